//! What accuracy costs in time, and which part of an error dominates.
//!
//! [`accuracy_cost`] solves bodies with a known answer and self-affine surfaces in every way that this project has, and says how far
//! each answer is off and what it took. References are exact answers, or the limit of fine grids at the tightest tolerance,
//! extrapolated where the observed order is established; each comes with its uncertainty, and no error is reported below it.

mod check;
mod limit;
mod means;
mod picture;
mod plan;
mod pressure;
mod problem;
mod row;
mod study;
mod table;
mod text;

pub use check::{Honesty, budget_check};
pub use plan::{Needs, Plan, Wish, plan};
pub use study::Depth;

use crate::csv_file::{Header, write_csv};
use crate::error::Result;
use crate::files;
use crate::outcome::Outcome;
use crate::progress::Progress;
use contact_model::ContactModel as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Name of its files.
const NAME: &str = "accuracy-cost";

/// Runs the study and writes `accuracy-cost.csv`, `accuracy-order.csv`, `accuracy-cost.svg`, `accuracy-cost.png` (drawn from the CSV)
/// and `accuracy-cost.md` into a directory.
///
/// It runs on one thread, so that processor seconds are those of each row; they are the only numbers that differ from run to run.
///
/// # Errors
/// What a solver refuses, and files that cannot be written.
pub fn accuracy_cost(depth: Depth, seed: u64, out: &Path, progress: &dyn Progress) -> Result<Outcome> {
    let start = Instant::now();
    files::create_directory(out)?;
    let sizes = depth.sizes();
    let study = study::study(&sizes, seed, progress)?;
    let command = format!("cargo xtask accuracy-cost --preset {} --seed {seed}", depth.as_str());
    let header = Header::new(command)
        .with_sources(bem3d::Bem3d::default().sources())
        .with_sources(mdr1d::Mdr1d::default().sources())
        .with_sources(analytic::Hertz.sources())
        .with_note(format!(
            "references at tolerance {:?} on {:?} cells a side; band: shortest wave {} cells of the coarsest grid",
            sizes.tight,
            sizes.sequence(),
            problem::CELLS_PER_WAVE
        ))
        .with_note("spectrum: F_bar counts in the rms height on the paper's 2049 cells; mean: in each surface's own")
        .with_note(format!("seed: {seed} (surface i: surface_seed(seed, i); single surfaces are number 0)"))
        .with_note("cpu_seconds and bytes depend on the machine, everything else does not");
    let mut outcome = Outcome::new(NAME);
    let csv = out.join(format!("{NAME}.csv"));
    write_csv(&csv, &table::rows(&study)?, &header)?;
    let order = out.join("accuracy-order.csv");
    write_csv(&order, &table::orders(&study)?, &header)?;
    outcome.files = vec![csv.clone(), order.clone()];
    outcome.files.extend(redraw(&csv, &order, out)?);
    outcome.not_converged = study.rows.iter().filter(|r| !r.converged()).count();
    outcome.seconds = start.elapsed().as_secs_f64();
    Ok(outcome)
}

/// Draws the picture and writes the text from the tables of an earlier run.
///
/// # Errors
/// Tables that cannot be read, files that cannot be written.
pub fn redraw(csv: &Path, order: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let mut written = picture::draw(csv, out, NAME)?;
    let text = out.join(format!("{NAME}.md"));
    files::write_whole(&text, text::text(csv, order)?.as_bytes())?;
    written.push(text);
    Ok(written)
}
