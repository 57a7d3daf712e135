//! Coverage of the error budgets: random cases against references.

use super::random_case::{CaseJob, FINER, REFERENCE, RandomCase, STRATA, stratum};
use crate::evaluation::header::header;
use crate::evaluation::limits::{self, require, within};
use crate::evaluation::outcome::Outcome;
use crate::evaluation::session::Session;
use crate::evaluation::table_of::TableOf;
use crate::evaluation::tables::{FORCE_BAR, FRACTAL_DIMENSION};
use analysis::binomial_test;
use contact_model::Table;
use contact_model::never;
use runs::{JobList, JobRun, Progress, Result, Threads, collect, run_stored, write_csv};
use std::path::Path;

/// Share of the true errors that budgets should contain, and the level of the exact binomial test of it.
const COVERED: f64 = 0.95;
const LEVEL: f64 = 0.01;
/// Smallest median of error over budget: below it, budgets are too wide to be useful. For normally
/// distributed errors it is 0.34.
const SHARP: f64 = 0.2;

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
    /// The range and the number of errors inside, in words.
    fn words(&self) -> String {
        let ((low, high), d) = (self.loads, self.fractal_dimension);
        format!("D_f {d:?}, F_bar {low:?} to {high:?}: {} of {}", self.inside, self.cases)
    }

    /// Two-sided p-value of "95 % of the errors are inside".
    pub fn p_value(&self) -> f64 {
        binomial_test(self.inside, self.cases, COVERED)
    }
}

/// The result of the check.
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
    /// Whether the share in each stratum can be that of a correct 95 % budget (exact binomial test at 1 %).
    /// Budgets that are too wide fail by the median of error over budget, which may not be below 0.2.
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
        let rejected: Vec<String> = self.rejected().map(Stratum::words).collect();
        if rejected.is_empty() {
            write!(f, "none")
        } else {
            write!(f, "{}: {}", rejected.len(), rejected.join("; "))
        }
    }
}

/// Draws random (surface, load, grid, tolerance), predicts the error of k as the figures do, compares with
/// the same surface solved to 1e-10 on cells four times smaller, and writes `budget-check.csv`. The cases are
/// distributed evenly over the strata, so that 720 cases are 40 in each.
///
/// Cases on the one-cell floor (fewer than 10 contact cells on some surface) are drawn again, as the figures
/// mark such rows. The reference is itself computed on a finite grid: with errors of first order, its own
/// error is a quarter of them.
///
/// Cases that are stored in the directory are not solved again, and a larger number of cases begins with the
/// same ones.
///
/// # Errors
/// [`runs::Error::Parameter`] for fewer cases than strata, no thread, or a directory that another process
/// works in; errors of the solver; files that cannot be written.
pub fn budget_check(
    cases: usize,
    seed: u64,
    threads: usize,
    out: &Path,
    progress: &dyn Progress,
) -> Result<(Outcome, Coverage)> {
    let jobs = jobs(cases, seed)?;
    let session = Session::open(out, false)?;
    let what = format!("{cases} random cases against references");
    let run = JobRun { store: &session.store, threads: Threads::all(threads), progress, stop: &never };
    let found = collect(run_stored(&what, &jobs, run))?;
    let coverage = judge(&found);
    let path = out.join("budget-check.csv");
    let mut header = header(format!("cargo xtask budget-check --cases {cases} --seed {seed}"))
        .with_note(format!("references: tolerance {REFERENCE:?} on cells {FINER} times smaller"))
        .with_note(coverage.to_string());
    header.notes.extend(strata(&coverage));
    write_csv(&path, &table(&found)?, &header)?;
    let mut outcome = Outcome::new("budget-check");
    outcome.files.push(path);
    Ok((session.close(outcome)?, coverage))
}

/// The cases of [`budget_check`] as jobs.
///
/// # Errors
/// [`runs::Error::Parameter`] for fewer cases than strata.
pub fn budget_check_jobs(cases: usize, seed: u64) -> Result<Box<dyn JobList>> {
    Ok(Box::new(jobs(cases, seed)?))
}

fn jobs(cases: usize, seed: u64) -> Result<Vec<CaseJob>> {
    require(cases >= STRATA, "cases", cases, format!("at least {STRATA}, one for each stratum"))?;
    within("cases", cases, &limits::COUNT)?;
    Ok((0..cases as u64).map(|number| CaseJob { seed, number }).collect())
}

/// One line for each stratum.
fn strata(coverage: &Coverage) -> Vec<String> {
    let line = |s: &Stratum| {
        let (words, p) = (s.words(), s.p_value());
        format!("{words} inside, p = {p:.2}, median error over budget {:.2}", s.median)
    };
    coverage.strata.iter().map(line).collect()
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

fn table(cases: &[RandomCase]) -> Result<Table> {
    TableOf::new("Error budgets of single surfaces against references", cases)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |c| c.fractal_dimension)
        .column("seed", "1", "seed of this surface", |c| c.seed)
        .column("force_bar", "1", FORCE_BAR, |c| c.force_bar)
        .column("cells", "1", "cells a side", |c| c.cells)
        .column("tolerance", "1", "requested", |c| c.tolerance)
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
    use runs::{Job, Silent, Store};
    use std::sync::atomic::{AtomicUsize, Ordering};

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
    fn cases_that_were_interrupted_give_the_same_table() {
        // The three cheapest of a round of strata.
        let mut all = jobs(STRATA, 1).unwrap();
        all.sort_by_key(Job::cost);
        all.truncate(3);
        let dirs = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let [whole, parts] = dirs.each_ref().map(|dir| Store::open(dir.path(), false).unwrap());
        let finish = |store: &Store| {
            let run = JobRun { store, threads: Threads::all(2), progress: &Silent, stop: &never };
            collect(run_stored("cases", &all, run)).unwrap()
        };
        let expected = finish(&whole);
        // Stopped inside the first case, then after it; a case is stored whole or not at all.
        let polls = AtomicUsize::new(0);
        let stop = || polls.fetch_add(1, Ordering::Relaxed) >= 20;
        let work = |which: &[usize], stop: &(dyn Fn() -> bool + Sync)| {
            all.work(which, &parts, Threads::all(1), &Silent, stop).map_err(|e| e.to_string())
        };
        assert!(work(&[0, 1, 2], &stop).unwrap_err().contains("stopped"));
        assert_eq!(Store::count(dirs[1].path()), 0);
        work(&[1], &never).unwrap();
        assert_eq!(Store::count(dirs[1].path()), 1);
        let resumed = finish(&parts);
        assert_eq!(resumed, expected);
        let text = |name: &str, cases: &[RandomCase]| {
            let path = dirs[0].path().join(name);
            write_csv(&path, &table(cases).unwrap(), &header("cases".into())).unwrap();
            std::fs::read(path).unwrap()
        };
        assert_eq!(text("a.csv", &resumed), text("b.csv", &expected));
    }

    #[test]
    fn fewer_cases_than_strata_are_refused() {
        let refused = budget_check_jobs(STRATA - 1, 1).map(drop).unwrap_err().to_string();
        assert!(refused.contains("one for each stratum"), "{refused}");
        assert_eq!(budget_check_jobs(STRATA, 1).unwrap().count(), STRATA);
    }
}
