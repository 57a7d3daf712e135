//! Least-squares polynomials in x and y.

use crate::error::ContentError;
use contact_model::Cells;

/// What is subtracted from the heights.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Detrend {
    /// Nothing.
    #[default]
    Nothing,
    /// The mean height.
    Mean,
    /// The plane `a + b x + c y` of least squares: a tilted specimen.
    Plane,
    /// `a + b x + c y + d x^2 + e x y + f y^2` of least squares: a curved one.
    Quadric,
}

/// Most unknowns.
const MOST: usize = 6;

/// A pivot of the scaled normal matrix below this is 0: the squares of coordinates that are one line to 1e-5
/// of their range.
const SINGULAR: f64 = 1e-10;

/// Coefficients of Legendre's polynomials in coordinates that run from -1 to 1 along each side.
#[derive(Debug)]
pub(super) struct Trend {
    unknowns: usize,
    coefficients: [f64; MOST],
    /// What the coefficients are multiplied by.
    unit: f64,
    middle: f64,
}

impl Detrend {
    fn unknowns(self) -> usize {
        match self {
            Self::Nothing => 0,
            Self::Mean => 1,
            Self::Plane => 3,
            Self::Quadric => 6,
        }
    }

    /// Fits the heights that are not NaN; `None` for nothing to subtract.
    pub(super) fn fit(self, cells: Cells, heights: &[f64]) -> Result<Option<Trend>, ContentError> {
        let unknowns = self.unknowns();
        if unknowns == 0 {
            return Ok(None);
        }
        let measured = || heights.iter().enumerate().filter(|(_, h)| !h.is_nan());
        let (low, high) =
            measured().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), (_, &h)| (a.min(h), b.max(h)));
        // About the middle of the range and in units of half of it: nothing overflows, and an offset costs
        // its own rounding only.
        let (middle, half) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
        let unit = if half > 0.0 { half } else { 1.0 };
        let mut matrix = [[0.0; MOST]; MOST];
        let mut right = [0.0; MOST];
        let mut present = 0;
        for (row, heights) in heights.chunks_exact(cells.columns).enumerate() {
            // Row by row: sums of sums lose fewer digits than one long sum.
            let mut row_matrix = [[0.0; MOST]; MOST];
            let mut row_right = [0.0; MOST];
            for (column, &h) in heights.iter().enumerate() {
                if h.is_nan() {
                    continue;
                }
                present += 1;
                let basis = basis(row, column, cells);
                for i in 0..unknowns {
                    row_right[i] += basis[i] * ((h - middle) / unit);
                    for j in 0..=i {
                        row_matrix[i][j] += basis[i] * basis[j];
                    }
                }
            }
            for i in 0..unknowns {
                right[i] += row_right[i];
                for j in 0..=i {
                    matrix[i][j] += row_matrix[i][j];
                }
            }
        }
        let coefficients =
            solve(&mut matrix, right, unknowns).ok_or(ContentError::Trend { present, unknowns })?;
        Ok(Some(Trend { unknowns, coefficients, unit, middle }))
    }
}

impl Trend {
    fn at(&self, i: usize, cells: Cells) -> f64 {
        let basis = basis(i / cells.columns, i % cells.columns, cells);
        (0..self.unknowns).map(|i| self.coefficients[i] * basis[i]).sum()
    }

    pub(super) fn subtract(&self, cells: Cells, heights: &mut [f64]) {
        for (i, h) in heights.iter_mut().enumerate() {
            *h = (*h - self.middle) - self.unit * self.at(i, cells);
        }
    }

    /// Puts its own heights at the undefined points.
    pub(super) fn fill(&self, cells: Cells, heights: &mut [f64]) {
        for (i, h) in heights.iter_mut().enumerate().filter(|(_, h)| h.is_nan()) {
            *h = self.middle + self.unit * self.at(i, cells);
        }
    }
}

/// 1, x, y and the three products of second order, nearly orthogonal over the whole rectangle.
fn basis(row: usize, column: usize, cells: Cells) -> [f64; MOST] {
    let to_unit = |i: usize, count: usize| (2.0 * i as f64 + 1.0) / count as f64 - 1.0;
    let (x, y) = (to_unit(column, cells.columns), to_unit(row, cells.rows));
    [1.0, x, y, 1.5 * x * x - 0.5, x * y, 1.5 * y * y - 0.5]
}

/// Cholesky's factorisation of the scaled matrix, of which the lower triangle is given; `None` where it is
/// singular.
fn solve(matrix: &mut [[f64; MOST]; MOST], mut right: [f64; MOST], n: usize) -> Option<[f64; MOST]> {
    let mut scale = [0.0; MOST];
    for i in 0..n {
        if matrix[i][i] <= 0.0 {
            return None;
        }
        scale[i] = matrix[i][i].sqrt().recip();
    }
    for i in 0..n {
        right[i] *= scale[i];
        for j in 0..=i {
            let known: f64 = matrix[i][..j].iter().zip(&matrix[j][..j]).map(|(a, b)| a * b).sum();
            let sum = matrix[i][j] * scale[i] * scale[j] - known;
            if i > j {
                matrix[i][j] = sum / matrix[j][j];
            } else if sum > SINGULAR {
                matrix[i][i] = sum.sqrt();
            } else {
                return None;
            }
        }
    }
    for i in 0..n {
        for k in 0..i {
            right[i] -= matrix[i][k] * right[k];
        }
        right[i] /= matrix[i][i];
    }
    for i in (0..n).rev() {
        for k in i + 1..n {
            right[i] -= matrix[k][i] * right[k];
        }
        right[i] /= matrix[i][i];
    }
    for i in 0..n {
        right[i] *= scale[i];
    }
    Some(right)
}
