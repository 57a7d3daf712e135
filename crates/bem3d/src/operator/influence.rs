//! What every way to apply the influence matrix has in common.

use crate::geometry::CellSet;

/// Elastic displacement under a pressure, `u = G p` in nondimensional form (`u_i = sum_j I(i - j) p_j`).
pub trait InfluenceOperator<T> {
    /// `p` on the cells of `sources` gives `u` on those of `targets`, whatever `u` held.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]);
}
