//! The table of the two cases, and the pictures drawn from it.

use super::reading::slopes;
use super::study::{CASES, Curve, NAME};
use analysis::{Table, Value};
use contact_model::PAPER_STIFFNESS_FACTOR;
use evaluation::FLOOR_CELLS;
use evaluation::column;
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use plots::{Key, Mark, Picture, logarithmic};
use runs::CsvFile;
use runs::{Error, Result};
use std::path::{Path, PathBuf};

/// Stiffness above which the pictures end: towards full contact of a periodic square it has no limit.
const HIGHEST: f64 = 300.0;

pub(super) fn table(curves: &[Curve]) -> Result<Table> {
    let mut table = Table::new(
        "Two cases: k over F with free and periodic boundaries, with and without a roll-off of the spectrum",
        vec![
            column("case", "-", "boundary and spectrum"),
            column("model", "-", "bem3d, or a theory of periodic contact"),
            column(
                "force_bar",
                "1",
                "F/(E* h L), h the rms height of each surface (measured; of the spectrum for a theory)",
            ),
            column("stiffness_bar", "1", "mean of k/(1.1419 E* L)"),
            column("stiffness_bar_se", "1", "standard error of that mean"),
            column("slope", "1", "d ln k/d ln F from the loads before and after"),
            column("k_h_over_force", "1", "k h/F: the constant of proportionality where there is one"),
            column("area", "1", "mean share of the square in contact"),
            column("surfaces", "1", "surfaces in the mean (0: a theory)"),
            column("left_out", "1", "surfaces without a stiffness: not converged, or in full contact"),
            column("min_contact_cells", "1", "fewest cells in contact on any surface of the mean"),
            column("below_floor", "-", "true where some surface has fewer than 10 contact cells"),
        ],
    );
    for curve in curves {
        for (point, slope) in curve.points.iter().zip(slopes(&curve.points)) {
            let row = vec![
                curve.case.name().into(),
                curve.model.into(),
                point.force_bar.into(),
                point.stiffness_bar.into(),
                point.standard_error.into(),
                slope.into(),
                (PAPER_STIFFNESS_FACTOR * point.stiffness_bar / point.force_bar).into(),
                point.area.into(),
                point.surfaces.into(),
                point.left_out.into(),
                point.min_contact_cells.map_or(Value::Empty, Into::into),
                point.min_contact_cells.is_some_and(|n| n < FLOOR_CELLS).into(),
            ];
            table.push(row).map_err(Error::model("a row"))?;
        }
    }
    Ok(table)
}

pub(super) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let mut files = panel(&file, "stiffness_bar", "stiffness  k / (1.1419 E* L)", out, NAME)?;
    files.extend(panel(&file, "k_h_over_force", "k h / F", out, &format!("{NAME}-ratio"))?);
    Ok(files)
}

fn panel(file: &CsvFile, quantity: &str, label: &str, out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let (case, model) = (file.texts("case")?, file.texts("model")?);
    let (force, value, k) =
        (file.numbers("force_bar")?, file.numbers(quantity)?, file.numbers("stiffness_bar")?);
    let floor = file.texts("below_floor")?;
    let rows: Vec<(&str, &str, (f64, f64), bool)> = (0..case.len())
        .filter(|&i| k[i].is_some_and(|k| k <= HIGHEST))
        .filter_map(|i| Some((case[i], model[i], (force[i]?, value[i]?), floor[i] == "true")))
        .collect();
    let solved = || rows.iter().filter(|r| r.1 == "bem3d").map(|r| r.2);
    let (x, y) = (logarithmic(solved().map(|p| p.0)), logarithmic(solved().map(|p| p.1)));
    let mut picture = Picture::new(x, y, "force  F / (E* h L)", label)
        .with_title("Free and periodic, fractal and with a roll-off");
    if name != NAME {
        picture = picture.with_legend_at_lower_left();
    }
    let circle = MarkerShape::Circle;
    for of in CASES {
        let points = |name: &str, floor: bool| -> Vec<(f64, f64)> {
            rows.iter().filter(|r| r.0 == of.name() && r.1 == name && r.3 == floor).map(|r| r.2).collect()
        };
        let inside = points("bem3d", false);
        picture.line(&inside, of.color(), 1.8, &LineStyle::Solid);
        picture.points(&inside, of.color(), 3.2, Mark::Solid(circle));
        picture.points(&points("bem3d", true), of.color(), 3.0, Mark::Hollow(circle));
        picture.legend(of.name(), of.color(), Key::Mark(circle));
        picture.line(&points("persson", false), of.color(), 1.2, &LineStyle::Dashed);
        picture.line(&points("greenwood_williamson", false), of.color(), 1.2, &LineStyle::Dotted);
    }
    picture.legend("Persson; dotted: Greenwood, Williamson", "#444444", Key::Dashed);
    if rows.iter().any(|r| r.3) {
        picture.legend("fewer than 10 contact cells", "", Key::Open);
    }
    picture.save(out, name)
}
