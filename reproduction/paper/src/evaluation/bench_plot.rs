//! Pictures of a bench: cost over the number of cells, or over the load where there is only one size.

use crate::evaluation::run::distinct;
use crate::evaluation::table_of::read_rows;
use crate::output::save;
use analysis::observed_power;
use plots::{LegendKey, LineStyle, Mark, MarkShape, NEUTRAL, Picture, color, logarithmic, number};
use runs::{CsvFile, Error, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Marks of the loads or of the sizes, smallest first.
const MARKS: [MarkShape; 5] =
    [MarkShape::Circle, MarkShape::Square, MarkShape::Triangle, MarkShape::Diamond, MarkShape::Cross];

/// The pictures of a bench.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BenchPlot {
    /// Files written.
    pub files: Vec<PathBuf>,
    /// The fitted powers of each curve: `seconds ~ cells^a, iterations ~ cells^b` (least squares in
    /// logarithms).
    pub slopes: Vec<String>,
}

/// One solve, with the columns that the picture uses.
#[derive(Debug, Clone, PartialEq, Deserialize)]
struct BenchPoint {
    surface: String,
    fractal_dimension: Option<f64>,
    tolerance: f64,
    force_bar: f64,
    cells: f64,
    seconds: f64,
    iterations: f64,
    status: String,
}

impl BenchPoint {
    fn converged(&self) -> bool {
        self.status == contact_model::Status::Converged.as_str()
    }
}

/// The quantity along the horizontal axis; the other one distinguishes the curves.
#[derive(Clone, Copy)]
struct BenchAxis {
    of: fn(&BenchPoint) -> f64,
    name: &'static str,
    /// Its symbol in a picture.
    symbol: &'static str,
    label: &'static str,
}

const CELLS: BenchAxis =
    BenchAxis { of: |p| p.cells, name: "cells", symbol: "N", label: "cells per side $N$" };
const FORCE: BenchAxis = BenchAxis {
    of: |p| p.force_bar,
    name: "F_bar",
    symbol: "\\bar{F}",
    label: "normalised force $\\bar{F} = F/(E^* h L)$",
};

impl BenchAxis {
    /// The distinct values, increasing.
    fn values(self, points: &[BenchPoint]) -> Vec<f64> {
        distinct(points.iter().map(self.of))
    }
}

/// Draws seconds over cells from a table of [`crate::evaluation::write_bench`], as SVG and PNG; over force where
/// all rows have one size, and in a second picture (`NAME-force`) where there are several of both. Solves that did
/// not converge have hollow marks and are left out of the fits.
///
/// # Errors
/// [`Error::File`] for a table that cannot be read, [`Error::Parameter`] for a picture without a name.
pub fn plot_bench(csv: &Path, picture: &Path) -> Result<BenchPlot> {
    let name = picture.file_stem().and_then(|s| s.to_str());
    let name =
        name.ok_or_else(|| Error::parameter("plot", picture.display(), "a file name such as bench.svg"))?;
    let directory = picture.parent().map_or_else(PathBuf::new, Path::to_owned);
    let points = read(csv)?;
    let mut plot = BenchPlot::default();
    let (sizes, loads) = (CELLS.values(&points).len(), FORCE.values(&points).len());
    if sizes > 1 {
        draw(&points, [CELLS, FORCE], &directory, name, &mut plot)?;
    }
    if loads > 1 || sizes == 1 {
        let name = if sizes > 1 { format!("{name}-force") } else { name.to_owned() };
        draw(&points, [FORCE, CELLS], &directory, &name, &mut plot)?;
    }
    Ok(plot)
}

fn draw(
    points: &[BenchPoint],
    [over, other]: [BenchAxis; 2],
    directory: &Path,
    name: &str,
    plot: &mut BenchPlot,
) -> Result<()> {
    let others = other.values(points);
    let y = logarithmic(points.iter().map(|p| p.seconds));
    let along = over.values(points);
    let mut drawing = Picture::new(logarithmic(along.iter().copied()), y, over.label, "wall-clock time (s)")
        .with_title("Time of one certified solve with its stiffness")
        .with_subtitle(&tolerance_words(points));
    // Sizes of grids are few and odd: each has its own label.
    if over.name == CELLS.name && along.len() <= 8 {
        drawing = drawing.with_x_ticks(&along);
    }
    let tolerances = points.iter().any(|p| p.tolerance.total_cmp(&points[0].tolerance).is_ne());
    let mut known = Vec::new();
    for mut curve in curves(points, other) {
        curve.sort_by(|a, b| (over.of)(a).total_cmp(&(over.of)(b)));
        let first = curve[0].clone();
        let color = first.fractal_dimension.map_or_else(|| NEUTRAL.to_owned(), color);
        let what = first.fractal_dimension.map_or_else(|| first.surface.clone(), |d| format!("D_f = {d:?}"));
        let rank = others.iter().position(|v| v.total_cmp(&(other.of)(&first)).is_eq()).unwrap_or(0);
        let mark = MARKS[rank % MARKS.len()];
        let (done, open): (Vec<BenchPoint>, Vec<BenchPoint>) =
            curve.into_iter().partition(BenchPoint::converged);
        let at = |points: &[BenchPoint]| points.iter().map(|p| ((over.of)(p), p.seconds)).collect::<Vec<_>>();
        drawing.line(&at(&done), &color, 1.4, LineStyle::Solid);
        drawing.points(&at(&done), &color, 4.6, Mark::Solid(mark));
        drawing.points(&at(&open), &color, 4.6, Mark::Hollow(mark));
        if !known.contains(&what) {
            let label = first
                .fractal_dimension
                .map_or_else(|| what.clone(), |d| format!("$D_{{\\rm{{f}}}} = {d:?}$"));
            drawing.legend(&label, &color, LegendKey::Line(LineStyle::Solid));
            known.push(what.clone());
        }
        let power = |of: fn(&BenchPoint) -> f64| observed_power(done.iter().map(|p| ((over.of)(p), of(p))));
        if let (Some(a), Some(b)) = (power(|p| p.seconds), power(|p| p.iterations)) {
            let mut curve = format!("{what}, {} = {}", other.name, shown((other.of)(&first)));
            if tolerances {
                curve += &format!(", tolerance {:?}", first.tolerance);
            }
            let over = over.name;
            plot.slopes.push(format!("{curve}: seconds ~ {over}^{a:.2}, iterations ~ {over}^{b:.2}"));
        }
    }
    if others.len() > 1 {
        for (rank, value) in others.iter().enumerate() {
            let label = format!("${} = {}$", other.symbol, number(*value).replace('$', ""));
            drawing.legend(&label, NEUTRAL, LegendKey::Mark(Mark::Solid(MARKS[rank % MARKS.len()])));
        }
    }
    plot.files.extend(save(drawing.files(name), directory)?);
    Ok(())
}

/// Points of one surface, one tolerance and one value of `other`, in the order in which they come.
fn curves(points: &[BenchPoint], other: BenchAxis) -> Vec<Vec<BenchPoint>> {
    let mut curves: Vec<Vec<BenchPoint>> = Vec::new();
    for p in points {
        let same = |c: &&mut Vec<BenchPoint>| {
            let q = &c[0];
            q.surface == p.surface
                && q.fractal_dimension == p.fractal_dimension
                && q.tolerance.total_cmp(&p.tolerance).is_eq()
                && (other.of)(q).total_cmp(&(other.of)(p)).is_eq()
        };
        match curves.iter_mut().find(same) {
            Some(curve) => curve.push(p.clone()),
            None => curves.push(vec![p.clone()]),
        }
    }
    curves
}

/// The tolerances of all solves, in words.
fn tolerance_words(points: &[BenchPoint]) -> String {
    let all: Vec<String> = distinct(points.iter().map(|p| p.tolerance)).into_iter().map(number).collect();
    format!("tolerance of the certificate: {}", all.join(", "))
}

/// Draws again every picture of a bench in a directory: of each table of [`crate::evaluation::write_bench`] with an SVG
/// or PNG of its name.
///
/// # Errors
/// As [`plot_bench`]; a directory that cannot be read.
pub fn redraw_benches(directory: &Path) -> Result<Vec<PathBuf>> {
    let mut tables: Vec<PathBuf> = std::fs::read_dir(directory)
        .map_err(Error::file("read", directory))?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|p| p.extension().is_some_and(|e| e == "csv"))
        .filter(|p| ["svg", "png"].iter().any(|e| p.with_extension(e).exists()))
        .collect();
    tables.sort();
    let mut files = Vec::new();
    for csv in tables {
        let file = CsvFile::read(&csv)?;
        // Other tables have pictures of their own.
        if ["cells", "seconds", "strategy"].iter().all(|name| file.column(name).is_ok()) {
            files.extend(plot_bench(&csv, &csv.with_extension("svg"))?.files);
        }
    }
    Ok(files)
}

/// Whole numbers without their `.0`.
fn shown(value: f64) -> String {
    if value.fract().abs() > 0.0 { format!("{value:?}") } else { format!("{value}") }
}

fn read(csv: &Path) -> Result<Vec<BenchPoint>> {
    let file = CsvFile::read(csv)?;
    let points: Vec<BenchPoint> = read_rows(csv, &file)?;
    if points.is_empty() {
        return Err(Error::content(csv, "no rows to draw"));
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_are_drawn_from_the_table() {
        let dir = tempfile::tempdir().unwrap();
        let (csv, svg) = (dir.path().join("bench.csv"), dir.path().join("bench.svg"));
        let head = "cells,force_bar,seconds,iterations,status,tolerance,surface,fractal_dimension\n";
        let several = "64,1,0.1,10,converged,1e-6,self-affine,2.4\n128,1,0.4,10,converged,1e-6,self-affine,2.4\n\
                       64,0.1,0.01,5,converged,1e-6,self-affine,2.4\n128,0.1,0.02,6,iteration_limit,1e-6,self-affine,2.4\n";
        std::fs::write(&csv, format!("{head}{several}")).unwrap();
        let plot = plot_bench(&csv, &svg).unwrap();
        assert_eq!(plot.slopes[0], "D_f = 2.4, F_bar = 1: seconds ~ cells^2.00, iterations ~ cells^0.00");
        // One point of the lighter load is left over the sizes, two over the loads at 64 cells.
        assert_eq!(plot.slopes.len(), 2);
        assert_eq!(plot.slopes[1], "D_f = 2.4, cells = 64: seconds ~ F_bar^1.00, iterations ~ F_bar^0.30");
        assert_eq!(plot.files.len(), 4);
        assert!(plot.files.iter().all(|f| f.exists()));

        // A map has one size and no fractal dimension; tolerances are curves of their own.
        let map = "64,1,0.1,10,converged,1e-6,map.npy,\n64,10,1,10,converged,1e-6,map.npy,\n\
                   64,1,0.1,10,converged,1e-3,map.npy,\n64,10,0.1,10,converged,1e-3,map.npy,\n";
        std::fs::write(&csv, format!("{head}{map}")).unwrap();
        let plot = plot_bench(&csv, &svg).unwrap();
        assert_eq!((plot.files.len(), plot.slopes.len()), (2, 2));
        assert_eq!(
            plot.slopes[1],
            "map.npy, cells = 64, tolerance 0.001: seconds ~ F_bar^0.00, iterations ~ F_bar^0.00"
        );

        std::fs::write(&csv, head).unwrap();
        assert!(plot_bench(&csv, &svg).unwrap_err().to_string().contains("no rows"));
        assert!(plot_bench(&dir.path().join("none.csv"), Path::new("x.svg")).is_err());
    }
}
