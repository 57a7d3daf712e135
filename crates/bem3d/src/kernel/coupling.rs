//! The coupling of normal and tangential displacements of bodies that differ.

use super::cerruti::coupling;
use super::definition::{Coefficients, Evidence, Kernel};
use super::period::Period;
use super::symbol::Parity;
use super::waves::{Integrand, symbol};
use crate::geometry::Grid;
use contact_model::Boundary;

/// The integrals `J = (J_x, J_y)` of `(x, y)/r^2` over a cell: with Dundurs' beta, tractions cause the normal
/// displacement `u_z = beta (J_x q_x + J_y q_y)` and pressures the tangential one `-beta J p`, in the units of
/// [`super::tangential::TangentialKernel`]. With periodic boundaries its mean is zero.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CouplingKernel {
    /// The grid.
    pub grid: Grid,
    /// The boundary of the map.
    pub boundary: Boundary,
}

impl Kernel<2> for CouplingKernel {
    fn grid(&self) -> Grid {
        self.grid
    }

    fn boundary(&self) -> Boundary {
        self.boundary
    }

    fn parities(&self) -> [[Parity; 2]; 2] {
        [[Parity::Odd, Parity::Even], [Parity::Even, Parity::Odd]]
    }

    fn coefficients(&self) -> Coefficients<2> {
        let grid = self.grid;
        if self.boundary == Boundary::Periodic {
            let waves = [Integrand::CouplingX, Integrand::CouplingY].map(|integrand| symbol(grid, integrand));
            return Coefficients::Period(Period::from_waves(grid, self.parities(), waves));
        }
        let stretch = grid.stretch;
        Coefficients::at_lags(move |entry, x, y| match entry {
            0 => coupling(x, y, stretch),
            _ => coupling(y, x, stretch.recip()),
        })
    }

    /// The coupling alone is antisymmetric: it has no energy.
    fn smallest_eigenvalue(&self) -> f64 {
        0.0
    }

    fn inverse_m_matrix(&self) -> Evidence {
        Evidence::Violated
    }
}
