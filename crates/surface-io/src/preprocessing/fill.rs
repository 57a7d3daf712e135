//! Undefined points filled by the discrete harmonic function with the measured rim.

use contact_model::{Cells, HeightMap, Result};

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
    let patches = UndefinedPatches::new(cells, aspect, heights);
    // Heights about the middle of the measured ones and in units of half their range, so that nothing
    // overflows.
    let (low, high) = heights
        .iter()
        .filter(|h| !h.is_nan())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &h| (a.min(h), b.max(h)));
    let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    let unit = if half > 0.0 { half } else { 1.0 };
    let filled = patches.solve(patches.inflow(|j| (heights[j] - middle) / unit));
    for (&i, x) in patches.missing.iter().zip(filled) {
        // The harmonic function lies between the ends of the range; rounding may not.
        heights[i] = (middle + unit * x).clamp(low, high);
    }
}

/// A map whose undefined points have the heights of [`crate::Fill::Neighbours`]: the discrete harmonic function
/// with the measured rim. The map stays as it is where all points are defined.
///
/// # Errors
/// [`contact_model::Error::Domain`] where a height is not finite, which no map has.
///
/// ```
/// use contact_model::HeightMap;
/// let map = HeightMap::with_undefined([3, 1], [3.0, 1.0], vec![1.0, f64::NAN, 2.0])?;
/// assert_eq!(surface_io::filled(&map)?.heights(), [1.0, 1.5, 2.0]);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn filled(map: &HeightMap) -> Result<HeightMap> {
    if map.undefined() == 0 {
        return Ok(map.clone());
    }
    let defined = |h: &f64| if h.is_finite() { *h } else { f64::NAN };
    let mut heights: Vec<f64> = map.heights().iter().map(defined).collect();
    harmonic(map.cells(), map.dy() / map.dx(), &mut heights);
    HeightMap::new(map.cells(), map.size(), heights)
}

/// The graph of the missing cells.
struct UndefinedPatches {
    cells: Cells,
    /// Weights of the neighbours above, below, to the left and to the right.
    weights: [f64; 4],
    /// Places of the missing cells.
    missing: Vec<usize>,
    /// The number of each cell among the missing ones. What is measured has the number behind the last: a
    /// place of the vectors that stays 0.
    number: Vec<usize>,
    /// Numbers of the neighbours of each missing cell.
    inner: Vec<[usize; 4]>,
    /// Sum of the weights of the neighbours of each missing cell.
    degree: Vec<f64>,
}

impl UndefinedPatches {
    fn new(cells: Cells, aspect: f64, heights: &[f64]) -> Self {
        let missing: Vec<usize> = (0..heights.len()).filter(|&i| heights[i].is_nan()).collect();
        let measured = missing.len();
        let mut number = vec![measured; heights.len()];
        for (k, &i) in missing.iter().enumerate() {
            number[i] = k;
        }
        let weights = [aspect.recip(), aspect.recip(), aspect, aspect];
        let around = missing.iter().map(|&i| neighbours(cells, i));
        let inner = around.clone().map(|around| around.map(|j| j.map_or(measured, |j| number[j]))).collect();
        let weight = |(j, w): (&Option<usize>, &f64)| if j.is_some() { *w } else { 0.0 };
        let degree = around.map(|around| around.iter().zip(&weights).map(weight).sum()).collect();
        Self { cells, weights, missing, number, inner, degree }
    }

    /// Sums of the measured heights around each missing cell, times their weights.
    fn inflow(&self, height: impl Fn(usize) -> f64) -> Vec<f64> {
        let of_cell = |&i: &usize| {
            let around = neighbours(self.cells, i).into_iter().zip(self.weights);
            let around = around.filter_map(|(j, w)| Some((j?, w)));
            let rim = around.filter(|&(j, _)| self.number[j] == self.missing.len());
            rim.map(|(j, w)| w * height(j)).sum::<f64>()
        };
        self.missing.iter().map(of_cell).collect()
    }

    /// Applies the graph Laplacian to `x`, which has a 0 for the measured cells behind its last number.
    fn apply(&self, x: &[f64], y: &mut [f64]) {
        for (k, around) in self.inner.iter().enumerate() {
            y[k] =
                self.degree[k] * x[k] - around.iter().zip(self.weights).map(|(&j, w)| w * x[j]).sum::<f64>();
        }
    }

    /// Divides by the diagonal of the Laplacian.
    fn preconditioned(&self, residual: &[f64]) -> Vec<f64> {
        residual.iter().zip(&self.degree).map(|(r, d)| r / d).collect()
    }

    /// Heights of the missing cells for this inflow, by conjugate gradients.
    fn solve(&self, inflow: Vec<f64>) -> Vec<f64> {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut x = vec![0.0; self.missing.len()];
        let mut residual = inflow;
        let mut z = self.preconditioned(&residual);
        let mut direction = z.clone();
        direction.push(0.0);
        let mut image = vec![0.0; self.missing.len()];
        let mut energy = dot(&residual, &z);
        let first = energy;
        for _ in 0..=self.missing.len() {
            if energy <= TOLERANCE * TOLERANCE * first {
                break;
            }
            self.apply(&direction, &mut image);
            let step = energy / dot(&direction, &image);
            for k in 0..x.len() {
                x[k] += step * direction[k];
                residual[k] -= step * image[k];
            }
            z = self.preconditioned(&residual);
            let next = dot(&residual, &z);
            let share = next / energy;
            for (d, z) in direction.iter_mut().zip(&z) {
                *d = z + share * *d;
            }
            energy = next;
        }
        x
    }
}

/// The cells above, below, to the left and to the right.
fn neighbours(cells: Cells, i: usize) -> [Option<usize>; 4] {
    let (row, column) = (i / cells.columns, i % cells.columns);
    [
        (row > 0).then(|| i - cells.columns),
        (row + 1 < cells.rows).then(|| i + cells.columns),
        (column > 0).then(|| i - 1),
        (column + 1 < cells.columns).then(|| i + 1),
    ]
}
