//! What Figs. 3 and 7 have in common: the fitted power laws.

use crate::grid_error::law_error;
use crate::measured::{Measured, Series};
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
    let law = |s: &Series| FittedLaw {
        model: measured.discretisation.name(),
        fractal_dimension: s.fractal_dimension,
        fit: fit_power_law(&s.curves, window, &Bootstrap::default()),
    };
    measured.series.iter().map(law).collect()
}

/// Floors of contact cells and upper ends of the window between which the exponents of one series are compared.
const FLOORS: [usize; 3] = [10, 30, 100];
const LARGEST: [f64; 2] = [0.086, 0.03];
/// A window shorter than this says little about a power law; the windows beside it may be half as long.
const LEAST_DECADES: f64 = 1.0;

/// A law over [`FitWindow::PAPER`] and what other windows make of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowedLaw {
    /// The law.
    pub fit: FittedPowerLaw,
    /// Largest changes of alpha and of zeta with floors of 30 and 100 contact cells on every surface and an upper end of 0.03, over at least
    /// half a decade.
    pub windows: (f64, f64),
    /// 95 % half-widths of alpha and of ln zeta that the grid leaves; `None` without coarser grids.
    pub grid: Option<(f64, f64)>,
}

/// The law of a series, or why there is none to judge.
///
/// # Errors
/// Words: too few loads, or a window of less than a decade.
pub fn windowed_law(measured: &Measured, series: &Series) -> Result<WindowedLaw, String> {
    let law = |floor: usize, largest: f64| {
        let window = FitWindow { max_force_bar: largest, min_contact_cells: floor, ..FitWindow::PAPER };
        let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
        let errors = if (floor, largest) == (FLOORS[0], LARGEST[0]) { Bootstrap::default() } else { once };
        fit_power_law(&series.curves, &window, &errors).map_err(|e| e.to_string())
    };
    let decades = |fit: &FittedPowerLaw| (fit.force_bar_max / fit.force_bar_min).log10();
    let fit = law(FLOORS[0], LARGEST[0])?;
    if decades(&fit) < LEAST_DECADES {
        return Err(format!(
            "the window {:.1e} to {:.1e} spans {:.2} decades, at least {LEAST_DECADES} is needed: finer grids widen it",
            fit.force_bar_min,
            fit.force_bar_max,
            decades(&fit)
        ));
    }
    let others = FLOORS.iter().flat_map(|&floor| LARGEST.map(|largest| law(floor, largest)));
    let windows = others.filter_map(Result::ok).filter(|other| decades(other) >= 0.5 * LEAST_DECADES).fold(
        (0.0, 0.0),
        |(alpha, zeta), other| {
            (f64::max(alpha, (other.alpha - fit.alpha).abs()), f64::max(zeta, (other.zeta - fit.zeta).abs()))
        },
    );
    let grid = measured.coarser_at(series.fractal_dimension).and_then(|coarser| law_error(series, coarser));
    Ok(WindowedLaw { fit, windows, grid })
}

/// 2.0, 2.05 .. 3.0 and the given ones: where formulas are tabulated.
pub fn dense_dimensions(given: &[f64]) -> Vec<f64> {
    let mut all: Vec<f64> = (0..=20).map(|i| f64::from(200 + 5 * i) / 100.0).collect();
    all.extend_from_slice(given);
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| a.total_cmp(b).is_eq());
    all
}
