//! The outer iteration: solve on a superset of the contact set, remove cells in tension, add penetrating
//! cells.

use super::bounds::Bounds;
use super::interior_point::{InteriorPressure, InteriorProblem};
use super::line_search::{StepStart, shorten};
use super::progress::{Decision, Evaluated, Look, OuterProgress, criteria};
use super::residuals::ContactGap;
use super::residuals::Residuals;
use super::state::{Continuation, Control, Guess, Limits, Problem, Solved};
use crate::geometry::CellSet;
use crate::law::{Descent, descend};
use crate::linear::{Factor, Fixed};
use crate::parts::{Part, Recorder};
use crate::real::{each, largest, sum_of_pairs, update};
use contact_model::{Interrupted, Status, Stop, never};

/// Solves for one load from a guess.
///
/// At fixed force, solving on a superset of the contact set and removing the cells in tension never removes a
/// true contact cell where G restricted to the set is an inverse M-matrix, which it was on every set tried:
/// bilateral contact on a superset needs a larger approach than the true one, and every removal lowers it.
/// Rounding and early stops can break this, so each outer iteration evaluates the exact gap on all candidates
/// and adds the cells that penetrate.
///
/// A solve that is stopped returns its last pressure, where the certificate of that is known or takes less than
/// [`CERTIFIED_NS`].
///
/// # Errors
/// [`Interrupted`] by the stop, where it does not.
///
/// Cost: 20 to 60 applications of G for a tolerance of 1e-4, or a few factorisations for a small set.
pub fn solve(
    problem: &mut Problem,
    target: Control,
    guess: Guess,
    limits: Limits,
    stop: Stop<'_>,
) -> Result<Solved, Interrupted> {
    let Guess { set, p, d } = guess;
    let reach = match target {
        Control::Force(_) => d,
        Control::Approach(asked) => asked,
    };
    let now = Pressure { contact: set, p, d, q: None };
    let solver = Solver::new(problem, target, limits, now, Continuation { reach, ..Continuation::default() });
    solver.iterate(None, stop)
}

/// Goes on from a solved state to a tighter tolerance; its gap is not evaluated again.
///
/// # Errors
/// As [`solve`].
pub fn resume(
    problem: &mut Problem,
    target: Control,
    solved: Solved,
    limits: Limits,
    stop: Stop<'_>,
) -> Result<Solved, Interrupted> {
    let Solved { contact, p, d, q, residuals, continuation, .. } = solved;
    let evaluated =
        Evaluated { residuals, complete: true, uncertainty: 0.0, factored: q.is_some(), step: None };
    let solver = Solver::new(problem, target, limits, Pressure { contact, p, d, q }, continuation);
    solver.iterate(Some(evaluated), stop)
}

/// Time of an application that a stop waits for, to certify the last pressure or to give its fields; by the cost
/// model, in ns. It is that of some 1000 cells a side.
pub const CERTIFIED_NS: f64 = 2e7;

/// A pressure on its way to a solution.
#[derive(Debug, Clone, Default)]
struct Pressure {
    contact: CellSet,
    p: Vec<f64>,
    d: f64,
    /// Where the set was factored; then p and d are exact on it.
    q: Option<Vec<f64>>,
}

/// Candidates found for one approach are also used for another one of at most this multiple of it, which is
/// less than the reserve with which they were chosen. Other values were not measured.
const KEPT_REACH: f64 = 1.02;

/// The share of the tolerance to which the interior-point method goes.
const INSIDE: f64 = 0.2;

struct Solver<'a> {
    problem: &'a mut Problem,
    target: Control,
    limits: Limits,
    now: Pressure,
    /// The gap of the present pressure.
    state: Continuation,
    /// The gap left on its contact set.
    left: Vec<f64>,
    /// Buffer for the displacement under a change of the pressure.
    displacement: Vec<f64>,
    /// Bound on the error of the gap: 0 in double precision.
    uncertainty: f64,
    /// The cells whose pressure has changed since the gap was evaluated, with the negative of their pressure
    /// at that time.
    measured: Option<(CellSet, Vec<f64>)>,
    /// Candidates are needed up to this approach.
    reach: f64,
    /// The best pressure so far, unless it is the present one.
    best: Pressure,
    now_is_best: bool,
    /// The pressure before with its gap, where cells were at their upper bound: steps from such a pressure
    /// may have to be shortened.
    before: Option<(Pressure, Continuation)>,
    /// Largest number of steps of the next inner solve: few after one that was shortened, because long ones
    /// change the sets too much at once.
    inner_steps: usize,
    /// The residuals of the present pressure, where they were measured in double precision on all candidates.
    certified: Option<Residuals>,
}

impl<'a> Solver<'a> {
    fn new(
        problem: &'a mut Problem,
        target: Control,
        limits: Limits,
        now: Pressure,
        state: Continuation,
    ) -> Self {
        problem.workspace.begin_load();
        let left = now.contact.carry(&state.checked, &state.gap);
        let (reach, best) = (state.reach, Pressure::default());
        Self {
            problem,
            target,
            limits,
            now,
            state,
            left,
            displacement: Vec::new(),
            uncertainty: 0.0,
            measured: None,
            reach,
            best,
            now_is_best: false,
            before: None,
            inner_steps: usize::MAX,
            certified: None,
        }
    }

    fn iterate(mut self, known: Option<Evaluated>, stop: Stop<'_>) -> Result<Solved, Interrupted> {
        let tuning = *self.problem.operators.tuning();
        let mut progress = OuterProgress::new(self.limits);
        let mut steps = 0;
        let (status, worst) = match self.improve_until_the_end(known, &mut progress, &mut steps, stop) {
            Ok(ended) => ended,
            Err(Interrupted) => {
                (Status::Stopped, self.certified.map_or(f64::INFINITY, |residuals| residuals.worst()))
            }
        };
        let soon = self.is_certified_soon();
        let best_is_better = !self.now_is_best && progress.best.is_finite() && progress.best <= worst;
        if status != Status::Converged && best_is_better && (soon || status != Status::Stopped) {
            self.now = std::mem::take(&mut self.best);
            (self.state, self.reach) = (Continuation::default(), tuning.candidates * self.now.d);
            self.certified = None;
        }
        // What is returned carries residuals of double precision on every candidate, converged or not.
        let residuals = match self.certified {
            Some(residuals) => residuals,
            None if soon => self.evaluate(Look::Exact, &never)?.residuals,
            None => self.evaluate(Look::Exact, stop)?.residuals,
        };
        let Self { now: Pressure { contact, p, d, q }, state: continuation, .. } = self;
        Ok(Solved { contact, p, d, q, residuals, steps, status, continuation })
    }

    /// Outer iterations until the present pressure has converged or a better one is not to be expected. Adds the
    /// steps taken, and returns the largest residual too, as it was evaluated last.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the present pressure is then one that obeys the bounds and the force.
    fn improve_until_the_end(
        &mut self,
        mut known: Option<Evaluated>,
        progress: &mut OuterProgress,
        steps: &mut usize,
        stop: Stop<'_>,
    ) -> Result<(Status, f64), Interrupted> {
        let (mut tuning, recorder) = (*self.problem.operators.tuning(), self.recorder());
        let tolerance = self.limits.tolerance;
        let bulges = self.problem.operators.table().kernel().may_bulge();
        if bulges {
            tuning.stalled = tuning.stalled_bulging;
        }
        // Once, and without an upper bound.
        let mut inside = bulges && self.problem.bounds == Bounds::Unlimited;
        loop {
            let mut evaluated = match known.take() {
                Some(known) => {
                    self.certified = Some(known.residuals);
                    known
                }
                None => recorder.timed(Part::Residuals, || self.evaluate(progress.look, stop))?,
            };
            let within = evaluated.residuals.worst() <= tolerance;
            if within && !evaluated.complete && (evaluated.uncertainty > 0.0 || evaluated.step.is_some()) {
                // Better than expected; the end of a step that was shortened has not been evaluated.
                evaluated = recorder.timed(Part::Residuals, || self.evaluate(Look::Exact, stop))?;
            }
            let fell_back = progress.falls_back();
            match progress.judge(evaluated, self.now.d, &tuning, stop) {
                Decision::End(status) => return Ok((status, evaluated.residuals.worst())),
                Decision::Continue { best } => self.now_is_best |= best,
            }
            if progress.falls_back() {
                if !fell_back {
                    // From the exact gap of a pressure that obeys the bounds and the force.
                    self.evaluate(Look::Exact, stop)?;
                }
                let found = if std::mem::take(&mut inside) { self.solve_inside(stop)? } else { None };
                *steps += match found {
                    Some(steps) => steps,
                    None => self.descend(stop)?,
                };
                continue;
            }
            let may_alternate = self.problem.bounds.is_reached(&self.now.p);
            self.before = may_alternate.then(|| (self.now.clone(), self.state.clone()));
            *steps += self.improve(evaluated.residuals.worst(), stop)?;
        }
    }

    /// Whether the exact gap of the present pressure is evaluated so fast that a stop may wait for it.
    fn is_certified_soon(&self) -> bool {
        let operators = &self.problem.operators;
        operators.plans.nanoseconds(operators.table().grid().window()) < CERTIFIED_NS
    }

    fn recorder(&self) -> Recorder {
        self.problem.operators.recorder().clone()
    }

    /// Evaluates the gap under the present pressure and, at a prescribed force, the approach that follows
    /// from it.
    ///
    /// A gap in single precision decides how to go on, but never certifies a state.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the gap is then undefined.
    fn evaluate(&mut self, look: Look, stop: Stop<'_>) -> Result<Evaluated, Interrupted> {
        self.certified = None;
        let Self { problem, target, now, .. } = self;
        let Problem { bounds, candidates, .. } = &**problem;
        let joined = bounds.admit(&mut now.contact, &mut now.p, target.force(), candidates);
        self.displace(joined, look, stop)?;
        let step = self.shorten();
        let Self { problem, target, limits, now, state, left, reach, uncertainty, .. } = self;
        let (bounds, tuning) = (problem.bounds, problem.operators.tuning());
        let Continuation { checked, gap, .. } = state;
        problem.operators.recorder().timed(Part::Sets, || now.contact.carry_to(checked, gap, left));
        match *target {
            Control::Approach(asked) => now.d = asked,
            // That of a factored set is exact.
            Control::Force(_) if now.q.is_some() => {}
            Control::Force(_) => now.d = bounds.approach(&now.p, left, gap).unwrap_or(now.d),
        }
        let d = now.d;
        for values in [&mut *gap, &mut *left] {
            each(values, |g| *g -= d);
        }
        // Just above the plane: a generous guess must not make every outer iteration evaluate the whole grid.
        *reach = tuning.candidates * d;
        let height = limits.height.unwrap_or(d);
        let under = ContactGap { contact: &now.contact, left, checked, gap };
        let evaluated = Evaluated {
            residuals: Residuals::measure(bounds, &now.p, under, height),
            complete: (limits.is_guess || *uncertainty <= 0.0) && step.is_none() && d <= state.reach,
            uncertainty: *uncertainty,
            factored: now.q.is_some(),
            step,
        };
        self.certified = evaluated.complete.then_some(evaluated.residuals);
        Ok(evaluated)
    }

    /// Evaluates u + z under the present pressure on all cells that could touch; `joined`: cells were added
    /// to the contact set that may not be among the candidates.
    ///
    /// In single precision only the change since the last gap is evaluated: the error is relative to what is
    /// transformed.
    fn displace(&mut self, joined: bool, look: Look, stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { problem, now, state, reach, measured, displacement, uncertainty, .. } = self;
        let Problem { candidates, operators, .. } = &mut **problem;
        let (kept, recorder) = (operators.tuning().kept_candidates, operators.recorder().clone());
        let mut before = measured.take();
        // Where the surface may rise beside a load, all cells are candidates.
        let reach = if operators.table().kernel().may_bulge() { f64::INFINITY } else { *reach };
        // Later contact sets are subsets of the candidates that the first one is joined to.
        recorder.timed(Part::Sets, || {
            if state.checked.is_empty() || !(kept * state.reach..=KEPT_REACH * state.reach).contains(&reach) {
                state.reach = reach;
                state.checked = candidates.below(reach).union(&now.contact);
                before = None;
            } else if joined {
                state.checked = state.checked.union(&now.contact);
                before = None;
            }
        });
        let Continuation { checked, gap, .. } = state;
        let exact = look == Look::Exact || (look == Look::Change && before.is_none());
        let cells = before.as_ref().map_or(&now.contact, |(cells, _)| cells);
        let error = if exact { 0.0 } else { operators.roughness(cells, checked) };
        if error <= 0.0 {
            operators.exact(&now.contact, &now.p, checked, gap, stop)?;
            *uncertainty = 0.0;
        } else if let Some((cells, mut change)) = before {
            recorder.timed(Part::Sets, || cells.add_carried(&now.contact, &now.p, &mut change));
            operators.rough(&cells, &change, checked, displacement, stop)?;
            // A pressure that changes its sign from cell to cell displaces little.
            let own = operators.table().own() * largest(&change);
            *uncertainty += error * own.max(largest(displacement));
            let d = now.d;
            update(gap, displacement, |gap, u| *gap += u + d);
            return Ok(());
        } else {
            operators.rough(&now.contact, &now.p, checked, gap, stop)?;
            *uncertainty = error * largest(gap);
        }
        recorder.timed(Part::Sets, || candidates.add_to(checked, gap));
        Ok(())
    }

    /// Shortens the step that led to the present pressure where it passed the minimum of the energy. Returns
    /// the share of the step that is kept in that case.
    fn shorten(&mut self) -> Option<f64> {
        let (before, at) = self.before.take()?;
        let Continuation { checked, gap, .. } = &mut self.state;
        if at.checked.len() != checked.len() {
            return None;
        }
        let tuning = *self.problem.operators.tuning();
        let pressure = at.checked.carry(&before.contact, &before.p);
        let start = StepStart { pressure: &pressure, gap: &at.gap, approach: before.d };
        let mut p = checked.carry(&self.now.contact, &self.now.p);
        let share = shorten(start, &mut p, gap, tuning.whole_step);
        self.inner_steps =
            if share.is_some() { tuning.short_steps } else { self.inner_steps.saturating_mul(2) };
        if share.is_some() {
            self.now.contact = checked.filter(&p, |p| p > 0.0);
            p.retain(|&p| p > 0.0);
            self.now.p = p;
        }
        share
    }

    /// One outer iteration: a new set from the gap, a solution on it, and the cells in tension removed.
    /// Returns the steps taken.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the present pressure is then as it was.
    fn improve(&mut self, error: f64, stop: Stop<'_>) -> Result<usize, Interrupted> {
        let recorder = self.recorder();
        let Self { problem, target, limits, now, state, left, measured, .. } = self;
        let (bounds, tuning) = (problem.bounds, *problem.operators.tuning());
        let Continuation { checked, gap, .. } = &*state;
        let noise = tuning.noise * root_mean_square(&bounds.of_free(&now.p, left));
        let (set, held) = recorder.timed(Part::Sets, || {
            let set = checked.filter(gap, |g| g < -noise).union(&now.contact);
            let held = bounds.held(&now.contact, &now.p, left, noise);
            (if held.is_empty() { set } else { set.without(&held) }, held)
        });
        let planner = problem.operators.planner();
        let Some(recipe) = planner.system(&set, now.contact.len(), false) else { return Ok(0) };
        if limits.factor
            && !bounds.is_reached(&now.p)
            && planner.factors(set.len(), recipe.window)
            && let Some(exact) = eliminate(problem, &set, *target, stop)?
        {
            self.reach = tuning.candidates * exact.d;
            self.advance(exact);
            return Ok(0);
        }
        let mut change = recorder.timed(Part::Sets, || set.carry(checked, gap));
        each(&mut change, |value| *value = -*value);
        let mut criteria = criteria(*limits, error, now.d, &tuning);
        criteria.steps = criteria.steps.min(self.inner_steps);
        let Problem { operators, workspace, .. } = &mut **problem;
        workspace.take(operators, set, recipe, stop)?;
        let fixed = if target.force().is_some() { Fixed::Force } else { Fixed::Approach };
        let outcome = workspace.solve(operators, &mut change, fixed, criteria, stop)?;
        if outcome.is_limited && criteria.steps == tuning.inner_steps {
            // The weights that were carried from set to set may fit this one badly.
            operators.plans.limited += 1;
            workspace.begin_load();
        }
        let set = workspace.set();
        let (contact, p) = recorder.timed(Part::Sets, || {
            let mut before = set.carry(&now.contact, &now.p);
            update(&mut change, &before, |change, p| *change += p);
            let corrected = bounds.corrected(set, change, &held, target.force());
            if held.is_empty() {
                each(&mut before, |p| *p = -*p);
                *measured = Some((set.clone(), before));
            }
            corrected
        });
        let d = now.d;
        self.advance(Pressure { contact, p, d, q: None });
        Ok(outcome.steps)
    }

    /// The fall-back of a kernel that bulges, which begins from no contact set. Returns the steps taken; `None`
    /// where it found no pressure.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the present pressure is then as it was.
    fn solve_inside(&mut self, stop: Stop<'_>) -> Result<Option<usize>, Interrupted> {
        let Self { problem, target, limits, now, state, .. } = self;
        let Problem { operators, candidates, .. } = &mut **problem;
        let cells = &state.checked;
        let before = operators.plans.applications;
        let inside = InteriorProblem {
            z: &candidates.gaps(cells),
            cells,
            force: target.force(),
            approach: now.d,
            enough: INSIDE * limits.tolerance * limits.height.unwrap_or(now.d),
            operators,
        };
        let found = inside.solve(now.p.iter().sum::<f64>() / cells.len() as f64, stop)?;
        operators.plans.descent += operators.plans.applications - before;
        let Some(InteriorPressure { mut p, gap, approach, steps }) = found else { return Ok(None) };
        let own = operators.table().own();
        update(&mut p, &gap, |p, gap| *p = if own * *p > *gap { *p } else { 0.0 });
        let contact = cells.filter(&p, |p| p > 0.0);
        p.retain(|&p| p > 0.0);
        if contact.is_empty() {
            return Ok(None);
        }
        self.advance(Pressure { contact, p, d: approach, q: None });
        Ok(Some(steps))
    }

    /// Steps of the fall-back from the present pressure and its gap. Returns the steps taken.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; the present pressure is then as it was, and its gap undefined.
    fn descend(&mut self, stop: Stop<'_>) -> Result<usize, Interrupted> {
        self.certified = None;
        let Self { problem, target, now, state, .. } = self;
        let Problem { operators, bounds, .. } = &mut **problem;
        let Continuation { checked, gap, .. } = state;
        let mut p = checked.carry(&now.contact, &now.p);
        let most = operators.tuning().fall_back_steps;
        let descent = Descent {
            law: &bounds.law(),
            force: target.force().map(|force| [force]),
            tractions: &mut p,
            gradient: gap,
            own: operators.table().own(),
        };
        let displace = |change: &[f64], u: &mut Vec<f64>| operators.exact(checked, change, checked, u, stop);
        let steps = descend(descent, displace, most, stop)?;
        operators.plans.descent += steps;
        let contact = checked.filter(&p, |p| p > 0.0);
        p.retain(|&p| p > 0.0);
        let d = now.d;
        self.advance(Pressure { contact, p, d, q: None });
        Ok(steps)
    }

    /// Replaces the present pressure; it is kept where it is the best.
    fn advance(&mut self, next: Pressure) {
        self.certified = None;
        let last = std::mem::replace(&mut self.now, next);
        if std::mem::take(&mut self.now_is_best) {
            self.best = last;
        }
    }
}

/// Removes cells in tension from a small superset until none is left; p, q and d are exact up to rounding.
/// `None` where no cell is left or one would have to be at its upper bound.
///
/// # Errors
/// [`Interrupted`] by the stop.
fn eliminate(
    problem: &mut Problem,
    superset: &CellSet,
    target: Control,
    stop: Stop<'_>,
) -> Result<Option<Pressure>, Interrupted> {
    let mut set = superset.clone();
    loop {
        let z = problem.candidates.gaps(&set);
        problem.operators.plans.solves += 1;
        let factored = || {
            let factor = Factor::until(problem.operators.table(), &set, stop)?;
            Ok(factor.map(|factor| factor.solve_pair(&z)))
        };
        let Some((q, w)) = problem.operators.recorder().timed(Part::Factor, factored)? else {
            return Ok(None);
        };
        let d = match target {
            Control::Force(force) => (force + w.iter().sum::<f64>()) / q.iter().sum::<f64>(),
            Control::Approach(d) => d,
        };
        let p: Vec<f64> = q.iter().zip(&w).map(|(q, w)| d * q - w).collect();
        let contact = set.filter(&p, |p| p > 0.0);
        if contact.len() == set.len() {
            let fits = !problem.bounds.is_reached(&p);
            return Ok(fits.then_some(Pressure { contact: set, p, d, q: Some(q) }));
        }
        if contact.is_empty() {
            return Ok(None);
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

#[cfg(test)]
mod tests;
