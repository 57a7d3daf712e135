//! Coverage of the error budgets: random cases against references.

use crate::budget::algebraic;
use crate::grid_error::{EdgePart, discretisation_error, relative_differences};
use crate::header::header;
use crate::measured::COARSER_SURFACES;
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
/// Grids and tolerances that are drawn from.
const CELLS: [usize; 5] = [65, 97, 129, 193, 257];
const TOLERANCES: (f64, f64) = (1e-6, 1e-1);
/// Ranges of loads; each with each of the paper's fractal dimensions is a stratum, and the cases go round them.
const LOADS: [(f64, f64); 3] = [(1e-3, 0.086), (0.086, 2.0), (2.0, 20.0)];
const STRATA: usize = LOADS.len() * FRACTAL_DIMENSIONS.len();
/// Share of the true errors that a budget is to hold, and the level of the exact binomial test of it.
const COVERED: f64 = 0.95;
const LEVEL: f64 = 0.01;
/// Smallest median of error over budget: below, budgets are too wide to be of use. Normal errors have 0.34.
const SHARP: f64 = 0.2;
/// Fewest cases.
const FEWEST: usize = STRATA;

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

/// One range of loads at one fractal dimension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stratum {
    /// D_f.
    pub fractal_dimension: f64,
    /// Smallest and largest F_bar.
    pub loads: (f64, f64),
    /// Cases.
    pub cases: usize,
    /// True errors inside the whole budget.
    pub inside: usize,
    /// Median of error over budget.
    pub median: f64,
}

impl Stratum {
    /// Two-sided p-value of "95 % of the errors are inside".
    pub fn p_value(&self) -> f64 {
        binomial_test(self.inside, self.cases, COVERED)
    }
}

/// What the check found.
#[derive(Debug, Clone, PartialEq)]
pub struct Coverage {
    /// Cases.
    pub cases: usize,
    /// True errors inside the whole budget.
    pub inside: usize,
    /// Share of algebraic errors inside the algebraic part.
    pub algebraic_inside: f64,
    /// Median of error over budget.
    pub median: f64,
    /// By load and fractal dimension.
    pub strata: Vec<Stratum>,
}

impl Coverage {
    /// Whether the share in each stratum can be that of a correct 95 % budget (exact binomial test at 1 %). Budgets that are too wide fail by
    /// the median of error over budget, which may not be below 0.2.
    pub fn holds(&self) -> bool {
        self.median >= SHARP && self.rejected().next().is_none()
    }

    fn rejected(&self) -> impl Iterator<Item = &Stratum> {
        self.strata.iter().filter(|s| s.p_value() < LEVEL)
    }
}

impl std::fmt::Display for Coverage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let fewest = self.strata.iter().map(|s| s.cases).min().unwrap_or(0);
        write!(
            f,
            "{} cases: {:.1} % of the true errors inside their budget, {:.0} % of the algebraic errors inside their part; median error over \
             budget {:.2} (at least {SHARP} wanted); of {} strata (loads and D_f, at least {fewest} cases each) an exact binomial test at {LEVEL} \
             rejects 95 % coverage in ",
            self.cases,
            100.0 * self.inside as f64 / self.cases.max(1) as f64,
            100.0 * self.algebraic_inside,
            self.median,
            self.strata.len()
        )?;
        let rejected: Vec<String> = self
            .rejected()
            .map(|s| {
                let ((low, high), d) = (s.loads, s.fractal_dimension);
                format!("D_f {d:?}, F_bar {low:?} to {high:?}: {} of {}", s.inside, s.cases)
            })
            .collect();
        if rejected.is_empty() {
            write!(f, "none")
        } else {
            write!(f, "{}: {}", rejected.len(), rejected.join("; "))
        }
    }
}

/// Draws random (surface, load, grid, tolerance), predicts the error of k as the figures do, compares with the same surface on cells
/// four times smaller at 1e-10, and writes `budget-check.csv`. The cases go round the strata: 720 are 40 in each.
///
/// Cases on the one-cell floor (fewer than 10 contact cells on some surface) are drawn again, as the figures mark such rows. The truth is itself on
/// a finite grid: with errors of first order it is known to a quarter of them.
///
/// # Errors
/// [`Error::Parameter`] for fewer cases than strata or no thread; what the solver refuses; files that cannot be written.
pub fn budget_check(
    cases: usize,
    seed: u64,
    threads: usize,
    out: &Path,
    progress: &dyn Progress,
) -> Result<(Outcome, Coverage)> {
    let start = Instant::now();
    if cases < FEWEST {
        return Err(Error::parameter("cases", cases, format!("at least {FEWEST}, one for each stratum")));
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
    let mut header = header(format!("cargo xtask budget-check --cases {cases} --seed {seed}"))
        .with_note(format!("references: tolerance {REFERENCE:?} on cells {FINER} times smaller"))
        .with_note(coverage.to_string());
    header.notes.extend(strata(&coverage));
    write_csv(&path, &table(&found)?, &header)?;
    let mut outcome = Outcome::new("budget-check");
    outcome.files.push(path);
    outcome.seconds = start.elapsed().as_secs_f64();
    Ok((outcome, coverage))
}

/// One line for each stratum.
fn strata(coverage: &Coverage) -> Vec<String> {
    let line = |s: &Stratum| {
        let ((low, high), d) = (s.loads, s.fractal_dimension);
        format!(
            "D_f {d:?}, F_bar {low:?} to {high:?}: {} of {} inside, p = {:.2}, median error over budget {:.2}",
            s.inside,
            s.cases,
            s.p_value(),
            s.median
        )
    };
    coverage.strata.iter().map(line).collect()
}

/// Stratum of a case by its number.
fn stratum(number: usize) -> (f64, (f64, f64)) {
    let of = number % STRATA;
    (FRACTAL_DIMENSIONS[of % FRACTAL_DIMENSIONS.len()], LOADS[of / FRACTAL_DIMENSIONS.len()])
}

/// Shares and ratios; the cases are in the order of their numbers.
fn judge(cases: &[RandomCase]) -> Coverage {
    let inside = |cases: &[&RandomCase]| cases.iter().filter(|c| c.error() <= c.budget()).count();
    let median = |cases: &[&RandomCase]| {
        let mut ratios: Vec<f64> = cases.iter().map(|c| c.error() / c.budget()).collect();
        ratios.sort_by(f64::total_cmp);
        ratios.get(ratios.len() / 2).copied().unwrap_or_default()
    };
    let strata = (0..STRATA.min(cases.len()))
        .map(|of| {
            let own: Vec<&RandomCase> = cases.iter().skip(of).step_by(STRATA).collect();
            let (fractal_dimension, loads) = stratum(of);
            Stratum { fractal_dimension, loads, cases: own.len(), inside: inside(&own), median: median(&own) }
        })
        .collect();
    let all: Vec<&RandomCase> = cases.iter().collect();
    let algebraic = all.iter().filter(|c| c.algebraic_error() <= c.algebraic + REFERENCE).count();
    Coverage {
        cases: all.len(),
        inside: inside(&all),
        algebraic_inside: algebraic as f64 / all.len().max(1) as f64,
        median: median(&all),
        strata,
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
    let (d, loads) = stratum(number as usize);
    // The heaviest load of a range never lies on the floor of the finest grid; light ones do in a few draws out of ten.
    for attempt in 0_u64.. {
        let u = |stream| uniform(seed, number, 16 * attempt + stream);
        let cells = pick(u(1), &CELLS);
        let (force_bar, tolerance) = (logarithmic(u(2), loads), logarithmic(u(3), TOLERANCES));
        // The surface of the case, and those that its budget comes from: others for each case, so that the cases are independent.
        let surface = surface_seed(seed ^ 0xca5e, 1 + number);
        let discretisation = Discretisation::Bem3d { cells, tolerance };
        let mine = solve(discretisation, d, surface, force_bar)?;
        let (Some(k), Some(touching)) = (mine.stiffness_bar, mine.contact_cells) else { continue };
        if mine.below_floor() || !mine.converged() {
            continue;
        }
        let Some([half, quarter]) = discretisation.coarser() else { continue };
        let on = |discretisation| -> Result<Vec<Sample>> {
            (0..COARSER_SURFACES as u64)
                .map(|i| solve(discretisation, d, surface_seed(surface, 1 + i), force_bar))
                .collect()
        };
        let fine = on(discretisation)?;
        if fine.iter().any(Sample::below_floor) {
            continue;
        }
        let differences: Vec<[f64; 2]> = (fine.iter().zip(on(half)?).zip(on(quarter)?))
            .filter_map(|((fine, half), quarter)| {
                relative_differences(fine.stiffness_bar?, half.stiffness_bar?, quarter.stiffness_bar?)
            })
            .collect();
        let stiffnesses: Vec<f64> = fine.iter().filter_map(|s| s.stiffness_bar).collect();
        let mean = analysis::sum(stiffnesses.iter().copied()) / stiffnesses.len().max(1) as f64;
        let edge = EdgePart::at(mean, discretisation);
        let Some(discretisation) = discretisation_error(&differences, edge, 1) else { continue };
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
        // Twenty in each stratum, one of them outside: each budget twice the error.
        let number = 20 * STRATA;
        let case = |i: usize| if i < STRATA { made(0.03, 0.02) } else { made(0.01, 0.02) };
        let cases: Vec<RandomCase> = (0..number).map(case).collect();
        let coverage = judge(&cases);
        assert_eq!((coverage.inside, coverage.strata.len()), (19 * STRATA, STRATA));
        assert!(coverage.strata.iter().all(|s| (s.cases, s.inside) == (20, 19)));
        approx::assert_relative_eq!(coverage.median, 0.5, max_relative = 1e-9);
        assert!(coverage.holds() && coverage.algebraic_inside > 0.99);
        assert!(coverage.to_string().ends_with("in none"), "{coverage}");
        // Budgets that are too wide, and one stratum in which they are too narrow.
        assert!(!judge(&vec![made(0.01, 0.12); number]).holds());
        let narrow = |i: usize| if i % STRATA == 3 && i % 2 == 1 { made(0.03, 0.02) } else { case(i) };
        let narrow = judge(&(0..number).map(narrow).collect::<Vec<_>>());
        assert!(!narrow.holds() && narrow.to_string().contains("in 1: D_f 2.6"), "{narrow}");
    }

    #[test]
    fn draws_are_within_their_ranges() {
        for i in 0..50 {
            let u = uniform(1, i, 3);
            assert!((0.0..1.0).contains(&u));
            let f = logarithmic(u, LOADS[0]);
            assert!(f >= LOADS[0].0 && f <= LOADS[0].1 && CELLS.contains(&pick(u, &CELLS)));
        }
        assert_eq!(stratum(0), (2.0, LOADS[0]));
        assert_eq!(stratum(STRATA + 17), (3.0, LOADS[2]));
    }
}
