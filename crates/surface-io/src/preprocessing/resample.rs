//! Coarser cells.

use contact_model::Cells;

/// Heights on at most as many columns and rows: each is the mean of the map over its area, so the mean height
/// stays.
///
/// The map is taken as constant over each fine cell; a fine cell that two coarse ones share counts for each
/// by its area there. Along x, then along y. A coarse cell is the mean over its defined part, and NaN where
/// less than half of its area is defined. Summits become lower, and the rms height and slope become smaller,
/// as with a coarser instrument. Cost O(N) for N points.
pub(super) fn coarsen(heights: Vec<f64>, cells: Cells, coarse: Cells) -> Vec<f64> {
    if coarse == cells {
        return heights;
    }
    if !heights.iter().any(|h| h.is_nan()) {
        return means(&heights, cells, coarse);
    }
    let defined: Vec<f64> = heights.iter().map(|h| f64::from(u8::from(!h.is_nan()))).collect();
    let heights: Vec<f64> = heights.iter().map(|h| if h.is_nan() { 0.0 } else { *h }).collect();
    let mean = |(h, share): (f64, f64)| if share < HALF { f64::NAN } else { h / share };
    means(&heights, cells, coarse).into_iter().zip(means(&defined, cells, coarse)).map(mean).collect()
}

/// Half of a cell, but for roundings of its parts.
const HALF: f64 = 0.5 - 1e-9;

/// Means over coarser cells.
fn means(values: &[f64], cells: Cells, coarse: Cells) -> Vec<f64> {
    let overlaps = |cells: usize, coarse: usize| (0..coarse).map(move |k| overlaps(k, cells, coarse));
    let parts: Vec<(usize, Vec<f64>)> = overlaps(cells.columns, coarse.columns).collect();
    let mut across = Vec::with_capacity(cells.rows * coarse.columns);
    for row in values.chunks_exact(cells.columns) {
        for (from, weights) in &parts {
            across.push(row[*from..].iter().zip(weights).map(|(h, w)| h * w).sum::<f64>());
        }
    }
    let mut result = vec![0.0; coarse.rows * coarse.columns];
    for ((from, weights), row) in
        overlaps(cells.rows, coarse.rows).zip(result.chunks_exact_mut(coarse.columns))
    {
        let fine = across[from * coarse.columns..].chunks_exact(coarse.columns);
        for (fine, weight) in fine.zip(weights) {
            for (sum, h) in row.iter_mut().zip(fine) {
                *sum += weight * h;
            }
        }
    }
    result
}

/// The first fine cell under coarse cell k and the shares of it and those behind it, which add up to 1.
fn overlaps(k: usize, cells: usize, coarse: usize) -> (usize, Vec<f64>) {
    // In units of 1 / (cells * coarse) of the side all edges are whole numbers.
    let (from, to) = (k * cells, (k + 1) * cells);
    let (first, last) = (from / coarse, (to - 1) / coarse);
    let share = |i: usize| (to.min((i + 1) * coarse) - from.max(i * coarse)) as f64 / cells as f64;
    (first, (first..=last).map(share).collect())
}
