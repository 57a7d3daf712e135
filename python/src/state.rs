//! States of a contact.

use crate::errors::of_model;
use crate::notes::note;
use crate::quantities::{is_named_where_known, object};
use fractal_contact::quantities::{QUANTITIES, Role, StateQuantity};
use fractal_contact::scenes::StateNotes;
use fractal_contact::{
    Certificate as RustCertificate, ContactResolution, ContactState as RustState, FIELDS, Field,
    FieldQuantity, Normalisation as RustNormalisation, PathMemory, Scene, SolveReport, Value,
};
use numpy::ndarray::Dimension;
use numpy::{BorrowError, PyArray, PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use serde::Serialize;
use serde::de::DeserializeOwned;

/// A field as an array `[row, column]` that owns its values, nothing is copied; of several components
/// `[component, row, column]`. None without components. Nobody writes into it: all who ask have the same.
pub fn array(py: Python<'_>, components: Vec<Field>) -> PyResult<Option<Py<PyArrayDyn<f64>>>> {
    let count = components.len();
    let mut components = components.into_iter();
    let Some(first) = components.next() else { return Ok(None) };
    let shape = [count, first.rows(), first.columns()];
    let mut values = first.into_values();
    values.extend(components.flat_map(Field::into_values));
    let shape = shape[usize::from(count == 1)..].to_vec();
    let flat = PyArray1::from_vec(py, values);
    forbid_writing(&flat)?;
    Ok(Some(flat.reshape(shape)?.unbind()))
}

/// Makes an array read-only. One that is so already, such as a view of a file or of bytes, stays as it is.
///
/// # Errors
/// For an array that is being written to.
pub fn forbid_writing<D: Dimension>(array: &Bound<'_, PyArray<f64, D>>) -> PyResult<()> {
    match array.try_readwrite() {
        Ok(writable) => {
            writable.make_nonwriteable();
            Ok(())
        }
        Err(BorrowError::NotWriteable) => Ok(()),
        Err(error) => Err(error.into()),
    }
}

/// What a value is made of, as bytes for another process of the same version.
pub fn bytes<'py>(py: Python<'py>, of: &impl Serialize) -> PyResult<Bound<'py, PyBytes>> {
    let kept = PathMemory::of(of).map_err(|error| of_model(py, error))?;
    Ok(PyBytes::new(py, kept.bytes()))
}

/// The value of such bytes.
///
/// # Errors
/// `ShapeError` for bytes of something else.
pub fn of_bytes<T: DeserializeOwned>(py: Python<'_>, bytes: &[u8]) -> PyResult<T> {
    PathMemory::from_bytes(bytes.to_vec()).read().map_err(|_| {
        let expected = "the bytes of one, pickled by this version".into();
        of_model(py, fractal_contact::Error::Shape { name: "pickle".into(), found: bytes.len(), expected })
    })
}

/// How a value is made again from the function `name` of `fractal_contact._restored`.
pub fn reduced<'py, A>(py: Python<'py>, name: &str, arguments: A) -> PyResult<Bound<'py, PyTuple>>
where
    A: IntoPyObject<'py>,
{
    (py.import("fractal_contact._restored")?.getattr(name)?, arguments).into_pyobject(py)
}

/// What a contact tells its states, besides what was solved.
#[derive(Debug, Clone, Copy)]
pub struct StateOrigin {
    pub normalisation: RustNormalisation,
    notes: StateNotes,
    /// Sides of the rectangle.
    size: [f64; 2],
}

impl StateOrigin {
    /// Of a contact of this scene.
    pub fn new(scene: &Scene, normalisation: RustNormalisation) -> Self {
        let size = scene.surface.size();
        Self { normalisation, notes: StateNotes::new(scene), size: [size.x, size.y] }
    }
}

/// Looks up all that arrays need of numpy, while the module is imported.
///
/// The crate `numpy` does so when the first array is made, and takes for granted that nothing fails there: a
/// Ctrl-C that came at that moment would be a panic.
pub fn look_up_arrays(py: Python<'_>) -> PyResult<()> {
    py.import("numpy")?;
    let array = PyArray1::from_vec(py, vec![0.0]).reshape(vec![1, 1])?;
    array.try_readonly()?;
    Ok(())
}

/// How exactly the contact conditions hold, measured with the exact operator in double precision.
///
/// All numbers are relative and dimensionless.
#[pyclass(name = "Certificate", frozen, eq, module = "fractal_contact")]
#[derive(Clone, PartialEq)]
pub struct PyCertificate(RustCertificate);

#[pymethods]
impl PyCertificate {
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

    /// float: relative difference of the force from the prescribed one; of a prescribed mean gap its error over
    /// the rms height. With adhesion relative to a thousandth of the force of the contact pressure where that is
    /// larger than the prescribed force.
    #[getter]
    fn load_error(&self) -> f64 {
        self.0.load_error
    }

    /// float or None: estimated relative error of the stiffness; None where it is a difference quotient
    /// (`quotient_error`).
    #[getter]
    fn stiffness_error(&self) -> Option<f64> {
        self.0.stiffness_error
    }

    /// float or None: estimated relative error of a stiffness that is a difference quotient, with adhesion of
    /// short range and Dugdale's law. It depends on the cells, not on the tolerance, so it is no part of `worst`.
    #[getter]
    fn quotient_error(&self) -> Option<f64> {
        self.0.quotient_error
    }

    /// float or None: bound of the relative error of the force under a prescribed approach or mean gap, an
    /// estimate with adhesion; no part of `worst`.
    #[getter]
    fn force_error(&self) -> Option<f64> {
        self.0.force_error
    }

    /// float or None: estimated relative error of the stiffness, whether it is a difference quotient or not;
    /// ``stiffness_error`` in tables.
    #[getter]
    fn error_of_stiffness(&self) -> Option<f64> {
        self.0.error_of_stiffness()
    }

    /// float or None: largest difference between the traction of a cell and what the law of adhesion says of
    /// its gap, over work/range; None without adhesion of finite range.
    #[getter]
    fn equilibrium(&self) -> Option<f64> {
        self.0.equilibrium
    }

    /// float or None: duality gap of the last step of friction over sliding force times tangential displacement,
    /// without how far the contact has slid before; None without friction, and where a model does not solve it
    /// cell by cell.
    #[getter]
    fn tangential_duality_gap(&self) -> Option<f64> {
        self.0.tangential_duality_gap
    }

    /// float or None: difference of the tangential force from the prescribed one, over the sliding force.
    #[getter]
    fn tangential_load_error(&self) -> Option<f64> {
        self.0.tangential_load_error
    }

    /// float or None: estimated relative error of the tangential stiffness.
    #[getter]
    fn tangential_stiffness_error(&self) -> Option<f64> {
        self.0.tangential_stiffness_error
    }

    /// float: the largest of the numbers that the tolerance bounds.
    #[getter]
    fn worst(&self) -> f64 {
        self.0.worst()
    }

    fn __hash__(&self) -> u64 {
        // Of equal certificates equal; 0 and -0 are equal.
        (self.0.worst() + 0.0).to_bits()
    }

    /// Whether every number that the tolerance bounds is at most `tolerance`.
    ///
    /// Parameters
    /// ----------
    /// tolerance : float
    ///     Dimensionless, as that of the model.
    ///
    /// Returns
    /// -------
    /// bool
    fn meets(&self, tolerance: f64) -> bool {
        self.0.meets(tolerance)
    }

    /// The numbers by the names of the columns of scenes; ``stiffness_error`` is `error_of_stiffness`.
    ///
    /// Returns
    /// -------
    /// dict of float or None
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        // The residuals of the table, of a state that has nothing but this certificate.
        let mut state = RustState::new(0.0, SolveReport::exact(""));
        state.report.certificate = self.0;
        let normalisation = RustNormalisation { contact_modulus: 1.0, length: 1.0, height: None };
        let dict = PyDict::new(py);
        for quantity in QUANTITIES.iter().filter(|quantity| matches!(quantity.role, Role::Residual(_))) {
            dict.set_item(quantity.name, object(py, (quantity.value)(&state, &normalisation))?)?;
        }
        Ok(dict)
    }

    /// From the bytes of `__reduce__`.
    #[staticmethod]
    fn _of_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        of_bytes(py, bytes).map(Self)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        reduced(py, "certificate", (bytes(py, &self.0)?,))
    }

    fn __repr__(&self) -> String {
        format!("<Certificate: {}>", self.0)
    }
}

/// One contact state, alone or at the end of a step of a path.
///
/// What was not requested, or what the model does not claim, is None. Two states compare with ``==`` as wholes: they
/// are equal if all their numbers, fields and notes are, to the last bit.
///
/// Its numbers and words are those of `quantities`. Units in brackets are those of SI; a scene in other units
/// has its own.
#[pyclass(name = "ContactState", frozen, weakref, module = "fractal_contact")]
pub struct PyContactState {
    state: RustState,
    normalisation: RustNormalisation,
    notes: Vec<String>,
    size: [f64; 2],
    /// In the order of `FIELDS`.
    fields: Vec<Option<Py<PyArrayDyn<f64>>>>,
}

/// Moves a state of a contact of this origin into Python.
pub fn of(py: Python<'_>, mut state: RustState, origin: &StateOrigin) -> PyResult<Py<PyContactState>> {
    let StateOrigin { normalisation, notes, size } = *origin;
    let notes = notes.of(&state).into_iter().map(note).collect();
    let mut taken = state.fields.take().unwrap_or_default();
    let arrays = FIELDS.iter().map(|quantity| array(py, (quantity.take)(&mut taken)));
    let fields = arrays.collect::<PyResult<_>>()?;
    Py::new(py, PyContactState { state, normalisation, notes, size, fields })
}

impl PyContactState {
    /// What the table takes from it.
    pub fn value(&self, quantity: &StateQuantity) -> Value {
        (quantity.value)(&self.state, &self.normalisation)
    }

    /// The array of a field, where it was asked for.
    pub fn field(&self, py: Python<'_>, quantity: &FieldQuantity) -> Option<Py<PyArrayDyn<f64>>> {
        let known = FIELDS.iter().zip(&self.fields);
        let (_, field) = known.into_iter().find(|(known, _)| known.name == quantity.name)?;
        field.as_ref().map(|field| field.clone_ref(py))
    }
}

impl PyContactState {
    /// How well cells resolve the contact; a formula has none.
    fn resolution_of_cells(&self) -> Option<ContactResolution> {
        self.state.resolution.filter(|_| self.state.report.contact_cells.is_some())
    }
}

#[pymethods]
impl PyContactState {
    /// int or None: cells in contact at an edge of a free rectangle.
    #[getter]
    fn edge_cells(&self) -> Option<usize> {
        self.resolution_of_cells().map(|resolution| resolution.edge_cells)
    }

    /// int or None: cells in contact that share an edge with an undefined point of the surface.
    #[getter]
    fn rim_cells(&self) -> Option<usize> {
        self.resolution_of_cells().map(|resolution| resolution.rim_cells)
    }

    /// numpy.ndarray or None: areas of the connected contacts (length^2), the largest first; shape
    /// (patches,). Read-only.
    #[getter]
    fn patches<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        let Some(patches) = self.state.patches.as_ref() else { return Ok(None) };
        let array = PyArray1::from_slice(py, patches.areas());
        forbid_writing(&array)?;
        Ok(Some(array))
    }

    /// tuple of str: what may be wrong with the state though it is solved, such as few cells in contact or contact at
    /// the edge, and what to do about it.
    #[getter]
    fn notes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, &self.notes)
    }

    /// (float, float): sides (Lx, Ly) of the rectangle.
    #[getter]
    fn size(&self) -> (f64, f64) {
        self.size.into()
    }

    /// Certificate: how exactly the contact conditions hold.
    #[getter]
    fn certificate(&self) -> PyCertificate {
        PyCertificate(self.state.report.certificate)
    }

    /// The numbers and words by their names, which are those of the columns of scenes.
    ///
    /// Arrays are there only with ``fields=True``. Those of effects and of paths are there where the state has them; any other that it lacks is None.
    /// ``patches`` is the number of connected contacts, and with ``fields=True`` the array.
    ///
    /// Parameters
    /// ----------
    /// fields : bool
    ///     True to add the arrays of the fields that were requested.
    ///
    /// Returns
    /// -------
    /// dict
    ///     Numbers, texts, None and arrays by their names.
    #[pyo3(signature = (*, fields=false))]
    fn to_dict<'py>(&self, py: Python<'py>, fields: bool) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for quantity in QUANTITIES {
            match self.value(quantity) {
                Value::Empty if is_named_where_known(quantity) => {}
                value => dict.set_item(quantity.name, object(py, value)?)?,
            }
        }
        if fields {
            for quantity in FIELDS {
                dict.set_item(quantity.name, self.field(py, quantity))?;
            }
            dict.set_item("patches", self.patches(py)?)?;
        }
        Ok(dict)
    }

    /// Whether two states are the same to the last bit, with their fields and notes.
    fn __eq__(&self, py: Python<'_>, other: &Self) -> PyResult<bool> {
        let numbers = self.state == other.state
            && self.normalisation == other.normalisation
            && self.notes == other.notes
            && self.size.map(f64::to_bits) == other.size.map(f64::to_bits);
        if !numbers {
            return Ok(false);
        }
        for fields in self.fields.iter().zip(&other.fields) {
            let same = match fields {
                (Some(one), Some(other)) => {
                    let (one, other) = (one.bind(py).try_readonly()?, other.bind(py).try_readonly()?);
                    one.as_array() == other.as_array()
                }
                (one, other) => one.is_none() == other.is_none(),
            };
            if !same {
                return Ok(false);
            }
        }
        Ok(true)
    }

    fn __hash__(&self) -> u64 {
        // Of equal states equal; 0 and -0 are equal.
        (self.state.force + 0.0).to_bits()
    }

    /// From the bytes of `__reduce__` and the fields, in the order of `FIELDS`.
    #[staticmethod]
    fn _of_bytes(
        py: Python<'_>,
        bytes: &[u8],
        fields: Vec<Option<Bound<'_, PyArrayDyn<f64>>>>,
    ) -> PyResult<Self> {
        fields.iter().flatten().try_for_each(forbid_writing)?;
        let (state, normalisation, notes, size) = of_bytes(py, bytes)?;
        let mut fields: Vec<_> = fields.into_iter().map(|field| field.map(Bound::unbind)).collect();
        fields.resize_with(FIELDS.len(), || None);
        Ok(Self { state, normalisation, notes, size, fields })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let kept = bytes(py, &(&self.state, &self.normalisation, &self.notes, &self.size))?;
        let fields: Vec<_> =
            self.fields.iter().map(|field| field.as_ref().map(|field| field.bind(py))).collect();
        reduced(py, "state", (kept, fields))
    }

    fn _repr_html_(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        slf.py().import("fractal_contact._html")?.call_method1("state", (&slf,))
    }

    fn __repr__(&self) -> String {
        let mut known = Vec::new();
        for quantity in QUANTITIES.iter().filter(|quantity| quantity.role == Role::Answer) {
            match self.value(quantity) {
                Value::Text(text) => known.push(format!("{}={text}", quantity.name)),
                Value::Number(number) => known.push(format!("{}={number:.6e}", quantity.name)),
                Value::Count(count) => known.push(format!("{}={count}", quantity.name)),
                Value::Flag(flag) => known.push(format!("{}={flag}", quantity.name)),
                Value::Empty => {}
            }
        }
        let report = &self.state.report;
        let notes: Vec<&str> = self.notes.iter().filter_map(|note| note.split(": ").next()).collect();
        let notes = if notes.is_empty() { String::new() } else { format!(", notes: {}", notes.join("; ")) };
        let (known, status) = (known.join(", "), report.status.as_str());
        format!("<ContactState: {known}, {status}, {}{notes}>", report.certificate)
    }
}
