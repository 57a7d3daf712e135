//! The pictures of the study of partial slip, drawn from its tables.

use crate::evaluation::{distinct, read_rows};
use crate::output::save;
use crate::words;
use plots::{
    Axis, COLORS, Legend, LegendKey, LineStyle, Mark, Panels, Picture, REFERENCE, SHAPES, color, shape,
};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Table of first loadings.
pub(crate) const SLIPS: &str = "partial-slip.csv";
/// Table of stiffnesses.
pub(super) const STIFFNESS: &str = "partial-slip-stiffness.csv";
/// Table of loops.
pub(super) const LOOPS: &str = "partial-slip-loops.csv";

const FORCE: &str = "tangential force $Q/(μ F)$";
const POISSON: &str = "Poisson's ratio $ν$";
const BARS: &str = "bars: 95 %, over the surfaces";

#[derive(Debug, Deserialize)]
struct DrawnStiffnessRow {
    boundary: String,
    fractal_dimension: f64,
    force_bar: f64,
    poisson: f64,
    ratio: Option<f64>,
    ratio_half: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct DrawnSlipRow {
    fractal_dimension: f64,
    force_bar: f64,
    poisson: f64,
    share: f64,
    displacement: Option<f64>,
    stick: Option<f64>,
    stick_half: Option<f64>,
    stiffness: Option<f64>,
    stiffness_half: Option<f64>,
    displacement_miss: Option<f64>,
    displacement_miss_half: Option<f64>,
    stick_miss: Option<f64>,
    stick_miss_half: Option<f64>,
    traction_miss: Option<f64>,
    traction_miss_half: Option<f64>,
}

#[derive(Debug, Deserialize)]
struct DrawnLoopRow {
    fractal_dimension: f64,
    force_bar: f64,
    poisson: f64,
    share: f64,
    miss: Option<f64>,
    miss_half: Option<f64>,
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

/// The middle value, or the larger of the two middle ones.
fn middle(values: &[f64]) -> f64 {
    values.get(values.len() / 2).copied().unwrap_or_default()
}

/// The nearest value.
fn nearest(values: &[f64], to: f64) -> f64 {
    values.iter().copied().min_by(|a, b| (a - to).abs().total_cmp(&(b - to).abs())).unwrap_or(to)
}

/// Draws all pictures from the tables of a directory.
///
/// # Errors
/// [`runs::Error`] for tables that cannot be read and pictures that cannot be written.
pub fn draw(directory: &Path) -> Result<Vec<PathBuf>> {
    fn rows<T: serde::de::DeserializeOwned>(path: &Path) -> Result<Vec<T>> {
        read_rows(path, &CsvFile::read(path)?)
    }
    let slips: Vec<DrawnSlipRow> = rows(&directory.join(SLIPS))?;
    let mut files = curves(&slips, directory)?;
    files.extend(fractions(&slips, directory)?);
    files.extend(ratios(&rows(&directory.join(STIFFNESS))?, directory)?);
    files.extend(misses(&slips, &rows(&directory.join(LOOPS))?, directory)?);
    Ok(files)
}

/// Q over delta: the curves of all Poisson's ratios in one picture for each fractal dimension.
fn curves(rows: &[DrawnSlipRow], out: &Path) -> Result<Vec<PathBuf>> {
    let forces = distinct(rows.iter().map(|r| r.force_bar));
    let ratios = distinct(rows.iter().map(|r| r.poisson));
    let shown = [ratios.first(), ratios.last()].into_iter().flatten();
    let force = middle(&forces);
    let mut picture = Picture::new(
        Axis::Linear(0.0, 1.0),
        Axis::Linear(0.0, 1.0),
        "displacement $δ/(μ (E^*/G^*) d(F))$",
        FORCE,
    )
    .with_size(800.0, 560.0)
    .with_title("Partial slip of fractal surfaces")
    .with_subtitle(&format!("free, $\\bar{{F}} = {force}$; means over surfaces"))
    .with_legend_below();
    for d in distinct(rows.iter().map(|r| r.fractal_dimension)) {
        for (which, nu) in shown.clone().enumerate() {
            let of = |r: &&DrawnSlipRow| {
                same(r.fractal_dimension, d) && same(r.force_bar, force) && same(r.poisson, *nu)
            };
            let points = rows.iter().filter(of).filter_map(|r| Some((r.displacement?, r.share)));
            let points: Vec<(f64, f64)> = std::iter::once((0.0, 0.0)).chain(points).collect();
            let color = color(d);
            if which == 0 {
                picture.line(&points, &color, 1.6, LineStyle::Solid);
                let label = format!("{}, Ciavarella and Jaeger ($ν = 0$)", words::dimension(d));
                picture.legend(&label, &color, LegendKey::Line(LineStyle::Solid));
            } else {
                let mark = Mark::Hollow(shape(d));
                picture.points(&points[1..], &color, 4.0, mark);
                picture.legend(
                    &format!("{}, $ν = {nu}$", words::dimension(d)),
                    &color,
                    LegendKey::Mark(mark),
                );
            }
        }
    }
    save(picture.files("partial-slip-curve"), out)
}

/// As in the paper of 2014: share of the contact that sticks, and stiffness, over the tangential force.
fn fractions(rows: &[DrawnSlipRow], out: &Path) -> Result<Vec<PathBuf>> {
    type DrawnColumn = (fn(&DrawnSlipRow) -> Option<f64>, fn(&DrawnSlipRow) -> Option<f64>);
    let (forces, ratios) =
        (distinct(rows.iter().map(|r| r.force_bar)), distinct(rows.iter().map(|r| r.poisson)));
    let (force, nu) = (middle(&forces), nearest(&ratios, 0.3));
    let columns: [(&str, DrawnColumn); 2] = [
        ("stick area over contact area", (|r| r.stick, |r| r.stick_half)),
        ("$k_t(Q)/k_t(0)$", (|r| r.stiffness, |r| r.stiffness_half)),
    ];
    let mut pictures = Vec::new();
    for (label, (value, half)) in columns {
        let mut picture = Picture::new(Axis::Linear(0.0, 1.0), Axis::Linear(0.0, 1.0), FORCE, label)
            .with_size(400.0, 330.0);
        picture.line(&[(0.0, 1.0), (1.0, 0.0)], REFERENCE, 1.2, LineStyle::Dashed);
        for d in distinct(rows.iter().map(|r| r.fractal_dimension)) {
            let of = |r: &&DrawnSlipRow| {
                same(r.fractal_dimension, d) && same(r.force_bar, force) && same(r.poisson, nu)
            };
            let own: Vec<&DrawnSlipRow> = rows.iter().filter(of).collect();
            let points: Vec<_> = own.iter().filter_map(|r| Some((r.share, value(r)?))).collect();
            let bars: Vec<_> = own.iter().filter_map(|r| Some((r.share, value(r)?, half(r)))).collect();
            let color = color(d);
            picture.line(&points, &color, 1.4, LineStyle::Solid);
            picture.points(&points, &color, 3.6, Mark::Solid(shape(d)));
            picture.errors(&bars, &color);
        }
        pictures.push(picture);
    }
    let mut legend = Legend::default();
    for d in distinct(rows.iter().map(|r| r.fractal_dimension)) {
        legend.push(&words::dimension(d), &color(d), LegendKey::Curve(Mark::Solid(shape(d))));
    }
    legend.push("$1 - Q/(μ F)$", REFERENCE, LegendKey::Line(LineStyle::Dashed));
    legend.push(BARS, REFERENCE, LegendKey::Words);
    let title = format!("What sticks, and how stiff it is: $ν = {nu}$, $\\bar{{F}} = {force}$");
    save(Panels { pictures, columns: 2, title, legend }.files("partial-slip-stick"), out)
}

/// Over Poisson's ratio: points of one load beside those of the next.
fn ratios(rows: &[DrawnStiffnessRow], out: &Path) -> Result<Vec<PathBuf>> {
    let ends = rows.iter().filter_map(|r| Some([r.ratio? - r.ratio_half?, r.ratio? + r.ratio_half?]));
    let y = plots::linear(ends.flatten().chain([1.0]));
    let forces = distinct(rows.iter().map(|r| r.force_bar));
    let mut pictures = Vec::new();
    for boundary in ["free", "periodic"] {
        for d in distinct(rows.iter().map(|r| r.fractal_dimension)) {
            let mut picture =
                Picture::new(Axis::Linear(-0.02, 0.54), y, POISSON, "$k_t/k$ over Mindlin's ratio")
                    .with_size(400.0, 280.0)
                    .with_subtitle(&format!("{boundary}, {}", words::dimension(d)));
            picture.line(&[(-0.02, 1.0), (0.54, 1.0)], REFERENCE, 1.2, LineStyle::Dashed);
            for (j, force) in forces.iter().enumerate() {
                let of = |r: &&DrawnStiffnessRow| {
                    r.boundary == boundary && same(r.fractal_dimension, d) && same(r.force_bar, *force)
                };
                let beside = 0.008 * (j as f64 - 0.5 * (forces.len() - 1) as f64);
                let bar = |r: &DrawnStiffnessRow| Some((r.poisson + beside, r.ratio?, r.ratio_half));
                let bars: Vec<_> = rows.iter().filter(of).filter_map(bar).collect();
                let points: Vec<_> = bars.iter().map(|b| (b.0, b.1)).collect();
                let (color, mark) = (COLORS[j % 6], SHAPES[j % 6]);
                picture.points(&points, color, 3.6, Mark::Solid(mark));
                picture.errors(&bars, color);
            }
            pictures.push(picture);
        }
    }
    let columns = (pictures.len() / 2).max(1);
    let mut legend = Legend::default();
    for (j, force) in forces.iter().enumerate() {
        let mark = Mark::Solid(SHAPES[j % 6]);
        legend.push(&format!("$\\bar{{F}} = {force}$"), COLORS[j % 6], LegendKey::Mark(mark));
    }
    legend.push(BARS, REFERENCE, LegendKey::Words);
    let title = "Stiffness $k_t/k$ over $(2 - 2ν)/(2 - ν)$".to_owned();
    save(Panels { pictures, columns, title, legend }.files("partial-slip-stiffness"), out)
}

/// The errors of Ciavarella and Jaeger's approximation: four numbers over Poisson's ratio, for several
/// tangential forces.
fn misses(slips: &[DrawnSlipRow], loops: &[DrawnLoopRow], out: &Path) -> Result<Vec<PathBuf>> {
    type DrawnQuantity = (f64, f64, f64, f64, Option<f64>, Option<f64>);
    let d = distinct(slips.iter().map(|r| r.fractal_dimension)).first().copied().unwrap_or_default();
    let of_slips = |value: fn(&DrawnSlipRow) -> [Option<f64>; 2]| -> Vec<DrawnQuantity> {
        let own = slips.iter().filter(|r| same(r.fractal_dimension, d));
        own.map(|r| (r.force_bar, r.poisson, r.share, d, value(r)[0], value(r)[1])).collect()
    };
    let own = loops.iter().filter(|r| same(r.fractal_dimension, d));
    let of_loops = own.map(|r| (r.force_bar, r.poisson, r.share, d, r.miss, r.miss_half)).collect();
    let quantities: [(&str, Vec<DrawnQuantity>); 4] = [
        ("displacement (%)", of_slips(|r| [r.displacement_miss, r.displacement_miss_half])),
        ("stick area (%)", of_slips(|r| [r.stick_miss, r.stick_miss_half])),
        ("energy of a loop (%)", of_loops),
        ("tractions, rms (%)", of_slips(|r| [r.traction_miss, r.traction_miss_half])),
    ];
    let forces = distinct(slips.iter().map(|r| r.force_bar));
    let shares = distinct(loops.iter().map(|r| r.share));
    let styles = [LineStyle::Dotted, LineStyle::Solid, LineStyle::Dashed];
    let mut pictures = Vec::new();
    for (label, found) in &quantities {
        let own = found.iter().filter(|f| shares.iter().any(|s| same(*s, f.2)));
        let ends = own.clone().filter_map(|f| Some([f.4? - f.5?, f.4? + f.5?])).flatten().map(|v| 100.0 * v);
        let mut picture = Picture::new(Axis::Linear(-0.02, 0.54), plots::linear(ends), POISSON, label)
            .with_size(400.0, 300.0);
        for (i, share) in shares.iter().enumerate() {
            for (j, force) in forces.iter().enumerate() {
                let bars: Vec<_> = (own.clone())
                    .filter(|f| same(f.0, *force) && same(f.2, *share))
                    .filter_map(|f| Some((f.1, 100.0 * f.4?, f.5.map(|half| 100.0 * half))))
                    .collect();
                let points: Vec<_> = bars.iter().map(|b| (b.0, b.1)).collect();
                picture.line(&points, COLORS[i % 6], 1.3, styles[j % 3]);
                picture.points(&points, COLORS[i % 6], 3.0, Mark::Solid(SHAPES[i % 6]));
                picture.errors(&bars, COLORS[i % 6]);
            }
        }
        pictures.push(picture);
    }
    let mut legend = Legend::default();
    for (i, share) in shares.iter().enumerate() {
        let mark = Mark::Solid(SHAPES[i % 6]);
        legend.push(&format!("$Q/(μ F) = {share}$"), COLORS[i % 6], LegendKey::Mark(mark));
    }
    for (j, force) in forces.iter().enumerate() {
        legend.push(&format!("$\\bar{{F}} = {force}$"), REFERENCE, LegendKey::Line(styles[j % 3]));
    }
    legend.push(BARS, REFERENCE, LegendKey::Words);
    let title = format!("Ciavarella and Jaeger over the solution, less 1: {}", words::dimension(d));
    save(Panels { pictures, columns: 2, title, legend }.files("partial-slip-misses"), out)
}
