//! The outer iteration: solve on a superset of the contact set, remove cells in tension, add penetrating cells.

use super::progress::{Decision, Evaluated, OuterProgress, criteria};
use super::residuals::Residuals;
use super::state::{Continuation, Guess, Limits, Problem, Solved, Target};
use crate::geometry::CellSet;
use crate::linear::Factor;
use crate::parts::{Part, timed};
use crate::real::{each, largest, smallest, sum, sum_of_pairs};
use contact_model::{Status, Stop};

/// Solves for one load from a guess.
///
/// At fixed force, solving on a superset of the contact set and removing the cells in tension never removes a true contact cell
/// where G restricted to the set is an inverse M-matrix, which it was on every set tried: bilateral contact on a superset needs a larger
/// approach than the true one, and every removal lowers it. Rounding and early stops can break this, so each outer iteration evaluates
/// the exact gap on all candidates and adds the cells that penetrate.
///
/// Cost: 20 to 60 applications of G for four digits, a few factorisations for a small set.
pub fn solve(problem: &mut Problem, target: Target, guess: Guess, limits: Limits, stop: Stop<'_>) -> Solved {
    let Guess { set, p, d, far } = guess;
    let reach = match target {
        Target::Force(_) => d,
        Target::Approach(asked) => asked,
    };
    let now = Pressure { contact: set, p, d, q: None };
    let solver = Solver::new(problem, target, limits, now, Continuation { reach, ..Continuation::default() });
    solver.iterate(None, far, stop)
}

/// Goes on from a solved state to a tighter tolerance; its gap is not evaluated again.
pub fn resume(
    problem: &mut Problem,
    target: Target,
    solved: Solved,
    limits: Limits,
    stop: Stop<'_>,
) -> Solved {
    let Solved { contact, p, d, q, residuals, continuation, .. } = solved;
    let evaluated = Evaluated { residuals, complete: true, factored: q.is_some() };
    let solver = Solver::new(problem, target, limits, Pressure { contact, p, d, q }, continuation);
    solver.iterate(Some(evaluated), false, stop)
}

/// A pressure on its way to a solution.
#[derive(Debug, Clone, Default)]
struct Pressure {
    contact: CellSet,
    p: Vec<f64>,
    d: f64,
    /// Where the set was factored; then p and d are exact on it.
    q: Option<Vec<f64>>,
}

struct Solver<'a> {
    problem: &'a mut Problem,
    target: Target,
    limits: Limits,
    now: Pressure,
    /// The gap of the present pressure.
    state: Continuation,
    /// The gap left on its contact set.
    left: Vec<f64>,
    /// Candidates are wanted up to this approach.
    reach: f64,
    /// The best pressure so far, unless it is the present one.
    best: Pressure,
    now_is_best: bool,
}

impl<'a> Solver<'a> {
    fn new(
        problem: &'a mut Problem,
        target: Target,
        limits: Limits,
        now: Pressure,
        state: Continuation,
    ) -> Self {
        problem.workspace.begin_load();
        let left = now.contact.carry(&state.checked, &state.gap);
        let (reach, best) = (state.reach, Pressure::default());
        Self { problem, target, limits, now, state, left, reach, best, now_is_best: false }
    }

    fn iterate(mut self, mut known: Option<Evaluated>, rough: bool, stop: Stop<'_>) -> Solved {
        let tuning = *self.problem.operators.tuning();
        let mut progress = OuterProgress::new(self.limits, rough);
        let (mut steps, tolerance) = (0, self.limits.tolerance);
        let (status, last) = loop {
            let mut evaluate = |rough| timed(Part::Residuals, || self.evaluate(rough));
            let mut evaluated = known.take().unwrap_or_else(|| evaluate(progress.rough));
            if progress.rough && evaluated.residuals.worst() <= tolerance {
                evaluated = evaluate(false); // Better than expected.
            }
            match progress.judge(evaluated, self.now.d, &tuning, stop) {
                Decision::End(status) => break (status, evaluated),
                Decision::Continue { best } => self.now_is_best |= best,
            }
            steps += self.improve(evaluated.residuals.worst(), stop);
        };
        let mut residuals = last.residuals;
        if status != Status::Converged && !self.now_is_best && progress.best <= residuals.worst() {
            self.now = std::mem::take(&mut self.best);
            (self.state, self.reach) = (Continuation::default(), tuning.candidates * self.now.d);
            residuals = self.evaluate(false).residuals;
        } else if !last.complete {
            // What is returned carries residuals of double precision on every candidate, converged or not.
            residuals = self.evaluate(false).residuals;
        }
        let Self { now: Pressure { contact, p, d, q }, state: continuation, .. } = self;
        Solved { contact, p, d, q, residuals, steps, status, continuation }
    }

    /// Evaluates the gap under the present pressure, and at a prescribed force finds the approach that it makes.
    ///
    /// A `rough` evaluation in single precision says how to go on, but is never evidence.
    fn evaluate(&mut self, rough: bool) -> Evaluated {
        let Self { problem, target, limits, now, state, left, reach, .. } = self;
        let Problem { candidates, operators, .. } = &mut **problem;
        let tuning = *operators.tuning();
        if let Target::Force(force) = *target {
            rescale(&mut now.p, force);
        }
        // Later contact sets are subsets of the candidates that the first one is joined to.
        if state.checked.is_empty() || !(tuning.kept_candidates * state.reach..=state.reach).contains(reach) {
            state.reach = *reach;
            state.checked = candidates.below(*reach).union(&now.contact);
        }
        let Continuation { checked, gap, .. } = state;
        if rough {
            operators.rough(&now.contact, &now.p, checked, gap);
        } else {
            operators.exact(&now.contact, &now.p, checked, gap);
        }
        candidates.add_to(checked, gap);
        now.contact.carry_to(checked, gap, left);
        let force = sum(&now.p);
        match *target {
            // The mean weighted by the pressure: the gap is then right where it carries.
            Target::Force(_) if now.q.is_none() && force > 0.0 => {
                now.d = sum_of_pairs(&now.p, left, |p, g| p / force * g);
            }
            Target::Force(_) => {}
            Target::Approach(asked) => now.d = asked,
        }
        let d = now.d;
        for values in [&mut *gap, &mut *left] {
            each(values, |g| *g -= d);
        }
        // Just above the plane: a generous guess must not make every outer iteration evaluate the whole grid.
        *reach = tuning.candidates * now.d;
        let residuals = Residuals::measure(&now.p, left, smallest(gap), limits.height.unwrap_or(now.d));
        Evaluated { residuals, complete: !rough && now.d <= state.reach, factored: now.q.is_some() }
    }

    /// One outer iteration: a new set from the gap, a solution on it, and the cells in tension removed. Returns the steps taken.
    fn improve(&mut self, error: f64, stop: Stop<'_>) -> usize {
        let Self { problem, target, limits, now, state, left, .. } = self;
        let tuning = *problem.operators.tuning();
        let Continuation { checked, gap, .. } = &*state;
        let noise = tuning.noise * root_mean_square(left);
        let set = checked.filter(gap, |g| g < -noise).union(&now.contact);
        let planner = problem.operators.planner();
        let Some(recipe) = planner.system(&set, now.contact.len(), false) else { return 0 };
        if limits.factor
            && planner.factors(set.len(), recipe.window)
            && let Some(exact) = eliminate(problem, &set, *target)
        {
            self.reach = tuning.candidates * exact.d;
            self.advance(exact);
            return 0;
        }
        let mut change = set.carry(checked, gap);
        each(&mut change, |value| *value = -*value);
        let criteria = criteria(*limits, error, now.d, &tuning);
        let Problem { operators, workspace, .. } = &mut **problem;
        workspace.take(operators, set, recipe);
        let fixed_sum = matches!(target, Target::Force(_));
        let outcome = workspace.solve(operators, &mut change, fixed_sum, criteria, stop);
        let set = workspace.set();
        set.add_carried(&now.contact, &now.p, &mut change);
        let contact = set.filter(&change, |p| p > 0.0);
        change.retain(|&p| p > 0.0);
        let d = now.d;
        self.advance(Pressure { contact, p: change, d, q: None });
        outcome.steps
    }

    /// Replaces the present pressure; it is kept where it is the best.
    fn advance(&mut self, next: Pressure) {
        let last = std::mem::replace(&mut self.now, next);
        if std::mem::take(&mut self.now_is_best) {
            self.best = last;
        }
    }
}

/// Removes cells in tension from a small superset until none is left; p, q and d are exact up to rounding.
fn eliminate(problem: &mut Problem, superset: &CellSet, target: Target) -> Option<Pressure> {
    let mut set = superset.clone();
    loop {
        let z = problem.candidates.gaps(&set);
        problem.operators.solves += 1;
        let factored = || Some(Factor::new(problem.operators.table(), &set)?.solve_pair(&z));
        let (q, w) = timed(Part::Factor, factored)?;
        let d = match target {
            Target::Force(force) => (force + w.iter().sum::<f64>()) / q.iter().sum::<f64>(),
            Target::Approach(d) => d,
        };
        let p: Vec<f64> = q.iter().zip(&w).map(|(q, w)| d * q - w).collect();
        let contact = set.filter(&p, |p| p > 0.0);
        if contact.len() == set.len() {
            return Some(Pressure { contact: set, p, d, q: Some(q) });
        }
        if contact.is_empty() {
            return None;
        }
        set = contact;
    }
}

/// Root mean square without overflow or underflow on the way.
fn root_mean_square(values: &[f64]) -> f64 {
    let unit = largest(values);
    if unit <= 0.0 {
        return 0.0;
    }
    let square = sum_of_pairs(values, values, |v, _| (v / unit).powi(2));
    unit * (square / values.len() as f64).sqrt()
}

/// Brings a pressure to a force.
fn rescale(p: &mut [f64], force: f64) {
    let sum = sum(p);
    if sum > 0.0 {
        let factor = force / sum;
        each(p, |p| *p *= factor);
    }
}

#[cfg(test)]
mod tests;
