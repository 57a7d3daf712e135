//! Fig. 7: the factor zeta over the fractal dimension.

use crate::claims;
use crate::fig3::{both, columns, formula, header, push, series};
use analysis::Table;
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::{Measured, measure_1d, measure_3d};
use evaluation::{dense_dimensions, laws};
use kuva::plot::line::LineStyle;
use plots::{Axis, Key, Picture};
use runs::Progress;
use runs::Result;
use runs::{CsvFile, write_csv};
use std::path::{Path, PathBuf};

/// Fits both ensembles (solving what is not stored) and writes `fig7.csv`, `fig7.svg`, `fig7.png`.
///
/// Source: Fig. 7 of the paper; Eq. 11 (`0.18/0.086^(0.266 D_f)`) beside.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig7(run: &Run, progress: &dyn Progress) -> Result<Outcome> {
    let session = Session::open(run)?;
    let solid = measure_3d(run, &session.store, progress)?;
    let line = measure_1d(run, &session.store, progress)?;
    let mut outcome = write(run, &solid, &line)?;
    outcome.claims = claims::factors(&solid, &line);
    session.close(outcome)
}

pub(crate) fn write(run: &Run, solid: &Measured, line: &Measured) -> Result<Outcome> {
    let title = "Fig. 7: factor of k_bar = zeta F_bar^alpha over the fractal dimension";
    let mut table = Table::new(title, columns("zeta", "zeta_se"));
    for law in laws(solid).into_iter().chain(laws(line)) {
        push(&mut table, &law, |l| (l.zeta, l.zeta_se))?;
    }
    for d in dense_dimensions(&run.dimensions()) {
        formula(&mut table, "paper_fit", d, analytic::zeta_fit(d), "Eq. 11: 0.18/0.086^(0.266 D_f)")?;
    }
    let csv = run.out.join("fig7.csv");
    write_csv(&csv, &table, &header("fig7", run, solid, line))?;
    let mut outcome = Outcome::new("fig7");
    outcome.files = vec![csv.clone()];
    outcome.files.extend(draw(&csv, &run.out)?);
    outcome.not_converged = solid.not_converged() + line.not_converged();
    outcome.bem3d_seconds = Some(solid.seconds());
    outcome.mdr1d_seconds = Some(line.seconds());
    Ok(outcome)
}

fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let law: Vec<(f64, f64)> = series(&file, "paper_fit", "zeta")?.into_iter().map(|p| (p.0, p.1)).collect();
    let mut highest: f64 = 1.8;
    for model in ["bem3d", "mdr1d"] {
        for (_, v, e) in series(&file, model, "zeta")? {
            highest = highest.max(v + e.unwrap_or(0.0));
        }
    }
    let axes = (Axis::Linear(1.9, 3.1), Axis::Linear(0.4, (highest * 5.0).ceil() / 5.0));
    let mut picture = Picture::new(axes.0, axes.1, "fractal dimension D_f", "factor \u{3b6}")
        .with_title("Fig. 7: factor of the power law over the fractal dimension");
    picture.line(&law, "#222222", 1.6, &LineStyle::Dashed);
    both(&mut picture, &file, "zeta")?;
    picture.legend("paper, Eq. 11: 0.18/0.086^(0.266 D_f)", "#222222", Key::Dashed);
    picture.save(out, "fig7")
}
