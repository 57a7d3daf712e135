//! A surface with friction through the increments of a path.

use super::increment::{
    self, FrictionLimits, FrictionSystems, Increment, IncrementState, TangentialControl, exact,
};
use super::linearised::{FrictionRoom, SlipBranch};
use crate::geometry::{CellSet, Grid};
use crate::kernel::TangentialTable;
use crate::law::total;
use crate::operator::{CouplingOperator, TangentialOperators};
use crate::parts::Recorder;
use crate::real::{dot, sum};
use crate::tuning::Tuning;
use contact_model::{Boundary, FrictionLaw, Interrupted, Status, Stop};
use serde::{Deserialize, Serialize};

/// The contact at the end of an increment, nondimensional: pressures so that `u = sum I p`.
#[derive(Debug, Clone, Copy)]
pub struct PressedCells<'a> {
    /// Cells with pressure.
    pub cells: &'a CellSet,
    /// Pressure on them.
    pub pressure: &'a [f64],
}

/// The start of the next increment. The default is no contact, no traction and no displacement.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct SlipMemory {
    /// The contact.
    pub cells: CellSet,
    /// Tractions on it: components along x, then those along y.
    pub traction: Vec<f64>,
    /// Tangential displacement of the bodies.
    pub displacement: [f64; 2],
    /// `delta - u` on the contact, with u its tangential displacement: the total slip of each cell from its
    /// position without any traction. Empty where it is not known yet.
    pub offset: Vec<f64>,
    /// Slip of each cell since it touched.
    pub slip: Vec<f64>,
    /// Slip in the last increment in which anything moved: it tells the cells that slipped from those that stuck.
    pub moved: Vec<f64>,
    /// Pressure on the contact, which causes tangential displacements where both problems are coupled. Where
    /// friction acts on the attached share of each cell, these shares.
    pub pressure: Vec<f64>,
}

/// The state at the end of an increment.
#[derive(Debug, Clone)]
pub struct FrictionState {
    /// The start of the next increment: contact, tractions, displacement, slip since each cell touched.
    pub memory: SlipMemory,
    /// Largest traction of each cell.
    pub limit: Vec<f64>,
    /// Slip of the increment; where nothing moved in it, that of the last one in which anything did.
    pub slip: Vec<f64>,
    /// Sum of the tractions.
    pub force: [f64; 2],
    /// `sum(q . w)`: what friction dissipated in the increment.
    pub dissipated: f64,
    /// The cells that stick.
    pub stick: CellSet,
    /// Relative duality gap, see [`IncrementState::duality_gap`].
    pub duality_gap: f64,
    /// Difference of the force from the prescribed one, over the largest force.
    pub load_error: f64,
    /// Newton's steps and those of conjugate gradients.
    pub iterations: [usize; 2],
    /// How it ended.
    pub status: Status,
}

/// Why there is no state at the end of an increment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum NotAdvanced {
    /// The tangential force is larger than friction can hold.
    Force {
        /// The largest one.
        largest: f64,
    },
    /// By a stop, before there were any tractions.
    Interrupted,
}

impl From<Interrupted> for NotAdvanced {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// The tangential load of an increment, and the law of friction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrictionLoad {
    /// Largest traction at a pressure, both nondimensional.
    pub law: FrictionLaw,
    /// What is prescribed at the end of the increment.
    pub control: TangentialControl,
}

impl FrictionLoad {
    /// The largest traction of each cell.
    fn limits(&self, pressure: &[f64]) -> Vec<f64> {
        pressure.iter().map(|&pressure| self.law.largest_traction(pressure)).collect()
    }
}

/// An increment of a path.
#[derive(Debug, Clone, Copy)]
pub struct SlipStep<'a> {
    /// The state before.
    pub before: &'a SlipMemory,
    /// The contact at the end.
    pub contact: PressedCells<'a>,
    /// The tangential load at the end.
    pub load: FrictionLoad,
    /// Tractions on some cells to begin with, admissible or not; `None`: those before.
    pub guess: Option<(&'a CellSet, &'a [f64])>,
    /// Whether tractions change while nothing slips: those before are then not the ones that were solved for.
    pub relaxes: bool,
}

/// Friction on one surface: operators and room, kept from increment to increment.
#[derive(Debug)]
pub struct FrictionSolver {
    /// The kernel of tangential tractions.
    pub operators: TangentialOperators,
    /// Room for its systems.
    pub room: FrictionRoom,
    /// The coupling of normal and tangential displacements; `None` where it vanishes or is neglected.
    coupling: Option<CouplingOperator>,
}

impl FrictionSolver {
    /// A surface on bodies of the constant `compliance = E* sum nu/(2 G)`, see `kernel/tangential.rs`.
    ///
    /// `beta` is Dundurs' second constant with the body as the first one on which the tractions act; 0 leaves the
    /// normal and the tangential problem independent of each other.
    pub fn new(
        grid: Grid,
        boundary: Boundary,
        [compliance, beta]: [f64; 2],
        tuning: &Tuning,
        recorder: &Recorder,
    ) -> Self {
        let table = TangentialTable::shared(grid, boundary, compliance);
        let coupling = (beta.abs() > 0.0).then(|| CouplingOperator::new(grid, boundary, beta));
        let operators = TangentialOperators::new(table, tuning, recorder);
        Self { operators, room: FrictionRoom::default(), coupling }
    }

    /// The kernel of tangential tractions with the room for its systems.
    pub fn systems(&mut self) -> FrictionSystems<'_> {
        FrictionSystems { operators: &mut self.operators, room: &mut self.room }
    }

    /// Drops the plans and the buffers of the increments before. The coupling has one plan, of the grid.
    pub fn forget_plans(&mut self) {
        self.operators.forget_plans();
        self.room = FrictionRoom::default();
    }

    /// Whether the normal and the tangential problem are coupled.
    pub fn is_coupled(&self) -> bool {
        self.coupling.is_some()
    }

    /// Normal displacement of the whole grid under the tractions of a state; `None` where the problems are
    /// not coupled.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn normal_displacement(
        &mut self,
        state: &SlipMemory,
        stop: Stop<'_>,
    ) -> Result<Option<Vec<f64>>, Interrupted> {
        let coupling = self.coupling.as_mut();
        coupling.map(|coupling| coupling.normal(&state.cells, &state.traction, stop)).transpose()
    }

    /// Adds the tangential displacement under pressures, times a sign.
    fn add_pressed(
        &mut self,
        (from, pressure): (&CellSet, &[f64]),
        sign: f64,
        cells: &CellSet,
        u: &mut [f64],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        if let Some(coupling) = &mut self.coupling {
            let pressed = coupling.tangential(from, pressure, cells, stop)?;
            u.iter_mut().zip(pressed).for_each(|(u, pressed)| *u += sign * pressed);
        }
        Ok(())
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.operators.table().grid()
    }

    /// Applications and linear systems so far.
    pub fn work(&self) -> [usize; 2] {
        let coupled = self.coupling.as_ref().map_or(0, |coupling| coupling.applications);
        [self.operators.applications + coupled, self.operators.solves]
    }

    /// The state at the end of an increment, from the one before.
    ///
    /// A cell that comes into contact takes its slip reference from where it was at the beginning. Where it touches
    /// within the increment does not matter to the tractions: a later reference, linear in the increment, is
    /// `w` times a positive number, which changes neither the direction of the slip nor whether there is any. A
    /// cell that leaves forgets its slip.
    ///
    /// An increment in which nothing moves, within the tolerance, leaves the state before as it is. Whether its cells
    /// stick or slip would be a matter of rounding otherwise. A number of such increments, each too small to be
    /// resolved, still adds up, because each is measured from the last one that moved.
    ///
    /// # Errors
    /// [`NotAdvanced::Force`] for a force of more than the sum of the largest tractions of the cells, beyond a
    /// billionth of it.
    pub fn advance(
        &mut self,
        step: SlipStep<'_>,
        limits: FrictionLimits,
        stop: Stop<'_>,
    ) -> Result<FrictionState, NotAdvanced> {
        let SlipStep { before, contact: PressedCells { cells, pressure }, load, guess, .. } = step;
        let limit = load.limits(pressure);
        if let TangentialControl::Force([x, y]) = load.control {
            let largest = sum(&limit);
            if x.hypot(y) > largest * (1.0 + FORCE_ROUNDING) {
                return Err(NotAdvanced::Force { largest });
            }
        }
        let offset = self.offset(before, cells, stop)?;
        let mut reference = offset.clone();
        self.add_pressed((cells, pressure), 1.0, cells, &mut reference, stop)?;
        let (from, tractions) = guess.unwrap_or((&before.cells, &before.traction));
        let start = carried(cells, from, tractions);
        let increment = Increment {
            cells,
            limit: &limit,
            reference: &reference,
            control: load.control,
            displacement: before.displacement,
        };
        let found = increment::solve(self.systems(), increment, start, limits, stop)?;
        if !step.relaxes && self.is_unmoved(step, &limit, &found, limits) {
            return Ok(self.unmoved(before, load, &found));
        }
        let unresolved = limits.unresolved * sum(&limit) * found.length;
        let still = step.relaxes && weighted(&limit, &found.slip) <= unresolved;
        let mut state = moved(step, limit, &offset, found);
        if still && !before.cells.is_empty() {
            // Cells at their limit go on as they went when something slipped last.
            state.slip = carried(cells, &before.cells, &before.moved);
            state.memory.moved.clone_from(&state.slip);
            let (tractions, rho) = (&state.memory.traction, increment::step(&self.operators));
            state.stick = increment::sticking(cells, (tractions, &state.slip), &state.limit, rho);
        }
        Ok(state)
    }

    /// Whether nothing has moved within what is resolved.
    fn is_unmoved(
        &self,
        step: SlipStep<'_>,
        limit: &[f64],
        found: &IncrementState,
        limits: FrictionLimits,
    ) -> bool {
        let SlipStep { before, contact: PressedCells { cells, pressure }, load, .. } = step;
        let most = limits.unresolved * sum(limit);
        most > 0.0
            && *cells == before.cells
            // Also where a tighter tolerance than this asks for more than the arithmetic gives.
            && found.duality_gap <= limits.unresolved
            && change(&load.limits(&before.pressure), limit) <= most
            // Pressures that change no limit still displace, where both problems are coupled.
            && (self.coupling.is_none()
                || change(&before.pressure, pressure) <= limits.unresolved * sum(pressure))
            && change(&before.traction, &found.traction) <= most
            && weighted(limit, &found.slip) <= most * found.length
    }

    /// The state before, with the certificate of the increment.
    fn unmoved(&self, before: &SlipMemory, load: FrictionLoad, found: &IncrementState) -> FrictionState {
        let limit = load.limits(&before.pressure);
        let slip = before.moved.clone();
        let rho = increment::step(&self.operators);
        FrictionState {
            force: total(&before.traction),
            dissipated: 0.0,
            stick: increment::sticking(&before.cells, (&before.traction, &slip), &limit, rho),
            memory: before.clone(),
            limit,
            slip,
            duality_gap: found.duality_gap,
            load_error: found.load_error,
            iterations: [found.iterations, found.steps],
            status: found.status,
        }
    }

    /// `delta - u` of the state before on the cells of the next contact.
    fn offset(
        &mut self,
        before: &SlipMemory,
        cells: &CellSet,
        stop: Stop<'_>,
    ) -> Result<Vec<f64>, Interrupted> {
        if *cells == before.cells && !before.offset.is_empty() {
            return Ok(before.offset.clone());
        }
        let mut u = Vec::new();
        exact(&mut self.operators, (&before.cells, &before.traction), cells, &mut u, stop)?;
        for (u, delta) in u.chunks_exact_mut(cells.len().max(1)).zip(before.displacement) {
            for u in u.iter_mut() {
                *u = delta - *u;
            }
        }
        if !before.cells.is_empty() {
            self.add_pressed((&before.cells, &before.pressure), -1.0, cells, &mut u, stop)?;
        }
        Ok(u)
    }
}

impl FrictionState {
    /// The cells that stick and slip as the load goes on.
    pub fn branch(&self, operators: &TangentialOperators) -> SlipBranch {
        let rho = increment::step(operators);
        let moved = |(q, w): (&f64, &f64)| q + rho * w;
        let y: Vec<f64> = self.memory.traction.iter().zip(&self.slip).map(moved).collect();
        SlipBranch::of(&self.memory.cells, &y, &self.slip, &self.limit)
    }
}

/// The state at the end of an increment, from its tractions; `offset` is `delta - u` at its beginning.
fn moved(step: SlipStep<'_>, limit: Vec<f64>, offset: &[f64], found: IncrementState) -> FrictionState {
    let SlipStep { before, contact: PressedCells { cells, pressure }, .. } = step;
    let IncrementState { traction, slip, .. } = found;
    let mut since = carried(cells, &before.cells, &before.slip);
    since.iter_mut().zip(&slip).for_each(|(since, slip)| *since += slip);
    FrictionState {
        force: total(&traction),
        dissipated: dot(&traction, &slip),
        memory: SlipMemory {
            cells: cells.clone(),
            traction,
            displacement: found.displacement,
            offset: offset.iter().zip(&slip).map(|(offset, slip)| offset + slip).collect(),
            slip: since,
            moved: slip.clone(),
            pressure: pressure.to_vec(),
        },
        limit,
        slip,
        stick: found.stick,
        duality_gap: found.duality_gap,
        load_error: found.load_error,
        iterations: [found.iterations, found.steps],
        status: found.status,
    }
}

/// A force that differs from the largest one by less than this share counts as the largest one.
const FORCE_ROUNDING: f64 = 1e-9;

/// The sum of the lengths of the changes from one field to another.
fn change(from: &[f64], to: &[f64]) -> f64 {
    from.iter().zip(to).fold(0.0, |sum, (from, to)| sum + (to - from).abs())
}

/// The sum of the lengths of slips, weighted by the limits.
fn weighted(limit: &[f64], slip: &[f64]) -> f64 {
    let (x, y) = slip.split_at(limit.len());
    limit.iter().zip(x.iter().zip(y)).fold(0.0, |sum, (b, (x, y))| sum + b * x.hypot(*y))
}

/// Vectors on one set carried to another.
fn carried(cells: &CellSet, from: &CellSet, v: &[f64]) -> Vec<f64> {
    let mut carried = Vec::with_capacity(2 * cells.len());
    if from.is_empty() {
        carried.resize(2 * cells.len(), 0.0);
    } else {
        v.chunks_exact(from.len()).for_each(|v| carried.extend(cells.carry(from, v)));
    }
    carried
}
