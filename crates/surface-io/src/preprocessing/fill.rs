//! Undefined points filled by the discrete harmonic function with the measured rim.

use contact_model::Cells;

/// Residual, as a share of the first one, at which the iteration ends: rounding of heights of six digits is
/// far larger.
const TOLERANCE: f64 = 1e-12;

/// Fills every NaN so that it is the weighted mean of its neighbours; at least one height must be measured.
/// `aspect` is dy/dx of a cell.
///
/// The flow from one cell to the next is the difference of their heights times the length of their common
/// edge over the distance of their centres: dy/dx along x, dx/dy along y, 1 for square cells. Conjugate
/// gradients on the graph Laplacian of the missing cells, which is positive definite because the grid is
/// connected. Cost O(m) for each of about as many iterations as the largest undefined patch is wide; memory 9
/// numbers for each of the m missing cells and one for every cell.
pub(super) fn harmonic(cells: Cells, aspect: f64, heights: &mut [f64]) {
    let missing: Vec<usize> = (0..heights.len()).filter(|&i| heights[i].is_nan()).collect();
    // What is measured has the number behind the last: a place of the vectors that stays 0.
    let measured = missing.len();
    let mut number = vec![measured; heights.len()];
    for (k, &i) in missing.iter().enumerate() {
        number[i] = k;
    }
    // Up, down, left, right.
    let weights = [aspect.recip(), aspect.recip(), aspect, aspect];
    let neighbours = |i: usize| {
        let (row, column) = (i / cells.columns, i % cells.columns);
        [
            (row > 0).then(|| i - cells.columns),
            (row + 1 < cells.rows).then(|| i + cells.columns),
            (column > 0).then(|| i - 1),
            (column + 1 < cells.columns).then(|| i + 1),
        ]
    };
    let inner: Vec<[usize; 4]> =
        missing.iter().map(|&i| neighbours(i).map(|j| j.map_or(measured, |j| number[j]))).collect();
    // Heights about the middle of the measured ones and in units of half their range, so that nothing
    // overflows.
    let (low, high) = heights
        .iter()
        .filter(|h| !h.is_nan())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &h| (a.min(h), b.max(h)));
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    let unit = if half > 0.0 { half } else { 1.0 };
    let weight = |(j, w): (&Option<usize>, &f64)| if j.is_some() { *w } else { 0.0 };
    let degree: Vec<f64> =
        missing.iter().map(|&i| neighbours(i).iter().zip(&weights).map(weight).sum()).collect();
    let apply = |x: &[f64], y: &mut [f64]| {
        for (k, around) in inner.iter().enumerate() {
            y[k] = degree[k] * x[k] - around.iter().zip(weights).map(|(&j, w)| w * x[j]).sum::<f64>();
        }
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let rim = |i: usize| {
        let around = neighbours(i).into_iter().zip(weights).filter_map(|(j, w)| Some((j?, w)));
        let rim = around.filter(|&(j, _)| number[j] == measured);
        rim.map(|(j, w)| w * ((heights[j] - middle) / unit)).sum::<f64>()
    };
    let mut x = vec![0.0; missing.len()];
    let mut residual: Vec<f64> = missing.iter().map(|&i| rim(i)).collect();
    // Preconditioned by the sum of the weights.
    let preconditioned = |r: &[f64]| r.iter().zip(&degree).map(|(r, d)| r / d).collect::<Vec<f64>>();
    let mut z = preconditioned(&residual);
    let mut direction = z.clone();
    direction.push(0.0);
    let mut image = vec![0.0; missing.len()];
    let mut energy = dot(&residual, &z);
    let first = energy;
    for _ in 0..=missing.len() {
        if energy <= TOLERANCE * TOLERANCE * first {
            break;
        }
        apply(&direction, &mut image);
        let step = energy / dot(&direction, &image);
        for k in 0..x.len() {
            x[k] += step * direction[k];
            residual[k] -= step * image[k];
        }
        z = preconditioned(&residual);
        let next = dot(&residual, &z);
        let share = next / energy;
        for (d, z) in direction.iter_mut().zip(&z) {
            *d = z + share * *d;
        }
        energy = next;
    }
    for (k, &i) in missing.iter().enumerate() {
        // The harmonic function lies between the ends of the range; rounding may not.
        heights[i] = (middle + unit * x[k]).clamp(low, high);
    }
}
