//! Units in parallel, results in order.

use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::store::Store;
use crate::unit::{Models, Unit, UnitResult};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

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
    let mut order: Vec<usize> = (0..units.len()).collect();
    // Stable: equal costs keep their order, so that one surface of each kind comes early.
    order.sort_by_key(|&i| std::cmp::Reverse(units[i].cost()));
    let results: Vec<OnceLock<Result<UnitResult>>> = units.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let failed = AtomicBool::new(false);
    let models = Models::default();
    let work = || {
        while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            if failed.load(Ordering::Relaxed) {
                return;
            }
            let result = one(&units[i], &models, store, &failed, progress);
            if result.is_err() {
                failed.store(true, Ordering::Relaxed);
            }
            // Each index is taken once.
            let _ = results[i].set(result);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads.max(1))
        .build()
        .map_err(|e| Error::parameter("threads", threads, format!("threads that the system grants ({e})")))?;
    // One loop per thread rather than a parallel iterator: a thread that waits inside a solve then never begins another unit,
    // and those without a unit help the solves of the others.
    pool.broadcast(|_| work());
    progress.end();
    let done: Vec<Option<Result<UnitResult>>> = results.into_iter().map(OnceLock::into_inner).collect();
    collect(done)
}

/// All results, or the error that started it.
fn collect(done: Vec<Option<Result<UnitResult>>>) -> Result<Vec<UnitResult>> {
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
    failed: &AtomicBool,
    progress: &dyn Progress,
) -> Result<UnitResult> {
    if let Some(stored) = store.load(unit) {
        progress.advance(unit.cost(), true);
        return Ok(stored);
    }
    let result = unit.solve_among(models, &|| failed.load(Ordering::Relaxed))?;
    store.save(unit, &result)?;
    progress.advance(unit.cost(), false);
    Ok(result)
}
