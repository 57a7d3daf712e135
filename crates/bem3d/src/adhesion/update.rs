//! One update of contact pressure and attraction: a plain one, one that follows fronts, one far along a slow
//! change, or a Newton step.

use super::attraction::Attraction;
use super::bottleneck::Bottleneck;
use super::equilibrium::{AdhesiveControl, Equilibrium};
use super::law::LawShape;
use super::newton::{BEGIN, Predicted, Trial, WantedStep, step};
use super::relaxation::{FrontLattice, Tractions, follow};
use crate::active_set::Problem;
use crate::kernel::Inverse;
use crate::linear::{Fixed, StoppingCriteria};
use crate::real::{each, largest, largest_difference, sum, update};
use contact_model::{Interrupted, Stop};

// Half and twice the value of each constant below change the work by less than 3 % (34 paths of rough maps and
// of spheres with 65 cells a side, at a tolerance of 1e-5). Half of `BALANCE` takes 3.3 % more. The work with Dugdale's law alone changes by up to 6 % with `PLAIN_REDUCTION` and by up to 5 % with `SETTLED`.

/// An update reduces the residual gaps on the contact by this factor. Less would lose part of the effect of
/// the changed attraction, and more would be lost at the next change of the attraction.
const REDUCTION: f64 = 0.05;
/// The same for the plain iteration, whose contact is solved before the attraction is changed.
const PLAIN_REDUCTION: f64 = 1e-2;
/// Where fronts are followed, Newton steps begin when no attraction changes by more than this in an update, over
/// the peak: of 0.0005 to 0.02 the one of fewest applications along five paths of rough maps of 257 and 513 cells
/// (`examples/adhesion map`).
const FOLLOWED: f64 = 0.002;
/// Steps of conjugate gradients in an update at most.
const STEPS: usize = 40;
/// The plain iteration changes the attraction where no gap of the contact is wrong by more than this share of
/// the range.
pub const SETTLED: f64 = 1e-3;
/// In the other updates: by more than this share of the change of its gaps under the attraction ...
const BALANCE: f64 = 0.3;
/// ... and at most this.
const SETTLED_FIRST: f64 = 0.1;
/// Bottlenecks are looked for when no gap changes by more than this share of the range in an update.
const SLOW: f64 = 0.5;
/// At a prescribed mean gap more attraction in one place opens gaps in another, and cells may alternate for
/// ever; from this many updates on only a share of the change of the attraction is taken ...
const PATIENT: usize = 100;
/// ... which is this.
const DAMPED: f64 = 0.3;
/// A Newton step reduces the residual of its linear system by this factor, because cells that change sides limit
/// what more would gain ...
const FIRST_STEP: f64 = 0.03;
/// ... and after steps that were refused or of no use at most by this one, that of single precision.
const LAST_STEP: f64 = 2e-4;
/// A Newton step aims at this share of the tolerance.
const AIM: f64 = 0.1;
/// A Newton step that does not lower the mismatch by this factor counts as useless.
const USEFUL: f64 = 0.5;
/// After such a step, or one that was refused, the next one is solved better by this factor.
const CLOSER: f64 = 0.1;
/// Plain updates at most from a Newton step that was refused, or of no use, to the next one.
const REST: usize = 8;

/// The history of the updates, from which the next one is chosen.
#[derive(Debug)]
pub struct UpdateProgress {
    bottleneck: Bottleneck,
    /// Plain updates before the next Newton step, and how many after one that is refused.
    rest: usize,
    pause: usize,
    /// The reduction of the linear system of the next Newton step, which is smaller while steps are refused or
    /// of no use.
    reduction: f64,
    /// The mismatch before the last Newton step, where that step was the last update of the attraction.
    before: Option<f64>,
}

impl Default for UpdateProgress {
    fn default() -> Self {
        Self { bottleneck: Bottleneck::default(), rest: 0, pause: 0, reduction: FIRST_STEP, before: None }
    }
}

impl UpdateProgress {
    /// The reduction of the linear system of a Newton step with this mismatch; `None`: a plain update.
    fn newton(&mut self, mismatch: f64, tolerance: f64) -> Option<f64> {
        let before = self.before.take();
        match before {
            Some(before) if mismatch > USEFUL * before => self.refuse(),
            Some(_) => (self.reduction, self.pause) = (FIRST_STEP, 0),
            None => {}
        }
        if self.rest > 0 {
            self.rest -= 1;
            return None;
        }
        self.reduction = self.reduction.max(AIM * tolerance / mismatch).clamp(LAST_STEP, FIRST_STEP);
        self.before = Some(mismatch);
        Some(self.reduction)
    }

    /// After a step that was refused or of no use plain updates follow, and the next one is solved better: a
    /// loose solution leaves out the slowest changes.
    fn refuse(&mut self) {
        self.pause = (2 * self.pause + 1).min(REST);
        (self.rest, self.before) = (self.pause, None);
        self.reduction *= CLOSER;
    }
}

/// Updates at one load.
#[derive(Debug)]
pub struct Updates<'a> {
    /// The surface.
    pub problem: &'a mut Problem,
    /// The attraction.
    pub attraction: &'a Attraction,
    /// The load.
    pub control: AdhesiveControl,
    /// Tolerance of the certificate.
    pub tolerance: f64,
    /// Whether the plain iteration alone may be used.
    pub plain: bool,
}

/// How an update ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Updated {
    /// The state has new pressure and attraction.
    Taken,
    /// The attraction cannot hold the force.
    PulledOff,
}

/// The attraction at which an update aims, and the kind of the update.
struct Wanted {
    /// The attraction.
    attraction: Vec<f64>,
    /// Its largest change, over the peak, also where it waits.
    change: f64,
    /// It stays as it is, because the contact is not yet settled.
    waits: bool,
    /// The fronts may be followed.
    follows: bool,
    /// The load that stays fixed while the contact is corrected.
    fixed: Fixed,
    /// Whether this update is one of the plain iteration alone.
    plain: bool,
}

/// Pressure and attraction before the contact is corrected, and the gap and the contact that follow from them.
struct Uncorrected {
    pressure: Vec<f64>,
    attraction: Vec<f64>,
    gap: Vec<f64>,
    contact: CarryingCells,
}

impl Updates<'_> {
    /// One update: the attraction of the present gaps, and the pressure that then closes the contact.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; pressure and attraction of the state are then as they were.
    pub fn update(
        &mut self,
        state: &mut Equilibrium,
        progress: &mut UpdateProgress,
        stop: Stop<'_>,
    ) -> Result<Updated, Interrupted> {
        let wanted = self.wanted(state);
        let mut uncorrected = None;
        if let Some(reduction) = self.newton_reduction(&wanted, progress) {
            let Some(held) = self.uncorrected(state, &wanted, false, stop)? else {
                return Ok(Updated::PulledOff);
            };
            let trial = self.newton_step(state, (&wanted, &held), reduction, stop)?;
            if let Some(trial) = trial {
                return Ok(self.take(state, trial.pressure, trial.attraction));
            }
            progress.refuse();
            uncorrected = Some(held).filter(|_| !wanted.follows);
        }
        if uncorrected.is_none() {
            uncorrected = self.uncorrected(state, &wanted, wanted.follows, stop)?;
        }
        let Some(mut next) = uncorrected else { return Ok(Updated::PulledOff) };
        state.steps += self.close(state, &mut next, &wanted, stop)?;
        self.lead_through(state, &mut next, &wanted, progress);
        Ok(self.take(state, next.pressure, next.attraction))
    }

    /// The attraction of the present gaps: a share of its change at a prescribed mean gap after many updates,
    /// none where the contact is not yet settled.
    fn wanted(&self, state: &Equilibrium) -> Wanted {
        let law = self.attraction.law;
        let plain = self.plain || law.shape == LawShape::Uniform;
        let fixed = self.control.fixed(self.problem.operators.table().shift());
        let mut attraction = state.lawful.clone();
        let damped = matches!(fixed, Fixed::MeanPlane(_)) && state.updates > PATIENT;
        if damped {
            update(&mut attraction, &state.attraction, |next, now| *next = now + DAMPED * (*next - now));
        }
        let change = largest_difference(&attraction, &state.attraction) / law.peak;
        let settled =
            if plain { SETTLED } else { (BALANCE * change).max(0.5 * self.tolerance).min(SETTLED_FIRST) };
        let waits =
            state.largest_gap_left(self.problem.bounds) > settled * law.range && sum(&state.pressure) > 0.0;
        if waits {
            attraction.clone_from(&state.attraction);
        }
        let follows = self.attraction.inverse().is_some() && !plain && !waits && !damped;
        Wanted { attraction, change, waits, follows, fixed, plain }
    }

    /// The reduction of the linear system of a Newton step; `None`: none is taken.
    fn newton_reduction(&self, wanted: &Wanted, progress: &mut UpdateProgress) -> Option<f64> {
        let begin = if wanted.follows { FOLLOWED } else { BEGIN };
        let is_early = wanted.plain || wanted.waits || wanted.change > begin;
        if is_early { None } else { progress.newton(wanted.change, self.tolerance) }
    }

    /// The state of a Newton step; `None` where it is refused.
    fn newton_step(
        &mut self,
        state: &mut Equilibrium,
        (wanted, held): (&Wanted, &Uncorrected),
        reduction: f64,
        stop: Stop<'_>,
    ) -> Result<Option<Trial>, Interrupted> {
        let predicted = Predicted {
            pressure: &held.pressure,
            attraction: &held.attraction,
            gap: &held.gap,
            contact: &held.contact.marked,
            noise: held.contact.noise,
        };
        let wanted = WantedStep { state, predicted: &predicted, fixed: wanted.fixed, reduction, stop };
        let (trial, steps) = step(self.problem, self.attraction, &wanted)?;
        state.steps += steps;
        Ok(trial)
    }

    /// The wanted attraction, or with `follows` that to which the fronts move, and the state that it leads to
    /// before the contact is corrected. `None` where it leaves no force for the contact.
    fn uncorrected(
        &mut self,
        state: &Equilibrium,
        wanted: &Wanted,
        follows: bool,
        stop: Stop<'_>,
    ) -> Result<Option<Uncorrected>, Interrupted> {
        let mut attraction = wanted.attraction.clone();
        let inverse = self.attraction.inverse().filter(|_| follows);
        let Some(pressure) = self.held(state, &mut attraction, inverse, stop)? else { return Ok(None) };
        let (gap, contact) = self.gap_after(state, (&pressure, &attraction), wanted.fixed, stop)?;
        Ok(Some(Uncorrected { pressure, attraction, gap, contact }))
    }

    /// Takes the next state far along its change where the iteration is in a bottleneck.
    fn lead_through(
        &self,
        state: &Equilibrium,
        next: &mut Uncorrected,
        wanted: &Wanted,
        progress: &mut UpdateProgress,
    ) {
        if wanted.plain || wanted.change > SLOW {
            progress.bottleneck.clear();
        } else if !wanted.waits {
            let peak = self.attraction.law.peak;
            let moved = next.attraction.iter().zip(&state.attraction).map(|(s, s0)| (s - s0) / peak);
            if let Some(factor) = progress.bottleneck.factor(wanted.change, moved.collect()) {
                extrapolate(factor, &state.pressure, &mut next.pressure, f64::INFINITY);
                extrapolate(factor, &state.attraction, &mut next.attraction, self.attraction.strongest());
            }
        }
    }

    /// Gives a state these tractions, brought to the force.
    fn take(&self, state: &mut Equilibrium, pressure: Vec<f64>, attraction: Vec<f64>) -> Updated {
        (state.pressure, state.attraction) = (pressure, attraction);
        let AdhesiveControl::Force(force) = self.control else { return Updated::Taken };
        let (wanted, sum) = (force + sum(&state.attraction), sum(&state.pressure));
        if wanted > 0.0 && sum > 0.0 {
            each(&mut state.pressure, |p| *p *= wanted / sum);
        }
        if wanted > 0.0 { Updated::Taken } else { Updated::PulledOff }
    }

    /// The pressure of a state brought to the force that an attraction leaves to it; `None` where the
    /// attraction leaves no force for the contact. With an inverse of the kernel its fronts are followed, and
    /// the attraction becomes that at their end.
    fn held(
        &self,
        state: &Equilibrium,
        attraction: &mut [f64],
        inverse: Option<&Inverse>,
        stop: Stop<'_>,
    ) -> Result<Option<Vec<f64>>, Interrupted> {
        let mut pressure = state.pressure.clone();
        if let Some(inverse) = inverse {
            let boundary = self.problem.operators.table().boundary();
            let lattice = FrontLattice { inverse, grid: self.problem.grid(), boundary };
            let mut to = Tractions { pressure: &mut pressure, attraction: &mut *attraction };
            follow(self.attraction, lattice, state, &mut to, stop)?;
        } else {
            // A contact cell that is attracted more bears as much more: its net pressure stays.
            for ((p, now), before) in pressure.iter_mut().zip(&*attraction).zip(&state.attraction) {
                if *p > 0.0 && *p + now - before > 0.0 {
                    *p += now - before;
                }
            }
        }
        let AdhesiveControl::Force(force) = self.control else { return Ok(Some(pressure)) };
        let (held, wanted) = (sum(&pressure), force + sum(attraction));
        if wanted <= 0.0 {
            return Ok(None);
        }
        if held > 0.0 {
            each(&mut pressure, |p| *p *= wanted / held);
        } else if let Some(first) = (0..pressure.len()).min_by(|&i, &j| state.gap[i].total_cmp(&state.gap[j]))
        {
            pressure[first] = wanted;
        }
        Ok(Some(pressure))
    }

    /// The gap of a state after pressure and attraction have changed, in single precision (the error is
    /// relative to the change), and the contact that follows.
    fn gap_after(
        &mut self,
        state: &Equilibrium,
        (pressure, next): (&[f64], &[f64]),
        fixed: Fixed,
        stop: Stop<'_>,
    ) -> Result<(Vec<f64>, CarryingCells), Interrupted> {
        let mut changed: Vec<f64> = pressure.iter().zip(next).map(|(p, s)| p - s).collect();
        let before = state.pressure.iter().zip(&state.attraction);
        changed.iter_mut().zip(before).for_each(|(changed, (p, s))| *changed -= p - s);
        let mut gap = state.gap.clone();
        if largest(&changed) > 0.0 {
            let mut u = Vec::new();
            self.problem.operators.rough(&state.cells, &changed, &state.cells, &mut u, stop)?;
            update(&mut gap, &u, |gap, u| *gap += u);
        }
        let offset: f64 = match fixed {
            Fixed::Force => {
                let force = sum(pressure);
                pressure.iter().zip(&gap).map(|(p, g)| p / force * g).sum()
            }
            Fixed::MeanPlane(shift) => shift * sum(&changed),
            Fixed::Approach => 0.0,
        };
        each(&mut gap, |g| *g -= offset);
        let contact = CarryingCells::new(pressure, &gap, self.problem.operators.tuning().noise);
        Ok((gap, contact))
    }

    /// Corrects the pressure of the contact so that its gap vanishes. Returns the steps.
    fn close(
        &mut self,
        state: &Equilibrium,
        next: &mut Uncorrected,
        wanted: &Wanted,
        stop: Stop<'_>,
    ) -> Result<usize, Interrupted> {
        let reduction = if wanted.plain { PLAIN_REDUCTION } else { REDUCTION };
        let set = state.cells.filter(&next.contact.marked, |m| m > 0.0);
        let Problem { operators, workspace, .. } = &mut *self.problem;
        let Some(recipe) = operators.planner().system(&set, next.contact.count, false) else {
            return Ok(0);
        };
        let mut right: Vec<f64> = set.carry(&state.cells, &next.gap);
        each(&mut right, |r| *r = -*r);
        let criteria = StoppingCriteria { reduction, energy: None, floor: 0.0, steps: STEPS };
        workspace.begin_load();
        workspace.take(operators, set, recipe, stop)?;
        let outcome = workspace.solve(operators, &mut right, wanted.fixed, criteria, stop)?;
        let correction = state.cells.carry(workspace.set(), &right);
        update(&mut next.pressure, &correction, |p, x| *p = (*p + x).max(0.0));
        Ok(outcome.steps)
    }
}

/// The contact that a pressure and its gap make: cells that carry, and those that penetrate.
struct CarryingCells {
    /// 1 on its cells.
    marked: Vec<f64>,
    /// Cells that carry.
    count: usize,
    /// Penetrations below this are within the error of the last correction.
    noise: f64,
}

impl CarryingCells {
    fn new(pressure: &[f64], gap: &[f64], noise: f64) -> Self {
        let (square, count) = (pressure.iter().zip(gap))
            .filter(|(p, _)| **p > 0.0)
            .fold((0.0, 0usize), |(square, count), (_, g)| (square + g * g, count + 1));
        let noise = if count > 0 { noise * (square / count as f64).sqrt() } else { 0.0 };
        let marked = |(&p, &g): (&f64, &f64)| if p > 0.0 || g < -noise { 1.0 } else { 0.0 };
        Self { marked: pressure.iter().zip(gap).map(marked).collect(), count, noise }
    }
}

/// Extrapolates by `factor` from one state to the next, within zero and `most`.
fn extrapolate(factor: f64, from: &[f64], to: &mut [f64], most: f64) {
    update(to, from, |to, from| *to = (from + factor * (*to - from)).clamp(0.0, most));
}
