//! When the outer iteration ends, and what it asks of the next inner solve.

use super::residuals::Residuals;
use super::state::Limits;
use crate::linear::StoppingCriteria;
use crate::tuning::Tuning;
use contact_model::{Status, Stop};

/// What the gap of a pressure says.
#[derive(Debug, Clone, Copy)]
pub struct Evaluated {
    /// How well the contact conditions hold.
    pub residuals: Residuals,
    /// Whether the gap is known on every cell below the plane, in double precision.
    pub complete: bool,
    /// Whether p and d are exact on the set, up to rounding.
    pub factored: bool,
}

/// How to go on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Decision {
    /// The solve ends.
    End(Status),
    /// Another iteration; `best`: the present pressure is the best so far.
    Continue { best: bool },
}

/// The history that decisions rest on.
#[derive(Debug)]
pub struct Progress {
    limits: Limits,
    /// Smallest residuals so far, of complete evaluations.
    pub best: f64,
    /// Whether the next gap is evaluated in single precision.
    pub rough: bool,
    iteration: usize,
    since_best: usize,
}

impl Progress {
    /// Nothing is known yet; `rough`: whether the first gap is evaluated in single precision.
    pub fn new(limits: Limits, rough: bool) -> Self {
        Self { limits, best: f64::INFINITY, rough, iteration: 0, since_best: 0 }
    }

    /// Decides after the evaluation of a gap at the approach d.
    pub fn judge(&mut self, evaluated: Evaluated, d: f64, tuning: &Tuning, stop: Stop<'_>) -> Decision {
        let Evaluated { residuals, complete, factored } = evaluated;
        let (error, limits) = (residuals.worst(), self.limits);
        let settled = !factored || residuals.deepest <= tuning.factor_rounding * d;
        if complete && settled && error <= limits.tolerance {
            return Decision::End(Status::Converged);
        } else if stop() {
            return Decision::End(Status::Stopped);
        } else if self.iteration >= limits.outer_iterations {
            return Decision::End(Status::IterationLimit);
        } else if self.since_best > tuning.patience {
            return Decision::End(Status::Stagnated);
        }
        self.iteration += 1;
        let length = error * limits.height.unwrap_or(d);
        self.rough = error > tuning.rough
            && error > tuning.rough_factor * limits.tolerance
            && length > tuning.single_noise * d;
        let best = complete && error < tuning.better * self.best;
        if best {
            (self.best, self.since_best) = (error, 0);
        } else {
            self.since_best += usize::from(!self.rough);
        }
        Decision::Continue { best }
    }
}

/// What an inner solve is asked for when the residuals are `error`.
pub fn criteria(limits: Limits, error: f64, d: f64, tuning: &Tuning) -> StoppingCriteria {
    let reduction = if error > tuning.early {
        tuning.early_reduction
    } else {
        (0.5 * limits.tolerance / error).clamp(tuning.reduction.0, tuning.reduction.1)
    };
    let floor = tuning.floor * limits.tolerance * limits.height.unwrap_or(d);
    StoppingCriteria { reduction, energy: None, floor, steps: tuning.inner_steps }
}
