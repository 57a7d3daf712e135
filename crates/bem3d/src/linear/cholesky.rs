//! The direct solver of small sets: the influence matrix and its Cholesky factor, from which both pressure
//! and stiffness are computed.

use crate::geometry::CellSet;
use crate::kernel::NormalTable;
#[cfg(feature = "faer")]
use contact_model::never;
use contact_model::{Interrupted, Stop};
#[cfg(feature = "faer")]
use faer::dyn_stack::{MemBuffer, MemStack};
#[cfg(feature = "faer")]
use faer::linalg::cholesky::llt;
#[cfg(feature = "faer")]
use faer::linalg::matmul::triangular::{self, BlockStructure};
#[cfg(feature = "faer")]
use faer::linalg::triangular_solve::solve_lower_triangular_in_place;
#[cfg(feature = "faer")]
use faer::{Accum, Conj, Mat, MatMut, Spec, get_global_parallelism};

/// Without the feature `faer` there is no factor, and every set is solved by iteration.
#[cfg(not(feature = "faer"))]
#[derive(Debug)]
pub enum Factor {}

#[cfg(not(feature = "faer"))]
impl Factor {
    pub fn new(_: &NormalTable, _: &CellSet) -> Option<Self> {
        None
    }

    #[allow(clippy::unnecessary_wraps)] // The signature is that of the factor with `faer`.
    pub fn until(_: &NormalTable, _: &CellSet, _: Stop<'_>) -> Result<Option<Self>, Interrupted> {
        Ok(None)
    }

    pub fn solve_pair(&self, _: &[f64]) -> (Vec<f64>, Vec<f64>) {
        match *self {}
    }
}

#[cfg(feature = "faer")]
/// Columns that are factored between two questions to the stop: the blocks of `faer`, so that no bit differs from
/// its factor. Of 6000 cells, the most that are factored, a block takes a seventh of a second.
const BLOCK: usize = 128;

#[cfg(feature = "faer")]
/// Up to this size `faer` factors a matrix without blocks.
const WITHOUT_BLOCKS: usize = 64;

/// The factor of G on one set.
#[cfg(feature = "faer")]
#[derive(Debug)]
pub struct Factor {
    /// The lower triangle L of `G = L L^T`; what stands above it is not used.
    lower: Mat<f64>,
}

#[cfg(feature = "faer")]
impl Factor {
    /// Assembles and factors G on a set of n cells; `None` if rounding makes it indefinite (never seen).
    ///
    /// Cost: n^3 / 3 multiplications and 8 n^2 bytes.
    pub fn new(table: &NormalTable, set: &CellSet) -> Option<Self> {
        Self::until(table, set, &never).ok().flatten()
    }

    /// As [`Factor::new`], unless the stop ends it, which is asked between blocks of columns.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn until(table: &NormalTable, set: &CellSet, stop: Stop<'_>) -> Result<Option<Self>, Interrupted> {
        let places: Vec<(usize, usize)> = set.places().collect();
        let mut lower = Mat::zeros(set.len(), set.len());
        for (j, &(xj, yj)) in places.iter().enumerate() {
            if j % BLOCK == 0 && stop.stops() {
                return Err(Interrupted);
            }
            for (i, &(xi, yi)) in places.iter().enumerate().skip(j) {
                let [value] = table.lag(xi.abs_diff(xj), yi.abs_diff(yj));
                lower[(i, j)] = value;
            }
        }
        Ok(factor(lower.as_mut(), stop)?.then_some(Self { lower }))
    }

    /// Solves `G q = 1` and `G w = z`.
    pub fn solve_pair(&self, z: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let right = Mat::from_fn(z.len(), 2, |i, j| if j == 0 { 1.0 } else { z[i] });
        let (mut solution, parallelism) = (right, get_global_parallelism());
        // It takes no room of its own.
        let stack = MemStack::new(&mut []);
        llt::solve::solve_in_place_with_conj(
            self.lower.as_ref(),
            Conj::No,
            solution.as_mut(),
            parallelism,
            stack,
        );
        let column = |j: usize| (0..z.len()).map(|i| solution[(i, j)]).collect();
        (column(0), column(1))
    }
}

/// Replaces the lower triangle of a matrix by that of its factor, block after block as `faer::linalg::solvers::Llt`
/// does, which would not ask the stop. Returns whether the matrix is positive definite.
///
/// # Errors
/// [`Interrupted`] by the stop.
#[cfg(feature = "faer")]
fn factor(mut matrix: MatMut<'_, f64>, stop: Stop<'_>) -> Result<bool, Interrupted> {
    let (n, parallelism) = (matrix.nrows(), get_global_parallelism());
    let largest = if n <= WITHOUT_BLOCKS { n.max(1) } else { BLOCK.min(n.next_power_of_two() / 2) };
    let room = llt::factor::cholesky_in_place_scratch::<f64>(largest, parallelism, Spec::default());
    let mut room = MemBuffer::new(room);
    let mut begin = 0;
    while begin < n {
        if stop.stops() {
            return Err(Interrupted);
        }
        let block = largest.min(n - begin);
        let rest = matrix.as_mut().get_mut(begin.., begin..);
        let (mut diagonal, _, mut below, mut right) = rest.split_at_mut(block, block);
        let (none, stack) = (llt::factor::LltRegularization::default(), MemStack::new(&mut room));
        let settings = Spec::default();
        if llt::factor::cholesky_in_place(diagonal.as_mut(), none, parallelism, stack, settings).is_err() {
            return Ok(false);
        }
        solve_lower_triangular_in_place(diagonal.as_ref(), below.as_mut().transpose_mut(), parallelism);
        triangular::matmul(
            right.as_mut(),
            BlockStructure::TriangularLower,
            Accum::Add,
            below.as_ref(),
            BlockStructure::Rectangular,
            below.as_ref().transpose(),
            BlockStructure::Rectangular,
            -1.0,
            parallelism,
        );
        begin += block;
    }
    Ok(true)
}

#[cfg(all(test, feature = "faer"))]
mod tests {
    use super::*;
    use faer::Side;
    use faer::linalg::solvers::{Llt, Solve as _};
    use std::cell::Cell;

    /// The factor and its solutions are those of `faer`, to the last bit, for all sizes about those of its blocks.
    #[test]
    fn blocks_are_those_of_the_library() {
        let grid = Grid::square(40, 40);
        let table = NormalTable::shared(grid, Boundary::Free);
        for n in [1, 2, 7, 63, 64, 65, 100, 127, 128, 129, 150, 191, 192, 255, 256, 257, 320, 385, 517, 800] {
            let index: Vec<u32> = (0..n).map(|k| 2 * k).collect();
            let set = CellSet::from_index(grid, &index);
            let places: Vec<(usize, usize)> = set.places().collect();
            let matrix = Mat::from_fn(set.len(), set.len(), |i, j| {
                let ((xi, yi), (xj, yj)) = (places[i], places[j]);
                let [value] = table.lag(xi.abs_diff(xj), yi.abs_diff(yj));
                value
            });
            let library = Llt::new(matrix.as_ref(), Side::Lower).unwrap();
            let mine = Factor::new(&table, &set).unwrap();
            for j in 0..set.len() {
                for i in j..set.len() {
                    assert_eq!(mine.lower[(i, j)].to_bits(), library.L()[(i, j)].to_bits(), "{n}: {i}, {j}");
                }
            }
            let z: Vec<f64> = (0..set.len()).map(|k| 1.0 + (k as f64 * 0.7).sin()).collect();
            let right = Mat::from_fn(z.len(), 2, |i, j| if j == 0 { 1.0 } else { z[i] });
            let expected = library.solve(&right);
            let (q, w) = mine.solve_pair(&z);
            for i in 0..set.len() {
                assert_eq!(q[i].to_bits(), expected[(i, 0)].to_bits());
                assert_eq!(w[i].to_bits(), expected[(i, 1)].to_bits());
            }
        }
    }

    /// The stop is asked before each block, and ends the factor there.
    #[test]
    fn a_stop_is_heard_between_blocks() {
        let grid = Grid::square(30, 30);
        let (table, set) = (NormalTable::shared(grid, Boundary::Free), CellSet::all(grid));
        let asked = Cell::new(0);
        let count = || {
            asked.set(asked.get() + 1);
            false
        };
        assert!(Factor::until(&table, &set, &count).unwrap().is_some());
        // Blocks of 128 columns of 900, assembled and factored.
        assert_eq!(asked.get(), 2 * 8);
        for heard in 1..=asked.get() {
            let left = Cell::new(heard);
            let stop = || {
                left.set(left.get() - 1);
                left.get() == 0
            };
            assert!(matches!(Factor::until(&table, &set, &stop), Err(Interrupted)), "{heard}");
        }
    }

    #[test]
    fn an_indefinite_matrix_has_no_factor() {
        let mut matrix = Mat::from_fn(200, 200, |i, j| if i == j { 1.0 } else { 0.0 });
        matrix[(170, 170)] = -1.0;
        assert_eq!(factor(matrix.as_mut(), &never), Ok(false));
    }

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
