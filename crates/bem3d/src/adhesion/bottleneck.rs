//! Passing a bottleneck: the load is just beyond the end of a branch, or a jump is under way along an
//! unstable direction.
//!
//! Each update of the plain iteration changes little there until the system has left the bottleneck; the
//! change has a minimum above zero. A Newton step looks for a state without change: it leads back to the
//! unstable equilibrium, and is refused. So the plain iteration goes on, and now and then far along its own
//! change, until it contracts or turns.

use crate::real::dot;

// Half and twice the value of each constant below do not change the work of 34 paths with 65 cells a side, none of
// which has a load next to a fold. Next to folds the constants were not varied.

/// Number of updates within which the residual has to be halved.
const PATIENCE: usize = 15;
/// Plain updates between two extrapolations, during which the parts outside the slow direction decay.
const BETWEEN: usize = 3;
/// The length of the first extrapolation, as a multiple of the change of an update; each further one is twice
/// as long.
const FIRST: f64 = 4.0;
/// No attraction changes by more than this in an extrapolation, over the peak.
const FARTHEST: f64 = 0.1;
/// A plain iteration that reduces its change by this factor in an update contracts.
const CONTRACTS: f64 = 0.9;

/// Watches the residual of the updates, and leads through bottlenecks.
#[derive(Debug, Default)]
pub struct Bottleneck {
    /// The residual that has to be halved, and the number of updates since.
    least: Option<f64>,
    since: usize,
    passage: Option<Passage>,
}

/// The way through.
#[derive(Debug)]
struct Passage {
    /// Change of the attraction in the update before.
    change: Vec<f64>,
    updates: usize,
    factor: f64,
}

impl Bottleneck {
    /// Begins anew.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// The multiple of its change that the iteration should take, from this residual and this change of the
    /// attraction over its peak. `None`: the change itself, because the residual falls.
    pub fn factor(&mut self, residual: f64, change: Vec<f64>) -> Option<f64> {
        let Some(passage) = &mut self.passage else {
            if self.least.is_none_or(|least| residual <= 0.5 * least) {
                (self.least, self.since) = (Some(residual), 0);
            }
            self.since += 1;
            if self.since > PATIENCE {
                self.passage = Some(Passage { change, updates: 1, factor: FIRST });
                return Some(1.0);
            }
            return None;
        };
        if passage.change.len() == change.len() {
            let along = dot(&passage.change, &change);
            let (before, now) = (dot(&passage.change, &passage.change), dot(&change, &change));
            let turned = along <= 0.0;
            // After an extrapolation the change has other parts too.
            let contracts = passage.updates > 1 && now <= CONTRACTS * CONTRACTS * before;
            if turned || contracts {
                self.clear();
                return None;
            }
        }
        let largest = change.iter().fold(0.0f64, |most, c| most.max(c.abs()));
        passage.change = change;
        if passage.updates < BETWEEN {
            passage.updates += 1;
            return Some(1.0);
        }
        let factor = passage.factor.min(FARTHEST / largest).max(1.0);
        (passage.updates, passage.factor) = (0, 2.0 * passage.factor);
        Some(factor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Updates of `x <- x + f(x)` that take x from -1 to 1.
    fn updates(f: impl Fn(f64) -> f64, passed: bool) -> usize {
        let (mut bottleneck, mut x, mut count) = (Bottleneck::default(), -1.0, 0);
        while x < 1.0 {
            let change = f(x);
            let factor = if passed { bottleneck.factor(change, vec![change]) } else { Some(1.0) };
            x += factor.unwrap_or(1.0) * change;
            count += 1;
        }
        count
    }

    #[test]
    fn a_bottleneck_is_passed_in_few_updates() {
        // 1e-4 at its narrowest: the plain iteration takes about pi/sqrt(1e-4 0.1) updates.
        let f = |x: f64| 1e-4 + 0.1 * x * x;
        assert!(updates(f, false) > 900);
        assert!(updates(f, true) < 150, "{}", updates(f, true));
    }

    #[test]
    fn a_residual_that_falls_is_left_alone_and_one_that_turns_ends_the_passage() {
        let mut bottleneck = Bottleneck::default();
        for i in 0..100 {
            assert_eq!(bottleneck.factor(0.9f64.powi(i), vec![1.0]), None);
        }
        bottleneck.clear();
        let stuck = (0..PATIENCE).filter(|_| bottleneck.factor(1.0, vec![1.0]).is_some()).count();
        assert_eq!(stuck, 0);
        let factors: Vec<Option<f64>> = (0..5).map(|_| bottleneck.factor(1.0, vec![1e-3])).collect();
        assert_eq!(factors, [1.0, 1.0, 1.0, FIRST, 1.0].map(Some));
        assert_eq!(bottleneck.factor(1.0, vec![-1e-3]), None);
        assert_eq!(bottleneck.factor(1.0, vec![1e-3]), None);
    }
}
