//! Solves on the threads of one pool, without the interpreter's lock, and with Ctrl-C heard meanwhile.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Between two looks at the signals of the process.
pub const LOOK: Duration = Duration::from_millis(50);

/// The pool of this process. Threads do not survive a fork: a child has a pool of its own.
static POOL: Mutex<Option<(u32, Arc<ThreadPool>)>> = Mutex::new(None);

fn available() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn pool() -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match known.as_ref() {
        Some((of, pool)) if *of == process => return Ok(Arc::clone(pool)),
        // Its threads are those of the parent: to wait for them would be for ever.
        Some(_) => std::mem::forget(known.take()),
        None => {}
    }
    let pool = new_pool(available())?;
    *known = Some((process, Arc::clone(&pool)));
    Ok(pool)
}

fn new_pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let built = ThreadPoolBuilder::new().num_threads(threads).build();
    built.map(Arc::new).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// Number of threads that one solve, or one ensemble, may use.
#[pyfunction]
pub fn threads() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}

/// Sets the number of threads; no bit of a result depends on it.
#[pyfunction]
pub fn set_threads(py: Python<'_>, count: usize) -> PyResult<()> {
    let count = count.clamp(1, 1024);
    let pool = new_pool(count)?;
    let before = POOL.lock().unwrap_or_else(PoisonError::into_inner).replace((std::process::id(), pool));
    if let Some((of, pool)) = before {
        if of == std::process::id() {
            py.detach(|| drop(pool));
        } else {
            std::mem::forget(pool);
        }
    }
    Ok(())
}

/// Runs `work` on the pool. `work` is given what says that it should stop; where a signal's handler raised,
/// that exception comes with the result.
///
/// `listen` is called about twenty times a second, with the interpreter's lock; an error of it stops the work
/// as well.
pub fn run<R: Send>(
    py: Python<'_>,
    listen: &mut (dyn FnMut(Python<'_>) -> PyResult<()> + Send),
    work: impl FnOnce(&(dyn Fn() -> bool + Sync)) -> R + Send,
) -> PyResult<(R, Option<PyErr>)> {
    let pool = pool()?;
    let stopped = AtomicBool::new(false);
    let (done, changed) = (Mutex::new(None), Condvar::new());
    let mut raised = None;
    py.detach(|| {
        pool.in_place_scope(|scope| {
            scope.spawn(|_| {
                let result = catch_unwind(AssertUnwindSafe(|| work(&|| stopped.load(Ordering::Relaxed))));
                *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
                changed.notify_all();
            });
            let mut found = done.lock().unwrap_or_else(PoisonError::into_inner);
            while found.is_none() {
                found = changed.wait_timeout(found, LOOK).unwrap_or_else(PoisonError::into_inner).0;
                if found.is_some() || raised.is_some() {
                    continue;
                }
                drop(found);
                let heard = Python::attach(|py| {
                    py.check_signals()?;
                    listen(py)
                });
                if let Err(error) = heard {
                    stopped.store(true, Ordering::Relaxed);
                    raised = Some(error);
                }
                found = done.lock().unwrap_or_else(PoisonError::into_inner);
            }
        });
    });
    match done.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(Ok(result)) => Ok((result, raised)),
        Some(Err(panic)) => resume_unwind(panic),
        None => Err(PyRuntimeError::new_err("the solver ended without a result")),
    }
}

/// Runs `work` on the pool, which cannot be stopped.
pub fn call<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let (result, raised) = run(py, &mut |_| Ok(()), |_| work())?;
    raised.map_or(Ok(result), Err)
}
