//! Error budgets: k = value +- algebraic +- discretisation +- ensemble, for each mean and for alpha and zeta.

use crate::fitted_laws::{WindowedLaw, windowed_law};
use crate::header::{FLAGS_1D, FLAGS_3D, describe, header};
use crate::measured::{Measured, Series, measure, measure_1d, measure_3d};
use crate::outcome::Outcome;
use crate::realisation::Discretisation;
use crate::run::{Flag, Run};
use crate::sample::{FLOOR_CELLS, Sample};
use crate::session::Session;
use crate::table_of::TableOf;
use crate::tables::{FORCE_BAR, FRACTAL_DIMENSION, MODEL};
use analysis::{Bootstrap, FitWindow, least_squares};
use runs::{Header, Progress, Result, Store, write_csv};
use std::path::{Path, PathBuf};

/// Surfaces that are solved on the coarser grids as well: enough to know the scatter of a difference to a fifth.
pub(crate) const COARSER_SURFACES: usize = 12;
/// Coarsest grid and shortest line that say anything about a finer one.
const SMALLEST: (usize, usize) = (17, 1 << 9);
/// By how much differences between grids fall from one halving of the cells to the next: what was measured, within this range. A fast fall
/// seen on a dozen surfaces is mostly chance; a slow one ends somewhere.
const FALLS: (f64, f64) = (0.35, 0.75);

/// Half-widths of 95 %, absolute, by where they come from; `None` where nothing is known of one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Budget {
    /// From the tolerance of the solver: its own estimates, added up.
    pub algebraic: f64,
    /// From the grid, with the waves that only finer ones carry.
    pub discretisation: Option<f64>,
    /// From the number of surfaces.
    pub ensemble: Option<f64>,
    /// From the window of a fit and its floor of contact cells; `None` where nothing is fitted.
    pub window: Option<f64>,
}

impl Budget {
    /// All together: `algebraic + sqrt(discretisation^2 + ensemble^2 + window^2)`; `None` where one of the first three is unknown.
    ///
    /// ```
    /// let budget = evaluation::Budget { algebraic: 1.0, discretisation: Some(3.0), ensemble: Some(4.0), window: None };
    /// assert_eq!(budget.half_width(), Some(6.0));
    /// ```
    pub fn half_width(&self) -> Option<f64> {
        Some(self.algebraic + self.discretisation?.hypot(self.ensemble?).hypot(self.window.unwrap_or(0.0)))
    }
}

/// A number with its budget.
#[derive(Debug, Clone, PartialEq)]
pub struct Budgeted {
    /// `stiffness_bar`, `alpha` or `zeta`.
    pub quantity: &'static str,
    /// D_f.
    pub fractal_dimension: f64,
    /// F_bar of a mean k_bar.
    pub force_bar: Option<f64>,
    /// The number.
    pub value: f64,
    /// Its budget.
    pub budget: Budget,
    /// Whether some surface has fewer than 10 contact cells.
    pub below_floor: bool,
}

impl Budgeted {
    /// The 95 % half-width in units of the number.
    pub fn relative(&self) -> Option<f64> {
        self.budget.half_width().map(|w| w / self.value.abs())
    }
}

/// The same model on cells (elements) twice and four times as large; `None` where those are too coarse to say anything.
pub(crate) fn coarser(discretisation: Discretisation) -> Option<[Discretisation; 2]> {
    let by = |factor: usize| match discretisation {
        Discretisation::Bem3d { cells, tolerance } => {
            let cells = cells.div_ceil(factor);
            (cells >= SMALLEST.0).then_some(Discretisation::Bem3d { cells, tolerance })
        }
        Discretisation::Mdr1d { elements } => {
            let elements = elements / factor;
            (elements >= SMALLEST.1).then_some(Discretisation::Mdr1d { elements })
        }
    };
    Some([by(2)?, by(4)?])
}

/// The first surfaces of an ensemble on grids half and a quarter as fine.
pub(crate) fn measure_coarser(
    run: &Run,
    measured: &Measured,
    store: &Store,
    progress: &dyn Progress,
) -> Result<Option<[Measured; 2]>> {
    let Some([half, quarter]) = coarser(measured.discretisation) else { return Ok(None) };
    let surfaces = measured.series.first().map_or(0, |s| s.units.len()).min(COARSER_SURFACES);
    let on = |discretisation| measure(discretisation, surfaces, measured.force_bar(), run, store, progress);
    Ok(Some([on(half)?, on(quarter)?]))
}

/// The series of one fractal dimension on both coarser grids.
pub(crate) fn coarser_series(
    coarser: Option<&[Measured; 2]>,
    fractal_dimension: f64,
) -> Option<[&Series; 2]> {
    let [half, quarter] = coarser?;
    Some([half.at(fractal_dimension)?, quarter.at(fractal_dimension)?])
}

/// What the tolerance leaves open in k, relative: the solver's estimate and what the missed load makes (k grows less than F).
pub(crate) fn algebraic(s: &Sample) -> f64 {
    s.certificate.stiffness_error.unwrap_or(0.0) + s.certificate.load_error
}

/// 95 % half-width of the distance from the limit of fine grids, for the mean over `surfaces`.
///
/// From the relative differences of single surfaces between the grid and the one half as fine, and between that and the one a quarter as fine:
/// how large the first are, by how much they fall from one halving to the next, and how far both go together. No order of convergence is
/// assumed. `None` for fewer than two surfaces.
pub(crate) fn discretisation_error(differences: &[[f64; 2]], surfaces: usize) -> Option<f64> {
    let n = differences.len() as f64;
    if differences.len() < 2 {
        return None;
    }
    let mean = |of: &dyn Fn(&[f64; 2]) -> f64| analysis::sum(differences.iter().map(of)) / n;
    let means = [mean(&|d| d[0]), mean(&|d| d[1])];
    let share = n.min(surfaces as f64);
    // Second moments of the mean over the surfaces.
    let moment = |a: usize, b: usize| {
        let covariance = mean(&|d| (d[a] - means[a]) * (d[b] - means[b])) * n / (n - 1.0);
        means[a] * means[b] + covariance / share
    };
    Some(analysis::student(n - 1.0) * still_to_come(moment(0, 0), moment(1, 1), moment(0, 1)))
}

/// Root mean square of all differences to come, from second moments of the last difference, the one before, and both.
///
/// Differences that fall by r from one grid to the next and go together with the correlation c add up to the variance
/// `m r^2/(1 - r^2) (1 + c r)/(1 - c r)`.
fn still_to_come(last: f64, before: f64, both: f64) -> f64 {
    if last <= 0.0 {
        return 0.0;
    }
    let fall = if before > 0.0 { (last / before).sqrt() } else { FALLS.1 }.clamp(FALLS.0, FALLS.1);
    let together = if before > 0.0 { both / (last * before).sqrt() } else { 1.0 }.clamp(0.0, 1.0);
    let (square, product) = (fall * fall, together * fall);
    (last * square / (1.0 - square) * (1.0 + product) / (1.0 - product)).sqrt()
}

/// Writes the budgets of the ensembles of a run, `fig2-budget.csv` for 3D and `fig6-budget.csv` for 1D, solving what is not stored.
///
/// # Errors
/// As [`measure_3d`] and [`measure_1d`].
pub fn state_budgets(run: &Run, solid: bool, line: bool, progress: &dyn Progress) -> Result<Outcome> {
    let session = Session::open(run)?;
    let mut outcome = Outcome::new("budget");
    if solid {
        let measured = measure_3d(run, &session.store, progress)?;
        outcome.add_budget(write_budget("fig2", &FLAGS_3D, run, &measured, &session.store, progress)?);
    }
    if line {
        let measured = measure_1d(run, &session.store, progress)?;
        outcome.add_budget(write_budget("fig6", &FLAGS_1D, run, &measured, &session.store, progress)?);
    }
    session.close(outcome)
}

/// Writes `name-budget.csv`; its path, and to what k is known.
///
/// # Errors
/// As [`measure_3d`]; a file that cannot be written.
pub fn write_budget(
    name: &'static str,
    flags: &[Flag],
    run: &Run,
    measured: &Measured,
    store: &Store,
    progress: &dyn Progress,
) -> Result<(PathBuf, String)> {
    let coarser = measure_coarser(run, measured, store, progress)?;
    let all = budgets(measured, coarser.as_ref());
    let header = describe(header(run.command(&format!("reproduce-{name}"), flags)), run, &[measured]);
    let path = run.out.join(format!("{name}-budget.csv"));
    write(&path, measured, &all, header)?;
    Ok((path, format!("{name}: {}", reached(&all))))
}

/// Budgets of every mean k_bar, of alpha and of zeta.
pub(crate) fn budgets(measured: &Measured, coarser: Option<&[Measured; 2]>) -> Vec<Budgeted> {
    let mut all = Vec::new();
    for series in &measured.series {
        let coarser = coarser_series(coarser, series.fractal_dimension);
        all.extend((0..series.points.len()).filter_map(|j| row(series, coarser, j)));
    }
    for series in &measured.series {
        let d = series.fractal_dimension;
        let Ok(WindowedLaw { fit, windows }) = windowed_law(series) else { continue };
        let inside: Vec<usize> = (0..series.points.len())
            .filter(|&j| (fit.force_bar_min..=fit.force_bar_max).contains(&series.points[j].force_bar))
            .collect();
        let grid = coarser_series(coarser, d).and_then(|coarser| law_error(series, coarser));
        let weights = weights(series, &inside);
        let freedom = analysis::student(series.units.len() as f64 - 1.0);
        let open = |weight: fn(&(f64, f64)) -> f64| {
            let each = inside.iter().zip(&weights).map(|(&j, w)| weight(w).abs() * mean_algebraic(series, j));
            analysis::sum(each)
        };
        let budgeted = |quantity, value, budget| Budgeted {
            quantity,
            fractal_dimension: d,
            force_bar: None,
            value,
            budget,
            below_floor: false,
        };
        all.push(budgeted(
            "alpha",
            fit.alpha,
            Budget {
                algebraic: open(|w| w.0),
                discretisation: grid.map(|g| g.0),
                ensemble: fit.alpha_se.map(|se| freedom * se),
                window: Some(windows.0),
            },
        ));
        all.push(budgeted(
            "zeta",
            fit.zeta,
            Budget {
                algebraic: fit.zeta * open(|w| w.1),
                discretisation: grid.map(|g| fit.zeta * g.1),
                ensemble: fit.zeta_se.map(|se| freedom * se),
                window: Some(windows.1),
            },
        ));
    }
    all
}

/// Mean over the converged surfaces of what their tolerance leaves open, relative.
fn mean_algebraic(series: &Series, j: usize) -> f64 {
    let open: Vec<f64> =
        (series.units.iter()).map(|(_, r)| &r.samples[j]).filter(|s| s.converged()).map(algebraic).collect();
    analysis::sum(open.iter().copied()) / open.len().max(1) as f64
}

fn row(series: &Series, coarser: Option<[&Series; 2]>, j: usize) -> Option<Budgeted> {
    let point = &series.points[j];
    let k = point.stiffness_bar?;
    let differences = coarser.map(|coarser| differences(series, coarser, j));
    let budget = Budget {
        algebraic: k.mean * mean_algebraic(series, j),
        discretisation: differences.and_then(|d| discretisation_error(&d, k.count)).map(|d| k.mean * d),
        ensemble: k.standard_error.map(|se| analysis::student(k.count as f64 - 1.0) * se),
        window: None,
    };
    Some(Budgeted {
        quantity: "stiffness_bar",
        fractal_dimension: series.fractal_dimension,
        force_bar: Some(point.force_bar),
        value: k.mean,
        budget,
        below_floor: point.min_contact_cells.is_some_and(|c| c < FLOOR_CELLS),
    })
}

/// Relative differences of k of each surface between its grid and the one half as fine, and between that and the one a quarter as fine, all
/// converged.
pub(crate) fn differences(series: &Series, [half, quarter]: [&Series; 2], j: usize) -> Vec<[f64; 2]> {
    let k = |s: &Series, i: usize| {
        let (_, result) = s.units.get(i)?;
        result.samples.get(j).filter(|s| s.converged()).and_then(|s| s.stiffness_bar)
    };
    let of = |i: usize| relative_differences(k(series, i)?, k(half, i)?, k(quarter, i)?);
    (0..series.units.len()).filter_map(of).collect()
}

/// `[(half - fine)/fine, (quarter - half)/fine]`; `None` for a number that is not positive.
pub(crate) fn relative_differences(fine: f64, half: f64, quarter: f64) -> Option<[f64; 2]> {
    (fine > 0.0).then(|| [(half - fine) / fine, (quarter - half) / fine])
}

/// What a relative error of k at each force makes of alpha and, relative, of zeta: the weights of the straight line.
fn weights(series: &Series, inside: &[usize]) -> Vec<(f64, f64)> {
    let x: Vec<f64> = inside.iter().map(|&j| series.points[j].force_bar.ln()).collect();
    let n = x.len() as f64;
    let mean = analysis::sum(x.iter().copied()) / n;
    let square = analysis::sum(x.iter().map(|x| (x - mean).powi(2)));
    x.iter().map(|x| (x - mean) / square).map(|w| (w, 1.0 / n - mean * w)).collect()
}

/// 95 % half-widths of alpha and of ln zeta from the coarser grids, over the forces that all three resolve.
fn law_error(series: &Series, [half, quarter]: [&Series; 2]) -> Option<(f64, f64)> {
    let window = FitWindow::PAPER;
    let all = [series, half, quarter];
    let resolved =
        |s: &Series, j: usize| s.points[j].min_contact_cells.is_none_or(|c| c >= window.min_contact_cells);
    let inside: Vec<usize> = (0..series.points.len())
        .filter(|&j| series.points[j].force_bar <= window.max_force_bar && all.iter().all(|s| resolved(s, j)))
        .collect();
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
    let surfaces = all.iter().map(|s| s.units.len()).min().unwrap_or(0);
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
        analysis::student(surfaces as f64 - 1.0) * still_to_come(moment(0, 0), moment(1, 1), moment(0, 1))
    };
    Some((error(0), error(1)))
}

/// Writes the budgets as `NAME-budget.csv`.
pub(crate) fn write(path: &Path, measured: &Measured, all: &[Budgeted], header: Header) -> Result<()> {
    const TITLE: &str = "Error budgets: half-widths of 95 %";
    const QUANTITY: &str =
        "stiffness_bar: mean k_bar at a load; alpha, zeta: the fitted law k_bar = zeta F_bar^alpha";
    const GRID: &str = "from the grid and its shortest wave; empty without grids half and a quarter as fine";
    const FLOOR: &str = "true where some surface has fewer than 10 contact cells: no number to rely on";
    const TOLERANCE: &str = "from the tolerance: mean of the solver's own estimates";
    const WINDOW: &str =
        "largest change with floors of 30 and 100 contact cells and an upper end of 0.03; empty for means";
    const SCATTER: &str = "from the number of surfaces (Student); empty for one surface";
    let model = measured.discretisation.name();
    let table = TableOf::new(TITLE, all)
        .column("model", "-", MODEL, |_| model)
        .column("quantity", "-", QUANTITY, |b| b.quantity)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |b| b.fractal_dimension)
        .column("force_bar", "1", FORCE_BAR, |b| b.force_bar)
        .column("value", "1", "the number", |b| b.value)
        .column("algebraic", "1", TOLERANCE, |b| b.budget.algebraic)
        .column("discretisation", "1", GRID, |b| b.budget.discretisation)
        .column("ensemble", "1", SCATTER, |b| b.budget.ensemble)
        .column("window", "1", WINDOW, |b| b.budget.window)
        .column("half_width", "1", "algebraic + sqrt(discretisation^2 + ensemble^2 + window^2)", |b| {
            b.budget.half_width()
        })
        .column("relative", "1", "half_width over value", Budgeted::relative)
        .column("below_floor", "-", FLOOR, |b| b.below_floor)
        .table()?;
    let header = header
        .with_note(format!(
            "discretisation: all differences to come, from those of the first {COARSER_SURFACES} surfaces between this grid and grids half and a \
             quarter as fine: their size, their fall and their correlation; budget-check measures how often the truth is inside"
        ))
        .with_note(reached(all));
    write_csv(path, &table, &header)
}

/// One line: to what k is known, floor rows apart.
pub(crate) fn reached(all: &[Budgeted]) -> String {
    let known: Vec<(&Budgeted, f64)> = all
        .iter()
        .filter(|b| b.force_bar.is_some() && !b.below_floor)
        .filter_map(|b| Some((b, b.relative()?)))
        .collect();
    let Some(worst) = known.iter().max_by(|a, b| a.1.total_cmp(&b.1)) else {
        return "accuracy reached: unknown (it takes two surfaces and a grid that can be halved)".to_owned();
    };
    let mut sorted: Vec<f64> = known.iter().map(|k| k.1).collect();
    sorted.sort_by(f64::total_cmp);
    format!(
        "accuracy reached (95 % half-width of the mean k_bar, {} rows without floor): {:.2} % or better, half of them {:.2} %; the \
         widest at D_f = {:?}, F_bar = {:.3e}",
        known.len(),
        100.0 * worst.1,
        100.0 * sorted[sorted.len() / 2],
        worst.0.fractal_dimension,
        worst.0.force_bar.unwrap_or(0.0)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn what_is_to_come_follows_from_what_was() {
        // Halved each time, all of one sign: 1/2 + 1/4 + ... = 1.
        assert_relative_eq!(still_to_come(1.0, 4.0, 2.0), 1.0, max_relative = 1e-12);
        // Halved and independent: 1/4 + 1/16 + ... = 1/3 in variance.
        assert_relative_eq!(still_to_come(1.0, 4.0, 0.0), (1.0_f64 / 3.0).sqrt(), max_relative = 1e-12);
        // Growing ones and very fast ones are taken at the ends of the range.
        assert_relative_eq!(still_to_come(1.0, 0.25, 0.5), 3.0, max_relative = 1e-12);
        assert_relative_eq!(still_to_come(1.0, 1e6, 1e3), 0.35 / 0.65, max_relative = 1e-12);
        assert_relative_eq!(still_to_come(1.0, 0.0, 0.0), 3.0, max_relative = 1e-12);
        assert!(still_to_come(0.0, 0.0, 0.0) < 1e-300);
    }

    #[test]
    fn surfaces_that_differ_average_out_and_a_common_difference_does_not() {
        let t = analysis::student(3.0);
        let common = [[0.1, 0.2]; 4];
        for surfaces in [1, 60] {
            let error = discretisation_error(&common, surfaces).unwrap();
            assert_relative_eq!(error, 0.1 * t, max_relative = 1e-9);
        }
        let scattered = [[0.1, 0.2], [-0.1, -0.2], [0.1, 0.2], [-0.1, -0.2]];
        let [one, four] = [1, 60].map(|n| discretisation_error(&scattered, n).unwrap());
        assert_relative_eq!(one, 2.0 * four, max_relative = 1e-9);
        assert_eq!(discretisation_error(&common[..1], 1), None);
    }

    #[test]
    fn coarser_grids_are_half_and_a_quarter_as_fine() {
        let solid = |cells| Discretisation::Bem3d { cells, tolerance: 1e-3 };
        let line = |elements| Discretisation::Mdr1d { elements };
        assert_eq!(coarser(solid(2049)), Some([solid(1025), solid(513)]));
        assert_eq!(coarser(solid(64)), None);
        assert_eq!(coarser(line(1 << 20)), Some([line(1 << 19), line(1 << 18)]));
        assert_eq!(coarser(line(1024)), None);
    }
}
