//! Coarser cells.

/// Heights on `coarse` <= `cells` cells a side: each is the mean of the map over its area, so the mean height stays.
///
/// The map is taken as constant over each fine cell; a fine cell that two coarse ones share counts for each by its area there. Along x, then along y.
/// Summits become lower, the rms height and slope smaller: what a coarser instrument sees. Cost O(N^2).
pub(super) fn coarsen(heights: &[f64], cells: usize, coarse: usize) -> Vec<f64> {
    if coarse == cells {
        return heights.to_vec();
    }
    let parts: Vec<(usize, Vec<f64>)> = (0..coarse).map(|k| overlaps(k, cells, coarse)).collect();
    let mut across = Vec::with_capacity(cells * coarse);
    for row in heights.chunks_exact(cells) {
        for (from, weights) in &parts {
            across.push(row[*from..].iter().zip(weights).map(|(h, w)| h * w).sum::<f64>());
        }
    }
    let mut result = vec![0.0; coarse * coarse];
    for ((from, weights), row) in parts.iter().zip(result.chunks_exact_mut(coarse)) {
        for (fine, weight) in across[from * coarse..].chunks_exact(coarse).zip(weights) {
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
