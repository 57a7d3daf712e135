//! Fig. 4: the collapse of all curves.

use crate::claims;
use crate::evaluation::{
    EnsembleModel, FORCE_BAR, FRACTAL_DIMENSION, MODEL, Measured, Outcome, Run, Session, TableOf, describe,
    flags, header, measure, read_rows, transformed,
};
use crate::judged::Judged;
use crate::output::save;
use crate::{curves, words};
use plots::{Axis, LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, Picture, REFERENCE, logarithmic};
use runs::{CsvFile, Progress, Result};
use std::path::{Path, PathBuf};

/// Transforms the 3D ensemble (solving what is not stored) and writes `fig4.csv`, `fig4.svg`, `fig4.png`.
///
/// `F_tilde = 0.086 (k_bar/0.18)^(1/(0.266 D_f))` equals F_bar where Eq. 12 holds. Source: Fig. 4 of the
/// paper.
///
/// # Errors
/// As [`crate::fig2`].
pub fn fig4(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    let session = Session::open(&run.out, run.fresh)?;
    let measured = measure(EnsembleModel::Bem3d, run, &session.store, progress)?;
    let outcome = session.close(write(run, &measured)?)?;
    Ok(Judged::new(outcome, claims::of_figure("fig4", &[&measured])?))
}

pub(crate) fn write(run: &Run, measured: &Measured) -> Result<Outcome> {
    const TILDE: &str = "0.086 (k_bar/0.18)^(1/(0.266 D_f)) of the mean k_bar: F_bar where Eq. 12 holds";
    let model = measured.discretisation.name();
    let points: Vec<_> = (measured.series.iter())
        .flat_map(|s| transformed(s).into_iter().map(|(p, floor)| (s.fractal_dimension, p, floor)))
        .collect();
    let table = TableOf::new("Fig. 4: collapse of the 3D curves", &points)
        .column("model", "-", MODEL, |_| model)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |p| p.0)
        .column("force_bar", "1", FORCE_BAR, |p| p.1.force_bar)
        .column("force_tilde", "1", TILDE, |p| p.1.force_tilde)
        .column("below_floor", "-", "true where some surface has fewer than 10 contact cells", |p| p.2)
        .table()?;
    let header =
        describe(header(run.command("reproduce-fig4", flags(EnsembleModel::Bem3d))), run, &[measured]);
    let files = curves::written(run, "fig4", &table, &header, |csv| draw(csv, &run.out))?;
    Ok(Outcome::of("fig4", files, &[measured]))
}

/// Draws `fig4.svg` and `fig4.png` from the table: F_tilde over F_bar would be six curves on one diagonal;
/// their ratio distinguishes them.
pub(crate) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let rows: Vec<(String, f64, f64, f64, bool)> = read_rows(csv, &file)?;
    let rows: Vec<(f64, f64, f64, bool)> =
        rows.into_iter().map(|(_, d, force, tilde, floor)| (d, force, tilde / force, floor)).collect();
    let solid = || rows.iter().filter(|r| !r.3);
    let x = logarithmic(solid().map(|r| r.1));
    let highest = solid().map(|r| r.2).fold(1.0, f64::max);
    let y = Axis::Linear(0.0, 1.12 * highest);
    let label = "$\\tilde{F}/\\bar{F}$,   $\\tilde{F} = 0.086 (\\bar{k}/0.18)^{1/(0.266 D_{\\rm{f}})}$";
    let mut picture = Picture::new(x, y, words::FORCE, label)
        .with_title(&words::title(&file))
        .with_subtitle(&words::subtitle(&file, "bem3d"));
    let law = [(x.ends().0, 1.0), (analytic::F_BAR_UL, 1.0)];
    picture.line(&law, REFERENCE, 1.5, LineStyle::Dashed);
    picture.line(
        &[(analytic::F_BAR_UL, 0.0), (analytic::F_BAR_UL, y.ends().1)],
        NEUTRAL,
        1.0,
        LineStyle::Dotted,
    );
    for series in rows.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()) {
        let points: Vec<_> = series.iter().map(|r| (r.1, r.2, r.3)).collect();
        curves::draw_curve(&mut picture, series[0].0, &points, [1.5, 3.2, 4.0]);
    }
    picture.legend("paper, Eq. 12", REFERENCE, LegendKey::Line(LineStyle::Dashed));
    picture.legend("its upper limit $\\bar{F} = 0.086$", NEUTRAL, LegendKey::Line(LineStyle::Dotted));
    if rows.iter().any(|r| r.3 && x.holds(r.1) && y.holds(r.2)) {
        let label = format!("fewer than {} contact cells", crate::evaluation::FLOOR_CELLS);
        picture.legend(&label, NEUTRAL, LegendKey::Mark(Mark::Hollow(MarkShape::Circle)));
    }
    save(picture.files("fig4"), out)
}
