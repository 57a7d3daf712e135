//! dlnk/dlnF = 1/(1 + n) for `z = c r^n`, n standing for H: solver, normalisation, curves and fit together.

use analysis::{Bootstrap, Curves, FitWindow, StiffnessSample, fit_power_law};
use bem3d::Bem3d;
use contact_model::{ContactModel, Load, Scene, Surface};
use mdr1d::Mdr1d;

/// Fits the stiffness of one model at forces over a decade and a half.
fn exponent(model: &dyn ContactModel, n: f64, least: f64) -> f64 {
    let scene = Scene::new(Surface::PowerLaw { coefficient: 0.05, exponent: n, size: 1.0.into() }, 1.0);
    let mut contact = model.prepare(&scene, 0).unwrap();
    let normalisation = contact.normalisation();
    // A body has no rms height: F_bar counts in E* L^2. The largest contact radius is 0.4 L.
    let largest = exact_force(n, 0.4);
    let force: Vec<f64> = (0..12).map(|i| largest * least.powf(f64::from(11 - i) / 11.0)).collect();
    let row = force
        .iter()
        .map(|&f| {
            let state = contact.solve(Load::force(f)).unwrap();
            Some(StiffnessSample {
                stiffness_bar: normalisation.stiffness_bar(state.stiffness.unwrap()),
                contact_cells: state.report.contact_cells,
            })
        })
        .collect();
    let curves = Curves::new(force, vec![row]).unwrap();
    fit_power_law(&curves, &FitWindow::PAPER, &Bootstrap::default()).unwrap().alpha
}

/// `F = 2 E* d a n/(n + 1)`, `d = kappa_n c a^n`.
fn exact_force(n: f64, radius: f64) -> f64 {
    let kappa = analytic::power_law_body::kappa(n).unwrap();
    2.0 * kappa * 0.05 * radius.powf(n + 1.0) * n / (n + 1.0)
}

/// The smallest contact is 10 cells wide, and its edge is a staircase: k scatters by 1 % there, the slope
/// over a decade of radii by 1e-3.
const STAIRCASE: f64 = 2.5e-3;
/// Formulas: rounding of ln over twelve points.
const CLOSED_FORM: f64 = 1e-10;

#[test]
fn power_law_bodies_give_one_over_one_plus_n() {
    for n in [0.5, 1.0, 2.0] {
        let exact = 1.0 / (1.0 + n);
        // A decade of contact radii.
        let least = exact_force(n, 0.04) / exact_force(n, 0.4);
        let bem = exponent(&Bem3d { cells: 129, tolerance: 1e-8, ..Bem3d::default() }, n, least);
        approx::assert_abs_diff_eq!(bem, exact, epsilon = STAIRCASE);
        approx::assert_abs_diff_eq!(exponent(&Mdr1d::default(), n, least), exact, epsilon = CLOSED_FORM);
        approx::assert_abs_diff_eq!(
            exponent(&analytic::PowerLawBody, n, least),
            exact,
            epsilon = CLOSED_FORM
        );
    }
}
