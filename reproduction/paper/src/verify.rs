//! Compares every claim of the paper with the numbers found here.

use crate::claim::{Claim, claims_table, markdown, short_table, sort, together};
use crate::claims;
use crate::evaluation::{Flag, Measured, Outcome, Run, Session, describe, header};
use crate::fitted::both;
use crate::judged::Judged;
use runs::{Progress, Result, files, write_csv};

/// Judges every statement (solving what is not stored) and writes `verify.csv`, `verify.md` and the short
/// `verify-table.md`, contradictions first.
///
/// The ratio of run times is only printed on the terminal and, in seconds, written to the manifest, so that
/// the other files have the same bytes on every machine and for any number of threads.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn verify(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    let session = Session::open(&run.out, run.fresh)?;
    let [solid, line] = both(run, &session.store, progress)?;
    let (outcome, claims) = write(run, &solid, &line)?;
    Ok(Judged::new(session.close(outcome)?, claims))
}

pub(crate) fn write(run: &Run, solid: &Measured, line: &Measured) -> Result<(Outcome, Vec<Claim>)> {
    let ensembles = claims::Ensembles::new(&[solid, line]);
    let mut claims = Vec::new();
    for command in claims::VERIFIED {
        claims.extend(claims::judged(command, &ensembles)?);
    }
    together(&mut claims);
    sort(&mut claims);
    let command = run.command("verify", &Flag::ALL);
    let title = "Statements of the paper beside what was found, contradictions first";
    let header = describe(header(command.clone()), run, &[solid, line]);
    let csv = run.out.join("verify.csv");
    // Files have the same bytes on every machine.
    let timeless: Vec<Claim> = claims.iter().map(Claim::without_times).collect();
    write_csv(&csv, &claims_table(title, &timeless)?, &header)?;
    let notes: String = header.notes.iter().map(|n| format!("- {n}\n")).collect();
    let text = format!("# {title}\n\n`{command}`\n\n{notes}\n{}", markdown(&timeless));
    let md = run.out.join("verify.md");
    files::write_whole(&md, text.as_bytes())?;
    let short = run.out.join("verify-table.md");
    files::write_whole(&short, short_table(&timeless).as_bytes())?;
    Ok((Outcome::of("verify", vec![csv, md, short], &[solid, line]), claims))
}
