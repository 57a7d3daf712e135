//! Grids and tolerances of the study, and the observed orders of convergence.

use super::limit::Limit;
use super::problem::ProblemKey;
use analysis::observed_power;
use serde::{Deserialize, Serialize};

/// The sizes of a study.
#[derive(Debug, Clone)]
pub(crate) struct StudySizes {
    /// Grids for every tolerance of `tolerances`, coarsest first.
    pub grids: &'static [usize],
    /// Grids in between, at the tightest tolerance only: they show the order.
    pub between: &'static [usize],
    /// Tolerances on every grid but the finest.
    pub tolerances: &'static [f64],
    /// Tolerances on the finest grid.
    pub finest: &'static [f64],
    /// The grid on which all tolerances from 1e-1 to 1e-10 and every operator are solved.
    pub ladder: usize,
    /// The tolerance of references.
    pub tight: f64,
    /// Elements of lines.
    pub elements: &'static [usize],
    /// Surfaces (and lines) of an ensemble.
    pub surfaces: usize,
    /// Grids of the ensembles.
    pub ensembles: &'static [usize],
}

/// A quantity whose convergence with the grid is studied.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) enum SizeQuantity {
    Stiffness,
    Approach,
    Area,
    /// The L2 norm of the pressure.
    Pressure,
}

impl SizeQuantity {
    pub const ALL: [Self; 4] = [Self::Stiffness, Self::Approach, Self::Area, Self::Pressure];

    pub fn as_str(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness",
            Self::Approach => "approach",
            Self::Area => "area",
            Self::Pressure => "pressure",
        }
    }
}

/// The convergence of a quantity on finer and finer grids.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Order {
    pub problem: ProblemKey,
    pub quantity: SizeQuantity,
    /// Order of convergence in the cell size: that of the extrapolation where established, otherwise the
    /// slope of the errors.
    pub power: Option<f64>,
    /// Whether errors are known against an exact answer or an established order.
    pub established: bool,
    pub limit: Option<Limit>,
    /// Relative error on the coarsest and on the finest grid.
    pub errors: [Option<f64>; 2],
}

impl Order {
    /// From the errors (cell, error) of a sequence, coarsest first; without an established order those that
    /// are `far` from the limit show the slope.
    pub fn new(
        problem: ProblemKey,
        quantity: SizeQuantity,
        limit: Option<Limit>,
        exact: bool,
        errors: &[(f64, f64)],
        far: &[(f64, f64)],
    ) -> Self {
        let extrapolated = limit.and_then(|l| l.order);
        Self {
            problem,
            quantity,
            power: extrapolated.or_else(|| observed_power(far.iter().copied())),
            established: exact || extrapolated.is_some(),
            limit,
            errors: [errors.first().map(|e| e.1), errors.last().map(|e| e.1)],
        }
    }
}
