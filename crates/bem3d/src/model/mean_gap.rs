//! Mean gaps with periodic boundaries, which replace the approach, and the stiffness from a kernel with a
//! constant.

use super::certificate::LoadError;
use super::options::NAME;
use super::prepared::PreparedSurface;
use super::sliding::Sliding;
use crate::active_set::{Bounds, Control, Solved};
use crate::tuning::{GAP_LOADS, GAP_STEP};
use contact_model::{ContactState, Error, Result, Status, Stop};

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

    /// The state at a nondimensional mean gap, by Newton's method in ln F where the stiffness is known and
    /// secants where it is not: the gap falls about linearly with ln F. It is met to the tolerance, in rms
    /// heights. Where every cell in contact is at the hardness one force belongs to a range of gaps, and the search
    /// goes on in the approach.
    pub(super) fn at_mean_gap(&mut self, asked: f64, stop: Stop<'_>) -> Result<ContactState> {
        let first = self.problem.candidates.range().first;
        if asked >= self.mean - first {
            // Apart, or touching: the gap is the one asked for.
            return self.no_contact(self.mean - asked);
        }
        if asked <= 0.0 && self.has_complete_contact() {
            let expected = "a number above 0, where every force from that of full contact on would do";
            return Err(Error::domain(
                "mean gap",
                self.nondimensional.approach(asked.abs())?.copysign(asked),
                expected,
            ));
        }
        if self.sliding.as_ref().is_some_and(Sliding::is_coupled) {
            let what = "a mean gap with full coupling: prescribe a force or a pressure";
            return Err(Error::unsupported(NAME, what));
        }
        self.begin_count();
        let (limits, side) = (self.limits(), (self.problem.grid().count() as f64).sqrt());
        // A wave of the rms height and the length of the map closes at about side x rms.
        let mut x = self.last.as_ref().map_or(0.1 * side, |last| last.force).ln();
        // With a hardness no force reaches that of all cells at it; without, this is infinite.
        let (mut low, mut high) = (f64::NEG_INFINITY, self.capacity().ln());
        x = x.min(high - GAP_STEP);
        let mut control = Control::Force(x.exp());
        // Approaches at which the gap is too large, and too small.
        let mut approaches = [f64::NEG_INFINITY, f64::INFINITY];
        let mut before: Option<(f64, f64)> = None;
        let mut followed: Option<(f64, f64)> = None;
        let mut steps = 0;
        for _ in 0..GAP_LOADS {
            let (mut solved, tangent) = self.settle(control, limits, stop);
            steps += solved.steps;
            let miss = self.gap_of(&solved) - asked;
            let met = miss.abs() <= limits.tolerance * limits.height.unwrap_or(self.mean);
            if met || solved.status != Status::Converged || stop.stops() {
                solved.steps = steps;
                let k = match &tangent {
                    Some(tangent) => self.stiffest(&solved, Some(tangent)),
                    // A secant between the loads tried would be too small: the force is convex.
                    None => self.rough_stiffness(&solved, stop),
                };
                let error = self.force_error(&solved, k, miss.abs());
                let error = LoadError { load: miss.abs() / limits.height.unwrap_or(self.mean), ..error };
                let slid = self.slide(&solved, stop)?;
                return self.state(solved, tangent, error, slid, stop);
            }
            let (force, d): (f64, f64) = (solved.p.iter().sum(), solved.d);
            if miss > 0.0 {
                low = low.max(x);
                approaches[0] = d.max(approaches[0]);
            } else {
                high = high.min(x);
                approaches[1] = d.min(approaches[1]);
            }
            let reached = self.problem.bounds.is_reached(&solved.p);
            if matches!(control, Control::Approach(_)) || reached && self.responding(&solved).cells.is_empty()
            {
                // Cells that begin to flow are in the secant and not in the tangent.
                let tangent_slope = tangent.as_ref().map_or(1.0, |t| self.magnification(t.stiffness.value));
                let secant = followed.map_or(f64::NAN, |(d0, miss0)| (d - d0) / (miss0 - miss));
                let slope = if secant.is_finite() && secant > 0.0 { secant } else { tangent_slope };
                followed = Some((d, miss));
                let next = d + miss * slope;
                let [far, near] = approaches;
                let within = next > far && next < near;
                control = Control::Approach(if within { next } else { f64::midpoint(far, near) });
                self.remember(solved, tangent);
                continue;
            }
            let slope = match (&tangent, before) {
                (Some(t), _) => t.stiffness.value * self.magnification(t.stiffness.value) / force,
                (None, Some((x0, miss0))) if (miss0 - miss).abs() > 0.0 => (x - x0) / (miss0 - miss),
                _ => 1.0 / self.mean,
            };
            before = Some((x, miss));
            let next = x + (miss * slope).clamp(-GAP_STEP, GAP_STEP);
            self.remember(solved, tangent);
            x = if next > low && next < high {
                next
            } else if low.is_finite() && high.is_finite() {
                if reached {
                    control = Control::Approach(f64::midpoint(approaches[0], approaches[1]));
                    continue;
                }
                f64::midpoint(low, high)
            } else {
                x + GAP_STEP.copysign(miss)
            };
            control = Control::Force(x.exp());
        }
        let units = self.nondimensional;
        let value = units.approach(asked.abs())?.copysign(asked);
        let min = if self.has_complete_contact() { 0.0 } else { f64::NEG_INFINITY };
        Err(Error::OutOfRange { name: "mean gap".into(), value, min, max: units.approach(self.mean)? })
    }
}
