//! What several groups of claims need.

use analysis::{Bootstrap, FittedPowerLaw, interpolate};
use evaluation::{FittedLaw, Measured, Series};

/// Uncertainty of alpha that independent values have (data/paper/VALUES.md).
pub(super) fn alpha_allowed(d: f64) -> f64 {
    if d > 2.9 { 0.08 } else { 0.03 }
}

/// How a model is called in a claim.
pub(super) fn label(measured: &Measured) -> &'static str {
    if measured.discretisation.name() == "bem3d" { "3D" } else { "1D" }
}

/// k_bar at any force of the curve, with the standard error of its mean.
pub(super) fn stiffness_at(series: &Series, force_bar: f64) -> Option<(f64, Option<f64>)> {
    let forces = series.curves.force_bar();
    let value = interpolate(forces, &series.means(), force_bar)?;
    let error = Bootstrap::default().standard_error(series.units.len(), |draw| {
        interpolate(forces, &series.curves.mean_of(draw), force_bar)
    });
    Some((value, error))
}

/// A window shorter than this says little about a power law.
const LEAST_DECADES: f64 = 1.0;

/// A fit that can be judged, or why it cannot.
pub(super) fn usable(law: &FittedLaw) -> Result<&FittedPowerLaw, String> {
    let fit = law.fit.as_ref().map_err(ToString::to_string)?;
    let decades = (fit.force_bar_max / fit.force_bar_min).log10();
    if decades < LEAST_DECADES {
        return Err(format!(
            "the window {:.1e} .. {:.1e} spans {decades:.2} decades, at least {LEAST_DECADES} is needed: finer grids widen it",
            fit.force_bar_min, fit.force_bar_max
        ));
    }
    Ok(fit)
}
