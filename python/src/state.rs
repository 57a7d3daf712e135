//! States of a contact.

use crate::effect_states::{AdhesiveState, PlasticState};
use fractal_contact::{Certificate as RustCertificate, ContactState as RustState, Field};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A field as an array `[row, column]` that owns its values; nothing is copied.
pub fn array(py: Python<'_>, field: Field) -> PyResult<Py<PyArray2<f64>>> {
    let shape = [field.rows(), field.columns()];
    Ok(PyArray1::from_vec(py, field.into_values()).reshape(shape)?.unbind())
}

/// Looks up all that arrays need of numpy, while the module is imported.
///
/// The crate `numpy` does so when the first array is made, and takes for granted that nothing fails there: a Ctrl-C that came at that
/// moment would be a panic.
pub fn look_up_arrays(py: Python<'_>) -> PyResult<()> {
    py.import("numpy")?;
    let array = PyArray1::from_vec(py, vec![0.0]).reshape([1, 1])?;
    array.try_readonly()?;
    Ok(())
}

/// How exactly the contact conditions hold, measured with the exact operator in double precision.
///
/// All numbers are relative and dimensionless.
#[pyclass(frozen, module = "fractal_contact")]
#[derive(Clone)]
pub struct Certificate(RustCertificate);

#[pymethods]
impl Certificate {
    /// float: duality gap of the quadratic programme over force times rms height.
    #[getter]
    fn duality_gap(&self) -> f64 {
        self.0.duality_gap
    }

    /// float: deepest penetration over the rms height.
    #[getter]
    fn penetration(&self) -> f64 {
        self.0.penetration
    }

    /// float: sum of pressure times gap over force times rms height.
    #[getter]
    fn complementarity(&self) -> f64 {
        self.0.complementarity
    }

    /// float: relative difference of the force from the one asked for; of a mean gap its miss over the rms height.
    #[getter]
    fn load_error(&self) -> f64 {
        self.0.load_error
    }

    /// float or None: estimated relative error of the stiffness; None where it is a difference quotient (`quotient_error`).
    #[getter]
    fn stiffness_error(&self) -> Option<f64> {
        self.0.stiffness_error
    }

    /// float or None: estimated relative error of a stiffness that is a difference quotient, with adhesion of short range and Dugdale's law.
    /// The cells decide it, not the tolerance: no part of `worst`.
    #[getter]
    fn quotient_error(&self) -> Option<f64> {
        self.0.quotient_error
    }

    /// float or None: bound of the relative error of the force under a prescribed approach or mean gap, an estimate with adhesion; no part
    /// of `worst`.
    #[getter]
    fn force_error(&self) -> Option<f64> {
        self.0.force_error
    }

    /// float or None: estimated relative error of the stiffness, however it was found; ``stiffness_error`` in tables.
    #[getter]
    fn error_of_stiffness(&self) -> Option<f64> {
        self.0.error_of_stiffness()
    }

    /// float or None: largest difference between the traction of a cell and what the law of adhesion says of its gap, over work/range; None
    /// without adhesion of finite range.
    #[getter]
    fn equilibrium(&self) -> Option<f64> {
        self.0.equilibrium
    }

    /// float: the largest of the numbers that the tolerance bounds.
    #[getter]
    fn worst(&self) -> f64 {
        self.0.worst()
    }

    /// Whether every number that the tolerance bounds is at most `tolerance`.
    fn meets(&self, tolerance: f64) -> bool {
        self.0.meets(tolerance)
    }

    /// The numbers by the names of the columns of scenes; ``stiffness_error`` is `error_of_stiffness`.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("duality_gap", self.0.duality_gap)?;
        dict.set_item("penetration", self.0.penetration)?;
        dict.set_item("complementarity", self.0.complementarity)?;
        dict.set_item("load_error", self.0.load_error)?;
        dict.set_item("force_error", self.0.force_error)?;
        dict.set_item("stiffness_error", self.0.error_of_stiffness())?;
        dict.set_item("equilibrium", self.0.equilibrium)?;
        Ok(dict)
    }

    fn __repr__(&self) -> String {
        format!("<Certificate: {}>", self.0)
    }
}

/// One contact state. What was not asked for, or what the model does not claim, is None.
#[pyclass(frozen, module = "fractal_contact")]
pub struct ContactState {
    state: RustState,
    pressure: Option<Py<PyArray2<f64>>>,
    displacement: Option<Py<PyArray2<f64>>>,
    gap: Option<Py<PyArray2<f64>>>,
    plastic_depth: Option<Py<PyArray2<f64>>>,
}

/// Moves a state into Python.
pub fn of(py: Python<'_>, mut state: RustState) -> PyResult<Py<ContactState>> {
    let fields = state.fields.take().unwrap_or_default();
    let array = |field: Option<Field>| field.map(|field| array(py, field)).transpose();
    let (pressure, displacement) = (array(fields.pressure)?, array(fields.displacement)?);
    let (gap, plastic_depth) = (array(fields.gap)?, array(fields.plastic_depth)?);
    Py::new(py, ContactState { state, pressure, displacement, gap, plastic_depth })
}

#[pymethods]
impl ContactState {
    /// float: normal force; negative where adhesion holds against a pull.
    #[getter]
    pub fn force(&self) -> f64 {
        self.state.force
    }

    /// float or None: approach from first touch; None with periodic boundaries.
    #[getter]
    pub fn approach(&self) -> Option<f64> {
        self.state.approach
    }

    /// float or None: distance between the mean plane of the defined heights and that of the deformed half-space. Without undefined points
    /// it is the mean of the gap field; with them it may be negative.
    #[getter]
    pub fn mean_gap(&self) -> Option<f64> {
        self.state.mean_gap
    }

    /// float or None: dF/dd along the branch of states (periodic: -dF/d(mean gap)): fronts of an adhesive contact move, saturated cells
    /// flow.
    #[getter]
    fn stiffness(&self) -> Option<f64> {
        self.state.stiffness
    }

    /// float or None: stiffness of the whole contact area, held; the conductance follows from it.
    #[getter]
    fn stiffness_fixed_area(&self) -> Option<f64> {
        self.state.stiffness_fixed_area
    }

    /// float or None: real contact area.
    #[getter]
    fn area(&self) -> Option<f64> {
        self.state.area
    }

    /// float or None: real contact area with a correction for its boundary, where cells were counted.
    #[getter]
    fn area_corrected(&self) -> Option<f64> {
        self.state.resolution.and_then(|resolution| resolution.corrected_area)
    }

    /// float or None: largest pressure of a cell.
    #[getter]
    fn largest_pressure(&self) -> Option<f64> {
        self.state.resolution.map(|resolution| resolution.largest_pressure)
    }

    /// int or None: cells in contact at an edge of a free rectangle.
    #[getter]
    fn edge_cells(&self) -> Option<usize> {
        self.state.resolution.map(|resolution| resolution.edge_cells)
    }

    /// float or None: conductance through the contact.
    #[getter]
    fn conductance(&self) -> Option<f64> {
        self.state.conductance
    }

    /// numpy.ndarray or None: areas of the connected contacts (length^2), the largest first; shape (patches,).
    #[getter]
    fn patches<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.state.patches.as_ref().map(|patches| PyArray1::from_slice(py, patches.areas()))
    }

    /// numpy.ndarray or None: pressure of each cell (force/length^2), shape (rows, columns); negative, a tension, with adhesion only.
    #[getter]
    fn pressure(&self, py: Python<'_>) -> Option<Py<PyArray2<f64>>> {
        self.pressure.as_ref().map(|field| field.clone_ref(py))
    }

    /// numpy.ndarray or None: displacement of the elastic surface (length), shape (rows, columns).
    #[getter]
    fn displacement(&self, py: Python<'_>) -> Option<Py<PyArray2<f64>>> {
        self.displacement.as_ref().map(|field| field.clone_ref(py))
    }

    /// numpy.ndarray or None: gap to the indented surface (length), shape (rows, columns); infinite at undefined points.
    #[getter]
    fn gap(&self, py: Python<'_>) -> Option<Py<PyArray2<f64>>> {
        self.gap.as_ref().map(|field| field.clone_ref(py))
    }

    /// numpy.ndarray or None: depth of the plastic indentation >= 0 (length), shape (rows, columns).
    #[getter]
    fn plastic_depth(&self, py: Python<'_>) -> Option<Py<PyArray2<f64>>> {
        self.plastic_depth.as_ref().map(|field| field.clone_ref(py))
    }

    /// PlasticState or None: what has yielded, of contacts with a hardness.
    #[getter]
    fn plastic(&self) -> Option<PlasticState> {
        self.state.plastic.map(PlasticState)
    }

    /// AdhesiveState or None: the adhesive part, of contacts with adhesion that are solved cell by cell.
    #[getter]
    fn adhesive(&self) -> Option<AdhesiveState> {
        self.state.adhesive.map(AdhesiveState)
    }

    /// Certificate: how exactly the contact conditions hold.
    #[getter]
    fn certificate(&self) -> Certificate {
        Certificate(self.state.report.certificate)
    }

    /// str: how the solve ended, such as ``converged``.
    #[getter]
    fn status(&self) -> &'static str {
        self.state.report.status.as_str()
    }

    /// str: which way was taken.
    #[getter]
    fn strategy(&self) -> &str {
        &self.state.report.strategy
    }

    /// int: iterations of the linear solvers.
    #[getter]
    fn iterations(&self) -> usize {
        self.state.report.iterations
    }

    /// int: applications of the influence matrix on the fine grid, the certificate's included.
    #[getter]
    fn applications(&self) -> usize {
        self.state.report.applications
    }

    /// int: linear systems solved.
    #[getter]
    fn linear_solves(&self) -> usize {
        self.state.report.work.linear_solves
    }

    /// int or None: cells in contact.
    #[getter]
    fn contact_cells(&self) -> Option<usize> {
        self.state.report.contact_cells
    }

    /// All numbers by the names of the columns of scenes; arrays only with ``fields=True``.
    ///
    /// Those of `plastic` (``plastic_area``, ``plastic_volume``, ``plastic_work``) and of `adhesive` (``branch``, ``energy``,
    /// ``stability``) are there where the state has them; any other that it lacks is None.
    #[pyo3(signature = (*, fields=false))]
    pub fn to_dict<'py>(&self, py: Python<'py>, fields: bool) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        dict.set_item("force", self.force())?;
        dict.set_item("approach", self.approach())?;
        dict.set_item("mean_gap", self.mean_gap())?;
        dict.set_item("stiffness", self.stiffness())?;
        dict.set_item("stiffness_fixed_area", self.stiffness_fixed_area())?;
        dict.set_item("area", self.area())?;
        dict.set_item("area_corrected", self.area_corrected())?;
        dict.set_item("largest_pressure", self.largest_pressure())?;
        dict.set_item("conductance", self.conductance())?;
        if let Some(plastic) = &self.state.plastic {
            dict.set_item("plastic_area", plastic.area)?;
            dict.set_item("plastic_volume", plastic.volume)?;
            dict.set_item("plastic_work", plastic.dissipated)?;
        }
        if let Some(adhesive) = &self.state.adhesive {
            dict.set_item("branch", adhesive.branch.as_str())?;
            dict.set_item("energy", adhesive.energy)?;
            dict.set_item("stability", adhesive.stability)?;
        }
        dict.set_item("contact_cells", self.contact_cells())?;
        dict.set_item("status", self.status())?;
        dict.set_item("iterations", self.iterations())?;
        dict.set_item("applications", self.applications())?;
        dict.update(self.certificate().to_dict(py)?.as_mapping())?;
        if fields {
            dict.set_item("pressure", self.pressure(py))?;
            dict.set_item("displacement", self.displacement(py))?;
            dict.set_item("gap", self.gap(py))?;
            dict.set_item("plastic_depth", self.plastic_depth(py))?;
            dict.set_item("patches", self.patches(py))?;
        }
        Ok(dict)
    }

    pub fn __repr__(&self) -> String {
        let mut text = format!("<ContactState: force={:.6e}", self.state.force);
        let known = [
            ("approach", self.approach()),
            ("mean_gap", self.mean_gap()),
            ("stiffness", self.stiffness()),
            ("stiffness_fixed_area", self.stiffness_fixed_area()),
            ("area", self.area()),
            ("conductance", self.conductance()),
        ];
        for (name, value) in known {
            if let Some(value) = value {
                text += &format!(", {name}={value:.6e}");
            }
        }
        if let Some(plastic) = self.plastic() {
            text += &format!(", plastic={}", plastic.__repr__());
        }
        if let Some(adhesive) = self.adhesive() {
            text += &format!(", adhesive={}", adhesive.__repr__());
        }
        text + &format!(", {}, {}>", self.status(), self.state.report.certificate)
    }
}
