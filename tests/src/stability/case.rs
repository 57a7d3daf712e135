//! One hard case, and its result.

use crate::stability::ledger::Ledger;
use contact_model::Result;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The size of the cases.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Effort {
    /// All cases together take less than a minute of processor time.
    #[default]
    Quick,
    /// Larger grids, more surfaces, more loads: up to twenty minutes.
    Thorough,
}

impl Effort {
    /// One of two sizes.
    ///
    /// ```
    /// assert_eq!(tests::stability::Effort::Quick.pick(33, 129), 33);
    /// ```
    pub fn pick<T>(self, quick: T, thorough: T) -> T {
        match self {
            Self::Quick => quick,
            Self::Thorough => thorough,
        }
    }
}

/// A hard case: a real solve with physical or exact assertions.
#[derive(Debug, Clone, Copy)]
pub struct HardCase {
    /// Short name, the key of the table.
    pub name: &'static str,
    /// Why a solver may fail here.
    pub why: &'static str,
    /// What is asserted besides the certificate of each state.
    pub asserted: &'static str,
    /// Largest figure that passes; 0 where bits or counts are compared.
    pub bound: f64,
    /// Solves the case and records the deviations.
    pub(crate) solve: fn(&mut Ledger, Effort) -> Result<()>,
}

impl HardCase {
    /// Solves the case and judges it.
    ///
    /// An error of a model, or even a panic, counts as a failed case, and the other cases still run.
    pub fn run(&self, effort: Effort) -> CaseResult {
        let mut ledger = Ledger::default();
        let solved = catch_unwind(AssertUnwindSafe(|| (self.solve)(&mut ledger, effort)));
        match solved {
            Ok(Ok(())) => {}
            Ok(Err(error)) => ledger.must(false, || error.to_string()),
            Err(_) => ledger.must(false, || "a panic: its message is above".to_owned()),
        }
        ledger.must(ledger.entries() > 0, || "nothing was compared".to_owned());
        let (figure, broken) = ledger.close();
        CaseResult { case: *self, figure, broken }
    }
}

/// The result of a case.
#[derive(Debug, Clone)]
pub struct CaseResult {
    /// The case.
    pub case: HardCase,
    /// The largest deviation found, dimensionless; `None` where it is not a finite number.
    pub figure: Option<f64>,
    /// Assertions that do not hold, in words, the first few.
    pub broken: Vec<String>,
}

impl CaseResult {
    /// Whether every assertion holds and the figure is within its bound.
    pub fn passed(&self) -> bool {
        self.broken.is_empty() && self.figure.is_some_and(|figure| figure <= self.case.bound)
    }

    /// The word used in tables.
    pub fn status(&self) -> &'static str {
        if self.passed() { "passed" } else { "failed" }
    }
}

/// Solves cases in parallel; threads without a case help the others. `found` is called with each result. The
/// results are returned in the order of the cases.
pub fn run(cases: &[HardCase], effort: Effort, found: &(dyn Fn(&CaseResult) + Sync)) -> Vec<CaseResult> {
    let one = |case: &HardCase| {
        let verdict = case.run(effort);
        found(&verdict);
        verdict
    };
    // One at a time for each thread: the cases differ in length by a thousand.
    cases.par_iter().with_max_len(1).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Error;

    fn case(bound: f64, solve: fn(&mut Ledger, Effort) -> Result<()>) -> CaseResult {
        HardCase { name: "test", why: "", asserted: "", bound, solve }.run(Effort::Quick)
    }

    #[test]
    fn a_case_passes_only_with_a_figure_within_its_bound_and_nothing_broken() {
        assert!(
            case(1e-3, |l, _| {
                l.near("x", 1.0005, 1.0);
                Ok(())
            })
            .passed()
        );
        assert!(
            !case(1e-4, |l, _| {
                l.near("x", 1.0005, 1.0);
                Ok(())
            })
            .passed()
        );
        assert!(
            !case(1.0, |l, _| {
                l.near("x", f64::NAN, 1.0);
                Ok(())
            })
            .passed()
        );
        assert!(
            !case(1.0, |l, _| {
                l.near("x", 1.0, 1.0);
                l.must(false, || "y".into());
                Ok(())
            })
            .passed()
        );
        // Comparing nothing is not success.
        assert!(!case(1.0, |_, _| Ok(())).passed());
        let error = case(1.0, |_, _| Err(Error::domain("force", -1.0, "more")));
        assert_eq!(error.broken[0], "force = -1: expected more");
        assert!(!case(1.0, |_, _| panic!("of a solver")).passed());
    }

    #[test]
    fn verdicts_keep_the_order_and_none_is_lost() {
        let fine = HardCase {
            name: "a",
            why: "",
            asserted: "",
            bound: 0.0,
            solve: |l, _| {
                l.count(0);
                Ok(())
            },
        };
        let bad = HardCase { name: "b", solve: |_, _| panic!("of a solver"), ..fine };
        let verdicts = run(&[bad, fine, bad, fine], Effort::Quick, &|_| ());
        assert_eq!(verdicts.iter().map(CaseResult::passed).collect::<Vec<_>>(), [false, true, false, true]);
    }
}
