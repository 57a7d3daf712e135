//! The stiffness of the tangential force on a branch of friction, or with every cell stuck.

use super::{Conditions, Goal, Stiffness, StiffnessCorrection, TangentialStiffness, refine};
use crate::friction::{FrictionRoom, FrictionSolver, FrictionState, SlipBranch, exact};
use crate::geometry::CellSet;
use crate::law::total;
use crate::linear::{Energy, StoppingCriteria, TORUS_ENERGY};
use crate::operator::TangentialOperators;
use crate::real::{dot, largest};
use contact_model::{Interrupted, Stop};

/// Which cells may slip in the state whose stiffness is requested.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StiffnessOf {
    /// The branch as the load goes on: stick cells, and slip cells in the directions in which they may move.
    Branch,
    /// The whole contact: what the branch begins with after a reversal.
    FullStick,
}

/// Weakest reduction of the residual that a correction aims at.
const LEAST_REDUCTION: f64 = 0.3;

/// A slip cell of which the direction of the traction and of the slip are not known exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
struct UncertainCell {
    /// Its position.
    cell: usize,
    /// Direction of its traction.
    radial: [f64; 2],
    /// Bound on the error of the slip over the limit of the traction.
    turning: f64,
}

/// A cell of which it is not known whether it sticks.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Undecided {
    /// Its position.
    cell: usize,
    /// Direction of its traction.
    radial: [f64; 2],
    /// Whether it counts as a stick cell.
    sticks: bool,
}

/// The linearised conditions of the cells that stick and slip (`friction::linearised`); B are the unit displacements as far
/// as cells may follow them.
///
/// The energy of a residual is bounded by the inverse on a torus of all cells: A is at least the kernel on the
/// tractions that the branch admits, whatever the slip cells do.
struct OnBranch<'a> {
    operators: &'a mut TangentialOperators,
    room: &'a mut FrictionRoom,
    cells: &'a CellSet,
    /// The admissible changes of each cell.
    branch: &'a SlipBranch,
    /// Cells that may be on the other side of stick and slip.
    undecided: Vec<Undecided>,
    /// Slip cells whose direction and turning `|w|/b` are not known exactly.
    uncertain: Vec<UncertainCell>,
    /// Displacements under X.
    displaced: [Vec<f64>; 2],
    stop: Stop<'a>,
}

impl Conditions<2, 3> for OnBranch<'_> {
    fn displacements(&self) -> [Vec<f64>; 2] {
        let n = self.cells.len();
        std::array::from_fn(|component| {
            let mut ones = vec![0.0; 2 * n];
            ones[component * n..][..n].fill(1.0);
            self.branch.restrict_f64(&mut ones);
            ones
        })
    }

    fn forces(&self, x: &[f64]) -> [f64; 2] {
        total(x)
    }

    fn residual(&mut self, x: &[Vec<f64>; 2], _: bool, r: &mut [Vec<f64>; 2]) -> Result<bool, Interrupted> {
        let right = self.displacements();
        let Self { operators, cells, branch, displaced, stop, .. } = self;
        for ((x, right), (r, u)) in x.iter().zip(&right).zip(r.iter_mut().zip(displaced)) {
            exact(operators, (cells, x), cells, u, *stop)?;
            r.clone_from(u);
            branch.restrict_f64(r);
            branch.add_turning(x, r, 1.0);
            r.iter_mut().zip(right).for_each(|(r, right)| *r = right - *r);
        }
        Ok(true)
    }

    fn correct(
        &mut self,
        r: &mut [Vec<f64>; 2],
        goal: Goal<2>,
    ) -> Result<Option<StiffnessCorrection<3>>, Interrupted> {
        let energy = self.energy(r)?;
        let is_enough = (0..2).all(|i| energy[i] < goal.enough * goal.bases[i]);
        if goal.only_energy || is_enough {
            return Ok(Some(StiffnessCorrection { energy, steps: None }));
        }
        let tuning = *self.operators.tuning();
        let mut steps = 0;
        for (i, r) in r.iter_mut().enumerate() {
            // What the checked energy has to fall by; before there is a stiffness, by the preconditioner's own.
            let base = goal.bases[i];
            let (reduction, energy) = if base > 0.0 {
                let fall = (goal.share * base / energy[i]).sqrt();
                (fall.clamp(tuning.stiffness_reduction, LEAST_REDUCTION), None)
            } else {
                (tuning.stiffness_reduction, Some(Energy { share: goal.share, base }))
            };
            let criteria = StoppingCriteria { reduction, energy, floor: 0.0, steps: tuning.stiffness_steps };
            steps += self.solve(r, criteria)?;
        }
        Ok(Some(StiffnessCorrection { energy, steps: Some(steps) }))
    }

    /// Of both directions together.
    ///
    /// An undecided slip cell that sticks adds at most `(e - K x)_e^2 / s` with the smallest eigenvalue s, where e is
    /// the direction of its traction; a stick cell that slips takes away at most `x_e^2` times its own compliance. To
    /// first order a change h of `|w|/b` of a slip cell takes away `x^2 h`, and a turn of its tangent adds
    /// `2 x (e - K x)_e` times the angle, which is estimated as h over s.
    fn set_error(&self, x: &[Vec<f64>; 2]) -> f64 {
        let table = self.operators.table();
        let (own, smallest, n) = (table.own(), table.smallest_eigenvalue(), self.cells.len());
        let along = |v: &[f64], i: usize, e: [f64; 2]| v[i] * e[0] + v[n + i] * e[1];
        let held_back = |k: usize, i: usize, e: [f64; 2]| e[k] - along(&self.displaced[k], i, e);
        let undecided = self.undecided.iter().map(|&Undecided { cell, radial, sticks }| -> f64 {
            let terms = (0..2).map(|k| {
                if sticks {
                    along(&x[k], cell, radial).powi(2) * own
                } else {
                    held_back(k, cell, radial).powi(2) / smallest
                }
            });
            terms.sum()
        });
        let uncertain = self.uncertain.iter().map(|&UncertainCell { cell, radial, turning }| -> f64 {
            let terms = (0..2).map(|k| {
                let moved = x[k][cell].hypot(x[k][n + cell]);
                turning * moved * (moved + 2.0 * held_back(k, cell, radial).abs() / smallest)
            });
            terms.sum()
        });
        undecided.chain(uncertain).fold(0.0, |sum, change| sum + change)
    }
}

impl OnBranch<'_> {
    /// Solves `A x = r` roughly and writes x over r; returns the steps.
    fn solve(&mut self, r: &mut [f64], criteria: StoppingCriteria) -> Result<usize, Interrupted> {
        let Self { operators, room, branch, stop, .. } = self;
        operators.solves += 1;
        let Some(mut system) = room.system(operators, branch, true, *stop)? else { return Ok(0) };
        let outcome = system.solve(r, criteria, *stop)?;
        operators.applications += outcome.applications;
        Ok(outcome.steps)
    }

    /// `R' A^-1 R`, estimated from above.
    fn energy(&mut self, residuals: &[Vec<f64>; 2]) -> Result<[f64; 3], Interrupted> {
        let Self { operators, room, branch, stop, .. } = self;
        let size = largest(&residuals[0]).max(largest(&residuals[1]));
        if size <= 0.0 {
            return Ok([0.0; 3]);
        }
        let mut r = residuals.each_ref().map(|r| r.iter().map(|r| (r / size) as f32).collect::<Vec<f32>>());
        let Some(z) = room.stuck_inverse(operators, branch, &mut r, *stop)? else { return Ok([0.0; 3]) };
        let factor = TORUS_ENERGY * size * size;
        Ok([(0, 0), (1, 1), (0, 1)].map(|(i, j)| factor * dot(&r[i], &z[j])))
    }
}

/// `dT/d(delta)` of a state, to about `tolerance` relative to its larger eigenvalue.
///
/// # Errors
/// [`Interrupted`] by the stop.
///
/// Cost: about 20 applications for 1e-4.
pub fn solve(
    friction: &mut FrictionSolver,
    state: &FrictionState,
    of: StiffnessOf,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<TangentialStiffness, Interrupted> {
    let FrictionSolver { operators, room, .. } = friction;
    let cells = &state.memory.cells;
    if cells.is_empty() {
        return Ok(Stiffness::nothing());
    }
    let (branch, (undecided, uncertain)) = match of {
        StiffnessOf::FullStick => (SlipBranch::stuck(cells), (Vec::new(), Vec::new())),
        StiffnessOf::Branch => {
            let branch = state.branch(operators);
            let unknown = unknown(state, &branch, operators.table().smallest_eigenvalue());
            (branch, unknown)
        }
    };
    room.take(cells);
    let tuning = *operators.tuning();
    let displaced = [Vec::new(), Vec::new()];
    let mut conditions =
        OnBranch { operators, room, cells, branch: &branch, undecided, uncertain, displaced, stop };
    let found = refine(&mut conditions, None, tolerance, &tuning, stop)?;
    // No later solve begins with the tractions, which are as large as the state.
    Ok(Stiffness { change: [Vec::new(), Vec::new()], ..found })
}

/// First the cells for which stick or slip is undecided: stick cells that the residual slip could bring to
/// their limit, and slip cells whose slip is no larger than the residual one. Then the other slip cells,
/// whose slip is known to the residual slip.
fn unknown(
    state: &FrictionState,
    branch: &SlipBranch,
    smallest: f64,
) -> (Vec<Undecided>, Vec<UncertainCell>) {
    let (n, q, w) = (state.limit.len(), &state.memory.traction, &state.slip);
    let slipped = |i: usize| w[i].hypot(w[n + i]);
    let squares: f64 = (0..n).filter(|&i| !branch.slips(i)).map(|i| slipped(i).powi(2)).sum();
    let noise = (squares / state.stick.len().max(1) as f64).sqrt();
    let (mut undecided, mut uncertain) = (Vec::new(), Vec::new());
    for cell in 0..n {
        let (sticks, length, limit) = (!branch.slips(cell), q[cell].hypot(q[n + cell]), state.limit[cell]);
        let doubtful =
            if sticks { limit - length < noise.max(slipped(cell)) / smallest } else { slipped(cell) < noise };
        let radial = [q[cell] / length, q[n + cell] / length];
        if length > 0.0 && doubtful {
            undecided.push(Undecided { cell, radial, sticks });
        } else if length > 0.0 && !sticks {
            uncertain.push(UncertainCell { cell, radial, turning: noise / limit });
        }
    }
    (undecided, uncertain)
}
