//! alpha: Eqs. 6 and 24, 1D against 3D, 1D at small forces.

use super::common::{alpha_allowed, label, usable};
use analysis::{FitWindow, FittedPowerLaw};
use evaluation::{Claim, Measured, laws, laws_within};

fn window(fit: &FittedPowerLaw) -> String {
    format!("fit over {:.1e} .. {:.1e}, {} loads", fit.force_bar_min, fit.force_bar_max, fit.points)
}

fn against(measured: &Measured, name: &str, formula: impl Fn(f64) -> f64, why: &str) -> Vec<Claim> {
    laws(measured)
        .iter()
        .map(|law| {
            let d = law.fractal_dimension;
            let claim = format!("alpha {} at D_f = {d:?}, {name}", label(measured));
            match usable(law) {
                Ok(fit) => {
                    let allowed = alpha_allowed(d);
                    let why =
                        format!("{why}; {}; {allowed}: the uncertainty of independent values", window(fit));
                    Claim::within(claim, formula(d), fit.alpha, fit.alpha_se, allowed, why)
                }
                Err(reason) => Claim::not_tested(claim, formula(d), reason),
            }
        })
        .collect()
}

pub(super) fn against_the_fit(measured: &Measured) -> Vec<Claim> {
    against(measured, "Eq. 6", analytic::exponent_fit, "the paper's fit 0.266 D_f")
}

pub(super) fn against_the_scaling(measured: &Measured) -> Vec<Claim> {
    against(
        measured,
        "Eq. 24",
        |d| analytic::exponent_scaling(3.0 - d),
        "1/(1 + H), called exact in Sec. IV; the zoom argument needs a contact that is one region of a nonplanar surface, \
         which fails towards D_f = 3",
    )
}

pub(super) fn line_against_solid(solid: &Measured, line: &Measured) -> Vec<Claim> {
    laws(solid)
        .iter()
        .zip(&laws(line))
        .filter(|(a, _)| a.fractal_dimension <= 2.5)
        .map(|(a, b)| {
            let d = a.fractal_dimension;
            let claim = format!("alpha 1D minus alpha 3D at D_f = {d:?}");
            match (usable(a), usable(b)) {
                (Ok(a), Ok(b)) => {
                    // Different surfaces: independent errors.
                    let error = a.alpha_se.zip(b.alpha_se).map(|(x, y)| x.hypot(y));
                    let allowed = 2f64.sqrt() * alpha_allowed(d);
                    let why = "\"coincide almost exactly\" for D_f from 2 to 2.5 (Sec. III); 0.03 for each, in quadrature: the uncertainty of \
                               independent values";
                    Claim::within(claim, 0.0, b.alpha - a.alpha, error, allowed, why)
                }
                (Err(reason), _) | (_, Err(reason)) => Claim::not_tested(claim, 0.0, reason),
            }
        })
        .collect()
}

/// The 1D power law "down to 1e-7": the exponent of the lowest decades is that of the others.
pub(super) fn down_to_small_forces(line: &Measured) -> Vec<Claim> {
    let low = FitWindow { min_force_bar: 1e-7 * (1.0 - 1e-9), max_force_bar: 1e-4, ..FitWindow::PAPER };
    let high = FitWindow { min_force_bar: 1e-4, ..FitWindow::PAPER };
    laws_within(line, &low)
        .iter()
        .zip(&laws_within(line, &high))
        .map(|(a, b)| {
            let d = a.fractal_dimension;
            let claim = format!("alpha 1D below 1e-4 minus above, D_f = {d:?}");
            match (&a.fit, &b.fit) {
                // Two loads a decade at least, from within a factor 2.2 of 1e-7.
                (Ok(a), Ok(b)) if a.force_bar_min <= 2.2e-7 => {
                    let error = a.alpha_se.zip(b.alpha_se).map(|(x, y)| x.hypot(y));
                    let allowed = alpha_allowed(d);
                    let why = format!(
                        "\"power-law dependencies remain correct up to forces of 10^-7\" (Sec. III); {} below, {:.3} above; {allowed}: the \
                         uncertainty of independent values",
                        window(a),
                        b.alpha
                    );
                    Claim::within(claim, 0.0, a.alpha - b.alpha, error, allowed, why)
                }
                (Ok(a), Ok(_)) => Claim::not_tested(
                    claim,
                    0.0,
                    format!("all lines have 10 contact elements only from {:.1e} on: more elements are needed", a.force_bar_min),
                ),
                (Err(reason), _) | (_, Err(reason)) => Claim::not_tested(claim, 0.0, reason.to_string()),
            }
        })
        .collect()
}
