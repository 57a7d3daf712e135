//! The fitted power laws of Figs. 3 and 7.

use crate::evaluation::measured::{Measured, Series};
use crate::evaluation::run::distinct;
use analysis::{
    Bootstrap, EnsemblePoint, FitWindow, FittedPowerLaw, NoFit, error_from_moments, fit_power_law,
    least_squares,
};

/// Power laws of an ensemble over a window, one for each fractal dimension, or why there is none; errors by
/// bootstrap over surfaces.
pub fn laws(measured: &Measured, window: &FitWindow) -> Vec<Result<FittedPowerLaw, NoFit>> {
    measured.series.iter().map(|s| fit_power_law(&s.curves, window, &Bootstrap::default())).collect()
}

/// Floors of contact cells and upper ends of the window between which the exponents of one series are
/// compared.
const FLOORS: [usize; 3] = [10, 30, 100];
const LARGEST: [f64; 2] = [0.086, 0.03];
/// A window shorter than this is too short for a power law; the windows that it is compared with may be half
/// as long.
const LEAST_DECADES: f64 = 1.0;

/// A law over [`FitWindow::PAPER`], and its changes with other windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowedLaw {
    /// The law.
    pub fit: FittedPowerLaw,
    /// Largest changes of alpha and of zeta with floors of 30 and 100 contact cells on every surface and an
    /// upper end of 0.03, over at least half a decade.
    pub windows: (f64, f64),
    /// 95 % half-widths of alpha and of ln zeta due to the grid; `None` without coarser grids.
    pub grid: Option<(f64, f64)>,
}

/// [`FitWindow::PAPER`], and the windows with which its law is compared.
fn windows() -> impl Iterator<Item = FitWindow> {
    let with = |min_contact_cells| {
        LARGEST.map(|max_force_bar| FitWindow { max_force_bar, min_contact_cells, ..FitWindow::PAPER })
    };
    FLOORS.into_iter().flat_map(with)
}

/// The law of a series, or the reason why there is none.
///
/// # Errors
/// The reason in words: too few loads, or a window of less than a decade.
pub fn windowed_law(measured: &Measured, series: &Series) -> Result<WindowedLaw, String> {
    law_over(measured, series, windows().map(Ok))
}

/// The law of a series of lines over the forces over which surfaces of the same D_f are fitted, in each of the
/// windows: exponents that are compared have the same forces.
///
/// # Errors
/// As [`windowed_law`], of the lines or of the surfaces.
pub fn law_over_forces_of(
    surfaces: &Series,
    measured: &Measured,
    series: &Series,
) -> Result<WindowedLaw, String> {
    let forces = |window: FitWindow| {
        let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
        let fit = fit_power_law(&surfaces.curves, &window, &once).map_err(|e| e.to_string())?;
        Ok(FitWindow::between(fit.force_bar_min, fit.force_bar_max))
    };
    law_over(measured, series, windows().map(forces))
}

/// The law over the first of these windows, and how it changes with the others that exist.
fn law_over(
    measured: &Measured,
    series: &Series,
    mut windows: impl Iterator<Item = Result<FitWindow, String>>,
) -> Result<WindowedLaw, String> {
    let law = |window: &FitWindow, errors: &Bootstrap| {
        fit_power_law(&series.curves, window, errors).map_err(|e| e.to_string())
    };
    let decades = |fit: &FittedPowerLaw| (fit.force_bar_max / fit.force_bar_min).log10();
    let window = windows.next().ok_or("no window")??;
    let fit = law(&window, &Bootstrap::default())?;
    if decades(&fit) < LEAST_DECADES {
        return Err(format!(
            "the window {:.1e} to {:.1e} spans {:.2} decades, at least {LEAST_DECADES} is needed: finer grids widen it",
            fit.force_bar_min,
            fit.force_bar_max,
            decades(&fit)
        ));
    }
    let once = Bootstrap { resamples: 0, ..Bootstrap::default() };
    let others = windows.filter_map(|window| law(&window.ok()?, &once).ok());
    let windows = others.filter(|other| decades(other) >= 0.5 * LEAST_DECADES).fold(
        (0.0, 0.0),
        |(alpha, zeta), other| {
            (f64::max(alpha, (other.alpha - fit.alpha).abs()), f64::max(zeta, (other.zeta - fit.zeta).abs()))
        },
    );
    let coarser = measured.coarser_at(series.fractal_dimension);
    let grid = coarser.and_then(|coarser| law_error(series, coarser, &window));
    Ok(WindowedLaw { fit, windows, grid })
}

/// The fractal dimensions 2.0, 2.05 .. 3.0 and the given ones, at which formulas are tabulated.
pub fn dense_dimensions(given: &[f64]) -> Vec<f64> {
    let steps = (0..=20).map(|i| f64::from(200 + 5 * i) / 100.0);
    distinct(steps.chain(given.iter().copied()))
}

/// 95 % half-widths of alpha and of ln zeta from the coarser grids, over the forces that the finest resolves.
/// Where a coarser one does not, its difference is too large, and so is the half-width.
fn law_error(series: &Series, [half, quarter]: [&Series; 2], window: &FitWindow) -> Option<(f64, f64)> {
    let all = [series, half, quarter];
    let resolved = |p: &EnsemblePoint| {
        (window.min_force_bar..=window.max_force_bar).contains(&p.force_bar)
            && p.min_contact_cells.is_none_or(|c| c >= window.min_contact_cells)
    };
    let inside: Vec<usize> = (0..series.points.len()).filter(|&j| resolved(&series.points[j])).collect();
    let law = |s: &Series, draw: &[usize]| {
        let (means, forces) = (s.curves.mean_of(draw), s.curves.force_bar());
        let points: Vec<(f64, f64)> =
            inside.iter().filter_map(|&j| Some((forces[j].ln(), means[j]?.ln()))).collect();
        least_squares(&points).filter(|_| points.len() >= 3)
    };
    // Differences of alpha and of ln zeta between neighbouring grids.
    let differences = |draw: &[usize]| {
        let [fine, half, quarter] = [law(all[0], draw)?, law(all[1], draw)?, law(all[2], draw)?];
        Some([[half.0 - fine.0, quarter.0 - half.0], [half.1 - fine.1, quarter.1 - half.1]])
    };
    let surfaces = all.iter().map(|s| s.realisations.len()).min().unwrap_or(0);
    let whole: Vec<usize> = (0..surfaces).collect();
    let found = differences(&whole)?;
    let draws: Vec<[[f64; 2]; 2]> =
        Bootstrap::default().draws(surfaces).iter().filter_map(|draw| differences(draw)).collect();
    if surfaces < 2 || draws.len() < 2 {
        return None;
    }
    let error = |part: usize| {
        let moment = |a: usize, b: usize| {
            let [x, y] = [found[part][a], found[part][b]];
            let scatter = draws.iter().map(|d| (d[part][a] - x) * (d[part][b] - y));
            x * y + analysis::sum(scatter) / draws.len() as f64
        };
        error_from_moments(found[part][0], [moment(0, 0), moment(1, 1), moment(0, 1)], surfaces)
    };
    Some((error(0), error(1)))
}
