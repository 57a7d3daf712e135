//! The picture: error of k over seconds, one panel for each load.

use kuva::plot::legend::{LegendEntry, LegendShape};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use kuva::render::figure::Figure;
use plots::{Axis, Mark, Picture, color, save};
use runs::CsvFile;
use runs::Result;
use std::path::{Path, PathBuf};

const NEUTRAL: &str = "#777777";
/// Seconds shown: from a formula to the finest grids.
const SECONDS: (f64, f64) = (1e-5, 1e2);
/// Errors shown.
const ERRORS: (f64, f64) = (1e-4, 1.0);
/// What one may want to know k to.
pub(crate) const TARGETS: [f64; 3] = [0.1, 0.01, 0.001];

/// A row of the table as picture and text see it.
#[derive(Debug, Clone)]
pub(crate) struct Point {
    pub family: String,
    pub fractal_dimension: Option<f64>,
    pub force_bar: Option<f64>,
    pub model: String,
    pub size: Option<f64>,
    pub tolerance: Option<f64>,
    pub method: String,
    pub error: Option<f64>,
    pub reference_error: Option<f64>,
    pub algebraic: Option<f64>,
    pub model_error: Option<f64>,
    pub ensemble: Option<f64>,
    pub seconds: Option<f64>,
    pub pareto: bool,
}

impl Point {
    pub fn same_problem(&self, other: &Self) -> bool {
        self.family == other.family
            && same(self.fractal_dimension, other.fractal_dimension)
            && same(self.force_bar, other.force_bar)
    }
}

fn same(a: Option<f64>, b: Option<f64>) -> bool {
    a.map(f64::to_bits) == b.map(f64::to_bits)
}

pub(crate) fn read(csv: &Path) -> Result<Vec<Point>> {
    let file = CsvFile::read(csv)?;
    let number = |name: &str| file.numbers(name);
    let (d, f, size, tolerance) =
        (number("fractal_dimension")?, number("force_bar")?, number("size")?, number("tolerance")?);
    let (error, reference) = (number("error_stiffness")?, number("reference_error")?);
    let (algebraic, model_error, ensemble) =
        (number("algebraic")?, number("model_error")?, number("ensemble")?);
    let seconds = number("cpu_seconds")?;
    let (family, model, method) = (file.texts("family")?, file.texts("model")?, file.texts("method")?);
    let pareto = file.texts("pareto")?;
    Ok((0..d.len())
        .map(|i| Point {
            family: family[i].to_owned(),
            fractal_dimension: d[i],
            force_bar: f[i],
            model: model[i].to_owned(),
            size: size[i],
            tolerance: tolerance[i],
            method: method[i].to_owned(),
            error: error[i],
            reference_error: reference[i],
            algebraic: algebraic[i],
            model_error: model_error[i],
            ensemble: ensemble[i],
            seconds: seconds[i],
            pareto: pareto[i] == "true",
        })
        .collect())
}

/// Different values, increasing.
pub(crate) fn values(points: &[Point], of: impl Fn(&Point) -> Option<f64>) -> Vec<f64> {
    let mut all: Vec<f64> = points.iter().filter_map(of).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| a.total_cmp(b).is_eq());
    all
}

pub(crate) fn draw(csv: &Path, out: &Path, name: &str) -> Result<Vec<PathBuf>> {
    let points = read(csv)?;
    let loads = values(&points, |p| p.force_bar);
    let dimensions = values(&points, |p| p.fractal_dimension);
    let (mut plots, mut layouts) = (Vec::new(), Vec::new());
    for (family, words) in [("band", "resolved waves"), ("spectrum", "fractal to the grid's end")] {
        for &load in &loads {
            let title = format!("{words}, F_bar = {load:?}");
            let (p, l) = panel(&points, family, load, &dimensions, &title).parts();
            plots.push(p);
            layouts.push(l);
        }
    }
    let columns = loads.len().max(1);
    let scene = Figure::new(2, columns)
        .with_cell_size(400.0, 370.0)
        .with_plots(plots)
        .with_layouts(layouts)
        .with_shared_legend_entries(legend(&dimensions))
        .with_shared_legend_bottom()
        .render();
    save(scene, out, name)
}

fn panel(points: &[Point], family: &str, load: f64, dimensions: &[f64], title: &str) -> Picture {
    let (x, y) = (Axis::Log(SECONDS.0, SECONDS.1), Axis::Log(ERRORS.0, ERRORS.1));
    let mut picture = Picture::new(x, y, "processor seconds", "relative error of k").with_title(title);
    for target in TARGETS {
        picture.line(&[(SECONDS.0, target), (SECONDS.1, target)], "#bbbbbb", 1.0, &LineStyle::Dashed);
        picture.note(&format!("{} %", 100.0 * target), (SECONDS.1 / 5.0, target * 1.15));
    }
    let here = |p: &&Point, family: &str, d: f64| {
        p.family == family && same(p.force_bar, Some(load)) && same(p.fractal_dimension, Some(d))
    };
    // What is faster or nearer than the axes go stands on their edge.
    let place = |p: &Point| {
        let seconds = p.seconds.unwrap_or(0.0).clamp(SECONDS.0 * 1.2, SECONDS.1 / 1.2);
        Some((seconds, p.error?.clamp(ERRORS.0 * 1.1, ERRORS.1 / 1.1)))
    };
    for &d in dimensions {
        let color = color(d);
        let front: Vec<&Point> =
            points.iter().filter(|p| here(p, family, d) && p.pareto && p.model == "bem3d").collect();
        let mut at: Vec<(f64, f64)> = front.iter().filter_map(|p| place(p)).collect();
        at.sort_by(|a, b| a.0.total_cmp(&b.0));
        picture.line(&at, &color, 1.6, &LineStyle::Solid);
        for p in &front {
            let at: Vec<(f64, f64)> = place(p).into_iter().collect();
            picture.points(&at, &color, mark_size(p.size), Mark::Solid(MarkerShape::Circle));
        }
        if family != "spectrum" {
            continue;
        }
        let means = |model: &str, mark: Mark, picture: &mut Picture| {
            let at: Vec<(f64, f64)> =
                points.iter().filter(|p| here(p, "mean", d) && p.model == model).filter_map(place).collect();
            picture.points(&at, &color, 4.2, mark);
        };
        means("mdr1d", Mark::Hollow(MarkerShape::Square), &mut picture);
        means("power_law", Mark::Solid(MarkerShape::Cross), &mut picture);
        means("plateau", Mark::Solid(MarkerShape::Triangle), &mut picture);
    }
    picture
}

/// Finer grids have larger marks.
fn mark_size(cells: Option<f64>) -> f64 {
    2.4 + 0.9 * (cells.unwrap_or(64.0) / 64.0).log2().max(0.0)
}

fn legend(dimensions: &[f64]) -> Vec<LegendEntry> {
    // The library's box is too narrow for its own words: spaces that do not break widen it.
    let entry = |label: String, color: &str, shape| LegendEntry {
        label: label + &"\u{a0}".repeat(6),
        color: color.to_owned(),
        shape,
        dasharray: None,
    };
    let mut all: Vec<LegendEntry> = dimensions
        .iter()
        .map(|d| entry(format!("3D, D_f = {d:?}"), &color(*d), LegendShape::Marker(MarkerShape::Circle)))
        .collect();
    all.push(entry("1D, mean".to_owned(), NEUTRAL, LegendShape::Marker(MarkerShape::Square)));
    all.push(entry("Eq. 12, mean".to_owned(), NEUTRAL, LegendShape::Marker(MarkerShape::Cross)));
    all.push(entry("rigid square".to_owned(), NEUTRAL, LegendShape::Marker(MarkerShape::Triangle)));
    all
}
