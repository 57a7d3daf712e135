//! Coverage of the error budgets: random cases against references.

use crate::budget::{HALF_GRIDS, algebraic, discretisation_error, half_grid};
use crate::header::header;
use crate::outcome::Outcome;
use crate::realisation::{Discretisation, Realisation};
use crate::run::FRACTAL_DIMENSIONS;
use crate::sample::Sample;
use crate::table_of::TableOf;
use crate::tables::{FORCE_BAR, FRACTAL_DIMENSION};
use analysis::{Table, binomial_test};
use contact_model::never;
use runs::{Error, Progress, Result, Threads, collect, files, run_jobs, write_csv};
use std::path::Path;
use std::time::Instant;
use surface_gen::surface_seed;

/// Tolerance of the references.
const REFERENCE: f64 = 1e-10;
/// The reference grid has cells so many times smaller.
const FINER: usize = 4;
/// Grids, loads and tolerances that are drawn from.
const CELLS: [usize; 5] = [65, 97, 129, 193, 257];
const FORCES: (f64, f64) = (1e-3, 20.0);
const TOLERANCES: (f64, f64) = (1e-6, 1e-1);
/// Share of the true errors that a budget is to hold, and the level of the exact binomial test of it.
const COVERED: f64 = 0.95;
const LEVEL: f64 = 0.01;
/// Most that a budget may be of the median error of cases like it.
const GENEROUS: f64 = 10.0;
/// Cases with the nearest budgets whose median error a budget is measured by.
const LIKE: usize = 20;
/// Of fewer cases the nearest ones are not alike.
const ENOUGH: usize = 3 * LIKE;

/// One case with its truth.
#[derive(Debug, Clone)]
struct RandomCase {
    fractal_dimension: f64,
    seed: u64,
    force_bar: f64,
    cells: usize,
    tolerance: f64,
    stiffness_bar: f64,
    contact_cells: usize,
    /// Relative half-widths.
    algebraic: f64,
    discretisation: f64,
    /// k_bar to 1e-10 on the same grid and on the reference grid.
    tight: f64,
    reference: f64,
}

impl RandomCase {
    fn budget(&self) -> f64 {
        self.algebraic + self.discretisation
    }

    fn error(&self) -> f64 {
        (self.stiffness_bar / self.reference - 1.0).abs()
    }

    fn algebraic_error(&self) -> f64 {
        (self.stiffness_bar / self.tight - 1.0).abs()
    }
}

/// What the check found.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Cases.
    pub cases: usize,
    /// Share of true errors inside the whole budget.
    pub inside: f64,
    /// Share of algebraic errors inside the algebraic part.
    pub algebraic_inside: f64,
    /// Largest ratio of a budget to the median error of the 20 cases with the nearest budgets; `None` for fewer than 60 cases, of which
    /// the nearest ones are not alike.
    pub widest: Option<f64>,
}

impl Coverage {
    /// Whether the share can be that of a correct 95 % budget (exact binomial test at 1 %), and no budget is more than ten times the median error, where there are enough cases to tell.
    pub fn holds(&self) -> bool {
        self.p_value() >= LEVEL && self.widest.is_none_or(|widest| widest <= GENEROUS)
    }

    fn p_value(&self) -> f64 {
        binomial_test((self.inside * self.cases as f64).round() as usize, self.cases, COVERED)
    }
}

impl std::fmt::Display for Coverage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} cases: {:.0} % of the true errors inside their budget (95 % wanted; exact binomial test: p = {:.2}, at least {LEVEL} \
             wanted), {:.0} % of the algebraic errors inside their part; ",
            self.cases,
            100.0 * self.inside,
            self.p_value(),
            100.0 * self.algebraic_inside,
        )?;
        match self.widest {
            Some(widest) => write!(
                f,
                "the widest budget is {widest:.1} times the median error of its like (at most {GENEROUS} wanted)"
            ),
            None => write!(f, "whether budgets are too wide takes {ENOUGH} cases to tell"),
        }
    }
}

/// Draws random (surface, load, grid, tolerance), predicts the error of k as the figures do, compares with the same surface on cells
/// four times smaller at 1e-10, and writes `budget-check.csv`.
///
/// Cases on the one-cell floor (fewer than 10 contact cells on some surface) are drawn again, as the figures mark such rows. The truth is itself on
/// a finite grid: with errors of first order it is known to a quarter of them.
///
/// # Errors
/// [`Error::Parameter`] for fewer than twenty cases or no thread; what the solver refuses; files that cannot be written.
pub fn budget_check(
    cases: usize,
    seed: u64,
    threads: usize,
    out: &Path,
    progress: &dyn Progress,
) -> Result<(Outcome, Coverage)> {
    let start = Instant::now();
    if cases < LIKE {
        return Err(Error::parameter("cases", cases, format!("at least {LIKE}")));
    }
    files::create_directory(out)?;
    progress.begin(&format!("{cases} random cases against references"), cases as u64);
    let order: Vec<usize> = (0..cases).collect();
    let done = run_jobs(Threads::all(threads), &order, &never, |i, _| {
        let case = case(seed, i as u64);
        progress.advance(1, false);
        case
    })?;
    progress.end();
    let found = collect(done)?;
    let coverage = judge(&found);
    let path = out.join("budget-check.csv");
    let header = header(format!("cargo xtask budget-check --cases {cases} --seed {seed}"))
        .with_note(format!("references: tolerance {REFERENCE:?} on cells {FINER} times smaller"))
        .with_note(coverage.to_string());
    write_csv(&path, &table(&found)?, &header)?;
    let mut outcome = Outcome::new("budget-check");
    outcome.files.push(path);
    outcome.seconds = start.elapsed().as_secs_f64();
    Ok((outcome, coverage))
}

/// Shares and ratios.
fn judge(cases: &[RandomCase]) -> Coverage {
    let share = |inside: &dyn Fn(&RandomCase) -> bool| {
        cases.iter().filter(|c| inside(c)).count() as f64 / cases.len().max(1) as f64
    };
    let ratio = |c: &RandomCase| {
        let far = |other: &RandomCase| (other.budget() / c.budget()).ln().abs();
        let mut like: Vec<&RandomCase> = cases.iter().collect();
        like.sort_by(|a, b| far(a).total_cmp(&far(b)));
        let mut errors: Vec<f64> = like.iter().take(LIKE).map(|c| c.error()).collect();
        errors.sort_by(f64::total_cmp);
        c.budget() / errors[errors.len() / 2]
    };
    Coverage {
        cases: cases.len(),
        inside: share(&|c| c.error() <= c.budget()),
        algebraic_inside: share(&|c| c.algebraic_error() <= c.algebraic + REFERENCE),
        widest: (cases.len() >= ENOUGH).then(|| cases.iter().map(ratio).fold(0.0, f64::max)),
    }
}

/// A number in [0, 1) from a stream of its own.
fn uniform(seed: u64, case: u64, stream: u64) -> f64 {
    (surface_seed(surface_seed(seed ^ 0xb0d6, case), stream) >> 11) as f64 / (1_u64 << 53) as f64
}

fn logarithmic(u: f64, (low, high): (f64, f64)) -> f64 {
    low * (high / low).powf(u)
}

fn pick<T: Copy>(u: f64, of: &[T]) -> T {
    of[((u * of.len() as f64) as usize).min(of.len() - 1)]
}

/// Draws until a case lies above the floor.
fn case(seed: u64, number: u64) -> Result<RandomCase> {
    // The heaviest load never lies on the floor; light ones do in a few draws out of ten.
    for attempt in 0_u64.. {
        let u = |stream| uniform(seed, number, 16 * attempt + stream);
        let d = pick(u(0), &FRACTAL_DIMENSIONS);
        let cells = pick(u(1), &CELLS);
        let (force_bar, tolerance) = (logarithmic(u(2), FORCES), logarithmic(u(3), TOLERANCES));
        let surface = surface_seed(seed ^ 0xca5e, 1 + number);
        let discretisation = Discretisation::Bem3d { cells, tolerance };
        let mine = solve(discretisation, d, surface, force_bar)?;
        let (Some(k), Some(touching)) = (mine.stiffness_bar, mine.contact_cells) else { continue };
        if mine.below_floor() || !mine.converged() {
            continue;
        }
        let Some(coarse) = half_grid(discretisation) else { continue };
        let on = |discretisation| -> Result<Vec<Sample>> {
            (0..HALF_GRIDS as u64)
                .map(|i| solve(discretisation, d, surface_seed(seed, i), force_bar))
                .collect()
        };
        let fine = on(discretisation)?;
        if fine.iter().any(Sample::below_floor) {
            continue;
        }
        let differences: Vec<f64> = (fine.iter().zip(on(coarse)?))
            .filter_map(|(fine, coarse)| Some(coarse.stiffness_bar? / fine.stiffness_bar? - 1.0))
            .collect();
        let Some(discretisation) = discretisation_error(&differences, 1) else { continue };
        let truth = |cells| {
            let exact = solve(Discretisation::Bem3d { cells, tolerance: REFERENCE }, d, surface, force_bar)?;
            exact.stiffness_bar.filter(|_| exact.converged()).ok_or_else(|| {
                Error::parameter("cases", number, "a reference that meets its tolerance (another seed)")
            })
        };
        return Ok(RandomCase {
            fractal_dimension: d,
            seed: surface,
            force_bar,
            cells,
            tolerance,
            stiffness_bar: k,
            contact_cells: touching,
            algebraic: algebraic(&mine),
            discretisation,
            tight: truth(cells)?,
            reference: truth(FINER * (cells - 1) + 1)?,
        });
    }
    Err(Error::parameter("cases", number, "a case above the floor"))
}

fn solve(discretisation: Discretisation, d: f64, seed: u64, force_bar: f64) -> Result<Sample> {
    let unit =
        Realisation { discretisation, fractal_dimension: d, index: 0, seed, forces: [force_bar].into() };
    let result = unit.solve(&never)?;
    result.samples.into_iter().next().ok_or_else(|| Error::parameter("cases", force_bar, "a load"))
}

fn table(cases: &[RandomCase]) -> Result<Table> {
    TableOf::new("Error budgets of single surfaces against references", cases)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |c| c.fractal_dimension)
        .column("seed", "1", "seed of this surface", |c| c.seed)
        .column("force_bar", "1", FORCE_BAR, |c| c.force_bar)
        .column("cells", "1", "cells a side", |c| c.cells)
        .column("tolerance", "1", "asked for", |c| c.tolerance)
        .column("contact_cells", "1", "cells in contact", |c| c.contact_cells)
        .column("stiffness_bar", "1", "k/(1.1419 E* L) (Eq. 8)", |c| c.stiffness_bar)
        .column("reference", "1", "the same to 1e-10 on cells four times smaller", |c| c.reference)
        .column("error", "1", "relative difference of both", RandomCase::error)
        .column(
            "algebraic_error",
            "1",
            "relative difference from 1e-10 on the same grid",
            RandomCase::algebraic_error,
        )
        .column("algebraic", "1", "part of the budget, relative", |c| c.algebraic)
        .column("discretisation", "1", "part of the budget, relative", |c| c.discretisation)
        .column("inside", "-", "true where the error is within both parts together", |c| {
            c.error() <= c.budget()
        })
        .table()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made(error: f64, budget: f64) -> RandomCase {
        RandomCase {
            fractal_dimension: 2.0,
            seed: 1,
            force_bar: 1.0,
            cells: 65,
            tolerance: 1e-3,
            stiffness_bar: 1.0 + error,
            contact_cells: 50,
            algebraic: 0.0,
            discretisation: budget,
            tight: 1.0 + error,
            reference: 1.0,
        }
    }

    #[test]
    fn shares_and_ratios_by_hand() {
        // 57 of 60 inside; each budget twice the median error.
        let mut cases: Vec<RandomCase> = (0..60).map(|_| made(0.01, 0.02)).collect();
        for i in [7, 20, 41] {
            cases[i] = made(0.03, 0.02);
        }
        let coverage = judge(&cases);
        approx::assert_relative_eq!(coverage.inside, 0.95);
        approx::assert_relative_eq!(coverage.widest.unwrap(), 2.0, max_relative = 1e-9);
        assert!(coverage.holds() && coverage.algebraic_inside > 0.99);
        // All of few cases inside can be by chance; ten of twenty cannot, and twelve times the error is too wide, where it can be told.
        assert!(judge(&vec![made(0.01, 0.02); 20]).holds() && !judge(&vec![made(0.01, 0.12); 60]).holds());
        assert_eq!(judge(&vec![made(0.01, 0.12); 20]).widest, None);
        let half = |i: usize| if i < 10 { made(0.03, 0.02) } else { made(0.01, 0.02) };
        assert!(!judge(&(0..20).map(half).collect::<Vec<_>>()).holds());
    }

    #[test]
    fn draws_are_within_their_ranges() {
        for i in 0..50 {
            let u = uniform(1, i, 3);
            assert!((0.0..1.0).contains(&u));
            let f = logarithmic(u, FORCES);
            assert!(f >= FORCES.0 && f <= FORCES.1 && CELLS.contains(&pick(u, &CELLS)));
        }
    }
}
