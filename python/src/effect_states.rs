//! What states of contacts with a hardness or with adhesion have beside the rest.

use fractal_contact::{AdhesiveState as RustAdhesiveState, PlasticState as RustPlasticState};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// What has yielded in a contact with a hardness.
#[pyclass(frozen, eq, module = "fractal_contact")]
#[derive(Clone, PartialEq)]
pub struct PlasticState(pub RustPlasticState);

#[pymethods]
impl PlasticState {
    /// float: area under the hardness (length^2).
    #[getter]
    fn area(&self) -> f64 {
        self.0.area
    }

    /// float: volume of the plastic indentation, since the virgin surface (length^3).
    #[getter]
    fn volume(&self) -> f64 {
        self.0.volume
    }

    /// float: energy dissipated in it, hardness times volume (force times length); ``plastic_work`` in tables.
    #[getter]
    fn dissipated(&self) -> f64 {
        self.0.dissipated
    }

    /// The numbers by their names.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("area", self.0.area)?;
        dict.set_item("volume", self.0.volume)?;
        dict.set_item("dissipated", self.0.dissipated)?;
        Ok(dict)
    }

    pub fn __repr__(&self) -> String {
        let RustPlasticState { area, volume, dissipated, .. } = self.0;
        format!("<PlasticState: area={area:.6e}, volume={volume:.6e}, dissipated={dissipated:.6e}>")
    }
}

/// The adhesive part of a state.
#[pyclass(frozen, eq, module = "fractal_contact")]
#[derive(Clone, PartialEq)]
pub struct AdhesiveState(pub RustAdhesiveState);

#[pymethods]
impl AdhesiveState {
    /// str: on which branch the state lies, ``approach`` or ``withdrawal``: between snap-in and pull-off both are stable.
    #[getter]
    fn branch(&self) -> &'static str {
        self.0.branch.as_str()
    }

    /// float: elastic energy less the work of adhesion that the attraction has done (force times length); 0 for bodies far apart.
    #[getter]
    fn energy(&self) -> f64 {
        self.0.energy
    }

    /// float: how stable the state is, dimensionless; > 0 for a minimum of the energy.
    ///
    /// The smallest curvature of the energy, over that without adhesion. With Dugdale's law, whose states are stable between the jumps of
    /// single cells, the smallest distance of the gap of a cell from the range, in ranges.
    #[getter]
    fn stability(&self) -> f64 {
        self.0.stability
    }

    /// The branch and the numbers by their names.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("branch", self.branch())?;
        dict.set_item("energy", self.0.energy)?;
        dict.set_item("stability", self.0.stability)?;
        Ok(dict)
    }

    pub fn __repr__(&self) -> String {
        let RustAdhesiveState { energy, stability, .. } = self.0;
        format!("<AdhesiveState: {}, energy={energy:.6e}, stability={stability:.3e}>", self.branch())
    }
}
