//! Hardness together with adhesion of finite range: limits, closed forms, the balance of energy.

#![allow(clippy::unwrap_used)] // Helpers of tests.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Boundary, ContactModel, ContactState, Hardness, Load, Outputs, Scene,
    SelfAffine, Step, Surface,
};

const RANGE: f64 = 0.02;

/// A rough surface with sides of 1 and heights of 0.01 on 32 cells a side.
fn scene(hardness: Option<f64>, work: f64, law: AdhesionLaw, boundary: Boundary) -> Scene {
    let mut surface = SelfAffine::new(2.2, 1.0, 0.01).unwrap();
    surface.short_cutoff = Some(50.0);
    let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
    scene.effects.boundary = boundary;
    if work > 0.0 {
        scene.effects.adhesion = Adhesion::FiniteRange { work, range: RANGE, law };
    }
    if let Some(pressure) = hardness {
        scene.effects.hardness = Hardness::Limit { pressure };
    }
    scene.outputs = Outputs { area: true, pressure: true, gap: true, ..Outputs::default() };
    scene
}

const MODEL: Bem3d = Bem3d { cells: 32, tolerance: 1e-8, max_outer_iterations: 400, ..Bem3d::DEFAULT };

fn path(scene: &Scene, loads: &[Load]) -> Vec<ContactState> {
    let mut contact = MODEL.prepare(scene, 2).unwrap();
    let steps = loads.iter().enumerate();
    steps.map(|(i, load)| contact.advance(Step::new(i as f64, *load)).unwrap()).collect()
}

fn approaches(values: &[f64]) -> Vec<Load> {
    values.iter().map(|d| Load::approach(*d)).collect()
}

const LAWS: [AdhesionLaw; 2] = [AdhesionLaw::Exponential, AdhesionLaw::Dugdale];
const PATH: [f64; 6] = [-0.005, 0.01, 0.03, 0.02, 0.005, -0.01];

/// Where no pressure reaches the hardness the states are those without one. They are found by another kind of
/// update, so that they agree to the tolerance.
#[test]
fn a_large_hardness_gives_the_states_without() {
    for law in LAWS {
        let hard = path(&scene(Some(1e3), 1e-4, law, Boundary::Free), &approaches(&PATH));
        let elastic = path(&scene(None, 1e-4, law, Boundary::Free), &approaches(&PATH));
        for (a, b) in hard.iter().zip(&elastic) {
            assert!((a.force - b.force).abs() < 1e-5 * b.force.abs().max(1e-4), "{} {}", a.force, b.force);
            assert_eq!(a.area, b.area);
            assert!(a.plastic.as_ref().unwrap().volume == 0.0);
            assert_eq!(a.adhesive.as_ref().unwrap().branch, b.adhesive.as_ref().unwrap().branch);
        }
    }
}

/// With less and less work the states tend to those of the hardness alone, in first order.
#[test]
fn without_work_the_states_are_those_of_the_hardness() {
    for law in LAWS {
        let plastic = path(&scene(Some(0.05), 0.0, law, Boundary::Free), &approaches(&PATH[1..5]));
        let difference = |work: f64| {
            let states = path(&scene(Some(0.05), work, law, Boundary::Free), &approaches(&PATH[1..5]));
            let pairs = states.iter().zip(&plastic);
            pairs.fold(0.0, |most: f64, (a, b)| most.max((a.force - b.force).abs()))
        };
        let (one, two) = (difference(1e-5), difference(1e-7));
        assert!(two < 2e-2 * one, "{law:?}: {one} {two}");
    }
}

/// The net pressure never exceeds the hardness. Where all of the contact flows, the force and the attraction of
/// open cells are together the hardness times its area.
#[test]
fn a_contact_that_flows_bears_the_hardness_on_its_area() {
    let hardness = 1e-3;
    for law in LAWS {
        for boundary in [Boundary::Free, Boundary::Periodic] {
            let scene = scene(Some(hardness), 5e-6, law, boundary);
            for state in path(&scene, &[Load::force(2e-4), Load::force(5e-4)]) {
                let cell = 1.0 / 1024.0;
                let pressures = state.pressure().unwrap().values();
                assert!(pressures.iter().all(|p| *p <= hardness * (1.0 + 1e-9)));
                let attracted: f64 = pressures.iter().map(|p| (-p).max(0.0)).sum::<f64>() * cell;
                let flowing = state.plastic.as_ref().unwrap().area;
                let area = state.area.unwrap();
                // Cells at the edge of the contact bear less.
                assert!(flowing > 0.8 * area, "{law:?} {flowing} {area}");
                let borne = state.force + attracted;
                assert!(
                    borne <= hardness * area * (1.0 + 1e-9) && borne >= hardness * flowing * (1.0 - 1e-9)
                );
            }
        }
    }
}

/// The work done is the stored energy, with that of the attraction, and what the flow took.
#[test]
fn work_is_stored_or_taken_by_the_flow() {
    let there = (0..=160).map(|i| -0.04 + 0.07 * f64::from(i) / 160.0);
    let back = (1..=200).map(|i| 0.03 - 0.09 * f64::from(i) / 200.0);
    let values: Vec<f64> = there.chain(back).collect();
    let scene = scene(Some(0.05), 1e-4, AdhesionLaw::Exponential, Boundary::Free);
    let states = path(&scene, &approaches(&values));
    let energy = |state: &ContactState| {
        state.adhesive.as_ref().unwrap().energy.unwrap() + state.plastic.as_ref().unwrap().dissipated
    };
    let (mut work, mut largest) = (0.0, 0.0_f64);
    for (pair, d) in states.windows(2).zip(values.windows(2)) {
        work += f64::midpoint(pair[0].force, pair[1].force) * (d[1] - d[0]);
        largest = largest.max(work.abs());
        let change = energy(&pair[1]) - energy(&states[0]);
        assert!((change - work).abs() < 5e-3 * largest, "at {}: {change} {work}", d[1]);
    }
    assert!(states.last().unwrap().plastic.as_ref().unwrap().volume > 1e-5);
}

/// A single pull is the end of a path that begins without a force: what flows there stays.
#[test]
fn a_single_pull_is_the_end_of_a_path() {
    for law in LAWS {
        let scene = scene(Some(2e-3), 1e-4, law, Boundary::Free);
        let loads = [Load::force(0.0), Load::force(-1e-5)];
        let states = path(&scene, &loads);
        assert!(states[0].plastic.as_ref().unwrap().volume > 0.0);
        let mut contact = MODEL.prepare(&scene, 2).unwrap();
        for _ in 0..2 {
            let single = contact.solve(loads[1]).unwrap();
            assert_eq!(
                (single.force, single.area, single.plastic),
                (states[1].force, states[1].area, states[1].plastic)
            );
            // The next one begins with the virgin surface again.
            contact.solve(Load::force(1e-3)).unwrap();
        }
    }
}

/// A contact that has flowed fits better, and holds more when it is pulled off.
#[test]
fn what_has_flowed_holds_more() {
    let pulled: Vec<f64> = (0..=30).map(|i| 0.03 - 0.003 * f64::from(i)).collect();
    let most = |hardness: Option<f64>| {
        let scene = scene(hardness, 1e-4, AdhesionLaw::Exponential, Boundary::Free);
        path(&scene, &approaches(&pulled)).iter().fold(0.0, |most: f64, state| most.min(state.force))
    };
    let (elastic, flowed) = (most(None), most(Some(0.05)));
    assert!(flowed < 1.05 * elastic, "{elastic} {flowed}");
}

/// The stiffness is the slope of the force along the path, on the way in, where cells flow, and on the way out, where
/// none does; that of the held area is the slope between states without new contact, which is steeper.
#[test]
fn the_stiffness_is_a_difference_quotient() {
    let mut scene = scene(Some(0.05), 1e-4, AdhesionLaw::Exponential, Boundary::Free);
    (scene.outputs.stiffness, scene.outputs.stiffness_fixed_area) = (true, true);
    let step = 1e-6;
    for turn in [0.03, 0.02] {
        for (from, sign) in [(turn, 1.0), (turn - 0.004, -1.0)] {
            let mut loads = approaches(&[0.01, 0.015, turn]);
            if sign < 0.0 {
                loads.push(Load::approach(from));
            }
            loads.push(Load::approach(from + sign * step));
            let states = path(&scene, &loads);
            let [.., before, after] = &states[..] else { unreachable!() };
            let quotient = (after.force - before.force) / (sign * step);
            let slope = before.stiffness.unwrap();
            assert!((slope / quotient - 1.0).abs() < 1e-3, "{turn} {sign}: {slope} {quotient}");
            assert!(before.stiffness_fixed_area.unwrap() > 0.0);
            assert_eq!(before.plastic.as_ref().unwrap().area > 0.0, sign > 0.0);
        }
    }
}

/// At the mean gap that a force has left, the force is the same: with cells that flow, and on the way back.
#[test]
fn a_mean_gap_is_that_of_its_force() {
    for law in LAWS {
        let mut scene = scene(Some(0.02), 5e-6, law, Boundary::Periodic);
        scene.outputs.mean_gap = true;
        let forces = path(&scene, &[1e-4, 1e-3, 5e-3, 2e-3].map(Load::force));
        let gaps: Vec<Load> = forces.iter().map(|state| Load::mean_gap(state.mean_gap.unwrap())).collect();
        let states = path(&scene, &gaps);
        assert!(forces.last().unwrap().plastic.as_ref().unwrap().volume > 0.0);
        for (state, asked) in states.iter().zip(&forces) {
            let error = state.report.certificate.force_error.unwrap();
            let differs = (state.force / asked.force - 1.0).abs();
            // The mean gap of a prescribed force is known to the tolerance.
            assert!(error < 1e-3 && differs < error.clamp(1e-8, 1e-6), "{law:?} {differs} {error}");
            assert!((state.mean_gap.unwrap() - asked.mean_gap.unwrap()).abs() < 1e-15, "{law:?}");
            let [here, there] = [state, asked].map(|of| of.plastic.as_ref().unwrap().volume);
            assert!((here - there).abs() <= 1e-6 * there, "{law:?} {here} {there}");
        }
    }
}

/// At mean gaps too, a hardness that is never reached changes nothing.
#[test]
fn a_large_hardness_changes_no_state_at_a_mean_gap() {
    let gaps = [0.04, 0.03, 0.02, 0.025, 0.05].map(Load::mean_gap);
    let law = AdhesionLaw::Exponential;
    let hard = path(&scene(Some(1e3), 1e-4, law, Boundary::Periodic), &gaps);
    let elastic = path(&scene(None, 1e-4, law, Boundary::Periodic), &gaps);
    for (a, b) in hard.iter().zip(&elastic) {
        assert!((a.force - b.force).abs() < 1e-5 * b.force.abs().max(1e-4), "{} {}", a.force, b.force);
        assert_eq!(a.area, b.area);
    }
}

/// The stiffness at a mean gap is the slope of the force, where cells flow and on the way back.
#[test]
fn the_stiffness_at_a_mean_gap_is_a_difference_quotient() {
    let mut scene = scene(Some(0.05), 1e-4, AdhesionLaw::Exponential, Boundary::Periodic);
    scene.outputs.stiffness = true;
    let step = 1e-6;
    for (loads, sign) in [(vec![0.03, 0.022], -1.0), (vec![0.03, 0.02, 0.022], 1.0)] {
        let last = loads.last().unwrap() + sign * step;
        let gaps: Vec<Load> = loads.into_iter().chain([last]).map(Load::mean_gap).collect();
        let [.., before, after] = &path(&scene, &gaps)[..] else { unreachable!() };
        let quotient = (before.force - after.force) / (sign * step);
        let slope = before.stiffness.unwrap();
        assert!((slope / quotient - 1.0).abs() < 1e-3, "{sign}: {slope} {quotient}");
    }
}

#[test]
fn adhesion_of_short_range_is_refused() {
    let mut short = scene(Some(0.05), 1e-4, AdhesionLaw::Exponential, Boundary::Periodic);
    short.effects.adhesion = Adhesion::ShortRange { work: 1e-4 };
    assert!(MODEL.prepare(&short, 2).err().unwrap().to_string().contains("short range"));
}
