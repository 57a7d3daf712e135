//! Viscoelastic contacts: correspondence with elastic ones while the contact grows, and histories beyond.

#![allow(clippy::unwrap_used)]

use approx::assert_relative_eq;
use bem3d::*;
use contact_model::{Layer, LayerBase, PronySeries, Relaxing, Rheology};

const MODULUS: f64 = 4.0;
const ARM: Relaxing = Relaxing { weight: 3.0, time: 2.0 };
const SOLID: Rheology = Rheology::StandardSolid { arm: ARM };
const MODEL: Bem3d = Bem3d { cells: 48, tolerance: 1e-8, ..Bem3d::DEFAULT };

fn scene(surface: Surface, boundary: Boundary, rheology: &Rheology) -> Scene {
    let mut scene = Scene::new(surface, MODULUS);
    scene.effects.rheology = *rheology;
    scene.effects.boundary = boundary;
    scene.outputs = Outputs { area: true, mean_gap: boundary == Boundary::Periodic, ..Outputs::default() };
    scene
}

fn ball() -> Surface {
    Surface::Sphere { radius: 1.0, size: 1.0.into() }
}

fn rough() -> Surface {
    let mut surface = SelfAffine::new(2.3, 1.0, 0.01).unwrap();
    surface.short_cutoff = Some(16.0);
    Surface::SelfAffine(surface)
}

/// The states at the ends of these steps.
fn history(model: &Bem3d, scene: &Scene, steps: &[(f64, Load)]) -> Vec<ContactState> {
    let mut contact = model.prepare(scene, 3).unwrap();
    steps.iter().map(|&(time, load)| contact.advance(Step::new(time, load)).unwrap()).collect()
}

/// A force applied at once and held: the creep function of the material over E*.
fn creep(rheology: &Rheology, time: f64) -> f64 {
    match *rheology {
        Rheology::StandardSolid { arm: Relaxing { weight, time: tau } } => {
            1.0 - weight / (1.0 + weight) * (-time / (tau * (1.0 + weight))).exp()
        }
        // G = E*/4 = 1.
        Rheology::Maxwell { viscosity } => 1.0 + time / viscosity,
        _ => 1.0,
    }
}

/// While the contact grows it is that of an elastic body under the force that creep makes of it, on the same cells:
/// what differs is the error of the steps of time, and states say how large it is.
#[test]
fn a_held_force_is_an_elastic_contact_under_what_creep_makes_of_it() {
    let layer = Layer { thickness: 0.2, young: MODULUS * 0.75, poisson: 0.5, base: LayerBase::Rigid };
    let fluid = Rheology::Maxwell { viscosity: 2.0 };
    for (surface, boundary, rheology, layer, force) in [
        (ball(), Boundary::Free, SOLID, None, 0.02),
        (ball(), Boundary::Free, fluid, None, 0.005),
        (rough(), Boundary::Free, SOLID, None, 0.01),
        (rough(), Boundary::Periodic, SOLID, None, 0.02),
        (rough(), Boundary::Periodic, fluid, None, 0.005),
        (rough(), Boundary::Periodic, SOLID, Some(layer), 0.01),
        (ball(), Boundary::Free, SOLID, Some(layer), 0.02),
    ] {
        let mut scene = scene(surface, boundary, &rheology);
        scene.effects.layer = layer;
        let mut elastic = scene.clone();
        elastic.effects.rheology = Rheology::Elastic;
        let mut elastic = MODEL.prepare(&elastic, 3).unwrap();
        let times = [0.0, 0.1, 1.0, 4.0, 10.0];
        let states = history(&MODEL, &scene, &times.map(|time| (time, Load::force(force))));
        for (time, state) in times.into_iter().zip(states) {
            let expected = elastic.solve(Load::force(force * creep(&rheology, time))).unwrap();
            let of = state.viscoelastic.unwrap();
            // Ten times the solver's tolerance, in rms heights or approaches.
            let error = of.distance_time_error + 1e-6;
            if boundary == Boundary::Free {
                assert_relative_eq!(
                    state.approach.unwrap(),
                    expected.approach.unwrap(),
                    max_relative = error
                );
            } else {
                let (gap, expected) = (state.mean_gap.unwrap(), expected.mean_gap.unwrap());
                assert!((gap - expected).abs() < error * gap.max(0.01), "{time}: {gap} {expected} {of:?}");
            }
            let (cells, expected) =
                (state.report.contact_cells.unwrap(), expected.report.contact_cells.unwrap());
            assert!(cells.abs_diff(expected) <= 2 + cells / 500, "{time}: {cells} {expected} {of:?}");
            assert_relative_eq!(state.force, force, max_relative = 1e-12);
        }
    }
}

/// A load in no time meets the glassy body, and one that is held for long the relaxed one.
#[test]
fn both_limits_are_elastic() {
    let arms = [ARM, Relaxing { weight: 1.0, time: 0.3 }];
    let series = Rheology::Prony(PronySeries::new(&arms).unwrap());
    for (surface, boundary) in [(ball(), Boundary::Free), (rough(), Boundary::Periodic)] {
        let viscous = scene(surface.clone(), boundary, &series);
        let steps = [(0.0, Load::force(0.01)), (200.0, Load::force(0.01))];
        let states = history(&MODEL, &viscous, &steps);
        for (state, factor) in states.iter().zip([5.0, 1.0]) {
            let mut elastic = scene(surface.clone(), boundary, &Rheology::Elastic);
            elastic.contact_modulus *= factor;
            let expected = MODEL.prepare(&elastic, 3).unwrap().solve(Load::force(0.01)).unwrap();
            assert_eq!(state.report.contact_cells, expected.report.contact_cells);
            let distance = |state: &ContactState| state.approach.or(state.mean_gap).unwrap();
            assert_relative_eq!(distance(state), distance(&expected), max_relative = 1e-6);
        }
        assert_eq!(states[0].viscoelastic.unwrap().time_steps, 0);
    }
}

/// At a held approach nothing moves, and the force relaxes as the modulus does, whatever the steps are.
#[test]
fn a_held_approach_relaxes_as_the_modulus() {
    for (surface, boundary) in [(ball(), Boundary::Free), (rough(), Boundary::Periodic)] {
        let load = if boundary == Boundary::Free { Load::approach(0.02) } else { Load::mean_gap(0.01) };
        let scene = scene(surface, boundary, &SOLID);
        let states = history(&MODEL, &scene, &[(0.0, load), (1.0, load), (7.0, load), (60.0, load)]);
        for state in &states {
            let modulus = 1.0 + 3.0 * (-state.time.unwrap() / 2.0_f64).exp();
            assert_relative_eq!(state.force / states[0].force, modulus / 4.0, max_relative = 1e-6);
            assert_eq!(state.report.contact_cells, states[0].report.contact_cells);
            assert!(state.viscoelastic.unwrap().force_time_error < 1e-6);
        }
    }
}

/// The error of fixed steps falls as the square of their length, and states know it.
#[test]
fn steps_are_of_second_order() {
    let viscous = scene(ball(), Boundary::Free, &SOLID);
    // Up and down again, so that the contact shrinks too; the corner is the end of a step.
    let at = |count: u32| {
        let steps: Vec<_> = (1..=count)
            .map(|k| {
                let share = f64::from(k) / f64::from(count);
                (4.0 * share, Load::approach(0.04 * share.min(0.65 - 0.3 * share)))
            })
            .collect();
        // Any error is allowed, so that each load is one step.
        history(&Bem3d { time_tolerance: 1.0, ..MODEL }, &viscous, &steps).pop().unwrap()
    };
    let exact = at(320).force;
    let errors: Vec<_> = [10, 20, 40].map(at).iter().map(|s| (s.force / exact - 1.0).abs()).collect();
    for (pair, count) in errors.windows(2).zip([10, 20]) {
        assert!(pair[0] / pair[1] > 3.0, "{count}: {errors:?}");
    }
    for count in [10, 20, 40] {
        let state = at(count);
        let stated = state.viscoelastic.unwrap().force_time_error;
        assert!((state.force / exact - 1.0).abs() < stated, "{count}: {stated}");
    }
}

/// A ball that is pressed in and drawn back, beside Ting's solution (J. Appl. Mech. 33, 845 (1966)): while the contact
/// shrinks it is as large as at an earlier time, from which on the approach has left nothing in the modulus.
#[test]
fn a_ball_that_is_drawn_back_follows_ting() {
    let (radius, speed, turn) = (1.0_f64, 0.02, 1.0);
    let modulus = |t: f64| MODULUS * (1.0 + 3.0 * (-t / 2.0).exp());
    let model = Bem3d { cells: 129, tolerance: 1e-7, time_tolerance: 1e-4, ..Bem3d::DEFAULT };
    let scene = scene(ball(), Boundary::Free, &SOLID);
    let times = [0.5, 1.0, 1.15, 1.3, 1.45];
    let approach = |t: f64| speed * if t < turn { t } else { 2.0 * turn - t };
    let states = history(&model, &scene, &times.map(|t| (t, Load::approach(approach(t)))));
    // int of the modulus over the age.
    let integral = |t: f64| MODULUS * (t + 6.0 * -(-t / 2.0).exp_m1());
    for (t, state) in times.into_iter().zip(states) {
        let earlier = if t <= turn {
            t
        } else {
            // int_{t1}^{turn} E(t - s) ds = int_turn^t E(t - s) ds.
            let (mut low, mut high) = (0.0, turn);
            for _ in 0..60 {
                let middle = 0.5 * (low + high);
                let rising = integral(t - middle) - integral(t - turn);
                if rising > integral(t - turn) { low = middle } else { high = middle }
            }
            low
        };
        let points = 20_000;
        let step = earlier / f64::from(points);
        let force: f64 = (0..points)
            .map(|k| (f64::from(k) + 0.5) * step)
            .map(|s| modulus(t - s) * (speed * s).sqrt() * 1.5 * speed * step)
            .sum::<f64>()
            * 4.0
            / 3.0
            * radius.sqrt();
        assert_relative_eq!(state.force, force, max_relative = 5e-3);
        let area = std::f64::consts::PI * radius * speed * earlier;
        assert_relative_eq!(state.resolution.unwrap().corrected_area.unwrap(), area, max_relative = 0.02);
    }
}

/// A body that was pressed recovers after the contact is lost, and may be met again.
#[test]
fn a_contact_that_is_lost_recovers() {
    let mut viscous = scene(ball(), Boundary::Free, &SOLID);
    viscous.outputs.gap = true;
    viscous.outputs.displacement = true;
    let force = Load::force(0.02);
    let steps = [
        (0.0, force),
        (3.0, force),
        (3.0, Load::force(0.0)),
        (3.1, Load::force(0.0)),
        (90.0, Load::force(0.0)),
    ];
    let states = history(&MODEL, &viscous, &steps);
    for (state, next) in states[2..].iter().zip(&states[3..]) {
        assert_eq!((state.force, state.area), (0.0, Some(0.0)));
        // What is left of the indentation shrinks.
        let deepest =
            |state: &ContactState| state.displacement().unwrap().values().iter().copied().fold(0.0, f64::max);
        assert!(deepest(next) < deepest(state) && deepest(next) >= 0.0);
    }
    let left = states[4].displacement().unwrap().values().iter().copied().fold(0.0, f64::max);
    assert!(left < 1e-4 * states[1].approach.unwrap(), "{left}");
    for state in &states {
        assert!(state.gap().unwrap().values().iter().all(|gap| *gap > -1e-9));
    }
    let approach = |d: f64| Load::approach(d);
    let back = [
        (0.0, approach(0.02)),
        (1.0, approach(0.02)),
        (1.0, approach(0.0)),
        (2.0, approach(0.012)),
        (2.0, approach(0.02)),
    ];
    let states = history(&MODEL, &viscous, &back);
    assert!(states[2].force.abs() <= 0.0);
    assert!(states[3].force > 0.0 && states[4].force > states[3].force);
}

/// Restored from its memory in the middle, a history goes on to the same bits.
#[test]
fn a_restored_history_goes_on_to_the_same_bits() {
    let viscous = scene(rough(), Boundary::Periodic, &SOLID);
    let loads = [(0.0, 0.01), (0.7, 0.02), (1.5, 0.005), (1.5, 0.01), (4.0, 0.012)];
    let loads = loads.map(|(time, force)| (time, Load::force(force)));
    let whole = history(&MODEL, &viscous, &loads);
    for kept in 1..loads.len() {
        let mut first = MODEL.prepare(&viscous, 3).unwrap();
        for &(time, load) in &loads[..kept] {
            first.advance(Step::new(time, load)).unwrap();
        }
        let memory = first.memory().unwrap().unwrap();
        let mut second = MODEL.prepare(&viscous, 3).unwrap();
        second.recall(&memory).unwrap();
        for (&(time, load), expected) in loads[kept..].iter().zip(&whole[kept..]) {
            assert_eq!(second.advance(Step::new(time, load)).unwrap(), *expected);
        }
        let mut elastic = viscous.clone();
        elastic.effects.rheology = Rheology::Elastic;
        assert!(MODEL.prepare(&elastic, 3).unwrap().recall(&memory).is_err());
    }
}

/// A cycle of the load takes energy, which is less in very slow and very fast ones.
#[test]
fn slow_and_fast_cycles_lose_less() {
    let viscous = scene(ball(), Boundary::Free, &SOLID);
    let loss = |period: f64| {
        let steps: Vec<_> = (0..=60)
            .map(|k| {
                let share = f64::from(k) / 20.0;
                let wave = 1.0 - (std::f64::consts::TAU * share).cos();
                (period * share, Load::approach(0.01 + 0.005 * wave))
            })
            .collect();
        let states = history(&Bem3d { cells: 33, ..MODEL }, &viscous, &steps);
        let last = &states[40..];
        let by_trapezia: f64 = last
            .windows(2)
            .map(|pair| {
                0.5 * (pair[0].force + pair[1].force)
                    * (pair[1].approach.unwrap() - pair[0].approach.unwrap())
            })
            .sum();
        let work = |state: &ContactState| state.viscoelastic.unwrap().work.unwrap();
        let lost = work(&last[20]) - work(&last[0]);
        // Trapezia between the states are too coarse for fast cycles, which lose a small part of their work.
        assert!((lost - by_trapezia).abs() < 0.01 * work(&last[10]).abs(), "{period}: {lost} {by_trapezia}");
        let (least, most) =
            last.iter().fold((f64::MAX, 0.0_f64), |(a, b), s| (a.min(s.force), b.max(s.force)));
        lost / ((most - least) * 0.01)
    };
    let [fast, near, slow] = [0.05, 8.0, 800.0].map(loss);
    assert!(fast > 0.0 && slow > 0.0 && near > 3.0 * fast && near > 3.0 * slow, "{fast} {near} {slow}");
}

#[test]
fn what_has_no_answer_is_refused() {
    let refused = |scene: &Scene, load: Load| match MODEL.prepare(scene, 3) {
        Ok(mut contact) => contact.advance(Step::new(0.0, load)).unwrap_err().to_string(),
        Err(error) => error.to_string(),
    };
    let force = Load::force(0.01);
    let voigt = scene(ball(), Boundary::Free, &Rheology::KelvinVoigt { viscosity: 1.0 });
    assert!(refused(&voigt, force).contains("give the load a time"));
    let mut stiff = scene(ball(), Boundary::Free, &SOLID);
    stiff.outputs.stiffness = true;
    assert!(refused(&stiff, force).contains("stiffness of a viscoelastic body"));
    let mut sticky = scene(ball(), Boundary::Free, &SOLID);
    sticky.effects.adhesion = Adhesion::ShortRange { work: 1.0 };
    assert!(refused(&sticky, force).contains("give the adhesion a range"), "{}", refused(&sticky, force));
    let mut coated = scene(ball(), Boundary::Free, &SOLID);
    let base = LayerBase::HalfSpace { young: 1.0, poisson: 0.3 };
    coated.effects.layer = Some(Layer { thickness: 0.1, young: MODULUS * 0.91, poisson: 0.3, base });
    assert!(refused(&coated, force).contains("relax as the layer does"));
    let bodies = Pair {
        first: Body::Elastic { young: 1.5 * MODULUS, poisson: 0.0 },
        second: Body::Elastic { young: 3.0 * MODULUS, poisson: 0.0 },
    };
    let mut two = scene(ball(), Boundary::Free, &SOLID);
    two.pair = Some(bodies);
    assert!(refused(&two, force).contains("one has to be rigid"));
    let same = Body::Elastic { young: 2.0 * MODULUS, poisson: 0.0 };
    two.pair = Some(Pair { first: same, second: same });
    two.effects.rheology = Rheology::Maxwell { viscosity: 1.0 };
    assert!(refused(&two, force).contains("a viscosity of two bodies"));
    let tolerance = Bem3d { time_tolerance: 0.0, ..MODEL };
    assert!(tolerance.prepare(&scene(ball(), Boundary::Free, &SOLID), 0).is_err());
}

/// Kelvin and Voigt's body has steps of first order, whose error is controlled all the same.
#[test]
fn a_dashpot_in_parallel() {
    let voigt = scene(ball(), Boundary::Free, &Rheology::KelvinVoigt { viscosity: 2.0 });
    let force = 0.02;
    let times = [0.5, 3.0, 40.0];
    let states = history(&MODEL, &voigt, &times.map(|time| (time, Load::force(force))));
    // The force rises in the first half unit of time: int (1 - exp(-(t - s)/2)) ds / 0.5.
    let crept = |t: f64| 1.0 - ((-(t - 0.5) / 2.0_f64).exp() - (-t / 2.0_f64).exp()) * 2.0 / 0.5;
    let mut elastic = MODEL.prepare(&scene(ball(), Boundary::Free, &Rheology::Elastic), 3).unwrap();
    for (time, state) in times.into_iter().zip(states) {
        let expected = elastic.solve(Load::force(force * crept(time))).unwrap();
        let error = state.viscoelastic.unwrap().distance_time_error;
        assert_relative_eq!(
            state.approach.unwrap(),
            expected.approach.unwrap(),
            max_relative = 1.5 * error + 1e-6
        );
        assert!(error < 0.03, "{error}");
    }
}

/// The hardness bounds the true pressure, and what has flowed stays when the rest has recovered.
#[test]
fn a_hardness_bounds_the_pressure_of_a_history() {
    let mut hard = scene(ball(), Boundary::Free, &SOLID);
    let pressure = 0.35;
    hard.effects.hardness = Hardness::Limit { pressure };
    hard.outputs.pressure = true;
    hard.outputs.plastic_depth = true;
    hard.outputs.gap = true;
    let force = Load::force(0.02);
    let steps =
        [(0.0, force), (1.0, force), (9.0, force), (9.0, Load::force(0.0)), (200.0, Load::force(0.0))];
    let states = history(&MODEL, &hard, &steps);
    for state in &states[..3] {
        let largest = state.pressure().unwrap().values().iter().copied().fold(0.0, f64::max);
        assert!(largest <= pressure * (1.0 + 1e-9), "{largest}");
        assert_relative_eq!(state.force, 0.02, max_relative = 1e-9);
        assert!(state.gap().unwrap().values().iter().all(|gap| *gap > -1e-9));
    }
    // The glassy body flows at once; then the contact grows and its pressure falls.
    let [first, .., last] = [0, 1, 4].map(|k| states[k].plastic.unwrap());
    assert!(first.volume > 0.0 && last.volume >= first.volume && last.area == 0.0);
    assert_relative_eq!(last.dissipated, pressure * last.volume, max_relative = 1e-12);
    // In no time it is the elastic and plastic contact of the glassy body.
    let mut elastic = hard.clone();
    (elastic.effects.rheology, elastic.contact_modulus) = (Rheology::Elastic, 4.0 * MODULUS);
    let expected = history(&MODEL, &elastic, &steps[..1]).remove(0);
    assert_relative_eq!(expected.plastic.unwrap().volume, first.volume, max_relative = 1e-6);
    // The work of the load is that of the force along the way, what flows included.
    let ramp: Vec<_> = (0..=80).map(|k| f64::from(k) / 80.0).map(|t| (t, Load::approach(0.02 * t))).collect();
    let states = history(&MODEL, &hard, &ramp);
    let by_trapezia: f64 = states
        .windows(2)
        .map(|pair| {
            0.5 * (pair[0].force + pair[1].force) * (pair[1].approach.unwrap() - pair[0].approach.unwrap())
        })
        .sum();
    assert!(states[80].plastic.unwrap().dissipated > 0.1 * by_trapezia);
    assert_relative_eq!(states[80].viscoelastic.unwrap().work.unwrap(), by_trapezia, max_relative = 5e-3);
    // A hardness that nothing reaches changes nothing.
    hard.effects.hardness = Hardness::Limit { pressure: 100.0 };
    let soft = history(&MODEL, &hard, &steps[..3]);
    let free = history(&MODEL, &scene(ball(), Boundary::Free, &SOLID), &steps[..3]);
    for (soft, free) in soft.iter().zip(free) {
        assert_relative_eq!(soft.approach.unwrap(), free.approach.unwrap(), max_relative = 1e-7);
    }
}

/// In no time the work of the load is the elastic energy of the glassy body.
#[test]
fn the_work_of_a_jump_is_the_elastic_energy() {
    let model = Bem3d { cells: 65, ..MODEL };
    let scene = scene(ball(), Boundary::Free, &SOLID);
    let states = history(
        &model,
        &scene,
        &[(0.0, Load::force(0.01)), (0.0, Load::force(0.03)), (0.0, Load::force(0.0))],
    );
    for state in &states[..2] {
        let energy = 0.4 * state.force * state.approach.unwrap();
        assert_relative_eq!(state.viscoelastic.unwrap().work.unwrap(), energy, max_relative = 2e-3);
    }
    let left = states[2].viscoelastic.unwrap().work.unwrap() / states[1].viscoelastic.unwrap().work.unwrap();
    assert!(left.abs() < 1e-6, "{left}");
}

/// An error below what the solver leaves is no reason to go on cutting steps.
#[test]
fn steps_end_where_the_solver_decides() {
    let model = Bem3d { cells: 24, tolerance: 1e-4, time_tolerance: 1e-9, ..Bem3d::DEFAULT };
    let mut contact = model.prepare(&scene(rough(), Boundary::Periodic, &SOLID), 3).unwrap();
    let steps: usize = [0.0, 1.0, 30.0]
        .into_iter()
        .map(|time| contact.advance(Step::new(time, Load::force(0.002))).unwrap())
        .map(|state| state.viscoelastic.unwrap().time_steps)
        .sum();
    assert!(steps < 3000, "{steps}");
}

/// With periodic boundaries the load works along the fall of the mean gap, up and down; a profile has no zero.
#[test]
fn the_work_of_periodic_and_line_contacts() {
    let viscous = scene(rough(), Boundary::Periodic, &SOLID);
    let steps: Vec<_> = (0..=200)
        .map(|k| f64::from(k) / 100.0)
        .map(|t| (t, Load::force(0.004 + 0.016 * if t < 1.0 { t } else { 2.0 - t })))
        .collect();
    let states = history(&MODEL, &viscous, &steps);
    let work = |state: &ContactState| state.viscoelastic.unwrap().work.unwrap();
    let by_trapezia = |states: &[ContactState]| -> f64 {
        states
            .windows(2)
            .map(|pair| {
                0.5 * (pair[0].force + pair[1].force)
                    * (pair[0].mean_gap.unwrap() - pair[1].mean_gap.unwrap())
            })
            .sum()
    };
    for (from, to) in [(0, 100), (100, 200), (0, 200)] {
        let (found, expected) = (work(&states[to]) - work(&states[from]), by_trapezia(&states[from..=to]));
        assert!((found - expected).abs() < 5e-3 * work(&states[100]), "{from} {to}: {found} {expected}");
    }
    let line = scene(rough(), Boundary::PeriodicAlongX, &SOLID);
    let state = history(&MODEL, &line, &[(0.0, Load::force(0.01))]).remove(0);
    assert!(state.viscoelastic.unwrap().work.is_none());
}

/// Rubber under a rigid ball, with friction; nu = 1/2, so that nothing is coupled.
fn sliding(rheology: &Rheology, friction: f64) -> Scene {
    let body = Body::Elastic { young: 0.75 * MODULUS, poisson: 0.5 };
    let mut scene = Scene::of_pair(ball(), Pair { first: Body::Rigid, second: body }).unwrap();
    scene.effects.rheology = *rheology;
    scene.effects.friction = Friction::coulomb(friction);
    scene.outputs = Outputs { area: true, stick_area: true, traction: true, ..Outputs::default() };
    scene.outputs.pressure = true;
    scene
}

fn pushed(force: f64, tangential: f64) -> Load {
    Load::force(force).with_tangential(Tangential::Force([tangential, 0.0]))
}

fn displaced(approach: f64, tangential: f64) -> Load {
    Load::approach(approach).with_tangential(Tangential::Displacement([tangential, 0.0]))
}

/// At a held displacement tractions relax as the modulus does, and as the pressures do that limit them: what sticks and
/// what slips stays.
#[test]
fn tractions_relax_as_pressures_do() {
    let scene = sliding(&SOLID, 0.3);
    let load = displaced(0.02, 0.004);
    let states = history(&MODEL, &scene, &[(0.0, load), (1.0, load), (7.0, load), (60.0, load)]);
    let of = |state: &ContactState| state.tangential.unwrap();
    let first = of(&states[0]);
    assert!(first.stick_area.unwrap() > 0.0 && first.slip_area.unwrap() > 0.0, "{first:?}");
    for state in &states {
        let modulus = 1.0 + 3.0 * (-state.time.unwrap() / 2.0_f64).exp();
        assert_relative_eq!(of(state).force[0] / first.force[0], modulus / 4.0, max_relative = 1e-6);
        assert_relative_eq!(of(state).stick_area.unwrap(), first.stick_area.unwrap());
        assert_relative_eq!(of(state).dissipated, first.dissipated, max_relative = 1e-6);
        assert!(state.viscoelastic.unwrap().tangential_time_errors.unwrap()[0] < 1e-6);
    }
}

/// Two bodies of one material have one function of time: they are as one of half the modulus under a rigid body, also
/// with friction.
#[test]
fn two_bodies_of_one_material_relax_together() {
    let one = sliding(&SOLID, 0.3);
    let rubber = Body::Elastic { young: 1.5 * MODULUS, poisson: 0.5 };
    let mut two = Scene::of_pair(ball(), Pair { first: rubber, second: rubber }).unwrap();
    (two.effects, two.outputs) = (one.effects, one.outputs);
    let steps = [(0.0, pushed(0.01, 0.0)), (1.0, pushed(0.02, 0.003)), (9.0, pushed(0.02, 0.001))];
    let numbers = |state: &ContactState| {
        let tangential = state.tangential.unwrap();
        [state.approach.unwrap(), tangential.displacement[0], tangential.dissipated, state.area.unwrap()]
    };
    for (a, b) in history(&MODEL, &one, &steps).iter().zip(&history(&MODEL, &two, &steps)) {
        for (a, b) in numbers(a).into_iter().zip(numbers(b)) {
            assert_relative_eq!(a, b, max_relative = 1e-9, epsilon = 1e-15);
        }
    }
}

/// A tangential force in no time on a contact that has relaxed meets the glassy body, and its displacement creeps as a
/// body under one force does: the tractions of Cattaneo stay as they are.
#[test]
fn a_tangential_force_on_a_relaxed_contact_creeps() {
    let scene = sliding(&SOLID, 0.3);
    let mut elastic = scene.clone();
    elastic.effects.rheology = Rheology::Elastic;
    let (force, tangential) = (0.01, 0.5 * 0.3 * 0.01);
    let still = [(1.0, pushed(force, 0.0)), (2.0, pushed(force, tangential))];
    let expected = history(&MODEL, &elastic, &still).pop().unwrap();
    let times = [200.0, 200.5, 202.0, 210.0, 400.0];
    let mut steps = vec![(0.0, pushed(force, 0.0)), (200.0, pushed(force, 0.0))];
    steps.extend(times.map(|time| (time, pushed(force, tangential))));
    for state in &history(&MODEL, &scene, &steps)[2..] {
        let creep = creep(&SOLID, state.time.unwrap() - 200.0);
        let (found, expected) = (state.tangential.unwrap(), expected.tangential.unwrap());
        let error = 1e-5 + state.viscoelastic.unwrap().tangential_time_errors.unwrap()[1];
        assert_relative_eq!(found.displacement[0], creep * expected.displacement[0], max_relative = error);
        assert_relative_eq!(found.stick_area.unwrap(), expected.stick_area.unwrap(), max_relative = 0.02);
        assert_relative_eq!(found.force[0], tangential);
    }
}

/// Normal and tangential force that grow in one ratio below the coefficient of friction let nothing slip: tractions are
/// that ratio of the pressures, and so are the displacements in bodies of E* = G* that have one function of time.
#[test]
fn a_load_of_one_direction_sticks() {
    let scene = sliding(&SOLID, 0.5);
    let model = Bem3d { time_tolerance: 1e-4, ..MODEL };
    let states = history(&model, &scene, &[(4.0, pushed(0.01, 0.002)), (8.0, pushed(0.01, 0.002))]);
    // 1/G* over 1/E* of an incompressible body is 3/2.
    let compliance = 1.5;
    for state in &states {
        let of = state.tangential.unwrap();
        let ratio = of.displacement[0] / state.approach.unwrap();
        // Contact grows by whole cells.
        assert_relative_eq!(ratio, 0.2 * compliance, max_relative = 0.03);
        assert!(of.slip_area.unwrap() < 0.35 * state.area.unwrap(), "{of:?}");
        let fields = state.fields.as_ref().unwrap();
        let [along, across] = fields.traction.as_ref().unwrap();
        let pressure = fields.pressure.as_ref().unwrap();
        let force: f64 = pressure.values().iter().sum();
        let along = along.values().iter().zip(pressure.values()).map(|(q, p)| (q - 0.2 * p).abs());
        let across = across.values().iter().map(|q| q.abs());
        let [along, across] = [along.sum::<f64>() / force, across.sum::<f64>() / force];
        assert!(along < 0.02 && across < 0.02, "{along} {across}");
    }
}

/// A path with friction goes on to the same bits from its memory.
#[test]
fn friction_goes_on_from_a_memory() {
    let scene = sliding(&SOLID, 0.3);
    let steps = [
        (1.0, pushed(0.01, 0.001)),
        (2.0, pushed(0.01, 0.0025)),
        (2.0, pushed(0.008, 0.001)),
        (5.0, pushed(0.006, -0.001)),
        (6.0, displaced(0.0, 0.0)),
        (9.0, displaced(0.01, 0.002)),
    ];
    let whole = history(&MODEL, &scene, &steps);
    for cut in 1..steps.len() {
        let mut contact = MODEL.prepare(&scene, 3).unwrap();
        for &(time, load) in &steps[..cut] {
            contact.advance(Step::new(time, load)).unwrap();
        }
        let memory = contact.memory().unwrap().unwrap();
        let mut other = MODEL.prepare(&scene, 3).unwrap();
        other.recall(&memory).unwrap();
        for (&(time, load), expected) in steps[cut..].iter().zip(&whole[cut..]) {
            assert_eq!(other.advance(Step::new(time, load)).unwrap(), *expected, "{cut} {time}");
        }
    }
}

/// A ball that attracts: its range is some cells long, and the contact is one of tens of cells.
fn sticky(rheology: &Rheology, law: AdhesionLaw) -> Scene {
    let mut scene = scene(ball(), Boundary::Free, rheology);
    scene.effects.adhesion = Adhesion::FiniteRange { work: 0.01, range: 0.02, law };
    scene
}

/// Pressures displace as the integral of the modulus over the past says, by sums over pairs of cells; beside the
/// contact they are the attraction of the gap. The largest difference from the integral, relative to the largest
/// displacement, with this number of states a unit of time.
fn beside_the_integral(law: AdhesionLaw, states: u32) -> f64 {
    const SIDE: usize = 16;
    let model = Bem3d { cells: SIDE, tolerance: 1e-9, time_tolerance: 1.0, ..Bem3d::DEFAULT };
    let mut scene = sticky(&SOLID, law);
    scene.surface = Surface::Sphere { radius: 1.0, size: 0.4.into() };
    (scene.outputs.pressure, scene.outputs.displacement, scene.outputs.gap) = (true, true, true);
    // In, a rest and out.
    let at = |time: f64| 0.02 + 0.03 * time.min(1.0) - 0.03 * (time - 2.0).max(0.0);
    let times = (1..=3 * states).map(|k| f64::from(k) / f64::from(states));
    let steps: Vec<_> = times.map(|time| (time, Load::approach(at(time)))).collect();
    let found = history(&model, &scene, &steps);
    let closed: Vec<_> = found.iter().map(|state| state.report.contact_cells.unwrap()).collect();
    assert!(
        closed[states as usize - 1] > closed[0] && closed[closed.len() - 1] < closed[2 * states as usize - 1]
    );
    let place = |i: usize| (i % SIDE, i / SIDE);
    let influence = |i: usize, j: usize| {
        let ((x, y), (other_x, other_y)) = (place(i), place(j));
        love::influence_of_rectangle(x.abs_diff(other_x), y.abs_diff(other_y), 1.0)
    };
    let unit = 0.4 / SIDE as f64 / (std::f64::consts::PI * MODULUS);
    let (mut arm, mut before, mut worst) = (vec![0.0; SIDE * SIDE], vec![0.0; SIDE * SIDE], 0.0_f64);
    let angle = 1.0 / f64::from(states) / ARM.time;
    for state in &found {
        let fields = state.fields.as_ref().unwrap();
        let [p, u, g] = [&fields.pressure, &fields.displacement, &fields.gap]
            .map(|field| field.as_ref().unwrap().values());
        for ((q, u), before) in arm.iter_mut().zip(u).zip(&before) {
            *q = (-angle).exp() * *q - (-angle).exp_m1() / angle * (u - before);
        }
        before = u.to_vec();
        let largest = u.iter().zip(&arm).fold(0.0, |most: f64, (u, q)| most.max((u + 3.0 * q).abs()));
        for i in 0..SIDE * SIDE {
            let pressed = (0..SIDE * SIDE).map(|j| influence(i, j) * p[j]).sum::<f64>() * unit;
            worst = worst.max((pressed - u[i] - 3.0 * arm[i]).abs() / largest);
            let attraction = match law {
                AdhesionLaw::Dugdale if g[i] < 0.02 => 0.5,
                AdhesionLaw::Dugdale => 0.0,
                _ => 0.5 * (-g[i] / 0.02).exp(),
            };
            assert!(g[i] < 1e-6 || (p[i] + attraction).abs() < 1e-5, "{i}: {} {attraction}", p[i]);
        }
    }
    worst
}

#[test]
fn an_attraction_has_a_history_too() {
    for law in [AdhesionLaw::Exponential, AdhesionLaw::Dugdale] {
        let [coarse, fine] = [10, 40].map(|states| beside_the_integral(law, states));
        assert!(fine < 2e-3 && fine < 0.4 * coarse, "{law:?}: {coarse} {fine}");
    }
}

/// In no time the body is glassy, and at rest it becomes the relaxed one.
#[test]
fn both_limits_of_adhesion_are_elastic() {
    let scene = sticky(&SOLID, AdhesionLaw::Exponential);
    let load = Load::approach(0.03);
    let states = history(&MODEL, &scene, &[(0.0, load), (400.0, load)]);
    for (state, factor) in states.iter().zip([4.0, 1.0]) {
        let mut elastic = scene.clone();
        elastic.effects.rheology = Rheology::Elastic;
        elastic.contact_modulus *= factor;
        let expected = MODEL.prepare(&elastic, 3).unwrap().solve(load).unwrap();
        assert_relative_eq!(state.force, expected.force, max_relative = 1e-4);
        let (cells, expected) = (state.report.contact_cells.unwrap(), expected.report.contact_cells.unwrap());
        assert!(cells.abs_diff(expected) <= 2, "{cells} {expected}");
        let adhesive = state.adhesive.unwrap();
        assert!(adhesive.stability > 0.0 && adhesive.energy.is_none());
        assert_eq!(state.viscoelastic.unwrap().work, None);
    }
}

/// A pull that a contact bears for some time, and not for long: it comes off on the way.
#[test]
fn what_is_drawn_off_fast_holds_more() {
    let scene = sticky(&SOLID, AdhesionLaw::Exponential);
    let largest = |speed: f64| {
        let mut contact = MODEL.prepare(&scene, 3).unwrap();
        // Pressed for long, so that the contact is that of the relaxed body.
        contact.advance(Step::new(0.0, Load::approach(0.04))).unwrap();
        contact.advance(Step::new(100.0, Load::approach(0.04))).unwrap();
        (1..=40)
            .map(|k| {
                let way = 0.004 * f64::from(k);
                let step = Step::new(100.0 + way / speed, Load::approach(0.04 - way));
                -contact.advance(step).unwrap().force
            })
            .fold(0.0, f64::max)
    };
    let [slow, fast] = [1e-4, 1.0].map(largest);
    assert!(fast > 2.0 * slow && slow > 0.0, "{slow} {fast}");
    // The pull of the relaxed body is the least that holds for ever.
    let mut contact = MODEL.prepare(&scene, 3).unwrap();
    let held = |time, force| Step::new(time, Load::force(force));
    contact.advance(held(0.0, 0.05)).unwrap();
    contact.advance(held(100.0, 0.05)).unwrap();
    let between = 0.5 * (slow + fast);
    let state = contact.advance(held(100.01, -between)).unwrap();
    assert!(state.force < 0.0 && state.area.unwrap() > 0.0);
    let Err(Error::NotConverged { best }) = contact.advance(held(200.0, -between)) else {
        panic!("it holds")
    };
    assert_eq!(best.report.status, Status::PulledOff);
    assert_relative_eq!(best.force, -between, max_relative = 1e-6);
    assert_eq!(best.time, Some(100.01));
    // The path is where it was.
    assert!(contact.advance(held(100.02, 0.0)).unwrap().area.unwrap() > 0.0);
}

/// A path with adhesion goes on to the same bits from its memory, with a hardness and friction too.
#[test]
fn adhesion_goes_on_from_a_memory() {
    let body = Body::Elastic { young: 0.75 * MODULUS, poisson: 0.5 };
    let mut rubber = Scene::of_pair(ball(), Pair { first: Body::Rigid, second: body }).unwrap();
    let of = sticky(&SOLID, AdhesionLaw::Dugdale);
    (rubber.effects, rubber.outputs) = (of.effects, of.outputs);
    let mut hard = rubber.clone();
    hard.effects.hardness = Hardness::Limit { pressure: 1.0 };
    rubber.effects.friction = Friction::coulomb(0.3);
    for scene in [rubber, hard] {
        let steps =
            [(0.0, 0.02), (1.0, 0.05), (2.0, 0.05), (3.0, 0.01), (3.0, 0.02), (8.0, -0.01), (9.0, -0.3)];
        let loads = steps.map(|(time, d)| (time, Load::approach(d)));
        let whole = history(&MODEL, &scene, &loads);
        assert_eq!(whole[6].area, Some(0.0));
        for cut in [1, 3, 5, 6] {
            let mut contact = MODEL.prepare(&scene, 3).unwrap();
            for &(time, load) in &loads[..cut] {
                contact.advance(Step::new(time, load)).unwrap();
            }
            let memory = contact.memory().unwrap().unwrap();
            let mut other = MODEL.prepare(&scene, 3).unwrap();
            other.recall(&memory).unwrap();
            for (&(time, load), expected) in loads[cut..].iter().zip(&whole[cut..]) {
                assert_eq!(other.advance(Step::new(time, load)).unwrap(), *expected, "{cut} {time}");
            }
        }
    }
}
