//! Units in parallel, results in order.

use crate::error::{Error, Result};
use crate::job_queue::{largest_first, run_jobs};
use crate::progress::Progress;
use crate::store::Store;
use crate::unit::{Models, Unit, UnitResult};
use contact_model::{Stop, never};

/// Solves all units that the store does not hold, one per thread, the largest first, and gives the results in the order of
/// `units`. The results do not depend on `threads`.
///
/// Each finished unit is stored at once: an interruption loses those in flight.
///
/// # Errors
/// The first error in the order of `units`; units that finished before stay stored.
pub fn sweep(
    what: &str,
    units: &[Unit],
    store: &Store,
    threads: usize,
    progress: &dyn Progress,
) -> Result<Vec<UnitResult>> {
    progress.begin(what, units.iter().map(Unit::cost).sum());
    let models = Models::default();
    let order = largest_first(units.len(), |i| units[i].cost());
    let done = run_jobs(threads, &order, &never, |i, stop| one(&units[i], &models, store, stop, progress))
        .map_err(|e| Error::parameter("threads", threads, format!("threads that the system grants ({e})")))?;
    progress.end();
    collect(done)
}

/// All results, or the error that started it.
pub(crate) fn collect<T>(done: Vec<Option<Result<T>>>) -> Result<Vec<T>> {
    let mut results = Vec::with_capacity(done.len());
    let mut stopped = None;
    for result in done.into_iter().flatten() {
        match result {
            Ok(result) => results.push(result),
            // Others that were in flight were told to stop: their reason is not the reason.
            Err(e @ Error::Model { source: contact_model::Error::Stopped { .. }, .. }) => {
                stopped.get_or_insert(e);
            }
            Err(e) => return Err(e),
        }
    }
    stopped.map_or(Ok(results), Err)
}

fn one(
    unit: &Unit,
    models: &Models,
    store: &Store,
    stop: Stop<'_>,
    progress: &dyn Progress,
) -> Result<UnitResult> {
    if let Some(stored) = store.load(unit) {
        progress.advance(unit.cost(), true);
        return Ok(stored);
    }
    let result = unit.solve_among(models, stop)?;
    store.save(unit, &result)?;
    progress.advance(unit.cost(), false);
    Ok(result)
}
