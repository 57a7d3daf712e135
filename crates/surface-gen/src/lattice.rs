//! The wave vectors of a rectangular grid.

use contact_model::{Cells, Size};

/// Fewest cells along an axis that carries waves: with 2 there is only the Nyquist wave.
pub(crate) const FEWEST: usize = 3;

/// Wave vectors `q = 2 pi (mx/Lx, my/Ly)` of a grid, in units of `q_0 = 2 pi / L`, `L = sqrt(Lx Ly)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Lattice {
    /// `(L/Lx)^2 = Ly/Lx` and `(L/Ly)^2 = Lx/Ly`: exactly 1 for a square, so that its `|q|^2` are integers.
    weights: [f64; 2],
    /// See [`Lattice::limit`].
    limit: f64,
    /// See [`Lattice::longest`].
    longest: f64,
}

impl Lattice {
    pub(crate) fn new(cells: Cells, size: Size) -> Self {
        let (length, sides) = (size.length(), [size.x, size.y]);
        let counts = [cells.columns, cells.rows];
        let none = counts.iter().all(|&count| count < FEWEST);
        let (mut limit, mut longest) = (f64::INFINITY, 0.0_f64);
        for (count, side) in counts.into_iter().zip(sides) {
            if none || count >= FEWEST {
                limit = limit.min(0.5 * (count as f64 * (length / side)));
                longest = longest.max(side);
            }
        }
        Self { weights: [size.y / size.x, size.x / size.y], limit, longest }
    }

    /// `|q|^2` of the wave (mx, my); an exact integer for a square.
    #[inline]
    pub(crate) fn square(&self, mx: u64, my: u64) -> f64 {
        (mx * mx) as f64 * self.weights[0] + (my * my) as f64 * self.weights[1]
    }

    /// Largest |q| that the grid has in all directions, `pi / max(dx, dy)`; an axis of fewer than 3 cells
    /// carries no wave and does not count, unless neither does.
    pub(crate) fn limit(&self) -> f64 {
        self.limit
    }

    /// The longest side, a length, among the axes that count.
    pub(crate) fn longest(&self) -> f64 {
        self.longest
    }
}
