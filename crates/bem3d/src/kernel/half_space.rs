//! Normal displacement of a half-space that is unloaded outside the map, by Love's coefficients.

use super::definition::{Coefficients, Evidence, Kernel};
use super::love::{influence_row, smallest_eigenvalue};
use super::symbol::Parity;
use crate::geometry::Grid;
use contact_model::Boundary;

/// A half-space under the pressures on its map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    /// The grid.
    pub grid: Grid,
}

impl Kernel<1> for HalfSpace {
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
        let stretch = self.grid.stretch;
        Coefficients::Lags(Box::new(move |_, y, row| influence_row(y, stretch, row)))
    }

    fn smallest_eigenvalue(&self) -> f64 {
        smallest_eigenvalue(self.grid.stretch)
    }

    fn has_far_field_of_squares(&self) -> bool {
        self.grid.has_square_cells()
    }

    fn inverse_m_matrix(&self) -> Evidence {
        Evidence::Observed
    }
}
