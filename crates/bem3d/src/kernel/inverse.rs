//! The inverse of the kernel on an infinite lattice, near a cell.

use super::love::influence_of_rectangle;
use super::symbol::Symbol;
use crate::geometry::{Grid, Lengths};

/// Cells along a side of the torus that approximates the lattice.
const TORUS: usize = 64;

/// The pressures, on a cell and on those around it, that displace that cell alone.
///
/// The kernel's inverse falls as `1/r^3`; only the cell's own value is positive.
#[derive(Debug, Clone)]
pub struct Inverse {
    /// The pressure of the cell itself, over its displacement.
    pub own: f64,
    /// Largest distance in columns and in rows.
    pub reach: (usize, usize),
    /// Pressures of all cells of each row, the cell itself in the middle of the middle one.
    pub rows: Vec<Vec<f64>>,
}

impl Inverse {
    /// The inverse on the cells within the distance `farthest`, in sides of a square cell.
    ///
    /// Cost: two transforms of 4096 points.
    pub fn within(grid: Grid, farthest: f64) -> Self {
        let lengths = Lengths { x: TORUS, y: TORUS };
        let half = TORUS / 2 + 1;
        let symbol = Symbol::of_kernel(lengths, |x, y| influence_of_rectangle(x, y, grid.stretch));
        let inverse = Symbol::of_kernel(lengths, |x, y| 1.0 / symbol.values[x * half + y]);
        let at = |x: usize, y: usize| inverse.values[x * half + y] / lengths.points() as f64;
        let (dx, dy) = grid.cell();
        let cells = |distance: f64, side: f64| ((distance / side) as usize).min(TORUS / 2);
        let top = cells(farthest, dy);
        let row = |y: usize| {
            let half = cells((farthest.powi(2) - (y as f64 * dy).powi(2)).max(0.0).sqrt(), dx);
            (0..=2 * half).map(|x| at(x.abs_diff(half), y)).collect()
        };
        Self {
            own: at(0, 0),
            reach: (cells(farthest, dx), top),
            rows: (0..=2 * top).map(|y| row(y.abs_diff(top))).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_inverse_undoes_the_kernel_and_only_its_own_value_is_positive() {
        for stretch in [1.0, 1.4, 0.6] {
            let grid = Grid { columns: 9, rows: 9, stretch };
            let inverse = Inverse::within(grid, 14.0);
            let (_, top) = inverse.reach;
            // Of a pressure on cell (x, y): the displacement, and the pressure at the origin that it takes.
            for (x, y, expected) in [(0usize, 0usize, 1.0), (1, 0, 0.0), (2, 1, 0.0), (0, 3, 0.0)] {
                let mut found = 0.0;
                for (row, weights) in inverse.rows.iter().enumerate() {
                    let half = weights.len() / 2;
                    for (column, &weight) in weights.iter().enumerate() {
                        let own = (row, column) == (top, half);
                        assert!((weight > 0.0) == own && (!own || (weight - inverse.own).abs() <= 0.0));
                        let lag = ((column + x).abs_diff(half), (row + y).abs_diff(top));
                        found += weight * influence_of_rectangle(lag.0, lag.1, stretch);
                    }
                }
                // What lies further away is left out.
                assert!((found - expected).abs() < 0.02, "{stretch} {x} {y} {found}");
            }
        }
    }
}
