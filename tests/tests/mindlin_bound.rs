//! The bound of the tangential stiffness of a contact that sticks (`book/src/partial-slip.md`): the mean of
//! `k_xx` and `k_yy` is at least Mindlin's ratio times the normal stiffness of the same cells.

use bem3d::Bem3d;
use contact_model::{
    Body, Boundary, ContactModel, Coupling, Error, Friction, Load, Outputs, Pair, Scene, Step, Surface,
};
use proptest::prelude::*;
use proptest::test_runner::{FileFailurePersistence, RngSeed};
use std::sync::Arc;
use tests::stability::{PlainShear, PlainSum, compliance};
use tests::{hard_map, map, rough_map};

const TOLERANCE: f64 = 1e-10;
/// Stiffnesses of two solves at [`TOLERANCE`].
const SOLVED: f64 = 1e-7;
/// Gauss's rule, elimination, and sums over images that converge to about 1e-10 of the largest entry.
const DENSE: f64 = 1e-8;

fn config(cases: u32) -> ProptestConfig {
    let file = "tests/mindlin_bound.regressions";
    ProptestConfig {
        rng_seed: RngSeed::Fixed(1),
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(file))),
        ..ProptestConfig::with_cases(cases)
    }
}

/// Shear modulus and Poisson's ratio.
fn body([shear, poisson]: [f64; 2]) -> Body {
    Body::Elastic { young: 2.0 * shear * (1.0 + poisson), poisson }
}

/// `2 sum((1 - nu)/G) / sum((2 - nu)/G)`; of like bodies Mindlin's `(2 - 2 nu)/(2 - nu)`.
fn ratio(bodies: [[f64; 2]; 2]) -> f64 {
    let sum = |of: fn(f64) -> f64| bodies.iter().map(|[shear, nu]| of(*nu) / shear).sum::<f64>();
    2.0 * sum(|nu| 1.0 - nu) / sum(|nu| 2.0 - nu)
}

fn any_body() -> impl Strategy<Value = [f64; 2]> {
    (-2.0_f64..2.0, prop_oneof![Just(0.0), Just(0.5), 0.0_f64..0.5]).prop_map(|(g, nu)| [10_f64.powf(g), nu])
}

proptest! {
    #![proptest_config(config(80))]

    /// Random sets of cells of any size short of all, connected or not, by elimination alone: also the trace of
    /// the influence coefficients, from which the bound follows.
    #[test]
    fn every_set_of_cells_is_at_least_as_stiff(
        columns in 2_usize..9, rows in 2_usize..9, share in 0.02_f64..1.0, periodic in any::<bool>(),
        aspect in prop_oneof![Just(1.0), 0.3_f64..3.0], bodies in [any_body(), any_body()],
        noise in prop::collection::vec(0.0_f64..1.0, 64),
    ) {
        let [first, second] = bodies.map(body);
        let c = compliance(&Pair { first, second }).unwrap();
        // The sums over images are for square maps.
        let (normal, shear) = if periodic {
            let map = map(columns, 1.0, |_, _| 0.0).unwrap();
            (PlainSum::periodic(&map), PlainShear::periodic(&map, c))
        } else {
            let sides = [1.0, aspect];
            (PlainSum::new([columns, rows], sides), PlainShear::new([columns, rows], sides, c))
        };
        let cells = columns * if periodic { columns } else { rows };
        // Normal displacements are counted from their mean too.
        let mean = if periodic { normal.mean() } else { 0.0 };
        for lag in 0..cells {
            let [xx, yy, _] = shear.between(0, lag);
            let (found, expected) = (xx + yy, (2.0 + c) * (normal.between(0, lag) - mean));
            let scale = (2.0 + c) * normal.between(0, 0);
            prop_assert!((found - expected).abs() <= DENSE * scale, "lag {lag}: {found}, {expected}");
        }
        let mut contact: Vec<usize> = (0..cells).filter(|i| noise[i % 64] < share).collect();
        if contact.is_empty() {
            contact.push(0);
        }
        // All cells of a periodic surface have no stiffness: their mean displacement is 0.
        if contact.len() == cells && periodic {
            contact.pop();
        }
        // A constant c added to every coefficient adds c to 1/k.
        let k = 1.0 / (1.0 / normal.stiffness(&contact) - mean);
        let [[xx, _], [_, yy]] = shear.stiffness(&contact);
        let over = 0.5 * (xx + yy) / k / ratio(bodies);
        prop_assert!((2.0 / (2.0 + c) / ratio(bodies) - 1.0).abs() < 1e-12);
        prop_assert!(over >= 1.0 - DENSE, "{over} of {} cells", contact.len());
    }

}

proptest! {
    #![proptest_config(config(150))]

    /// The same of contacts that bem3d solves, bodies alike or not (normal and tangential contact uncoupled).
    #[test]
    fn every_contact_is_at_least_as_stiff(
        kind in 0_u8..9, cells in 2_usize..33, seed in 0_u64..1000, exponent in -4.0_f64..1.0,
        noise in prop::collection::vec(0.0_f64..1.0, 200), periodic in any::<bool>(), alike in any::<bool>(),
        bodies in [any_body(), any_body()],
    ) {
        let bodies = if alike { [bodies[0]; 2] } else { bodies };
        let [first, second] = bodies.map(body);
        let map = match kind {
            7 | 8 if cells > 2 => rough_map(if kind == 7 { 2.2 } else { 2.8 }, cells, seed).unwrap(),
            _ => hard_map(kind, cells, &noise).unwrap(),
        };
        let rms = surface_gen::rms_height(map.heights());
        let pair = Pair { first, second };
        let force = 10_f64.powf(exponent) * pair.contact_modulus().unwrap() * if rms > 0.0 { rms } else { 1.0 };
        let mut scene = Scene::of_pair(Surface::Heights(Arc::new(map)), pair).unwrap();
        scene.effects.boundary = if periodic { Boundary::Periodic } else { Boundary::Free };
        scene.effects.friction = Friction::coulomb(0.3).with_coupling(Some(Coupling::Neglected));
        scene.outputs = Outputs { stiffness: true, tangential_stiffness_stuck: true, ..Outputs::default() };
        let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
        let state = model.prepare(&scene, 0).unwrap().advance(Step::new(0.0, Load::force(force)));
        let state = match state {
            // Ties and stiffnesses that jump are refused by name; friction_properties.rs has them.
            Err(Error::NotConverged { .. }) => return Err(TestCaseError::reject("not converged")),
            state => state.unwrap(),
        };
        let stuck = state.tangential.and_then(|t| t.stiffness_stuck);
        // Full contact of a periodic surface has neither.
        let (Some(k), Some([[xx, _], [_, yy]])) = (state.stiffness, stuck) else {
            prop_assert!(periodic);
            return Ok(());
        };
        let over = 0.5 * (xx + yy) / k / ratio(bodies);
        prop_assert!(over >= 1.0 - SOLVED, "{over}, nu and G {bodies:?}");
    }
}

/// The excess over the bound vanishes for one cell, is small for a square, and grows with the length of a
/// rectangle.
#[test]
fn a_long_contact_exceeds_the_bound_and_a_compact_one_hardly() {
    let nu = 0.5;
    let c = compliance(&Pair { first: body([1.0, nu]), second: body([1.0, nu]) }).unwrap();
    let over = |columns: usize, rows: usize| {
        let contact: Vec<usize> = (0..columns * rows).collect();
        let normal = PlainSum::new([columns, rows], [1.0; 2]).stiffness(&contact);
        let [[xx, _], [_, yy]] = PlainShear::new([columns, rows], [1.0; 2], c).stiffness(&contact);
        0.5 * (xx + yy) / normal / ratio([[1.0, nu]; 2]) - 1.0
    };
    let one = over(1, 1);
    assert!(one.abs() < 1e-12, "{one}");
    let [square, twice, long] = [over(8, 8), over(16, 8), over(24, 2)];
    assert!(0.0 < square && square < 0.01 && square < twice && twice < long, "{square} {twice} {long}");
    // An endless strip: k along it is 1/(1 + c) of k across it, which is the normal one.
    assert!(long < (1.0 + 0.5 * c).powi(2) / (1.0 + c) - 1.0, "{long}");
}
