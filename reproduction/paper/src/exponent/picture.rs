//! The pictures: local slopes with bands and the laws, and the ratio of line to surface.

use crate::evaluation::{distinct, read_rows};
use crate::output::save;
use crate::words;
use plots::{Axis, Legend, LegendKey, LineStyle, Mark, Panels, Picture, color, logarithmic, shape};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Table of curves and local slopes.
pub const CURVES: &str = "exponent.csv";
/// Table of ratios.
pub const RATIOS: &str = "exponent-ratio.csv";

const FORCE: &str = "$\\bar{F}$";
const SOLID: &str = "#0b559f";
const LINE: &str = "#d55e00";

#[derive(Debug, Deserialize)]
struct CurveRow {
    model: String,
    convention: String,
    fractal_dimension: f64,
    force_bar: f64,
    slope: Option<f64>,
    slope_band: Option<f64>,
    slope_grid: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct RatioRow {
    convention: String,
    fractal_dimension: f64,
    force_bar: f64,
    ratio: f64,
    half_width: f64,
}

/// Draws both from their tables in a directory.
///
/// # Errors
/// [`runs::Error`] for tables that cannot be read and pictures that cannot be written.
pub fn draw(directory: &Path) -> Result<Vec<PathBuf>> {
    let mut files = slopes(directory)?;
    files.extend(ratios(directory)?);
    Ok(files)
}

fn slopes(directory: &Path) -> Result<Vec<PathBuf>> {
    let path = directory.join(CURVES);
    let rows: Vec<CurveRow> = read_rows(&path, &CsvFile::read(&path)?)?;
    let shown: Vec<&CurveRow> =
        rows.iter().filter(|r| r.convention == "measured_rms" && r.slope.is_some()).collect();
    let x = logarithmic(shown.iter().map(|r| r.force_bar));
    let mut pictures = Vec::new();
    for d in distinct(shown.iter().map(|r| r.fractal_dimension)) {
        let mut picture = Picture::new(x, Axis::Linear(0.3, 1.1), FORCE, "$\\rm{d ln} k/\\rm{d ln} F$")
            .with_size(400.0, 280.0)
            .with_subtitle(&words::dimension(d));
        let (low, high) = x.ends();
        let laws = [analytic::exponent_fit(d), analytic::exponent_scaling(3.0 - d)];
        for (law, style) in laws.into_iter().zip([LineStyle::Dashed, LineStyle::Dotted]) {
            picture.line(&[(low, law), (high, law)], "#000000", 1.2, style);
        }
        for (model, color) in [("mdr1d", LINE), ("bem3d", SOLID)] {
            let own: Vec<&&CurveRow> = shown
                .iter()
                .filter(|r| r.model == model && r.fractal_dimension.total_cmp(&d).is_eq())
                .collect();
            let band: Vec<(f64, f64, f64)> = (own.iter())
                .filter_map(|r| {
                    let half = r.slope_band? + r.slope_grid?;
                    Some((r.force_bar, r.slope? - half, r.slope? + half))
                })
                .collect();
            let line: Vec<(f64, f64)> = own.iter().filter_map(|r| Some((r.force_bar, r.slope?))).collect();
            picture.band(&band, color);
            picture.line(&line, color, 1.6, LineStyle::Solid);
        }
        pictures.push(picture);
    }
    let mut legend = Legend::default();
    legend.push("surfaces (3D), on the finest grid", SOLID, LegendKey::Line(LineStyle::Solid));
    legend.push("lines (1D), with the most elements", LINE, LegendKey::Line(LineStyle::Solid));
    legend.push("$0.266 D_{\\rm{f}}$ (Eq. 6)", "#000000", LegendKey::Line(LineStyle::Dashed));
    legend.push("$1/(1 + H)$ (Eq. 24)", "#000000", LegendKey::Line(LineStyle::Dotted));
    legend.push(
        "bands: 95 % for the whole curve, and the discretisation error; curves end where it is too large",
        "#000000",
        LegendKey::Words,
    );
    let title = "Local exponent of stiffness over force".to_owned();
    save(Panels { pictures, columns: 3, title, legend }.files("exponent"), directory)
}

fn ratios(directory: &Path) -> Result<Vec<PathBuf>> {
    let path = directory.join(RATIOS);
    let rows: Vec<RatioRow> = read_rows(&path, &CsvFile::read(&path)?)?;
    let shown: Vec<&RatioRow> = rows.iter().filter(|r| r.convention == "measured_rms").collect();
    let x = logarithmic(shown.iter().map(|r| r.force_bar));
    let ends = shown.iter().flat_map(|r| [r.ratio - r.half_width, r.ratio + r.half_width]);
    let mut picture = Picture::new(x, plots::linear(ends), words::FORCE, "$k_{\\rm{1D}}/k_{\\rm{3D}}$")
        .with_size(800.0, 560.0)
        .with_title("Stiffness of the line over that of the surface")
        .with_legend_below();
    for d in distinct(shown.iter().map(|r| r.fractal_dimension)) {
        let own: Vec<&&RatioRow> =
            shown.iter().filter(|r| r.fractal_dimension.total_cmp(&d).is_eq()).collect();
        let (color, mark) = (color(d), Mark::Solid(shape(d)));
        let band: Vec<_> =
            own.iter().map(|r| (r.force_bar, r.ratio - r.half_width, r.ratio + r.half_width)).collect();
        let line: Vec<_> = own.iter().map(|r| (r.force_bar, r.ratio)).collect();
        picture.band(&band, &color);
        picture.line(&line, &color, 1.6, LineStyle::Solid);
        picture.points(&line, &color, 3.6, mark);
        picture.legend(&words::dimension(d), &color, LegendKey::Curve(mark));
    }
    picture.legend("bands: 95 %, scatter and what both grids leave", "#000000", LegendKey::Words);
    save(picture.files("exponent-ratio"), directory)
}
