//! Units in parallel, results in order.

use crate::realisation::{Discretisation, Models, Realisation, RealisationResult};
use crate::sample::{FIELDS, Sample};
use contact_model::{Stop, never};
use runs::{Error, Job, Progress, Result, Store, Threads, collect, number, run_stored, threads_for_memory};
use std::sync::Arc;

/// Solves all units that the store does not hold, the largest first, and gives the results in the order of
/// `units`. The results do not depend on `threads`.
///
/// Each finished unit is stored at once: an interruption loses those in flight. No more units are in flight than fit in memory; threads without
/// a unit help inside the others.
///
/// # Errors
/// [`Error::Parameter`] for a size that does not fit in memory;
/// the first error in the order of `units`; units that finished before stay stored.
pub fn sweep(
    what: &str,
    units: &[Realisation],
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<RealisationResult>> {
    let largest =
        units.iter().map(|unit| unit.discretisation).max_by(|a, b| a.memory().total_cmp(&b.memory()));
    let in_flight = largest.map_or(Ok(threads), |largest| {
        let name = if matches!(largest, Discretisation::Bem3d { .. }) { "cells" } else { "elements" };
        threads_for_memory(threads, largest.memory(), name, largest.size())
    })?;
    let jobs = realisation_jobs(units.to_vec());
    let threads = Threads { total: threads, jobs: in_flight };
    collect(run_stored(what, &jobs, store, threads, progress, &never))
}

/// Units as jobs that share what a line's ensemble plans once.
pub fn realisation_jobs(units: Vec<Realisation>) -> Vec<RealisationJob> {
    let models = Arc::new(Models::default());
    units.into_iter().map(|unit| RealisationJob { unit, models: Arc::clone(&models) }).collect()
}

/// A unit with what all of them share.
#[derive(Debug, Clone)]
pub struct RealisationJob {
    unit: Realisation,
    models: Arc<Models>,
}

impl Job for RealisationJob {
    type Output = RealisationResult;
    type Error = Error;

    fn key(&self) -> String {
        self.unit.key()
    }

    fn name(&self) -> String {
        let Realisation { discretisation, fractal_dimension, index, .. } = &self.unit;
        let (model, size) = (discretisation.name(), discretisation.size());
        let kind =
            if matches!(discretisation, Discretisation::Bem3d { .. }) { "cells a side" } else { "elements" };
        format!("{model}, D_f = {fractal_dimension:?}, surface {index}, {size} {kind}")
    }

    fn cost(&self) -> u64 {
        self.unit.cost()
    }

    fn memory(&self) -> f64 {
        self.unit.discretisation.memory()
    }

    fn stored_bytes(&self) -> u64 {
        1000 + 250 * self.unit.forces.len() as u64
    }

    fn solve(&self, stop: Stop<'_>) -> Result<RealisationResult> {
        self.unit.solve_among(&self.models, stop)
    }

    fn encode(&self, result: &RealisationResult) -> String {
        let mut table = csv::Writer::from_writer(Vec::new());
        // Writing into memory does not fail; what it would leave is no result when it is read.
        let _ = table.write_record(FIELDS);
        for sample in &result.samples {
            let _ = table.write_record(sample.fields());
        }
        let table = String::from_utf8(table.into_inner().unwrap_or_default()).unwrap_or_default();
        let (height, seconds) = (number(result.rms_height), number(result.seconds));
        format!("# measured_rms_height {height}\n# seconds {seconds}\n{table}")
    }

    fn decode(&self, text: &str) -> Option<RealisationResult> {
        let (height, rest) = text.strip_prefix("# measured_rms_height ")?.split_once('\n')?;
        let (seconds, table) = rest.strip_prefix("# seconds ")?.split_once('\n')?;
        let finite = |t: &str| t.parse::<f64>().ok().filter(|v| v.is_finite());
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        if reader.headers().ok()?.iter().ne(FIELDS) {
            return None;
        }
        let samples: Vec<Sample> = reader
            .records()
            .map(|record| record.ok().and_then(|r| Sample::from_fields(r.iter())))
            .collect::<Option<_>>()?;
        // The loads are part of the key; the rows must be those loads.
        let solved = samples.iter().map(|s| s.force_bar.to_bits());
        if solved.ne(self.unit.forces.iter().map(|f| f.to_bits())) {
            return None;
        }
        Some(RealisationResult { rms_height: finite(height)?, seconds: finite(seconds)?, samples })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::tests::sample;

    #[test]
    fn units_come_back_bit_for_bit() {
        let discretisation = Discretisation::Mdr1d { elements: 64 };
        let unit = Realisation {
            discretisation,
            fractal_dimension: 2.4,
            index: 0,
            seed: 1,
            forces: [0.1, 1.0].into(),
        };
        let job = realisation_jobs(vec![unit]).remove(0);
        let result = RealisationResult {
            rms_height: 1.0 / 3.0,
            seconds: 0.25,
            samples: vec![sample(0.1), sample(1.0)],
        };
        let text = job.encode(&result);
        assert_eq!(job.decode(&text), Some(result));
        let without_a_row: String =
            text.lines().filter(|l| !l.starts_with("0.1,")).flat_map(|l| [l, "\n"]).collect();
        for bad in
            [without_a_row, text.replace("0.25", "inf"), text.replace("force_bar", "load"), String::new()]
        {
            assert_eq!(job.decode(&bad), None, "{bad}");
        }
    }
}
