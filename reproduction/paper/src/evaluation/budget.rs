//! Error budgets: k = value +- algebraic +- discretisation +- ensemble, for each mean and for alpha and zeta.

use crate::evaluation::fitted_laws::{WindowedLaw, windowed_law};
use crate::evaluation::header::{describe, flags, header};
use crate::evaluation::measured::{COARSER_SURFACES, Measured, Series, measure};
use crate::evaluation::outcome::Outcome;
use crate::evaluation::realisation::EnsembleModel;
use crate::evaluation::run::Run;
use crate::evaluation::sample::{FLOOR_CELLS, Sample};
use crate::evaluation::session::Session;
use crate::evaluation::table_of::TableOf;
use crate::evaluation::tables::{FORCE_BAR, FRACTAL_DIMENSION, MODEL};
use runs::{Header, Progress, Result, write_csv};
use std::path::{Path, PathBuf};

/// Absolute half-widths of the 95 % intervals by source; `None` where a part is unknown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ErrorBudget {
    /// From the tolerance of the solver: its own estimates, added up.
    pub algebraic: f64,
    /// From the grid, including the waves that only finer grids resolve.
    pub discretisation: Option<f64>,
    /// From the number of surfaces.
    pub ensemble: Option<f64>,
    /// From the window of a fit and its floor of contact cells; `None` where nothing is fitted.
    pub window: Option<f64>,
}

impl ErrorBudget {
    /// The total: `algebraic + sqrt(discretisation^2 + ensemble^2 + window^2)`; `None` where one of the
    /// first three is unknown.
    ///
    /// ```
    /// use paper::evaluation::ErrorBudget;
    /// let (discretisation, ensemble) = (Some(3.0), Some(4.0));
    /// let budget = ErrorBudget { algebraic: 1.0, discretisation, ensemble, window: None };
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
    pub budget: ErrorBudget,
    /// Whether some surface has fewer than 10 contact cells.
    pub below_floor: bool,
}

impl Budgeted {
    /// The 95 % half-width in units of the number.
    pub fn relative(&self) -> Option<f64> {
        self.budget.half_width().map(|w| w / self.value.abs())
    }
}

/// Relative error of k due to the tolerance: the solver's estimate and the effect of the load error (k grows
/// less than F).
pub(crate) fn algebraic(s: &Sample) -> f64 {
    s.certificate.stiffness_error.unwrap_or(0.0) + s.certificate.load_error
}

/// Writes the budgets of the ensembles of a run, `fig2-budget.csv` for 3D and `fig6-budget.csv` for 1D,
/// solving what is not stored.
///
/// # Errors
/// As [`measure`].
pub fn state_budgets(run: &Run, models: &[EnsembleModel], progress: &dyn Progress) -> Result<Outcome> {
    let session = Session::open(&run.out, run.fresh)?;
    let mut outcome = Outcome::new("budget");
    for &model in models {
        let name = match model {
            EnsembleModel::Bem3d => "fig2",
            EnsembleModel::Mdr1d => "fig6",
        };
        outcome.add_budget(write_budget(name, run, &measure(model, run, &session.store, progress)?)?);
    }
    session.close(outcome)
}

/// Writes `name-budget.csv`. Returns its path and a line on the accuracy of k.
///
/// # Errors
/// A file that cannot be written.
pub fn write_budget(name: &'static str, run: &Run, measured: &Measured) -> Result<(PathBuf, String)> {
    let all = budgets(measured);
    let flags = flags(measured.discretisation.of());
    let header = describe(header(run.command(&format!("reproduce-{name}"), flags)), run, &[measured]);
    let path = run.out.join(format!("{name}-budget.csv"));
    write(&path, measured, &all, header)?;
    Ok((path, format!("{name}: {}", reached(&all))))
}

/// Budgets of every mean k_bar, of alpha and of zeta.
pub(crate) fn budgets(measured: &Measured) -> Vec<Budgeted> {
    let mut all = Vec::new();
    for series in &measured.series {
        all.extend((0..series.points.len()).filter_map(|j| row(measured, series, j)));
    }
    for series in &measured.series {
        let d = series.fractal_dimension;
        let Ok(WindowedLaw { fit, windows, grid }) = windowed_law(measured, series) else { continue };
        let inside: Vec<usize> = (0..series.points.len())
            .filter(|&j| (fit.force_bar_min..=fit.force_bar_max).contains(&series.points[j].force_bar))
            .collect();
        let weights = weights(series, &inside);
        let freedom = analysis::student(series.realisations.len() as f64 - 1.0);
        let open = |weight: fn(&(f64, f64)) -> f64| {
            let each = inside.iter().zip(&weights).map(|(&j, w)| weight(w).abs() * mean_algebraic(series, j));
            analysis::sum(each)
        };
        let parts = [
            ("alpha", fit.alpha, fit.alpha_se, open(|w| w.0), grid.map(|g| g.0), windows.0),
            (
                "zeta",
                fit.zeta,
                fit.zeta_se,
                fit.zeta * open(|w| w.1),
                grid.map(|g| fit.zeta * g.1),
                windows.1,
            ),
        ];
        all.extend(parts.map(|(quantity, value, error, algebraic, discretisation, window)| Budgeted {
            quantity,
            fractal_dimension: d,
            force_bar: None,
            value,
            budget: ErrorBudget {
                algebraic,
                discretisation,
                ensemble: error.map(|error| freedom * error),
                window: Some(window),
            },
            below_floor: false,
        }));
    }
    all
}

/// Mean over the converged surfaces of their relative error due to the tolerance.
fn mean_algebraic(series: &Series, j: usize) -> f64 {
    let open: Vec<f64> = (series.realisations.iter())
        .map(|(_, r)| &r.samples[j])
        .filter(|s| s.converged())
        .map(algebraic)
        .collect();
    analysis::sum(open.iter().copied()) / open.len().max(1) as f64
}

fn row(measured: &Measured, series: &Series, j: usize) -> Option<Budgeted> {
    let point = &series.points[j];
    let k = point.stiffness_bar?;
    let edge = measured.discretisation.edge_part(k.mean);
    let grid = (measured.coarser_at(series.fractal_dimension))
        .and_then(|coarser| analysis::mean_grid_error(&series.grid_differences(coarser, j), edge, k.count));
    let budget = ErrorBudget {
        algebraic: k.mean * mean_algebraic(series, j),
        discretisation: grid.map(|d| k.mean * d),
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

/// The sensitivity of alpha and of zeta (relative) to a relative error of k at each force: the weights of the
/// straight line.
fn weights(series: &Series, inside: &[usize]) -> Vec<(f64, f64)> {
    let x: Vec<f64> = inside.iter().map(|&j| series.points[j].force_bar.ln()).collect();
    let n = x.len() as f64;
    let mean = analysis::sum(x.iter().copied()) / n;
    let square = analysis::sum(x.iter().map(|x| (x - mean).powi(2)));
    x.iter().map(|x| (x - mean) / square).map(|w| (w, 1.0 / n - mean * w)).collect()
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

/// One line on the accuracy of k, without rows on the floor.
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
