//! The stopping criteria of the outer iteration and the accuracy of the next inner solve.

use super::residuals::Residuals;
use super::state::Limits;
use crate::linear::StoppingCriteria;
use crate::tuning::Tuning;
use contact_model::{Status, Stop};

/// The evaluation of the gap of a pressure.
#[derive(Debug, Clone, Copy)]
pub struct Evaluated {
    /// How well the contact conditions hold.
    pub residuals: Residuals,
    /// Whether the gap is known on every cell below the plane, in double precision unless the result is a guess.
    pub complete: bool,
    /// Bound on the error of the gap, as a length.
    pub uncertainty: f64,
    /// Whether p and d are exact on the set, up to rounding.
    pub factored: bool,
    /// The share of the step that was taken to get here, where it was shortened.
    pub step: Option<f64>,
}

/// The decision after an evaluation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// The solve ends.
    End(Status),
    /// Another iteration; `best`: the present pressure is the best so far.
    Continue { best: bool },
}

/// How a gap is evaluated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Look {
    /// In double precision.
    Exact,
    /// Only the change in single precision where the previous gap is known, otherwise in double precision.
    Change,
    /// In single precision.
    Rough,
}

/// The history that decisions rest on.
#[derive(Debug)]
pub struct OuterProgress {
    limits: Limits,
    /// Smallest residuals so far, of complete evaluations.
    pub best: f64,
    /// How the next gap is evaluated.
    pub look: Look,
    /// The residuals before.
    last: f64,
    iteration: usize,
    since_best: usize,
    /// Smallest residuals so far, of any evaluation, and the outer iterations since.
    lowest: f64,
    since_lowest: usize,
    /// The residuals that the fall-back has to reach, while it goes on.
    goal: Option<f64>,
    /// Number of times that it was begun.
    begun: i32,
}

impl OuterProgress {
    /// Nothing is known yet.
    pub fn new(limits: Limits) -> Self {
        let unknown = f64::INFINITY;
        Self {
            limits,
            best: unknown,
            look: Look::Rough,
            last: unknown,
            iteration: 0,
            since_best: 0,
            lowest: unknown,
            since_lowest: 0,
            goal: None,
            begun: 0,
        }
    }

    /// Whether the next pressure comes from the fall-back ([`crate::law::descend`]).
    pub fn falls_back(&self) -> bool {
        self.goal.is_some()
    }

    /// Begins the fall-back where the outer iteration makes no progress, and ends it once its goal is
    /// reached. Returns whether neither can go on.
    ///
    /// The fall-back converges from every pressure, and the n-th time it goes on until the residuals are
    /// 10^-n times the smallest of all before: it is used a few times at most, and each time the outer
    /// iteration either reduces the residuals within a fixed number of iterations or is left again. So the
    /// solve ends, up to rounding, at the tolerance.
    fn alternate(&mut self, error: f64, jammed: bool, resolved: bool, tuning: &Tuning) -> bool {
        if error < tuning.better * self.lowest {
            (self.lowest, self.since_lowest) = (error, 0);
        } else {
            self.since_lowest += 1;
        }
        let stagnated = self.since_best > tuning.patience;
        match self.goal {
            Some(goal) if error <= goal => {
                (self.goal, self.since_lowest, self.since_best) = (None, 0, 0);
            }
            None if jammed || self.since_lowest > tuning.stalled || (stagnated && resolved) => {
                self.begun += 1;
                self.goal = Some(tuning.fall_back.powi(self.begun) * self.lowest);
                (self.look, self.since_lowest, self.since_best) = (Look::Exact, 0, 0);
            }
            _ => return stagnated,
        }
        false
    }

    /// Decides after the evaluation of a gap at the approach d.
    pub fn judge(&mut self, evaluated: Evaluated, d: f64, tuning: &Tuning, stop: Stop<'_>) -> Decision {
        let Evaluated { residuals, complete, uncertainty, factored, step } = evaluated;
        let jammed = step.is_some_and(|share| share < tuning.jammed);
        let (error, limits) = (residuals.worst(), self.limits);
        stop.residual(error, limits.tolerance);
        let settled = !factored || residuals.deepest <= tuning.factor_rounding * d;
        if complete && settled && error <= limits.tolerance {
            return Decision::End(Status::Converged);
        } else if stop.stops() {
            return Decision::End(Status::Stopped);
        } else if self.iteration >= limits.outer_iterations {
            return Decision::End(Status::IterationLimit);
        }
        let length = error * limits.height.unwrap_or(d);
        if self.alternate(error, jammed, length > tuning.rounding * d, tuning) {
            return Decision::End(Status::Stagnated);
        }
        self.iteration += 1;
        // Small residuals that do not fall may be those of the precision.
        let falls = error < tuning.better * self.last;
        self.last = error;
        self.look = if self.goal.is_some() {
            Look::Exact
        } else if length > tuning.single_noise * d {
            Look::Rough
        } else if falls
            && error > tuning.expected * limits.tolerance
            && length > tuning.resolved * uncertainty
        {
            Look::Change
        } else {
            Look::Exact
        };
        let best = complete && error < tuning.better * self.best;
        if best {
            (self.best, self.since_best) = (error, 0);
        } else {
            self.since_best += usize::from(complete);
        }
        Decision::Continue { best }
    }
}

/// The stopping criteria of an inner solve when the residuals are `error`.
pub fn criteria(limits: Limits, error: f64, d: f64, tuning: &Tuning) -> StoppingCriteria {
    let reduction = if error > tuning.early {
        tuning.early_reduction
    } else {
        (0.5 * limits.tolerance / error).clamp(tuning.reduction.0, tuning.reduction.1)
    };
    let floor = tuning.floor * limits.tolerance * limits.height.unwrap_or(d);
    StoppingCriteria { reduction, energy: None, floor, steps: tuning.inner_steps }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::never;

    const TUNING: Tuning = Tuning::DEFAULT;
    const TIGHT: Limits =
        Limits { tolerance: 1e-6, height: Some(1.0), outer_iterations: 100, factor: true, is_guess: false };

    /// A complete evaluation with these residuals.
    fn seen(error: f64) -> Evaluated {
        let residuals = Residuals { duality_gap: error, ..Residuals::default() };
        Evaluated { residuals, complete: true, uncertainty: 0.0, factored: false, step: None }
    }

    /// The first decision.
    fn first(evaluated: Evaluated, d: f64) -> Decision {
        OuterProgress::new(TIGHT).judge(evaluated, d, &TUNING, &never)
    }

    /// The decisions on a series of evaluations at an approach of 1.
    fn judged(limits: Limits, errors: &[f64]) -> Vec<Decision> {
        let mut progress = OuterProgress::new(limits);
        errors.iter().map(|&error| progress.judge(seen(error), 1.0, &TUNING, &never)).collect()
    }

    #[test]
    fn converged_is_complete_and_settled_and_within_the_tolerance() {
        const CONVERGED: Decision = Decision::End(Status::Converged);
        let good = seen(1e-6);
        assert_eq!(first(good, 1.0), CONVERGED);
        assert_eq!(first(seen(1.01e-6), 1.0), Decision::Continue { best: true });
        // Any of the residuals counts.
        for residuals in [
            Residuals { penetration: 1.01e-6, ..Residuals::default() },
            Residuals { complementarity: 1.01e-6, ..Residuals::default() },
        ] {
            assert_ne!(first(Evaluated { residuals, ..good }, 1.0), CONVERGED, "{residuals:?}");
        }
        // The gap is not known on every cell.
        assert_eq!(first(Evaluated { complete: false, ..good }, 1.0), Decision::Continue { best: false });
        // The residual of a factored set may be the rounding of its approach, here 1e-12 x 1000, and no more.
        let factored = |deepest| {
            let residuals = Residuals { deepest, ..good.residuals };
            first(Evaluated { residuals, factored: true, ..good }, 1e3)
        };
        assert_eq!(factored(5e-10), CONVERGED);
        assert_eq!(factored(2e-9), Decision::Continue { best: true });
        // A converged state is not stopped any more.
        assert_eq!(OuterProgress::new(TIGHT).judge(good, 1.0, &TUNING, &|| true), CONVERGED);
        let stopped = OuterProgress::new(TIGHT).judge(seen(1.0), 1.0, &TUNING, &|| true);
        assert_eq!(stopped, Decision::End(Status::Stopped));
    }

    #[test]
    fn patience_is_for_outer_iterations_without_better_residuals() {
        // The first residuals are the best, patience + 1 more are no better: the next one ends it where they
        // may be those of rounding, and begins the fall-back where they are not. Large ones that do not fall
        // do so, too.
        for error in [1e-3, 0.5] {
            for (d, rounding) in [(1e-3, false), (2.0 * error / TUNING.rounding, true)] {
                let mut progress = OuterProgress::new(TIGHT);
                for i in 0..TUNING.patience + 2 {
                    let decision = progress.judge(seen(error), d, &TUNING, &never);
                    assert_eq!(decision, Decision::Continue { best: i == 0 });
                    assert!(!progress.falls_back());
                }
                let decision = progress.judge(seen(error), d, &TUNING, &never);
                assert_eq!(decision == Decision::End(Status::Stagnated), rounding, "{error} {d}");
                assert_eq!(progress.falls_back(), !rounding, "{error} {d}");
            }
        }
        // Evaluations in single precision do not count against the patience: only the limit of iterations
        // ends them.
        let mut progress = OuterProgress::new(TIGHT);
        let mut error = 0.5;
        let decisions = (0..=TIGHT.outer_iterations).map(|_| {
            error *= 0.89;
            progress.judge(Evaluated { complete: false, ..seen(error) }, 1e-3, &TUNING, &never)
        });
        let end = Decision::End(Status::IterationLimit);
        assert_eq!(decisions.into_iter().position(|d| d == end), Some(TIGHT.outer_iterations));
        // Shortened steps, whose gaps are not evaluated, do not count either.
        let mut progress = OuterProgress::new(TIGHT);
        let shortened = Evaluated { complete: false, ..seen(1e-5) };
        let mut decisions = (0..2 * TUNING.patience).map(|_| progress.judge(shortened, 1.0, &TUNING, &never));
        assert!(decisions.all(|d| d == Decision::Continue { best: false }));
        // Better residuals begin anew.
        let errors: Vec<f64> =
            (0..5 * TUNING.patience).map(|i| 1e-3 * 0.8f64.powf((i / 10) as f64)).collect();
        assert!(judged(TIGHT, &errors).iter().all(|d| matches!(d, Decision::Continue { .. })));
    }

    #[test]
    fn the_fall_back_begins_where_nothing_falls_and_goes_on_to_its_goal() {
        let jammed = |error| Evaluated { complete: false, step: Some(0.0), ..seen(error) };
        let next = |progress: &mut OuterProgress, evaluated| {
            let decision = progress.judge(evaluated, 1.0, &TUNING, &never);
            (decision, progress.falls_back())
        };
        let continued = Decision::Continue { best: false };
        // A step of which nothing is left begins it at once, without a gap in single precision; a tenth of
        // the smallest residuals ends it.
        let mut progress = OuterProgress::new(TIGHT);
        assert_eq!(next(&mut progress, seen(0.1)), (Decision::Continue { best: true }, false));
        assert_eq!(next(&mut progress, jammed(0.2)), (continued, true));
        assert_eq!(progress.look, Look::Exact);
        assert!(next(&mut progress, seen(0.011)).1 && progress.look == Look::Exact);
        assert!(!next(&mut progress, seen(0.009)).1);
        // The second time it takes a hundredth.
        assert!(next(&mut progress, jammed(0.5)).1);
        assert!(next(&mut progress, seen(1e-4)).1);
        assert!(!next(&mut progress, seen(8.9e-5)).1);
        // It ends where nothing falls any more, and where the tolerance is met.
        assert!(next(&mut progress, jammed(0.5)).1);
        let mut stagnated = (0..).map(|_| next(&mut progress, seen(8.5e-5)).0);
        assert_eq!(stagnated.position(|d| d == Decision::End(Status::Stagnated)), Some(TUNING.patience + 1));
        let mut progress = OuterProgress::new(TIGHT);
        next(&mut progress, seen(0.1));
        assert!(next(&mut progress, jammed(0.1)).1);
        assert_eq!(next(&mut progress, seen(1e-6)).0, Decision::End(Status::Converged));
        // Shortened steps without better residuals begin it, too.
        let mut progress = OuterProgress::new(TIGHT);
        let shortened = Evaluated { complete: false, ..seen(0.1) };
        let begins = (0..1000).position(|_| next(&mut progress, shortened).1);
        assert_eq!(begins, Some(TUNING.stalled + 1));
    }

    #[test]
    fn residuals_are_better_when_they_fall_by_a_tenth() {
        let best = |decisions: &[Decision]| -> Vec<usize> {
            let best = Decision::Continue { best: true };
            (0..decisions.len()).filter(|&i| decisions[i] == best).collect()
        };
        assert_eq!(best(&judged(TIGHT, &[1.0, 0.95, TUNING.better, 0.5, 0.46, 0.44])), [0, 3, 5]);
        let mut progress = OuterProgress::new(TIGHT);
        progress.judge(seen(1.0), 1.0, &TUNING, &never);
        let incomplete = Evaluated { complete: false, ..seen(0.1) };
        assert_eq!(progress.judge(incomplete, 1.0, &TUNING, &never), Decision::Continue { best: false });
        assert_relative_eq!(progress.best, 1.0);
    }

    #[test]
    fn single_precision_looks_as_long_as_it_can_tell() {
        let noise = TUNING.single_noise;
        let look = |height, evaluations: &[Evaluated], d| {
            let mut progress = OuterProgress::new(Limits { height: Some(height), ..TIGHT });
            assert_eq!(progress.look, Look::Rough);
            for &evaluated in evaluations {
                progress.judge(evaluated, d, &TUNING, &never);
            }
            progress.look
        };
        let known = |error, uncertainty| Evaluated { uncertainty, complete: false, ..seen(error) };
        // The gap that is measured, residuals x height, against 1e-4 of the approach, whatever they did.
        assert_eq!(look(1.0, &[known(0.5, 1.0)], 0.4 / noise), Look::Rough);
        assert_eq!(look(1.0, &[known(0.4, 1.0), known(0.5, 1.0)], 0.4 / noise), Look::Rough);
        assert_eq!(look(4.0, &[known(0.5, 1.0)], 1.0 / noise), Look::Rough);
        assert_eq!(look(1.0, &[known(0.5, 1.0)], 0.6 / noise), Look::Exact);
        // Below it against what the gap may be wrong by.
        let small = |uncertainty| look(1.0, &[known(0.5, uncertainty)], 1e3 / noise);
        assert_eq!(small(0.0), Look::Change);
        assert_eq!(small(0.49 / TUNING.resolved), Look::Change);
        assert_eq!(small(0.51 / TUNING.resolved), Look::Exact);
        // Those that are expected within the tolerance are evaluated to end the solve.
        let last = |error| look(1.0, &[known(error, 0.0)], 1e3 / noise);
        assert_eq!(last(1.1 * TUNING.expected * TIGHT.tolerance), Look::Change);
        assert_eq!(last(0.9 * TUNING.expected * TIGHT.tolerance), Look::Exact);
        // Those that do not fall may be noise.
        assert_eq!(look(1.0, &[seen(0.5), seen(0.44)], 1e3 / noise), Look::Change);
        assert_eq!(look(1.0, &[seen(0.5), seen(0.46)], 1e3 / noise), Look::Exact);
        // Without a height gaps are compared with the approach, whatever its unit.
        let mut progress = OuterProgress::new(Limits { height: None, ..TIGHT });
        progress.judge(seen(0.5), 1e-30, &TUNING, &never);
        assert_eq!(progress.look, Look::Rough);
    }

    #[test]
    fn an_inner_solve_is_asked_for_half_of_what_is_wanted() {
        let limits = Limits { tolerance: 1e-3, height: Some(5.0), ..TIGHT };
        let reduction = |error| criteria(limits, error, 1.0, &TUNING).reduction;
        assert_relative_eq!(reduction(4e-3), 0.125);
        assert_relative_eq!(reduction(TUNING.early), TUNING.reduction.0);
        assert_relative_eq!(reduction(1.01 * TUNING.early), TUNING.early_reduction);
        assert_relative_eq!(reduction(1e-3), TUNING.reduction.1);
        // A fifth of the tolerance, as a length: of the height, or of the approach where there is none.
        assert_relative_eq!(criteria(limits, 1.0, 3.0, &TUNING).floor, 1e-3);
        let tight = criteria(Limits { tolerance: 1e-9, height: None, ..limits }, 1e-2, 3.0, &TUNING);
        assert_relative_eq!(tight.reduction, TUNING.reduction.0);
        assert_relative_eq!(tight.floor, 0.6e-9);
        assert!(tight.energy.is_none() && tight.steps == TUNING.inner_steps);
    }
}
