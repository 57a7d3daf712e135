//! The direct solver of small sets: the influence matrix and its Cholesky factor, from which both pressure
//! and stiffness are computed.

use crate::geometry::CellSet;
use crate::kernel::NormalTable;
#[cfg(feature = "faer")]
use faer::{Mat, Side, linalg::solvers::Llt, linalg::solvers::Solve};

/// Without the feature `faer` there is no factor, and every set is solved by iteration.
#[cfg(not(feature = "faer"))]
#[derive(Debug)]
pub enum Factor {}

#[cfg(not(feature = "faer"))]
impl Factor {
    pub fn new(_: &NormalTable, _: &CellSet) -> Option<Self> {
        None
    }

    pub fn solve_pair(&self, _: &[f64]) -> (Vec<f64>, Vec<f64>) {
        match *self {}
    }
}

/// The factor of G on one set.
#[cfg(feature = "faer")]
#[derive(Debug)]
pub struct Factor {
    factor: Llt<f64>,
}

#[cfg(feature = "faer")]
impl Factor {
    /// Assembles and factors G on a set of n cells; `None` if rounding makes it indefinite (never seen).
    ///
    /// Cost: n^3 / 3 multiplications and 16 n^2 bytes.
    pub fn new(table: &NormalTable, set: &CellSet) -> Option<Self> {
        let places: Vec<(usize, usize)> = set.places().collect();
        let matrix = Mat::from_fn(set.len(), set.len(), |i, j| {
            let ((xi, yi), (xj, yj)) = (places[i], places[j]);
            let [value] = table.lag(xi.abs_diff(xj), yi.abs_diff(yj));
            value
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

#[cfg(all(test, feature = "faer"))]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::operator::{DirectSum, InfluenceOperator};
    use approx::assert_relative_eq;
    use contact_model::Boundary;

    #[test]
    fn the_factor_inverts_the_direct_sum() {
        let square = Grid::square(12, 12);
        for (grid, boundary) in [
            (square, Boundary::Free),
            (square, Boundary::Periodic),
            (Grid { columns: 9, rows: 14, stretch: 1.3 }, Boundary::Free),
            (Grid { columns: 1, rows: 20, stretch: 1.0 }, Boundary::Periodic),
        ] {
            let table = NormalTable::shared(grid, boundary);
            let picks = [true, false, true, true, false, true, false];
            let cells = CellSet::numbered(grid, |i| picks[i % picks.len()]);
            let z: Vec<f64> = (0..cells.len()).map(|k| 1.0 + (k as f64 * 0.7).sin()).collect();
            let (q, w) = Factor::new(&table, &cells).unwrap().solve_pair(&z);
            let mut back = vec![0.0; z.len()];
            DirectSum(&table).apply(&cells, &q, &cells, &mut back);
            for b in &back {
                assert_relative_eq!(*b, 1.0, max_relative = 1e-13);
            }
            DirectSum(&table).apply(&cells, &w, &cells, &mut back);
            for (b, z) in back.iter().zip(&z) {
                assert_relative_eq!(b, z, epsilon = 1e-13, max_relative = 1e-13);
            }
        }
    }
}
