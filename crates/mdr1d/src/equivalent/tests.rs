use super::*;
use crate::{Mdr1d, PartialSlip, Viscoelastic};
use approx::assert_relative_eq;
use contact_model::{
    Abilities, Adhesion, Body, Conductance, ContactModel, ContactState, Friction, Load, NormalLoad, Output,
    Pair, PreparedContact, PronySeries, Relaxing, Rheology, SelfAffine, SolveReport, Step, Stop, Surface,
    SurfaceKind,
};
use std::sync::atomic::{AtomicUsize, Ordering};

const MU: f64 = 0.4;

fn rubber() -> Pair {
    Pair { first: Body::Rigid, second: Body::Elastic { young: 0.75, poisson: 0.5 } }
}

fn sphere() -> Surface {
    Surface::Sphere { radius: 1.0, size: 2.0.into() }
}

fn rough() -> Surface {
    Surface::SelfAffine(SelfAffine::new(2.3, 1.0, 0.01).unwrap())
}

fn sliding(surface: Surface) -> Scene {
    let mut scene = Scene::of_pair(surface, rubber()).unwrap();
    scene.effects.friction = Friction::coulomb(MU);
    scene
}

#[allow(clippy::large_types_passed_by_value)] // Tests read better so.
fn creeping(surface: Surface, rheology: Rheology) -> Scene {
    let mut scene = Scene::of_pair(surface, rubber()).unwrap();
    scene.effects.rheology = rheology;
    scene.outputs.stiffness = false;
    scene
}

fn equivalent(per_decade: u32) -> Equivalent<Mdr1d> {
    Equivalent { per_decade, ..Equivalent::new(Mdr1d { elements: 1 << 12 }) }
}

fn step(normal: f64, tangential: Tangential) -> Step {
    Step::new(0.0, Load::force(normal).with_tangential(tangential))
}

const SOLID: Rheology = Rheology::StandardSolid { arm: Relaxing { weight: 3.0, time: 2.0 } };

/// Largest difference of force, displacement, stick radius and loss from exact springs along a path of both
/// loads, relative to the largest of each.
fn difference(surface: &Surface, per_decade: u32) -> [f64; 4] {
    let path: Vec<Step> = [
        (0.010, 0.0),
        (0.010, 0.5),
        (0.020, 0.1),
        (0.013, -0.8),
        (0.005, -0.3),
        (0.005, 0.9),
        (0.030, 0.2),
        (0.030, 0.95),
    ]
    .iter()
    .map(|&(normal, share)| step(normal, Tangential::force_along_x(share * MU * normal)))
    .collect();
    let scene = sliding(surface.clone());
    let exact = PartialSlip.prepare(&scene, 0).unwrap().follow(&path).unwrap();
    let found = equivalent(per_decade).prepare(&scene, 0).unwrap().follow(&path).unwrap();
    let numbers = |state: &ContactState| {
        let t = state.tangential.unwrap();
        [t.force[0], t.displacement[0], t.stick_radius.unwrap(), t.dissipated]
    };
    let mut worst = [0.0_f64; 4];
    for (one, other) in exact.iter().zip(&found) {
        assert_relative_eq!(one.contact_radius.unwrap(), other.contact_radius.unwrap(), max_relative = 1e-12);
        for (worst, (a, b)) in worst.iter_mut().zip(numbers(one).into_iter().zip(numbers(other))) {
            *worst = worst.max((a - b).abs());
        }
    }
    let largest = exact
        .iter()
        .map(numbers)
        .fold([0.0_f64; 4], |most, now| [0, 1, 2, 3].map(|i| most[i].max(now[i].abs())));
    // A punch loses nothing.
    [0, 1, 2, 3].map(|i| worst[i] / largest[i].max(f64::MIN_POSITIVE))
}

#[test]
fn springs_of_a_table_converge_to_those_of_the_body() {
    for surface in [sphere(), Surface::PowerLaw { coefficient: 1.0, exponent: 0.7, size: 2.0.into() }] {
        let (coarse, fine) = (difference(&surface, 6), difference(&surface, 24));
        // Third order would be 64; the stick radius is x itself, and its worst place moves between the nodes.
        for (coarse, fine) in coarse.iter().zip(&fine).skip(1) {
            assert!(coarse / fine > 16.0 && *fine < 2e-5, "{coarse:e} {fine:e}");
        }
    }
    // A cone and a punch are met exactly.
    for surface in [
        Surface::Cone { slope: 0.3, size: 2.0.into() },
        Surface::FlatCircle { radius: 0.3, size: 2.0.into() },
    ] {
        let error = difference(&surface, 6);
        assert!(error.iter().all(|error| *error < 1e-8), "{error:?}");
    }
}

#[test]
fn a_step_of_a_viscoelastic_sphere_is_the_models_own_force_times_the_modulus() {
    let scene = creeping(sphere(), SOLID);
    let mut contact = equivalent(8).prepare(&scene, 0).unwrap();
    let elastic = 4.0 / 3.0 * 0.01_f64.powf(1.5);
    for time in [0.0, 0.3, 4.0, 1e5] {
        let state = contact.advance(Step::new(time, Load::approach(0.01))).unwrap();
        let contact_modulus = 1.0 + 3.0 * (-time / 2.0_f64).exp();
        assert_relative_eq!(state.force, contact_modulus * elastic, max_relative = 1e-12);
    }
    // A ramp needs the profile: the difference from exact springs falls with the nodes.
    let arms = [Relaxing { weight: 2.0, time: 0.1 }, Relaxing { weight: 1.0, time: 3.0 }];
    let scene = creeping(sphere(), Rheology::Prony(PronySeries::new(&arms).unwrap()));
    let path = [(0.5, 0.01), (3.0, 0.012), (3.5, 0.03)].map(|(t, d)| Step::new(t, Load::approach(d)));
    let exact = Viscoelastic.prepare(&scene, 0).unwrap().follow(&path).unwrap();
    let error = |per_decade: u32| {
        let found = equivalent(per_decade).prepare(&scene, 0).unwrap().follow(&path).unwrap();
        found.iter().zip(&exact).fold(0.0_f64, |worst, (a, b)| worst.max((a.force / b.force - 1.0).abs()))
    };
    let (coarse, fine) = (error(4), error(16));
    assert!(coarse / fine > 30.0 && fine < 1e-6, "{coarse:e} {fine:e}");
    // By force: Phi in closed form, and d from the model itself.
    let path = [(0.5, 0.001), (3.0, 0.002), (9.0, 0.0019)].map(|(t, f)| Step::new(t, Load::force(f)));
    let exact = Viscoelastic.prepare(&scene, 0).unwrap().follow(&path).unwrap();
    let found = equivalent(4).prepare(&scene, 0).unwrap().follow(&path).unwrap();
    for (a, b) in found.iter().zip(&exact) {
        assert_relative_eq!(a.approach.unwrap(), b.approach.unwrap(), max_relative = 1e-11);
    }
}

#[test]
fn the_normal_part_is_the_models_own() {
    let mut scene = sliding(rough());
    let conductance = Conductance::Electrical { first: 1.0, second: 1.0 };
    scene.outputs.conductance = conductance;
    let model = Mdr1d { elements: 1 << 12 };
    let elastic = Scene { effects: Effects::default(), ..scene.clone() };
    let mut own = model.prepare(&elastic, 5).unwrap();
    let mut contact = Equivalent::new(model).prepare(&scene, 5).unwrap();
    assert_eq!(own.normalisation(), contact.normalisation());
    for normal in [1e-3, 4e-3, 2e-3, 0.0, 1e-2] {
        let normal = contact.normalisation().force(normal).unwrap();
        let state = contact.advance(step(normal, Tangential::force_along_x(0.3 * MU * normal))).unwrap();
        let there = own.solve(Load::force(normal)).unwrap();
        assert_eq!(
            (state.force, state.approach, state.stiffness),
            (there.force, there.approach, there.stiffness)
        );
        assert_eq!(state.conductance, there.conductance);
        assert!(state.conductance.is_some() && state.report.strategy.contains("g(x) through"));
    }
}

#[test]
fn limits_of_friction_on_a_rough_surface() {
    let run = |coefficient: f64, tangential: Tangential| {
        let mut scene = sliding(rough());
        scene.effects.friction = Friction::coulomb(coefficient);
        let mut contact = equivalent(16).prepare(&scene, 5).unwrap();
        let normal = contact.normalisation().force(0.05).unwrap();
        let first = contact.advance(step(normal, Tangential::force_along_x(0.0))).unwrap();
        let then = contact.advance(Step::new(0.0, Load::force(normal).with_tangential(tangential)));
        (first, then)
    };
    let shear = rubber().shear_modulus().unwrap() / rubber().contact_modulus().unwrap();
    // mu -> infinity: a spring with k_x = (G*/E*) k, and no loss. The difference falls as 1/mu.
    let deviation = |mu: f64| {
        let (normal, state) = run(mu, Tangential::displacement_along_x(1e-4));
        let sticking = shear * normal.stiffness.unwrap() * 1e-4;
        let tangential = state.unwrap().tangential.unwrap();
        assert!(tangential.dissipated >= 0.0 && tangential.dissipated < 1e-4 * sticking);
        1.0 - tangential.force[0] / sticking
    };
    let (low, high) = (deviation(10.0), deviation(1e4));
    assert!(low > 0.0 && high < 1e-2 * low && high.abs() < 1e-6, "{low:e} {high:e}");
    // A wide stroke slips as a whole: mu F, and it stays there.
    let (normal, state) = run(MU, Tangential::displacement_along_x(1.0));
    let tangential = state.unwrap().tangential.unwrap();
    assert_relative_eq!(tangential.force[0], MU * normal.force, max_relative = 1e-9);
    assert!(tangential.stick_radius.unwrap() <= 0.0 && tangential.dissipated > 0.0);
    // Exactly mu F can be held, more cannot.
    assert!(run(MU, Tangential::force_along_x(MU * normal.force)).1.is_ok());
    let error = run(MU, Tangential::force_along_x(1.001 * MU * normal.force)).1.unwrap_err();
    assert!(
        matches!(error, Error::OutOfRange { max, .. } if (max / (MU * normal.force) - 1.0).abs() < 1e-12)
    );
}

/// Hertz's sphere with a wrong stiffness, and a count of solves.
struct Scripted {
    factor: fn(f64) -> f64,
    solves: &'static AtomicUsize,
}

struct ScriptedContact {
    factor: fn(f64) -> f64,
    solves: &'static AtomicUsize,
}

impl ContactModel for Scripted {
    fn name(&self) -> &'static str {
        "told"
    }
    fn sources(&self) -> &'static [Source] {
        &[]
    }
    fn abilities(&self) -> Abilities {
        Abilities { surfaces: SurfaceKind::ALL, outputs: Output::ALL, ..Abilities::ELASTIC }
    }
    fn prepare(&self, scene: &Scene, _: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse("told", scene)?;
        assert!(!scene.outputs.any_field());
        Ok(Box::new(ScriptedContact { factor: self.factor, solves: self.solves }))
    }
}

impl PreparedContact for ScriptedContact {
    fn normalisation(&self) -> Normalisation {
        Normalisation { contact_modulus: 1.0, length: 2.0, height: None }
    }
    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop.stops() {
            return Err(Error::Stopped { best: None });
        }
        self.solves.fetch_add(1, Ordering::Relaxed);
        let d = match load.normal {
            NormalLoad::Approach(d) => d,
            NormalLoad::Force(f) => (0.75 * f).powf(2.0 / 3.0),
            other => return Err(Error::unsupported("told", format!("{other:?}"))),
        };
        Ok(ContactState::new(4.0 / 3.0 * d.powf(1.5), SolveReport::exact("told"))
            .with_approach(d)
            .with_elastic_stiffness(2.0 * d.sqrt() * (self.factor)(d)))
    }
}

#[test]
fn contacts_that_do_not_grow_are_refused_and_leave_no_trace() {
    static SOLVES: AtomicUsize = AtomicUsize::new(0);
    let model = Equivalent::new(Scripted { factor: |d| if d > 0.005 { 0.8 } else { 1.0 }, solves: &SOLVES });
    let mut contact = model.prepare(&sliding(sphere()), 0).unwrap();
    let held = Step::new(0.0, Load::approach(0.003).with_tangential(Tangential::displacement_along_x(1e-4)));
    let before = contact.advance(held).unwrap().tangential.unwrap();
    let error = contact
        .advance(Step { load: Load::approach(0.008).with_tangential(held.load.tangential), ..held })
        .unwrap_err();
    assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("grows"), "{error}");
    assert_eq!(contact.advance(held).unwrap().tangential.unwrap(), before);
}

#[test]
fn a_stop_between_nodes_leaves_no_trace() {
    static SOLVES: AtomicUsize = AtomicUsize::new(0);
    let model = Equivalent::new(Scripted { factor: |_| 1.0, solves: &SOLVES });
    let mut contact = model.prepare(&sliding(sphere()), 0).unwrap();
    let step = Step::new(1.0, Load::approach(0.01));
    let stop = || SOLVES.load(Ordering::Relaxed) >= 7;
    let error = contact.advance_until(step, &stop).unwrap_err();
    assert!(matches!(error, Error::Stopped { .. }));
    assert_eq!(SOLVES.load(Ordering::Relaxed), 7);
    assert!(contact.advance(Step { time: 0.5, ..step }).is_ok(), "the time is still 0");
}

#[test]
fn any_units_do() {
    let run = |length: f64, young: f64| {
        let pair = Pair { first: Body::Rigid, second: Body::Elastic { young, poisson: 0.5 } };
        let surface = Surface::Sphere { radius: length, size: (2.0 * length).into() };
        let mut scene = Scene::of_pair(surface, pair).unwrap();
        scene.effects.friction = Friction::coulomb(MU);
        let mut contact = equivalent(8).prepare(&scene, 0).unwrap();
        let force = 0.01 * (scene.contact_modulus * length) * length;
        contact.advance(step(force, Tangential::force_along_x(0.0))).unwrap();
        let state = contact.advance(step(force, Tangential::force_along_x(0.5 * MU * force))).unwrap();
        [state.contact_radius.unwrap() / length, state.tangential.unwrap().displacement[0] / length]
    };
    let here = run(1.0, 0.75);
    for (length, young) in [(1e-90, 1e90), (1e90, 1e-90), (1e-6, 1e11)] {
        for (a, b) in run(length, young).into_iter().zip(here) {
            assert_relative_eq!(a, b, max_relative = 1e-9);
        }
    }
}

#[test]
fn nodes_are_solved_once() {
    static SOLVES: AtomicUsize = AtomicUsize::new(0);
    let solves = || SOLVES.swap(0, Ordering::Relaxed);
    let model = Equivalent {
        per_decade: 10,
        decades: 2,
        ..Equivalent::new(Scripted { factor: |_| 1.0, solves: &SOLVES })
    };
    let mut contact = model.prepare(&sliding(sphere()), 0).unwrap();
    assert_eq!(solves(), 0, "nothing before the first step");
    let mut press = |d: f64| contact.advance(Step::new(0.0, Load::approach(d))).map(|_| ());
    press(0.01).unwrap();
    assert_eq!(solves(), 1 + 21);
    press(0.01).unwrap();
    press(0.002).unwrap();
    assert_eq!(solves(), 2, "inside the table a step is one solve");
    press(0.1).unwrap();
    assert_eq!(solves(), 1 + 10);
    press(0.0).unwrap();
    contact.restart();
    assert!(contact.advance(Step::new(0.0, Load::approach(0.1))).is_ok());
    assert_eq!(solves(), 2, "a restart keeps the table");
}

#[test]
fn growth_in_time_is_checked() {
    let mut contact = equivalent(8).prepare(&creeping(rough(), SOLID), 3).unwrap();
    let unit = contact.normalisation().height.unwrap();
    let state = contact.advance(Step::new(1.0, Load::approach(unit))).unwrap();
    let error = contact.advance(Step::new(2.0, Load::approach(0.9 * unit))).unwrap_err();
    assert!(matches!(error, Error::OutOfRange { max, .. } if (max - 1.0).abs() < 1e-12), "{error}");
    // Relaxed: what M carries, at the same approach.
    let late = contact.advance(Step::new(1e6, Load::approach(unit))).unwrap();
    let elastic = Scene { effects: Effects::default(), ..creeping(rough(), SOLID) };
    let own = Mdr1d { elements: 1 << 12 }.prepare(&elastic, 3).unwrap().solve(Load::approach(unit)).unwrap();
    assert_relative_eq!(late.force, own.force, max_relative = 1e-12);
    assert!(state.force > late.force);
    // Creep of a fluid goes on beyond every table that was there before.
    let mut contact =
        equivalent(8).prepare(&creeping(rough(), Rheology::Maxwell { viscosity: 1.0 }), 3).unwrap();
    let force = contact.normalisation().force(1e-3).unwrap();
    let depths = [0.0, 1.0, 100.0, 1e4]
        .map(|t| contact.advance(Step::new(t, Load::force(force))).unwrap().approach.unwrap());
    assert!(depths.windows(2).all(|d| d[1] > d[0]), "{depths:?}");
}

#[test]
fn what_the_wrapper_lacks_is_refused() {
    let refused = |scene: &Scene| matches!(equivalent(8).prepare(scene, 0), Err(Error::Unsupported { .. }));
    assert!(refused(&Scene::of_pair(sphere(), rubber()).unwrap()));
    assert!(refused(&Scene { pair: None, ..sliding(sphere()) }));
    assert!(refused(&sliding(Surface::Flat { size: 1.0.into() })), "what M refuses");
    let mut scene = sliding(sphere());
    scene.effects.rheology = SOLID;
    assert!(refused(&scene));
    scene = sliding(sphere());
    scene.effects.adhesion = Adhesion::ShortRange { work: 0.1 };
    assert!(refused(&scene));
    scene = sliding(sphere());
    scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
    assert!(refused(&scene));
    scene = creeping(sphere(), SOLID);
    scene.outputs.stiffness = true;
    assert!(refused(&scene));
    let mut contact = equivalent(8).prepare(&creeping(sphere(), SOLID), 0).unwrap();
    assert!(contact.advance(step(0.01, Tangential::force_along_x(1e-3))).is_err());
    for (per_decade, decades) in [(0, 3), (1001, 3), (16, 0), (16, 13)] {
        let model = Equivalent { per_decade, decades, ..Equivalent::new(Mdr1d::default()) };
        assert!(matches!(model.prepare(&sliding(sphere()), 0), Err(Error::Domain { .. })));
    }
    assert!(equivalent(8).profile(&sliding(sphere()), 0, 0.0).is_err());
}

#[test]
fn a_straight_piece_is_the_sum_of_its_parts() {
    // Cut anywhere, a path ends in the same state, to what the table knows between its nodes.
    let run = |cuts: &[f64]| {
        let mut contact = equivalent(16).prepare(&sliding(rough()), 5).unwrap();
        let unit = contact.normalisation().height.unwrap();
        let mut from = [0.0, 0.0];
        for corner in [[1.0, 0.05], [1.0, -0.03], [2.0, 0.06], [0.5, 0.01]] {
            for cut in cuts.iter().chain(&[1.0]) {
                let [d, u] = [0, 1].map(|i| from[i] + cut * (corner[i] - from[i]));
                let tangential = Tangential::displacement_along_x(u * unit);
                contact
                    .advance(Step::new(0.0, Load::approach(d * unit).with_tangential(tangential)))
                    .unwrap();
            }
            from = corner;
        }
        let last = Tangential::displacement_along_x(from[1] * unit);
        let step = Step::new(0.0, Load::approach(from[0] * unit).with_tangential(last));
        let tangential = contact.advance(step).unwrap().tangential.unwrap();
        [tangential.force[0], tangential.dissipated]
    };
    let whole = run(&[]);
    for cuts in [&[0.5][..], &[0.1, 0.7], &[0.01, 0.02, 0.5, 0.99]] {
        for (a, b) in run(cuts).into_iter().zip(whole) {
            assert_relative_eq!(a, b, max_relative = 2e-4);
        }
    }
}
