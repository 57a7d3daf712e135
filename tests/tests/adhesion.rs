//! Adhesion: two independent codes for the sphere with short-range adhesion, and boundary elements compared
//! with Maugis's sphere for a finite range.

use analytic::Jkr;
use analytic::maugis_dugdale::MaugisSphere;
use approx::assert_relative_eq;
use bem3d::Bem3d;
use contact_model::{
    Adhesion, AdhesionLaw, ContactModel, ContactState, Load, PreparedContact, Scene, Step, Surface,
};
use mdr1d::Mdr1d;
use std::f64::consts::PI;

/// Both are closed or iterated to rounding; a tenth away from a fold a root loses one digit.
const EXACT: f64 = 1e-12;

fn press(model: &dyn ContactModel, work: f64, load: Load) -> ContactState {
    let mut scene = Scene::new(Surface::Sphere { radius: 1.3, size: 2.0.into() }, 0.7);
    scene.effects.adhesion = Adhesion::ShortRange { work };
    (scene.outputs.area, scene.outputs.stiffness_fixed_area) = (true, true);
    model.prepare(&scene, 0).unwrap().solve(load).unwrap()
}

#[test]
fn mdr_is_jkr_for_a_sphere() {
    for work in [0.0, 1e-12, 1e-6, 1e-3, 1e-2] {
        let pull_off = 1.5 * std::f64::consts::PI * work * 1.3;
        for force in [-0.9 * pull_off, 0.0, 0.1 * pull_off, 1e-6, 0.05] {
            let (one, other) =
                (press(&Jkr, work, Load::force(force)), press(&Mdr1d::default(), work, Load::force(force)));
            assert_relative_eq!(one.area.unwrap(), other.area.unwrap(), max_relative = EXACT);
            for pick in [|s: &ContactState| s.stiffness, |s: &ContactState| s.stiffness_fixed_area] {
                assert_relative_eq!(pick(&one).unwrap(), pick(&other).unwrap(), max_relative = EXACT);
            }
            let d = one.approach.unwrap();
            assert_relative_eq!(
                d,
                other.approach.unwrap(),
                max_relative = EXACT,
                epsilon = EXACT * one.area.unwrap()
            );
            let (one, other) =
                (press(&Jkr, work, Load::approach(d)), press(&Mdr1d::default(), work, Load::approach(d)));
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
    // U = U_el - w A along the equilibrium, F = dU/dd: the whole of JKR in one sentence. A central difference
    // of second order.
    let work = 1e-3;
    for (model, name) in models() {
        let energy = |d: f64| {
            let area = press(model, work, Load::approach(d)).area.unwrap();
            elastic_energy(d, (area / std::f64::consts::PI).sqrt()) - work * area
        };
        for d in [-0.005, 0.0, 0.01, 0.1] {
            let force = press(model, work, Load::approach(d)).force;
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
    // a^3 = (3R/4E*) (F + 3 pi w R + sqrt(6 pi w R F + ...)): the difference falls as sqrt(w), and with it
    // that of the stiffness of the held area. The approach is the slope of an energy that a itself leaves
    // stationary: there it is w dA/dF, of first order; and so is the difference of the stiffness along the
    // branch, its inverse derivative.
    let force = 0.01;
    let elastic = press(&Jkr, 0.0, Load::force(force));
    for (model, name) in models() {
        let difference = |work: f64| {
            let state = press(model, work, Load::force(force));
            [
                state.area.unwrap() / elastic.area.unwrap() - 1.0,
                state.stiffness_fixed_area.unwrap() / elastic.stiffness.unwrap() - 1.0,
                state.stiffness.unwrap() / elastic.stiffness.unwrap() - 1.0,
                state.approach.unwrap() / elastic.approach.unwrap() - 1.0,
            ]
        };
        let works = [1e-8, 1e-10, 1e-12];
        let all = works.map(difference);
        for (which, fall) in [(0, 10.0), (1, 10.0), (2, 100.0), (3, 100.0)] {
            for pair in all.windows(2) {
                let ratio = pair[0][which] / pair[1][which];
                // But for terms of the next order in sqrt(w), and the rounding of a difference of 1e-10.
                assert!(pair[1][which] > 0.0 && (ratio / fall - 1.0).abs() < 0.01, "{name} {which}: {ratio}");
            }
        }
        let off = press(model, 0.0, Load::force(force));
        assert_relative_eq!(off.area.unwrap(), elastic.area.unwrap(), max_relative = EXACT);
        assert_relative_eq!(off.approach.unwrap(), elastic.approach.unwrap(), max_relative = EXACT);
    }
}

#[test]
fn a_stronger_adhesion_has_a_larger_contact_and_a_larger_pull_off_force() {
    for (model, name) in models() {
        let states = [0.0, 1e-6, 1e-4, 1e-2].map(|work| press(model, work, Load::force(0.01)));
        for pair in states.windows(2) {
            assert!(pair[1].area > pair[0].area && pair[1].approach > pair[0].approach, "{name}");
        }
        let states = [0.0, 1e-6, 1e-4, 1e-2].map(|work| press(model, work, Load::approach(0.01)));
        assert!(states.windows(2).all(|pair| pair[1].force < pair[0].force), "{name}");
    }
}

/// Dugdale's law on a sphere with R = E* = 1, on cells.
struct OnCells {
    exact: MaugisSphere,
    path: Box<dyn PreparedContact>,
    /// Maugis's unit of radii, `(3 pi w R^2/(4 E*))^(1/3)`; its square is that of approaches.
    unit: f64,
    /// pi w R.
    force: f64,
    /// Side of a cell in units.
    cell: f64,
}

impl OnCells {
    /// Maugis's lambda; `half` is half of the side in these units.
    fn new(lambda: f64, cells: usize, half: f64) -> Self {
        let range = 1e-4;
        let work = (lambda * range / 2.0 * (16.0 * PI / 9.0).cbrt()).powf(1.5);
        let unit = (0.75 * PI * work).cbrt();
        let exact = MaugisSphere::new(1.0, 1.0, work, range).unwrap();
        assert_relative_eq!(exact.lambda(), lambda, max_relative = EXACT);
        let surface = Surface::Sphere { radius: 1.0, size: (2.0 * half * unit).into() };
        let mut scene = Scene::new(surface, 1.0);
        scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: AdhesionLaw::Dugdale };
        (scene.outputs.area, scene.outputs.stiffness) = (true, false);
        let model = Bem3d { cells, tolerance: 1e-5, ..Bem3d::default() };
        let path = ContactModel::prepare(&model, &scene, 0).unwrap();
        Self { exact, path, unit, force: PI * work, cell: 2.0 * half / cells as f64 }
    }

    /// Force over pi w R and contact radius in units at an approach in units, the next one of a path.
    fn at(&mut self, approach: f64) -> (f64, f64) {
        let load = Load::approach(approach * self.unit * self.unit);
        let state = self.path.advance(Step::new(0.0, load)).unwrap();
        (state.force / self.force, (state.area.unwrap() / PI).sqrt() / self.unit)
    }

    /// The same in closed form.
    fn exactly_at(&self, approach: f64) -> (f64, f64) {
        let radius = self.exact.radius_at_approach(approach * self.unit * self.unit).unwrap();
        (self.exact.force(radius).unwrap() / self.force, radius / self.unit)
    }
}

/// lambda, half of the side in units, cells a side, and the largest differences of a force over pi w R and of
/// a radius, in cells.
///
/// The cohesive zone grows by whole cells, so that each branch deviates from the closed form by a share of a
/// cell, and the force by the traction on that share along the edge. Measured were 0.2, 1.2 and 4 cells for
/// the force and 0.3, 0.4 and 1.3 for the radius; the bounds are rounded up.
type AdhesionCase = (f64, f64, [usize; 2], (f64, f64));
const SPHERES: [AdhesionCase; 3] = [
    (0.3, 3.2, [64, 128], (0.3, 0.5)),
    (1.0, 2.4, [96, 192], (1.5, 0.6)),
    (2.0, 2.2, [160, 320], (5.0, 1.7)),
];
/// Error of the pull-off force extrapolated to cells of size zero, which depends on the position of the cells
/// relative to the edge.
const PULL_OFF: f64 = 0.01;

#[test]
fn cells_follow_maugis_on_both_branches() {
    for (lambda, half, grids, (in_force, in_radius)) in SPHERES {
        let mut least = 0.0;
        let pulled = grids.map(|cells| {
            let mut sphere = OnCells::new(lambda, cells, half);
            let exact = sphere.exact.pull_off_at_force().unwrap();
            let fold = exact.approach / (sphere.unit * sphere.unit);
            least = exact.force / sphere.force;
            // Approach and withdrawal.
            for d in [0.1, 0.6, 1.0, 0.7, 0.2, -0.2] {
                let ((force, radius), exact) = (sphere.at(d), sphere.exactly_at(d));
                let errors = ((force - exact.0) / sphere.cell, (radius - exact.1) / sphere.cell);
                let said = format!("{lambda} {cells} {d}: {errors:?} cells");
                assert!(errors.0.abs() < in_force && errors.1.abs() < in_radius, "{said}");
            }
            let around = (-4..=4).rev().map(|i| fold + 0.03 * f64::from(i));
            around.map(|d| sphere.at(d).0).fold(f64::INFINITY, f64::min)
        });
        // Between DMT and JKR, and of first order in the cell.
        assert!(pulled.iter().all(|force| (-2.0..-1.5).contains(force)), "{lambda} {pulled:?}");
        let extrapolated = 2.0 * pulled[1] - pulled[0];
        assert!((extrapolated / least - 1.0).abs() < PULL_OFF, "{lambda} {pulled:?} {extrapolated} {least}");
    }
}

#[test]
fn a_hard_sphere_with_adhesion_is_withdrawn_beyond_its_contact() {
    // Under lambda = 0.938 the contact shrinks to nothing while the surfaces still attract each other.
    let mut sphere = OnCells::new(0.1, 128, 4.0);
    let exact = sphere.exact.pull_off_at_force().unwrap().force / sphere.force;
    let last = sphere.exact.pull_off_at_approach().unwrap();
    assert!(last.radius <= 0.0);
    let drawn: Vec<(f64, f64)> = (0..=39).map(|i| sphere.at(0.5 - f64::from(i) / 30.0)).collect();
    let least = drawn.iter().map(|(force, _)| *force).fold(f64::INFINITY, f64::min);
    assert!((least / exact - 1.0).abs() < PULL_OFF, "{least} {exact}");
    let without: Vec<f64> =
        drawn.iter().filter(|(_, radius)| *radius <= 0.0).map(|(force, _)| *force).collect();
    assert!(without.len() > 5 && without.iter().all(|force| *force < 0.0), "{drawn:?}");
}
