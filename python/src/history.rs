//! Planned contacts that remember their path.

use crate::contact::{Normalisation, load, solved};
use crate::exclusive::Exclusive;
use crate::history_state::{self, HistoryState};
use crate::memory;
use fractal_contact::{
    History as RustHistory, HistoryState as RustHistoryState, Normalisation as RustNormalisation, Step,
    Tangential,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};

/// A planned contact that remembers its path.
#[pyclass(frozen, module = "fractal_contact")]
pub struct History {
    inner: Exclusive<Box<dyn RustHistory>>,
    normalisation: RustNormalisation,
    long: bool,
    /// Whether its memory is looked at before each step.
    large: bool,
    last: Mutex<Option<Py<HistoryState>>>,
}

impl History {
    /// A history whose steps are long, or not.
    pub fn new(history: Box<dyn RustHistory>, long: bool, large: bool) -> Self {
        let normalisation = history.normalisation();
        Self { inner: Exclusive::new(history), normalisation, long, large, last: Mutex::new(None) }
    }

    /// Sets the last state. The one before it ends with what is returned, outside of all locks: the end of an array may call Python, which
    /// may ask for this history.
    #[must_use]
    fn set_last(&self, last: Option<Py<HistoryState>>) -> Option<Py<HistoryState>> {
        std::mem::replace(&mut *self.last.lock().unwrap_or_else(PoisonError::into_inner), last)
    }
}

#[pymethods]
impl History {
    /// Goes to the end of the next step. A step that fails leaves the history as it was.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     At the end of the step; it never decreases. Friction alone does not look at it.
    /// force, approach, mean_pressure, mean_gap : float
    ///     Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries. The first three may be negative
    ///     with adhesion.
    /// tangential_force, tangential_displacement : float, optional
    ///     At most one of them; no tangential force otherwise.
    ///
    /// Returns
    /// -------
    /// HistoryState
    ///
    /// Raises
    /// ------
    /// DomainError, OutOfRange, Unsupported
    ///     For a load that makes no sense or that the model does not hold for.
    /// NotConverged
    ///     With the state that was reached as ``best``; beyond pull-off that is the last stable state.
    #[pyo3(signature = (time=0.0, *, force=None, approach=None, mean_pressure=None, mean_gap=None, tangential_force=None,
                        tangential_displacement=None))]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn advance(
        &self,
        py: Python<'_>,
        time: f64,
        force: Option<f64>,
        approach: Option<f64>,
        mean_pressure: Option<f64>,
        mean_gap: Option<f64>,
        tangential_force: Option<f64>,
        tangential_displacement: Option<f64>,
    ) -> PyResult<Py<HistoryState>> {
        let normal = load(&self.normalisation, force, approach, mean_pressure, mean_gap)?;
        let tangential = match (tangential_force, tangential_displacement) {
            (None, None) => Tangential::default(),
            (Some(force), None) => Tangential::Force(force),
            (None, Some(displacement)) => Tangential::Displacement(displacement),
            _ => {
                return Err(PyTypeError::new_err(
                    "give at most one of tangential_force and tangential_displacement",
                ));
            }
        };
        let step = Step { time, normal, tangential };
        let mut ended = Vec::new();
        let mut inner = self.inner.take(py)?;
        if self.large {
            memory::check_solve(py, &mut *inner, |history| history.required_memory(normal))?;
        }
        let mut reached = None;
        let result: PyResult<RustHistoryState> = solved(
            py,
            self.long,
            // A step that was complete before it heard of the signal counts.
            |found| reached = found.ok(),
            |stop| inner.advance_until(step, &|| stop()),
        );
        if let Some(reached) = reached {
            ended.extend(self.set_last(Some(history_state::of(py, reached)?)));
        }
        let state = history_state::of(py, result?)?;
        ended.extend(self.set_last(Some(state.clone_ref(py))));
        Ok(state)
    }

    /// Goes along a path: an iterator that yields the state at the end of each step as soon as it is there.
    ///
    /// What was yielded stays where a later step raises; the history then stands at the end of the step before that one.
    ///
    /// Parameters
    /// ----------
    /// time : float or iterable of float
    ///     At the end of each step.
    /// force, approach, mean_pressure, mean_gap : float or iterable of float
    ///     Exactly one of them, as in `advance`.
    /// tangential_force, tangential_displacement : float or iterable of float, optional
    ///     At most one of them. Iterables have one number for each step; a number alone is that of every step.
    ///
    /// Yields
    /// ------
    /// HistoryState
    #[pyo3(signature = (time=None, *, force=None, approach=None, mean_pressure=None, mean_gap=None, tangential_force=None,
                        tangential_displacement=None))]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn follow<'py>(
        slf: &Bound<'py, Self>,
        time: Option<Bound<'py, PyAny>>,
        force: Option<Bound<'py, PyAny>>,
        approach: Option<Bound<'py, PyAny>>,
        mean_pressure: Option<Bound<'py, PyAny>>,
        mean_gap: Option<Bound<'py, PyAny>>,
        tangential_force: Option<Bound<'py, PyAny>>,
        tangential_displacement: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let steps = PyDict::new(slf.py());
        steps.set_item("time", time)?;
        steps.set_item("force", force)?;
        steps.set_item("approach", approach)?;
        steps.set_item("mean_pressure", mean_pressure)?;
        steps.set_item("mean_gap", mean_gap)?;
        steps.set_item("tangential_force", tangential_force)?;
        steps.set_item("tangential_displacement", tangential_displacement)?;
        slf.py().import("fractal_contact._models")?.call_method("follow", (slf,), Some(&steps))
    }

    /// Forgets the path: back to no contact at time 0.
    fn restart(&self, py: Python<'_>) -> PyResult<()> {
        let mut inner = self.inner.take(py)?;
        inner.restart();
        let before = self.set_last(None);
        drop(inner);
        drop(before);
        Ok(())
    }

    /// HistoryState or None: the state at the end of the last step that was complete, where the next one begins; None before the first.
    ///
    /// It says where the history stands after a step that failed, or that a signal such as Ctrl-C interrupted.
    #[getter]
    fn last(&self, py: Python<'_>) -> Option<Py<HistoryState>> {
        self.last.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|last| last.clone_ref(py))
    }

    /// Normalisation: of this very surface.
    #[getter]
    fn normalisation(&self) -> Normalisation {
        Normalisation(self.normalisation)
    }

    fn __repr__(&self) -> String {
        format!("<History: modulus={:e}, length={:e}>", self.normalisation.modulus, self.normalisation.length)
    }
}
