//! What one thread of Python uses at a time: taken in the order of asking, with Ctrl-C heard while a thread
//! waits.
//!
//! It is taken by the thread that calls from Python, before there is a job of the pool. A lock that is taken
//! inside a job can wait for ever: a thread of the pool that waits for helpers may be given another job,
//! which would wait for the lock that its own thread holds.

use crate::errors::stopped;
use crate::pool::{LOOK, StopToken};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};

/// A value that one thread uses at a time.
pub struct Exclusive<T> {
    state: Mutex<State<T>>,
    returned: Condvar,
}

struct State<T> {
    /// `None` while a thread has it.
    value: Option<T>,
    user: Option<ThreadId>,
    /// Those that wait, the first in front: a number each, and the thread.
    waiting: VecDeque<(u64, ThreadId)>,
    next: u64,
    /// The process in which it was used last: threads do not survive a fork.
    process: u32,
}

/// The value in use; it goes back where this ends.
pub struct InUse<'a, T> {
    of: &'a Exclusive<T>,
    value: Option<T>,
}

impl<T: Send> Exclusive<T> {
    pub fn new(value: T) -> Self {
        let state = State {
            value: Some(value),
            user: None,
            waiting: VecDeque::new(),
            next: 0,
            process: std::process::id(),
        };
        Self { state: Mutex::new(state), returned: Condvar::new() }
    }

    /// Takes the value; waits without the interpreter's lock while another thread has it.
    ///
    /// # Errors
    /// What the handler of a signal raises meanwhile; `RuntimeError` where this very thread has the value or
    /// waits for it, as in the handler of a signal that came during a solve.
    pub fn take(&self, py: Python<'_>) -> PyResult<InUse<'_, T>> {
        self.take_unless(py, StopToken::NONE)
    }

    /// The same, unless the token is set while it waits.
    ///
    /// # Errors
    /// `Stopped` then. `RuntimeError` in a process that was forked while a thread of its parent had the value:
    /// that thread does not exist in the child, and would never give it back.
    pub fn take_unless(&self, py: Python<'_>, token: StopToken<'_>) -> PyResult<InUse<'_, T>> {
        let mut state = self.locked();
        let process = std::process::id();
        if state.process != process {
            if state.value.is_none() {
                return Err(PyRuntimeError::new_err(
                    "this process was forked while a thread of its parent was solving with this contact, and the solve does not go on \
                     here: start processes with multiprocessing.get_context(\"spawn\"), or make a contact in each process",
                ));
            }
            // Those that waited are threads of the parent.
            state.waiting.clear();
            state.process = process;
        }
        if state.waiting.is_empty()
            && let Some(value) = state.take()
        {
            return Ok(InUse { of: self, value: Some(value) });
        }
        let this = thread::current().id();
        if state.user == Some(this) || state.waiting.iter().any(|(_, thread)| *thread == this) {
            return Err(PyRuntimeError::new_err(
                "this thread is already solving with this object: it cannot be used inside the handler of a signal",
            ));
        }
        let place = WaitingPlace { of: self, number: state.next };
        state.next += 1;
        state.waiting.push_back((place.number, this));
        drop(state);
        loop {
            if let Some(value) = py.detach(|| self.wait(place.number)) {
                return Ok(InUse { of: self, value: Some(value) });
            }
            py.check_signals()?;
            if token.is_set(py)? {
                return Err(stopped(py));
            }
        }
    }

    /// The value, when it is the turn of this number before the next look at the signals.
    fn wait(&self, number: u64) -> Option<T> {
        let waits = |state: &mut State<T>| !state.is_first(number) || state.value.is_none();
        let (mut state, _) = self
            .returned
            .wait_timeout_while(self.locked(), LOOK, waits)
            .unwrap_or_else(PoisonError::into_inner);
        if state.is_first(number) { state.take() } else { None }
    }

    /// Held for a few instructions only, and never while the interpreter's lock is waited for.
    fn locked(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> State<T> {
    fn is_first(&self, number: u64) -> bool {
        self.waiting.front().is_some_and(|(first, _)| *first == number)
    }

    fn take(&mut self) -> Option<T> {
        let value = self.value.take()?;
        self.user = Some(thread::current().id());
        Some(value)
    }
}

/// A place among those that wait, until the value is taken or the wait is given up.
struct WaitingPlace<'a, T> {
    of: &'a Exclusive<T>,
    number: u64,
}

impl<T> Drop for WaitingPlace<'_, T> {
    fn drop(&mut self) {
        let mut state = self.of.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.waiting.retain(|(number, _)| *number != self.number);
        drop(state);
        self.of.returned.notify_all();
    }
}

impl<T> Drop for InUse<'_, T> {
    fn drop(&mut self) {
        let mut state = self.of.state.lock().unwrap_or_else(PoisonError::into_inner);
        (state.value, state.user) = (self.value.take(), None);
        drop(state);
        self.of.returned.notify_all();
    }
}

impl<T> Deref for InUse<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        self.value.as_ref().unwrap_or_else(|| unreachable!("it goes back at the end only"))
    }
}

impl<T> DerefMut for InUse<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        self.value.as_mut().unwrap_or_else(|| unreachable!("it goes back at the end only"))
    }
}
