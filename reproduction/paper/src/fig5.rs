//! Fig. 5: the equivalent lines.

use crate::evaluation::{FRACTAL_DIMENSION, Flag, Outcome, Run, Session, TableOf, header, list, read_rows};
use crate::judged::Judged;
use crate::output::{save, write_npy};
use crate::{curves, words};
use contact_model::{Line, SelfAffine};
use plots::{Axis, LineStyle, Panels, Picture, extent};
use runs::{CsvFile, Error, Progress, Result, threads_for_memory};
use std::path::{Path, PathBuf};

/// The flags on which Fig. 5 depends.
pub const FLAGS: [Flag; 3] = [Flag::ELEMENTS, Flag::FRACTAL_DIMENSIONS, Flag::SEED];

/// The paper's three lines, from top to bottom.
const DIMENSIONS: [f64; 3] = [3.0, 2.5, 2.0];

/// Number of bins of the CSV, with two extremes each: more than a picture has pixels.
const BINS: usize = 1000;

/// Memory of drawing a line, bytes per element.
const BYTES: f64 = 40.0;

/// Draws line number 0 of each fractal dimension (3, 2.5 and 2 by default): `fig5.csv` with the lowest and
/// the highest element of each of 1000 bins, so that no peak is lost, `fig5.svg`, `fig5.png`, and whole as
/// `fig5-df2.0.npy`, ...
///
/// Source: Fig. 5 of the paper (2^20 elements).
///
/// # Errors
/// Files that cannot be written, lines that do not fit in memory.
pub fn fig5(run: &Run, progress: &dyn Progress) -> Result<Judged> {
    threads_for_memory(1, BYTES * run.elements as f64, "elements", run.elements)?;
    let session = Session::open(&run.out, run.fresh)?;
    let dimensions: Vec<f64> = run
        .fractal_dimensions
        .as_ref()
        .map_or_else(|| DIMENSIONS.to_vec(), |given| given.iter().rev().copied().collect());
    let mut outcome = Outcome::new("fig5");
    let mut points = Vec::new();
    let seed = surface_gen::surface_seed(run.seed, 0);
    let cost = run.elements as u64;
    progress.begin(
        &format!("{} lines of {} elements", dimensions.len(), run.elements),
        cost * dimensions.len() as u64,
    );
    for &d in &dimensions {
        let line = SelfAffine::new(d, 1.0, 1.0)
            .and_then(|s| surface_gen::self_affine_line(&s, run.elements, seed))
            .map_err(Error::model(format!("the line of D_f = {d:?}")))?;
        let at = |i: usize| [d, (i as f64 + 0.5) * line.element(), line.heights()[i]];
        points.extend(extremes(&line).into_iter().map(at));
        let npy = run.out.join(format!("fig5-df{d:?}.npy"));
        write_npy(&npy, &[run.elements], line.heights())?;
        outcome.files.push(npy);
        progress.advance(cost, false);
    }
    progress.end();
    let table = TableOf::new("Fig. 5: equivalent rough lines", &points)
        .column("fractal_dimension", "1", FRACTAL_DIMENSION, |p| p[0])
        .column("x", "L", "centre of the element, 0 to L_1D = (2/sqrt(pi)) L", |p| p[1])
        .column("height", "h", "in units of the rms height of the whole line, mean 0", |p| p[2])
        .table()?;
    let header = header(run.command("reproduce-fig5", &FLAGS))
        .with_note(format!("fractal_dimensions: {}", list(&dimensions)))
        .with_note(format!("seed: {} (line 0: {seed}; the same phases for every D_f)", run.seed))
        .with_note(format!(
            "line: {} elements; here the lowest and the highest of each of {} bins, in order of x",
            run.elements,
            BINS.min(run.elements)
        ));
    outcome.files.extend(curves::written(run, "fig5", &table, &header, |csv| draw(csv, &run.out))?);
    session.close(outcome).map(Judged::from)
}

/// Indices of the lowest and the highest element of each bin, increasing; one where both are the same.
fn extremes(line: &Line) -> Vec<usize> {
    let h = line.heights();
    let bins = BINS.min(h.len());
    let mut kept = Vec::with_capacity(2 * bins);
    for bin in 0..bins {
        let range = bin * h.len() / bins..(bin + 1) * h.len() / bins;
        let lowest = range.clone().min_by(|&a, &b| h[a].total_cmp(&h[b]));
        let highest = range.max_by(|&a, &b| h[a].total_cmp(&h[b]));
        if let (Some(a), Some(b)) = (lowest, highest) {
            kept.push(a.min(b));
            if a != b {
                kept.push(a.max(b));
            }
        }
    }
    kept
}

/// Draws `fig5.svg` and `fig5.png` from the table.
pub(crate) fn draw(csv: &Path, out: &Path) -> Result<Vec<PathBuf>> {
    let file = CsvFile::read(csv)?;
    let rows: Vec<(f64, f64, f64)> = read_rows(csv, &file)?;
    let curves: Vec<_> = rows.chunk_by(|a, b| a.0.total_cmp(&b.0).is_eq()).collect();
    let mut pictures = Vec::new();
    for (panel, curve) in curves.iter().enumerate() {
        let (low, high) = extent(curve.iter().map(|r| r.2)).unwrap_or((-1.0, 1.0));
        let margin = 0.08 * (high - low).max(1e-3);
        let x = Axis::Linear(0.0, contact_model::line_length(1.0));
        let letter = char::from(b'a' + panel as u8);
        let below = if panel + 1 == curves.len() { "position $x/L$" } else { "" };
        let mut picture = Picture::new(x, Axis::Linear(low - margin, high + margin), below, "height $z/h$")
            .with_size(800.0, 225.0)
            .with_subtitle(&format!("({letter})  {}", words::dimension(curve[0].0)));
        let points: Vec<(f64, f64)> = curve.iter().map(|r| (r.1, r.2)).collect();
        picture.line(&points, "#1f2937", 0.7, LineStyle::Solid);
        pictures.push(picture);
    }
    let size = words::flag(&file, "--elements").and_then(|n| n.parse().ok()).map(words::elements);
    let title = format!("{}{}", words::title(&file), size.map_or_else(String::new, |s| format!(", {s}")));
    save(Panels { pictures, columns: 1, title, ..Panels::default() }.files("fig5"), out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_peak_is_lost() {
        let heights: Vec<f64> = (0..5000).map(|i| if i == 3001 { 9.0 } else { f64::from(i % 7) }).collect();
        let line = Line::new(1.0, heights).unwrap();
        let kept = extremes(&line);
        assert!(kept.contains(&3001) && kept.windows(2).all(|w| w[0] < w[1]));
        assert_eq!(kept.len(), 2 * BINS);
        let short = Line::new(1.0, vec![1.0, 0.0, 2.0]).unwrap();
        assert_eq!(extremes(&short), [0, 1, 2]);
    }
}
