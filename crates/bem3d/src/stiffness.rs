//! The incremental stiffness on a given contact set: one linear solve with two-sided bounds.

use crate::active_set::{Bounds, Problem, Solved};
use crate::geometry::CellSet;
use crate::kernel::NormalTable;
use crate::linear::{Energy, Fixed, StoppingCriteria};
use crate::operator::{Conditioning, Recipe};
use crate::parts::Part;
use crate::real::{dot, each, sum, update};
use contact_model::Stop;
use std::borrow::Cow;

/// Nondimensional stiffness with its error estimates.
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// Ritz value of `1' G^-1 1`.
    pub value: f64,
    /// Estimated relative error of the linear solve on the given set.
    pub solve_error: f64,
    /// Estimated relative error from cells that may be on the wrong side of the set.
    pub set_error: f64,
    /// `G q = 1` on the cells that respond.
    pub q: Vec<f64>,
    /// Conjugate gradient steps.
    pub steps: usize,
}

impl Stiffness {
    fn unknown() -> Self {
        Self { value: 0.0, solve_error: f64::INFINITY, set_error: 0.0, q: Vec::new(), steps: 0 }
    }

    /// Estimated relative error, both parts.
    pub fn error(&self) -> f64 {
        self.solve_error + self.set_error
    }
}

/// The cells of a contact that follow a small change of the approach.
#[derive(Debug, Clone)]
pub struct Responding<'a> {
    /// The cells.
    pub cells: Cow<'a, CellSet>,
    /// The bounds at which their pressure would no longer follow.
    pub bounds: Bounds,
    /// Cells that cannot be on the wrong side of the set, whatever their residual gap: those at the upper
    /// bound where the whole contact is fixed, and those at the bound without a gap where the direction of
    /// the load decides.
    pub decided: CellSet,
}

impl<'a> Responding<'a> {
    /// The free cells.
    pub fn free(state: &'a Solved, bounds: Bounds) -> Self {
        Self { cells: bounds.free(&state.contact, &state.p), bounds, decided: CellSet::default() }
    }

    /// The whole contact with a fixed set of cells, without the upper bound.
    pub fn whole(state: &'a Solved, bounds: Bounds) -> Self {
        let decided = state.contact.without(&bounds.free(&state.contact, &state.p));
        Self { cells: Cow::Borrowed(&state.contact), bounds: Bounds::Unlimited, decided }
    }
}

/// Solves `G q = 1` on the cells that respond until the relative error of k is estimated below half of
/// `tolerance`.
///
/// For any q with residual `r = 1 - G q` the true k lies between the Ritz value `(1'q)^2 / (q'Gq)` and
/// `1'q + r'q + r'G^-1 r`; both errors are quadratic in that of q. `guess` may be the q of a similar set;
/// that of a factored state is exact up to rounding. The energy of a residual is the first thing that
/// conjugate gradients find, so that the check of one correction is the beginning of the next.
///
/// Cost: about 10 applications of G for a relative error of 1e-4.
pub fn solve(
    problem: &mut Problem,
    state: &Solved,
    responding: &Responding<'_>,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    stop: Stop<'_>,
) -> Stiffness {
    let grid = problem.grid();
    let Problem { operators, workspace, .. } = problem;
    let (contact, tuning) = (&*responding.cells, *operators.tuning());
    // The q of a factored state is that of its whole contact.
    let factored = state.q.as_ref().filter(|q| q.len() == contact.len());
    if contact.is_empty() && !state.contact.is_empty() {
        return Stiffness { solve_error: 0.0, ..Stiffness::unknown() };
    }
    let Some(recipe) = operators.planner().system(contact, contact.len(), true) else {
        return Stiffness::unknown();
    };
    // A factored state needs no transform.
    let conditioning = if factored.is_some() { Conditioning::Identity } else { recipe.conditioning };
    let recipe = Recipe { conditioning, ..recipe };
    let mut left = state.gap_on(contact);
    if !responding.decided.is_empty() {
        let known = contact.carry(&responding.decided, &vec![true; responding.decided.len()]);
        left.iter_mut().zip(known).filter(|(_, known)| *known).for_each(|(left, _)| *left = 0.0);
    }
    let mut room = state.room(contact, responding.bounds).into_owned();
    let recorder = operators.recorder().clone();
    let mut undecided = recorder.timed(Part::Sets, || state.undecided(grid, contact, &left, &tuning));
    if !responding.decided.is_empty() {
        undecided = undecided.without(&responding.decided);
        contact.add_carried(&responding.decided, &vec![f64::INFINITY; responding.decided.len()], &mut room);
    }
    let targets = contact.union(&undecided);
    let mut started = false;
    let mut q = guess.or_else(|| factored.cloned());
    let (mut r, mut v) = (vec![1.0; contact.len()], Vec::new());
    let mut best = Stiffness::unknown();
    let (mut steps, mut unimproved) = (0, 0);
    for round in 0..tuning.stiffness_rounds {
        // A guess will be corrected.
        let rough = round == 0 && factored.is_none() && {
            let error = operators.roughness(contact, &targets);
            error > 0.0 && tolerance >= tuning.stiffness_single * error.powi(2)
        };
        if let Some(q) = &q {
            if rough {
                operators.rough(contact, q, &targets, &mut v);
            } else {
                operators.exact(contact, q, &targets, &mut v);
            }
            recorder.timed(Part::Sets, || contact.carry_to(&targets, &v, &mut r));
            each(&mut r, |r| *r = 1.0 - *r);
        }
        let (total, rq) = q.as_ref().map_or((0.0, 0.0), |q| (sum(q), dot(&r, q)));
        if !std::mem::replace(&mut started, true) {
            workspace.take(operators, contact.clone(), recipe);
        }
        let last = round + 1 == tuning.stiffness_rounds || unimproved > 2;
        let criteria = StoppingCriteria {
            reduction: tuning.stiffness_reduction,
            energy: Some(Energy { share: tuning.stiffness_aim * tolerance, base: total + rq }),
            floor: 0.0,
            steps: if last { 0 } else { tuning.stiffness_steps },
        };
        let outcome = workspace.solve(operators, &mut r, Fixed::Approach, criteria, stop);
        let Some(q) = &mut q else {
            steps += outcome.steps;
            q = Some(r.clone());
            continue;
        };
        let (ritz, error) = bounds(total, rq, outcome.energy);
        if !rough {
            unimproved = if error < 0.9 * best.solve_error { 0 } else { unimproved + 1 };
        }
        if error < best.solve_error && !rough {
            let at_undecided = undecided.carry(&targets, &v);
            let set_error = set_error(operators.table(), &room, &left, &at_undecided, q) / ritz;
            best = Stiffness { value: ritz, solve_error: error, set_error, q: q.clone(), steps };
        }
        if !rough && (error <= tuning.stiffness_share * tolerance || last || stop.stops()) {
            break;
        }
        steps += outcome.steps;
        update(q, &r, |q, x| *q += x);
    }
    Stiffness { steps, ..best }
}

/// Ritz value and relative width of the bounds from `1'q`, `r'q` and the energy `r' G^-1 r`.
fn bounds(sum: f64, rq: f64, energy: f64) -> (f64, f64) {
    let ritz = sum * sum / (sum - rq);
    (ritz, (sum + rq + energy - ritz).max(0.0) / ritz)
}

/// Change of k if the undecided cells changed sides.
///
/// Adding cell j adds `(1 - (Gq)_j)^2 / S_j` with a Schur complement S_j not below the smallest eigenvalue;
/// removing one takes away `q_j^2 / (G^-1)_jj`, at most `q_j^2 G_jj`. Undecided are the cells of
/// [`Solved::undecided`] and those whose pressure is nearer to its bounds (`room`) than what their own
/// residual gap can change. `tests/stiffness_error.rs` compares the sum of both parts with true errors.
fn set_error(table: &NormalTable, room: &[f64], left: &[f64], at_undecided: &[f64], q: &[f64]) -> f64 {
    let smallest = table.smallest_eigenvalue();
    let added: f64 = at_undecided.iter().map(|v| (1.0 - v).powi(2)).sum::<f64>() / smallest;
    let doubtful = room.iter().zip(q).zip(left).filter(|&((p, _), gap)| *p < gap.abs() / smallest);
    let removed: f64 = doubtful.map(|((_, q), _)| q * q).sum::<f64>() * table.own();
    added + removed
}

#[cfg(test)]
mod tests;
