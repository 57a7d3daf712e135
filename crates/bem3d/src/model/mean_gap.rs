//! Mean gaps with periodic boundaries, which replace the approach, and the stiffness from a kernel with a
//! constant.

use super::certificate::LoadError;
use super::load::ScaledTangential;
use super::options::NAME;
use super::prepared::{PreparedSurface, Tangent};
use super::sliding::SurfaceFriction;
use crate::active_set::{Bounds, Control, Solved};
use crate::tuning::{FLOWING_GAP_LOADS, GAP_LOADS, GAP_STEP, POLISHED_GAP, POLISHING_LOADS};
use contact_model::{ContactState, Error, Interrupted, Result, Status, Stop};

/// The search for a force by the mean gap that it leaves, in x = ln F.
struct GapSearch {
    x: f64,
    /// Where the gap is too large, and too small.
    low: f64,
    high: f64,
    /// Approaches at which the gap is too large, and too small.
    approaches: [f64; 2],
    /// The last x of an incomplete contact, and by how much its gap was too large.
    before: Option<(f64, f64)>,
}

/// The next x by a slope, and whether it lies between those that are known.
#[derive(Clone, Copy)]
struct GapStep {
    x: f64,
    is_within: bool,
}

impl GapSearch {
    fn is_bracketed(&self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    /// Narrows the bracket by a state whose gap is too large by `miss`.
    fn narrow(&mut self, solved: &Solved, miss: f64, complete: bool) {
        if miss > 0.0 {
            self.low = self.low.max(self.x);
            self.approaches[0] = solved.d.max(self.approaches[0]);
        } else {
            self.high = self.high.min(self.x);
            self.approaches[1] = solved.d.min(self.approaches[1]);
        }
        if complete {
            // Every force from that of the first complete contact on has the gap 0.
            let (force, least) =
                (solved.p.iter().sum::<f64>(), solved.p.iter().copied().fold(f64::INFINITY, f64::min));
            self.high = self.high.min((force - least * solved.p.len() as f64).ln());
        }
    }

    /// The change of x with the gap: by the stiffness, by the last two states, or as far as is known of the surface.
    fn slope(&self, stiffness: Option<f64>, force: f64, miss: f64, usual: f64) -> f64 {
        match (stiffness, self.before) {
            (Some(k), _) => k / force,
            (None, Some((x0, miss0))) if (miss0 - miss).abs() > 0.0 => (self.x - x0) / (miss0 - miss),
            _ => usual,
        }
    }

    fn next(&self, change: f64, complete: bool) -> GapStep {
        let x = self.x + change.clamp(-GAP_STEP, GAP_STEP);
        GapStep { x, is_within: x > self.low && x < self.high && !(complete && self.is_bracketed()) }
    }

    /// Goes on by a step, or halves the bracket, or looks for its other end.
    fn take(&mut self, step: GapStep, miss: f64) {
        self.x = if step.is_within {
            step.x
        } else if self.is_bracketed() {
            f64::midpoint(self.low, self.high)
        } else {
            self.x + GAP_STEP.copysign(miss)
        };
    }
}

impl PreparedSurface {
    /// Mean gap of a solved state, nondimensional.
    fn gap_of(&self, solved: &Solved) -> f64 {
        self.mean_gap(self.is_complete(solved), solved.d, solved.p.iter().sum())
    }

    /// Whether the mean gap is positive at any force: this holds without undefined points and without a
    /// hardness.
    fn has_complete_contact(&self) -> bool {
        self.problem.bounds == Bounds::Unlimited && self.defined == self.problem.grid().count()
    }

    /// The state at a nondimensional mean gap and a tangential load, by Newton's method in ln F where the
    /// stiffness is known and secants where it is not: the gap falls about linearly with ln F. It is met to the
    /// tolerance, in rms heights. Where cells at the hardness carry nearly all of the force, one force belongs to a range of gaps,
    /// and the search goes on in the approach.
    pub(super) fn at_mean_gap(
        &mut self,
        asked: f64,
        load: ScaledTangential,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let first = self.problem.candidates.range().first;
        if asked >= self.mean - first {
            // Apart, or touching: the gap is the one asked for.
            return self.no_contact(self.mean - asked, load);
        }
        self.check_gap(asked)?;
        self.begin_count();
        let mut search = self.begin_gap_search(first);
        let mut steps = 0;
        // Loads that meet the gap and are followed by another one.
        let mut polish = POLISHING_LOADS;
        for tries in 0..GAP_LOADS {
            let tried = self.try_gap(asked, Control::Force(search.x.exp()), &mut polish, stop);
            let tried = tried.map_err(Interrupted::without_state)?;
            steps += tried.solved.steps;
            if tried.ends {
                return self.at_gap(tried, load, steps, stop);
            }
            let GapTried { solved, tangent, miss, .. } = tried;
            let complete = self.is_complete(&solved);
            search.narrow(&solved, miss, complete);
            let slope = search.slope(
                tangent.as_ref().map(|t| t.stiffness.k() * self.magnification(t.stiffness.k())),
                solved.p.iter().sum(),
                miss,
                1.0 / self.mean,
            );
            let step = search.next(miss * slope, complete);
            let flows = self.problem.bounds.is_reached(&solved.p);
            let in_approach = flows
                && (self.responding(&solved).cells.is_empty()
                    || search.is_bracketed() && !step.is_within
                    || tries >= FLOWING_GAP_LOADS);
            search.before = (!complete).then_some((search.x, miss));
            self.remember(solved, tangent);
            if in_approach {
                return self.at_gap_by_approach((asked, load), search.approaches, steps, stop);
            }
            search.take(step, miss);
        }
        Err(self.no_such_gap(asked)?)
    }

    /// Refuses a mean gap below that of the first touch that cannot be prescribed.
    fn check_gap(&self, asked: f64) -> Result<()> {
        if asked <= 0.0 && self.has_complete_contact() {
            let expected = "a number above 0, where every force from that of full contact on would do";
            return Err(Error::domain(
                "mean gap",
                self.nondimensional.approach(asked.abs())?.copysign(asked),
                expected,
            ));
        }
        if self.sliding.as_ref().is_some_and(SurfaceFriction::is_coupled) {
            let what = "a mean gap with full coupling: prescribe a force or a pressure";
            return Err(Error::unsupported(NAME, what));
        }
        Ok(())
    }

    /// The search for a mean gap from the last force on; `first` is the approach of the first touch.
    fn begin_gap_search(&self, first: f64) -> GapSearch {
        let side = (self.problem.grid().count() as f64).sqrt();
        // A wave of the rms height and the length of the map closes at about side x rms.
        let x = self.last.as_ref().map_or(0.1 * side, |last| last.force).ln();
        // With a hardness no force reaches that of all cells at it; without, this is infinite.
        let high = self.capacity().ln();
        GapSearch {
            x: x.min(high - GAP_STEP),
            low: f64::NEG_INFINITY,
            high,
            approaches: [first, f64::INFINITY],
            before: None,
        }
    }

    /// The same by approaches between one at which the gap is too large and one at which it is too small, if
    /// that is known.
    fn at_gap_by_approach(
        &mut self,
        (asked, load): (f64, ScaledTangential),
        [mut far, mut near]: [f64; 2],
        mut steps: usize,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let first = self.problem.candidates.range().first;
        let (mut last, mut interrupted) = (None, Ok(()));
        // How much the gap at an approach is too large; 0 ends the search.
        let mut miss = |d: f64| {
            if d <= first {
                return self.mean - first - asked;
            }
            let Ok(tried) = self.try_gap(asked, Control::Approach(d), &mut 0, stop) else {
                interrupted = Err(Interrupted);
                return 0.0;
            };
            steps += tried.solved.steps;
            if tried.ends {
                last = Some(tried);
                return 0.0;
            }
            self.remember(tried.solved, tried.tangent);
            tried.miss
        };
        let mut step = far - first + asked.abs() + f64::MIN_POSITIVE;
        for _ in 0..GAP_LOADS {
            if near.is_finite() {
                break;
            }
            let d = far + step;
            if miss(d) > 0.0 {
                far = d;
            } else {
                near = d;
            }
            step *= 2.0;
        }
        numerics::root::between(far, near, miss);
        interrupted.map_err(Interrupted::without_state)?;
        match last {
            Some(tried) => self.at_gap(tried, load, steps, stop),
            None => Err(self.no_such_gap(asked)?),
        }
    }

    /// Solves for a load in the search for a mean gap. One that meets the gap is followed by another one, up to
    /// `polish` times, unless it meets it by far: near full contact the force is so convex, and its stiffness
    /// depends so much on the gap, that their errors would be too small otherwise.
    fn try_gap(
        &mut self,
        asked: f64,
        control: Control,
        polish: &mut usize,
        stop: Stop<'_>,
    ) -> std::result::Result<GapTried, Interrupted> {
        let limits = self.limits();
        let (solved, tangent) = self.settle(control, limits, stop)?;
        let miss = self.gap_of(&solved) - asked;
        let bound = limits.tolerance * limits.height.unwrap_or(self.mean);
        let mut met = miss.abs() <= bound;
        if met && miss.abs() > POLISHED_GAP * bound && *polish > 0 {
            *polish -= 1;
            met = false;
        }
        let ends = met || solved.status != Status::Converged || stop.stops();
        Ok(GapTried { solved, tangent, miss, ends })
    }

    /// The state of the load that ended the search, after a number of steps.
    fn at_gap(
        &mut self,
        tried: GapTried,
        load: ScaledTangential,
        steps: usize,
        stop: Stop<'_>,
    ) -> Result<ContactState> {
        let GapTried { mut solved, tangent, miss, .. } = tried;
        solved.steps = steps;
        let k = match &tangent {
            Some(tangent) => self.stiffest(&solved, Some(tangent)),
            // A secant between the loads tried would be too small: the force is convex.
            // A stopped state has no error of the force.
            None => self.rough_stiffness(&solved, stop).unwrap_or(f64::INFINITY),
        };
        let error = self.force_error(&solved, k, miss.abs());
        let error = LoadError { load: miss.abs() / self.limits().height.unwrap_or(self.mean), ..error };
        let slid = self.slide_under(&solved, load, stop)?;
        self.state(solved, tangent, error, slid, stop)
    }

    /// The error for a mean gap that no load gives.
    fn no_such_gap(&self, asked: f64) -> Result<Error> {
        let units = self.nondimensional;
        let value = units.approach(asked.abs())?.copysign(asked);
        let min = if self.has_complete_contact() { 0.0 } else { f64::NEG_INFINITY };
        Ok(Error::OutOfRange { name: "mean gap".into(), value, min, max: units.approach(self.mean)? })
    }
}

/// A load in the search for a mean gap.
struct GapTried {
    solved: Solved,
    tangent: Option<Tangent>,
    /// How much its gap is too large.
    miss: f64,
    /// Whether it ends the search: the gap is met, or the load has not converged, or was stopped.
    ends: bool,
}
