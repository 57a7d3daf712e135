//! The common interface of the operators that apply the influence matrix.

use crate::geometry::CellSet;

/// Elastic displacement under a pressure, `u = G p` in nondimensional form (`u_i = sum_j I(i - j) p_j`).
pub trait InfluenceOperator<T> {
    /// Computes `u` on the cells of `targets` from `p` on those of `sources`; the old values of `u` are
    /// ignored.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]);
}
