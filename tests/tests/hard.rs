//! Hard cases: tiny grids, flat maps, ties, distant contacts, huge loads and unattainable tolerances.

use approx::assert_relative_eq;
use bem3d::{Bem3d, Method};
use contact_model::{ContactModel, ContactState, Error, HeightMap, Load, Scene, SelfAffine, Status, Surface};
use mdr1d::Mdr1d;
use std::cell::Cell;
use tests::{map, rough, rough_map, scene};

const TOLERANCE: f64 = 1e-10;
/// Two solves at [`TOLERANCE`], which is a share of the rms height, at approaches down to 1e-3 of it.
const SAME: f64 = 1e-7;
const METHODS: [Method; 2] = [Method::Auto, Method::Iterative];

fn press_by(method: Method, map: &HeightMap, load: Load) -> ContactState {
    let model = Bem3d { tolerance: TOLERANCE, method, ..Bem3d::default() };
    let mut scene = scene(map.clone());
    scene.outputs.area = true;
    model.prepare(&scene, 0).unwrap().solve(load).unwrap()
}

/// Both methods, which must agree.
fn press(map: &HeightMap, load: Load) -> ContactState {
    let [one, other] = METHODS.map(|method| press_by(method, map, load));
    assert_relative_eq!(one.force, other.force, max_relative = SAME);
    assert_relative_eq!(one.approach.unwrap(), other.approach.unwrap(), max_relative = SAME);
    assert_relative_eq!(one.stiffness.unwrap(), other.stiffness.unwrap(), max_relative = SAME);
    assert_eq!(one.report.contact_cells, other.report.contact_cells);
    one
}

/// `k/(E* L)` of full contact of N x N cells.
fn full(cells: usize) -> f64 {
    let flat = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
    let model = Bem3d { cells, tolerance: TOLERANCE, ..Bem3d::default() };
    model.prepare(&flat, 0).unwrap().solve(Load::approach(1.0)).unwrap().stiffness.unwrap()
}

/// With equal heights the contact is the flat punch under any load. The rms height is 0, so that F_bar does
/// not exist.
#[test]
fn flat_maps_of_any_size() {
    for cells in [1, 2, 3, 4, 7, 13, 31, 61, 64] {
        for height in [0.0, -3.5, 1e9] {
            let flat = map(cells, 1.0, |_, _| height).unwrap();
            for load in [
                Load::force(0.3),
                Load::approach(0.2),
                Load::force(1e-12),
                Load::approach(1e12),
                Load::force(1e-200),
                Load::approach(1e-200),
                Load::force(1e160),
                Load::approach(1e200),
            ] {
                let state = press(&flat, load);
                assert_eq!(state.report.contact_cells, Some(cells * cells));
                assert_relative_eq!(state.stiffness.unwrap(), full(cells), max_relative = SAME);
                assert_relative_eq!(state.force, full(cells) * state.approach.unwrap(), max_relative = SAME);
                assert_relative_eq!(state.area.unwrap(), 1.0, max_relative = 1e-12);
            }
            let contact = Bem3d::default().prepare(&scene(flat), 0).unwrap();
            assert!(matches!(contact.normalisation().force_bar(1.0), Err(Error::Domain { .. })));
        }
    }
}

/// Rough maps from one cell to a prime number, from first touch to full contact.
#[test]
fn small_and_prime_grids() {
    for cells in [3, 4, 5, 7, 11, 23, 37] {
        let rough = rough_map(2.5, cells, 2).unwrap();
        let mut before = 0.0;
        for force in [1e-8, 1e-3, 0.1, 1.0, 10.0, 300.0] {
            let state = press(&rough, Load::force(force));
            let k = state.stiffness.unwrap();
            assert!(k >= before * (1.0 - SAME) && k <= full(cells) * (1.0 + SAME));
            before = k;
        }
        assert_relative_eq!(before, full(cells), max_relative = SAME);
    }
}

/// Black cells touch first, all together, then the white ones.
#[test]
fn a_checkerboard() {
    for cells in [2, 3, 8, 17, 32] {
        let board = map(cells, 1.0, |x, y| if (x + y) % 2 == 0 { 0.0 } else { -1.0 }).unwrap();
        let black = (cells * cells).div_ceil(2);
        let light = press(&board, Load::approach(1e-3));
        assert_eq!(light.report.contact_cells, Some(black));
        assert!(light.stiffness.unwrap() < full(cells));
        assert_relative_eq!(light.force, light.stiffness.unwrap() * 1e-3, max_relative = SAME);
        let heavy = press(&board, Load::force(1e3));
        assert_eq!(heavy.report.contact_cells, Some(cells * cells));
        assert_relative_eq!(heavy.stiffness.unwrap(), full(cells), max_relative = SAME);
    }
}

#[test]
fn a_single_spike_and_two_distant_ones() {
    let one_cell = 0.891_106_989;
    for cells in [9, 64, 101] {
        let cell = 1.0 / cells as f64;
        let spike = map(cells, 1.0, |x, y| if (x, y) == (2, 5) { 1.0 } else { 0.0 }).unwrap();
        for d in [1e-12, 1e-3, 0.9] {
            let state = press(&spike, Load::approach(d));
            assert_eq!(state.report.contact_cells, Some(1));
            assert_relative_eq!(state.stiffness.unwrap(), one_cell * cell, max_relative = 1e-9);
        }
        let corners = [(0, 0), (cells - 1, cells - 1)];
        let two = map(cells, 1.0, |x, y| if corners.contains(&(x, y)) { 1.0 } else { 0.0 }).unwrap();
        let state = press(&two, Load::force(1e-3 * cell));
        assert_eq!(state.report.contact_cells, Some(2));
        // Each feels the other: k = 2 pi h_c/(I(0, 0) + I(N - 1, N - 1)).
        let pair = bem3d::love::influence(0, 0) + bem3d::love::influence(cells - 1, cells - 1);
        let exact = 2.0 * std::f64::consts::PI * cell / pair;
        assert_relative_eq!(state.stiffness.unwrap(), exact, max_relative = 1e-9);
        // The second a little lower: it joins once the first has been pressed so deep and lifted it by its
        // own field.
        let uneven = map(cells, 1.0, |x, y| match (x, y) {
            p if p == corners[0] => 1.0,
            p if p == corners[1] => 0.999,
            _ => 0.0,
        })
        .unwrap();
        assert_eq!(press(&uneven, Load::approach(0.000_9)).report.contact_cells, Some(1));
        assert_eq!(press(&uneven, Load::approach(0.002)).report.contact_cells, Some(2));
    }
}

/// The whole range of forces in one sweep, in any order, compared with each load alone.
#[test]
fn from_1e_minus_200_to_1e4_in_one_sweep() {
    let map = rough_map(2.4, 33, 5).unwrap();
    let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
    let mut contact = model.prepare(&scene(map.clone()), 0).unwrap();
    for force in [1e-200, 1e-12, 1e4, 1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e2, 1e4, 20.0, 1e-8, 0.1] {
        let swept = contact.solve(Load::force(force)).unwrap();
        let alone = press(&map, Load::force(force));
        assert_relative_eq!(swept.force, force, max_relative = TOLERANCE);
        assert_relative_eq!(swept.approach.unwrap(), alone.approach.unwrap(), max_relative = SAME);
        assert_relative_eq!(swept.stiffness.unwrap(), alone.stiffness.unwrap(), max_relative = SAME);
    }
}

#[test]
fn heights_and_moduli_at_the_ends_of_f64() {
    let original = rough_map(2.4, 17, 5).unwrap();
    for vertical in [1e-150, 1e150] {
        for contact_modulus in [1e-12, 1.0, 1e12] {
            for force in [1e-6, 0.1, 20.0] {
                let there = press(&original, Load::force(force));
                let mut scaled = scene(original.scaled(1.0, vertical).unwrap());
                scaled.contact_modulus = contact_modulus;
                let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
                let load = Load::force(force * vertical * contact_modulus);
                let here = model.prepare(&scaled, 0).unwrap().solve(load).unwrap();
                let approach = here.approach.unwrap() / vertical;
                assert_relative_eq!(approach, there.approach.unwrap(), max_relative = SAME);
                let stiffness = here.stiffness.unwrap() / contact_modulus;
                assert_relative_eq!(stiffness, there.stiffness.unwrap(), max_relative = SAME);
            }
        }
    }
}

#[test]
fn no_load_is_no_contact() {
    let models: [(&dyn ContactModel, Scene); 3] = [
        (&Bem3d { cells: 33, ..Bem3d::default() }, Scene::new(Surface::SelfAffine(rough(2.4).unwrap()), 1.0)),
        (&Mdr1d::default(), Scene::new(Surface::SelfAffine(rough(2.4).unwrap()), 1.0)),
        (&analytic::Hertz, Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0)),
    ];
    for (model, scene) in models {
        let mut contact = model.prepare(&scene, 0).unwrap();
        let small = contact.normalisation().contact_modulus * 1e-3;
        for load in [Load::force(0.0), Load::approach(0.0), Load::force(-0.0)] {
            let state = contact.solve(load).unwrap();
            let numbers = [state.force, state.approach.unwrap(), state.stiffness.unwrap()];
            assert!(numbers.iter().all(|x| *x == 0.0), "{}: {state:?}", model.name());
            // And the next one is none the worse.
            assert!(contact.solve(Load::force(small)).unwrap().stiffness.unwrap() > 0.0);
        }
        for value in [-1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for load in [Load::force(value), Load::approach(value)] {
                let error = contact.solve(load).unwrap_err();
                assert!(matches!(error, Error::Domain { .. }), "{} {load:?}: {error}", model.name());
            }
        }
        assert!(contact.solve(Load::force(small)).is_ok());
    }
}

/// A tolerance that double precision cannot reach is never reported as converged.
#[test]
fn an_unattainable_tolerance_is_an_error() {
    let rough = scene(rough_map(2.2, 65, 4).unwrap());
    for method in METHODS {
        let model = Bem3d { tolerance: 1e-17, method, ..Bem3d::default() };
        for force in [0.1, 1.0, 20.0] {
            match model.prepare(&rough, 0).unwrap().solve(Load::force(force)) {
                Err(Error::NotConverged { best }) => {
                    assert_ne!(best.report.status, Status::Converged);
                    assert!(!best.report.certificate.meets(1e-17));
                    // As good as it gets is still good.
                    assert!(best.report.certificate.meets(1e-8), "{:?}", best.report);
                }
                other => panic!("{method:?}, F {force}: {other:?}"),
            }
        }
        for tolerance in [0.0, -1.0, 1.0, f64::NAN, f64::INFINITY] {
            let refused = Bem3d { tolerance, ..model }.prepare(&rough, 0);
            assert!(matches!(refused, Err(Error::Domain { .. })), "tolerance {tolerance}");
        }
    }
}

/// With too few rounds the result is an error with the best state.
#[test]
fn too_few_rounds_are_an_error_or_enough() {
    let rough = scene(rough_map(2.2, 65, 4).unwrap());
    let exact = press(&rough_map(2.2, 65, 4).unwrap(), Load::force(1.0));
    for rounds in 0..12 {
        let model = Bem3d { tolerance: TOLERANCE, max_outer_iterations: rounds, ..Bem3d::default() };
        match model.prepare(&rough, 0).unwrap().solve(Load::force(1.0)) {
            Ok(state) => {
                assert_relative_eq!(state.stiffness.unwrap(), exact.stiffness.unwrap(), max_relative = SAME);
            }
            Err(Error::NotConverged { best }) => assert_ne!(best.report.status, Status::Converged),
            Err(other) => panic!("{rounds} outer iterations: {other}"),
        }
    }
}

/// A solve stopped after any number of polls is an error, and the next solve is not affected.
#[test]
fn a_stopped_solve_is_an_error_and_does_not_affect_the_next() {
    let rough = scene(rough_map(2.2, 65, 4).unwrap());
    let exact = press(&rough_map(2.2, 65, 4).unwrap(), Load::force(1.0));
    let model = Bem3d { tolerance: TOLERANCE, ..Bem3d::default() };
    let mut contact = model.prepare(&rough, 0).unwrap();
    for patience in (0..20).chain((20..400).step_by(20)) {
        let asked = Cell::new(0);
        let stop = || {
            asked.set(asked.get() + 1);
            asked.get() > patience
        };
        match contact.solve_until(Load::force(1.0), &stop) {
            Err(Error::Stopped { best }) => {
                assert!(best.is_none_or(|b| b.report.status == Status::Stopped));
            }
            Ok(state) => {
                assert_relative_eq!(state.stiffness.unwrap(), exact.stiffness.unwrap(), max_relative = SAME);
            }
            Err(other) => panic!("patience {patience}: {other}"),
        }
        if patience % 7 == 0 {
            let state = contact.solve(Load::force(1.0)).unwrap();
            assert_relative_eq!(state.stiffness.unwrap(), exact.stiffness.unwrap(), max_relative = SAME);
        }
    }
    for model in [&Mdr1d::default() as &dyn ContactModel, &analytic::PowerLaw] {
        let scene = Scene::new(Surface::SelfAffine(rough_surface()), 1.0);
        let stopped = model.prepare(&scene, 0).unwrap().solve_until(Load::force(1e-3), &|| true);
        assert!(matches!(stopped, Err(Error::Stopped { .. })));
    }
    let stopped = model.prepare(&rough, 0).unwrap().solve_until(Load::force(1.0), &|| true);
    assert!(matches!(stopped, Err(Error::Stopped { .. })));
}

fn rough_surface() -> SelfAffine {
    rough(2.4).unwrap()
}

#[test]
fn heights_that_are_no_numbers_are_refused_with_their_position() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let heights = map(5, 1.0, |x, y| if (x, y) == (3, 1) { bad } else { 0.0 });
        let text = heights.unwrap_err().to_string();
        assert!(text.starts_with("heights[1, 3] = "), "{text}");
    }
    assert!(matches!(HeightMap::new(2, 1.0, vec![0.0; 6]), Err(Error::Shape { .. })));
    for contact_modulus in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let mut scene = scene(map(3, 1.0, |_, _| 0.0).unwrap());
        scene.contact_modulus = contact_modulus;
        assert!(matches!(Bem3d::default().prepare(&scene, 0), Err(Error::Domain { .. })));
    }
    let none = Bem3d { cells: 0, ..Bem3d::default() };
    for surface in [Surface::Flat { size: 1.0.into() }, Surface::SelfAffine(rough_surface())] {
        assert!(matches!(none.prepare(&Scene::new(surface, 1.0), 0), Err(Error::Domain { .. })));
    }
}
