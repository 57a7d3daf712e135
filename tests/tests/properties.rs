//! Properties that follow from mechanics for any map under any load.

use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{ContactModel, ContactState, HeightMap, Load, PreparedContact};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};
use tests::stability::PlainSum;
use tests::{hard_map, map, rough_map, scene};

const TOLERANCE: f64 = 1e-10;
/// The certificate bounds gaps weighted by pressure in rms heights; an approach is one weighted by the
/// tangent's pressure, up to ten times that, and two of them are compared.
const SAME: f64 = 1e-8;
/// Bound of the gaps that the certificate allows, in tolerances times the rms height (`Bem3d::tolerance`).
const LEFT_OPEN: f64 = 10.0;
/// Sums over a few hundred cells.
const ROUNDING: f64 = 1e-12;

/// Seeds of failures are stored beside the tests.
fn config(cases: u32) -> ProptestConfig {
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct("tests/properties.regressions"))),
        ..ProptestConfig::with_cases(cases)
    }
}

prop_compose! {
    /// Any of the maps on which solvers have failed, or a rough one, of up to 20 x 20 cells.
    fn any_map()(
        kind in 0_u8..9, cells in 2_usize..21, seed in 0_u64..1000, noise in prop::collection::vec(0.0_f64..1.0, 400),
    ) -> HeightMap {
        match kind {
            7 | 8 if cells > 2 => rough_map(if kind == 7 { 2.2 } else { 2.9 }, cells, seed).unwrap(),
            _ => hard_map(kind, cells, &noise).unwrap(),
        }
    }
}

/// Rms height, or 1 for a flat map.
fn unit(map: &HeightMap) -> f64 {
    let rms = surface_gen::rms_height(map.heights());
    if rms > 0.0 { rms } else { 1.0 }
}

fn prepare(map: &HeightMap) -> Box<dyn PreparedContact> {
    let mut scene = scene(map.clone());
    (scene.outputs.pressure, scene.outputs.displacement) = (true, true);
    Bem3d { tolerance: TOLERANCE, ..Bem3d::default() }.prepare(&scene, 0).unwrap()
}

fn solve(map: &HeightMap, load: Load) -> ContactState {
    prepare(map).solve(load).unwrap()
}

/// Force and approach of either kind, from first touch to full contact.
fn any_load(map: &HeightMap, exponent: f64, is_force: bool) -> Load {
    let size = 10_f64.powf(exponent) * unit(map);
    if is_force { Load::force(size) } else { Load::approach(size) }
}

/// Force per cell and displacement.
fn fields(map: &HeightMap, state: &ContactState) -> (Vec<f64>, Vec<f64>) {
    let fields = state.fields.clone().unwrap();
    let area = map.dx() * map.dx();
    (
        fields.pressure.unwrap().values().iter().map(|p| p * area).collect(),
        fields.displacement.unwrap().into_values(),
    )
}

fn contact(map: &HeightMap, state: &ContactState) -> Vec<usize> {
    let (forces, _) = fields(map, state);
    (0..forces.len()).filter(|&i| forces[i] > 0.0).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Largest difference between two states: a gap for d, and that times k for F.
fn assert_same(map: &HeightMap, a: &ContactState, b: &ContactState) {
    let k = a.stiffness.unwrap();
    let gap = SAME * unit(map).max(ROUNDING * a.approach.unwrap());
    assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), epsilon = gap, max_relative = SAME);
    assert_relative_eq!(a.force, b.force, epsilon = gap * k, max_relative = SAME);
    assert_relative_eq!(k, b.stiffness.unwrap(), max_relative = SAME);
}

proptest! {
    #![proptest_config(config(48))]

    /// All eight symmetries of the square, pressures included.
    #[test]
    fn turned_and_mirrored(
        drawn in any_map(), turns in 0_u8..4, mirror in any::<bool>(), transpose in any::<bool>(), exponent in -8.0_f64..2.0, is_force in any::<bool>(),
    ) {
        let turn = |of: &HeightMap| {
            let mut of = of.clone();
            for _ in 0..turns {
                of = of.rotated();
            }
            if mirror {
                of = of.mirrored();
            }
            if transpose { of.transposed() } else { of }
        };
        let load = any_load(&drawn, exponent, is_force);
        let (here, turned) = (solve(&drawn, load), turn(&drawn));
        let there = solve(&turned, load);
        assert_same(&drawn, &here, &there);
        let field = |of: &ContactState| HeightMap::new(drawn.columns(), 1.0, of.pressure().unwrap().values().to_vec()).unwrap();
        let (expected, found) = (turn(&field(&here)), field(&there));
        // A gap left by the certificate, times the stiffness of a cell over its area.
        let slack = SAME * (unit(&drawn) / drawn.dx() * 2.0 + found.highest());
        for (a, b) in expected.heights().iter().zip(found.heights()) {
            prop_assert!((a - b).abs() <= slack, "{a} {b} of {}", found.highest());
        }
    }

    /// An offset that the heights represent exactly changes no bit.
    #[test]
    fn an_exact_offset_of_heights_changes_nothing(drawn in any_map(), steps in -2_000_000_000_i64..2_000_000_000, exponent in -6.0_f64..2.0, is_force in any::<bool>()) {
        let step = 2_f64.powi(-16);
        let at = |offset: f64| {
            let h = drawn.heights();
            map(drawn.columns(), 1.0, |x, y| (h[y * drawn.columns() + x] / step).round() * step + offset).unwrap()
        };
        let load = any_load(&drawn, exponent, is_force);
        prop_assert_eq!(solve(&at(0.0), load), solve(&at(steps as f64 * step), load));
    }

    /// Nested sets, convex F, k that never falls and is the difference quotient while the set stays, and the
    /// elastic energy between the sums of a convex force: chords above, tangents below.
    #[test]
    fn loading_at_increasing_approach(drawn in any_map(), start in -6.0_f64..0.5, ratios in prop::collection::vec(1.001_f64..3.0, 1..8)) {
        let mut press = prepare(&drawn);
        let mut d = 10_f64.powf(start) * unit(&drawn);
        let mut before: Option<(ContactState, Vec<f64>, f64)> = None;
        for ratio in ratios {
            let state = press.solve(Load::approach(d)).unwrap();
            let (forces, u) = fields(&drawn, &state);
            let (f1, k1) = (state.force, state.stiffness.unwrap());
            prop_assert!((forces.iter().sum::<f64>() / f1 - 1.0).abs() <= ROUNDING);
            let energy = 0.5 * dot(&forces, &u);
            if let Some((old, old_forces, old_energy)) = before {
                let (d0, f0, k0) = (old.approach.unwrap(), old.force, old.stiffness.unwrap());
                let (step, rise) = (d - d0, f1 - f0);
                let gap = LEFT_OPEN * TOLERANCE * unit(&drawn) + SAME * step;
                prop_assert!(k1 >= k0 * (1.0 - SAME), "k falls from {} to {}", k0, k1);
                prop_assert!(rise >= k0 * step - gap * k1 && rise <= k1 * step + gap * k1, "{} {} {}", k0, rise / step, k1);
                // A cell may leave only if it was never surely in.
                let surely = SAME * unit(&drawn) * drawn.dx();
                prop_assert!(old_forces.iter().zip(&forces).all(|(old, new)| *old <= surely || *new > 0.0));
                if contact(&drawn, &old) == contact(&drawn, &state) {
                    prop_assert!((rise - k1 * step).abs() <= gap * k1, "quotient {} beside k {}", rise / step, k1);
                }
                let chord = 0.5 * (f0 + f1) * step;
                // Where the tangents meet.
                let meet = if k1 > k0 * (1.0 + SAME) { ((k1 * step - rise) / (k1 - k0)).clamp(0.0, step) } else { step };
                let rest = step - meet;
                let tangents = f0 * meet + 0.5 * k0 * meet * meet + f1 * rest - 0.5 * k1 * rest * rest;
                let slack = gap * f1 + ROUNDING * energy;
                let work = energy - old_energy;
                prop_assert!(work <= chord + slack && work >= tangents - slack, "{} {} {}", tangents, work, chord);
            }
            before = Some((state, forces, energy));
            d *= ratio;
        }
    }

    /// Reciprocity (Maxwell and Betti): the work of one state's pressure on the other's displacement equals
    /// that of the other's pressure on its own.
    #[test]
    fn reciprocity(one in any_map(), noise in prop::collection::vec(0.0_f64..1.0, 400), exponents in (-3.0_f64..1.5, -3.0_f64..1.5)) {
        let other = hard_map(0, one.columns(), &noise).unwrap();
        let [a, b] = [(&one, exponents.0), (&other, exponents.1)]
            .map(|(map, exponent)| fields(map, &solve(map, any_load(map, exponent, true))));
        let (there, back) = (dot(&a.0, &b.1), dot(&b.0, &a.1));
        prop_assert!((there - back).abs() <= ROUNDING * there.abs(), "{} {}", there, back);
    }

    /// Raised anywhere below its summit, a surface carries more at the same approach, and needs less approach
    /// for the same force.
    #[test]
    fn a_higher_surface_carries_more(
        drawn in any_map(), raise in prop::collection::vec(0.0_f64..1.0, 400), exponent in -4.0_f64..1.5,
    ) {
        let (cells, highest) = (drawn.columns(), drawn.highest());
        let higher = map(cells, 1.0, |x, y| {
            let (h, r) = (drawn.heights()[y * cells + x], raise[y * cells + x]);
            // A third of the cells, part of the way to the summit.
            if r < 0.33 { h + r * (highest - h) } else { h }
        }).unwrap();
        let d = 10_f64.powf(exponent) * unit(&drawn);
        let (low, high) = (solve(&drawn, Load::approach(d)), solve(&higher, Load::approach(d)));
        let slack = SAME * unit(&drawn) * high.stiffness.unwrap() + SAME * high.force;
        prop_assert!(high.force >= low.force - slack, "{} above {}", low.force, high.force);
        let back = solve(&higher, Load::force(low.force)).approach.unwrap();
        prop_assert!(back <= d * (1.0 + SAME) + SAME * unit(&drawn), "{} beyond {}", back, d);
    }

    /// Barber's bounds. `F/k_N <= d <= F/k_N + height` with k_N of the square: the flat surfaces through the
    /// summit and the deepest point enclose the rough one. k is between that of a cell of the contact and
    /// that of the rectangle around it, and no more than the sum of cells.
    #[test]
    fn bounds_of_barber(drawn in any_map(), exponent in -6.0_f64..2.0) {
        let (cells, load) = (drawn.columns(), any_load(&drawn, exponent, true));
        let state = solve(&drawn, load);
        let plain = PlainSum::of(&drawn);
        let square = plain.stiffness(&(0..cells * cells).collect::<Vec<_>>());
        let (d, k) = (state.approach.unwrap(), state.stiffness.unwrap());
        let lowest = drawn.heights().iter().copied().fold(f64::INFINITY, f64::min);
        let (flat, slack) = (state.force / square, SAME * (unit(&drawn) + d));
        prop_assert!(d >= flat - slack && d <= flat + (drawn.highest() - lowest) + slack, "{} beside {}", d, flat);
        let set = contact(&drawn, &state);
        let ends = |of: &dyn Fn(usize) -> usize| {
            let places: Vec<usize> = set.iter().map(|&i| of(i)).collect();
            (places.iter().copied().min().unwrap(), places.iter().copied().max().unwrap())
        };
        let (x, y) = (ends(&|i| i % cells), ends(&|i| i / cells));
        let around: Vec<usize> =
            (0..cells * cells).filter(|i| (x.0..=x.1).contains(&(i % cells)) && (y.0..=y.1).contains(&(i / cells))).collect();
        let one = plain.stiffness(&set[..1]);
        let rectangle = plain.stiffness(&around);
        prop_assert!(k <= rectangle * (1.0 + SAME) && k <= one * set.len() as f64 * (1.0 + SAME), "{} of {}", k, rectangle);
        prop_assert!(k >= one * (1.0 - SAME), "{} below one cell's {}", k, one);
    }
}
