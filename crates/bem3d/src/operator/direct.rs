//! The elastic operator by direct summation: exact, O(n m), obviously right.

use super::Table;
use crate::cells::CellSet;

/// `u_i = sum_j I(i - j) p_j` for the cells `i` of `targets`, by summing over the cells `j` of `sources`.
///
/// Shape: `p` on `sources`, `u` on `targets`; dimensionless (see [`crate::love::influence`]). Cost: O(sources x targets).
/// The twin of every faster operator, and the fastest one itself for a few hundred cells.
pub fn apply(table: &Table, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut [f64]) {
    u.fill(0.0);
    let side = sources.side();
    for source_row in sources.rows() {
        for target_row in targets.rows() {
            let line = table.row(source_row.y.abs_diff(target_row.y));
            for i in target_row.span.clone() {
                let x = targets.index()[i] as usize - target_row.y * side;
                let mut sum = 0.0;
                for j in source_row.span.clone() {
                    let xs = sources.index()[j] as usize - source_row.y * side;
                    sum += line[x.abs_diff(xs)] * p[j];
                }
                u[i] += sum;
            }
        }
    }
}
