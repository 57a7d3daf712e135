//! The state solved last, and what it foretells of the next.

use crate::active_set::{Guess, Solved, Target};
use crate::cells::CellSet;

/// A load this many times the last one begins cold: the last state says little about it.
const WARM_RANGE: f64 = 30.0;

/// How far the mean tangent between two loads is led on beyond the last tangent: at half way, where it holds, it would be twice as far.
const LED_ON: f64 = 1.5;

/// The state solved last, from which the next is predicted.
#[derive(Debug)]
pub struct Last {
    /// The contact set.
    pub contact: CellSet,
    /// Pressure on it.
    pub p: Vec<f64>,
    /// Approach.
    pub d: f64,
    /// Sum of the pressure.
    pub force: f64,
    /// q and its sum, where known.
    pub tangent: Option<(Vec<f64>, f64)>,
}

impl Last {
    /// How many times the last load is asked for.
    pub fn ratio(&self, target: Target) -> f64 {
        match target {
            Target::Force(force) => force / self.force,
            Target::Approach(d) => d / self.d,
        }
    }

    /// A guess of q at a state from the last one and the way between them; on the way down the last q alone.
    pub fn tangent_at(self, solved: &Solved) -> Option<Vec<f64>> {
        let mut q = solved.contact.carry(&self.contact, &self.tangent.as_ref()?.0);
        let way = solved.d - self.d;
        if way > 0.0 {
            let before = solved.contact.carry(&self.contact, &self.p);
            for ((q, p), before) in q.iter_mut().zip(&solved.p).zip(&before) {
                *q += LED_ON * ((p - before) / way - *q);
            }
        }
        Some(q)
    }

    /// Follows the tangent of the last state: `p + Dd q` on the same set. The stiffness grows with the load, so that the predicted
    /// approach is an upper bound and every new contact cell lies below it. Where no stiffness was asked for, the pressure is scaled.
    pub fn predict(&self, target: Target) -> Option<Guess> {
        let ratio = self.ratio(target);
        if !(1.0 / WARM_RANGE..=WARM_RANGE).contains(&ratio) {
            return None;
        }
        let (pressure, d): (Vec<f64>, f64) = if let Some((q, k)) = &self.tangent {
            let step = match target {
                Target::Force(force) => (force - self.force) / k,
                Target::Approach(d) => d - self.d,
            };
            let pressure = self.p.iter().zip(q).map(|(p, q)| p + step * q).collect();
            (pressure, self.d + step.max(0.0))
        } else {
            (self.p.iter().map(|p| ratio * p).collect(), self.d * ratio.max(1.0))
        };
        let set = self.contact.filter(|k| pressure[k] > 0.0);
        if set.is_empty() {
            return None;
        }
        let p = pressure.into_iter().filter(|&p| p > 0.0).collect();
        Some(Guess { set, p, d: d.max(f64::MIN_POSITIVE), far: false })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active_set::{self, Limits, Problem};
    use crate::stiffness;
    use approx::assert_relative_eq;
    use contact_model::{Boundary, never};
    use std::sync::Arc;

    const SIDE: usize = 48;

    /// A paraboloid with waves on it under a path of forces; the state and q at each.
    fn path(forces: &[f64]) -> (Problem, Vec<(Solved, Vec<f64>)>) {
        let z = (0..SIDE * SIDE)
            .map(|i| {
                let (x, y) = ((i % SIDE) as f64 - 23.0, (i / SIDE) as f64 - 24.0);
                (x * x + y * y) / 100.0 + 0.4 * (1.0 - f64::cos(0.9 * x) * f64::cos(0.7 * y))
            })
            .collect();
        let mut problem = Problem::new(SIDE, Arc::new(z), Boundary::Free);
        let limits = Limits { tolerance: 1e-9, height: Some(1.0), rounds: 200, dense: false };
        let states = forces
            .iter()
            .map(|&force| {
                let all = (0..(SIDE * SIDE) as u32).collect();
                let (set, p) = (CellSet::new(SIDE, all), vec![1.0; SIDE * SIDE]);
                let guess = Guess { set, p, d: 4.0 * force, far: false };
                let solved = active_set::solve(&mut problem, Target::Force(force), guess, limits, &never);
                let k = stiffness::on_lists(&mut problem, &solved, None, 1e-9, &never);
                (solved, k.q)
            })
            .collect();
        (problem, states)
    }

    fn last((solved, q): &(Solved, Vec<f64>)) -> Last {
        Last {
            contact: solved.contact.clone(),
            p: solved.p.clone(),
            d: solved.d,
            force: solved.p.iter().sum(),
            tangent: Some((q.clone(), q.iter().sum())),
        }
    }

    #[test]
    fn the_way_between_two_loads_says_more_than_the_tangent_at_the_first() {
        let (mut problem, states) = path(&[100.0, 200.0]);
        let solved = &states[1].0;
        let carried = solved.contact.carry(&states[0].0.contact, &states[0].1);
        let led = last(&states[0]).tangent_at(solved).unwrap();
        // A tolerance that any guess meets returns what the guess is worth.
        let [carried, led] = [carried, led].map(|q| {
            let k = stiffness::on_lists(&mut problem, solved, Some(q), 100.0, &never);
            assert_eq!(k.steps, 0);
            k.solve_error
        });
        assert!(led < 0.5 * carried, "{led} {carried}");
        // Without a way, or on the way down, there is no better guess than the tangent at the larger load.
        let back = last(&states[1]).tangent_at(&states[0].0).unwrap();
        assert_eq!(back, states[0].0.contact.carry(&solved.contact, &states[1].1));
        assert_eq!(last(&states[1]).tangent_at(solved).unwrap(), states[1].1);
    }

    #[test]
    fn the_tangent_foretells_an_approach_from_above() {
        let (_, states) = path(&[100.0, 150.0]);
        let (before, after) = (last(&states[0]), &states[1].0);
        let guess = before.predict(Target::Force(150.0)).unwrap();
        assert!(guess.d > after.d && guess.d < 1.2 * after.d, "{} {}", guess.d, after.d);
        assert_relative_eq!(guess.p.iter().sum::<f64>(), 150.0, max_relative = 1e-6);
        let approach = before.predict(Target::Approach(after.d)).unwrap();
        assert_relative_eq!(approach.d, after.d);
        assert!(approach.p.iter().sum::<f64>() < 150.0, "the stiffness grows on the way");
        // Without a tangent the pressure is scaled; down the approach stays where it was.
        let bare = Last { tangent: None, ..last(&states[0]) };
        let down = bare.predict(Target::Force(50.0)).unwrap();
        assert_relative_eq!(down.d, bare.d);
        assert_relative_eq!(down.p[7], 0.5 * bare.p[7], max_relative = 1e-6);
        let up = bare.predict(Target::Force(200.0)).unwrap();
        assert_relative_eq!(up.d, 2.0 * bare.d, max_relative = 1e-6);
        assert_relative_eq!(bare.ratio(Target::Approach(2.0 * bare.d)), 2.0);
        // What does not press is not guessed to.
        let mut p = bare.p.clone();
        p[7] = 0.0;
        let lifted = Last { p, ..last(&states[0]) };
        let guess = Last { tangent: None, ..lifted }.predict(Target::Force(100.0)).unwrap();
        assert_eq!((guess.set.len(), guess.p.len()), (bare.p.len() - 1, bare.p.len() - 1));
        for far in [3.3, 3001.0] {
            assert!(bare.predict(Target::Force(far)).is_none(), "thirty times away is far");
        }
    }
}
