//! Solves realisations in parallel; the results are in order.

use crate::realisation::{Model, RealisationJob, RealisationResult};
use contact_model::never;
use runs::{
    Job as _, Ordered, Progress, Result, Store, Threads, collect, largest_first, run_in_order,
    threads_for_memory,
};

/// Solves the jobs that the store does not hold, the largest first, and returns the results in the order of
/// `jobs`. The results do not depend on `threads`.
///
/// Each finished job is stored at once, so that an interruption loses only the running jobs. No more jobs run
/// at the same time than fit in memory; threads without a job help the others.
///
/// # Errors
/// [`runs::Error::Parameter`] for a size that does not fit in memory; the first error in the order of `jobs`;
/// jobs that finished before remain stored.
pub fn solve_realisations(
    what: &str,
    jobs: &[RealisationJob],
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let order = largest_first(jobs.len(), |i| jobs[i].cost());
    solve_in_order(what, &Ordered { jobs, order: &order, solved: &|_, _| Ok(()) }, store, threads, progress)
}

/// As [`solve_realisations`], but not in the order of the costs.
pub(crate) fn solve_in_order(
    what: &str,
    ordered: &Ordered<'_, RealisationJob>,
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let jobs = ordered.jobs;
    let largest = jobs.iter().map(|job| job.discretisation).max_by(|a, b| a.memory().total_cmp(&b.memory()));
    let in_flight = largest.map_or(Ok(threads), |largest| {
        let name = match largest.of() {
            Model::Bem3d => "cells",
            Model::Mdr1d => "elements",
        };
        threads_for_memory(threads, largest.memory(), name, largest.size())
    })?;
    let threads = Threads { total: threads, jobs: in_flight };
    collect(run_in_order(what, ordered, store, threads, progress, &never))
}

/// Whether the store holds a result of this job; its numbers are not read.
pub fn is_solved(job: &RealisationJob, store: &Store) -> bool {
    store.load(&RealisationJob::KIND.stored_key(&job.key())).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::realisation::Discretisation;
    use crate::sample::tests::sample;
    use std::sync::Arc;

    #[test]
    fn stored_results_are_read_bit_for_bit_and_damaged_ones_are_not() {
        let discretisation = Discretisation::Mdr1d { elements: 64 };
        let job = RealisationJob {
            discretisation,
            fractal_dimension: 2.4,
            index: 0,
            seed: 1,
            forces: [0.1, 1.0].into(),
            models: Arc::default(),
        };
        let result = RealisationResult {
            rms_height: 1.0 / 3.0,
            seconds: 0.25,
            samples: vec![sample(0.1), sample(1.0)],
        };
        let text = RealisationJob::KIND.encode(&result);
        assert_eq!(job.decode(&text).as_ref(), Some(&result));
        for cut in 0..text.len() {
            assert_eq!(job.decode(&text[..cut]), None, "{cut} bytes");
        }
        for bad in [text.replace("0.25", "inf"), text.replace("force_bar", "load"), format!("{text}\n")] {
            assert_eq!(job.decode(&bad), None, "{bad}");
        }
        let encoded = |result| RealisationJob::KIND.encode(&result);
        let of = |forces: &[f64]| RealisationResult {
            samples: forces.iter().copied().map(sample).collect(),
            ..result.clone()
        };
        for other in [of(&[1.0]), of(&[1.0, 0.1]), of(&[0.1, 1.0, 2.0])] {
            assert_eq!(job.decode(&encoded(other)), None);
        }
        let mut not_a_number = of(&[0.1, 1.0]);
        not_a_number.samples[1].stiffness_bar = Some(f64::NAN);
        assert_eq!(job.decode(&encoded(not_a_number)), None);
    }
}
