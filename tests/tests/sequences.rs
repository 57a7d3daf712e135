//! Any order of loads on any map: a solver with earlier loads in its memory gives the same states as a fresh
//! one.

use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, Load};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use tests::{hard_map, rough_map, scene};

const TOLERANCE: f64 = 1e-9;
/// The certificate bounds gaps weighted by pressure; the approach is one weighted by the tangent's pressure,
/// up to ten times that.
const SAME: f64 = 2e-8;

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), failure_persistence: None, ..ProptestConfig::with_cases(150) })]

    #[test]
    fn earlier_loads_do_not_change_a_state(
        kind in 0_u8..8, cells in 1_usize..40, seed in 0_u64..1000,
        noise in prop::collection::vec(0.0_f64..1.0, 1600),
        // Logarithm of the load over the rms height, and whether it is a force.
        loads in prop::collection::vec((-8.0_f64..3.0, any::<bool>()), 1..6),
    ) {
        let map = if kind == 7 && cells > 2 { rough_map(2.6, cells, seed).unwrap() } else { hard_map(kind, cells, &noise).unwrap() };
        let rms = surface_gen::rms_height(map.heights());
        let unit = if rms > 0.0 { rms } else { 1.0 };
        let scene = scene(map);
        let model = |method| Bem3d { tolerance: TOLERANCE, method, ..Bem3d::default() };
        let mut remembering = model(Method::Auto).prepare(&scene, 0).unwrap();
        for (exponent, is_force) in loads {
            let size = 10_f64.powf(exponent) * unit;
            let load = if is_force { Load::force(size) } else { Load::approach(size) };
            let one = remembering.solve(load).unwrap();
            let other = model(Method::Iterative).prepare(&scene, 0).unwrap().solve(load).unwrap();
            let stiffness = other.stiffness.unwrap();
            // Flat: gaps are counted in the approach.
            let gap = SAME * if rms > 0.0 { rms } else { other.approach.unwrap() };
            assert_relative_eq!(one.approach.unwrap(), other.approach.unwrap(), epsilon = gap);
            assert_relative_eq!(one.force, other.force, epsilon = gap * stiffness);
            assert_relative_eq!(one.stiffness.unwrap(), stiffness, max_relative = SAME);
            for state in [one, other] {
                assert!(state.report.certificate.meets(TOLERANCE), "{:?}", state.report);
            }
        }
    }
}
