//! The solver compared with a search of every contact set for the one that satisfies the contact conditions.

use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, HeightMap, Load};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tests::{every_contact_set, map, scene};

const TOLERANCE: f64 = 1e-12;
/// Rounding of sums over a few cells, which is the only error of the stiffness.
const ROUNDING: f64 = 1e-12;
/// Closer to a tie than this the contact set depends on rounding, and either set is accepted.
const TIE: f64 = 1e-9;

/// The unique solution; `None` where the case is a tie.
fn check(map: &HeightMap, cells: &[usize], load: Load) {
    let all = every_contact_set(map, cells, load.normal);
    let [one] = &all[..] else {
        assert!(all.iter().all(|s| s.margin < TIE), "not one solution: {all:?}");
        return;
    };
    if one.margin < TIE {
        return;
    }
    let mut scene = scene(map.clone());
    scene.outputs.pressure = true;
    for method in [Method::Auto, Method::Iterative] {
        let model = Bem3d { tolerance: TOLERANCE, method, ..Bem3d::default() };
        let state = model.prepare(&scene, 0).unwrap().solve(load).unwrap();
        let pressure = state.fields.unwrap().pressure.unwrap().into_values();
        let found: Vec<usize> = (0..pressure.len()).filter(|&i| pressure[i] > 0.0).collect();
        assert_eq!(found, one.contact, "{method:?} {load:?} {map:?}");
        // The certificate bounds gaps in units of the rms height; a gap times a cell's own stiffness (1.7 at
        // most) is a force.
        let gap = TOLERANCE * surface_gen::rms_height(map.heights());
        let force = 2.0 * gap * one.contact.len() as f64;
        assert_relative_eq!(state.force, one.force, epsilon = force, max_relative = ROUNDING);
        assert_relative_eq!(
            state.approach.unwrap(),
            one.approach,
            epsilon = 2.0 * gap,
            max_relative = ROUNDING
        );
        assert_relative_eq!(state.stiffness.unwrap(), one.stiffness, max_relative = ROUNDING);
        let area = map.dx() * map.dx();
        for (&i, exact) in one.contact.iter().zip(&one.forces) {
            assert_relative_eq!(pressure[i] * area, exact, epsilon = force, max_relative = ROUNDING);
        }
    }
}

/// Forces and approaches from one cell in contact to all; heights are within [0, 1], the side of a cell is 1.
fn loads() -> impl Strategy<Value = Load> {
    prop_oneof![
        (-4.0_f64..1.5).prop_map(|x| Load::force(10_f64.powf(x))),
        (-3.0_f64..0.6).prop_map(|x| Load::approach(10_f64.powf(x))),
    ]
}

/// Cells of a mask drawn with letters; the map is as wide as the drawing.
fn cells_of(mask: &[&str]) -> Vec<usize> {
    let n = mask.len();
    let marked = |i: &usize| mask[i / n].as_bytes()[i % n] != b'.';
    (0..n * n).filter(marked).collect()
}

/// Masks on which contact is possible; all other cells lie out of reach.
const MASKS: [&[&str]; 5] = [
    &["xxxxx", "xxxxx", ".....", ".....", "....."],
    &["x.......", ".x......", "..x.....", "...x....", "....x...", ".....x..", "......x.", ".......x"],
    &["x.x.x", ".....", "x.x.x", ".....", "x.x.x"],
    &["xx..xx", "......", "......", "......", "......", "xx..xx"],
    &["x..", "xxx", "x.x"],
];

/// Deeper than any approach of [`loads`] reaches (d <= 4, or F = 32 on one cell: about 36), not so deep that
/// it spoils the rms height.
const DEEP: f64 = -60.0;

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::with_cases(96) })]

    #[test]
    fn three_by_three(heights in prop::collection::vec(0.0_f64..1.0, 9), load in loads()) {
        check(&map(3, 3.0, |x, y| heights[3 * y + x]).unwrap(), &(0..9).collect::<Vec<_>>(), load);
    }

    /// Heights of a few steps only: ties of heights, not of pressures.
    #[test]
    fn three_by_three_in_steps(heights in prop::collection::vec(0_u8..4, 9), load in loads()) {
        let map = map(3, 3.0, |x, y| 0.25 * f64::from(heights[3 * y + x])).unwrap();
        check(&map, &(0..9).collect::<Vec<_>>(), load);
    }

    #[test]
    fn masks(which in 0..MASKS.len(), heights in prop::collection::vec(0.0_f64..1.0, 16), load in loads()) {
        let n = MASKS[which].len();
        let cells = cells_of(MASKS[which]);
        let at = |i: usize| cells.iter().position(|&c| c == i).map_or(DEEP, |place| heights[place]);
        check(&map(n, n as f64, |x, y| at(y * n + x)).unwrap(), &cells, load);
    }
}
