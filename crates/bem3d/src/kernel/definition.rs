//! The definition of a kernel: the properties that every kernel states.

use super::period::Period;
use super::symbol::Parity;
use crate::geometry::{Grid, Lengths};
use contact_model::Boundary;
use std::any::Any;
use std::fmt;

/// How the tractions of one cell displace the others, on one grid.
///
/// A kernel has `E` independent entries: one for the normal displacement under a pressure, three for the
/// tangential displacements under tangential tractions, two for the coupling of both. Lengths are counted in
/// `c = sqrt(dx dy)` and displacements in `c/(pi E*)` times a pressure. Operators, planner, preconditioner and
/// stiffness ask a kernel what they need to know and distinguish none by name.
pub trait Kernel<const E: usize>: fmt::Debug + Any + Send + Sync {
    /// The grid.
    fn grid(&self) -> Grid;

    /// The boundary of the map: a free surface around it, or periodic copies of it.
    fn boundary(&self) -> Boundary;

    /// How each entry changes when a lag along x, or along y, changes its sign.
    fn parities(&self) -> [[Parity; 2]; E];

    /// The entries, made ready for any lag.
    fn coefficients(&self) -> Coefficients<E>;

    /// A lower bound of the eigenvalues on every set of cells; 0 where there is none.
    fn smallest_eigenvalue(&self) -> f64;

    /// Whether displacements are measured from a point at infinity, so that an approach has a meaning.
    fn vanishes_far_away(&self) -> bool {
        self.boundary() == Boundary::Free
    }

    /// Whether its far field is that of a square cell on a half-space, `1/r + 1/(24 r^3)`, for which there are
    /// approximations.
    fn has_far_field_of_squares(&self) -> bool {
        false
    }

    /// Whether corrections of the tractions may take a kernel that is wrong at long lags.
    fn may_be_shortened(&self) -> bool {
        true
    }

    /// The circular lengths of a transform, which would be `lengths` if the map did not repeat itself.
    fn within_period(&self, lengths: Lengths) -> Lengths {
        if self.boundary() == Boundary::Periodic { lengths.within_period(self.grid()) } else { lengths }
    }

    /// Whether the inverse of the matrix of a set of cells has negative entries off its diagonal only, with a
    /// constant in all entries that is large enough where displacements are measured from their mean. Then a
    /// contact shrinks when it is unloaded, no cell above the plane touches, and equilibria of an attraction that
    /// rises are ordered. The constant changes nothing under a given force.
    fn inverse_m_matrix(&self) -> Evidence;

    /// Whether the surface may rise beside a load, so that cells above the undeformed plane may touch.
    fn may_bulge(&self) -> bool {
        self.inverse_m_matrix() == Evidence::Violated
    }
}

/// What is known of a property that was not proved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Evidence {
    /// It held on every set tried; a test tries some.
    Observed,
    /// There are sets on which it does not hold.
    Violated,
}

/// The entries of a kernel at all lags.
pub enum Coefficients<const E: usize> {
    /// By a function, which writes entry `e` at the lags `(0 .., y)`.
    Lags(Box<FillRow>),
    /// From a table of one period.
    Period(Period<E>),
}

/// Writes an entry at the lags `(0 .., y)`: `(entry, y, row)`.
pub type FillRow = dyn Fn(usize, usize, &mut [f64]) + Send + Sync;

impl<const E: usize> fmt::Debug for Coefficients<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lags(_) => "Lags",
            Self::Period(_) => "Period",
        })
    }
}

impl<const E: usize> Coefficients<E> {
    /// Coefficients that a function gives one by one: `(entry, x, y)`.
    pub fn at_lags(entry: impl Fn(usize, usize, usize) -> f64 + Send + Sync + 'static) -> Self {
        Self::Lags(Box::new(move |e, y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = entry(e, x, y);
            }
        }))
    }

    /// Writes an entry at the lags `(0 .., y)`.
    pub fn fill(&self, entry: usize, y: usize, row: &mut [f64]) {
        match self {
            Self::Lags(fill) => fill(entry, y, row),
            Self::Period(period) => {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = period.at(entry, x, y);
                }
            }
        }
    }

    /// The constant in the entries that are even in both lags.
    pub fn shift(&self) -> f64 {
        match self {
            Self::Lags(_) => 0.0,
            Self::Period(period) => period.shift(),
        }
    }
}
