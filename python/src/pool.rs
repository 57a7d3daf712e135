//! Solves on the threads of one pool, without the interpreter's lock, and with Ctrl-C heard meanwhile.

use crate::numbers::{Single, of_value_or_type, shown};
use fractal_contact::runs::{JOB_STACK, MOST_THREADS};
use pyo3::exceptions::{PyRuntimeError, PyTypeError};
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

fn pool() -> PyResult<Arc<ThreadPool>> {
    let process = std::process::id();
    let mut known = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match known.as_ref() {
        Some((of, pool)) if *of == process => return Ok(Arc::clone(pool)),
        // Its threads are those of the parent: to wait for them would be for ever.
        Some(_) => std::mem::forget(known.take()),
        None => {}
    }
    // As many threads as RAYON_NUM_THREADS says, or as there are processors.
    let pool = new_pool(0)?;
    *known = Some((process, Arc::clone(&pool)));
    Ok(pool)
}

fn new_pool(threads: usize) -> PyResult<Arc<ThreadPool>> {
    let built = ThreadPoolBuilder::new().num_threads(threads).stack_size(JOB_STACK).build();
    built.map(Arc::new).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

/// Number of threads that one solve, or one ensemble, may use.
///
/// By default it is what the variable ``RAYON_NUM_THREADS`` of the environment says, or as many as there are processors.
///
/// Returns
/// -------
/// int
#[pyfunction]
pub fn threads() -> PyResult<usize> {
    Ok(pool()?.current_num_threads())
}

/// Sets the number of threads; no bit of a result depends on it.
///
/// Parameters
/// ----------
/// count : int
///     At least 1.
#[pyfunction]
pub fn set_threads(py: Python<'_>, count: &Bound<'_, PyAny>) -> PyResult<()> {
    let whole = usize::single(count).filter(|count| (1..=MOST_THREADS).contains(count));
    let count = whole.ok_or_else(|| {
        let shown = shown(count);
        of_value_or_type(
            count,
            format!("count = {shown}: expected a whole number of threads from 1 to {MOST_THREADS}"),
        )
    })?;
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

/// What another thread of Python sets to stop a solve: a `threading.Event`, or anything that has its `is_set`.
#[derive(Clone, Copy)]
pub struct StopToken<'a>(Option<&'a Py<PyAny>>);

impl<'a> StopToken<'a> {
    /// An error for what cannot be asked.
    pub fn new(py: Python<'_>, token: Option<&'a Py<PyAny>>) -> PyResult<Self> {
        match token {
            Some(token) if !token.bind(py).hasattr("is_set")? => Err(PyTypeError::new_err(format!(
                "stop is {}: expected a threading.Event, or what has its is_set()",
                token.bind(py).repr()?
            ))),
            token => Ok(Self(token)),
        }
    }

    pub const NONE: Self = Self(None);

    /// Whether it is set.
    pub fn is_set(self, py: Python<'_>) -> PyResult<bool> {
        self.0.map_or(Ok(false), |token| token.call_method0(py, "is_set")?.is_truthy(py))
    }
}

/// Runs `work` on the pool. `work` is given what says that it should stop: a signal whose handler raised, and
/// then that exception comes with the result, or `token`.
///
/// `listen` is called about twenty times a second, with the interpreter's lock; an error of it stops the work
/// as well.
pub fn run<R: Send>(
    py: Python<'_>,
    token: StopToken<'_>,
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
                    stopped.fetch_or(token.is_set(py)?, Ordering::Relaxed);
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

/// Runs `work` that cannot be stopped on the pool. Where the handler of a signal raises, the caller has that
/// exception at once; the work goes on to its end, and its result is dropped.
pub fn call<R: Send + 'static>(py: Python<'_>, work: impl FnOnce() -> R + Send + 'static) -> PyResult<R> {
    let shared = Arc::new((Mutex::new(None), Condvar::new()));
    let told = Arc::clone(&shared);
    pool()?.spawn(move || {
        let result = catch_unwind(AssertUnwindSafe(work));
        let (done, changed) = &*told;
        *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(result);
        changed.notify_all();
    });
    let (done, changed) = &*shared;
    loop {
        let found = py.detach(|| {
            let found = done.lock().unwrap_or_else(PoisonError::into_inner);
            let waiting = changed.wait_timeout_while(found, LOOK, |found| found.is_none());
            waiting.unwrap_or_else(PoisonError::into_inner).0.take()
        });
        match found {
            Some(Ok(result)) => return Ok(result),
            Some(Err(panic)) => resume_unwind(panic),
            None => py.check_signals()?,
        }
    }
}
