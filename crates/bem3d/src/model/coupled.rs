//! Loads on a surface whose normal and tangential displacements are coupled, and the stiffness of their states.
//!
//! Tractions raise the surface, so that the force depends on them: the stiffness is that of both problems together,
//! with the tangential load held. Cells that stick follow the tractions that a step causes and cells that slip
//! follow their limits, and which of them do is known only after the step. So the stiffness is a difference
//! quotient: two small steps of the approach go on from the state.

use super::increment::{TIGHTENINGS, branch_error, further};
use super::load::ScaledTangential;
use super::options::NAME;
use super::prepared::{PreparedSurface, Tangent};
use super::sliding::{Slid, SurfaceFriction};
use crate::active_set::{Candidates, Control, Guess, Limits, Solved};
use crate::friction::{
    CoupledGuess, CoupledLoad, CoupledState, CoupledSurface, FrictionLimits, FrictionLoad, SlipMemory,
    TangentialControl, advance_coupled,
};
use crate::response::TangentialStiffness;
use contact_model::{ContactState, Error, Interrupted, Result, Status, Stop};

/// The step of a difference quotient, over the elastic approach of a circle around the contact.
const STEP: f64 = 1e-4;
/// Tolerances of the states of a difference quotient: of the pressures, and of the tractions, whose error falls as
/// the square root of their tolerance.
const TIGHT: [f64; 2] = [1e-12, 1e-15];
/// A quotient with a larger relative error is not claimed.
const CLAIMED: f64 = 0.5;

/// Accuracy and length of the solves of an increment of both loads.
#[derive(Debug, Clone, Copy)]
struct CoupledLimits {
    normal: Limits,
    tangential: FrictionLimits,
}

/// A step of both loads, from the state before it to what is prescribed at its end.
#[derive(Debug, Clone, Copy)]
struct CoupledStep<'a> {
    before: &'a SlipMemory,
    normal: Control,
    tangential: TangentialControl,
}

impl PreparedSurface {
    /// The state of a load with coupled normal and tangential displacements.
    pub(super) fn at_coupled(
        &mut self,
        target: Control,
        tangential: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let Some(mut sliding) = self.sliding.take() else {
            return Err(Error::unsupported(NAME, "coupling without friction"));
        };
        let found = self.solve_coupled(&mut sliding, target, tangential, stop);
        self.sliding = Some(sliding);
        let (solved, tangent, slid) = found?;
        let error = self.load_error(target, &solved, None);
        self.state(solved, tangent, error, Some(slid), stop)
    }

    /// The pressure, its tangent where the stiffness at a fixed contact area is asked for, and the tractions.
    fn solve_coupled(
        &mut self,
        sliding: &mut SurfaceFriction,
        target: Control,
        ScaledTangential { control, prescribed }: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<(Solved, Option<Tangent>, Slid)> {
        let work = sliding.friction.work();
        let mut limits = self.coupled_limits();
        let before = sliding.before.clone();
        let step = CoupledStep { before: &before, normal: target, tangential: control };
        let tuning = *self.problem.operators.tuning();
        let guess =
            self.last.as_ref().filter(|last| (tuning.near.0..=tuning.near.1).contains(&last.ratio(target)));
        let guess = guess.and_then(|last| last.extrapolated(target, &tuning));
        let start = CoupledGuess { pressure: guess, tractions: None };
        let mut state = self.advance_both(sliding, step, limits, start, stop)?;
        let quotient = self.outputs.stiffness && !self.is_complete(&state.normal);
        if quotient {
            let tight = CoupledLimits {
                normal: Limits { tolerance: TIGHT[0].min(limits.normal.tolerance), ..limits.normal },
                tangential: FrictionLimits {
                    tolerance: TIGHT[1].min(limits.tangential.tolerance),
                    ..limits.tangential
                },
            };
            self.tighten(sliding, step, tight, &mut state, stop)?;
            limits = tight;
        }
        let tangent = self.coupled_tangent(sliding, step, &mut limits, &mut state, stop)?;
        let stiffness = self.coupled_stiffness(sliding, step, &mut limits, &mut state, stop)?;
        let normal_stiffness = if quotient && state.status() == Status::Converged {
            let deformed = self.problem.candidates.shared();
            let quotient = self.quotient(sliding, &state, control, limits, stop);
            self.problem.candidates = Candidates::new(self.problem.grid(), deformed);
            quotient?
        } else {
            None
        };
        self.count(work, sliding.friction.work());
        let (status, rounds) = (state.status(), Some((state.rounds, state.contraction)));
        let slid = Slid { prescribed, state: state.tangential, stiffness, normal_stiffness, rounds };
        Ok((Solved { status, ..state.normal }, tangent, slid))
    }

    /// The stiffness of the pressures at a fixed contact area, where it is asked for.
    fn coupled_tangent(
        &mut self,
        sliding: &mut SurfaceFriction,
        step: CoupledStep<'_>,
        limits: &mut CoupledLimits,
        state: &mut CoupledState,
        stop: Stop<'_>,
    ) -> Result<Option<Tangent>> {
        if !self.outputs.needs_fixed_area() || self.is_complete(&state.normal) {
            return Ok(None);
        }
        let tuning = *self.problem.operators.tuning();
        let mut found =
            self.tangent(&state.normal, (None, None), None, stop).map_err(Interrupted::without_state)?;
        // As in `settle`, as long as undecided cells could change it by more than the tolerance.
        for _ in 0..tuning.tightenings {
            let (error, before_error) = (self.tangent_error(&found), state.normal.residuals.worst());
            if error <= self.options.tolerance {
                break;
            }
            limits.normal.tolerance =
                tuning.tightened(self.options.tolerance / error) * limits.normal.tolerance.min(before_error);
            if !self.tighten(sliding, step, *limits, state, stop)? {
                break;
            }
            state.normal.steps += found.steps();
            found =
                self.tangent(&state.normal, (None, None), None, stop).map_err(Interrupted::without_state)?;
        }
        Ok(Some(found))
    }

    /// The tangential stiffnesses, for which the pair may have to be solved further.
    fn coupled_stiffness(
        &mut self,
        sliding: &mut SurfaceFriction,
        step: CoupledStep<'_>,
        limits: &mut CoupledLimits,
        state: &mut CoupledState,
        stop: Stop<'_>,
    ) -> Result<[Option<TangentialStiffness>; 2]> {
        let mut stiffness = self
            .tangential_stiffness(&mut sliding.friction, &state.tangential, stop)
            .map_err(Interrupted::without_state)?;
        for _ in 0..TIGHTENINGS {
            let error = branch_error(&stiffness);
            if error <= self.options.tolerance {
                break;
            }
            limits.tangential.tolerance = limits.tangential.tolerance.min(state.tangential.duality_gap)
                * further(self.options.tolerance / error);
            if !self.tighten(sliding, step, *limits, state, stop)? {
                break;
            }
            stiffness = self
                .tangential_stiffness(&mut sliding.friction, &state.tangential, stop)
                .map_err(Interrupted::without_state)?;
        }
        Ok(stiffness)
    }

    fn coupled_limits(&self) -> CoupledLimits {
        let normal = self.limits();
        let tolerance = normal.tolerance * if self.outputs.tangential_stiffness { 1e-2 } else { 1.0 };
        // The error of the tangential stiffness falls as the square root of that of the tractions.
        CoupledLimits { normal, tangential: FrictionLimits { tolerance, ..self.friction_limits() } }
    }

    /// The state at the end of a step of both loads.
    fn advance_both(
        &mut self,
        sliding: &mut SurfaceFriction,
        step: CoupledStep<'_>,
        limits: CoupledLimits,
        start: CoupledGuess,
        stop: Stop<'_>,
    ) -> Result<CoupledState> {
        let SurfaceFriction { friction, law, undeformed, .. } = sliding;
        let CoupledStep { before, normal, tangential: control } = step;
        let load = CoupledLoad {
            normal,
            tangential: FrictionLoad { law: *law, control },
            normal_limits: limits.normal,
            tangential_limits: limits.tangential,
        };
        let surface = CoupledSurface { problem: &mut self.problem, undeformed, friction };
        let found = advance_coupled(surface, before, load, start, stop);
        found.map_err(|error| self.not_advanced(control, error))
    }

    /// Solves a converged state further. Returns whether that made it better; it counts as converged as long as it
    /// meets the tolerance that was asked for.
    fn tighten(
        &mut self,
        sliding: &mut SurfaceFriction,
        step: CoupledStep<'_>,
        limits: CoupledLimits,
        state: &mut CoupledState,
        stop: Stop<'_>,
    ) -> Result<bool> {
        if state.status() != Status::Converged || stop.stops() {
            return Ok(false);
        }
        let start = guess_of(&state.normal, &state.tangential.memory);
        let deformed = self.problem.candidates.shared();
        let mut next = self.advance_both(sliding, step, limits, start, stop)?;
        let gap = next.tangential.duality_gap;
        let (worst, before) = (next.normal.residuals.worst(), state.normal.residuals.worst());
        let better = (worst < before || gap < state.tangential.duality_gap)
            && worst <= before.max(limits.normal.tolerance)
            && gap <= state.tangential.duality_gap.max(limits.tangential.tolerance);
        if better {
            next.normal.steps += state.normal.steps;
            if worst <= self.options.tolerance && !stop.stops() {
                next.normal.status = Status::Converged;
            }
            if gap <= self.options.tolerance && !stop.stops() {
                next.tangential.status = Status::Converged;
            }
            *state = next;
        } else {
            self.problem.candidates = Candidates::new(self.problem.grid(), deformed);
        }
        Ok(better)
    }

    /// dF/dd of a state as the path goes on, with the tangential load held, and its relative error; nondimensional
    /// over pi. The approach goes on in the direction of the last change of the force, and grows where that did not
    /// change. `None` where no step can be solved, as where the tangential force is all that friction holds.
    fn quotient(
        &mut self,
        sliding: &mut SurfaceFriction,
        state: &CoupledState,
        tangential: TangentialControl,
        limits: CoupledLimits,
        stop: Stop<'_>,
    ) -> Result<Option<(f64, f64)>> {
        let normal = &state.normal;
        let force: f64 = normal.p.iter().sum();
        let before: f64 = sliding.before.pressure.iter().sum();
        let falls = force < before * (1.0 - self.options.tolerance);
        let circle = self.stiffest_on(&normal.contact);
        let step = if falls { -STEP } else { STEP } * force / circle;
        let shift = self.problem.operators.table().shift();
        let mut slopes = [0.0_f64; 2];
        let mut noise = 0.0_f64;
        for (slope, steps) in slopes.iter_mut().zip([1.0, 2.0]) {
            let next = CoupledStep {
                before: &state.tangential.memory,
                normal: Control::Approach(normal.d + steps * step),
                tangential,
            };
            let start = guess_of(normal, &state.tangential.memory);
            let found = self.advance_both(sliding, next, limits, start, stop);
            let next = match found {
                Ok(next) => next,
                // The tangential force would be more than friction holds.
                Err(Error::OutOfRange { .. }) => return Ok(None),
                Err(other) => return Err(other),
            };
            if next.normal.residuals.worst() > self.options.tolerance {
                return Ok(None);
            }
            let rise = next.normal.p.iter().sum::<f64>() - force;
            *slope = rise / (steps * step - shift * rise);
            let left = |solved: &Solved| {
                let error = self.force_error(solved, circle, 0.0).force;
                error.unwrap_or(f64::INFINITY) * solved.p.iter().sum::<f64>()
            };
            noise = noise.max((left(normal) + left(&next.normal)) / (rise.abs() * steps));
        }
        // To the second order of the step.
        let slope = 2.0 * slopes[0] - slopes[1];
        let error = (slope - slopes[0]).abs() / slope.abs() + 3.0 * noise;
        Ok((slope > 0.0 && error <= CLAIMED).then_some((slope, error)))
    }
}

fn guess_of(solved: &Solved, tractions: &SlipMemory) -> CoupledGuess {
    let pressure = Guess { set: solved.contact.clone(), p: solved.p.clone(), d: solved.d };
    CoupledGuess { pressure: Some(pressure), tractions: Some(tractions.clone()) }
}
