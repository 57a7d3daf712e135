//! Fig. 6: stiffness over force in one dimension.

use crate::claims;
use crate::curves;
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::write_budget;
use evaluation::{Measured, measure_1d};
use runs::Progress;
use runs::Result;

use evaluation::FLAGS_1D as FLAGS;

/// Solves the 1D ensemble and writes `fig6.csv`, `fig6-samples.csv`, `fig6-budget.csv`, `fig6.svg`, `fig6.png`.
///
/// Source: Fig. 6 of the paper (2^20 elements, 500 lines).
///
/// # Errors
/// What the model refuses, and files that cannot be written.
pub fn fig6(run: &Run, progress: &dyn Progress) -> Result<Outcome> {
    curves::check(run.over.as_deref())?;
    let session = Session::open(run)?;
    let measured = measure_1d(run, &session.store, progress)?;
    let mut outcome = write(run, &measured)?;
    outcome.add_budget(write_budget("fig6", &FLAGS, run, &measured, &session.store, progress)?);
    outcome.claims = claims::curves_1d(&measured);
    session.close(outcome)
}

pub(crate) fn write(run: &Run, measured: &Measured) -> Result<Outcome> {
    let mut outcome = Outcome::new("fig6");
    let title = "Fig. 6: stiffness over force, 1D reduction";
    outcome.files = curves::write("fig6", title, &FLAGS, run, measured)?;
    outcome.not_converged = measured.not_converged();
    outcome.mdr1d_seconds = Some(measured.seconds());
    Ok(outcome)
}
