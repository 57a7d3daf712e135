//! Normal displacement of a half-space whose map repeats itself along one axis and is free along the other: a contact
//! that goes on along a line.
//!
//! Along the periodic axis pressures are waves. Those that vary along it displace the surface beside them by a
//! modified Bessel function of the distance, which falls as `exp(-2 pi y/L)` with the period L. On a map that repeats
//! itself across as well, but far enough away, they therefore displace it in the same way, and the kernel of such a
//! map is known. The mean along the line is plane strain: its displacement is the logarithm of a half-plane, measured
//! from a point at the distance D of each row. D is twice the longer side of the map, so that every entry is positive.
//! Pressure, contact and gap under a prescribed force do not depend on it; the approach and the stiffness do, and
//! states have neither.

use super::definition::{Coefficients, Evidence, Kernel};
use super::half_plane::mean_logarithm;
use super::love::smallest_eigenvalue;
use super::period::Period;
use super::symbol::Parity;
use super::waves::{Integrand, symbol};
use crate::geometry::{Grid, Lengths, Window};
use contact_model::Boundary;

/// Distance of the copies across the line, over the period, beyond the map itself: they displace it by
/// `exp(-2 pi 5.6)` = 5e-16 of what a row displaces itself.
const CLEARANCE: f64 = 5.6;
/// D over the longer side of the map.
const DATUM: f64 = 2.0;

/// A half-space under the pressures on its map and on the copies along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlongALine {
    /// The grid.
    pub grid: Grid,
    /// Periodic along x or along y.
    pub boundary: Boundary,
}

impl AlongALine {
    fn is_along_x(&self) -> bool {
        self.boundary == Boundary::PeriodicAlongX
    }

    /// The map turned so that it is periodic along its columns.
    fn turned(&self) -> Grid {
        let Grid { columns, rows, stretch } = self.grid;
        if self.is_along_x() {
            self.grid
        } else {
            Grid { columns: rows, rows: columns, stretch: stretch.recip() }
        }
    }

    /// The waves that vary along the line, as the kernel of a map with copies across.
    ///
    /// Cost: that of a periodic kernel on `columns x (rows + 5.6 columns)` cells.
    fn varying(&self) -> Period<1> {
        let grid = self.turned();
        let (a, b) = grid.cell();
        let clear = (CLEARANCE * grid.columns as f64 * a / b).ceil() as usize;
        let across = Window { x: 0, y: 0, width: 1, height: (grid.rows + clear).div_ceil(2) + 1 };
        // A length of fast transforms, at least as long.
        let wide = Grid { rows: Lengths::free(across).y, ..grid };
        let mut waves = symbol(wide, Integrand::Normal);
        // Those that do not vary along the line.
        waves[..=wide.rows / 2].fill(0.0);
        Period::from_waves(wide, [[Parity::Even; 2]], [waves])
    }

    /// The mean along the line at a distance across, in cells.
    fn mean(&self) -> impl Fn(usize) -> f64 + Send + Sync + 'static {
        let grid = self.turned();
        let ((a, b), along) = (grid.cell(), grid.columns as f64);
        let side = (along * a).max(grid.rows as f64 * b);
        let datum = (DATUM * side / b).ln();
        move |lag| 2.0 * b * (datum - mean_logarithm(lag)) / along
    }
}

impl Kernel<1> for AlongALine {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        self.boundary
    }

    fn parities(&self) -> [[Parity; 2]; 1] {
        [[Parity::Even; 2]]
    }

    fn coefficients(&self) -> Coefficients<1> {
        let (varying, mean) = (self.varying(), self.mean());
        if self.is_along_x() {
            return Coefficients::Lags(Box::new(move |_, y, row| {
                let mean = mean(y);
                for (x, value) in row.iter_mut().enumerate() {
                    *value = varying.at(0, x, y) + mean;
                }
            }));
        }
        Coefficients::at_lags(move |_, x, y| varying.at(0, y, x) + mean(x))
    }

    fn smallest_eigenvalue(&self) -> f64 {
        smallest_eigenvalue(self.grid.stretch)
    }

    fn vanishes_far_away(&self) -> bool {
        false
    }

    fn within_period(&self, lengths: Lengths) -> Lengths {
        let period = lengths.within_period(self.grid);
        if self.is_along_x() {
            Lengths { x: period.x, ..lengths }
        } else {
            Lengths { y: period.y, ..lengths }
        }
    }

    fn inverse_m_matrix(&self) -> Evidence {
        Evidence::Observed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::love::influence_of_rectangle;

    fn entries(columns: usize, rows: usize, stretch: f64, boundary: Boundary) -> Vec<Vec<f64>> {
        let kernel = AlongALine { grid: Grid { columns, rows, stretch }, boundary };
        let coefficients = kernel.coefficients();
        let row = |y| {
            let mut row = vec![0.0; columns];
            coefficients.fill(0, y, &mut row);
            row
        };
        (0..rows).map(row).collect()
    }

    /// Sums over images: those far away as the potential of points, whose squares of the lag are summed to infinity.
    #[test]
    fn a_cell_and_its_images() {
        for (columns, rows, stretch) in
            [(4_usize, 3_usize, 1.0_f64), (7, 9, 1.0), (6, 5, 1.7), (5, 8, 0.4), (1, 6, 1.0)]
        {
            let kernel = entries(columns, rows, stretch, Boundary::PeriodicAlongX);
            let (a, b) = (stretch, stretch.recip());
            let (side, most) = (columns as f64 * a, 4000_usize);
            let sum = |x: usize, y: usize| -> f64 {
                let of = |m: isize| (x.cast_signed() + m * columns.cast_signed()).unsigned_abs();
                let most = most.cast_signed();
                let near: f64 = (-most..=most).map(|m| influence_of_rectangle(of(m), y, stretch)).sum();
                // sum over |m| > M of (2 x^2 - y^2)/(2 (m L)^3), and the same of the moments of a cell, which do not
                // depend on the lag.
                let (x, y) = (x as f64 * a, y as f64 * b);
                let cubes = 1.0 / (most as f64 + 0.5).powi(2);
                near + 0.5 * (2.0 * x * x - y * y) / side.powi(3) * cubes
            };
            for (x, y) in [(columns / 2, 0), (columns / 3, rows / 2), (0, rows - 1), (columns - 1, rows - 1)]
            {
                let (found, expected) = (kernel[0][0] - kernel[y][x], sum(0, 0) - sum(x, y));
                let error = (found - expected).abs() / influence_of_rectangle(0, 0, stretch);
                assert!(error < 2e-12, "{columns} {rows} {stretch} {x} {y}: {found} {expected}, {error:e}");
            }
        }
    }

    /// The mean along the line is the strip of a half-plane, and copies across are not seen.
    #[test]
    fn uniform_pressure_along_the_line_is_plane_strain() {
        let kernel = entries(6, 11, 1.3, Boundary::PeriodicAlongX);
        let b = 1.3_f64.recip();
        for (y, row) in kernel.iter().enumerate() {
            let sum: f64 = row.iter().sum();
            let strip = |y: usize| -2.0 * b * mean_logarithm(y);
            let (found, expected) = (sum - kernel[0].iter().sum::<f64>(), strip(y) - strip(0));
            assert!((found - expected).abs() < 1e-12, "{y}: {found} {expected}");
        }
    }

    #[test]
    fn both_axes_and_all_signs() {
        for (columns, rows, stretch) in [(9, 4, 1.0), (4, 9, 1.6), (40, 1, 1.0), (2, 50, 0.3), (1, 1, 1.0)] {
            let along_x = entries(columns, rows, stretch, Boundary::PeriodicAlongX);
            let along_y = entries(rows, columns, stretch.recip(), Boundary::PeriodicAlongY);
            for (y, row) in along_x.iter().enumerate() {
                for (x, value) in row.iter().enumerate() {
                    assert!(*value > 0.0, "{columns} {rows} {x} {y}: {value}");
                    assert!((value - along_y[x][y]).abs() < 1e-12, "{x} {y}");
                    assert!((value - row[(columns - x) % columns]).abs() < 1e-12, "{x} {y}");
                }
            }
        }
    }
}
