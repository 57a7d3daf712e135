use super::*;
use approx::assert_relative_eq;
use contact_model::{Adhesion, Body, Effects, Friction, Load, Pair, SelfAffine, Step, Surface};

/// A root of a function that is known to a dozen digits.
const ROOT: f64 = 1e-11;

fn scene(surface: Surface, mu: f64) -> Scene {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 0.75, poisson: 0.5 } };
    let mut scene = Scene::of_pair(surface, pair).unwrap();
    scene.effects.friction = Friction::coulomb(mu);
    scene
}

fn sphere(length: f64) -> Surface {
    Surface::Sphere { radius: length, size: (2.0 * length).into() }
}

fn step(normal: f64, tangential: Tangential) -> Step {
    Step::new(0.0, Load::force(normal).with_tangential(tangential))
}

#[test]
fn reference_numbers_in_any_units() {
    for length in [1.0, 1e-100, 1e100] {
        let mut scene = scene(sphere(length), 0.4);
        scene.outputs.area = true;
        let mut contact = PartialSlip.prepare(&scene, 0).unwrap();
        // F in E* R^2.
        let force = 0.01 * length * length;
        for (share, ratio) in [(0.25, 0.908_560_296_4), (0.5, 0.793_700_526_0), (0.9, 0.464_158_883_4)] {
            contact.restart();
            contact.advance(Step::new(0.0, Load::force(force))).unwrap();
            let state = contact.advance(step(force, Tangential::force_along_x(share * 0.4 * force))).unwrap();
            let (a, tangential) = (state.contact_radius.unwrap(), state.tangential.unwrap());
            assert_relative_eq!(tangential.stick_radius.unwrap() / a, ratio, max_relative = 1e-9);
            // u = 3 mu F/(4 G* a) (1 - (c/a)^2), G* = (2/3) E*.
            let u = 0.75 * 0.4 * force / (2.0 / 3.0 * a) * (1.0 - ratio * ratio);
            assert_relative_eq!(tangential.displacement[0], u, max_relative = 1e-9);
            assert_relative_eq!(state.area.unwrap(), std::f64::consts::PI * a * a, max_relative = 1e-14);
        }
    }
}

#[test]
fn force_and_displacement_drive_the_same_path() {
    for surface in [
        sphere(1.0),
        Surface::Cone { slope: 0.3, size: 2.0.into() },
        Surface::PowerLaw { coefficient: 1.0, exponent: 0.6, size: 2.0.into() },
        Surface::FlatCircle { radius: 0.3, size: 2.0.into() },
    ] {
        let scene = scene(surface, 0.3);
        let (mut by_force, mut by_displacement) =
            (PartialSlip.prepare(&scene, 0).unwrap(), PartialSlip.prepare(&scene, 0).unwrap());
        for (normal, share) in
            [(0.01, 0.0), (0.01, 0.5), (0.02, 0.1), (0.02, -0.8), (0.005, -0.3), (0.005, 0.9), (0.0, 0.0)]
        {
            let one =
                by_force.advance(step(normal, Tangential::force_along_x(share * 0.3 * normal))).unwrap();
            let u = one.tangential.unwrap().displacement[0];
            let other = by_displacement.advance(step(normal, Tangential::displacement_along_x(u))).unwrap();
            let (one, other) = (one.tangential.unwrap(), other.tangential.unwrap());
            assert_relative_eq!(one.force[0], other.force[0], max_relative = ROOT, epsilon = ROOT * 0.01);
            assert_relative_eq!(
                one.dissipated,
                other.dissipated,
                max_relative = 1e-9,
                epsilon = ROOT * one.dissipated.max(1e-6)
            );
        }
    }
}

#[test]
fn the_path_matters() {
    // Sheared at a light load and then pressed is softer than pressed and then sheared: the springs that came
    // later began unstrained.
    let run = |path: &[(f64, f64)]| {
        let mut contact = PartialSlip.prepare(&scene(sphere(1.0), 0.5), 0).unwrap();
        let steps: Vec<Step> =
            path.iter().map(|&(normal, u)| step(normal, Tangential::displacement_along_x(u))).collect();
        contact.follow(&steps).unwrap().pop().unwrap().tangential.unwrap().force[0]
    };
    let pressed_first = run(&[(0.02, 0.0), (0.02, 1e-3)]);
    let sheared_first = run(&[(0.002, 0.0), (0.002, 1e-3), (0.02, 1e-3)]);
    assert!(sheared_first < 0.6 * pressed_first);
}

#[test]
fn limits_and_failures() {
    let mut contact = PartialSlip.prepare(&scene(sphere(1.0), 0.4), 0).unwrap();
    let full = contact.advance(step(0.01, Tangential::force_along_x(0.004))).unwrap().tangential.unwrap();
    assert!(full.stick_radius.unwrap() <= 1e-9);
    let before = full;
    let error = contact.advance(step(0.01, Tangential::force_along_x(0.0041))).unwrap_err();
    assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("slips as a whole"));
    assert!(contact.advance(step(0.0, Tangential::force_along_x(1e-9))).is_err());
    assert!(contact.advance(step(1e3, Tangential::force_along_x(0.0))).is_err());
    // Failures leave no trace.
    assert_eq!(
        contact.advance(step(0.01, Tangential::force_along_x(0.004))).unwrap().tangential.unwrap(),
        before
    );
    // Without friction there is no tangential force.
    let mut smooth = PartialSlip.prepare(&scene(sphere(1.0), 0.0), 0).unwrap();
    let state =
        smooth.advance(step(0.01, Tangential::displacement_along_x(0.1))).unwrap().tangential.unwrap();
    assert!(state.force[0].abs() <= 0.0 && state.dissipated <= 0.0 && state.stick_radius.unwrap() <= 0.0);
    assert!(smooth.advance(step(0.01, Tangential::force_along_x(0.0))).is_ok());
}

#[test]
fn what_the_model_lacks_is_refused() {
    let refused = |scene: &Scene| matches!(PartialSlip.prepare(scene, 0), Err(Error::Unsupported { .. }));
    let rough = Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 0.1).unwrap());
    assert!(refused(&scene(rough, 0.1)) && refused(&scene(Surface::Flat { size: 1.0.into() }, 0.1)));
    assert!(refused(&Scene { pair: None, ..scene(sphere(1.0), 0.1) }));
    let mut other = scene(sphere(1.0), 0.1);
    other.effects.adhesion = Adhesion::ShortRange { work: 0.1 };
    assert!(refused(&other));
    other.effects = Effects::default();
    assert!(refused(&other));
    let mut fields = scene(sphere(1.0), 0.1);
    fields.outputs.gap = true;
    assert!(refused(&fields));
}
