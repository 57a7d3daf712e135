//! Tangential displacements of two bodies under tangential tractions.

use super::cerruti::{across, along_x, along_y};
use super::definition::{Coefficients, Evidence, Kernel};
use super::love::{influence_of_rectangle, smallest_eigenvalue};
use super::period::Period;
use super::symbol::Parity;
use super::waves::{Integrand, symbol};
use crate::geometry::Grid;
use contact_model::Boundary;

/// The constant in the periodic kernel, over the side of the square with as many cells.
const SHIFT: f64 = 2.0;

/// The kernel `K = I + c M` of tangential tractions: I are the influence coefficients of pressure, M the
/// integrals of `(x^2, y^2, x y)/r^3` (see [`super::cerruti`]). Its entries are `[xx, yy, xy]`.
///
/// So `u_i = (h_c / (pi E*)) sum_j K(i - j) q_j`, the relative displacement of both bodies. With periodic
/// boundaries displacements are measured from their mean, except for a constant in both diagonal entries, which
/// makes the kernel definite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TangentialKernel {
    /// The grid.
    pub grid: Grid,
    /// The boundary of the map.
    pub boundary: Boundary,
    /// The constant c of the bodies, `E* sum nu/(2 G)`, in [0, 1].
    pub compliance: f64,
}

impl TangentialKernel {
    fn period(self) -> Period<3> {
        let Self { grid, compliance: c, .. } = self;
        let normal = symbol(grid, Integrand::Normal);
        let sheared = |integrand| symbol(grid, integrand);
        let along =
            |sheared: Vec<f64>| normal.iter().zip(sheared).map(|(normal, m)| normal + c * m).collect();
        let waves = [
            along(sheared(Integrand::AlongX)),
            along(sheared(Integrand::AlongY)),
            sheared(Integrand::Across).into_iter().map(|m| c * m).collect(),
        ];
        Period::from_waves(grid, self.parities(), waves).raised_by(SHIFT / (grid.count() as f64).sqrt())
    }
}

impl Kernel<3> for TangentialKernel {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        self.boundary
    }

    fn parities(&self) -> [[Parity; 2]; 3] {
        [[Parity::Even; 2], [Parity::Even; 2], [Parity::Odd; 2]]
    }

    fn coefficients(&self) -> Coefficients<3> {
        if self.boundary == Boundary::Periodic {
            return Coefficients::Period(self.period());
        }
        let (c, stretch) = (self.compliance, self.grid.stretch);
        Coefficients::at_lags(move |entry, x, y| match entry {
            0 => influence_of_rectangle(x, y, stretch) + c * along_x(x, y, stretch),
            1 => influence_of_rectangle(x, y, stretch) + c * along_y(x, y, stretch),
            _ => c * across(x, y, stretch),
        })
    }

    /// That of the normal kernel. For a wave along its own direction the contribution of M vanishes in the
    /// continuum and is only slightly negative on the lattice: the smallest eigenvalue of K is not below that of
    /// I by more than 2e-5 of it, for c = 0.43 and 1 and sides of a cell 1 : 1 to 1 : 9.
    fn smallest_eigenvalue(&self) -> f64 {
        (1.0 - 1e-4) * smallest_eigenvalue(self.grid.stretch)
    }

    fn inverse_m_matrix(&self) -> Evidence {
        Evidence::Violated
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Lengths;
    use crate::kernel::TangentialTable;
    use approx::assert_relative_eq;
    use std::sync::Arc;

    #[test]
    fn surfaces_of_one_grid_and_pair_share_a_table() {
        let grid = Grid::square(21, 20);
        let table = |boundary, c| TangentialTable::shared(grid, boundary, c);
        let (one, two) = (table(Boundary::Free, 0.3), table(Boundary::Free, 0.3));
        assert!(Arc::ptr_eq(&one, &two));
        assert!(!Arc::ptr_eq(&one, &table(Boundary::Free, 0.31)));
        assert!(!Arc::ptr_eq(&one, &table(Boundary::Periodic, 0.3)));
    }

    #[test]
    fn periodic_entries_are_sums_over_images() {
        // As for the normal kernel: differences of the kernel, images in a square, its edges by half.
        for (columns, rows, stretch, [mx, my]) in
            [(4_usize, 4_usize, 1.0, [40_isize, 40_isize]), (5, 8, 1.0, [48, 30]), (6, 4, 1.8, [50, 243])]
        {
            let grid = Grid { columns, rows, stretch };
            let c = 0.6;
            let table = TangentialTable::shared(grid, Boundary::Periodic, c);
            let free = |entry: usize, x: usize, y: usize| match entry {
                0 => influence_of_rectangle(x, y, stretch) + c * along_x(x, y, stretch),
                1 => influence_of_rectangle(x, y, stretch) + c * along_y(x, y, stretch),
                _ => c * across(x, y, stretch),
            };
            let images = |entry: usize, (x, y): (usize, usize), times: isize| -> f64 {
                let (mx, my) = (times * mx, times * my);
                let lag = |a: usize, i: isize, n: usize| a.cast_signed() + i * n.cast_signed();
                let weight = |i: isize, m: isize| if i.abs() == m { 0.5 } else { 1.0 };
                (-mx..=mx)
                    .flat_map(|i| (-my..=my).map(move |j| (i, j)))
                    .map(|(i, j)| {
                        let (lx, ly) = (lag(x, i, columns), lag(y, j, rows));
                        let sign = if entry == 2 { (lx.signum() * ly.signum()) as f64 } else { 1.0 };
                        let image = free(entry, lx.unsigned_abs(), ly.unsigned_abs());
                        weight(i, mx) * weight(j, my) * sign * image
                    })
                    .sum()
            };
            for to in [(columns / 2, 0), (columns / 3, rows / 2), (1, 1), (columns - 1, 1)] {
                for entry in 0..3 {
                    let difference = |times| images(entry, (0, 0), times) - images(entry, to, times);
                    let expected = 2.0 * difference(2) - difference(1);
                    let found = table.lag(0, 0)[entry] - table.lag(to.0, to.1)[entry];
                    assert!(
                        (found - expected).abs() < 6e-5,
                        "{columns} {rows} {stretch} {entry} {to:?}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn periodic_entries_have_the_mean_of_their_shift() {
        for (columns, rows, stretch) in [(5, 5, 1.0), (8, 6, 1.0), (30, 42, 2.0), (60, 3, 0.4)] {
            let grid = Grid { columns, rows, stretch };
            let table = TangentialTable::shared(grid, Boundary::Periodic, 0.8);
            let mean = |k: usize| {
                let all = (0..grid.count()).map(|i| table.lag(i % columns, i / columns)[k]);
                all.sum::<f64>() / grid.count() as f64
            };
            assert_relative_eq!(mean(0), table.shift(), max_relative = 1e-12);
            assert_relative_eq!(mean(1), table.shift(), max_relative = 1e-12);
            assert!(mean(2).abs() < 1e-13);
        }
    }

    #[test]
    fn a_long_wave_is_that_of_the_continuum() {
        // (I - nu k k'/k^2)/(G |k|) = (1 + c k_t^2/k^2)/|k| 2/E* with 2/E* = (1 - nu)/G, here times pi E*.
        let (n, nu) = (256, 0.3);
        let c = nu / (1.0 - nu);
        let table = TangentialTable::shared(Grid::square(n, n), Boundary::Periodic, c);
        let lengths = Lengths { x: n, y: n };
        let symbol: Vec<[f64; 3]> = table.symbol(lengths, &contact_model::never).unwrap().collect();
        for (kx, ky) in [(1_u32, 0_u32), (0, 2), (2, 1), (3, 3)] {
            let (qx, qy) = (f64::from(kx), f64::from(ky));
            let (q2, wave) = (qx * qx + qy * qy, std::f64::consts::TAU / n as f64);
            let over = |transverse: f64| n as f64 / q2.sqrt() * transverse;
            let expected = [
                over(1.0 - nu * qx * qx / q2) / (1.0 - nu),
                over(1.0 - nu * qy * qy / q2) / (1.0 - nu),
                over(-nu * qx * qy / q2) / (1.0 - nu),
            ];
            let found = symbol[kx as usize * (n / 2 + 1) + ky as usize];
            for (found, expected) in found.into_iter().zip(expected) {
                // The mean over a cell, and the waves that the grid takes for this one.
                assert!((found - expected).abs() < 0.5 * wave * over(1.0), "{kx} {ky}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_smallest_eigenvalue_is_one_of_the_lattice() {
        for (columns, rows, stretch) in [(40, 40, 1.0), (30, 42, 2.0), (31, 8, 0.4)] {
            for c in [0.0, 0.43, 1.0] {
                let table = TangentialTable::shared(Grid { columns, rows, stretch }, Boundary::Periodic, c);
                let lowest = table
                    .symbol(Lengths { x: columns, y: rows }, &contact_model::never)
                    .unwrap()
                    .map(|[xx, yy, xy]| f64::midpoint(xx, yy) - (0.5 * (xx - yy)).hypot(xy))
                    .fold(f64::INFINITY, f64::min);
                assert!(lowest >= table.smallest_eigenvalue(), "{stretch} {c}: {lowest}");
            }
        }
    }
}
