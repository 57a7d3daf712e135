//! Thousands of small random states with a hardness, each of which has to converge.

#![allow(clippy::unwrap_used)]

use bem3d::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// States of the test that always runs.
const STATES: u64 = 20_000;
/// One state in this number is solved to the tighter tolerance.
const TIGHT_SHARE: u64 = 4;
/// Both tolerances.
const TOLERANCES: [f64; 2] = [1e-6, 1e-9];

/// Reproducible random numbers (splitmix64).
struct SplitMix(u64);

impl SplitMix {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Uniform in [0, 1).
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    fn index(&mut self, low: usize, high: usize) -> usize {
        low + self.next() as usize % (high + 1 - low)
    }

    fn decades(&mut self, low: f64, high: f64) -> f64 {
        10f64.powf(self.between(low, high))
    }
}

/// White noise, smoothed repeatedly over a cell and its neighbours, periodically across the edges.
fn heights(draw: &mut SplitMix, columns: usize, rows: usize) -> Vec<f64> {
    let mut h: Vec<f64> =
        (0..columns * rows).map(|_| (0..4).map(|_| draw.uniform()).sum::<f64>() - 2.0).collect();
    for _ in 0..draw.index(0, 6).saturating_sub(2) {
        let at = |x: usize, y: usize| h[y % rows * columns + x % columns];
        let mean = |i: usize| {
            let (x, y) = (i % columns, i / columns);
            let beside = at(x + 1, y) + at(x + columns - 1, y) + at(x, y + 1) + at(x, y + rows - 1);
            0.5 * at(x, y) + 0.125 * beside
        };
        h = (0..h.len()).map(mean).collect();
    }
    // Steps, or a few high summits.
    match draw.index(0, 7) {
        0 => h.iter_mut().for_each(|h| *h = (4.0 * *h).round() / 4.0),
        1 => h.iter_mut().for_each(|h| *h = (3.0 * *h).exp()),
        _ => {}
    }
    let scale = draw.decades(-2.0, 1.5);
    for h in &mut h {
        *h *= scale;
    }
    h
}

/// A state by its number: model, scene and load.
fn state(number: u64, tolerances: [f64; 2]) -> (Bem3d, Scene, Load) {
    let mut draw = SplitMix(number);
    let (columns, rows) = (draw.index(8, 30), draw.index(8, 30));
    let (dx, dy) = (0.05, if draw.index(0, 2) == 0 { 0.05 } else { 0.05 * draw.between(0.5, 2.0) });
    let size = [columns as f64 * dx, rows as f64 * dy];
    let h = heights(&mut draw, columns, rows);
    let map = if draw.index(0, 2) == 0 {
        let holes = draw.between(0.0, 0.4);
        let h = h.iter().map(|&h| if draw.uniform() < holes { f64::NAN } else { h }).collect();
        HeightMap::with_undefined([columns, rows], size, h).unwrap()
    } else {
        HeightMap::new([columns, rows], size, h).unwrap()
    };
    let (mut slopes, mut count) = (0.0, 0.0);
    for y in 0..rows {
        for x in 1..columns {
            let step = (map.heights()[y * columns + x] - map.heights()[y * columns + x - 1]) / dx;
            if step.is_finite() {
                (slopes, count) = (slopes + step * step, count + 1.0);
            }
        }
    }
    let gradient = (slopes / count).sqrt().max(1e-6);
    let pressure = gradient * draw.decades(-3.0, 1.0);
    let capacity = pressure * (map.heights().len() - map.undefined()) as f64 * dx * dy;
    let low = map.defined().fold(f64::INFINITY, f64::min);
    let range = map.highest() - low;
    let boundary = if draw.index(0, 1) == 0 { Boundary::Free } else { Boundary::Periodic };
    let share = match draw.index(0, 4) {
        0 => draw.decades(-4.0, 0.0),
        1 => 1.0 - draw.decades(-3.0, 0.0),
        _ => draw.between(0.0, 1.0),
    };
    let load = match (draw.index(0, 2), boundary) {
        (0, Boundary::Free) => Load::approach(range * draw.between(0.01, 1.2)),
        (0, Boundary::Periodic) => {
            let mean = map.defined().sum::<f64>() / (map.heights().len() - map.undefined()) as f64;
            Load::mean_gap((map.highest() - mean) * draw.between(0.2, 0.95))
        }
        _ => Load::force(capacity * share.clamp(1e-4, 0.999)),
    };
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 1.0);
    scene.effects.boundary = boundary;
    scene.effects.hardness = Hardness::Limit { pressure };
    scene.outputs = Outputs::default();
    scene.outputs.stiffness = false;
    scene.outputs.area = true;
    let tight = draw.next().is_multiple_of(TIGHT_SHARE);
    let method = if draw.index(0, 1) == 0 { Method::Auto } else { Method::Iterative };
    let model = Bem3d { tolerance: tolerances[usize::from(tight)], method, ..Bem3d::default() };
    (model, scene, load)
}

/// Solves the states of these numbers on two threads; how they ended, and the numbers of those that did not
/// converge.
fn solved(first: u64, count: u64, tolerances: [f64; 2]) -> (BTreeMap<&'static str, usize>, Vec<String>) {
    let next = AtomicU64::new(first);
    let work = || {
        let (mut ends, mut failed) = (BTreeMap::new(), Vec::new());
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= first + count {
                return (ends, failed);
            }
            let (model, scene, load) = state(number, tolerances);
            let end = match ContactModel::prepare(&model, &scene, 0).unwrap().solve(load) {
                Ok(state) => {
                    assert!(state.report.certificate.meets(model.tolerance));
                    if state.plastic.unwrap().area > 0.0 { "with saturated cells" } else { "elastic" }
                }
                // Near full plasticity, and where whole cells carry the force, a range of gaps has forces
                // that differ by rounding.
                Err(Error::OutOfRange { .. }) if matches!(load.normal, NormalLoad::MeanGap(_)) => {
                    "no such gap"
                }
                Err(error) => {
                    failed.push(format!("{number}: {load:?} to {}: {error}", model.tolerance));
                    "not converged"
                }
            };
            *ends.entry(end).or_insert(0) += 1;
        }
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        let (mut ends, mut failed) = (BTreeMap::new(), Vec::new());
        for (found, messages) in threads.map(|thread| thread.join().unwrap()) {
            for (end, count) in found {
                *ends.entry(end).or_insert(0) += count;
            }
            failed.extend(messages);
        }
        (ends, failed)
    })
}

/// Asserts that these states converge, and that few mean gaps have no force of their own.
fn converge(first: u64, count: u64, tolerances: [f64; 2]) {
    let (ends, failed) = solved(first, count, tolerances);
    println!("{ends:?}");
    assert!(failed.is_empty(), "{failed:#?}");
    let of = |end: &str| ends.get(end).copied().unwrap_or(0) as u64;
    assert!(of("no such gap") < count / 10 && of("with saturated cells") > count / 2, "{ends:?}");
}

#[test]
fn every_small_state_converges() {
    converge(0, STATES, TOLERANCES);
}

/// Ten times as many states, with tighter tolerances:
/// `cargo test --release -p bem3d --test hardness_states -- --ignored --nocapture`.
#[test]
#[ignore = "minutes"]
fn many_more_small_states_converge() {
    converge(STATES, 10 * STATES, TOLERANCES);
    converge(20 * STATES, STATES, [1e-10, 1e-11]);
}

/// Heights of maps on which cells are alike, far apart, or alone.
fn degenerate(columns: usize, rows: usize) -> Vec<(&'static str, Vec<f64>)> {
    let n = columns * rows;
    let of = |height: &dyn Fn(usize) -> f64| (0..n).map(height).collect::<Vec<f64>>();
    vec![
        ("flat", vec![0.0; n]),
        ("one summit", of(&|i| f64::from(u8::from(i == n / 2)))),
        ("two levels", of(&|i| (i % 2) as f64)),
        ("stairs", of(&|i| i as f64 / n as f64)),
        ("twelve decades", of(&|i| 10f64.powf(-12.0 * (i * 7 % n) as f64 / n as f64))),
        ("one defined cell", of(&|i| if i == n - 1 { 1.0 } else { f64::NAN })),
        ("defined cells in one row", of(&|i| if i < columns { (i * i % 5) as f64 } else { f64::NAN })),
    ]
}

/// Hardness that no cell reaches, and one that nearly all do, at forces from nearly nothing to nearly all.
#[test]
fn degenerate_states_converge() {
    let mut count = 0;
    for [columns, rows] in [[1, 1], [1, 2], [2, 2], [5, 1], [3, 4], [9, 8]] {
        for (what, heights) in degenerate(columns, rows) {
            let map =
                HeightMap::with_undefined([columns, rows], [columns as f64, 1.3 * rows as f64], heights)
                    .unwrap();
            let cells = map.heights().len() - map.undefined();
            for (boundary, hardness, method) in
                [Boundary::Free, Boundary::Periodic].into_iter().flat_map(|boundary| {
                    [1e-9, 1e-3, 0.1, 1.0, 1e3].into_iter().flat_map(move |hardness| {
                        [Method::Auto, Method::Iterative, Method::SingleLevel]
                            .map(|method| (boundary, hardness, method))
                    })
                })
            {
                let capacity = hardness * 1.3 * cells as f64;
                let whole = (1..=cells).step_by(1 + cells / 5).map(|n| n as f64 / cells as f64);
                let shares = [1e-12, 1e-6, 0.01, 0.3, 0.7, 0.999, 1.0 - 1e-9, 1.0 - 3e-12];
                let forces = shares.into_iter().chain(whole.filter(|&share| share < 0.9999));
                let loads = forces.map(|share| Load::force(share * capacity));
                let approaches = [1e-9, 0.1, 1.0, 20.0].map(Load::approach);
                let free = boundary == Boundary::Free;
                for load in loads.chain(approaches.into_iter().filter(|_| free)) {
                    let mut scene = Scene::new(Surface::Heights(Arc::new(map.clone())), 1.0);
                    scene.effects.boundary = boundary;
                    scene.effects.hardness = Hardness::Limit { pressure: hardness };
                    (scene.outputs.stiffness, scene.outputs.area) = (false, true);
                    let model = Bem3d { method, ..Bem3d::default() };
                    let found = ContactModel::prepare(&model, &scene, 0).unwrap().solve(load);
                    let state = found.unwrap_or_else(|error| {
                        panic!(
                            "{what} {columns} x {rows} {boundary:?} {hardness} {method:?} {load:?}: {error}"
                        )
                    });
                    assert!(state.report.certificate.meets(model.tolerance));
                    count += 1;
                }
            }
        }
    }
    println!("{count} states");
}
