//! Thousands of small random states with a hardness: each one converges.

#![allow(clippy::unwrap_used)]

use bem3d::*;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// States of the test that always runs.
const STATES: u64 = 20_000;
/// One state in so many is solved to the tighter tolerance.
const TIGHT_SHARE: u64 = 4;
/// Both tolerances.
const TOLERANCES: [f64; 2] = [1e-6, 1e-9];

/// Reproducible random numbers (splitmix64).
struct Draw(u64);

impl Draw {
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

/// White noise, smoothed so many times over a cell and its neighbours across the edges.
fn heights(draw: &mut Draw, columns: usize, rows: usize) -> Vec<f64> {
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
    h.iter_mut().for_each(|h| *h *= scale);
    h
}

/// A state by its number: model, scene and load.
fn state(number: u64, tolerances: [f64; 2]) -> (Bem3d, Scene, Load) {
    let mut draw = Draw(number);
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
        (0, Boundary::Free) => Load::Approach(range * draw.between(0.01, 1.2)),
        (0, Boundary::Periodic) => {
            let mean = map.defined().sum::<f64>() / (map.heights().len() - map.undefined()) as f64;
            Load::MeanGap((map.highest() - mean) * draw.between(0.2, 0.95))
        }
        _ => Load::Force(capacity * share.clamp(1e-4, 0.999)),
    };
    let mut scene = Scene::new(Surface::Heights(Arc::new(map)), 1.0);
    scene.effects.boundary = boundary;
    scene.effects.hardness = Hardness::Limit { pressure };
    scene.outputs = Outputs::default();
    scene.outputs.stiffness = false;
    scene.outputs.area = true;
    let tight = draw.next() % TIGHT_SHARE == 0;
    let method = if draw.index(0, 1) == 0 { Method::Auto } else { Method::Iterative };
    let model = Bem3d { tolerance: tolerances[usize::from(tight)], method, ..Bem3d::default() };
    (model, scene, load)
}

/// Solves the states of these numbers on two threads; how they ended, and the numbers of those that did not converge.
fn solved(first: u64, count: u64, tolerances: [f64; 2]) -> (BTreeMap<&'static str, usize>, Vec<u64>) {
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
                // No force that f64 tells from that of all cells makes so small a gap.
                Err(Error::OutOfRange { .. }) if matches!(load, Load::MeanGap(_)) => "no such gap",
                Err(error) => {
                    if std::env::var("WHY").is_ok() {
                        println!("{number}: {load:?} {} {error}", model.tolerance);
                    }
                    failed.push(number);
                    "not converged"
                }
            };
            *ends.entry(end).or_insert(0) += 1;
        }
    };
    std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        let (mut ends, mut failed) = (BTreeMap::new(), Vec::new());
        for (found, numbers) in threads.map(|thread| thread.join().unwrap()) {
            found.into_iter().for_each(|(end, count)| *ends.entry(end).or_insert(0) += count);
            failed.extend(numbers);
        }
        failed.sort_unstable();
        (ends, failed)
    })
}

#[test]
fn every_small_state_converges() {
    let count = std::env::var("STATES").map_or(STATES, |v| v.parse().unwrap());
    let first = std::env::var("FIRST").map_or(0, |v| v.parse().unwrap());
    let (ends, failed) = solved(first, count, TOLERANCES);
    println!("{ends:?}");
    assert!(failed.is_empty(), "not converged: {failed:?}");
}
