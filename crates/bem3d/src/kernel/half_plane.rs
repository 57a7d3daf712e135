//! Influence coefficients of a half-plane (plane strain): the displacement of the middle of a strip under
//! uniform pressure on another.
//!
//! `u(x) = -(2 / (pi E*)) int p(s) ln(|x - s| / D) ds` does not vanish at infinity: displacements are
//! measured from a point at the distance D from each strip. D is twice the side of the map along x, so that
//! every entry is positive and the matrix is an inverse M-matrix on every set tried. Pressure, contact and
//! gap at a prescribed force do not depend on it; the approach and the stiffness do.

use super::definition::{Coefficients, Evidence, Kernel};
use super::symbol::Parity;
use crate::geometry::{Grid, Lengths};
use contact_model::Boundary;
use std::f64::consts::PI;

/// Beyond this distance, in steps, the series is used: the closed form, a difference of terms `x ln x`, loses
/// digits.
const FAR: usize = 64;
/// D over the side of the map along x.
const DATUM: f64 = 2.0;
/// Catalan's constant.
const CATALAN: f64 = 0.915_965_594_177_219;

/// A half-plane in plane strain under the pressures on one row of strips.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// The grid, of one row.
    pub grid: Grid,
}

impl Kernel<1> for HalfPlane {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        Boundary::Free
    }

    fn parities(&self) -> [[Parity; 2]; 1] {
        [[Parity::Even; 2]]
    }

    fn coefficients(&self) -> Coefficients<1> {
        let grid = self.grid;
        Coefficients::at_lags(move |_, x, _| influence(x, grid))
    }

    fn smallest_eigenvalue(&self) -> f64 {
        smallest_eigenvalue(self.grid.stretch)
    }

    fn vanishes_far_away(&self) -> bool {
        false
    }

    fn within_period(&self, lengths: Lengths) -> Lengths {
        // One row has no lag along y.
        Lengths { y: 1, ..lengths }
    }

    fn inverse_m_matrix(&self) -> Evidence {
        Evidence::Observed
    }
}

/// Displacement at a lag, in strips of width a, under unit pressure, times `pi E* / c`; c is the unit of
/// length and `stretch = a / c`: `2 (a/c) (ln(D/a) - <ln|x + t|>)`, the mean over `-1/2 < t < 1/2`.
fn influence(lag: usize, grid: Grid) -> f64 {
    let datum = (DATUM * grid.columns as f64).ln();
    2.0 * grid.stretch * (datum - mean_logarithm(lag))
}

/// A lower bound of the eigenvalues on every set of strips: that of the alternating wave on the infinite
/// line, `8 G a / (pi c)` with Catalan's constant G.
fn smallest_eigenvalue(stretch: f64) -> f64 {
    8.0 * CATALAN / PI * stretch
}

/// The mean of `ln|x + t|` over `-1/2 < t < 1/2`.
pub(super) fn mean_logarithm(lag: usize) -> f64 {
    let x = lag as f64;
    if lag > FAR {
        // <t^2> = 1/12, <t^4> = 1/80.
        let square = x.powi(-2);
        return x.ln() - square * (1.0 / 24.0 + square / 320.0);
    }
    let integral = |u: f64| u * u.abs().ln() - u;
    integral(x + 0.5) - integral(x - 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn line(columns: usize) -> Grid {
        Grid { columns, rows: 1, stretch: 1.0 }
    }

    #[test]
    fn logarithms_by_quadrature_and_both_forms() {
        // Own strip: ln(1/2) - 1.
        assert_relative_eq!(mean_logarithm(0), 0.5_f64.ln() - 1.0, max_relative = 1e-15);
        for lag in [1, 2, 7, FAR, FAR + 1, 1000] {
            let points = 2000;
            let at = |i: i32| (f64::from(i) + 0.5) / f64::from(points) - 0.5;
            let mean: f64 = (0..points).map(|i| (lag as f64 + at(i)).ln()).sum::<f64>() / f64::from(points);
            approx::assert_abs_diff_eq!(mean_logarithm(lag), mean, epsilon = 5e-8);
        }
        let x = (FAR + 1) as f64;
        let closed = (x + 0.5) * (x + 0.5).ln() - (x - 0.5) * (x - 0.5).ln() - 1.0;
        assert_relative_eq!(mean_logarithm(FAR + 1), closed, max_relative = 1e-13);
    }

    #[test]
    fn strips_are_the_difference_of_two_long_rows_of_squares() {
        // Rows of square cells so long that their ends add the same at both lags: Love's kernel summed along
        // y.
        let half = 20_000;
        let row = |lag| {
            (1..=half).map(|y| 2.0 * crate::kernel::love::influence(lag, y)).sum::<f64>()
                + crate::kernel::love::influence(lag, 0)
        };
        let grid = line(64);
        for lags in [(0, 1), (1, 5), (3, 40)] {
            let expected = row(lags.0) - row(lags.1);
            assert_relative_eq!(
                influence(lags.0, grid) - influence(lags.1, grid),
                expected,
                max_relative = 1e-5
            );
        }
    }
}
