//! The influence matrix by direct summation: exact, O(n m), obviously right.

use super::influence::InfluenceOperator;
use crate::geometry::CellSet;
use crate::kernel::KernelTable;
use crate::real::Real;

/// The reference implementation of every faster operator, and the fastest one itself for a few hundred cells.
#[derive(Debug)]
pub struct DirectSum<'a>(pub &'a KernelTable);

impl<T: Real> InfluenceOperator<T> for DirectSum<'_> {
    /// `u_i = sum_j I(i - j) p_j`. Cost: O(sources x targets).
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        u.fill(T::default());
        for source in sources.rows() {
            let pressure = &p[source.span()];
            for target in targets.rows() {
                let line = self.0.row(source.y.abs_diff(target.y));
                for (&x, u) in target.columns.iter().zip(&mut u[target.span()]) {
                    let pairs = source.columns.iter().zip(pressure);
                    let sum: f64 = pairs.map(|(&xs, p)| line[x.abs_diff(xs) as usize] * p.to_f64()).sum();
                    *u += T::of(sum);
                }
            }
        }
    }
}
