//! The ensembles of a command with their fitted laws, and functions that several claims use.

use super::solved::height_ratio;
use super::table::{ClaimRow, ClaimedNumber, Reason};
use crate::claim::Estimate;
use crate::evaluation::{EnsembleModel, Measured, Series, WindowedLaw, law_over_forces_of, windowed_law};
use analysis::{Bootstrap, Curves, FitWindow, FittedPowerLaw, fit_power_law, interpolate};
use runs::{Error, Result};

/// The ensembles that a command has solved.
pub(crate) struct Ensembles<'a>(Vec<EnsembleLaws<'a>>);

/// An ensemble and the law of each of its series, or the reason why there is none.
pub(super) struct EnsembleLaws<'a> {
    pub measured: &'a Measured,
    pub laws: Vec<std::result::Result<SeriesLaw, Reason>>,
    /// Of lines beside surfaces: the laws over the forces over which surfaces of the same D_f are fitted.
    pub same_forces: Vec<std::result::Result<SeriesLaw, Reason>>,
}

/// A power law of one series, with the uncertainty of its window.
#[derive(Debug, Clone)]
pub(crate) struct SeriesLaw {
    /// D_f.
    pub fractal_dimension: f64,
    /// The fit over the window of Figs. 3 and 7.
    pub fit: FittedPowerLaw,
    /// alpha, with its interval from the scatter and, in quadrature, the largest change with other windows
    /// and the discretisation error.
    pub alpha: Estimate,
    /// The same of zeta.
    pub zeta: Estimate,
    /// The discretisation error in alpha's half-width.
    pub grid: f64,
}

impl<'a> Ensembles<'a> {
    /// The ensembles with their laws.
    pub fn new(measured: &[&'a Measured]) -> Self {
        let of_model = |model| measured.iter().copied().find(|m| m.discretisation.of() == model);
        let solid = of_model(EnsembleModel::Bem3d);
        let of = |&measured: &&'a Measured| {
            let laws = measured.series.iter().map(|series| SeriesLaw::new(measured, series)).collect();
            let lines = solid.filter(|_| measured.discretisation.of() == EnsembleModel::Mdr1d);
            let beside = lines.into_iter().flat_map(|solid| solid.series.iter().zip(&measured.series));
            let same_forces =
                beside.map(|(solid, line)| SeriesLaw::over_forces_of(solid, measured, line)).collect();
            EnsembleLaws { measured, laws, same_forces }
        };
        Self(measured.iter().map(of).collect())
    }

    /// The one of a model.
    ///
    /// # Errors
    /// [`Error::Parameter`] for one that the command does not have.
    pub(super) fn of(&self, model: EnsembleModel) -> Result<&EnsembleLaws<'a>> {
        let ensemble = self.0.iter().find(|e| e.measured.discretisation.of() == model);
        ensemble.ok_or_else(|| Error::parameter("model", model.name(), "one that the command solves"))
    }
}

impl EnsembleLaws<'_> {
    /// A row for each series.
    pub fn each(&self, found: impl Fn(&Series) -> ClaimedNumber) -> Vec<ClaimRow> {
        self.measured
            .series
            .iter()
            .map(|series| ClaimRow::at(series.fractal_dimension, found(series)))
            .collect()
    }

    /// A row for each series, from its law.
    pub fn each_law(&self, found: impl Fn(&Series, &SeriesLaw) -> ClaimedNumber) -> Vec<ClaimRow> {
        let row = |(series, law): (&Series, &std::result::Result<SeriesLaw, Reason>)| {
            ClaimRow::at(
                series.fractal_dimension,
                law.as_ref().map_err(Reason::clone).and_then(|law| found(series, law)),
            )
        };
        self.measured.series.iter().zip(&self.laws).map(row).collect()
    }

    /// Series of both models at each D_f.
    pub fn beside<'b>(&'b self, line: &'b Self) -> impl Iterator<Item = (&'b Series, &'b Series)> {
        self.measured.series.iter().zip(&line.measured.series)
    }

    /// rms height of these lines over that of surfaces of the same D_f, where both have one spectrum: a force
    /// that is F_bar by the height of the surface is F_bar over this ratio by that of the line.
    pub fn height_ratio(&self, solid: &Self, fractal_dimension: f64) -> Result<f64> {
        let [elements, cells] = [self, solid].map(|e| e.measured.discretisation.size());
        height_ratio(fractal_dimension, elements, cells)
    }

    /// Surfaces of each D_f.
    pub fn surfaces(&self) -> usize {
        self.measured.series.first().map_or(0, |series| series.realisations.len())
    }
}

impl SeriesLaw {
    /// The law of a series, or the reason why there is none.
    pub fn new(measured: &Measured, series: &Series) -> std::result::Result<Self, Reason> {
        Self::of(series, windowed_law(measured, series)?)
    }

    /// The law of lines over the forces over which surfaces are fitted, or the reason why there is none.
    pub fn over_forces_of(
        surfaces: &Series,
        lines: &Measured,
        series: &Series,
    ) -> std::result::Result<Self, Reason> {
        Self::of(series, law_over_forces_of(surfaces, lines, series)?)
    }

    fn of(series: &Series, windowed: WindowedLaw) -> std::result::Result<Self, Reason> {
        let WindowedLaw { fit, windows, grid } = windowed;
        let grid = grid.ok_or("no coarser grid says what this one leaves")?;
        let estimate = |value: f64, error: Option<f64>, window: f64, grid: f64| {
            let scatter = Estimate::normal(value, error).ok_or(ONE_SURFACE)?;
            Ok::<_, Reason>(scatter.widened(window).widened(grid))
        };
        Ok(Self {
            fractal_dimension: series.fractal_dimension,
            alpha: estimate(fit.alpha, fit.alpha_se, windows.0, grid.0)?,
            zeta: estimate(fit.zeta, fit.zeta_se, windows.1, fit.zeta * grid.1)?,
            grid: grid.0,
            fit,
        })
    }

    /// The window in words.
    pub fn window(&self) -> String {
        let FittedPowerLaw { force_bar_min, force_bar_max, points, .. } = self.fit;
        format!("{points} loads, {force_bar_min:.1e} to {force_bar_max:.1e}")
    }

    /// The loads of the fit, regardless of the number of cells in contact.
    pub fn loads(&self) -> FitWindow {
        FitWindow::between(self.fit.force_bar_min, self.fit.force_bar_max)
    }
}

/// The reason why a scatter is missing.
pub(super) const ONE_SURFACE: &str = "one surface has no scatter";

/// The law fitted to the surfaces `draw`, without an error.
pub(super) fn law_of(curves: &Curves, window: &FitWindow, draw: &[usize]) -> Option<FittedPowerLaw> {
    let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
    fit_power_law(&curves.resampled(draw), window, &once).ok()
}

/// A number that is computed from a choice of surfaces: its value for all surfaces, and its scatter over
/// resampled ones.
pub(super) fn resampled(surfaces: usize, number: impl Fn(&[usize]) -> Option<f64>) -> Option<Estimate> {
    let all: Vec<usize> = (0..surfaces).collect();
    Estimate::normal(number(&all)?, Bootstrap::default().standard_error(surfaces, number))
}

/// k_bar at any force of the curve.
pub(super) fn stiffness_at(series: &Series, force_bar: f64) -> Option<Estimate> {
    let forces = series.curves.force_bar();
    let value = interpolate(forces, &series.means(), force_bar)?;
    let error = Bootstrap::default().standard_error(series.realisations.len(), |draw| {
        interpolate(forces, &series.curves.mean_of(draw), force_bar)
    });
    Estimate::normal(value, error)
}
