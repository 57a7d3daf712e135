//! Friction: the reduction to one dimension (springs) compared with the closed form of the sphere.

use analytic::{CattaneoMindlin, Hertz};
use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{
    Body, ContactModel, ContactState, Error, Friction, Load, Pair, PreparedContact, Scene, Step, Surface,
    Tangential,
};
use mdr1d::PartialSlip;

/// Rounding of a root in each, and of energies that are small differences near the first reversal.
const EXACT: f64 = 1e-9;

#[test]
fn springs_are_cattaneo_and_mindlin_and_deresiewicz() {
    let steel = Body::Elastic { young: 210.0, poisson: 0.3 };
    let rubber = Body::Elastic { young: 0.01, poisson: 0.5 };
    for pair in [
        Pair { first: steel, second: steel },
        Pair { first: Body::Rigid, second: rubber },
        Pair { first: steel, second: rubber },
    ] {
        let mut scene = Scene::of_pair(Surface::Sphere { radius: 2.0, size: 3.0.into() }, pair).unwrap();
        scene.effects.friction = Friction::coulomb(0.35);
        let models: [&dyn ContactModel; 2] = [&CattaneoMindlin, &PartialSlip];
        let [mut closed, mut springs] = models.map(|model| model.prepare(&scene, 0).unwrap());
        let normal = Load::approach(0.01);
        let limit = 0.35 * closed.advance(Step::new(0.0, normal)).unwrap().force;
        springs.advance(Step::new(0.0, normal)).unwrap();
        // Turns inside turns, loops that close, gross slip and back.
        let shares = [0.5, 0.8, -0.2, 0.3, -0.1, 0.9, -0.9, 0.0, 0.95, -1.0, 0.4, 1.0, 0.0];
        for (i, share) in shares.into_iter().enumerate() {
            let step = Step::new(i as f64, normal.with_tangential(Tangential::force_along_x(share * limit)));
            let [one, other] = [&mut closed, &mut springs].map(|history| history.advance(step).unwrap());
            assert_relative_eq!(
                one.contact_radius.unwrap(),
                other.contact_radius.unwrap(),
                max_relative = 1e-13
            );
            let (one, other) = (one.tangential.unwrap(), other.tangential.unwrap());
            let reach = 0.75 * limit / (scene.contact_modulus * 0.1);
            assert_relative_eq!(
                one.displacement[0],
                other.displacement[0],
                max_relative = EXACT,
                epsilon = EXACT * reach
            );
            assert_relative_eq!(
                one.dissipated,
                other.dissipated,
                max_relative = EXACT,
                epsilon = EXACT * limit * reach
            );
            if share.abs() < 1.0 {
                assert_relative_eq!(
                    one.stick_radius.unwrap(),
                    other.stick_radius.unwrap(),
                    max_relative = 1e-6
                );
            }
        }
    }
}

/// A sphere, pressed and sheared; both models with a coefficient.
fn models(coefficient: f64) -> [Box<dyn PreparedContact>; 2] {
    let scene = &scene(coefficient);
    [&CattaneoMindlin as &dyn ContactModel, &PartialSlip].map(|model| model.prepare(scene, 0).unwrap())
}

fn scene(coefficient: f64) -> Scene {
    let body = Body::Elastic { young: 2.0, poisson: 0.3 };
    let pair = Pair { first: body, second: body };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 2.0, size: 3.0.into() }, pair).unwrap();
    scene.effects.friction = Friction::coulomb(coefficient);
    scene
}

/// G*/E* = (2 - 2 nu)/(2 - nu).
const SHEAR: f64 = 1.4 / 1.7;
const D: f64 = 0.01;

fn shear(history: &mut dyn PreparedContact, tangential: Tangential) -> ContactState {
    history.advance(Step::new(0.0, Load::approach(D).with_tangential(tangential))).unwrap()
}

#[test]
fn without_slip_it_is_mindlins_stiffness() {
    // mu -> infinity: T = 2 G* a u, nothing lost; T/(2 G* a u) = 1 - u G*/(4 mu E* d) + ..., so the
    // difference falls as 1/mu.
    let u = 1e-3;
    let deviations = [1e2, 1e3, 1e4].map(|coefficient| {
        models(coefficient).map(|mut history| {
            let normal = shear(&mut *history, Tangential::force_along_x(0.0));
            let state = shear(&mut *history, Tangential::displacement_along_x(u));
            let tangential = state.tangential.unwrap();
            let sticking = SHEAR * normal.stiffness.unwrap() * u;
            assert!(tangential.dissipated >= 0.0 && tangential.dissipated <= sticking * u / coefficient);
            assert_relative_eq!(
                tangential.stick_radius.unwrap(),
                state.contact_radius.unwrap(),
                max_relative = u * SHEAR / (coefficient * D)
            );
            1.0 - tangential.force[0] / sticking
        })
    });
    for (i, coefficient) in [1e2, 1e3, 1e4].into_iter().enumerate() {
        for deviation in deviations[i] {
            // Second order of u/(mu d) is left out.
            let expected = 0.25 * u * SHEAR / (coefficient * D);
            assert_relative_eq!(deviation, expected, max_relative = 1e-3, epsilon = 1e-12);
        }
    }
}

#[test]
fn small_friction_leads_to_gross_slip_and_zero_friction_to_no_force() {
    // mu -> 0: T = mu F for any stroke, and mu F (u - ...) is lost.
    let u = 1e-3;
    for coefficient in [1e-3, 1e-6] {
        for mut history in models(coefficient) {
            let force = shear(&mut *history, Tangential::force_along_x(0.0)).force;
            let tangential = shear(&mut *history, Tangential::displacement_along_x(u)).tangential.unwrap();
            assert_relative_eq!(tangential.force[0], coefficient * force, max_relative = EXACT);
            assert!(tangential.stick_radius.unwrap() <= 0.0);
            let reach = coefficient * D / SHEAR;
            assert!(tangential.dissipated < tangential.force[0] * u);
            assert!(tangential.dissipated > tangential.force[0] * (u - reach));
        }
    }
    // The closed form divides by mu and refuses 0; the springs do not.
    assert!(CattaneoMindlin.prepare(&scene(0.0), 0).is_err());
    let mut smooth = PartialSlip.prepare(&scene(0.0), 0).unwrap();
    shear(&mut *smooth, Tangential::force_along_x(0.0));
    let tangential = shear(&mut *smooth, Tangential::displacement_along_x(u)).tangential.unwrap();
    assert!(tangential.force[0].abs() <= 0.0 && tangential.dissipated <= 0.0);
}

#[test]
fn work_along_any_path_is_stored_or_lost() {
    // What friction has lost never falls and never exceeds the work done; after a closed loop of u at T = T
    // the work is the loss.
    for mut history in models(0.4) {
        let force = shear(&mut *history, Tangential::force_along_x(0.0)).force;
        let reach = 0.4 * D / SHEAR;
        let (mut work, mut lost, mut last) = (0.0, 0.0, [0.0, 0.0]);
        let segments = 200;
        let mut loops = Vec::new();
        for turn in [0.7, -0.5, 0.9, -0.9, 0.9] {
            let begin = last[0];
            for i in 1..=segments {
                let u = begin + (turn * reach - begin) * f64::from(i) / f64::from(segments);
                let tangential =
                    shear(&mut *history, Tangential::displacement_along_x(u)).tangential.unwrap();
                work += 0.5 * (tangential.force[0] + last[1]) * (u - last[0]);
                assert!(tangential.dissipated >= lost - EXACT * force * reach);
                assert!(tangential.dissipated <= work + 1e-4 * force * reach);
                assert!(tangential.force[0].abs() <= 0.4 * force * (1.0 + EXACT));
                lost = tangential.dissipated;
                last = [u, tangential.force[0]];
            }
            loops.push([work, lost]);
        }
        // From 0.9 to 0.9: a closed loop. Trapezia of 200 segments, second order.
        let [one, other] = [loops[2], loops[4]];
        assert_relative_eq!(other[0] - one[0], other[1] - one[1], max_relative = 1e-4);
    }
}

/// A single load may have a tangential part: it is the first step of a path, and refused without friction.
#[test]
fn a_single_load_is_one_step_of_both_loads() {
    let steel = Body::Elastic { young: 210.0, poisson: 0.3 };
    let pair = Pair { first: steel, second: steel };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 2.0, size: 1.0.into() }, pair).unwrap();
    let load = Load::approach(0.01).with_tangential(Tangential::displacement_along_x(1e-3));
    let cells = Bem3d { cells: 17, ..Bem3d::default() };
    let models: [&dyn ContactModel; 3] = [&cells, &CattaneoMindlin, &PartialSlip];
    for model in models.into_iter().take(1).chain([&Hertz as &dyn ContactModel]) {
        let refused = model.prepare(&scene, 0).unwrap().solve(load).unwrap_err();
        assert!(matches!(refused, Error::Unsupported { .. }), "{refused}");
    }
    scene.effects.friction = Friction::coulomb(0.35);
    for model in models {
        let mut contact = model.prepare(&scene, 0).unwrap();
        let step = contact.advance(Step::new(0.0, load)).unwrap();
        let single = contact.solve(load).unwrap();
        assert_eq!(single.tangential, step.tangential, "{}", model.name());
        assert_eq!((single.force, single.time), (step.force, None), "{}", model.name());
        // The path goes on from the single load.
        let again = contact.advance(Step::new(1.0, load)).unwrap().tangential.unwrap();
        assert_relative_eq!(again.force[0], step.tangential.unwrap().force[0], max_relative = 1e-5);
        assert!(single.tangential.unwrap().force[0] > 0.0);
    }
}
