//! The picture of the grid study, drawn from its table.

use crate::evaluation::{distinct, read_rows};
use crate::output::save;
use crate::words;
use plots::{Axis, Legend, LegendKey, LineStyle, Mark, Panels, Picture, REFERENCE, color, shape};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Table of the means on all grids.
pub(crate) const GRIDS: &str = "partial-slip-grids.csv";

#[derive(Debug, Deserialize)]
struct GridPictureRow {
    fractal_dimension: f64,
    force_bar: f64,
    poisson: f64,
    share: f64,
    cells: Option<f64>,
    stick: Option<f64>,
    stick_half: Option<f64>,
    stick_grid: Option<f64>,
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The share that sticks less `1 - Q/(mu F)` over the tangential force, one panel for each load: grids as lines,
/// the limit of small cells as marks.
///
/// # Errors
/// [`runs::Error`] for a table that cannot be read and pictures that cannot be written.
pub(crate) fn draw(directory: &Path) -> Result<Vec<PathBuf>> {
    let path = directory.join(GRIDS);
    let rows: Vec<GridPictureRow> = read_rows(&path, &CsvFile::read(&path)?)?;
    let rows: Vec<GridPictureRow> = rows.into_iter().filter(|r| same(r.poisson, 0.0)).collect();
    let above = |r: &GridPictureRow| Some(r.stick? - (1.0 - r.share));
    let half = |r: &GridPictureRow| Some(r.stick_half? + r.stick_grid?);
    let limits = || rows.iter().filter(|r| r.cells.is_none());
    let ends = limits().filter_map(|r| Some([above(r)? - half(r)?, above(r)? + half(r)?])).flatten();
    let of_grids = rows.iter().filter_map(above);
    let y = plots::linear(ends.chain(of_grids).chain([0.0]));
    let dimensions = distinct(rows.iter().map(|r| r.fractal_dimension));
    let mut grids = distinct(rows.iter().filter_map(|r| r.cells));
    grids.sort_by(f64::total_cmp);
    let styles = [LineStyle::Dotted, LineStyle::Dashed, LineStyle::Solid];
    let mut pictures = Vec::new();
    for force in distinct(rows.iter().map(|r| r.force_bar)) {
        let mut picture = Picture::new(
            Axis::Linear(0.0, 1.0),
            y,
            "tangential force $Q/(μ F)$",
            "share that sticks $- (1 - Q/(μ F))$",
        )
        .with_size(400.0, 330.0)
        .with_subtitle(&format!("$\\bar{{F}} = {force}$"));
        picture.line(&[(0.0, 0.0), (1.0, 0.0)], REFERENCE, 1.2, LineStyle::Solid);
        for (k, &d) in dimensions.iter().enumerate() {
            let own = |r: &&GridPictureRow| same(r.fractal_dimension, d) && same(r.force_bar, force);
            for (i, &cells) in grids.iter().enumerate() {
                let on = |r: &&GridPictureRow| r.cells.is_some_and(|c| same(c, cells));
                let points: Vec<_> =
                    rows.iter().filter(own).filter(on).filter_map(|r| Some((r.share, above(r)?))).collect();
                picture.line(&points, &color(d), 1.0, styles[i % 3]);
            }
            // Marks of one fractal dimension beside those of the next.
            let beside = 0.012 * (k as f64 - 0.5 * (dimensions.len() - 1) as f64);
            let bar = |r: &GridPictureRow| Some((r.share + beside, above(r)?, half(r)));
            let bars: Vec<_> = limits().filter(own).filter_map(bar).collect();
            let points: Vec<_> = bars.iter().map(|b| (b.0, b.1)).collect();
            picture.points(&points, &color(d), 3.6, Mark::Solid(shape(d)));
            picture.errors(&bars, &color(d));
        }
        pictures.push(picture);
    }
    let columns = pictures.len();
    let mut legend = Legend::default();
    for &d in &dimensions {
        legend.push(
            &format!("{}, small cells", words::dimension(d)),
            &color(d),
            LegendKey::Mark(Mark::Solid(shape(d))),
        );
    }
    for (i, cells) in grids.iter().enumerate() {
        legend.push(&format!("{cells} cells a side"), REFERENCE, LegendKey::Line(styles[i % 3]));
    }
    legend.push("bars: 95 % over surfaces, and the grid", REFERENCE, LegendKey::Words);
    let title = "Share of the contact that sticks, $ν = 0$".to_owned();
    save(Panels { pictures, columns, title, legend }.files("partial-slip-grids"), directory)
}
