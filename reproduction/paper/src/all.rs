//! All seven figures and the verification, each ensemble solved once.

use crate::evaluation::{Outcome, Run, Session};
use crate::judged::Judged;
use crate::{fig1, fig2, fig3, fig4, fig5, fig6, fig7, verify};
use runs::{Progress, Result};

/// Makes Figs. 1 to 7 and the verification.
///
/// # Errors
/// As each figure.
pub fn reproduce_all(run: &Run, progress: &dyn Progress) -> Result<Vec<Judged>> {
    let mut outcomes = vec![fig1::fig1(run, progress)?, fig5::fig5(run, progress)?];
    let (two, solid) = fig2::FIGURE.reproduce(run, progress)?;
    let (six, line) = fig6::FIGURE.reproduce(run, progress)?;
    outcomes.extend([two, six]);
    let alone = |write: &dyn Fn() -> Result<Outcome>| -> Result<Judged> {
        let session = Session::open(&run.out, run.fresh)?;
        session.close(write()?).map(Judged::from)
    };
    outcomes.push(alone(&|| fig3::FIGURE.write(run, &solid, &line))?);
    outcomes.push(alone(&|| fig4::write(run, &solid))?);
    outcomes.push(alone(&|| fig7::FIGURE.write(run, &solid, &line))?);
    // The claims of all figures are in the verification.
    let session = Session::open(&run.out, run.fresh)?;
    let (outcome, claims) = verify::write(run, &solid, &line)?;
    outcomes.push(Judged::new(session.close(outcome)?, claims));
    outcomes.sort_by_key(|o| o.name);
    Ok(outcomes)
}
