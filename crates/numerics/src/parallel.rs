//! Tasks that are shared by the threads of the caller's pool.
//!
//! No bit of a result depends on the number of threads: the division into tasks depends on sizes alone, one
//! thread does each task, and the results are combined in the order of the tasks. The pool is that of `rayon`
//! in which a solve runs; its idle threads help. Parallel iterators of `rayon` would allocate buffers for
//! each split instead of for each thread, and they would need a second code for builds without the feature
//! `rayon`, which have one thread.
//!
//! A thread that waits for its helpers may be given any other work of its pool, such as another solve of a
//! parallel iterator over surfaces. Two rules keep that harmless: nothing is locked while tasks are shared,
//! and what such a thread begins meanwhile runs on it alone, so that work is never nested deeper than that.

#[cfg(feature = "rayon")]
use std::cell::Cell;
#[cfg(feature = "rayon")]
use std::sync::atomic::{AtomicBool, Ordering};
#[cfg(feature = "rayon")]
use std::sync::{Mutex, PoisonError};

/// Number of elements of a vector loop for which a further thread pays; other values were not measured.
const WORK_PER_THREAD: usize = 1 << 15;

#[cfg(feature = "rayon")]
thread_local! {
    /// Whether this thread shares tasks, and may be waiting for its helpers.
    static SHARING: Cell<bool> = const { Cell::new(false) };
}

/// Marks this thread as one that shares tasks, for as long as the mark lives.
#[cfg(feature = "rayon")]
struct Sharing;

#[cfg(feature = "rayon")]
impl Sharing {
    /// `None` where the thread shares tasks already.
    fn begin() -> Option<Self> {
        (!SHARING.replace(true)).then(|| Self)
    }
}

#[cfg(feature = "rayon")]
impl Drop for Sharing {
    fn drop(&mut self) {
        SHARING.set(false);
    }
}

/// Number of threads that pay for `work`, a number of elements of a vector loop.
pub fn threads_for(work: usize) -> usize {
    #[cfg(feature = "rayon")]
    let threads = if SHARING.get() { 1 } else { rayon::current_num_threads() };
    #[cfg(not(feature = "rayon"))]
    let threads = 1;
    threads.min(work / WORK_PER_THREAD).max(1)
}

/// Does `work` with the widest vector instructions that the processor has. They change no order of operations,
/// so that no bit of a result depends on them.
#[inline]
pub fn widest<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(feature = "simd")]
    return pulp::Arch::new().dispatch(work);
    #[cfg(not(feature = "simd"))]
    work()
}

/// Does `own` on this thread and `work` on `helpers` others of its pool, once on each. Not generic, so that the
/// sharing is compiled once and not for each of hundreds of loops.
#[cfg(feature = "rayon")]
fn on_threads(helpers: usize, work: &(dyn Fn() + Sync), own: &dyn Fn()) {
    rayon::in_place_scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|_| work());
        }
        own();
    });
}

/// Does `work` on each task, on as many threads as there are buffers; each thread has its own.
pub fn for_each<T: Send, B: Send>(
    buffers: &mut [B],
    mut tasks: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(&mut B, T) + Sync,
) {
    share(buffers, &mut tasks, &work, &|| false);
}

/// As [`for_each`], as long as `stops` does not say to stop: it is asked on this thread before each of its tasks,
/// and the others then begin no further task either. Returns whether every task was done.
pub fn for_each_until<T: Send, B: Send>(
    buffers: &mut [B],
    mut tasks: impl ExactSizeIterator<Item = T> + Send,
    stops: &dyn Fn() -> bool,
    work: impl Fn(&mut B, T) + Sync,
) -> bool {
    share(buffers, &mut tasks, &work, stops)
}

/// [`for_each_until`], compiled once for each type of task and buffer and not for each of hundreds of loops.
fn share<T: Send, B: Send>(
    buffers: &mut [B],
    tasks: &mut (dyn ExactSizeIterator<Item = T> + Send),
    work: &(dyn Fn(&mut B, T) + Sync),
    stops: &dyn Fn() -> bool,
) -> bool {
    #[cfg(feature = "rayon")]
    if let helpers @ 1.. = buffers.len().min(tasks.len()).saturating_sub(1)
        && let Some(_sharing) = Sharing::begin()
    {
        let tasks = Mutex::new(tasks);
        let buffers = Mutex::new(buffers.iter_mut());
        let stopped = AtomicBool::new(false);
        let until = |stops: &dyn Fn() -> bool| {
            if let Some(buffer) = next(&buffers) {
                while !stops()
                    && let Some(task) = next(&tasks)
                {
                    work(buffer, task);
                }
            }
        };
        let heard = || stopped.load(Ordering::Relaxed);
        let asked = || {
            let stops = stops();
            stopped.fetch_or(stops, Ordering::Relaxed);
            stops
        };
        on_threads(helpers, &|| until(&heard), &|| until(&asked));
        return next(&tasks).is_none();
    }
    let Some(buffer) = buffers.first_mut() else { return true };
    for task in tasks {
        if stops() {
            return false;
        }
        work(buffer, task);
    }
    true
}

/// The next of what threads share.
#[cfg(feature = "rayon")]
fn next<I: Iterator>(shared: &Mutex<I>) -> Option<I::Item> {
    shared.lock().unwrap_or_else(PoisonError::into_inner).next()
}

/// Does `work` on each task and returns the results in the order of the tasks; the total amount of work, in
/// elements of a vector loop, decides the number of threads.
pub fn map<T: Send, R: Send + Default>(
    total: usize,
    mut tasks: impl ExactSizeIterator<Item = T> + Send,
    work: impl Fn(T) -> R + Sync,
) -> Vec<R> {
    collect(threads_for(total), &mut tasks, &work)
}

/// [`map`], compiled once for each type of task and result.
fn collect<T: Send, R: Send + Default>(
    threads: usize,
    tasks: &mut (dyn ExactSizeIterator<Item = T> + Send),
    work: &(dyn Fn(T) -> R + Sync),
) -> Vec<R> {
    let mut results: Vec<R> = Vec::new();
    results.resize_with(tasks.len(), R::default);
    let mut buffers = vec![(); threads];
    let each = |(): &mut (), (task, result): (T, &mut R)| *result = work(task);
    share(&mut buffers, &mut tasks.zip(&mut results), &each, &|| false);
    results
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_task_is_done_once_and_results_keep_their_order() {
        for threads in [1, 2, 5] {
            for count in [0, 1, 2, 100] {
                let mut buffers = vec![0_usize; threads];
                let mut done = vec![0; count];
                for_each(&mut buffers, done.iter_mut(), |buffer, task| {
                    *buffer += 1;
                    *task += 1;
                });
                assert!(done.iter().all(|&times| times == 1), "{threads} threads, {count} tasks");
                assert_eq!(buffers.iter().sum::<usize>(), count);
            }
        }
        assert_eq!(map(usize::MAX, 0..50, |i| i * i), (0..50).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(threads_for(0), 1);
        assert_eq!(threads_for(2 * WORK_PER_THREAD - 1), 1, "not enough for two");
    }

    #[test]
    fn after_a_stop_each_thread_ends_its_task_and_begins_no_other() {
        use std::sync::atomic::{AtomicUsize, Ordering};
        for threads in [1, 4] {
            let (done, asked) = (AtomicUsize::new(0), std::cell::Cell::new(0));
            let stops = || {
                asked.set(asked.get() + 1);
                asked.get() > 3
            };
            let mut buffers = vec![(); threads];
            let all = for_each_until(&mut buffers, 0..usize::MAX, &stops, |(), _| {
                done.fetch_add(1, Ordering::Relaxed);
            });
            assert!(!all && asked.get() == 4, "it is asked before each task of its thread");
            if threads == 1 {
                assert_eq!(done.into_inner(), 3);
            }
            assert!(for_each_until(&mut buffers, 0..100, &|| false, |(), _| {}));
        }
    }

    #[cfg(feature = "rayon")]
    #[test]
    fn what_a_thread_begins_while_it_shares_tasks_runs_on_it_alone() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(3).build().unwrap();
        pool.install(|| {
            assert_eq!(threads_for(usize::MAX), 3);
            let sharing = Sharing::begin();
            assert!(sharing.is_some() && Sharing::begin().is_none());
            assert_eq!(threads_for(usize::MAX), 1);
            let me = std::thread::current().id();
            let ids = map(usize::MAX, 0..40, |_| Some(std::thread::current().id()));
            assert!(ids.iter().all(|id| *id == Some(me)));
            drop(sharing);
            assert_eq!(threads_for(usize::MAX), 3);
        });
    }
}
