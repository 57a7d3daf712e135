//! Outliers, and the largest part of a map without undefined points.

use contact_model::Cells;
use std::ops::Range;

/// The standard deviation of a Gaussian over its median absolute deviation.
pub(super) const GAUSSIAN: f64 = 1.4826;

/// Makes NaN of every height farther from the median of its neighbours (eight, fewer at an edge) than `times`
/// the robust standard deviation of all such distances; how many.
///
/// One pass: two outliers beside each other are found, a patch of many is not. Cost O(N log N) for N points.
pub(super) fn remove_outliers(cells: Cells, times: f64, heights: &mut [f64]) -> usize {
    let Cells { columns, rows } = cells;
    let distance = |i: usize| {
        let (row, column) = (i / columns, i % columns);
        let mut around = [0.0; 8];
        let mut count = 0;
        for j in row.saturating_sub(1)..(row + 2).min(rows) {
            for k in column.saturating_sub(1)..(column + 2).min(columns) {
                let h = heights[j * columns + k];
                if (j, k) != (row, column) && !h.is_nan() {
                    around[count] = h;
                    count += 1;
                }
            }
        }
        (count > 0 && !heights[i].is_nan()).then(|| heights[i] - median(&mut around[..count]))
    };
    let distances: Vec<Option<f64>> = (0..heights.len()).map(distance).collect();
    let mut sizes: Vec<f64> = distances.iter().flatten().map(|d| d.abs()).collect();
    if sizes.is_empty() {
        return 0;
    }
    let limit = times * GAUSSIAN * median(&mut sizes);
    let mut removed = 0;
    for (h, distance) in heights.iter_mut().zip(distances) {
        if distance.is_some_and(|d| d.abs() > limit) {
            *h = f64::NAN;
            removed += 1;
        }
    }
    removed
}

/// The middle value, the lower one of two; of at least one value.
fn median(values: &mut [f64]) -> f64 {
    let middle = (values.len() - 1) / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Rows and columns of the largest rectangle without undefined points, by its number of cells; the first of
/// several. Cost O(N).
pub(super) fn largest_defined(cells: Cells, heights: &[f64]) -> (Range<usize>, Range<usize>) {
    let mut best = (0, 0..0, 0..0);
    // Defined points above each other that end in this row.
    let mut defined = vec![0_usize; cells.columns + 1];
    for (row, line) in heights.chunks_exact(cells.columns).enumerate() {
        for (count, h) in defined.iter_mut().zip(line) {
            *count = if h.is_nan() { 0 } else { *count + 1 };
        }
        // Columns of growing height: each begins the widest rectangle of its own height. The last column, of
        // none, closes all.
        let mut open: Vec<(usize, usize)> = Vec::new();
        for (column, &height) in defined.iter().enumerate() {
            let mut from = column;
            while let Some(&(start, tall)) = open.last().filter(|(_, tall)| *tall >= height) {
                open.pop();
                let area = tall * (column - start);
                if area > best.0 {
                    best = (area, row + 1 - tall..row + 1, start..column);
                }
                from = start;
            }
            open.push((from, height));
        }
    }
    (best.1, best.2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_spike_and_a_pit_go_and_a_wave_stays() {
        let cells = Cells { columns: 20, rows: 10 };
        let mut heights: Vec<f64> =
            (0..200).map(|i| (f64::from(i % 20) / 3.0).sin() + 0.1 * f64::from(i / 20)).collect();
        heights[0] = f64::NAN;
        let before = heights.clone();
        assert_eq!(remove_outliers(cells, 30.0, &mut heights), 0);
        heights[77] = 40.0;
        heights[199] = -40.0;
        assert_eq!(remove_outliers(cells, 30.0, &mut heights), 2);
        for (i, (after, before)) in heights.iter().zip(&before).enumerate() {
            let gone = [0, 77, 199].contains(&i);
            assert!(if gone { after.is_nan() } else { after.to_bits() == before.to_bits() }, "{i}");
        }
        assert_eq!(remove_outliers(Cells { columns: 1, rows: 1 }, 3.0, &mut [1.0]), 0);
    }

    proptest! {
        /// Against all rectangles.
        #[test]
        fn the_largest_rectangle_is_found(holes in prop::collection::vec(any::<bool>(), 30)) {
            let cells = Cells { columns: 6, rows: 5 };
            let heights: Vec<f64> = holes.iter().map(|&hole| if hole { f64::NAN } else { 1.0 }).collect();
            let whole = |rows: &Range<usize>, columns: &Range<usize>| {
                rows.clone().all(|row| columns.clone().all(|column| !holes[6 * row + column]))
            };
            let mut most = 0;
            for (top, left) in (0..5).flat_map(|top| (0..6).map(move |left| (top, left))) {
                for (bottom, right) in (top + 1..6).flat_map(|b| (left + 1..7).map(move |r| (b, r))) {
                    if whole(&(top..bottom), &(left..right)) {
                        most = most.max((bottom - top) * (right - left));
                    }
                }
            }
            let (rows, columns) = largest_defined(cells, &heights);
            prop_assert!(whole(&rows, &columns));
            prop_assert_eq!(rows.len() * columns.len(), most);
        }
    }
}
