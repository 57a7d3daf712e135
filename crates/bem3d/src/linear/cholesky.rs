//! Small sets: the influence matrix itself and its Cholesky factor. Pressure and stiffness come from one factor.

use crate::geometry::CellSet;
use crate::kernel::KernelTable;
use faer::linalg::solvers::{Llt, Solve};
use faer::{Mat, Side};

/// The factor of G on one set.
#[derive(Debug)]
pub struct Factor {
    factor: Llt<f64>,
}

impl Factor {
    /// Assembles and factors G on a set of n cells; `None` if rounding makes it indefinite (never seen).
    ///
    /// Cost: n^3 / 3 multiplications and 16 n^2 bytes.
    pub fn new(table: &KernelTable, set: &CellSet) -> Option<Self> {
        let places: Vec<(usize, usize)> = set.places().collect();
        let matrix = Mat::from_fn(set.len(), set.len(), |i, j| {
            let ((xi, yi), (xj, yj)) = (places[i], places[j]);
            table.row(yi.abs_diff(yj))[xi.abs_diff(xj)]
        });
        Llt::new(matrix.as_ref(), Side::Lower).ok().map(|factor| Self { factor })
    }

    /// Solves `G q = 1` and `G w = z`.
    pub fn solve_pair(&self, z: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let right = Mat::from_fn(z.len(), 2, |i, j| if j == 0 { 1.0 } else { z[i] });
        let solution = self.factor.solve(&right);
        let column = |j: usize| (0..z.len()).map(|i| solution[(i, j)]).collect();
        (column(0), column(1))
    }
}
