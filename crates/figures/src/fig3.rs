//! Fig. 3: the exponent alpha over the fractal dimension.

use crate::claims;
use crate::fitted;
use crate::words;
use analysis::{Table, Value, Window};
use evaluation::Outcome;
use evaluation::Session;
use evaluation::describe;
use evaluation::{FRACTAL_DIMENSION, column};
use evaluation::{Flag, Run};
use evaluation::{Law, dense_dimensions, laws};
use evaluation::{Measured, measure_1d, measure_3d};
use plots::{Axis, Key, LineStyle, Picture, REFERENCE};
use runs::Header;
use runs::Progress;
use runs::{CsvFile, write_csv};
use runs::{Error, Result};
use std::path::{Path, PathBuf};

/// Fits both ensembles (solving what is not stored) and writes `fig3.csv`, `fig3.svg`, `fig3.png`.
///
/// Source: Fig. 3 of the paper; Eq. 6 (`0.266 D_f`) and Eq. 24 (`1/(1 + H)`) beside.
///
/// # Errors
/// As [`crate::fig2`] and [`crate::fig6`].
pub fn fig3(run: &Run, progress: &dyn Progress) -> Result<Outcome> {
    let session = Session::open(run)?;
    let solid = measure_3d(run, &session.store, progress)?;
    let line = measure_1d(run, &session.store, progress)?;
    let mut outcome = write(run, &solid, &line)?;
    outcome.claims = claims::exponents(&solid, &line);
    session.close(outcome)
}

pub(crate) fn write(run: &Run, solid: &Measured, line: &Measured) -> Result<Outcome> {
    let title = "Fig. 3: exponent of k_bar = zeta F_bar^alpha over the fractal dimension";
    let mut table = Table::new(title, columns("alpha", "alpha_se"));
    let found = laws(solid).into_iter().chain(laws(line));
    for law in found {
        push(&mut table, &law, |l| (l.alpha, l.alpha_se))?;
    }
    for d in dense_dimensions(&run.dimensions()) {
        formula(&mut table, "paper_fit", d, analytic::exponent_fit(d), "Eq. 6: 0.266 D_f")?;
    }
    for d in dense_dimensions(&run.dimensions()) {
        let alpha = analytic::exponent_scaling(3.0 - d);
        formula(&mut table, "scaling", d, alpha, "Eq. 24: 1/(1 + H)")?;
    }
    let csv = run.out.join("fig3.csv");
    write_csv(&csv, &table, &header("fig3", run, solid, line))?;
    let mut outcome = Outcome::new("fig3");
    outcome.files = vec![csv.clone()];
    outcome.files.extend(draw(&csv, None, &run.out)?);
    outcome.not_converged = solid.not_converged() + line.not_converged();
    outcome.bem3d_seconds = Some(solid.seconds());
    outcome.mdr1d_seconds = Some(line.seconds());
    Ok(outcome)
}

pub(crate) fn header(name: &str, run: &Run, solid: &Measured, line: &Measured) -> Header {
    let bootstrap = analysis::Bootstrap::default();
    describe(evaluation::header(run.command(&format!("reproduce-{name}"), &Flag::ALL)), run, &[solid, line])
        .with_note(format!(
            "fit: ln of the arithmetic mean of k_bar over ln F_bar, equal weights, {}",
            Window::default()
        ))
        .with_note(format!(
            "errors: bootstrap over surfaces, {} resamples; curves of different D_f share phases, their errors are correlated",
            bootstrap.resamples
        ))
}

pub(crate) fn columns(value: &'static str, error: &'static str) -> Vec<analysis::Column> {
    vec![
        column("model", "-", "bem3d, mdr1d: fitted here; others: formulas of the paper"),
        column("fractal_dimension", "1", FRACTAL_DIMENSION),
        column(value, "1", "of k_bar = zeta F_bar^alpha; empty where there is no fit"),
        column(error, "1", "standard error over surfaces; empty for formulas and for one surface"),
        column("force_bar_min", "1", "smallest F_bar of the fit"),
        column("force_bar_max", "1", "largest F_bar of the fit"),
        column("points", "1", "loads in the fit"),
        column("surfaces", "1", "surfaces in the fit"),
        column("note", "-", "formula, or why there is no fit"),
    ]
}

pub(crate) fn push(
    table: &mut Table,
    law: &Law,
    pick: impl Fn(&analysis::PowerLaw) -> (f64, Option<f64>),
) -> Result<()> {
    let (model, d) = (law.model, law.fractal_dimension);
    let row: Vec<Value> = match &law.fit {
        Ok(l) => {
            let (value, error) = pick(l);
            vec![
                model.into(),
                d.into(),
                value.into(),
                error.into(),
                l.force_bar_min.into(),
                l.force_bar_max.into(),
                l.points.into(),
                l.surfaces.into(),
                Value::Empty,
            ]
        }
        Err(reason) => {
            let mut row = vec![Value::Empty; 9];
            (row[0], row[1], row[8]) = (model.into(), d.into(), reason.to_string().into());
            row
        }
    };
    table.push(row).map_err(Error::model("a fitted law"))
}

pub(crate) fn formula(table: &mut Table, model: &str, d: f64, value: f64, note: &str) -> Result<()> {
    let mut row = vec![Value::Empty; 9];
    (row[0], row[1], row[2], row[8]) = (model.into(), d.into(), value.into(), note.into());
    table.push(row).map_err(Error::model("a formula"))
}

/// Draws `fig3.svg` and `fig3.png` from the table; `finer` is a table of Fig. 2 whose exponents stand beside.
pub(crate) fn draw(csv: &Path, finer: Option<&Path>, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let axes = (Axis::Linear(1.9, 3.1), Axis::Linear(0.42, 1.05));
    let title = "Fig. 3: exponent of $\\bar{k} = ζ \\bar{F}^α$ over the fractal dimension";
    let mut picture = Picture::new(axes.0, axes.1, words::DIMENSION, "exponent $α$")
        .with_size(800.0, 560.0)
        .with_title(title)
        .with_legend_below();
    picture.line(&fitted::formula(&file, "paper_fit", "alpha")?, REFERENCE, 1.6, LineStyle::Solid);
    picture.line(&fitted::formula(&file, "scaling", "alpha")?, REFERENCE, 1.6, LineStyle::Dashed);
    fitted::points(&mut picture, &file, finer, "alpha")?;
    picture.legend("paper, Eq. 6: $α = 0.266 D_{\\rm{f}}$", REFERENCE, Key::Line(LineStyle::Solid));
    picture.legend(
        "paper, Eq. 24: $α = 1/(1 + H)$, $H = 3 - D_{\\rm{f}}$",
        REFERENCE,
        Key::Line(LineStyle::Dashed),
    );
    picture.save(out, "fig3")
}
