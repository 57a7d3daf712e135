//! Adhesion through the common traits: closed forms, paths, energies and refusals.

#![allow(clippy::unwrap_used, clippy::float_cmp)] // Tests.

use bem3d::{
    Adhesion, AdhesionLaw, Bem3d, Boundary, Branch, ContactModel, ContactState, Error, Hardness, HeightMap,
    Load, Outputs, PreparedContact, Scene, SelfAffine, Step, Surface, Tangential,
};
use std::f64::consts::PI;
use std::sync::Arc;

const EXPONENTIAL: AdhesionLaw = AdhesionLaw::Exponential;
const DUGDALE: AdhesionLaw = AdhesionLaw::Dugdale;

fn with(surface: Surface, work: f64, range: f64, law: AdhesionLaw) -> Scene {
    let mut scene = Scene::new(surface, 1.0);
    scene.effects.adhesion = Adhesion::FiniteRange { work, range, law };
    scene.outputs.area = true;
    scene
}

fn map(cells: usize, side: f64, height: impl Fn(usize, usize) -> f64) -> Surface {
    Surface::Heights(Arc::new(HeightMap::from_fn(cells, side, height).unwrap()))
}

fn history(model: Bem3d, scene: &Scene) -> Box<dyn PreparedContact> {
    ContactModel::prepare(&model, scene, 1).unwrap()
}

fn at(history: &mut dyn PreparedContact, load: Load) -> Result<ContactState, Error> {
    history.advance(Step::new(0.0, load))
}

/// A sphere with R = E* = 1 and the range 1e-4 under Tabor's parameter mu = (R w^2/(E*^2 range^3))^(1/3).
/// `half`: half of the side, in `(pi w R^2/K)^(1/3)` with K = 4/3 E*, Maugis's unit of the contact radius.
/// Returns the scene, the unit of approaches and pi w R.
fn sphere(mu: f64, half: f64) -> (Scene, f64, f64) {
    let range = 1e-4f64;
    let work = (mu * range).powf(1.5);
    let unit = (PI * work * 0.75).cbrt();
    let surface = Surface::Sphere { radius: 1.0, size: (2.0 * half * unit).into() };
    let mut scene = with(surface, work, range, EXPONENTIAL);
    scene.outputs.stiffness = false;
    (scene, unit * unit, PI * work)
}

/// Pull-off force over pi w R, found by withdrawing through these approaches.
fn pull_off(mu: f64, (cells, half): (usize, f64), approaches: impl Iterator<Item = f64>) -> f64 {
    let (scene, unit, force) = sphere(mu, half);
    let mut history = history(Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() }, &scene);
    approaches
        .map(|d| at(&mut *history, Load::approach(d * unit)).unwrap().force / force)
        .fold(f64::INFINITY, f64::min)
}

fn down(from: f64, to: f64, steps: u32) -> impl Iterator<Item = f64> {
    (0..=steps).map(move |i| from + (to - from) * f64::from(i) / f64::from(steps))
}

#[test]
fn a_hard_sphere_has_the_pull_off_force_two_pi_w_r() {
    let found = pull_off(0.02, (128, 24.0), down(0.3, -0.3, 12));
    assert!((found + 2.0).abs() < 0.02, "{found}");
}

#[test]
fn nothing_attracts_without_work() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0).unwrap());
    let elastic = Scene::new(surface.clone(), 1.0);
    let without = Scene { outputs: elastic.outputs, ..with(surface, 0.0, 0.1, EXPONENTIAL) };
    let mut short = without.clone();
    short.effects.adhesion = Adhesion::ShortRange { work: 0.0 };
    let model = Bem3d { cells: 32, ..Bem3d::default() };
    let load = Load::force(0.5);
    let expected = ContactModel::prepare(&model, &elastic, 3).unwrap().solve(load).unwrap();
    for without in [without, short] {
        assert_eq!(ContactModel::prepare(&model, &without, 3).unwrap().solve(load).unwrap(), expected);
        let mut history = ContactModel::prepare(&model, &without, 3).unwrap();
        assert_eq!(at(&mut *history, load).unwrap(), expected.clone().with_time(0.0));
        assert!(at(&mut *history, Load::force(-0.1)).is_err());
    }
}

/// A single load begins from no contact, independent of earlier solves.
#[test]
fn a_single_load_is_on_the_branch_of_approach() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0).unwrap());
    let scene = with(surface, 0.3, 0.3, EXPONENTIAL);
    let model = Bem3d { cells: 32, tolerance: 1e-7, ..Bem3d::default() };
    let mut contact = ContactModel::prepare(&model, &scene, 3).unwrap();
    let first = contact.solve(Load::approach(0.2)).unwrap();
    contact.solve(Load::approach(2.0)).unwrap();
    let again = contact.solve(Load::approach(0.2)).unwrap();
    assert_eq!((again.force, again.adhesive.unwrap().branch), (first.force, Branch::Approach));
    let mut history = ContactModel::prepare(&model, &scene, 3).unwrap();
    at(&mut *history, Load::approach(2.0)).unwrap();
    let withdrawn = at(&mut *history, Load::approach(0.2)).unwrap();
    assert_eq!(withdrawn.adhesive.unwrap().branch, Branch::Withdrawal);
}

/// Single loads that increase follow from each other: each state is that of its load alone, with less work.
#[test]
fn increasing_loads_continue_from_the_last_state() {
    // What the tolerance leaves open of forces and of approaches, relative to the largest.
    const SAME: f64 = 1e-5;
    let surface = Surface::SelfAffine(SelfAffine::new(2.3, 1.0, 0.1).unwrap());
    let finite = |law| Adhesion::FiniteRange { work: 1e-3, range: 0.05, law };
    let model = Bem3d { cells: 48, tolerance: 1e-7, ..Bem3d::default() };
    let laws = [
        ("short range", Adhesion::ShortRange { work: 1e-3 }, Boundary::Free),
        ("exponential", finite(EXPONENTIAL), Boundary::Free),
        ("exponential, periodic", finite(EXPONENTIAL), Boundary::Periodic),
        ("Dugdale", Adhesion::FiniteRange { work: 5e-4, range: 0.05, law: DUGDALE }, Boundary::Free),
    ];
    for (name, adhesion, boundary) in laws {
        let mut scene = Scene::new(surface.clone(), 1.0);
        (scene.effects.adhesion, scene.effects.boundary) = (adhesion, boundary);
        scene.outputs =
            Outputs { area: true, mean_gap: boundary == Boundary::Periodic, ..Outputs::default() };
        let prepared = || ContactModel::prepare(&model, &scene, 3).unwrap();
        let forces = [0, 1, 2, 3, 4, 5, 6].map(|i| Load::force(2e-3 * 1.2f64.powi(i)));
        let approaches = [-0.02, 0.02, 0.03, 0.04, 0.05, 0.06, 0.07].map(Load::approach);
        for loads in if boundary == Boundary::Free { vec![forces, approaches] } else { vec![forces] } {
            let mut contact = prepared();
            let sweep = loads.map(|load| contact.solve(load).unwrap());
            let alone = loads.map(|load| prepared().solve(load).unwrap());
            let largest = alone.last().unwrap();
            for (state, alone) in sweep.iter().zip(&alone) {
                let near =
                    |a: f64, b: f64, scale: f64| assert!((a - b).abs() <= SAME * scale, "{name}: {a} {b}");
                near(state.force, alone.force, largest.force);
                near(state.area.unwrap(), alone.area.unwrap(), largest.area.unwrap());
                let plane = |state: &ContactState| state.approach.or(state.mean_gap).unwrap();
                near(plane(state), plane(alone), 0.1);
                assert_eq!(state.report.contact_cells, alone.report.contact_cells, "{name}");
                assert_eq!(state.adhesive.unwrap().branch, Branch::Approach);
                assert!(state.report.certificate.meets(model.tolerance));
            }
            let work = |states: &[ContactState]| states.iter().map(|s| s.report.applications).sum::<usize>();
            let (together, each) = (work(&sweep), work(&alone));
            println!("{name}, {:?}: {together} applications, {each} alone", loads[0]);
            assert!(together <= each, "{name}: {together} {each}");
            // A smaller load begins anew: no branch of withdrawal.
            let again = contact.solve(loads[2]).unwrap();
            assert_eq!(again.adhesive.unwrap().branch, Branch::Approach);
            assert!((again.force - alone[2].force).abs() <= SAME * largest.force, "{name}");
            assert!((again.area.unwrap() - alone[2].area.unwrap()).abs() <= SAME, "{name}");
        }
    }
}

/// `k = dF/dd` of a periodic contact, the mean gap lowered by d, with the motion of the attraction.
#[test]
fn stiffness_of_a_periodic_contact_is_the_slope_of_its_force() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0).unwrap());
    let mut scene = with(surface, 0.05, 0.3, EXPONENTIAL);
    scene.effects.boundary = Boundary::Periodic;
    scene.outputs.mean_gap = true;
    let model = Bem3d { cells: 32, tolerance: 1e-9, ..Bem3d::default() };
    let mut history = ContactModel::prepare(&model, &scene, 3).unwrap();
    let [low, middle, high] = [0.999, 1.0, 1.001].map(|f| at(&mut *history, Load::force(0.5 * f)).unwrap());
    let slope = (high.force - low.force) / (low.mean_gap.unwrap() - high.mean_gap.unwrap());
    let k = middle.stiffness.unwrap();
    assert!((k / slope - 1.0).abs() < 5e-3, "{k} {slope}");
}

/// Rounding of the gaps would hide a smaller range, a larger one the surface.
#[test]
fn ranges_beyond_the_scales_of_the_surface_are_refused() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0).unwrap());
    let prepared = |adhesion: Adhesion| {
        let mut scene = Scene::new(surface.clone(), 1.0);
        scene.effects.adhesion = adhesion;
        ContactModel::prepare(&Bem3d { cells: 8, ..Bem3d::default() }, &scene, 3).map(|_| ())
    };
    assert!(prepared(Adhesion::ShortRange { work: 1e-6 }).is_ok());
    // Of weak laws, which any cell resolves.
    let weak = |range: f64| Adhesion::FiniteRange { work: 1e-6 * range * range, range, law: EXPONENTIAL };
    for range in [2e-9, 5e8] {
        assert!(prepared(weak(range)).is_ok(), "{range}");
    }
    for (adhesion, (name, expected)) in [
        (weak(5e-10), ("range of adhesion", "is outside [1e-9, 1")),
        (weak(2e9), ("range of adhesion", "is outside [1e-9, 1")),
        (Adhesion::ShortRange { work: 1e-30 }, ("work of adhesion", "by the heights of the surface")),
        (Adhesion::ShortRange { work: 1e30 }, ("work of adhesion", "by the heights of the surface")),
    ] {
        let message = prepared(adhesion).unwrap_err().to_string();
        assert!(message.starts_with(name) && message.contains(expected), "{message}");
    }
}

/// A small work of adhesion changes the state little.
#[test]
fn a_small_work_of_adhesion_changes_little() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0).unwrap());
    let model = Bem3d { cells: 32, tolerance: 1e-8, ..Bem3d::default() };
    let load = Load::force(0.5);
    let solve = |scene: &Scene| ContactModel::prepare(&model, scene, 3).unwrap().solve(load).unwrap();
    let elastic = solve(&Scene::new(surface.clone(), 1.0)).approach.unwrap();
    let shifts =
        [1e-3, 1e-4].map(|w| solve(&with(surface.clone(), w, 0.5, EXPONENTIAL)).approach.unwrap() - elastic);
    assert!(shifts[0] > 0.0 && (shifts[0] / shifts[1] - 10.0).abs() < 0.2, "{shifts:?}");
}

#[test]
fn a_flat_holds_its_area_times_the_largest_traction_at_most() {
    let (work, range) = (1e-3, 0.1);
    let scene = with(Surface::Flat { size: 1.0.into() }, work, range, EXPONENTIAL);
    let mut history = history(Bem3d { cells: 12, ..Bem3d::default() }, &scene);
    let touching = at(&mut *history, Load::force(1e-3)).unwrap();
    assert_eq!(touching.report.contact_cells, Some(144));
    let adhesive = touching.adhesive.unwrap();
    assert!((adhesive.energy.unwrap() + work).abs() < 0.02 * work, "{adhesive:?}");
    let pulled = at(&mut *history, Load::force(-0.9 * work / range)).unwrap();
    assert_eq!(pulled.adhesive.unwrap().branch, Branch::Withdrawal);
    // The history stays where it was.
    let Err(Error::NotConverged { best }) = at(&mut *history, Load::force(-1.1 * work / range)) else {
        panic!()
    };
    assert_eq!(best.force, pulled.force);
    let again = at(&mut *history, Load::force(pulled.force)).unwrap();
    assert!((again.approach.unwrap() / pulled.approach.unwrap() - 1.0).abs() < 1e-6);
}

/// A plateau on a compliant half-space: it snaps in at a smaller approach than that at which it snaps off.
#[test]
fn a_plateau_snaps_in_and_off_and_loses_energy() {
    let plateau = map(24, 1.0, |x, y| if (6..18).contains(&x) && (6..18).contains(&y) { 0.0 } else { -5.0 });
    let scene = with(plateau, 0.04, 0.1, EXPONENTIAL);
    let mut history = history(Bem3d { cells: 24, ..Bem3d::default() }, &scene);
    let path = |low: f64, high: f64, n: usize| -> Vec<f64> {
        (0..=n).map(|i| low + (high - low) * i as f64 / n as f64).collect()
    };
    let states = |history: &mut dyn PreparedContact, path: &[f64]| -> Vec<ContactState> {
        path.iter().map(|&d| at(history, Load::approach(d)).unwrap()).collect()
    };
    let (up, back) = (path(-0.8, 0.1, 90), path(0.1, -0.8, 90));
    let (rising, falling) = (states(&mut *history, &up), states(&mut *history, &back));
    let first = rising.iter().position(|s| s.report.contact_cells > Some(0)).unwrap();
    let last = falling.iter().position(|s| s.report.contact_cells == Some(0)).unwrap();
    // A rigid punch on a spring: beta = (A w/range^2)/k, k = 1.1419 E* L; in at -d = range (1 + ln beta), off
    // at range beta. The edge of a punch gives way before its middle does, and a step is 0.01.
    let beta: f64 = 0.25 * 0.04 / 0.01 / (1.1419 * 0.5);
    assert!((up[first] + 0.1 * (1.0 + beta.ln())).abs() < 0.015, "{}", up[first]);
    assert!((back[last] + 0.1 * beta).abs() < 0.015, "{}", back[last]);
    assert!(up[first] > back[last] + 0.015, "{} {}", up[first], back[last]);
    let work = |states: &[ContactState], path: &[f64]| -> f64 {
        let pairs = states.windows(2).zip(path.windows(2));
        pairs.map(|(s, d)| 0.5 * (s[0].force + s[1].force) * (d[1] - d[0])).sum()
    };
    let lost = work(&rising, &up) + work(&falling, &back);
    assert!(lost > 0.0, "{lost}");
    // Without a jump the work of the load is what is stored.
    let before = first - 1;
    let stored =
        rising[before].adhesive.unwrap().energy.unwrap() - rising[0].adhesive.unwrap().energy.unwrap();
    let done = work(&rising[..=before], &up[..=before]);
    assert!((stored / done - 1.0).abs() < 0.01, "{stored} {done}");
    for state in rising.iter().chain(&falling) {
        assert!(state.adhesive.unwrap().stability > 0.0 && state.report.certificate.meets(1e-6));
    }
}

#[test]
fn a_single_summit_and_a_strong_attraction() {
    let summit = map(21, 1.0, |x, y| if (x, y) == (10, 10) { 0.0 } else { -10.0 });
    let scene = with(summit, 0.01, 0.1, EXPONENTIAL);
    let state = ContactModel::prepare(&Bem3d::default(), &scene, 0).unwrap().solve(Load::force(0.0)).unwrap();
    assert_eq!(state.report.contact_cells, Some(1));
    // All of a gentle surface jumps in.
    let gentle = map(24, 1.0, |x, y| 1e-3 * ((x as f64).sin() + (y as f64).cos()));
    let scene = with(gentle, 0.02, 0.1, EXPONENTIAL);
    let state = ContactModel::prepare(&Bem3d::default(), &scene, 0).unwrap().solve(Load::force(0.0)).unwrap();
    assert_eq!(state.report.contact_cells, Some(24 * 24));
}

#[test]
fn a_periodic_surface_in_full_contact_carries_tension() {
    let waves = map(24, 1.0, |x, _| 1e-3 * (2.0 * PI * x as f64 / 24.0).cos());
    let mut scene = with(waves, 0.01, 0.1, EXPONENTIAL);
    scene.effects.boundary = Boundary::Periodic;
    (scene.outputs.stiffness, scene.outputs.pressure, scene.outputs.mean_gap) = (false, true, true);
    let mut history = history(Bem3d::default(), &scene);
    assert_eq!(at(&mut *history, Load::force(0.1)).unwrap().report.contact_cells, Some(576));
    let state = at(&mut *history, Load::force(-0.05)).unwrap();
    assert_eq!(state.report.contact_cells, Some(576));
    // The pressure of a flat wave: mean -0.05 and pi E* h/lambda cos.
    let p = state.pressure().unwrap().values();
    let (mean, most) = (p.iter().sum::<f64>() / 576.0, p.iter().copied().fold(f64::MIN, f64::max));
    assert!(
        (mean + 0.05).abs() < 1e-9 && (most - mean - PI * 1e-3).abs() < 0.02 * PI * 1e-3,
        "{mean} {most}"
    );
}

#[test]
fn a_mean_gap_is_met_along_a_path() {
    let surface = Surface::SelfAffine(SelfAffine::new(2.2, 1.0, 0.05).unwrap());
    let mut scene = with(surface, 0.01, 0.1, EXPONENTIAL);
    scene.effects.boundary = Boundary::Periodic;
    (scene.outputs.stiffness, scene.outputs.mean_gap) = (false, true);
    let mut history = history(Bem3d { cells: 32, ..Bem3d::default() }, &scene);
    for gap in [0.3, 0.15, 0.1, 0.05, 0.1, 0.15, 0.3] {
        let state = at(&mut *history, Load::mean_gap(gap)).unwrap();
        assert!((state.mean_gap.unwrap() - gap).abs() < 1e-6, "{gap} {:?}", state.mean_gap);
    }
}

#[test]
fn oblong_cells_agree_with_square_ones() {
    let force = |cells: usize, rows: usize| {
        let (mut scene, unit, force) = sphere(0.3, 6.0);
        scene.outputs.stiffness = false;
        let model = Bem3d { cells, rows: Some(rows), ..Bem3d::default() };
        let mut history = history(model, &scene);
        at(&mut *history, Load::approach(0.2 * unit)).unwrap().force / force
    };
    let (square, oblong) = (force(96, 96), force(96, 72));
    assert!((square / oblong - 1.0).abs() < 0.01, "{square} {oblong}");
}

#[test]
fn a_single_pull_begins_in_contact() {
    let (scene, _, force) = sphere(0.3, 6.0);
    let model = Bem3d { cells: 96, ..Bem3d::default() };
    let mut contact = ContactModel::prepare(&model, &scene, 0).unwrap();
    let state = contact.solve(Load::force(-force)).unwrap();
    assert!((state.force / force + 1.0).abs() < 1e-6);
    assert_eq!(state.adhesive.unwrap().branch, Branch::Withdrawal);
    assert!(matches!(contact.solve(Load::force(-2.1 * force)), Err(Error::NotConverged { .. })));
    // Nothing is remembered.
    assert_eq!(contact.solve(Load::force(0.0)).unwrap().adhesive.unwrap().branch, Branch::Approach);
}

#[test]
fn invalid_parameters_are_refused() {
    let flat = || Surface::Flat { size: 1.0.into() };
    let prepared = |scene: &Scene| ContactModel::prepare(&Bem3d { cells: 8, ..Bem3d::default() }, scene, 0);
    for (work, range) in [(f64::NAN, 0.1), (-1.0, 0.1), (0.1, 0.0), (0.1, f64::NAN), (f64::INFINITY, 0.1)] {
        assert!(matches!(prepared(&with(flat(), work, range, DUGDALE)), Err(Error::Domain { .. })));
    }
    for work in [f64::NAN, -1.0, f64::INFINITY, 1e300] {
        let mut scene = with(flat(), 0.1, 0.1, DUGDALE);
        scene.effects.adhesion = Adhesion::ShortRange { work };
        scene.contact_modulus = if work > 1.0 { 1e-300 } else { 1.0 };
        assert!(matches!(prepared(&scene), Err(Error::Domain { .. })), "{work}");
    }
    // Cells of 1/8 under a range of 1e-3: told with the side that would do.
    let Err(Error::OutOfRange { name, value, max, .. }) = prepared(&with(flat(), 0.01, 1e-3, EXPONENTIAL))
    else {
        panic!()
    };
    assert_eq!((&*name, value), (bem3d::UNRESOLVED_RANGE, 0.125));
    assert!((1.78e-5..1.79e-5).contains(&max), "{max}");
    let mut scene = with(flat(), 0.01, 0.1, EXPONENTIAL);
    scene.effects.hardness = Hardness::Limit { pressure: 1.0 };
    assert!(prepared(&scene).is_ok());
    scene.effects.adhesion = Adhesion::ShortRange { work: 0.01 };
    assert!(matches!(prepared(&scene), Err(Error::Unsupported { .. })));
    let mut history = prepared(&with(flat(), 0.01, 0.1, EXPONENTIAL)).unwrap();
    for load in [Load::force(f64::NAN), Load::approach(f64::INFINITY), Load::mean_gap(0.1)] {
        assert!(at(&mut *history, load).is_err(), "{load:?}");
    }
    let twisted = Step::new(0.0, Load::force(0.0).with_tangential(Tangential::force_along_x(1.0)));
    assert!(matches!(history.advance(twisted), Err(Error::Unsupported { .. })));
}
