//! The common interface of the operators that apply the influence matrix.

use crate::geometry::CellSet;
use contact_model::{Interrupted, Stop, never};

/// Elastic displacement under a pressure, `u = G p` in nondimensional form (`u_i = sum_j I(i - j) p_j`).
pub trait InfluenceOperator<T> {
    /// Computes `u` on the cells of `targets` from `p` on those of `sources`; the old values of `u` are
    /// ignored.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between rows; `u` is then undefined.
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted>;

    /// The same to its end.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        let _ = self.apply_until(sources, p, targets, u, &never);
    }
}
