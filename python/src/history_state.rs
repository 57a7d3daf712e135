//! States of a path.

use crate::state::{self, ContactState};
use fractal_contact::HistoryState as RustHistoryState;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The state at the end of a step of a path.
#[pyclass(frozen, module = "fractal_contact")]
pub struct HistoryState {
    time: f64,
    normal: Py<ContactState>,
    contact_radius: Option<f64>,
    tangential: Option<fractal_contact::TangentialState>,
}

/// Moves a state of a path into Python.
pub fn of(py: Python<'_>, state: RustHistoryState) -> PyResult<Py<HistoryState>> {
    let RustHistoryState { time, normal, contact_radius, tangential, .. } = state;
    Py::new(py, HistoryState { time, normal: state::of(py, normal)?, contact_radius, tangential })
}

#[pymethods]
impl HistoryState {
    /// float: time at the end of the step.
    #[getter]
    fn time(&self) -> f64 {
        self.time
    }

    /// ContactState: the normal part, with fields and certificate.
    #[getter]
    fn normal(&self, py: Python<'_>) -> Py<ContactState> {
        self.normal.clone_ref(py)
    }

    /// float: normal force.
    #[getter]
    fn force(&self) -> f64 {
        self.normal.get().force()
    }

    /// float or None: approach.
    #[getter]
    fn approach(&self) -> Option<f64> {
        self.normal.get().approach()
    }

    /// float or None: mean gap, with periodic boundaries and where asked for.
    #[getter]
    fn mean_gap(&self) -> Option<f64> {
        self.normal.get().mean_gap()
    }

    /// float or None: radius of a round contact, or of the round contact of the same stiffness.
    #[getter]
    fn contact_radius(&self) -> Option<f64> {
        self.contact_radius
    }

    /// float or None: tangential force.
    #[getter]
    fn tangential_force(&self) -> Option<f64> {
        self.tangential.map(|of| of.force)
    }

    /// float or None: tangential displacement of the bodies relative to each other.
    #[getter]
    fn tangential_displacement(&self) -> Option<f64> {
        self.tangential.map(|of| of.displacement)
    }

    /// float or None: radius inside which nothing slips.
    #[getter]
    fn stick_radius(&self) -> Option<f64> {
        self.tangential.and_then(|of| of.stick_radius)
    }

    /// float or None: energy that friction has dissipated since the first step.
    #[getter]
    fn dissipated(&self) -> Option<f64> {
        self.tangential.map(|of| of.dissipated)
    }

    /// All numbers by their names, as `ContactState.to_dict`; arrays only with ``fields=True``.
    ///
    /// Those of friction are there where the state has them.
    #[pyo3(signature = (*, fields=false))]
    fn to_dict<'py>(&self, py: Python<'py>, fields: bool) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("time", self.time)?;
        dict.update(self.normal.get().to_dict(py, fields)?.as_mapping())?;
        dict.set_item("contact_radius", self.contact_radius)?;
        if let Some(tangential) = &self.tangential {
            dict.set_item("tangential_force", tangential.force)?;
            dict.set_item("tangential_displacement", tangential.displacement)?;
            dict.set_item("stick_radius", tangential.stick_radius)?;
            dict.set_item("dissipated", tangential.dissipated)?;
        }
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("<HistoryState: time={:e}, {}>", self.time, self.normal.get().__repr__())
    }
}
