//! Fig. 2: stiffness over force in three dimensions.

use crate::claims;
use crate::curves;
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::write_budget;
use evaluation::{Measured, measure_3d};
use runs::Progress;
use runs::Result;

use evaluation::FLAGS_3D as FLAGS;

/// Solves the 3D ensemble and writes `fig2.csv`, `fig2-samples.csv`, `fig2-budget.csv`, `fig2.svg`, `fig2.png`.
///
/// The budget takes the first surfaces on a grid half as fine as well, a twentieth more work.
///
/// Source: Fig. 2 of the paper (2049 cells a side, 60 surfaces, F_bar from 1e-8 to 20).
///
/// # Errors
/// What the solver refuses, and files that cannot be written.
pub fn fig2(run: &Run, progress: &dyn Progress) -> Result<Outcome> {
    curves::check(run.over.as_deref())?;
    let session = Session::open(run)?;
    let measured = measure_3d(run, &session.store, progress)?;
    let mut outcome = write(run, &measured)?;
    outcome.add_budget(write_budget("fig2", &FLAGS, run, &measured, &session.store, progress)?);
    outcome.claims = claims::curves_3d(&measured);
    session.close(outcome)
}

pub(crate) fn write(run: &Run, measured: &Measured) -> Result<Outcome> {
    let mut outcome = Outcome::new("fig2");
    let title = "Fig. 2: stiffness over force, 3D boundary elements";
    outcome.files = curves::write("fig2", title, &FLAGS, run, measured)?;
    outcome.not_converged = measured.not_converged();
    outcome.bem3d_seconds = Some(measured.seconds());
    Ok(outcome)
}
