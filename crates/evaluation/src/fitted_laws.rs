//! What Figs. 3 and 7 have in common: the fitted power laws.

use crate::measured::Measured;
use analysis::{Bootstrap, FitWindow, FittedPowerLaw, NoFit, fit_power_law};

/// A fitted law, or why there is none.
#[derive(Debug, Clone, PartialEq)]
pub struct FittedLaw {
    /// `bem3d` or `mdr1d`.
    pub model: &'static str,
    /// D_f.
    pub fractal_dimension: f64,
    /// The fit.
    pub fit: Result<FittedPowerLaw, NoFit>,
}

/// Power laws of an ensemble, one per fractal dimension, over [`FitWindow::PAPER`]; errors by bootstrap over surfaces.
pub fn laws(measured: &Measured) -> Vec<FittedLaw> {
    laws_within(measured, &FitWindow::PAPER)
}

/// The same over another window.
pub fn laws_within(measured: &Measured, window: &FitWindow) -> Vec<FittedLaw> {
    let law = |s: &crate::measured::Series| FittedLaw {
        model: measured.discretisation.name(),
        fractal_dimension: s.fractal_dimension,
        fit: fit_power_law(&s.curves, window, &Bootstrap::default()),
    };
    measured.series.iter().map(law).collect()
}

/// 2.0, 2.05 .. 3.0 and the given ones: where formulas are tabulated.
pub fn dense_dimensions(given: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = (0..=20).map(|i| f64::from(200 + 5 * i) / 100.0).collect();
    all.extend_from_slice(given);
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| a.total_cmp(b).is_eq());
    all
}
