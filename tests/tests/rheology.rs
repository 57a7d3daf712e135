//! Rheology by its properties: limits in time, bounds by energy, superposition; both for the exact springs
//! and for those of a table.

use analytic::{FlatPunch, Hertz};
use approx::assert_relative_eq;
use contact_model::{ContactModel, Load, Outputs, PronySeries, Relaxing, Rheology, Scene, Step, Surface};
use mdr1d::{Equivalent, Viscoelastic};

const MODULUS: f64 = 4.0;
const ARMS: [Relaxing; 2] = [Relaxing { weight: 2.0, time: 0.5 }, Relaxing { weight: 1.0, time: 3.0 }];
/// `1 + sum w`: the instantaneous (glassy) modulus.
const GLASSY: f64 = 4.0;
/// Closed forms and quadratures.
const EXACT: f64 = 1e-11;
/// Tables of a smooth body.
const TABLE: f64 = 1e-5;

fn scene(surface: Surface, rheology: &Rheology) -> Scene {
    let mut scene = Scene::new(surface, MODULUS);
    scene.outputs = Outputs::default();
    scene.effects.rheology = *rheology;
    scene
}

fn series() -> Rheology {
    Rheology::Prony(PronySeries::new(&ARMS).unwrap())
}

fn sphere() -> Surface {
    Surface::Sphere { radius: 1.0, size: 2.0.into() }
}

/// Force of an elastic sphere over E* of the relaxed body.
fn elastic(d: f64) -> f64 {
    4.0 / 3.0 * MODULUS * d.powf(1.5)
}

fn models() -> [(Box<dyn ContactModel>, f64); 2] {
    [(Box::new(Viscoelastic), EXACT), (Box::new(Equivalent::new(Hertz)), TABLE)]
}

/// Forces along a path of (time, approach).
fn forces(model: &dyn ContactModel, scene: &Scene, path: &[(f64, f64)]) -> Vec<f64> {
    let mut history = model.prepare(scene, 0).unwrap();
    let step = |&(time, d): &(f64, f64)| history.advance(Step::new(time, Load::approach(d))).unwrap();
    path.iter().map(step).map(|state| state.force).collect()
}

#[test]
fn slow_is_relaxed_and_fast_is_glassy() {
    // A ramp to d in the time T: when it is slow the arms still hold sum w tau Phi'(T)/Phi = (3/2) sum w
    // tau/T; when it is fast they have lost sum w/tau int Phi dt/Phi = (2/5) sum w T/tau.
    let d = 0.02;
    for (model, tolerance) in models() {
        let scene = scene(sphere(), &series());
        let ramp = |time: f64| forces(&*model, &scene, &[(time, d)])[0] / elastic(d);
        let held: f64 = ARMS.iter().map(|arm| arm.weight * arm.time).sum();
        let lost: f64 = ARMS.iter().map(|arm| arm.weight / arm.time).sum();
        for time in [1e3, 1e4] {
            // The next order is relative tau/T.
            assert_relative_eq!(
                (ramp(time) - 1.0) * time,
                1.5 * held,
                max_relative = 5.0 / time + tolerance * time
            );
        }
        for time in [1e-2, 1e-3] {
            let fall = (GLASSY - ramp(time)) / time;
            assert_relative_eq!(fall, 0.4 * lost, max_relative = 5.0 * time + 10.0 * tolerance / time);
        }
    }
}

#[test]
fn work_lies_between_the_relaxed_and_the_glassy_energy() {
    // E* Phi <= F <= E*(0) Phi while the contact grows, hence so does the work; what lies above the relaxed
    // energy is dissipated or still held.
    for (model, tolerance) in models() {
        let scene = scene(sphere(), &series());
        let segments = 200;
        let path: Vec<(f64, f64)> = (1..=segments)
            .map(|i| {
                let t = f64::from(i) / f64::from(segments);
                // Fast, slow and fast again.
                (4.0 * t, 0.02 * (t + 0.12 * (12.0 * t).sin() / 2.0).max(0.0))
            })
            .collect();
        assert!(path.windows(2).all(|w| w[1].1 >= w[0].1), "it grows");
        let forces = forces(&*model, &scene, &path);
        let (mut work, mut last) = (0.0, (0.0, 0.0));
        for (&(_, d), &force) in path.iter().zip(&forces) {
            let relaxed = elastic(d);
            assert!(force >= relaxed * (1.0 - tolerance) && force <= GLASSY * relaxed * (1.0 + tolerance));
            work += 0.5 * (force + last.1) * (d - last.0);
            last = (d, force);
            let energy = 0.4 * relaxed * d;
            // Trapezia are too large, at the beginning by a quarter.
            if d > 0.004 {
                assert!(work >= energy && work <= GLASSY * energy * 1.01, "{work} {energy}");
            }
        }
    }
}

#[test]
fn a_flat_punch_responds_linearly() {
    // Without growth Boltzmann's superposition holds in d itself: the force of a sum of histories is the sum
    // of the forces.
    let punch = Surface::FlatCircle { radius: 0.3, size: 2.0.into() };
    let times = [0.0, 0.3, 1.0, 5.0, 40.0];
    let (one, other) = ([1e-3, 2e-3, 2e-3, 5e-3, 5e-3], [0.0, 4e-3, 7e-3, 7e-3, 9e-3]);
    let models: [Box<dyn ContactModel>; 2] =
        [Box::new(Viscoelastic), Box::new(Equivalent::new(&FlatPunch as &'static dyn ContactModel))];
    for model in models {
        let scene = scene(punch.clone(), &series());
        let run = |depths: [f64; 5]| {
            let path: Vec<(f64, f64)> = times.into_iter().zip(depths).collect();
            forces(&*model, &scene, &path)
        };
        let sum = run([0, 1, 2, 3, 4].map(|i| one[i] + other[i]));
        for ((sum, a), b) in sum.into_iter().zip(run(one)).zip(run(other)) {
            assert_relative_eq!(sum, a + b, max_relative = EXACT);
        }
    }
}

#[test]
fn arms_without_weight_and_arms_that_never_relax_are_elastic() {
    let d = 0.02;
    let path = [(0.3, 0.5 * d), (2.0, d)];
    for (model, tolerance) in models() {
        let with = |weight: f64, time: f64| {
            forces(
                &*model,
                &scene(sphere(), &Rheology::StandardSolid { arm: Relaxing { weight, time } }),
                &path,
            )[1]
        };
        // w -> 0, tau -> 0: the scene's own modulus; tau -> infinity: (1 + w) times it. The first orders
        // vanish as w, tau and 1/tau.
        for (weight, time, limit) in [(1e-6, 1.0, 1.0), (2.0, 1e-6, 1.0), (2.0, 1e6, 3.0)] {
            assert_relative_eq!(with(weight, time), limit * elastic(d), max_relative = 1e-5 + tolerance);
        }
        // A dashpot without viscosity to speak of.
        let voigt = forces(&*model, &scene(sphere(), &Rheology::KelvinVoigt { viscosity: 1e-9 }), &path)[1];
        assert_relative_eq!(voigt, elastic(d), max_relative = 1e-7);
        // A spring that hardly flows.
        let maxwell = forces(&*model, &scene(sphere(), &Rheology::Maxwell { viscosity: 1e9 }), &path)[1];
        assert_relative_eq!(maxwell, elastic(d), max_relative = 1e-7 + tolerance);
    }
}

/// Boundary elements beside the closed form of a ball, to the error of the cells and of the steps of time: approach,
/// force and contact radius of histories by force and by approach.
#[test]
fn boundary_elements_follow_the_closed_form() {
    let model = bem3d::Bem3d { cells: 129, tolerance: 1e-7, ..bem3d::Bem3d::DEFAULT };
    let ball = Surface::Sphere { radius: 1.0, size: 0.6.into() };
    let mut scene = scene(ball, &series());
    scene.outputs.area = true;
    let force = |t: f64, f: f64| Step::new(t, Load::force(f));
    let approach = |t: f64, d: f64| Step::new(t, Load::approach(d));
    let paths = [
        vec![force(0.0, 0.02), force(1.0, 0.02), force(6.0, 0.05), force(30.0, 0.05)],
        vec![approach(1.0, 0.01), approach(2.0, 0.03), approach(20.0, 0.03)],
    ];
    for path in paths {
        let mut contact = model.prepare(&scene, 0).unwrap();
        let mut exact = Viscoelastic.prepare(&scene, 0).unwrap();
        for step in path {
            let (found, exact) = (contact.advance(step).unwrap(), exact.advance(step).unwrap());
            // The grid has its own error of half a per cent, of approaches less.
            assert_relative_eq!(found.force, exact.force, max_relative = 6e-3);
            assert_relative_eq!(found.approach.unwrap(), exact.approach.unwrap(), max_relative = 4e-3);
            let area = found.resolution.unwrap().corrected_area.unwrap();
            assert_relative_eq!(area, exact.area.unwrap(), max_relative = 0.02);
        }
    }
}
