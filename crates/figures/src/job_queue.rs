//! Jobs in parallel, results in their places.

use contact_model::Stop;
use rayon::ThreadPoolBuildError;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Runs the jobs of `order` on some threads, those that stand first in it first, and gives their results by number; `None` where none was begun.
///
/// After a failure, or when `stop` says so, no further job begins, and those in flight are told by their own closure.
///
/// One loop per thread rather than a parallel iterator: a thread that waits inside a job then never begins another one (whose time
/// would contain the first), and those without a job help the others.
///
/// # Errors
/// That the system does not grant the threads.
pub fn run_jobs<T: Send + Sync, E: Send + Sync>(
    threads: usize,
    order: &[usize],
    stop: &(dyn Fn() -> bool + Sync),
    job: impl Fn(usize, Stop<'_>) -> Result<T, E> + Sync,
) -> Result<Vec<Option<Result<T, E>>>, ThreadPoolBuildError> {
    let results: Vec<OnceLock<Result<T, E>>> = order.iter().map(|_| OnceLock::new()).collect();
    let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
    let halt = || failed.load(Ordering::Relaxed) || stop();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build()?;
    pool.broadcast(|_| {
        while let Some(&i) = order.get(next.fetch_add(1, Ordering::Relaxed)) {
            if halt() {
                return;
            }
            let result = job(i, &halt);
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            // Each number is taken once.
            let _ = results[i].set(result);
        }
    });
    Ok(results.into_iter().map(OnceLock::into_inner).collect())
}

/// The numbers of jobs, the most expensive first; equal costs keep their order, so that one of each kind comes early.
pub fn largest_first<C: Ord>(count: usize, cost: impl Fn(usize) -> C) -> Vec<usize> {
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&i| std::cmp::Reverse(cost(i)));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    #[test]
    fn results_are_in_their_places_for_any_number_of_threads() {
        let order = largest_first(7, |i| i % 3);
        assert_eq!(order, [2, 5, 1, 4, 0, 3, 6]);
        for threads in [0, 1, 2, 4] {
            let squares = run_jobs::<_, ()>(threads, &order, &never, |i, _| Ok(i * i)).unwrap();
            assert_eq!(squares.into_iter().flatten().flatten().collect::<Vec<_>>(), [0, 1, 4, 9, 16, 25, 36]);
        }
    }

    #[test]
    fn a_failure_and_a_stop_begin_nothing_more() {
        let order = largest_first(3, |_| 0);
        let failing = run_jobs(1, &order, &never, |i, halt| {
            assert!(!halt());
            if i == 1 { Err("no") } else { Ok(i) }
        });
        assert_eq!(failing.unwrap(), [Some(Ok(0)), Some(Err("no")), None]);
        let stopped = run_jobs::<usize, ()>(1, &order, &|| true, |i, _| Ok(i)).unwrap();
        assert_eq!(stopped, [None, None, None]);
    }
}
