//! Fig. 7: the factor zeta over the fractal dimension.

use crate::claims;
use crate::fig3::{columns, formula, header, push};
use crate::fitted;
use crate::words;
use analysis::Table;
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::{Measured, measure_1d, measure_3d};
use evaluation::{dense_dimensions, laws};
use plots::{Axis, Key, LineStyle, Picture, REFERENCE};
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
    outcome.files.extend(draw(&csv, None, &run.out)?);
    outcome.not_converged = solid.not_converged() + line.not_converged();
    outcome.bem3d_seconds = Some(solid.seconds());
    outcome.mdr1d_seconds = Some(line.seconds());
    Ok(outcome)
}

/// Draws `fig7.svg` and `fig7.png` from the table; `finer` is a table of Fig. 2 whose factors stand beside.
pub(crate) fn draw(csv: &Path, finer: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let law = fitted::formula(&file, "paper_fit", "zeta")?;
    let mut all = fitted::series(&file, "bem3d", "zeta")?;
    all.extend(fitted::series(&file, "mdr1d", "zeta")?);
    if let Some(path) = finer {
        all.extend(fitted::finer_series(path, "zeta")?);
    }
    let highest = all.iter().map(|p| p.value + p.error.unwrap_or(0.0)).fold(1.7, f64::max) + 0.05;
    let axes = (Axis::Linear(1.9, 3.1), Axis::Linear(0.4, (highest * 5.0).ceil() / 5.0));
    let mut picture = Picture::new(axes.0, axes.1, words::DIMENSION, "factor $ζ$")
        .with_size(800.0, 560.0)
        .with_title("Fig. 7: factor of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension")
        .with_legend_below();
    picture.line(&law, REFERENCE, 1.6, LineStyle::Dashed);
    fitted::points(&mut picture, &file, finer, "zeta")?;
    let label = "paper, Eq. 11: $ζ = 0.18/0.086^{0.266 D_{\\rm{f}}}$";
    picture.legend(label, REFERENCE, Key::Line(LineStyle::Dashed));
    picture.save(out, "fig7")
}
