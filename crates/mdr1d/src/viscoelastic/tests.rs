use super::*;
use approx::assert_relative_eq;
use contact_model::{
    Body, Friction, Load, Nondimensionalisation, Pair, PreparedContact, PronySeries, Relaxing, Rheology,
    SelfAffine, Step, Surface, Tangential,
};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

/// Exponentials, roots and sums of some terms.
const ROUNDING: f64 = 1e-12;

#[allow(clippy::large_types_passed_by_value)] // Tests read better so.
fn scene(surface: Surface, rheology: Rheology) -> Scene {
    let mut scene = Scene::new(surface, 4.0);
    scene.effects.rheology = rheology;
    scene.outputs.stiffness = false;
    scene
}

fn sphere() -> Surface {
    Surface::Sphere { radius: 1.0, size: 2.0.into() }
}

#[allow(clippy::large_types_passed_by_value)]
fn prepare(surface: Surface, rheology: Rheology) -> Box<dyn PreparedContact> {
    Viscoelastic.prepare(&scene(surface, rheology), 0).unwrap()
}

fn force(contact: &mut dyn PreparedContact, time: f64, approach: f64) -> f64 {
    contact.advance(Step::new(time, Load::approach(approach))).unwrap().force
}

fn approach(contact: &mut dyn PreparedContact, time: f64, force: f64) -> f64 {
    let state = contact.advance(Step::new(time, Load::force(force))).unwrap();
    assert!(state.report.certificate.load_error < 1e-11);
    state.approach.unwrap()
}

const SOLID: Rheology = Rheology::StandardSolid { arm: Relaxing { weight: 3.0, time: 2.0 } };

#[test]
fn steps_of_the_approach_relax_as_the_modulus() {
    // Sphere: F(t) = (16/3) G(t) sqrt(R) d^1.5, E* = 4 G = 4. Maxwell with eta = 2: exp(-t/2).
    let elastic = 16.0 / 3.0 * 0.01_f64.powf(1.5);
    let moduli: [(Rheology, &dyn Fn(f64) -> f64); 2] = [
        (Rheology::Maxwell { viscosity: 2.0 }, &|t| (-t / 2.0).exp()),
        (SOLID, &|t| 1.0 + 3.0 * (-t / 2.0).exp()),
    ];
    for (rheology, contact_modulus) in moduli {
        let mut contact = prepare(sphere(), rheology);
        for time in [0.0, 0.1, 1.0, 30.0] {
            let expected = elastic * contact_modulus(time);
            assert_relative_eq!(force(&mut *contact, time, 0.01), expected, max_relative = ROUNDING);
        }
    }
    // For ever: elastic.
    let mut contact = prepare(sphere(), SOLID);
    force(&mut *contact, 0.0, 0.01);
    assert_relative_eq!(force(&mut *contact, 1e6, 0.01), elastic, max_relative = ROUNDING);
}

#[test]
fn steps_of_the_force_creep_as_the_compliance() {
    // Lee and Radok: (16/3) sqrt(R) d^1.5 = F J(t), for the standard solid J = 1 - w/(1 + w) exp(-t/(tau (1 +
    // w))) over G.
    let mut contact = prepare(sphere(), SOLID);
    for time in [0.0, 1e-3, 1.0, 8.0, 1e4] {
        let compliance = 1.0 - 0.75 * (-time / 8.0_f64).exp();
        let expected = (0.01 * compliance * 3.0 / 16.0).powf(2.0 / 3.0);
        assert_relative_eq!(approach(&mut *contact, time, 0.01), expected, max_relative = ROUNDING);
    }
    // Maxwell under a cone: J = 1 + t/tau, d a E* = F J with a = 2 d/(pi slope).
    let slope = 0.1;
    let mut contact =
        prepare(Surface::Cone { slope, size: 2.0.into() }, Rheology::Maxwell { viscosity: 2.0 });
    for time in [0.0, 0.5, 7.0] {
        let expected = (1e-3 / 4.0 * (1.0 + time / 2.0) * std::f64::consts::PI * slope / 2.0).sqrt();
        assert_relative_eq!(approach(&mut *contact, time, 1e-3), expected, max_relative = ROUNDING);
    }
}

#[test]
fn ramps_in_closed_form() {
    // Cone, d = v t, Phi = 2 d^2/(pi slope): Maxwell gives E* (4 v^2/(pi slope)) (tau t - tau^2 (1 -
    // exp(-t/tau))).
    let (slope, v, tau) = (0.1, 1e-3, 2.0);
    let cone = Surface::Cone { slope, size: 2.0.into() };
    let factor = 2.0 / (std::f64::consts::PI * slope);
    for time in [1e-4, 0.1, 2.0, 50.0_f64] {
        let mut contact = prepare(cone.clone(), Rheology::Maxwell { viscosity: 2.0 });
        let z: f64 = time / tau;
        // z - 1 + exp(-z), by its series where it cancels.
        let rest = if z < 0.1 {
            z * z
                * (0.5 - z / 6.0 + z * z / 24.0 - z.powi(3) / 120.0 + z.powi(4) / 720.0 - z.powi(5) / 5040.0)
        } else {
            z + (-z).exp_m1()
        };
        let expected = 4.0 * 2.0 * factor * v * v * tau * tau * rest;
        assert_relative_eq!(force(&mut *contact, time, v * time), expected, max_relative = ROUNDING);
        // F = r t: Phi = r (t + t^2/(2 tau)).
        contact.restart();
        let expected = (1e-4 / 4.0 * (time + time * time / (2.0 * tau)) / factor).sqrt();
        assert_relative_eq!(approach(&mut *contact, time, 1e-4 * time), expected, max_relative = ROUNDING);
    }
    // Kelvin-Voigt, cone, d = v t: E* Phi + 4 eta Phi'.
    let mut contact = prepare(cone, Rheology::KelvinVoigt { viscosity: 2.0 });
    let expected = factor * (4.0 * (v * 3.0_f64).powi(2) + 8.0 * 2.0 * v * v * 3.0);
    assert_relative_eq!(force(&mut *contact, 3.0, 3.0 * v), expected, max_relative = ROUNDING);
    // And at rest: elastic at once.
    let held = force(&mut *contact, 4.0, 3.0 * v);
    assert_relative_eq!(held, factor * 4.0 * (3.0 * v) * (3.0 * v), max_relative = ROUNDING);
    assert!(contact.advance(Step::new(4.0, Load::approach(0.1))).is_err());
}

#[test]
fn in_any_units() {
    let run = |length: f64, contact_modulus: f64| {
        let surface = Surface::Sphere { radius: length, size: (2.0 * length).into() };
        let mut scene = Scene::new(surface, contact_modulus);
        scene.effects.rheology = SOLID;
        scene.outputs.stiffness = false;
        let mut contact = Viscoelastic.prepare(&scene, 0).unwrap();
        let nondimensional = Nondimensionalisation::new(contact_modulus, length, length).unwrap();
        let force = nondimensional.force(1e-3).unwrap();
        contact.advance(Step::new(1.0, Load::force(force))).unwrap().approach.unwrap() / length
    };
    for (length, contact_modulus) in [(1e-150, 1e150), (1e150, 1e-150), (1e-3, 1e6)] {
        assert_relative_eq!(run(length, contact_modulus), run(1.0, 1.0), max_relative = ROUNDING);
    }
}

#[test]
fn the_time_of_shrinking_is_named() {
    // Kelvin-Voigt, loaded at once, then the force falls: d grows on until the spring alone would carry the
    // force, F(t) = E* Phi(t).
    let mut contact = prepare(sphere(), Rheology::KelvinVoigt { viscosity: 2.0 });
    approach(&mut *contact, 0.0, 0.01);
    approach(&mut *contact, 1.0, 0.01);
    let error = contact.advance(Step::new(11.0, Load::force(0.0))).unwrap_err();
    let Error::OutOfRange { max, value, ref name, .. } = error else { panic!("{error}") };
    assert!(max > 1.0 && max < 11.0 && value > 10.9 && name.contains("shrink"));
    // Up to there it can be followed; there the speed is 0: Phi' = (F - E* Phi)/(4 eta).
    let force = 0.01 * (11.0 - max) / 10.0;
    let state = contact.advance(Step::new(max, Load::force(force))).unwrap();
    let d = state.approach.unwrap();
    assert_relative_eq!(16.0 / 3.0 * d.powf(1.5), force, max_relative = 1e-9);
    assert!(contact.advance(Step::new(max + 0.01, Load::force(force - 1e-5))).is_err());

    let mut contact = prepare(sphere(), SOLID);
    super::tests::force(&mut *contact, 1.0, 0.01);
    let error = contact.advance(Step::new(2.0, Load::approach(0.009))).unwrap_err();
    assert!(matches!(error, Error::OutOfRange { max, .. } if (max - 1.0).abs() < 1e-12));
    assert!(contact.advance(Step::new(1.0, Load::force(0.0))).is_err());
    // Nothing has happened: it can go on.
    super::tests::force(&mut *contact, 2.0, 0.01);
    assert!(matches!(contact.advance(Step::new(3.0, Load::approach(1.5))), Err(Error::OutOfRange { .. })));
}

/// Springs one by one, each with its own arm, in short steps: the reference implementation.
fn single_springs(profile: Profile, arm: Relaxing, path: &[(f64, f64)], springs: usize, steps: usize) -> f64 {
    let widest = profile.at_approach(path.last().unwrap().1).radius;
    let dx = widest / springs as f64;
    let mut held = vec![0.0; springs];
    let (mut time, mut d, mut force) = (0.0, 0.0, 0.0);
    for &(to, depth) in path {
        let (dt, step) = ((to - time) / steps as f64, (depth - d) / steps as f64);
        for i in 0..steps {
            let now = d + step * (i + 1) as f64;
            force = 0.0;
            for (k, q) in held.iter_mut().enumerate() {
                let gamma = profile.depth((k as f64 + 0.5) * dx).unwrap();
                let pressed = (now - gamma).max(0.0) - (now - step - gamma).max(0.0);
                *q = *q * (-dt / arm.time).exp() + pressed;
                force += 2.0 * dx * ((now - gamma).max(0.0) + arm.weight * *q);
            }
        }
        (time, d) = (to, depth);
    }
    force
}

#[test]
fn single_springs_converge_to_it() {
    let arm = Relaxing { weight: 3.0, time: 2.0 };
    let path = [(0.5, 0.01), (3.0, 0.012), (3.5, 0.03)];
    for exponent in [1.0, 2.0, 3.0] {
        let surface = Surface::PowerLaw { coefficient: 0.5, exponent, size: 1.0.into() };
        let profile = Profile::new(&surface).unwrap().unwrap();
        let mut scene = Scene::new(surface, 1.0);
        scene.effects.rheology = Rheology::StandardSolid { arm };
        scene.outputs.stiffness = false;
        let mut contact = Viscoelastic.prepare(&scene, 0).unwrap();
        let exact = path.map(|(time, d)| force(&mut *contact, time, d))[2];
        // Rectangles in time: first order.
        let error = |n: usize| single_springs(profile, arm, &path, 4 * n, n) / exact - 1.0;
        let (coarse, fine) = (error(50), error(200));
        let order = (coarse / fine).abs().ln() / 4.0_f64.ln();
        assert!((0.9..1.1).contains(&order) && fine.abs() < 1e-2, "{exponent}: {order}, {fine}");
    }
}

#[test]
fn what_the_model_lacks_is_refused() {
    let refused = |scene: &Scene| matches!(Viscoelastic.prepare(scene, 0), Err(Error::Unsupported { .. }));
    let rough = Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 0.1).unwrap());
    assert!(refused(&scene(rough, SOLID)) && refused(&scene(sphere(), Rheology::Elastic)));
    let mut other = scene(sphere(), SOLID);
    other.effects.friction = Friction::coulomb(0.1);
    assert!(refused(&other));
    let mut stiffness = scene(sphere(), SOLID);
    stiffness.outputs.stiffness = true;
    assert!(refused(&stiffness));
    let soft = Body::Elastic { young: 3.0, poisson: 0.5 };
    let pair = |first, second| {
        let mut scene = Scene::of_pair(sphere(), Pair { first, second }).unwrap();
        scene.effects.rheology = Rheology::Maxwell { viscosity: 1.0 };
        scene.outputs.stiffness = false;
        scene
    };
    assert!(Viscoelastic.prepare(&pair(Body::Rigid, soft), 0).is_ok() && refused(&pair(soft, soft)));
    let compressible = Body::Elastic { young: 3.0, poisson: 0.3 };
    assert!(matches!(Viscoelastic.prepare(&pair(compressible, Body::Rigid), 0), Err(Error::Domain { .. })));
    let mut contact = prepare(sphere(), SOLID);
    let sheared = Step::new(0.0, Load::force(0.0).with_tangential(Tangential::force_along_x(1.0)));
    assert!(contact.advance(sheared).is_err());
    assert!(contact.advance(Step::new(-1.0, Load::force(0.0))).is_err());
}

fn series() -> impl Strategy<Value = Vec<Relaxing>> {
    proptest::collection::vec((0.0_f64..5.0, -3.0_f64..3.0), 1..6).prop_map(|arms| {
        arms.into_iter().map(|(weight, log)| Relaxing { weight, time: 10.0_f64.powf(log) }).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(32) })]

    /// A straight segment may be cut anywhere, whichever load is prescribed.
    #[test]
    fn pieces_of_a_step_add_up(n in 0.5_f64..4.0, arms in series(), cut in 0.01_f64..0.99, log in -3.0_f64..3.0) {
        let rheology = Rheology::Prony(PronySeries::new(&arms).unwrap());
        let body = Surface::PowerLaw { coefficient: 0.5, exponent: n, size: 2.0.into() };
        let (mut whole, mut cuts) = (prepare(body.clone(), rheology), prepare(body, rheology));
        let duration = 10.0_f64.powf(log);
        let (mut time, mut d) = (0.0, 0.0);
        for (to, rise) in [(duration, 1e-3), (2.0 * duration, 0.0), (10.0 * duration, 0.02)] {
            force(&mut *cuts, time + cut * (to - time), d + cut * rise);
            (time, d) = (to, d + rise);
            assert_relative_eq!(force(&mut *whole, to, d), force(&mut *cuts, to, d), max_relative = 1e-11);
        }
        whole.restart();
        cuts.restart();
        let (mut time, mut f) = (0.0, 0.0);
        for (to, rise) in [(duration, 1e-4), (2.0 * duration, 0.0), (10.0 * duration, 1e-3)] {
            approach(&mut *cuts, time + cut * (to - time), f + cut * rise);
            (time, f) = (to, f + rise);
            assert_relative_eq!(approach(&mut *whole, to, f), approach(&mut *cuts, to, f), max_relative = 1e-11);
        }
    }

    /// What creeps under a force has that force when it is driven along its own approach.
    #[test]
    fn force_and_approach_are_inverse(arms in series(), log in -2.0_f64..2.0) {
        let rheology = Rheology::Prony(PronySeries::new(&arms).unwrap());
        let (mut by_force, mut by_approach) = (prepare(sphere(), rheology), prepare(sphere(), rheology));
        // Between the times the approach is not straight: first order segments would differ, so the path is
        // fine and the bound wide.
        let segments = 400;
        let mut worst = 0.0_f64;
        for i in 1..=segments {
            let time = 10.0_f64.powf(log) * f64::from(i) / f64::from(segments);
            let f = 1e-3 * f64::from(i) / f64::from(segments);
            let d = approach(&mut *by_force, time, f);
            let back = force(&mut *by_approach, time, d);
            if i > segments / 10 {
                worst = worst.max((back / f - 1.0).abs());
            }
        }
        prop_assert!(worst < 2e-3, "{worst}");
    }
}
