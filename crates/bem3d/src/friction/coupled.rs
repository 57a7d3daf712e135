//! Coupled normal and tangential contact: tangential tractions cause normal displacements and pressures
//! tangential ones.

use super::increment::FrictionLimits;
use super::state::{
    FrictionLoad, FrictionSolver, FrictionState, NotAdvanced, PressedCells, SlipMemory, SlipStep,
};
use crate::active_set::{
    self, Candidates, ContactGap, Continuation, Control, Guess, Limits, Problem, Residuals, Solved,
};
use contact_model::{Interrupted, Status, Stop};
use std::sync::Arc;

/// Rounds at most.
const ROUNDS: usize = 60;
/// Number of rounds without progress of the normal displacements after which the alternation counts as not
/// contracting.
const PATIENCE: usize = 4;

/// A pair of states, certified together.
#[derive(Debug)]
pub struct CoupledState {
    /// The pressure, in contact on the surface that the tractions deform.
    pub normal: Solved,
    /// The tractions.
    pub tangential: FrictionState,
    /// Number of rounds of the alternation.
    pub rounds: usize,
    /// Factor by which the last round reduced the change of the normal displacements; above 1 the alternation
    /// does not contract. `None` after a single round.
    pub contraction: Option<f64>,
}

impl CoupledState {
    /// How it ended: converged where both states are converged, each with the other one.
    pub fn status(&self) -> Status {
        if self.normal.status == Status::Converged { self.tangential.status } else { self.normal.status }
    }
}

/// The loads and the accuracy of an increment of both loads.
#[derive(Debug, Clone, Copy)]
pub struct CoupledLoad {
    /// The normal load at its end.
    pub normal: Control,
    /// The tangential load at its end.
    pub tangential: FrictionLoad,
    /// Accuracy of the pressure.
    pub normal_limits: Limits,
    /// Accuracy of the tractions.
    pub tangential_limits: FrictionLimits,
}

/// A surface whose gaps change with the tractions on it.
#[derive(Debug)]
pub struct CoupledSurface<'a> {
    /// The normal problem, on the surface that tractions deform.
    pub problem: &'a mut Problem,
    /// The gaps without tractions.
    pub undeformed: &'a [f64],
    /// The tangential problem.
    pub friction: &'a mut FrictionSolver,
}

/// Where the search for a pair of states begins.
#[derive(Debug, Default)]
pub struct CoupledGuess {
    /// The pressure; `None`: unknown.
    pub pressure: Option<Guess>,
    /// Tractions that are nearer than those before; `None`: those before.
    pub tractions: Option<SlipMemory>,
}

/// The state at the end of an increment, from the state before.
///
/// Alternates: the pressure on the surface that the last tractions deform, the tractions with the tangential
/// displacement of that pressure. It ends when the gap of the pressure with the normal displacement of the
/// last tractions, evaluated exactly, meets its tolerance: the certificates are those of one pair. Each round
/// multiplies the error by about `beta mu`. For a large product the solution need not be unique, and an
/// alternation that no longer converges is [`Status::Stagnated`].
///
/// The problem is left with the gaps that the tractions deform.
///
/// # Errors
/// As [`FrictionSolver::advance`].
pub fn advance(
    surface: CoupledSurface<'_>,
    before: &SlipMemory,
    load: CoupledLoad,
    start: CoupledGuess,
    stop: Stop<'_>,
) -> Result<CoupledState, NotAdvanced> {
    let CoupledSurface { problem, undeformed: z, friction } = surface;
    let CoupledGuess { pressure: mut guess, mut tractions } = start;
    let CoupledLoad { normal: control, tangential, normal_limits, tangential_limits } = load;
    let from = tractions.as_ref().unwrap_or(before);
    let mut raised = friction.normal_displacement(from, stop)?.unwrap_or_else(|| vec![0.0; z.len()]);
    deform(problem, z, &raised);
    let (mut last, mut contraction, mut idle, mut rounds) = (f64::INFINITY, None, 0, 0);
    loop {
        rounds += 1;
        let from = match guess.take() {
            Some(guess) => guess,
            None => active_set::cold_start(problem, control, normal_limits, stop)?,
        };
        let mut normal = active_set::solve(problem, control, from, normal_limits, stop)?;
        let contact = PressedCells { cells: &normal.contact, pressure: &normal.p };
        let start = tractions.as_ref().map(|last| (&last.cells, &last.traction[..]));
        let state = friction.advance(
            SlipStep { before, contact, load: tangential, guess: start, relaxes: false },
            tangential_limits,
            stop,
        )?;
        let next = friction.normal_displacement(&state.memory, stop)?.unwrap_or_else(|| vec![0.0; z.len()]);
        let far = next.iter().zip(&raised).fold(0.0, |far: f64, (a, b)| far.max((a - b).abs()));
        deform(problem, z, &next);
        measure(problem, &mut normal, load, (&next, &raised), stop)?;
        if rounds > 1 {
            contraction = Some(far / last);
        }
        idle = if far < 0.9 * last { 0 } else { idle + 1 };
        last = far;
        let met = normal.residuals.worst() <= normal_limits.tolerance;
        let whole = normal.status == Status::Converged && state.status == Status::Converged;
        let gives_up = idle > PATIENCE || rounds >= ROUNDS || !whole || stop.stops();
        if met || gives_up {
            if !met && normal.status == Status::Converged {
                normal.status = if stop.stops() { Status::Stopped } else { Status::Stagnated };
            }
            return Ok(CoupledState { normal, tangential: state, rounds, contraction });
        }
        guess = Some(Guess { set: normal.contact, p: normal.p, d: normal.d });
        (tractions, raised) = (Some(state.memory), next);
    }
}

/// Gives the problem the surface that tractions raise by this displacement.
fn deform(problem: &mut Problem, z: &[f64], raised: &[f64]) {
    let deformed = z.iter().zip(raised).map(|(z, raised)| z + raised).collect();
    problem.candidates = Candidates::new(problem.grid(), Arc::new(deformed));
    problem.coarser = None;
}

/// Measures the residuals of a pressure with the normal displacement `next` of other tractions than it was found
/// with, whose displacement is `raised`, on every cell that may touch the surface that these deform.
fn measure(
    problem: &mut Problem,
    solved: &mut Solved,
    load: CoupledLoad,
    (next, raised): (&[f64], &[f64]),
    stop: Stop<'_>,
) -> Result<(), Interrupted> {
    let (grid, bounds) = (problem.grid(), problem.bounds);
    let Continuation { checked, gap, reach } = &mut solved.continuation;
    // First u + z.
    for (i, gap) in checked.index(grid).zip(&mut *gap) {
        *gap += next[i] - raised[i] + solved.d;
    }
    if load.normal.force().is_some() {
        let left = solved.contact.carry(checked, gap);
        solved.d = bounds.approach(&solved.p, &left, gap).unwrap_or(solved.d);
    }
    let d = solved.d;
    let others = problem.candidates.below(d).without(checked);
    if !others.is_empty() {
        let mut u = Vec::new();
        problem.operators.exact(&solved.contact, &solved.p, &others, &mut u, stop)?;
        problem.candidates.add_to(&others, &mut u);
        let all = checked.union(&others);
        let mut whole = all.carry(checked, gap);
        all.add_carried(&others, &u, &mut whole);
        (*checked, *gap) = (all, whole);
    }
    *reach = d;
    for gap in &mut *gap {
        *gap -= d;
    }
    let left = solved.contact.carry(checked, gap);
    let height = load.normal_limits.height.unwrap_or(d);
    let under = ContactGap { contact: &solved.contact, left: &left, checked, gap };
    solved.residuals = Residuals::measure(bounds, &solved.p, under, height);
    Ok(())
}
