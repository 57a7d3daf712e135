//! Chooses settings for an accuracy target: pilot solves on finer and finer grids give the discretisation
//! error, and their scatter the number of surfaces.
//!
//! The choice depends on counts and on predicted costs of one thread, and neither on measured times nor on the
//! number of threads: the same target gives the same settings on every machine.

use crate::evaluation::budget::{self, Budgeted};
use crate::evaluation::limits::require;
use crate::evaluation::measured::{COARSER_SURFACES, ensemble_jobs, measure};
use crate::evaluation::realisation::EnsembleModel;
use crate::evaluation::run::{Request, Run};
use analysis::{AccuracyTarget, GridTrial, first_grid};
use runs::amounts::duration;
use runs::{Error, Job, Progress, Result, Store, files};

/// Numbers of surfaces and of lines of a pilot: their scatter is known to a fifth and to a tenth.
const PILOT_SURFACES: usize = 16;
const PILOT_LINES: usize = 64;
/// Grids and lines to choose from.
const GRIDS: [usize; 7] = [65, 129, 257, 513, 1025, 2049, 4097];
const LINES: [usize; 6] = [1 << 12, 1 << 14, 1 << 16, 1 << 18, 1 << 20, 1 << 22];
/// Cost over cells a side (`seconds_of_rough_sweep`), and over elements.
const POWERS: (f64, f64) = (2.2, 1.1);
/// Most surfaces that are planned for.
const MOST_SURFACES: f64 = *crate::evaluation::limits::COUNT.end() as f64;
/// Factor on the number of surfaces that the observed scatter requires.
const MORE: f64 = 1.1;

/// Settings that are predicted to meet a target.
#[derive(Debug, Clone, PartialEq)]
pub struct AccuracyPlan {
    /// The run with its settings.
    pub run: Run,
    /// Predicted seconds of one thread, of the pilots and of the run.
    pub seconds: f64,
    /// The prediction in words, one line each.
    pub lines: Vec<String>,
}

/// The settings that meet a target (the 95 % half-width of each mean k_bar above the floor), found by pilot
/// solves, which are stored with the run and not solved again.
///
/// On each grid a pilot solves 16 surfaces (64 lines) under all loads, together with coarser grids, which
/// give the discretisation error. The first grid whose discretisation error is below the target is chosen,
/// with the number of surfaces that the scatter of the pilot requires.
///
/// # Errors
/// [`Error::Parameter`] for sizes or a tolerance that were given beside the target, and for an accuracy
/// outside (0, 1), a budget that is not positive, or a target beyond the budget, with the error of the last
/// grid; errors of the pilot's solves.
pub fn plan(
    request: &Request,
    models: &[EnsembleModel],
    target: AccuracyTarget,
    progress: &dyn Progress,
) -> Result<AccuracyPlan> {
    let given = [
        ("cells", request.cells.map(|n| n.to_string())),
        ("surfaces", request.surfaces.map(|n| n.to_string())),
        ("elements", request.elements.map(|n| n.to_string())),
        ("lines", request.lines.map(|n| n.to_string())),
        ("tolerance", request.tolerance.map(|t| format!("{t:?}"))),
    ];
    for (name, value) in given {
        let expected = "no value together with an accuracy target, which chooses it";
        require(value.is_none(), name, value.unwrap_or_default(), expected)?;
    }
    let AccuracyTarget { share, seconds } = target;
    let expected = "a share between 0 and 1, or per cent such as 1%";
    require(share > 0.0 && share < 1.0, "accuracy", share, expected)?;
    require(seconds > 0.0 && seconds.is_finite(), "budget", seconds, "a time such as 90s, 10min or 2h")?;
    let run = Run { tolerance: target.tolerance(), ..Run::new(request)? };
    files::create_directory(&run.out)?;
    let store = Store::open(&run.out, run.fresh)?;
    let mut plan = AccuracyPlan { run, seconds: 0.0, lines: Vec::new() };
    // Lines first: they cost little and leave the time to surfaces.
    for &model in models.iter().rev() {
        choose(model, &mut plan, target, &store, progress)?;
    }
    Ok(plan)
}

/// Solves what a plan chose and adds surfaces until the target is met, as far as the budget allows: the pilot
/// only predicts this number.
///
/// The results are stored with the run, so that the figure does not solve them again.
///
/// # Errors
/// Errors of the solver.
pub fn settle(
    mut plan: AccuracyPlan,
    models: &[EnsembleModel],
    target: AccuracyTarget,
    progress: &dyn Progress,
) -> Result<AccuracyPlan> {
    let store = Store::open(&plan.run.out, false)?;
    for &model in models.iter().rev() {
        loop {
            let all = budget::budgets(&measure(model, &plan.run, &store, progress)?);
            let (grid, count, _) = plan.run.ensemble(model);
            let wanted = surfaces_wanted(&all, target.share, count);
            let seconds = (wanted - count as f64) * seconds_of_one(model, &plan.run)?;
            if wanted <= count as f64 || wanted > MOST_SURFACES || plan.seconds + seconds > target.seconds {
                break;
            }
            plan.run = plan.run.with_sizes(model, grid.size(), wanted as usize);
            plan.seconds += seconds;
            plan.lines.push(format!("{}, for rows that scatter more", words(model, &plan.run)));
        }
    }
    Ok(plan)
}

/// The number of surfaces with which every mean above the floor meets a target, a tenth more than the
/// observed scatter requires. It is the present number where all means meet the target, or where more
/// surfaces would not help.
fn surfaces_wanted(all: &[Budgeted], target: f64, count: usize) -> f64 {
    let factors = above_floor(all).filter(|b| b.relative().is_some_and(|r| r > target)).map(|b| {
        let (grid, ensemble) = (b.budget.discretisation.unwrap_or(0.0), b.budget.ensemble.unwrap_or(0.0));
        let room = (target * b.value - b.budget.algebraic).powi(2) - grid * grid;
        if room > 0.0 { MORE * ensemble * ensemble / room } else { 1.0 }
    });
    let factor = factors.fold(1.0, f64::max);
    // Every round adds at least one surface, or ends.
    if factor > 1.0 { (factor * count as f64).ceil().max(count as f64 + 1.0) } else { count as f64 }
}

fn above_floor(all: &[Budgeted]) -> impl Iterator<Item = &Budgeted> {
    all.iter().filter(|b| b.force_bar.is_some() && !b.below_floor)
}

/// The result of a pilot on one grid.
#[derive(Debug, Clone, Copy)]
struct Pilot {
    /// Number of surfaces that its scatter requires.
    surfaces: f64,
    /// D_f and F_bar of the mean with the largest error of grid and tolerance; `None` where coarser grids
    /// give no estimate.
    worst: Option<(f64, f64)>,
}

/// Chooses size and number of surfaces of a model in a plan, and adds its time.
fn choose(
    model: EnsembleModel,
    plan: &mut AccuracyPlan,
    target: AccuracyTarget,
    store: &Store,
    progress: &dyn Progress,
) -> Result<()> {
    let (grids, power, count): (&[usize], f64, usize) = match model {
        EnsembleModel::Bem3d => (&GRIDS, POWERS.0, PILOT_SURFACES),
        EnsembleModel::Mdr1d => (&LINES, POWERS.1, PILOT_LINES),
    };
    let left = AccuracyTarget { seconds: target.seconds - plan.seconds, ..target };
    let mut spent = 0.0;
    let trial = |size: usize| -> Result<GridTrial<Pilot>> {
        let run = plan.run.with_sizes(model, size, count);
        let mut all = budget::budgets(&measure(model, &run, store, progress)?);
        let (seconds, each) = (seconds(model, &run)?, seconds_of_one(model, &run)?);
        spent += seconds;
        let left_by_grid = |b: &Budgeted| {
            let relative = (b.budget.algebraic + b.budget.discretisation?) / b.value;
            Some((relative, (b.fractal_dimension, b.force_bar?)))
        };
        let worst = above_floor(&all).filter_map(left_by_grid).max_by(|a, b| a.0.total_cmp(&b.0));
        let surfaces = surfaces_wanted(&all, target.share, count);
        for b in &mut all {
            b.budget.discretisation = Some(0.0);
        }
        let least = surfaces_wanted(&all, target.share, count);
        let rest = |surfaces: f64| (surfaces - count as f64) * each;
        let whole = if surfaces <= MOST_SURFACES { rest(surfaces) } else { f64::INFINITY };
        let (error, worst) = worst.unzip();
        let kept = Pilot { surfaces, worst };
        Ok(GridTrial { error, seconds, rest: whole, least_rest: rest(least), kept })
    };
    let found = first_grid(grids, left, power, trial)?.map_err(|none| {
        let grid = |size: usize| match model {
            EnsembleModel::Bem3d => format!("{size} cells a side"),
            EnsembleModel::Mdr1d => format!("{size} elements"),
        };
        let place = |pilot: &Pilot| {
            let words = |(d, force_bar)| format!("D_f = {d:?}, F_bar = {force_bar:.1e}");
            pilot.worst.map_or_else(String::new, words)
        };
        let expected = format!("less: {}", none.words(left.seconds, &grid, &place, &duration));
        Error::parameter("accuracy", format!("{:.3} %", 100.0 * target.share), expected)
    })?;
    let trial = found.trial;
    let seconds = spent + trial.rest;
    plan.run = plan.run.with_sizes(model, found.grid, trial.kept.surfaces as usize);
    plan.seconds += seconds;
    let (words, percent) = (words(model, &plan.run), 100.0 * target.share);
    let takes = duration(seconds);
    let unconfirmed = if found.is_confirmed { "" } else { "; no finer grid confirms the error of the grid" };
    plan.lines.push(format!(
        "{words} should give each mean to {percent:.2} % in about {takes} of one thread{unconfirmed}"
    ));
    Ok(())
}

/// Predicted seconds of all surfaces of a model on one thread, coarser grids included.
fn seconds(model: EnsembleModel, run: &Run) -> Result<f64> {
    let jobs = ensemble_jobs(run, &[model])?;
    Ok(jobs.iter().map(|job| 1e-3 * Job::cost(job) as f64).sum())
}

/// Predicted seconds of one more surface.
fn seconds_of_one(model: EnsembleModel, run: &Run) -> Result<f64> {
    let size = run.ensemble(model).0.size();
    let [one, none] = [1, 0].map(|more| run.with_sizes(model, size, COARSER_SURFACES + more));
    Ok(seconds(model, &one)? - seconds(model, &none)?)
}

fn words(model: EnsembleModel, run: &Run) -> String {
    let Run { cells, surfaces, elements, lines, tolerance, .. } = run;
    match model {
        EnsembleModel::Bem3d => {
            format!("bem3d: {surfaces} surfaces of {cells} cells a side, tolerance {tolerance:.0e}")
        }
        EnsembleModel::Mdr1d => format!("mdr1d: {lines} lines of {elements} elements"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A machine with more cores would otherwise choose finer grids and more surfaces.
    #[test]
    fn the_time_that_chooses_is_that_of_one_thread() {
        for model in EnsembleModel::BOTH {
            let on = |threads| {
                let request = Request { threads: Some(threads), ..Request::default() };
                seconds_of_one(model, &Run::new(&request).unwrap()).unwrap()
            };
            assert!(on(1) > 0.0);
            assert_relative_eq!(on(1), on(8), max_relative = 0.0);
        }
    }

    #[test]
    fn surfaces_are_added_where_their_scatter_is_the_reason() {
        let row = |grid, ensemble, below_floor| Budgeted {
            quantity: "stiffness_bar",
            fractal_dimension: 2.0,
            force_bar: Some(1.0),
            value: 2.0,
            budget: budget::ErrorBudget {
                algebraic: 0.0,
                discretisation: Some(grid),
                ensemble: Some(ensemble),
                window: None,
            },
            below_floor,
        };
        // Twice the target, from the scatter alone: four times the surfaces and a tenth.
        assert_relative_eq!(surfaces_wanted(&[row(0.0, 0.4, false)], 0.1, 10), 44.0);
        // Within the target, on the floor, or a matter of the grid.
        for other in [row(0.0, 0.1, false), row(0.0, 9.0, true), row(0.3, 0.4, false)] {
            assert_relative_eq!(surfaces_wanted(&[other], 0.1, 10), 10.0);
        }
    }
}
