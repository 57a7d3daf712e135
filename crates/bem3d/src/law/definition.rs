//! The definition of a convex law of a cell.

/// The tractions of N components that the cells of a set may have: a convex set for each cell.
///
/// With a velocity `v`, which is minus the gradient of the energy (minus the gap, or the slip), the conditions of
/// contact say that v lies in the normal cone of the set of its cell: no admissible traction has more work with v
/// than the present one. Vectors of a field hold the first component of all cells, then the next one.
pub trait ConvexLaw<const N: usize> {
    /// The nearest admissible traction of cell i.
    fn nearest(&self, i: usize, t: [f64; N]) -> [f64; N];

    /// Moves a field to the nearest admissible one or, with a prescribed `force`, to the nearest one of this sum.
    fn project(&self, t: &mut [f64], force: Option<[f64; N]>);

    /// `None` for a cell that may change in any direction. For one at a bound, the square of the part of a
    /// velocity that it may follow.
    fn held(&self, i: usize, t: [f64; N], v: [f64; N]) -> Option<f64>;

    /// The largest multiple of a change that can be added to the traction of cell i.
    fn room(&self, i: usize, t: [f64; N], change: [f64; N]) -> f64;

    /// Puts tractions that a change brought to a bound, up to rounding, exactly there.
    fn meet(&self, t: &mut [f64], change: &[f64]);

    /// The part of cell i in the duality gap: the work that the best admissible traction has with v beyond that
    /// of the present one. Zero exactly where the conditions of contact hold.
    fn excess(&self, i: usize, t: [f64; N], v: [f64; N]) -> f64;
}
