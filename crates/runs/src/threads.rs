//! Threads that the system grants; where it grants fewer than requested, the work has fewer, at worst the
//! calling one.
//!
//! `rayon` makes its global pool when it is first used and panics where the system refuses a thread, as under
//! `ulimit -u 1` or in a container with a limit of processes. Programs therefore run in [`with_threads`], and
//! [`crate::run_jobs`] asks [`granted_pool`].

use crate::error::Error;
use crate::meters::address_space;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::ffi::OsStr;
use std::time::Duration;

/// More threads than this are a mistake.
pub const MOST_THREADS: usize = 4096;

/// Name of the environment variable for the number of threads of work that is not divided into jobs.
pub const THREADS_VARIABLE: &str = "RAYON_NUM_THREADS";

/// Stack of a program's thread: what the first thread of a process has.
const STACK: usize = 8 << 20;

/// Stack of a thread for jobs, in bytes: what the standard library gives without `RUST_MIN_STACK`, which could
/// ask for too little.
pub const JOB_STACK: usize = 2 << 20;

/// Runs a program in a pool of its own: one thread per core, or as many as `asked`, the value of
/// [`THREADS_VARIABLE`], says.
///
/// # Errors
/// [`Error::Parameter`] for a value that is no number of threads.
pub fn with_threads<T: Send>(asked: Option<&OsStr>, work: impl FnOnce() -> T + Send) -> Result<T, Error> {
    let threads = match asked.map(OsStr::to_string_lossy).filter(|text| !text.trim().is_empty()) {
        None => None,
        Some(text) => match text.trim().parse::<usize>() {
            Ok(number) if number <= MOST_THREADS => (number > 0).then_some(number),
            _ => {
                let expected = format!("a whole number of threads up to {MOST_THREADS}; 0 is one per core");
                return Err(Error::parameter(THREADS_VARIABLE, text.escape_debug(), expected));
            }
        },
    };
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let pool = granted_pool(threads.unwrap_or_else(cores), STACK);
    // What is asked of the global pool from outside of the other one is done by this thread. It needs none of
    // the system's, so that it is refused only where a caller made the global pool before, and then there is
    // one.
    let _ = ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global();
    Ok(match pool {
        Some(pool) => pool.install(work),
        None => work(),
    })
}

/// A pool of `threads` threads, or of half as many, a quarter and so on, as the system grants; `None` where
/// it grants none. Their stacks of `stack` bytes take a quarter of a limited address space at most.
pub fn granted_pool(threads: usize, stack: usize) -> Option<ThreadPool> {
    /// Threads of a pool that could not be filled need a moment to end: until then their stacks are taken.
    const PAUSE: Duration = Duration::from_millis(50);
    /// Part of the address space for stacks. A thread that is granted and finds no room to begin in ends the
    /// process: the limit is not to be tried.
    const PART: u64 = 4;
    let room = address_space().map(|left| (left / PART / stack.max(1) as u64) as usize);
    let mut threads = threads.clamp(1, room.unwrap_or(MOST_THREADS).clamp(1, MOST_THREADS));
    loop {
        if let Ok(pool) = ThreadPoolBuilder::new().num_threads(threads).stack_size(stack).build() {
            return Some(pool);
        }
        if threads == 1 {
            return None;
        }
        threads /= 2;
        std::thread::sleep(PAUSE);
    }
}

/// Whether the system grants one more thread now: to be asked before a handler of signals, which waits in a
/// thread of its own, is set.
pub fn grants_a_thread() -> bool {
    std::thread::Builder::new().spawn(|| ()).is_ok_and(|thread| thread.join().is_ok())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_of_threads_is_refused_by_name() {
        let threads = |asked: &str| with_threads(Some(OsStr::new(asked)), rayon::current_num_threads);
        assert_eq!(threads("3").unwrap(), 3);
        for default in ["", " ", "0"] {
            assert!(threads(default).unwrap() >= 1);
        }
        for wrong in ["-1", "999999", "4097", "two", "1e3", "99999999999999999999999", "NaN", "\u{1b}[31m"] {
            let said = threads(wrong).unwrap_err().to_string();
            assert!(said.starts_with("RAYON_NUM_THREADS = ") && said.contains("up to 4096"), "{said}");
            assert!(!said.contains('\u{1b}'), "{said:?}");
        }
    }

    #[test]
    fn a_stack_that_no_system_grants_leaves_the_calling_thread() {
        assert!(granted_pool(4, usize::MAX / 4).is_none());
        assert_eq!(granted_pool(2, JOB_STACK).unwrap().current_num_threads(), 2);
    }
}
