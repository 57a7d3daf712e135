//! What several groups of claims need.

use crate::claim::Estimate;
use analysis::{Bootstrap, FittedPowerLaw, interpolate};
use evaluation::{Measured, Series, WindowedLaw, windowed_law};

/// How a model is called in a claim.
pub(super) fn label(measured: &Measured) -> &'static str {
    if measured.discretisation.name() == "bem3d" { "3D" } else { "1D" }
}

/// k_bar at any force of the curve.
pub(super) fn stiffness_at(series: &Series, force_bar: f64) -> Option<Estimate> {
    let forces = series.curves.force_bar();
    let value = interpolate(forces, &series.means(), force_bar)?;
    let error = Bootstrap::default().standard_error(series.units.len(), |draw| {
        interpolate(forces, &series.curves.mean_of(draw), force_bar)
    });
    Estimate::normal(value, error)
}

/// A power law of one series, with what its window leaves.
#[derive(Debug, Clone)]
pub(super) struct Law {
    /// D_f.
    pub fractal_dimension: f64,
    /// The fit over the window of Figs. 3 and 7.
    pub fit: FittedPowerLaw,
    /// alpha: scatter and, in quadrature, the largest change with other windows and what the grid leaves.
    pub alpha: Estimate,
    /// The same of zeta.
    pub zeta: Estimate,
    /// The part of alpha's half-width that the grid leaves.
    pub grid: f64,
}

impl Law {
    /// The window in words.
    pub fn window(&self) -> String {
        let FittedPowerLaw { force_bar_min, force_bar_max, points, .. } = self.fit;
        format!("{points} loads, {force_bar_min:.1e} to {force_bar_max:.1e}")
    }
}

/// What the intervals of exponents hold.
pub(super) const INTERVAL: &str = "the interval holds scatter, floors of 10, 30 and 100 cells, upper ends of 0.086 and 0.03, and what the grid leaves";

/// The law of a series, or why there is none to judge.
fn law(measured: &Measured, series: &Series) -> Result<Law, String> {
    let WindowedLaw { fit, windows, grid } = windowed_law(measured, series)?;
    let grid = grid.ok_or("no coarser grid says what this one leaves")?;
    let estimate = |value: f64, error: Option<f64>, window: f64, grid: f64| {
        let scatter = Estimate::normal(value, error).ok_or("one surface has no scatter")?;
        Ok::<_, String>(Estimate { value, half_width: scatter.half_width.hypot(window).hypot(grid) })
    };
    Ok(Law {
        fractal_dimension: series.fractal_dimension,
        alpha: estimate(fit.alpha, fit.alpha_se, windows.0, grid.0)?,
        zeta: estimate(fit.zeta, fit.zeta_se, windows.1, fit.zeta * grid.1)?,
        grid: grid.0,
        fit,
    })
}

/// The laws of all series, in their order.
pub(super) fn laws(measured: &Measured) -> Vec<Result<Law, String>> {
    measured.series.iter().map(|series| law(measured, series)).collect()
}

/// Mean of independent surfaces with Student's interval.
pub(super) fn mean_of(each: &[f64]) -> Option<Estimate> {
    let (value, deviation) = analysis::mean_and_deviation(each)?;
    let n = each.len() as f64;
    Some(Estimate { value, half_width: analysis::student(n - 1.0) * deviation? / n.sqrt() })
}

/// Independent numbers: `a/b`.
pub(super) fn ratio(a: Estimate, b: Estimate) -> Estimate {
    let value = a.value / b.value;
    Estimate { value, half_width: value.abs() * (a.half_width / a.value).hypot(b.half_width / b.value) }
}

/// Independent numbers: `a - b`.
pub(super) fn difference(a: Estimate, b: Estimate) -> Estimate {
    Estimate { value: a.value - b.value, half_width: a.half_width.hypot(b.half_width) }
}
