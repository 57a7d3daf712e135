//! Error budgets: k = value +- algebraic +- discretisation +- ensemble, for each mean and for alpha and zeta.

use crate::fitted_laws::laws;
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

/// Surfaces that are solved on the coarser grid as well: enough to know the scatter of a difference to a fifth.
pub(crate) const HALF_GRIDS: usize = 12;
/// Coarsest grid and shortest line that say anything about a finer one.
const SMALLEST_TWIN: (usize, usize) = (33, 1 << 10);
/// 95 % half-width of the distance from the limit of fine grids, in root mean squares of the difference between a grid and one half
/// as fine. Errors of first order give 1.96/sqrt(5) = 0.88 where those of both grids are independent and 1.96 where they have one sign;
/// chosen between them on the 100 cases of `budget-check` with its default seed.
const REACH: f64 = 1.35;

/// Half-widths of 95 %, absolute, by where they come from; `None` where nothing is known of one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Budget {
    /// From the tolerance of the solver: its own estimates, added up.
    pub algebraic: f64,
    /// From the grid, with the waves that only finer ones carry.
    pub discretisation: Option<f64>,
    /// From the number of surfaces.
    pub ensemble: Option<f64>,
}

impl Budget {
    /// All together: `algebraic + sqrt(discretisation^2 + ensemble^2)`; `None` where one is unknown.
    ///
    /// ```
    /// let budget = evaluation::Budget { algebraic: 1.0, discretisation: Some(3.0), ensemble: Some(4.0) };
    /// assert_eq!(budget.half_width(), Some(6.0));
    /// ```
    pub fn half_width(&self) -> Option<f64> {
        Some(self.algebraic + self.discretisation?.hypot(self.ensemble?))
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

/// The same model on cells (elements) twice as large; `None` where that grid is too coarse to say anything.
pub(crate) fn half_grid(discretisation: Discretisation) -> Option<Discretisation> {
    match discretisation {
        Discretisation::Bem3d { cells, tolerance } => {
            let cells = cells.div_ceil(2);
            (cells >= SMALLEST_TWIN.0).then_some(Discretisation::Bem3d { cells, tolerance })
        }
        Discretisation::Mdr1d { elements } => {
            let elements = elements / 2;
            (elements >= SMALLEST_TWIN.1).then_some(Discretisation::Mdr1d { elements })
        }
    }
}

/// The first surfaces of an ensemble on a grid half as fine.
pub(crate) fn measure_half_grids(
    run: &Run,
    measured: &Measured,
    store: &Store,
    progress: &dyn Progress,
) -> Result<Option<Measured>> {
    let Some(discretisation) = half_grid(measured.discretisation) else { return Ok(None) };
    let surfaces = measured.series.first().map_or(0, |s| s.units.len()).min(HALF_GRIDS);
    measure(discretisation, surfaces, measured.force_bar(), run, store, progress).map(Some)
}

/// What the tolerance leaves open in k, relative: the solver's estimate and what the missed load makes (k grows less than F).
pub(crate) fn algebraic(s: &Sample) -> f64 {
    s.certificate.stiffness_error.unwrap_or(0.0) + s.certificate.load_error
}

/// 95 % half-width from the relative differences between a grid and the one of half its size, for the mean over `surfaces`.
///
/// `REACH sqrt(m^2 + s^2/n)`: m the mean difference, s its scatter, n the number of surfaces or of half-size grids, whichever is less. `None` for
/// fewer than two differences.
pub(crate) fn discretisation_error(differences: &[f64], surfaces: usize) -> Option<f64> {
    let n = differences.len() as f64;
    if differences.len() < 2 {
        return None;
    }
    let mean = analysis::sum(differences.iter().copied()) / n;
    let variance = analysis::sum(differences.iter().map(|d| (d - mean).powi(2))) / (n - 1.0);
    Some(reach(mean, variance.sqrt(), n.min(surfaces as f64)))
}

/// `REACH sqrt(mean^2 + scatter^2/n)`.
pub(crate) fn reach(mean: f64, scatter: f64, n: f64) -> f64 {
    REACH * mean.hypot(scatter / n.sqrt())
}

/// 97.5 % quantile of Student's distribution: tabulated for up to five degrees of freedom, then Fisher's expansion (to 0.1 %).
fn student(freedom: usize) -> f64 {
    const SMALL: [f64; 5] = [12.706_205, 4.302_653, 3.182_446, 2.776_445, 2.570_582];
    const Z: f64 = 1.959_964;
    let nu = freedom as f64;
    let tail = |z: f64| {
        z + (z.powi(3) + z) / (4.0 * nu)
            + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * nu * nu)
            + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / (384.0 * nu.powi(3))
    };
    SMALL.get(freedom.wrapping_sub(1)).copied().unwrap_or_else(|| tail(Z))
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
    let half_grids = measure_half_grids(run, measured, store, progress)?;
    let all = budgets(measured, half_grids.as_ref());
    let header = describe(header(run.command(&format!("reproduce-{name}"), flags)), run, &[measured]);
    let path = run.out.join(format!("{name}-budget.csv"));
    write(&path, measured, &all, header)?;
    Ok((path, format!("{name}: {}", reached(&all))))
}

/// Budgets of every mean k_bar, of alpha and of zeta.
pub(crate) fn budgets(measured: &Measured, half_grids: Option<&Measured>) -> Vec<Budgeted> {
    let mut all = Vec::new();
    for series in &measured.series {
        let half_grids = half_grids.and_then(|t| t.at(series.fractal_dimension));
        all.extend((0..series.points.len()).filter_map(|j| row(series, half_grids, j)));
    }
    for law in laws(measured) {
        let (Some(series), Ok(fit)) = (measured.at(law.fractal_dimension), &law.fit) else { continue };
        let half_grids = half_grids.and_then(|t| t.at(law.fractal_dimension));
        let inside: Vec<usize> = (0..series.points.len())
            .filter(|&j| (fit.force_bar_min..=fit.force_bar_max).contains(&series.points[j].force_bar))
            .collect();
        let spread = half_grids.and_then(|t| law_difference(series, t));
        let weights = weights(series, &inside);
        let freedom = student(series.units.len().saturating_sub(1));
        let value =
            |quantity, value: f64, weight: fn(&(f64, f64)) -> f64, unit: f64, se: Option<f64>, spread| {
                Budgeted {
                    quantity,
                    fractal_dimension: law.fractal_dimension,
                    force_bar: None,
                    value,
                    budget: Budget {
                        algebraic: unit
                            * analysis::sum(
                                inside
                                    .iter()
                                    .zip(&weights)
                                    .map(|(&j, w)| weight(w).abs() * mean_algebraic(series, j)),
                            ),
                        discretisation: spread,
                        ensemble: se.map(|se| freedom * se),
                    },
                    below_floor: false,
                }
            };
        all.push(value("alpha", fit.alpha, |w| w.0, 1.0, fit.alpha_se, spread.map(|s| s.0)));
        all.push(value("zeta", fit.zeta, |w| w.1, fit.zeta, fit.zeta_se, spread.map(|s| fit.zeta * s.1)));
    }
    all
}

/// Mean over the converged surfaces of what their tolerance leaves open, relative.
fn mean_algebraic(series: &Series, j: usize) -> f64 {
    let open: Vec<f64> =
        (series.units.iter()).map(|(_, r)| &r.samples[j]).filter(|s| s.converged()).map(algebraic).collect();
    analysis::sum(open.iter().copied()) / open.len().max(1) as f64
}

fn row(series: &Series, half_grids: Option<&Series>, j: usize) -> Option<Budgeted> {
    let point = &series.points[j];
    let k = point.stiffness_bar?;
    let differences = half_grids.map(|t| differences(series, t, j));
    let budget = Budget {
        algebraic: k.mean * mean_algebraic(series, j),
        discretisation: differences.and_then(|d| discretisation_error(&d, k.count)).map(|d| k.mean * d),
        ensemble: k.standard_error.map(|se| student(k.count - 1) * se),
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

/// Relative differences of k between a surface and itself on the half-size grid, both converged.
pub(crate) fn differences(series: &Series, half_grids: &Series, j: usize) -> Vec<f64> {
    let k = |s: &Series, i: usize| {
        s.units[i].1.samples.get(j).filter(|s| s.converged()).and_then(|s| s.stiffness_bar)
    };
    (0..half_grids.units.len().min(series.units.len()))
        .filter_map(|i| Some(k(half_grids, i)? / k(series, i)? - 1.0))
        .collect()
}

/// What a relative error of k at each force makes of alpha and, relative, of zeta: the weights of the straight line.
fn weights(series: &Series, inside: &[usize]) -> Vec<(f64, f64)> {
    let x: Vec<f64> = inside.iter().map(|&j| series.points[j].force_bar.ln()).collect();
    let n = x.len() as f64;
    let mean = analysis::sum(x.iter().copied()) / n;
    let square = analysis::sum(x.iter().map(|x| (x - mean).powi(2)));
    x.iter().map(|x| (x - mean) / square).map(|w| (w, 1.0 / n - mean * w)).collect()
}

/// 95 % half-widths of alpha and of ln zeta from the half-size grids, over the forces that both grids resolve.
fn law_difference(series: &Series, half_grids: &Series) -> Option<(f64, f64)> {
    let window = FitWindow::PAPER;
    let (fine, coarse) = (&series.curves, &half_grids.curves);
    let resolved =
        |s: &Series, j: usize| s.points[j].min_contact_cells.is_none_or(|c| c >= window.min_contact_cells);
    let inside: Vec<usize> = (0..series.points.len())
        .filter(|&j| {
            series.points[j].force_bar <= window.max_force_bar
                && resolved(series, j)
                && resolved(half_grids, j)
        })
        .collect();
    let law = |curves: &analysis::Curves, draw: &[usize]| {
        let means = curves.mean_of(draw);
        let points: Vec<(f64, f64)> =
            inside.iter().filter_map(|&j| Some((curves.force_bar()[j].ln(), means[j]?.ln()))).collect();
        least_squares(&points).filter(|_| points.len() >= 3)
    };
    let difference = |draw: &[usize]| {
        let (a, b) = (law(fine, draw)?, law(coarse, draw)?);
        Some((a.0 - b.0, a.1 - b.1))
    };
    let surfaces = half_grids.units.len().min(series.units.len());
    let whole: Vec<usize> = (0..surfaces).collect();
    let found = difference(&whole)?;
    let scatter = |part: fn((f64, f64)) -> f64| {
        Bootstrap::default().standard_error(surfaces, |draw| difference(draw).map(part))
    };
    Some((REACH * found.0.hypot(scatter(|d| d.0)?), REACH * found.1.hypot(scatter(|d| d.1)?)))
}

/// Writes the budgets as `NAME-budget.csv`.
pub(crate) fn write(path: &Path, measured: &Measured, all: &[Budgeted], header: Header) -> Result<()> {
    const TITLE: &str = "Error budgets: half-widths of 95 %";
    const QUANTITY: &str =
        "stiffness_bar: mean k_bar at a load; alpha, zeta: the fitted law k_bar = zeta F_bar^alpha";
    const GRID: &str = "from the grid and its shortest wave; empty without a half-size grid";
    const FLOOR: &str = "true where some surface has fewer than 10 contact cells: no number to rely on";
    const TOLERANCE: &str = "from the tolerance: mean of the solver's own estimates";
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
        .column("half_width", "1", "algebraic + sqrt(discretisation^2 + ensemble^2)", |b| {
            b.budget.half_width()
        })
        .column("relative", "1", "half_width over value", Budgeted::relative)
        .column("below_floor", "-", FLOOR, |b| b.below_floor)
        .table()?;
    let header = header
        .with_note(format!(
            "discretisation: {REACH} root mean squares of the relative difference from the same surfaces on a grid half as fine (the first \
             {HALF_GRIDS} of them); budget-check measures how often the truth is inside"
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
    fn quantiles_of_student() {
        // Tables: 5, 10, 30, 59 degrees of freedom.
        for (nu, t) in [(1, 12.706), (4, 2.776), (5, 2.571), (10, 2.228), (30, 2.042), (59, 2.001)] {
            assert_relative_eq!(student(nu), t, max_relative = 1e-3);
        }
    }

    #[test]
    fn differences_that_agree_and_that_do_not() {
        // All the same: no scatter, however many surfaces.
        assert_relative_eq!(
            discretisation_error(&[0.1, 0.1], 60).unwrap(),
            0.1 * REACH,
            max_relative = 1e-12
        );
        // Mean 0, variance 2: one surface has it whole, two have half.
        assert_relative_eq!(discretisation_error(&[1.0, -1.0], 1).unwrap(), 2.0_f64.sqrt() * REACH);
        assert_relative_eq!(discretisation_error(&[1.0, -1.0], 60).unwrap(), REACH);
        assert_eq!(discretisation_error(&[1.0], 1), None);
    }

    #[test]
    fn twins_are_half_as_fine() {
        let solid = |cells| Discretisation::Bem3d { cells, tolerance: 1e-3 };
        assert_eq!(half_grid(solid(2049)), Some(solid(1025)));
        assert_eq!(half_grid(solid(64)), None);
        assert_eq!(
            half_grid(Discretisation::Mdr1d { elements: 1 << 20 }),
            Some(Discretisation::Mdr1d { elements: 1 << 19 })
        );
        assert_eq!(half_grid(Discretisation::Mdr1d { elements: 1024 }), None);
    }
}
