//! Normal displacement of a half-space whose map repeats itself.
//!
//! Under a mean pressure on every copy the displacement of an infinite half-space diverges; displacements are
//! therefore measured from their mean, which gives a kernel of zero mean. That kernel is not an inverse
//! M-matrix, and cells outside `z < d` may penetrate. Adding a constant c to it changes neither the pressure
//! under a given force nor the gap, but only the reference of the plane (`d + c F`). With the constant chosen
//! here every entry is positive, so that the assumptions of the elimination and of the candidates of the free
//! kernel hold again (`tests/tests/periodic.rs` checks the results).

use super::definition::{Coefficients, Evidence, Kernel};
use super::love::smallest_eigenvalue;
use super::period::Period;
use super::symbol::Parity;
use super::waves::{Integrand, continuous_symbol, symbol};
use crate::geometry::Grid;
use contact_model::Boundary;

/// `c N` of a square of N x N square cells: above 1.61554, the depth of the kernel half a period away in both
/// directions (`(1 - sqrt 2) 4 zeta(1/2) beta(1/2)` for a point; 1.62 or less for cells).
const SHIFT: f64 = 2.0;
/// c of other rectangles over the depth of their kernel.
const SHIFT_OVER_DEPTH: f64 = 1.25;

/// The pressures for which the kernel of a map that repeats itself is exact.
///
/// Both agree for contacts that are many cells wide. Other programs take waves, so that their contacts of few cells
/// can be compared with those of waves cell by cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PeriodicKernel {
    /// Pressures that are uniform on each cell, with the displacements at the centres of cells.
    #[default]
    Cells,
    /// Pressures that are waves as long as two cells or longer: the symbol `2/(E* q)` itself. Its coefficients are
    /// negative at some lags, so that a cell may rise beside a load.
    Waves,
}

impl PeriodicKernel {
    /// All, in the order of tables.
    pub const ALL: [Self; 2] = [Self::Cells, Self::Waves];

    /// Its word in scenes and tables.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Cells => "cells",
            Self::Waves => "waves",
        }
    }
}

/// The smallest value of the continuous symbol `2 pi/|q|` on the waves of a grid: that of the shortest wave.
pub(super) fn shortest_wave(grid: Grid) -> f64 {
    let (a, b) = grid.cell();
    2.0 / (1.0 / a).hypot(1.0 / b)
}

/// A half-space under the pressures on its map and on all copies of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PeriodicHalfSpace {
    /// The grid.
    pub grid: Grid,
    /// The pressures for which the kernel is exact.
    pub exact_for: PeriodicKernel,
}

impl PeriodicHalfSpace {
    /// The kernel at the lags of one period. Exact to rounding: the displacement at cell centres under uniform
    /// pressure on cells.
    ///
    /// A constant larger than needed only loses digits of the stiffness, `1/k' = 1/k + c`.
    ///
    /// Cost: some 25 multiplications a cell and a real transform of the grid; up to 5000 a row or column more
    /// for oblong cells.
    fn period(self) -> Period<1> {
        let Self { grid, exact_for } = self;
        let waves = match exact_for {
            PeriodicKernel::Cells => symbol(grid, Integrand::Normal),
            PeriodicKernel::Waves => continuous_symbol(grid, |_| 1.0),
        };
        let period = Period::from_waves(grid, self.parities(), [waves]);
        if grid.columns == grid.rows && grid.has_square_cells() {
            return period.raised_by(SHIFT / (grid.count() as f64).sqrt()).symmetric();
        }
        raised_above_zero(period, grid)
    }
}

/// A kernel of zero mean with the constant that makes every entry positive.
pub(super) fn raised_above_zero(period: Period<1>, grid: Grid) -> Period<1> {
    let square = SHIFT / (grid.count() as f64).sqrt();
    let depth = -period.lowest(0).min(0.0);
    period.raised_by(square.max(SHIFT_OVER_DEPTH * depth))
}

impl Kernel<1> for PeriodicHalfSpace {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        Boundary::Periodic
    }

    fn parities(&self) -> [[Parity; 2]; 1] {
        [[Parity::Even; 2]]
    }

    fn coefficients(&self) -> Coefficients<1> {
        Coefficients::Period(self.period())
    }

    fn smallest_eigenvalue(&self) -> f64 {
        match self.exact_for {
            PeriodicKernel::Cells => smallest_eigenvalue(self.grid.stretch),
            PeriodicKernel::Waves => shortest_wave(self.grid),
        }
    }

    fn inverse_m_matrix(&self) -> Evidence {
        match self.exact_for {
            PeriodicKernel::Cells => Evidence::Observed,
            PeriodicKernel::Waves => Evidence::Violated,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::love::influence_of_rectangle;
    use approx::assert_relative_eq;

    fn kernel(columns: usize, rows: usize, stretch: f64) -> Period<1> {
        PeriodicHalfSpace { grid: Grid { columns, rows, stretch }, exact_for: PeriodicKernel::Cells }.period()
    }

    #[test]
    fn a_cell_and_its_images() {
        // Differences of the kernel are sums of Love's kernel over images in a square (as many periods in
        // each direction as make one, those at its edges by half); what images beyond it add falls as one
        // over its side.
        for (columns, rows, stretch, [mx, my]) in [
            (3_usize, 3_usize, 1.0, [40_isize, 40_isize]),
            (8, 8, 1.0, [40, 40]),
            (5, 8, 1.0, [48, 30]),
            (1, 6, 1.0, [192, 32]),
            (6, 4, 1.8, [50, 243]),
            (5, 5, 0.4, [200, 32]),
        ] {
            let kernel = kernel(columns, rows, stretch);
            let images = |(x, y): (usize, usize), times: isize| -> f64 {
                let (mx, my) = (times * mx, times * my);
                let lag =
                    |a: usize, i: isize, n: usize| (a.cast_signed() + i * n.cast_signed()).unsigned_abs();
                let weight = |i: isize, m: isize| if i.abs() == m { 0.5 } else { 1.0 };
                (-mx..=mx)
                    .flat_map(|i| (-my..=my).map(move |j| (i, j)))
                    .map(|(i, j)| {
                        let image = influence_of_rectangle(lag(x, i, columns), lag(y, j, rows), stretch);
                        weight(i, mx) * weight(j, my) * image
                    })
                    .sum()
            };
            for to in [(columns / 2, 0), (columns / 3, rows / 2), (columns / 2, 1)] {
                let difference = |times| images((0, 0), times) - images(to, times);
                let expected = 2.0 * difference(2) - difference(1);
                let found = kernel.at(0, 0, 0) - kernel.at(0, to.0, to.1);
                assert!(
                    (found - expected).abs() < 3e-5,
                    "{columns} {rows} {stretch} {to:?}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn mean_and_sign() {
        let squares = [1, 2, 3, 4, 5, 16, 33].map(|n| (n, n, 1.0));
        let others = [(1, 7, 1.0), (40, 3, 1.0), (9, 4, 1.7), (6, 11, 0.3), (1, 1, 3.0), (200, 2, 1.0)];
        for (columns, rows, stretch) in squares.into_iter().chain(others) {
            let kernel = kernel(columns, rows, stretch);
            let count = columns * rows;
            let all: Vec<f64> = (0..count).map(|i| kernel.at(0, i % columns, i / columns)).collect();
            let mean = all.iter().sum::<f64>() / count as f64;
            assert_relative_eq!(mean, kernel.shift(), max_relative = 1e-13);
            assert!(all.iter().all(|&k| k > 0.0), "{columns} {rows}: {all:?}");
            if columns == rows && stretch.to_bits() == 1f64.to_bits() {
                assert_relative_eq!(kernel.shift(), SHIFT / columns as f64);
            }
        }
    }

    #[test]
    fn a_turned_rectangle_has_the_turned_kernel() {
        let (one, two) = (kernel(12, 7, 1.6), kernel(7, 12, 1.6f64.recip()));
        for (x, y) in [(0, 0), (3, 2), (11, 6), (6, 3)] {
            assert_relative_eq!(one.at(0, x, y), two.at(0, y, x), max_relative = 1e-12);
        }
    }

    #[test]
    fn own_image_of_a_point() {
        // N (I(0) - I_free(0)) - c N -> 4 zeta(1/2) beta(1/2) = -3.9002649, the square lattice of point
        // charges on their background; cells add a term of second order.
        let change =
            |n: usize| (kernel(n, n, 1.0).at(0, 0, 0) - influence_of_rectangle(0, 0, 1.0)) * n as f64 - SHIFT;
        let limit = change(64) + (change(64) - change(32)) / 3.0;
        assert_relative_eq!(limit, -3.900_264_9, max_relative = 1e-8);
    }
}
