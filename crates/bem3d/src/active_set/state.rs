//! The problem, the load, the limits, the initial guess and the solution of a solve.

use super::bounds::Bounds;
use super::candidates::Candidates;
use super::residuals::{ContactGap, Residuals};
use super::undecided::undecided;
use crate::geometry::{CellSet, Grid};
use crate::kernel::{Medium, NormalTable};
use crate::linear::Workspace;
use crate::operator::Operators;
use crate::parts::{Part, Recorder};
use crate::tuning::Tuning;
use contact_model::Status;
use std::borrow::Cow;
use std::sync::Arc;

/// One surface in nondimensional form: z in units of the rms height, p so that `u = sum I p`.
#[derive(Debug)]
pub struct Problem {
    /// The body that deforms under the pressures.
    pub medium: Medium,
    /// Where contact is possible.
    pub candidates: Candidates,
    /// The operators.
    pub operators: Operators,
    /// Room for its linear systems.
    pub workspace: Workspace,
    /// The bounds of the pressure of a cell.
    pub bounds: Bounds,
    /// The same surface on larger cells, once a cold start has needed it.
    pub coarser: Option<Box<Problem>>,
    /// Whether coarse grids may give initial guesses.
    pub nested: bool,
}

impl Problem {
    /// A surface of gaps z from the plane of first touch, row-major; infinite where a point is undefined. Its
    /// time is charged to the recorder.
    pub fn recorded(
        grid: Grid,
        z: Arc<Vec<f64>>,
        medium: impl Into<Medium>,
        tuning: &Tuning,
        recorder: &Recorder,
    ) -> Self {
        let medium = medium.into();
        let table = recorder.timed(Part::Plans, || NormalTable::shared(grid, medium));
        Self {
            medium,
            candidates: Candidates::new(grid, z),
            operators: Operators::recorded(table, tuning, recorder),
            workspace: Workspace::default(),
            bounds: Bounds::Unlimited,
            coarser: None,
            nested: true,
        }
    }

    /// Drops the plans and buffers of the loads before, on the coarser grids too.
    pub fn forget_plans(&mut self) {
        self.operators.forget_plans();
        self.workspace = Workspace::default();
        if let Some(coarser) = &mut self.coarser {
            coarser.forget_plans();
        }
    }

    /// As `recorded`, but no time is charged.
    #[cfg(test)]
    pub fn new(grid: Grid, z: Arc<Vec<f64>>, medium: impl Into<Medium>, tuning: &Tuning) -> Self {
        Self::recorded(grid, z, medium, tuning, &Recorder::default())
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.operators.table().grid()
    }
}

/// What is prescribed, nondimensional.
#[derive(Debug, Clone, Copy)]
pub enum Control {
    /// Sum of p.
    Force(f64),
    /// Approach.
    Approach(f64),
}

/// Accuracy and length of a solve.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bound of the residuals.
    pub tolerance: f64,
    /// Length that gaps are compared with; `None`: the approach.
    pub height: Option<f64>,
    /// Largest number of outer iterations.
    pub outer_iterations: usize,
    /// Whether small sets may be factored.
    pub factor: bool,
    /// Whether residuals in single precision end the solve: its result is a guess.
    pub is_guess: bool,
}

/// An initial guess.
#[derive(Debug, Clone)]
pub struct Guess {
    /// Where there is pressure.
    pub set: CellSet,
    /// Positive pressure there.
    pub p: Vec<f64>,
    /// Approach that belongs to it, rather too large than too small.
    pub d: f64,
}

/// A solved state.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The contact set: cells with p > 0.
    pub contact: CellSet,
    /// Pressure on it; exactly the upper bound on cells that are at it.
    pub p: Vec<f64>,
    /// Approach.
    pub d: f64,
    /// `G q = 1` on the contact set, where the state was factored.
    pub q: Option<Vec<f64>>,
    /// How well the contact conditions hold.
    pub residuals: Residuals,
    /// Conjugate gradient steps.
    pub steps: usize,
    /// How it ended.
    pub status: Status,
    /// The gap that the residuals were measured from.
    pub continuation: Continuation,
}

/// The exact gap of a state on all cells that could touch. It decides which cells are undecided, and a solve
/// to a tighter tolerance starts from it instead of evaluating it again.
#[derive(Debug, Clone, Default)]
pub struct Continuation {
    /// The candidates, the contact set among them.
    pub checked: CellSet,
    /// Gap on them.
    pub gap: Vec<f64>,
    /// The candidates are those below this approach.
    pub reach: f64,
}

impl Control {
    /// The sum of the pressure, where it is prescribed.
    pub fn force(self) -> Option<f64> {
        match self {
            Self::Force(force) => Some(force),
            Self::Approach(_) => None,
        }
    }
}

impl Solved {
    /// Gap left on a part of the contact set.
    pub fn gap_on(&self, part: &CellSet) -> Vec<f64> {
        part.carry(&self.continuation.checked, &self.continuation.gap)
    }

    /// The distance of the pressure of the `free` cells from the nearest of its bounds.
    pub fn room(&self, free: &CellSet, bounds: Bounds) -> Cow<'_, [f64]> {
        if bounds == Bounds::Unlimited && free.len() == self.contact.len() {
            return Cow::Borrowed(&self.p);
        }
        let mut room = free.carry(&self.contact, &self.p);
        for p in &mut room {
            *p = p.min(bounds.upper() - *p);
        }
        Cow::Owned(room)
    }

    /// Cells outside the `free` ones that may belong to them: open cells whose gap is negative or smaller
    /// than the change that it can still undergo, and cells at the upper bound whose indentation is.
    pub fn undecided(&self, grid: Grid, free: &CellSet, left: &[f64], tuning: &Tuning) -> CellSet {
        let Continuation { checked, gap, .. } = &self.continuation;
        let seen = ContactGap { contact: free, left, checked, gap };
        if free.len() == self.contact.len() {
            return undecided(grid, seen, tuning);
        }
        let at_bound = self.contact.without(free);
        let twice: Vec<f64> = at_bound.carry(checked, gap).iter().map(|g| -2.0 * g).collect();
        let mut away = gap.clone();
        checked.add_carried(&at_bound, &twice, &mut away);
        undecided(grid, ContactGap { gap: &away, ..seen }, tuning)
    }
}
