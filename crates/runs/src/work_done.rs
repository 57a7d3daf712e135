//! How much of the work of a run is done.

use crate::progress::JobInHand;
use std::collections::BTreeMap;

/// Least work, in seconds, from which a remaining time is predicted.
const FIRST: f64 = 1.0;

/// The work of a stage of a run, as relative costs, and how much of it is done.
#[derive(Debug, Default)]
pub struct WorkDone {
    total: f64,
    /// Of whole jobs.
    whole: f64,
    /// Of jobs under way, by their names.
    parts: BTreeMap<String, JobPart>,
    /// Costs of jobs whose states are all solved and whose pictures are drawn.
    finished: Vec<u64>,
    /// The part of it that was found on disk, which does not predict the time of the rest.
    found: f64,
}

/// Of a job under way.
#[derive(Debug, Clone, Copy)]
struct JobPart {
    cost: f64,
    /// States that are solved.
    states: usize,
    /// First residual of the state in hand.
    first: f64,
}

impl WorkDone {
    /// Work of this relative cost, of which nothing is done.
    pub fn new(total: u64) -> Self {
        Self { total: total as f64, ..Self::default() }
    }

    /// The relative cost of all of it.
    pub fn total(&self) -> f64 {
        self.total
    }

    /// A job is done; `reused` when it was found on disk.
    pub fn add(&mut self, cost: u64, reused: bool) {
        if let Some(place) = self.finished.iter().position(|finished| *finished == cost) {
            self.finished.swap_remove(place);
        }
        self.whole += cost as f64;
        if reused {
            self.found += cost as f64;
        }
    }

    /// A job is as far as this.
    pub fn set(&mut self, job: &JobInHand<'_>) {
        let of_states = job.cost.saturating_sub(job.pictures.cost) as f64;
        let of_state = of_states / job.all.max(1) as f64;
        if !self.parts.contains_key(job.name) {
            // What this run has not solved: the state that it tells of was solved by it.
            let solved_now = usize::from(job.residual.is_none());
            self.found += of_state * job.done.saturating_sub(solved_now) as f64;
        }
        if job.done >= job.all && job.pictures.drawn >= job.pictures.all {
            // The job counts as a whole when its result is stored, too.
            if self.parts.remove(job.name).is_some() {
                self.finished.push(job.cost);
            }
            return;
        }
        let new = JobPart { cost: 0.0, states: job.done, first: 0.0 };
        let part = self.parts.entry(job.name.to_owned()).or_insert(new);
        if part.states != job.done {
            *part = new;
        }
        let share = job.residual.map_or(0.0, |(residual, tolerance)| {
            // The states are still to come.
            if job.on_coarser_grids {
                return 0.0;
            }
            part.first = if residual.is_finite() { part.first.max(residual) } else { part.first };
            of_the_way(part.first, residual, tolerance)
        });
        let of_pictures = if job.done < job.all {
            0.0
        } else {
            job.pictures.cost as f64 * job.pictures.drawn as f64 / job.pictures.all.max(1) as f64
        };
        part.cost = part.cost.max(of_state * (job.done as f64 + share) + of_pictures);
    }

    /// The relative cost of what is done.
    pub fn cost(&self) -> f64 {
        let under_way: f64 = self.parts.values().map(|part| part.cost).sum();
        let finished: f64 = self.finished.iter().map(|cost| *cost as f64).sum();
        (self.whole + finished + under_way).min(self.total)
    }

    /// Predicted seconds for the rest after `seconds`, at the rate of this run so far. `None` where the run
    /// has done too little for a prediction.
    pub fn left(&self, seconds: f64) -> Option<f64> {
        let (cost, solved) = (self.cost(), self.cost() - self.found);
        (solved > 0.0 && seconds >= FIRST).then(|| seconds * (self.total - cost) / solved)
    }
}

/// Share of the way of a residual from the first one to the tolerance, in orders of magnitude: iterations
/// reduce it by about the same factor each.
fn of_the_way(first: f64, residual: f64, tolerance: f64) -> f64 {
    let (all, gone) = ((first / tolerance).ln(), (first / residual).ln());
    if all > 0.0 && gone > 0.0 && all.is_finite() { (gone / all).min(1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::{JobInHand, Pictures};

    #[test]
    fn time_left_follows_from_what_this_run_has_done() {
        let mut done = WorkDone { total: 100.0, ..WorkDone::default() };
        done.add(40, true);
        assert_eq!(done.left(5.0), None);
        done.add(10, false);
        // Ten took five seconds, fifty are left.
        assert_eq!(done.left(5.0), Some(25.0));
        assert_eq!(done.left(0.5), None);
        // A path of four states with two of them on disk, the third half way to its tolerance.
        let pictures = Pictures::default();
        let residual = Some((1e-2, 1e-6));
        let mut job = JobInHand {
            name: "path",
            cost: 40,
            done: 2,
            all: 4,
            pictures,
            residual,
            on_coarser_grids: false,
        };
        done.set(&job);
        assert_eq!((done.cost(), done.found), (70.0, 60.0));
        job.residual = Some((1e-4, 1e-6));
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 75.0, max_relative = 1e-12);
        approx::assert_relative_eq!(done.left(15.0).unwrap(), 15.0 * 25.0 / 15.0, max_relative = 1e-12);
        // Residuals that rise take nothing back.
        job.residual = Some((1e-1, 1e-6));
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 75.0, max_relative = 1e-12);
        // The whole job is counted when it is done.
        done.set(&JobInHand { done: 4, residual: None, ..job });
        // It is no less while its files are written.
        assert_eq!((done.cost(), done.parts.len()), (90.0, 0));
        done.add(40, false);
        assert_eq!((done.cost(), done.finished.len()), (90.0, 0));
    }

    #[test]
    fn a_job_is_not_done_before_its_pictures_are_drawn() {
        let mut done = WorkDone { total: 50.0, ..WorkDone::default() };
        let pictures = Pictures { cost: 20, drawn: 0, all: 4 };
        let mut job = JobInHand {
            name: "map",
            cost: 50,
            done: 2,
            all: 3,
            pictures,
            residual: None,
            on_coarser_grids: false,
        };
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 20.0, max_relative = 1e-12);
        job.done = 3;
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 30.0, max_relative = 1e-12);
        job.pictures.drawn = 1;
        done.set(&job);
        approx::assert_relative_eq!(done.cost(), 35.0, max_relative = 1e-12);
        assert_eq!(job.words(), "picture 2 of 4 of map");
        job.pictures.drawn = 4;
        done.set(&job);
        assert_eq!((done.cost(), job.words()), (50.0, "files of map".to_owned()));
        done.add(50, false);
        assert_eq!((done.cost(), done.finished.len()), (50.0, 0));
    }

    #[test]
    fn words_of_a_job_name_its_state_and_residual() {
        let pictures = Pictures::default();
        let mut job = JobInHand {
            name: "bem3d",
            cost: 1,
            done: 3,
            all: 10,
            pictures,
            residual: None,
            on_coarser_grids: false,
        };
        assert_eq!(job.words(), "3 of 10 states of bem3d");
        job.residual = Some((3.2e-5, 1e-8));
        assert_eq!(job.words(), "state 4 of 10, residual 3e-5 of 1e-8, bem3d");
        job.on_coarser_grids = true;
        assert_eq!(job.words(), "coarser grids, residual 3e-5 of 1e-8, bem3d");
        job.done = 10;
        assert_eq!(job.words(), "files of bem3d");
    }

    #[test]
    fn the_way_to_the_tolerance_is_counted_in_orders() {
        let way = |residual| of_the_way(1.0, residual, 1e-8);
        let none = |share: f64| share.abs() < 1e-300;
        assert!(none(way(2.0)) && none(way(1.0)) && none(of_the_way(1e-9, 1e-9, 1e-8)));
        assert!(none(way(1e-9) - 1.0));
        approx::assert_relative_eq!(way(1e-2), 0.25, max_relative = 1e-12);
        for unknown in [f64::INFINITY, f64::NAN] {
            assert!(none(of_the_way(unknown, 1.0, 1e-8)) && none(of_the_way(1.0, unknown, 1e-8)));
        }
    }
}
