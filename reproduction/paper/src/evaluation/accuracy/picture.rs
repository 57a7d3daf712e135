//! The picture: error of k over seconds, one panel for each load.

use crate::evaluation::run::distinct;
use crate::evaluation::table_of::read_rows;
use crate::output::save;
use plots::{Axis, Legend, LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, Panels, Picture, color, extent};
use runs::{CsvFile, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Shortest time shown: a formula takes less.
const SHORTEST: f64 = 1e-5;
/// Smallest error shown: the references are not better.
const SMALLEST: f64 = 1e-4;
/// Typical accuracy targets for k.
pub(crate) const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];

/// A row of the table, with the columns that picture and text use.
#[derive(Debug, Clone, Deserialize)]
pub(crate) struct AccuracyPoint {
    pub family: String,
    pub fractal_dimension: Option<f64>,
    pub force_bar: Option<f64>,
    pub model: String,
    pub size: Option<f64>,
    pub tolerance: Option<f64>,
    pub method: String,
    #[serde(rename = "error_stiffness")]
    pub error: Option<f64>,
    pub reference_error: Option<f64>,
    pub algebraic: Option<f64>,
    pub model_error: Option<f64>,
    pub ensemble: Option<f64>,
    #[serde(rename = "cpu_seconds")]
    pub seconds: Option<f64>,
    pub pareto: bool,
}

impl AccuracyPoint {
    pub fn same_problem(&self, other: &Self) -> bool {
        self.family == other.family
            && same(self.fractal_dimension, other.fractal_dimension)
            && same(self.force_bar, other.force_bar)
    }
}

fn same(a: Option<f64>, b: Option<f64>) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

pub(crate) fn read(csv: &Path) -> Result<Vec<AccuracyPoint>> {
    read_rows(csv, &CsvFile::read(csv)?)
}

/// The distinct values, increasing.
pub(crate) fn values(points: &[AccuracyPoint], of: impl Fn(&AccuracyPoint) -> Option<f64>) -> Vec<f64> {
    distinct(points.iter().filter_map(of))
}

pub(crate) fn draw(csv: &Path, out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let points = read(csv)?;
    let loads = values(&points, |p| p.force_bar);
    let dimensions = values(&points, |p| p.fractal_dimension);
    let mut pictures = Vec::new();
    let (x, y) = axes(&points);
    for (i, &load) in loads.iter().enumerate() {
        for (family, words) in [("band", "shortest wave resolved"), ("spectrum", "fractal to the cell")] {
            let below = if i + 1 == loads.len() { "processor time (s)" } else { "" };
            let beside = if family == "band" { "relative error of $k$" } else { "" };
            let mut picture = Picture::new(x, y, below, beside)
                .with_size(400.0, 270.0)
                .with_subtitle(&format!("{words}, $\\bar{{F}} = {load}$"));
            panel(&mut picture, &points, family, load, &dimensions);
            if !picture.is_empty() {
                pictures.push(picture);
            }
        }
    }
    let title = "Error of the stiffness over the time of one solve".to_owned();
    save(Panels { pictures, columns: 2, title, legend: legend(&points, &dimensions) }.files(name), out)
}

/// One pair of axes for all panels, as long as the points need.
fn axes(points: &[AccuracyPoint]) -> (Axis, Axis) {
    let shown = || points.iter().filter(|p| is_front(p) || p.family == "mean");
    let (_, slow) = extent(shown().filter_map(|p| p.seconds)).unwrap_or((0.0, 1.0));
    let (_, bad) = extent(shown().filter_map(|p| p.error)).unwrap_or((0.0, 1.0));
    (Axis::Log(SHORTEST, 2.0 * slow.max(1e-2)), Axis::Log(SMALLEST, (2.0 * bad).clamp(0.2, 1.0)))
}

/// Whether it is a solve of boundary elements that no other one beats in both error and time.
fn is_front(p: &AccuracyPoint) -> bool {
    p.pareto && p.model == "bem3d" && (p.family == "band" || p.family == "spectrum")
}

fn panel(picture: &mut Picture, points: &[AccuracyPoint], family: &str, load: f64, dimensions: &[f64]) {
    let (x, y) = picture.axes();
    let here = |p: &&AccuracyPoint, family: &str, d: f64| {
        p.family == family && same(p.force_bar, Some(load)) && same(p.fractal_dimension, Some(d))
    };
    // What is faster or nearer than the axes go stands on their edge.
    let place = |p: &AccuracyPoint| {
        let seconds = p.seconds.unwrap_or(0.0).clamp(x.ends().0 * 1.2, x.ends().1 / 1.2);
        Some((seconds, p.error?.clamp(y.ends().0 * 1.1, y.ends().1 / 1.1)))
    };
    for &d in dimensions {
        let color = color(d);
        let front: Vec<&AccuracyPoint> =
            points.iter().filter(|p| here(p, family, d) && is_front(p)).collect();
        let mut at: Vec<(f64, f64)> = front.iter().filter_map(|p| place(p)).collect();
        at.sort_by(|a, b| a.0.total_cmp(&b.0));
        picture.line(&at, &color, 1.4, LineStyle::Solid);
        for p in &front {
            let at: Vec<(f64, f64)> = place(p).into_iter().collect();
            picture.points(&at, &color, mark_size(p.size), Mark::Solid(MarkShape::Circle));
        }
        if family == "spectrum" {
            for (model, mark) in MEANS {
                let of = |p: &&AccuracyPoint| here(p, "mean", d) && p.model == model;
                let at: Vec<(f64, f64)> = points.iter().filter(of).filter_map(place).collect();
                picture.points(&at, &color, 4.2, mark);
            }
        }
    }
    if !picture.is_empty() {
        for target in TARGETS {
            picture.line(&[(x.ends().0, target), (x.ends().1, target)], "#bbbbbb", 0.9, LineStyle::Dotted);
        }
    }
}

/// Models of the mean over surfaces and their marks.
const MEANS: [(&str, Mark); 3] = [
    ("mdr1d", Mark::Hollow(MarkShape::Square)),
    ("power_law", Mark::Solid(MarkShape::Cross)),
    ("plateau", Mark::Hollow(MarkShape::Triangle)),
];

/// Finer grids have larger marks.
fn mark_size(cells: Option<f64>) -> f64 {
    2.2 + 0.9 * (cells.unwrap_or(64.0) / 64.0).log2().max(0.0)
}

fn legend(points: &[AccuracyPoint], dimensions: &[f64]) -> Legend {
    let mut legend = Legend::default();
    for d in dimensions {
        let label = format!("$D_{{\\rm{{f}}}} = {d:?}$, 3D, one surface");
        legend.push(&label, &color(*d), LegendKey::Curve(Mark::Solid(MarkShape::Circle)));
    }
    let sizes = values(points, |p| p.size.filter(|_| is_front(p)));
    if let Some((coarse, fine)) = extent(sizes) {
        let sizes = if fine > coarse { vec![coarse, fine] } else { vec![fine] };
        for n in sizes {
            let key = LegendKey::Sized(Mark::Solid(MarkShape::Circle), mark_size(Some(n)));
            legend.push(&format!("{n} × {n} cells"), NEUTRAL, key);
        }
    }
    let words = ["1D, mean of surfaces", "Eq. 12, mean of surfaces", "rigid square, mean of surfaces"];
    for ((model, mark), words) in MEANS.into_iter().zip(words) {
        if points.iter().any(|p| p.family == "mean" && p.model == model) {
            legend.push(words, NEUTRAL, LegendKey::Mark(mark));
        }
    }
    legend.push("dotted: 10 %, 1 %, 0.1 %", NEUTRAL, LegendKey::Line(LineStyle::Dotted));
    legend
}
