//! The influence matrix by direct summation: exact and simple, O(n m).

use super::influence::InfluenceOperator;
use crate::geometry::CellSet;
use crate::kernel::{KernelTable, Symmetric, Tensor};
use crate::real::Real;
use contact_model::{Interrupted, Stop};

/// The reference implementation of every faster operator, and the fastest one itself for a few hundred cells: the
/// kernel of a symmetric matrix with N rows and E entries.
#[derive(Debug)]
pub struct DirectSum<'a, const N: usize, const E: usize>(pub &'a KernelTable<E>);

impl<T: Real, const N: usize, const E: usize> InfluenceOperator<T> for DirectSum<'_, N, E>
where
    [f64; E]: Symmetric<f64, N>,
{
    /// `u_i = sum_j K(i - j) t_j`. Cost: O(sources x targets).
    fn apply_until(
        &mut self,
        sources: &CellSet,
        t: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        // What the rows are made from is made before threads ask for them.
        let _ = self.0.shift();
        let n = sources.len();
        for (i, u) in u.chunks_exact_mut(targets.len().max(1)).enumerate() {
            targets.update_until(n * targets.len(), u, stop, |target, u| {
                let u = &mut u[target.span()];
                u.fill(T::default());
                for source in sources.rows() {
                    let line = self.0.row(source.y.abs_diff(target.y));
                    let count = source.columns.len();
                    let tractions: [&[T]; N] =
                        std::array::from_fn(|j| &t[j * n + source.span().start..][..count]);
                    for (&x, u) in target.columns.iter().zip(&mut *u) {
                        let mut sum = 0.0;
                        for (k, &xs) in source.columns.iter().enumerate() {
                            let entries = line[x.abs_diff(xs) as usize];
                            let mirrored = (x < xs) != (target.y < source.y);
                            let entries = if mirrored { entries.mirrored() } else { entries };
                            let row = entries.row(i);
                            for (entry, traction) in row.into_iter().zip(tractions) {
                                sum += entry * traction[k].to_f64();
                            }
                        }
                        *u += T::of(sum);
                    }
                }
            })?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::kernel::NormalTable;
    use crate::kernel::love::influence_of_rectangle;
    use approx::assert_relative_eq;
    use contact_model::Boundary;

    #[test]
    fn a_sum_over_pairs_by_hand() {
        // Cells (0, 0) and (4, 2) act on (4, 2) and (1, 1).
        let grid = Grid { columns: 5, rows: 3, stretch: 1.3 };
        let sources = CellSet::from_index(grid, &[0, 14]);
        let targets = CellSet::from_index(grid, &[6, 14]);
        let influence = |x, y| influence_of_rectangle(x, y, 1.3);
        let mut u = [9.0; 2];
        let sum = |boundary, u: &mut [f64]| {
            DirectSum(&NormalTable::shared(grid, boundary)).apply(&sources, &[2.0, -1.0], &targets, u);
        };
        sum(Boundary::Free, &mut u);
        assert_relative_eq!(u[0], 2.0 * influence(1, 1) - influence(3, 1), max_relative = 1e-14);
        assert_relative_eq!(u[1], 2.0 * influence(4, 2) - influence(0, 0), max_relative = 1e-14);
        // A lag of four in a period of five is one the other way round.
        sum(Boundary::Periodic, &mut u);
        let kernel = NormalTable::shared(grid, Boundary::Periodic);
        assert_relative_eq!(u[1], 2.0 * kernel.lag(1, 1)[0] - kernel.lag(0, 0)[0], max_relative = 1e-14);
        // In single precision only the result is rounded.
        let mut single = [0.0f32; 2];
        DirectSum(&kernel).apply(&sources, &[2.0f32, -1.0], &targets, &mut single);
        assert_relative_eq!(f64::from(single[1]), u[1], max_relative = 1e-6);
    }
}
