//! Realisations in parallel, results in order.

use crate::realisation::{Discretisation, FORMAT, Models, Realisation, RealisationResult};
use contact_model::{Stop, never};
use runs::{
    Error, Job, Progress, Result, ResultKind, Store, Threads, collect, run_stored, threads_for_memory,
};
use std::sync::Arc;

/// Solves what the store does not hold, the largest first, and gives the results in the order of
/// `realisations`. The results do not depend on `threads`.
///
/// Each finished job is stored at once: an interruption loses those in flight. No more jobs are in flight
/// than fit in memory; threads without a job help inside the others.
///
/// # Errors
/// [`Error::Parameter`] for a size that does not fit in memory;
/// the first error in the order of `realisations`; jobs that finished before stay stored.
pub fn solve_realisations(
    what: &str,
    realisations: &[Realisation],
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let largest = realisations
        .iter()
        .map(|realisation| realisation.discretisation)
        .max_by(|a, b| a.memory().total_cmp(&b.memory()));
    let in_flight = largest.map_or(Ok(threads), |largest| {
        let name = if matches!(largest, Discretisation::Bem3d { .. }) { "cells" } else { "elements" };
        threads_for_memory(threads, largest.memory(), name, largest.size())
    })?;
    let jobs = realisation_jobs(realisations.to_vec());
    let threads = Threads { total: threads, jobs: in_flight };
    collect(run_stored(what, &jobs, store, threads, progress, &never))
}

/// Units as jobs that share what a line's ensemble plans once.
pub fn realisation_jobs(realisations: Vec<Realisation>) -> Vec<RealisationJob> {
    let models = Arc::new(Models::default());
    realisations
        .into_iter()
        .map(|realisation| RealisationJob { realisation, models: Arc::clone(&models) })
        .collect()
}

/// Whether the store holds a result of this realisation; its numbers are not read.
pub fn is_solved(realisation: &Realisation, store: &Store) -> bool {
    store.load(&RealisationJob::KIND.stored_key(&realisation.key())).is_some()
}

/// A realisation with what all of them share.
#[derive(Debug, Clone)]
pub struct RealisationJob {
    realisation: Realisation,
    models: Arc<Models>,
}

impl Job for RealisationJob {
    type Output = RealisationResult;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("realisation", FORMAT);

    fn key(&self) -> String {
        self.realisation.key()
    }

    fn name(&self) -> String {
        let Realisation { discretisation, fractal_dimension, index, .. } = &self.realisation;
        let (model, size) = (discretisation.name(), discretisation.size());
        let kind =
            if matches!(discretisation, Discretisation::Bem3d { .. }) { "cells a side" } else { "elements" };
        format!("{model}, D_f = {fractal_dimension:?}, surface {index}, {size} {kind}")
    }

    fn cost(&self) -> u64 {
        self.realisation.cost()
    }

    fn memory(&self) -> f64 {
        self.realisation.discretisation.memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 500 * self.realisation.forces.len() as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<RealisationResult> {
        self.realisation.solve_among(&self.models, stop)
    }

    /// The loads are part of the key; the samples must be of those loads.
    fn is_whole(&self, result: &RealisationResult) -> bool {
        let solved = result.samples.iter().map(|sample| sample.force_bar.to_bits());
        solved.eq(self.realisation.forces.iter().map(|force| force.to_bits()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::tests::sample;

    #[test]
    fn units_come_back_bit_for_bit_and_damage_does_not() {
        let discretisation = Discretisation::Mdr1d { elements: 64 };
        let realisation = Realisation {
            discretisation,
            fractal_dimension: 2.4,
            index: 0,
            seed: 1,
            forces: [0.1, 1.0].into(),
        };
        let job = realisation_jobs(vec![realisation]).remove(0);
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
