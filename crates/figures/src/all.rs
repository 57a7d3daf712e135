//! All seven figures and the verification, each ensemble solved once.

use crate::{claims, fig1, fig2, fig3, fig4, fig5, fig6, fig7, verify};
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::write_budget;
use evaluation::{FLAGS_1D, FLAGS_3D};
use evaluation::{measure_1d, measure_3d};
use runs::Progress;
use runs::Result;

/// Makes Figs. 1 to 7 and the verification.
///
/// # Errors
/// Those of each figure.
pub fn reproduce_all(run: &Run, progress: &dyn Progress) -> Result<Vec<Outcome>> {
    let mut outcomes = vec![fig1::fig1(run, progress)?, fig5::fig5(run, progress)?];
    let session = Session::open(run)?;
    let solid = measure_3d(run, &session.store, progress)?;
    let mut two = fig2::write(run, &solid)?;
    two.add_budget(write_budget("fig2", &FLAGS_3D, run, &solid, &session.store, progress)?);
    two.claims = claims::curves_3d(&solid);
    outcomes.insert(1, session.close(two)?);
    let session = Session::open(run)?;
    let line = measure_1d(run, &session.store, progress)?;
    let mut six = fig6::write(run, &line)?;
    six.add_budget(write_budget("fig6", &FLAGS_1D, run, &line, &session.store, progress)?);
    six.claims = claims::curves_1d(&line);
    outcomes.push(session.close(six)?);
    for write in [fig3::write, fig7::write, verify::write] {
        let session = Session::open(run)?;
        outcomes.push(session.close(write(run, &solid, &line)?)?);
    }
    let session = Session::open(run)?;
    outcomes.insert(2, session.close(fig4::write(run, &solid)?)?);
    outcomes.sort_by_key(|o| o.name);
    Ok(outcomes)
}
