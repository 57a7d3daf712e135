//! The picture of a bench: cost over the number of cells, or over the load where there is one size only.

use crate::csv_file::CsvFile;
use crate::error::{Error, Result};
use crate::plot::{Key, Mark, Picture, color, logarithmic};
use kuva::plot::line::LineStyle;
use kuva::plot::scatter::MarkerShape;
use std::path::{Path, PathBuf};

/// Marks of the loads, lightest first.
const MARKS: [MarkerShape; 5] = [
    MarkerShape::Circle,
    MarkerShape::Square,
    MarkerShape::Triangle,
    MarkerShape::Diamond,
    MarkerShape::Cross,
];

/// One solve as the picture sees it.
#[derive(Debug, Clone, Copy)]
struct Point {
    fractal_dimension: f64,
    force_bar: f64,
    cells: f64,
    seconds: f64,
    iterations: f64,
}

/// Draws seconds over cells (or over force where all rows have one size) from a table of [`crate::write_bench`], as SVG and PNG, and returns
/// one line per curve with the fitted powers of the cost: `seconds ~ cells^a, iterations ~ cells^b` (least squares in logarithms).
///
/// # Errors
/// [`Error::File`] or [`Error::Content`] for a table that cannot be read, [`Error::Parameter`] for a picture without a name.
pub fn plot_bench(csv: &Path, picture: &Path) -> Result<Vec<String>> {
    let name = picture.file_stem().and_then(|s| s.to_str());
    let name =
        name.ok_or_else(|| Error::parameter("plot", picture.display(), "a file name such as bench.svg"))?;
    let directory = picture.parent().map_or_else(PathBuf::new, Path::to_owned);
    let points = read(csv)?;
    let several = points.iter().any(|p| p.cells.total_cmp(&points[0].cells).is_ne());
    let x = |p: &Point| if several { p.cells } else { p.force_bar };
    let mut curves: Vec<Vec<Point>> = Vec::new();
    for &p in &points {
        let same = |c: &&mut Vec<Point>| {
            let q = c[0];
            q.fractal_dimension.total_cmp(&p.fractal_dimension).is_eq()
                && (!several || q.force_bar.total_cmp(&p.force_bar).is_eq())
        };
        match curves.iter_mut().find(same) {
            Some(curve) => curve.push(p),
            None => curves.push(vec![p]),
        }
    }
    let mut loads: Vec<f64> = points.iter().map(|p| p.force_bar).collect();
    loads.sort_by(f64::total_cmp);
    loads.dedup();
    let label = if several { "cells a side" } else { "force  F / (E* h L)" };
    let y = logarithmic(points.iter().map(|p| p.seconds));
    let mut drawing = Picture::new(logarithmic(points.iter().map(x)), y, label, "seconds")
        .with_title("Cost of one certified solve with its stiffness");
    let mut lines = Vec::new();
    let mut known = Vec::new();
    for curve in &mut curves {
        curve.sort_by(|a, b| x(a).total_cmp(&x(b)));
        let d = curve[0].fractal_dimension;
        let rank = loads.iter().position(|f| f.total_cmp(&curve[0].force_bar).is_eq()).unwrap_or(0);
        let mark = if several { MARKS[rank % MARKS.len()] } else { MARKS[0] };
        let at: Vec<(f64, f64)> = curve.iter().map(|p| (x(p), p.seconds)).collect();
        drawing.line(&at, &color(d), 1.2, &LineStyle::Solid);
        drawing.points(&at, &color(d), 4.0, Mark::Solid(mark));
        if !known.contains(&d.to_bits()) {
            known.push(d.to_bits());
            drawing.legend(&format!("D_f = {d:?}"), &color(d), Key::Mark(MARKS[0]));
        }
        let load = if several { format!(", F_bar {:?}", curve[0].force_bar) } else { String::new() };
        let power = |of: fn(&Point) -> f64| slope(curve.iter().map(|p| (x(p), of(p))));
        if let (Some(a), Some(b)) = (power(|p| p.seconds), power(|p| p.iterations)) {
            let over = if several { "cells" } else { "F_bar" };
            lines.push(format!("D_f {d:?}{load}: seconds ~ {over}^{a:.2}, iterations ~ {over}^{b:.2}"));
        }
    }
    if several {
        for (rank, load) in loads.iter().enumerate() {
            drawing.legend(&format!("F_bar = {load:?}"), "#555555", Key::Mark(MARKS[rank % MARKS.len()]));
        }
    }
    drawing.save(&directory, name)?;
    Ok(lines)
}

fn read(csv: &Path) -> Result<Vec<Point>> {
    let file = CsvFile::read(csv)?;
    let columns = ["fractal_dimension", "force_bar", "cells", "seconds", "iterations"];
    let [d, force, cells, seconds, iterations] = columns.map(|name| file.numbers(name));
    let (d, force, cells, seconds, iterations) = (d?, force?, cells?, seconds?, iterations?);
    let rows = (0..force.len()).filter_map(|i| {
        Some(Point {
            // A map from a file has no fractal dimension of its own.
            fractal_dimension: d[i].unwrap_or(0.0),
            force_bar: force[i]?,
            cells: cells[i]?,
            seconds: seconds[i]?,
            iterations: iterations[i]?,
        })
    });
    let points: Vec<Point> = rows.collect();
    if points.is_empty() {
        return Err(Error::content(csv, "no rows to draw"));
    }
    Ok(points)
}

/// Least-squares slope of ln y over ln x; `None` for fewer than two different x.
fn slope(points: impl Iterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|p| (p.0.ln(), p.1.ln())).collect();
    let n = logs.len() as f64;
    let (x, y) = (logs.iter().map(|p| p.0).sum::<f64>() / n, logs.iter().map(|p| p.1).sum::<f64>() / n);
    let (xy, xx) =
        logs.iter().fold((0.0, 0.0), |(a, b), p| (a + (p.0 - x) * (p.1 - y), b + (p.0 - x).powi(2)));
    (xx > 0.0).then(|| xy / xx)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_slope_of_a_power_is_its_exponent() {
        let points = [1.0, 2.0, 5.0].map(|x: f64| (x, 3.0 * x.powf(1.5)));
        approx::assert_relative_eq!(slope(points.into_iter()).unwrap(), 1.5, max_relative = 1e-12);
        assert_eq!(slope([(2.0, 1.0)].into_iter()), None);
    }

    #[test]
    fn a_picture_is_drawn_from_the_table() {
        let dir = tempfile::tempdir().unwrap();
        let csv = dir.path().join("bench.csv");
        let text = "cells,force_bar,seconds,iterations,fractal_dimension\n\
                    64,1,0.1,10,2.4\n128,1,0.4,10,2.4\n64,0.1,0.01,5,2.4\n128,0.1,0.02,6,2.4\n";
        std::fs::write(&csv, text).unwrap();
        let lines = plot_bench(&csv, &dir.path().join("bench.svg")).unwrap();
        assert_eq!(lines[0], "D_f 2.4, F_bar 1.0: seconds ~ cells^2.00, iterations ~ cells^0.00");
        assert!(dir.path().join("bench.png").exists() && dir.path().join("bench.svg").exists());
        assert!(plot_bench(&dir.path().join("none.csv"), Path::new("x.svg")).is_err());
    }
}
