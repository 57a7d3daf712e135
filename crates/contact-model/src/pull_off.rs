//! The largest pull along a path with adhesion, and a bound for the pull-off force between its steps.
//!
//! A path visits single loads. The pull-off force is the largest pull of all states of the branch, also
//! between these loads, so it is at least the largest pull P of the loads visited. How much larger it may be
//! depends on what is prescribed:
//!
//! * Where a prescribed force is larger than the contact can bear, the pull-off force lies between the pull
//!   of the last stable state and that force.
//! * Where an approach or a mean gap is prescribed, the force F over the distance x falls to its minimum at
//!   the load i and the next loads of the withdrawal, x_(i+1) < x_i < x_(i-1), are beyond it. The branch is
//!   taken to be convex there (that of a sphere is): it lies above the line through (i-1, i) as far as
//!   x_(i+1), and between i and i-1 above the lines through (i+1, i) and (i-2, i-1). Patches of a rough
//!   contact that jump between the loads make it an estimate.
//!
//! Elsewhere (the loads turn, or end, at the largest pull) no load is beyond pull-off, and the path gives no
//! upper bound.

use crate::load::NormalLoad;
use crate::state::{ContactState, PullOff, Status};

/// Follows a path and reports the largest pull so far.
///
/// ```
/// use contact_model::{ContactState, LargestPull, NormalLoad, SolveReport, Status};
/// let state = |force: f64| ContactState::new(force, SolveReport::exact("test"));
/// let mut largest = LargestPull::default();
/// assert_eq!(largest.enter(NormalLoad::Force(1.0), state(1.0)).pull_off, None);
/// assert_eq!(largest.enter(NormalLoad::Force(-2.0), state(-2.0)).pull_off.unwrap().force, 2.0);
/// // A force of -3 is not held: the state is the last stable one.
/// let mut last = state(-2.0);
/// last.report.status = Status::PulledOff;
/// assert_eq!(largest.enter(NormalLoad::Force(-3.0), last).pull_off.unwrap().error, Some(1.0));
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct LargestPull {
    /// The stable states, in their order.
    held: Vec<PathPoint>,
    /// Index of the state of the largest pull.
    largest: usize,
}

/// A state of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct PathPoint {
    /// The prescribed distance by which the bodies are pressed together; `None` under a prescribed force.
    distance: Option<f64>,
    force: f64,
    approach: Option<f64>,
    mean_gap: Option<f64>,
}

impl LargestPull {
    /// Enters the state of the next load, and returns it with the largest pull of the path so far, which is
    /// `None` as long as no load pulled. A state of [`Status::PulledOff`] is the last stable one before a
    /// load that the contact could not bear.
    ///
    /// Cost: O(1).
    #[must_use]
    pub fn enter(&mut self, load: NormalLoad, state: ContactState) -> ContactState {
        let mut beyond = None;
        if state.report.status == Status::PulledOff {
            beyond = Some(load);
        } else {
            let ContactState { approach, mean_gap, .. } = state;
            // A force that presses, or none, pulls nothing, whatever the rounding of its sum.
            let pressed = matches!(load, NormalLoad::Force(asked) if asked >= 0.0);
            let force = if pressed { state.force.max(0.0) } else { state.force };
            if self.held.get(self.largest).is_some_and(|largest| force < largest.force) {
                self.largest = self.held.len();
            }
            let distance = match load {
                NormalLoad::Approach(approach) => Some(approach),
                NormalLoad::MeanGap(gap) => Some(-gap),
                NormalLoad::Force(_) => None,
            };
            self.held.push(PathPoint { distance, force, approach, mean_gap });
        }
        ContactState { pull_off: self.pull_off(beyond), ..state }
    }

    fn pull_off(&self, beyond: Option<NormalLoad>) -> Option<PullOff> {
        let PathPoint { force, approach, mean_gap, .. } =
            *self.held.get(self.largest).filter(|largest| largest.force < 0.0)?;
        let error = match beyond {
            Some(NormalLoad::Force(asked)) => Some((force - asked).max(0.0)),
            _ => self.left_by_steps(),
        };
        Some(PullOff { force: -force, error, approach, mean_gap })
    }

    /// Largest fall of the force below its minimum between the loads of a withdrawal; `None` where nothing
    /// bounds it.
    fn left_by_steps(&self) -> Option<f64> {
        let at = |i: Option<usize>| {
            let point = self.held.get(i?)?;
            Some((point.distance?, point.force))
        };
        let i = self.largest;
        let (x, force) = at(Some(i))?;
        let (before, after) = (at(i.checked_sub(1))?, at(i.checked_add(1))?);
        if !(after.0 < x && x < before.0) {
            return None;
        }
        let slope = |(x0, f0): (f64, f64), (x1, f1): (f64, f64)| (f1 - f0) / (x1 - x0);
        let below = slope((x, force), before).max(0.0) * (x - after.0);
        // Between this load and the one before: two lines, of which the second may be missing.
        let away = (-slope(after, (x, force))).max(0.0);
        let width = before.0 - x;
        let whole = away * width;
        let above = match at(i.checked_sub(2)).filter(|earlier| earlier.0 > before.0) {
            None => whole,
            Some(earlier) => {
                let fall = slope(before, earlier).max(0.0);
                // Where `force - away s` and `before - fall (width - s)` meet.
                let s =
                    if away + fall > 0.0 { (force - before.1 + fall * width) / (away + fall) } else { 0.0 };
                away * s.clamp(0.0, width)
            }
        };
        Some(below.max(above))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::SolveReport;

    fn follow(path: &[(NormalLoad, f64)]) -> Option<PullOff> {
        let mut largest = LargestPull::default();
        let states = path.iter().map(|&(load, force)| {
            let approach = if let NormalLoad::Approach(d) = load { Some(d) } else { None };
            let state = ContactState::new(force, SolveReport::exact("test")).with_approach(approach);
            largest.enter(load, state).pull_off
        });
        states.last().flatten()
    }

    fn withdrawal(force: impl Fn(f64) -> f64, loads: &[f64]) -> Option<PullOff> {
        follow(&loads.iter().map(|&d| (NormalLoad::Approach(d), force(d))).collect::<Vec<_>>())
    }

    #[test]
    fn the_minimum_of_a_convex_branch_lies_in_the_interval_wherever_the_loads_are() {
        // Any convex branch, here with a minimum of -1 at 0, which ends at d = -0.8.
        let force = |d: f64| if d < -0.8 { 0.0 } else { d * d - 1.0 };
        for k in 0..100 {
            let offset = f64::from(k) * 0.003;
            let loads: Vec<f64> = (0..9).map(|i| 1.3 - offset - 0.3 * f64::from(i)).collect();
            let found = withdrawal(force, &loads).unwrap();
            let error = found.error.unwrap();
            assert!(found.force <= 1.0 && 1.0 <= found.force + error + 1e-12, "{found:?}");
            assert!(error <= 2.0 * 0.3 * 0.3, "{found:?}: of second order in the step");
            assert_eq!(found.approach.map(force), Some(-found.force));
        }
    }

    #[test]
    fn pull_that_grows_until_the_bodies_part_is_bounded_by_its_slope() {
        let force = |d: f64| if d < -1.0 { 0.0 } else { d };
        let found = withdrawal(force, &[1.0, 0.5, 0.0, -0.5, -0.9, -1.3]).unwrap();
        assert_eq!((found.force, found.approach), (0.9, Some(-0.9)));
        let (least, most) = (found.force, found.force + found.error.unwrap());
        assert!(least < 1.0 && 1.0 < most && (most - 1.3).abs() < 1e-12, "{found:?}");
    }

    #[test]
    fn nothing_bounds_a_pull_that_no_load_is_beyond() {
        let line = |d: f64| d;
        assert_eq!(withdrawal(line, &[1.0, 0.5, 0.0]), None, "no pull");
        let error = |loads: &[f64]| withdrawal(line, loads).unwrap().error;
        assert_eq!(error(&[1.0, 0.0, -1.0]), None, "the path ends");
        assert_eq!(error(&[1.0, 0.0, -1.0, 0.0, 1.0]), None, "the path turns");
        assert_eq!(error(&[-1.0]), None);
        let snap =
            [(2.0, 0.0), (1.0, -0.5), (0.0, 1.0)].map(|(gap, force)| (NormalLoad::MeanGap(gap), force));
        assert_eq!(follow(&snap).map(|p| (p.force, p.error)), Some((0.5, None)), "on approach");
        let forces = [1.0, -1.0, 1.0].map(|force| (NormalLoad::Force(force), force));
        assert_eq!(follow(&forces).map(|p| (p.force, p.error)), Some((1.0, None)), "as prescribed");
        let mixed = [
            (NormalLoad::Approach(1.0), 1.0),
            (NormalLoad::Force(-1.0), -1.0),
            (NormalLoad::Approach(-2.0), 0.0),
        ];
        assert_eq!(follow(&mixed).unwrap().error, None);
    }

    #[test]
    fn later_smaller_pulls_change_nothing() {
        let mut path = vec![
            (NormalLoad::MeanGap(-1.0), 1.0),
            (NormalLoad::MeanGap(0.0), -1.0),
            (NormalLoad::MeanGap(1.0), 0.0),
        ];
        let first = follow(&path);
        assert_eq!(first.unwrap().error, Some(2.0));
        path.extend([
            (NormalLoad::MeanGap(-1.0), 1.0),
            (NormalLoad::MeanGap(0.0), -0.5),
            (NormalLoad::MeanGap(1.0), 0.0),
        ]);
        assert_eq!(follow(&path), first);
    }
}
