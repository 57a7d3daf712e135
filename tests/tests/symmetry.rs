//! Scaling and symmetry: the same contact in other units, turned, mirrored and zoomed.

use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{ContactModel, ContactState, HeightMap, Line, Load, Scene, Surface};
use mdr1d::Mdr1d;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use std::sync::Arc;
use tests::{embedded, map, rough_map, scene};

const TOLERANCE: f64 = 1e-10;
/// Bound of the difference between two solves at [`TOLERANCE`]: the certificate is relative to the rms
/// height, and approaches here are down to a hundredth of it.
const SAME: f64 = 1e-7;

const CELLS: usize = 33;

/// A symmetry of the square.
type Turn = fn(&HeightMap) -> HeightMap;

fn solve(scene: &Scene, load: Load) -> ContactState {
    let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
    model.prepare(scene, 0).unwrap().solve(load).unwrap()
}

fn assert_same(a: &ContactState, b: &ContactState) {
    assert_relative_eq!(a.force, b.force, max_relative = SAME);
    assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), max_relative = SAME);
    assert_relative_eq!(a.stiffness.unwrap(), b.stiffness.unwrap(), max_relative = SAME);
    assert_eq!(a.report.contact_cells, b.report.contact_cells);
}

/// A line of the heights of a map's rows, for the one-dimensional model.
fn line(of: &HeightMap, lateral: f64, vertical: f64) -> Surface {
    let heights = of.heights().iter().map(|h| h * vertical).collect();
    Surface::Line { line: Arc::new(Line::new(lateral, heights).unwrap()), size: lateral.into() }
}

#[test]
fn turned_mirrored_transposed() {
    let original = rough_map(2.4, CELLS, 17).unwrap();
    let turns: [Turn; 4] =
        [HeightMap::mirrored, HeightMap::transposed, HeightMap::rotated, |m| m.rotated().rotated()];
    let pressed = |map: HeightMap, load: Load| {
        let mut scene = scene(map);
        scene.outputs.pressure = true;
        solve(&scene, load)
    };
    for load in [Load::force(1e-2), Load::force(0.5), Load::force(20.0), Load::approach(1.0)] {
        let there = pressed(original.clone(), load);
        let p = |state: &ContactState| state.pressure().unwrap().values().to_vec();
        let p_there = HeightMap::new(CELLS, 1.0, p(&there)).unwrap();
        for turn in turns {
            let here = pressed(turn(&original), load);
            assert_same(&there, &here);
            let largest = p_there.highest();
            for (a, b) in turn(&p_there).heights().iter().zip(&p(&here)) {
                assert_relative_eq!(a, b, epsilon = 1e3 * SAME * largest);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::with_cases(24) })]

    /// F ~ E* L h, k ~ E* L, d ~ h, in three dimensions and in one.
    #[test]
    fn units(
        seed in 0_u64..1000, force_bar in -3.0_f64..1.5,
        contact_modulus in -12.0_f64..12.0, lateral in -6.0_f64..6.0, vertical in -9.0_f64..6.0,
    ) {
        let [f, e, l, h] = [force_bar, contact_modulus, lateral, vertical].map(|x| 10_f64.powf(x));
        let original = rough_map(2.4, CELLS, seed).unwrap();
        let mut scaled = scene(original.scaled(l, h).unwrap());
        scaled.contact_modulus = e;
        let there = solve(&scene(original.clone()), Load::force(f));
        let here = solve(&scaled, Load::force(f * e * l * h));
        assert_same(&there, &divided(&here, e * l * h, h, e * l));

        let press = |surface: Surface, contact_modulus: f64, force: f64| {
            Mdr1d::default().prepare(&Scene::new(surface, contact_modulus), 0).unwrap().solve(Load::force(force)).unwrap()
        };
        let there = press(line(&original, 1.0, 1.0), 1.0, f);
        let here = press(line(&original, l, h), e, f * e * l * h);
        assert_same(&there, &divided(&here, e * l * h, h, e * l));
    }
}

fn divided(state: &ContactState, force: f64, approach: f64, stiffness: f64) -> ContactState {
    let mut state = state.clone();
    state.force /= force;
    state.approach = state.approach.map(|d| d / approach);
    state.stiffness = state.stiffness.map(|k| k / stiffness);
    state
}

/// Above Eq. 8: heights, force and approach times one factor leave k alone. With `k ~ F^alpha (h^2)^delta`
/// (Eq. 7) this is `alpha + 2 delta = 0`, so `dlnk/dlnh` at fixed F is minus `dlnk/dlnF` at fixed h.
#[test]
fn delta_is_minus_half_of_alpha() {
    let original = rough_map(2.4, CELLS, 3).unwrap();
    let k = |vertical: f64, force: f64| {
        let scene = scene(original.scaled(1.0, vertical).unwrap());
        solve(&scene, Load::force(force)).stiffness.unwrap()
    };
    let (force, factor) = (0.05, 1.7);
    assert_relative_eq!(k(factor, factor * force), k(1.0, force), max_relative = SAME);
    let alpha = (k(1.0, force) / k(1.0, force / factor)).ln() / factor.ln();
    let two_delta = (k(factor, force) / k(1.0, force)).ln() / factor.ln();
    // ln of numbers good to SAME, over ln 1.7.
    assert_relative_eq!(two_delta, -alpha, epsilon = 4.0 * SAME);
}

/// All lateral lengths times C, heights and approach unchanged: F and k times C, in three dimensions and in
/// one.
#[test]
fn lateral_lengths_alone() {
    let original = rough_map(2.2, CELLS, 5).unwrap();
    for factor in [0.01, 3.0, 4096.0] {
        for d in [0.3, 2.0, 20.0] {
            let there = solve(&scene(original.clone()), Load::approach(d));
            let here = solve(&scene(original.scaled(factor, 1.0).unwrap()), Load::approach(d));
            assert_same(&there, &divided(&here, factor, 1.0, factor));
            let press = |lateral| {
                let scene = Scene::new(line(&original, lateral, 1.0), 1.0);
                Mdr1d::default().prepare(&scene, 0).unwrap().solve(Load::approach(d)).unwrap()
            };
            assert_same(&press(1.0), &divided(&press(factor), factor, 1.0, factor));
        }
    }
}

/// Eqs. 19 and 21: a larger frame around the one contact region leaves force, approach and stiffness alone,
/// because the half-space is free outside. In the units of the frame that is Eq. 22: `k_bar` falls by C,
/// `F_bar` by C times the ratio of the rms heights.
#[test]
fn the_size_of_the_frame_does_not_matter() {
    let inner = map(CELLS, 1.0, |x, y| {
        let r2 = [x, y].map(|i| (i as f64 - 16.0) / 33.0).map(|t| t * t).iter().sum::<f64>();
        rough_map_value(x, y) - 8.0 * r2
    })
    .unwrap();
    let factor = 3;
    let outer = embedded(&inner, factor, -10.0).unwrap();
    for d in [0.2, 0.5, 1.0] {
        let (small, large) = (scene(inner.clone()), scene(outer.clone()));
        let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
        let (mut small, mut large) = (model.prepare(&small, 0).unwrap(), model.prepare(&large, 0).unwrap());
        let (a, b) = (small.solve(Load::approach(d)).unwrap(), large.solve(Load::approach(d)).unwrap());
        assert_same(&a, &b);
        let (at, bt) = (small.normalisation(), large.normalisation());
        let heights = bt.height.unwrap() / at.height.unwrap();
        assert_relative_eq!(
            at.stiffness_bar(a.stiffness.unwrap()),
            factor as f64 * bt.stiffness_bar(b.stiffness.unwrap()),
            max_relative = SAME
        );
        assert_relative_eq!(
            at.force_bar(a.force).unwrap(),
            factor as f64 * heights * bt.force_bar(b.force).unwrap(),
            max_relative = SAME
        );
    }
}

/// Small heights on the paraboloid, fixed by its place alone.
fn rough_map_value(x: usize, y: usize) -> f64 {
    0.05 * ((7 * x + 3 * y) as f64).sin() + 0.03 * ((2 * x + 11 * y) as f64).cos()
}

/// Eqs. 22 to 24 on a body that is exactly self-affine, `z = c r^n` with n for H: a frame C times as large on
/// as many cells is the same map with lateral factor C and heights times C^n. So `F ~ C^(n + 1)`, `k ~ C` and
/// `alpha = 1/(1 + n)` with no error of discretisation.
#[test]
fn the_zoom_argument() {
    for n in [0.5, 0.8, 1.0] {
        let body = |side: f64| {
            Scene::new(Surface::PowerLaw { coefficient: 0.1, exponent: n, size: side.into() }, 1.0)
        };
        let bem = Bem3d { cells: CELLS, tolerance: TOLERANCE, ..Bem3d::default() };
        let models: [&dyn ContactModel; 2] = [&bem, &Mdr1d::default()];
        for model in models {
            let press = |zoom: f64| {
                let load = Load::approach(0.1 * 0.3_f64.powf(n) * zoom.powf(n));
                model.prepare(&body(zoom), 0).unwrap().solve(load).unwrap()
            };
            let (here, there) = (press(1.0), press(5.0));
            assert_same(&here, &divided(&there, 5_f64.powf(n + 1.0), 5_f64.powf(n), 5.0));
            let alpha =
                (there.stiffness.unwrap() / here.stiffness.unwrap()).ln() / (there.force / here.force).ln();
            assert_relative_eq!(alpha, analytic::exponent_scaling(n), max_relative = SAME);
        }
    }
}
