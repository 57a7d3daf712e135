//! Fig. 4: the collapse of all curves.

use crate::claims;
use analysis::Table;
use evaluation::Outcome;
use evaluation::Run;
use evaluation::Session;
use evaluation::describe;
use evaluation::header;
use evaluation::{FORCE_BAR, FRACTAL_DIMENSION, MODEL, column};
use evaluation::{Measured, measure_3d, transformed};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use plots::{Key, Mark, Picture, color, logarithmic};
use runs::Progress;
use runs::{CsvFile, write_csv};
use runs::{Error, Result};
use std::path::{Path, PathBuf};

use evaluation::FLAGS_3D as FLAGS;

/// Transforms the 3D ensemble (solving what is not stored) and writes `fig4.csv`, `fig4.svg`, `fig4.png`.
///
/// `F_tilde = 0.086 (k_bar/0.18)^(1/(0.266 D_f))` equals F_bar where Eq. 12 holds. Source: Fig. 4 of the paper.
///
/// # Errors
/// As [`crate::fig2`].
pub fn fig4(run: &Run, progress: &dyn Progress) -> Result<Outcome> {
    let session = Session::open(run)?;
    let measured = measure_3d(run, &session.store, progress)?;
    let mut outcome = write(run, &measured)?;
    outcome.claims = claims::collapse(&measured);
    session.close(outcome)
}

pub(crate) fn write(run: &Run, measured: &Measured) -> Result<Outcome> {
    let title = "Fig. 4: collapse of the 3D curves";
    let mut table = Table::new(
        title,
        vec![
            column("model", "-", MODEL),
            column("fractal_dimension", "1", FRACTAL_DIMENSION),
            column("force_bar", "1", FORCE_BAR),
            column(
                "force_tilde",
                "1",
                "0.086 (k_bar/0.18)^(1/(0.266 D_f)) of the mean k_bar: F_bar where Eq. 12 holds",
            ),
            column("below_floor", "-", "true where some surface has fewer than 10 contact cells"),
        ],
    );
    for series in &measured.series {
        for (p, floor) in transformed(series) {
            let d = series.fractal_dimension;
            let row = vec![
                measured.discretisation.name().into(),
                d.into(),
                p.force_bar.into(),
                p.force_tilde.into(),
                floor.into(),
            ];
            table.push(row).map_err(Error::model(title))?;
        }
    }
    let csv = run.out.join("fig4.csv");
    let header = describe(header(run.command("reproduce-fig4", &FLAGS)), run, &[measured]);
    write_csv(&csv, &table, &header)?;
    let mut outcome = Outcome::new("fig4");
    outcome.files = vec![csv.clone()];
    outcome.files.extend(draw(title, &csv, &run.out)?);
    outcome.not_converged = measured.not_converged();
    outcome.bem3d_seconds = Some(measured.seconds());
    Ok(outcome)
}

fn draw(title: &str, csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let (d, f) = (file.numbers("fractal_dimension")?, file.numbers("force_bar")?);
    let (t, floor) = (file.numbers("force_tilde")?, file.texts("below_floor")?);
    let rows: Vec<(f64, f64, f64, bool)> =
        (0..d.len()).filter_map(|i| Some((d[i]?, f[i]?, t[i]?, floor[i] == "true"))).collect();
    // Both axes from the loads: the floor would stretch them for nothing.
    let x = logarithmic(rows.iter().map(|r| r.1));
    let y = logarithmic(rows.iter().filter(|r| !r.3).map(|r| r.2).chain(rows.iter().map(|r| r.1)));
    let mut picture =
        Picture::new(x, y, "force  F / (E* h L)", "0.086 (k / 0.18 k_s)^(1 / 0.266 D_f),  k_s = 1.1419 E* L")
            .with_title(title)
            .with_legend_below();
    let ends: Vec<f64> = rows.iter().map(|r| r.1).filter(|f| *f <= 1.0).collect();
    if let Some((low, high)) = plots::extent(ends) {
        picture.line(&[(low, low), (high, high)], "#222222", 1.4, &LineStyle::Dashed);
    }
    for series in rows.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()) {
        let color = color(series[0].0);
        let select = |on_floor: bool| -> Vec<(f64, f64)> {
            series.iter().filter(|r| r.3 == on_floor).map(|r| (r.1, r.2)).collect()
        };
        picture.points(&select(true), &color, 3.0, Mark::Hollow(MarkerShape::Circle));
        picture.points(&select(false), &color, 3.6, Mark::Solid(MarkerShape::Circle));
        picture.legend(&format!("D_f = {:?}", series[0].0), &color, Key::Mark(MarkerShape::Circle));
    }
    picture.legend("paper, Eq. 12", "#222222", Key::Dashed);
    if rows.iter().any(|r| r.3) {
        picture.legend("fewer than 10 contact cells", "", Key::Open);
    }
    picture.save(out, "fig4")
}
