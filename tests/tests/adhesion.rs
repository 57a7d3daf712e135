//! Adhesion: two independent codes for the sphere.

use analytic::Jkr;
use approx::assert_relative_eq;
use contact_model::{Adhesion, ContactModel, ContactState, Load, Scene, Surface};
use mdr1d::Mdr1d;

/// Both are closed or iterated to rounding; a tenth away from a fold a root loses one digit.
const EXACT: f64 = 1e-12;

fn press(model: &dyn ContactModel, work: f64, load: Load) -> ContactState {
    let mut scene = Scene::new(Surface::Sphere { radius: 1.3, size: 2.0.into() }, 0.7);
    scene.effects.adhesion = Adhesion::ShortRange { work };
    scene.outputs.area = true;
    model.prepare(&scene, 0).unwrap().solve(load).unwrap()
}

#[test]
fn mdr_is_jkr_for_a_sphere() {
    for work in [0.0, 1e-12, 1e-6, 1e-3, 1e-2] {
        let pull_off = 1.5 * std::f64::consts::PI * work * 1.3;
        for force in [-0.9 * pull_off, 0.0, 0.1 * pull_off, 1e-6, 0.05] {
            let (one, other) =
                (press(&Jkr, work, Load::Force(force)), press(&Mdr1d::default(), work, Load::Force(force)));
            assert_relative_eq!(one.area.unwrap(), other.area.unwrap(), max_relative = EXACT);
            assert_relative_eq!(one.stiffness.unwrap(), other.stiffness.unwrap(), max_relative = EXACT);
            let d = one.approach.unwrap();
            assert_relative_eq!(
                d,
                other.approach.unwrap(),
                max_relative = EXACT,
                epsilon = EXACT * one.area.unwrap()
            );
            let (one, other) =
                (press(&Jkr, work, Load::Approach(d)), press(&Mdr1d::default(), work, Load::Approach(d)));
            assert_relative_eq!(one.force, other.force, max_relative = EXACT, epsilon = EXACT * pull_off);
        }
    }
}

/// Models of adhesion.
fn models() -> [(&'static dyn ContactModel, &'static str); 2] {
    [(&Jkr, "jkr"), (&Mdr1d { elements: 1 }, "mdr1d")]
}

const RADIUS: f64 = 1.3;
const MODULUS: f64 = 0.7;

/// Elastic energy of a sphere in contact, `(E*/2) int_-a^a (d - x^2/R)^2 dx`.
fn elastic_energy(d: f64, a: f64) -> f64 {
    MODULUS * (d * d * a - 2.0 * d * a.powi(3) / (3.0 * RADIUS) + a.powi(5) / (5.0 * RADIUS * RADIUS))
}

#[test]
fn force_is_the_slope_of_elastic_and_surface_energy() {
    // U = U_el - w A along the equilibrium, F = dU/dd: the whole of JKR in one sentence. A central difference of second order.
    let work = 1e-3;
    for (model, name) in models() {
        let energy = |d: f64| {
            let area = press(model, work, Load::Approach(d)).area.unwrap();
            elastic_energy(d, (area / std::f64::consts::PI).sqrt()) - work * area
        };
        for d in [-0.005, 0.0, 0.01, 0.1] {
            let force = press(model, work, Load::Approach(d)).force;
            let slope = |step: f64| (energy(d + step) - energy(d - step)) / (2.0 * step);
            let (coarse, fine) = (slope(4e-4) - force, slope(1e-4) - force);
            let scale = force.abs().max(work);
            assert!(fine.abs() < 1e-4 * scale, "{name} {d}: {fine:e}");
            assert!(fine.abs() < 0.1 * coarse.abs() || fine.abs() < 1e-9, "{name} {d}: {coarse:e} {fine:e}");
        }
    }
}

#[test]
fn without_work_of_adhesion_it_is_hertz() {
    // a^3 = (3R/4E*) (F + 3 pi w R + sqrt(6 pi w R F + ...)): the difference falls as sqrt(w). The approach is the slope of an energy
    // that a itself leaves stationary: there it is w dA/dF, of first order.
    let force = 0.01;
    let elastic = press(&Jkr, 0.0, Load::Force(force));
    for (model, name) in models() {
        let difference = |work: f64| {
            let state = press(model, work, Load::Force(force));
            [
                state.area.unwrap() / elastic.area.unwrap() - 1.0,
                state.stiffness.unwrap() / elastic.stiffness.unwrap() - 1.0,
                state.approach.unwrap() / elastic.approach.unwrap() - 1.0,
            ]
        };
        let works = [1e-8, 1e-10, 1e-12];
        let all = works.map(difference);
        for (which, fall) in [(0, 10.0), (1, 10.0), (2, 100.0)] {
            for pair in all.windows(2) {
                let ratio = pair[0][which] / pair[1][which];
                // But for terms of the next order in sqrt(w), and the rounding of a difference of 1e-10.
                assert!(pair[1][which] > 0.0 && (ratio / fall - 1.0).abs() < 0.01, "{name} {which}: {ratio}");
            }
        }
        let off = press(model, 0.0, Load::Force(force));
        assert_relative_eq!(off.area.unwrap(), elastic.area.unwrap(), max_relative = EXACT);
        assert_relative_eq!(off.approach.unwrap(), elastic.approach.unwrap(), max_relative = EXACT);
    }
}

#[test]
fn adhesion_draws_in_and_holds_more_the_stronger_it_is() {
    for (model, name) in models() {
        let states = [0.0, 1e-6, 1e-4, 1e-2].map(|work| press(model, work, Load::Force(0.01)));
        for pair in states.windows(2) {
            assert!(pair[1].area > pair[0].area && pair[1].approach > pair[0].approach, "{name}");
        }
        let states = [0.0, 1e-6, 1e-4, 1e-2].map(|work| press(model, work, Load::Approach(0.01)));
        assert!(states.windows(2).all(|pair| pair[1].force < pair[0].force), "{name}");
    }
}
