//! Planned contacts that remember their path.

use crate::contact::{Normalisation, load, solved};
use crate::state::{self, HistoryState};
use fractal_contact::{
    History as RustHistory, HistoryState as RustHistoryState, Normalisation as RustNormalisation, Step,
    Tangential,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use std::sync::{Mutex, PoisonError};

/// A planned contact that remembers its path.
#[pyclass(frozen, module = "fractal_contact")]
pub struct History {
    inner: Mutex<Box<dyn RustHistory>>,
    normalisation: RustNormalisation,
    long: bool,
}

impl History {
    /// A history whose steps are long, or not.
    pub fn new(history: Box<dyn RustHistory>, long: bool) -> Self {
        let normalisation = history.normalisation();
        Self { inner: Mutex::new(history), normalisation, long }
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
    ///     Exactly one of them. Force and approach may be negative with adhesion.
    /// tangential_force, tangential_displacement : float, optional
    ///     At most one of them; no tangential force otherwise.
    ///
    /// Returns
    /// -------
    /// HistoryState
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
        let inner = &self.inner;
        let state: RustHistoryState = solved(
            py,
            self.long,
            |_| (),
            |stop| inner.lock().unwrap_or_else(PoisonError::into_inner).advance_until(step, &|| stop()),
        )?;
        state::of_history(py, state)
    }

    /// Forgets the path: back to no contact at time 0.
    fn restart(&self, py: Python<'_>) {
        let inner = &self.inner;
        py.detach(|| inner.lock().unwrap_or_else(PoisonError::into_inner).restart());
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
