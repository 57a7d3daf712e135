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

/// The errors on a sequence of grids, each with the size of the cells, coarsest first.
pub(crate) struct SequenceErrors<'a> {
    /// Whether they are against an exact answer.
    pub exact: bool,
    pub all: &'a [(f64, f64)],
    /// Those that are far from the limit: they show the slope where no order is established.
    pub far: &'a [(f64, f64)],
}

impl Order {
    pub fn new(
        problem: ProblemKey,
        quantity: SizeQuantity,
        limit: Option<Limit>,
        errors: &SequenceErrors<'_>,
    ) -> Self {
        let SequenceErrors { exact, all, far } = errors;
        let extrapolated = limit.and_then(|l| l.order);
        Self {
            problem,
            quantity,
            power: extrapolated.or_else(|| observed_power(far.iter().copied())),
            established: *exact || extrapolated.is_some(),
            limit,
            errors: [all.first().map(|e| e.1), all.last().map(|e| e.1)],
        }
    }
}
