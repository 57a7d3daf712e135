//! The estimated error of the stiffness covers the true one: loose solves compared with tight ones.

use bem3d::{Bem3d, Method};
use contact_model::{
    Body, Boundary, ContactModel, Coupling, Friction, Load, Pair, Scene, SelfAffine, Step, Surface,
};

/// Coverage: share of the true errors that lie inside their estimate.
const COVERAGE: f64 = 0.9;
/// Largest ratio of the median estimate to the true error: a larger bound would not be useful.
const OVERESTIMATE: f64 = 20.0;

#[test]
fn the_estimated_error_of_k_covers_the_true_one() {
    let forces: Vec<f64> = (0..8).map(|i| 0.03 * 2.5f64.powi(i)).collect();
    let mut ratios = Vec::new();
    for (cells, fractal_dimension, seed) in [(96, 2.0, 1), (129, 2.4, 2), (128, 2.8, 3), (150, 2.2, 4)] {
        let surface = Surface::SelfAffine(SelfAffine::new(fractal_dimension, 1.0, 1.0).unwrap());
        let scene = Scene::new(surface, 1.0);
        let sweep = |model: Bem3d| -> Vec<(f64, f64)> {
            let mut contact = model.prepare(&scene, seed).unwrap();
            let solve = |&f: &f64| {
                let state = contact.solve(Load::force(f)).unwrap();
                (state.stiffness.unwrap(), state.report.certificate.stiffness_error.unwrap())
            };
            forces.iter().map(solve).collect()
        };
        let exact = sweep(Bem3d { cells, tolerance: 1e-9, ..Bem3d::default() });
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let loose = sweep(Bem3d { cells, tolerance, method: Method::Iterative, ..Bem3d::default() });
            for ((k, estimate), (exact, _)) in loose.iter().zip(&exact) {
                assert!(*estimate <= tolerance);
                ratios.push((k / exact - 1.0).abs().max(1e-16) / estimate.max(1e-16));
            }
        }
    }
    ratios.sort_by(f64::total_cmp);
    let inside = ratios.iter().filter(|&&r| r <= 1.0).count() as f64 / ratios.len() as f64;
    let median = ratios[ratios.len() / 2];
    println!("{} solves: {inside:.3} inside, median true / estimated {median:.3}", ratios.len());
    assert!(inside >= COVERAGE, "only {inside} of the true errors lie inside their estimate");
    assert!(median >= 1.0 / OVERESTIMATE, "the estimates are {} times too large", 1.0 / median);
}

/// One of the steps of this path has a cell at the edge of contact on which the stiffness depends.
#[test]
fn the_stiffness_under_full_coupling_meets_its_tolerance() {
    let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 1.0, poisson: 0.2 } };
    let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 1.0.into() }, pair).unwrap();
    scene.effects.friction = Friction::coulomb(0.5).with_coupling(Some(Coupling::Full));
    let model = Bem3d { cells: 73, ..Bem3d::default() };
    let mut contact = model.prepare(&scene, 0).unwrap();
    for step in 1..=40 {
        let load = Load::force(0.05 / 40.0 * f64::from(step));
        let state = contact.advance(Step::new(f64::from(step), load)).unwrap();
        assert!(state.report.certificate.meets(model.tolerance), "{}", state.report.certificate);
    }
}

/// At a prescribed mean gap the stiffness is that of the gap asked for, and not only of the gap that was reached.
#[test]
fn of_a_prescribed_mean_gap() {
    for seed in 0..3 {
        let mut surface = SelfAffine::new(2.3, 1.0, 0.01).unwrap();
        surface.roll_off = Some(2.0);
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.effects.boundary = Boundary::Periodic;
        let solved = |tolerance: f64| {
            let mut contact =
                Bem3d { cells: 96, tolerance, ..Bem3d::default() }.prepare(&scene, seed).unwrap();
            let gaps = [0.018, 0.015, 0.01, 0.006, 0.004, 0.002];
            gaps.map(|gap| contact.solve(Load::mean_gap(gap)).unwrap())
        };
        for (rough, tight) in solved(1e-3).iter().zip(&solved(1e-9)) {
            let (k, exact) = (rough.stiffness.unwrap(), tight.stiffness.unwrap());
            let error = rough.report.certificate.error_of_stiffness().unwrap_or(0.0);
            assert!((k / exact - 1.0).abs() <= error + 1e-4, "seed {seed}: {k} {exact} {error}");
        }
    }
}
