//! Maps of heights.

use crate::errors::of_model;
use crate::memory;
use crate::numbers::{NumberPair, OneOrTwo, RealNumber, pair};
use crate::pool;
use crate::state::{forbid_writing, reduced};
use fractal_contact::surface_io::{Dimension, Sides as TextSides, Unit};
use fractal_contact::{Cells, HeightMap as RustMap, Size};
use numpy::{
    PyArray1, PyArray2, PyArrayDescr, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods, dtype,
};
use pyo3::basic::CompareOp;
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyDict, PyIterator, PyString, PyTuple};
use std::sync::Arc;

/// Heights on a rectangle of equal cells, measured outwards from the body, so that large values touch first.
///
/// ``np.asarray(map)`` is an array of them. Maps of the same size are added and subtracted; numbers, and arrays of
/// the map's shape, are added, subtracted, multiplied and divided by. Undefined points stay undefined. Comparisons,
/// ``map[row, column]``, ``map.max()`` and the functions of numpy give what they give of the array, in which undefined
/// points are NaN; each copies the heights once. `equals` compares two maps as wholes.
///
/// Parameters
/// ----------
/// heights : array_like
///     Two-dimensional, ``[row, column]``: columns along x, rows along y, of any real type. A masked array has
///     undefined points where it is masked. Of an array whose dimensions have names, such as one of xarray, the names
///     ``x`` and ``y`` (or ``column`` and ``row``) decide which axis is which; ``metadata`` says what was done.
/// size : float, str, or two of them
///     Side of a square or sides ``(Lx, Ly)`` of the rectangle, in the unit of the heights; texts with a unit, such
///     as ``"1 mm"`` or ``"2 mm x 1 mm"``, are metres.
/// unit : str, optional
///     Unit of the heights in the array, such as ``"nm"``: the map is then in metres.
/// undefined : {"error", "no_contact"}
///     What NaN means: an error, or a point that cannot touch. Masked points cannot touch either way.
#[pyclass(name = "HeightMap", frozen, weakref, module = "fractal_contact")]
#[derive(Clone)]
pub struct PyHeightMap {
    pub map: Arc<RustMap>,
    /// What was done with the axes of an array whose dimensions have names.
    axes: Option<String>,
    /// Which points were filled when the file of the map was read.
    filled: Option<Arc<[bool]>>,
}

impl From<RustMap> for PyHeightMap {
    fn from(map: RustMap) -> Self {
        Arc::new(map).into()
    }
}

impl From<Arc<RustMap>> for PyHeightMap {
    fn from(map: Arc<RustMap>) -> Self {
        Self { map, axes: None, filled: None }
    }
}

/// The sides of a rectangle.
pub fn size(of: OneOrTwo<f64>) -> Size {
    match of {
        OneOrTwo::One(side) => side.into(),
        OneOrTwo::Two(sides) => sides.into(),
    }
}

/// Sides as numbers, or as texts with units.
struct GivenSides(Size);

impl<'py> FromPyObject<'_, 'py> for GivenSides {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Some(numbers) = OneOrTwo::of(&of) {
            return Ok(Self(size(numbers)));
        }
        let text = match (of.cast::<PyString>(), pair::<String>(&of)) {
            (Ok(text), _) => text.to_string(),
            (_, Some([x, y])) => format!("{x} x {y}"),
            _ => {
                return Err(PyTypeError::new_err(format!(
                    "size = {}: expected a number, a text with a unit such as \"1 mm\", or two of them",
                    of.repr()?
                )));
            }
        };
        let wrong = |reason: &str| PyValueError::new_err(format!("size = {text:?}: {reason}"));
        let sides: TextSides = text.parse().map_err(|error| wrong(&format!("{error}")))?;
        let [x, y] = sides.both();
        if [x, y].iter().any(|side| ![Dimension::LENGTH, Dimension::NONE].contains(&side.dimension())) {
            return Err(wrong("expected lengths"));
        }
        Ok(Self([x.value(), y.value()].into()))
    }
}

/// The centres of so many cells of this side.
fn centres(py: Python<'_>, count: usize, side: f64) -> Bound<'_, PyArray1<f64>> {
    PyArray1::from_iter(py, (0..count).map(|i| (i as f64 + 0.5) * side))
}

/// An operation on a map and a number or an array, of `fractal_contact._arrays`.
fn combined<'py>(
    map: &Bound<'py, PyHeightMap>,
    other: &Bound<'py, PyAny>,
    operation: &str,
    reflected: bool,
) -> PyResult<Bound<'py, PyAny>> {
    let arrays = map.py().import("fractal_contact._arrays")?;
    arrays.call_method1("combined", (map, other, operation, reflected))
}

impl PyHeightMap {
    /// A map, and the same one with the points undefined that were filled.
    pub fn with_holes(map: RustMap, holes: Option<&RustMap>) -> Self {
        let filled = holes.map(|holes| holes.heights().iter().map(|h| !h.is_finite()).collect());
        Self { filled, ..map.into() }
    }

    /// The map with the points undefined that were filled; `None` where none was.
    pub fn holes(&self) -> Option<RustMap> {
        let filled = self.filled.as_ref()?;
        let height = |(h, filled): (&f64, &bool)| if *filled { f64::NAN } else { *h };
        let heights = self.map.heights().iter().zip(filled.iter()).map(height).collect();
        RustMap::with_undefined(self.map.cells(), self.map.size(), heights).ok()
    }

    /// The map after a step such as a turn. The step is applied to the points that were filled as well.
    fn made<E>(&self, of: impl Fn(&RustMap) -> Result<RustMap, E>) -> Result<Self, E> {
        // A part may have been filled as a whole: then it is not known any more.
        let holes = self.holes().and_then(|holes| of(&holes).ok());
        Ok(Self::with_holes(of(&self.map)?, holes.filter(|holes| holes.undefined() > 0).as_ref()))
    }

    /// The points that were filled in either of two maps of the same cells.
    fn filled_in_either(&self, other: &Self) -> Option<Arc<[bool]>> {
        match (&self.filled, &other.filled) {
            (Some(one), Some(other)) => {
                Some(one.iter().zip(other.iter()).map(|(one, other)| *one || *other).collect())
            }
            (one, other) => one.clone().or_else(|| other.clone()),
        }
    }

    /// A copy of the heights, NaN at undefined points.
    fn array<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.copied(py)?;
        let values = self.map.heights().iter().map(|h| if h.is_finite() { *h } else { f64::NAN }).collect();
        PyArray1::from_vec(py, values).reshape([self.map.rows(), self.map.columns()])
    }

    /// An error where there is no memory for another map of this size.
    fn copied(&self, py: Python<'_>) -> PyResult<()> {
        let cells = self.map.cells();
        memory::check_grid(py, "a map", cells, cells.map_bytes())
    }
}

#[pymethods]
impl PyHeightMap {
    #[new]
    #[pyo3(signature = (heights, size, *, unit=None, undefined="error"))]
    fn new(
        py: Python<'_>,
        heights: &Bound<'_, PyAny>,
        size: GivenSides,
        unit: Option<&str>,
        undefined: &str,
    ) -> PyResult<Self> {
        let GivenSides(size) = size;
        // Numpy's own rules for types, masks and memory orders.
        let prepared = py.import("fractal_contact._arrays")?.call_method1("heights", (heights, undefined))?;
        let (array, partly, axes): (PyReadonlyArray2<'_, f64>, bool, Option<String>) = prepared.extract()?;
        let [rows, columns] = array.shape() else { unreachable!("two dimensions") };
        let cells = Cells { columns: *columns, rows: *rows };
        memory::check_grid(py, "a map", cells, cells.map_bytes())?;
        let mut values = array.to_vec()?;
        if let Some(unit) = unit {
            let known: Unit =
                unit.parse().map_err(|error| PyValueError::new_err(format!("unit = {unit:?}: {error}")))?;
            if known.dimension() != Dimension::LENGTH {
                return Err(PyValueError::new_err(format!("unit = {unit:?}: expected a unit of length")));
            }
            for value in &mut values {
                *value = known.to_si(*value);
            }
        }
        let map = if partly {
            RustMap::with_undefined(cells, size, values)
        } else {
            RustMap::new(cells, size, values)
        };
        map.map(|map| Self { axes, ..map.into() }).map_err(|error| of_model(py, error))
    }

    /// dict of str: what was done with the axes of an array whose dimensions have names, under ``"axes"``; empty for
    /// other arrays, and of a map that follows from another one.
    #[getter]
    fn metadata<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let said = PyDict::new(py);
        if let Some(axes) = &self.axes {
            said.set_item("axes", axes)?;
        }
        Ok(said)
    }

    /// numpy.ndarray or None: which points were filled when the file of the map was read with ``fill``, [row, column];
    /// None where none was. `statistics.fit_spectrum` takes them into account. Maps that follow from this one by their
    /// methods, by numbers and by arrays keep it.
    #[getter]
    fn filled<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<bool>>>> {
        let array = |filled: &Arc<[bool]>| {
            PyArray1::from_slice(py, filled).reshape([self.map.rows(), self.map.columns()])
        };
        self.filled.as_ref().map(array).transpose()
    }

    /// numpy.ndarray: the heights, [row, column]; NaN at undefined points. Read-only: ``np.array(map)`` is a copy to
    /// change.
    #[getter]
    fn heights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let array = self.array(py)?;
        forbid_writing(&array)?;
        Ok(array)
    }

    #[pyo3(signature = (dtype=None, *, copy=None))]
    fn __array__<'py>(
        &self,
        py: Python<'py>,
        dtype: Option<Bound<'py, PyAny>>,
        copy: Option<bool>,
    ) -> PyResult<Bound<'py, PyAny>> {
        if copy == Some(false) {
            return Err(PyValueError::new_err(
                "the heights of a map are copied: an array without a copy is none",
            ));
        }
        let array = self.array(py)?.into_any();
        match dtype {
            None => Ok(array),
            Some(dtype) => array.call_method("astype", (dtype,), Some(&[("copy", false)].into_py_dict(py)?)),
        }
    }

    /// Sums, differences, products and quotients are those of the map; any other function of numpy has the array.
    #[pyo3(signature = (ufunc, method, *inputs, **options))]
    fn __array_ufunc__<'py>(
        slf: &Bound<'py, Self>,
        ufunc: &Bound<'py, PyAny>,
        method: &str,
        inputs: &Bound<'py, PyTuple>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let arrays = slf.py().import("fractal_contact._arrays")?;
        arrays.call_method1("ufunc", (slf, ufunc, method, inputs, options))
    }

    /// Operations of data frames with a map are the map's.
    #[classattr]
    #[pyo3(name = "__pandas_priority__")]
    fn pandas_priority() -> u32 {
        5000
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.heights(py)?.get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        self.heights(py)?.try_iter()
    }

    fn __contains__<'py>(&self, py: Python<'py>, value: &Bound<'py, PyAny>) -> PyResult<bool> {
        self.heights(py)?.as_any().contains(value)
    }

    fn __bool__(&self, py: Python<'_>) -> PyResult<bool> {
        self.heights(py)?.is_truthy()
    }

    /// int: 2, as of the array.
    #[getter]
    #[allow(clippy::unused_self)] // A property, which has a docstring.
    fn ndim(&self) -> usize {
        2
    }

    /// numpy.dtype: that of the array, double precision.
    #[getter]
    #[allow(clippy::unused_self)] // A property, which has a docstring.
    fn dtype<'py>(&self, py: Python<'py>) -> Bound<'py, PyArrayDescr> {
        dtype::<f64>(py)
    }

    /// The largest height, as ``max`` of the array: NaN where a point is undefined.
    ///
    /// Parameters
    /// ----------
    /// axis : int, optional
    ///     0 for that of each column, 1 for that of each row; of all by default.
    /// **options
    ///     Other options of the array's method.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    #[pyo3(signature = (axis=None, **options))]
    fn max<'py>(
        &self,
        py: Python<'py>,
        axis: Option<Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.heights(py)?.call_method("max", (axis,), options)
    }

    /// The smallest height, as ``min`` of the array: NaN where a point is undefined.
    ///
    /// Parameters
    /// ----------
    /// axis : int, optional
    ///     0 for that of each column, 1 for that of each row; of all by default.
    /// **options
    ///     Other options of the array's method.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    #[pyo3(signature = (axis=None, **options))]
    fn min<'py>(
        &self,
        py: Python<'py>,
        axis: Option<Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.heights(py)?.call_method("min", (axis,), options)
    }

    /// The mean height, as ``mean`` of the array: NaN where a point is undefined.
    ///
    /// Parameters
    /// ----------
    /// axis : int, optional
    ///     0 for that of each column, 1 for that of each row; of all by default.
    /// **options
    ///     Other options of the array's method.
    ///
    /// Returns
    /// -------
    /// float or numpy.ndarray
    #[pyo3(signature = (axis=None, **options))]
    fn mean<'py>(
        &self,
        py: Python<'py>,
        axis: Option<Bound<'py, PyAny>>,
        options: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.heights(py)?.call_method("mean", (axis,), options)
    }

    /// Whether another map has the same size and the same heights to the last bit, undefined points included.
    ///
    /// Parameters
    /// ----------
    /// other : HeightMap
    ///     The other map.
    ///
    /// Returns
    /// -------
    /// bool
    fn equals(&self, other: &Self) -> bool {
        self.map == other.map
    }

    /// Number of rows, as of the array.
    fn __len__(&self) -> usize {
        self.map.rows()
    }

    /// (int, int): rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.map.rows(), self.map.columns())
    }

    /// (float, float): sides (Lx, Ly).
    #[getter]
    fn size(&self) -> (f64, f64) {
        (self.map.size().x, self.map.size().y)
    }

    /// (float, float): sides of a cell (dx, dy).
    #[getter]
    fn cell(&self) -> (f64, f64) {
        (self.map.dx(), self.map.dy())
    }

    /// (float, float, float, float): left, right, bottom and top of the rectangle, as ``imshow`` takes it with
    /// ``origin="lower"``.
    #[getter]
    fn extent(&self) -> (f64, f64, f64, f64) {
        (0.0, self.map.size().x, 0.0, self.map.size().y)
    }

    /// numpy.ndarray: places of the centres of the columns along x, shape (columns,).
    #[getter]
    fn x<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        centres(py, self.map.columns(), self.map.dx())
    }

    /// numpy.ndarray: places of the centres of the rows along y, shape (rows,).
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        centres(py, self.map.rows(), self.map.dy())
    }

    /// int: number of undefined points.
    #[getter]
    fn undefined(&self) -> usize {
        self.map.undefined()
    }

    /// float: rms height about the mean of the defined points.
    #[getter]
    fn rms_height(&self, py: Python<'_>) -> PyResult<f64> {
        // On the pool, as all that shares its work: the threads of rayon's own pool do not survive a fork.
        self.copied(py)?;
        let map = Arc::clone(&self.map);
        pool::call(py, move || {
            let defined: Vec<f64> = map.defined().collect();
            fractal_contact::surface_gen::rms_height(&defined)
        })
    }

    /// The map with x and y exchanged.
    fn transposed(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        self.made(|map| Ok(map.transposed()))
    }

    /// The map with x reversed.
    fn mirrored(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        self.made(|map| Ok(map.mirrored()))
    }

    /// The map turned by a quarter from x to y.
    fn rotated(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        self.made(|map| Ok(map.rotated()))
    }

    /// The map of the rows and columns from the first to before the second of each pair.
    ///
    /// Parameters
    /// ----------
    /// rows, columns : (int, int)
    ///     First, and the one after the last.
    fn cropped(&self, py: Python<'_>, rows: NumberPair, columns: NumberPair) -> PyResult<Self> {
        let (NumberPair(rows), NumberPair(columns)) = (rows, columns);
        let [wide, high] = [columns, rows].map(|[first, end]| end.saturating_sub(first));
        let cells = Cells { columns: wide.min(self.map.columns()), rows: high.min(self.map.rows()) };
        memory::check_grid(py, "a map", cells, cells.map_bytes())?;
        let map = self.made(|map| map.cropped(columns[0]..columns[1], rows[0]..rows[1]));
        map.map_err(|error| of_model(py, error))
    }

    /// The map with its sides and its heights multiplied.
    ///
    /// Parameters
    /// ----------
    /// lateral : float
    ///     Factor > 0 of the sides.
    /// vertical : float
    ///     Factor of the heights.
    ///
    /// Returns
    /// -------
    /// HeightMap
    ///     A new map.
    fn scaled(&self, py: Python<'_>, lateral: RealNumber, vertical: RealNumber) -> PyResult<Self> {
        self.copied(py)?;
        self.made(|map| map.scaled(lateral.0, vertical.0)).map_err(|error| of_model(py, error))
    }

    /// Draws the map with matplotlib: cells in their shape, the first row at the bottom, a colour bar.
    ///
    /// Parameters
    /// ----------
    /// ax : matplotlib.axes.Axes, optional
    ///     Axes of the picture; the current ones by default.
    /// **options
    ///     Options of ``imshow``.
    ///
    /// Returns
    /// -------
    /// matplotlib.image.AxesImage
    #[pyo3(signature = (ax=None, **options))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        options: Option<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fractal_contact._arrays")?.call_method("plot", (slf, ax), options.as_ref())
    }

    /// The map for xarray, with the dimensions y and x and their coordinates.
    ///
    /// Returns
    /// -------
    /// xarray.DataArray
    fn to_xarray<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fractal_contact._arrays")?.call_method1("to_xarray", (slf,))
    }

    fn __add__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else { return combined(slf, other, "add", false) };
        slf.get().copied(slf.py())?;
        let sum = slf.get().map.plus(&other.get().map).map_err(|error| of_model(slf.py(), error))?;
        let filled = slf.get().filled_in_either(other.get());
        Ok(Self { filled, ..sum.into() }.into_pyobject(slf.py())?.into_any())
    }

    fn __radd__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        combined(slf, other, "add", true)
    }

    fn __sub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let Ok(other) = other.cast::<Self>() else { return combined(slf, other, "subtract", false) };
        slf.get().copied(slf.py())?;
        let difference = slf.get().map.minus(&other.get().map).map_err(|error| of_model(slf.py(), error))?;
        let filled = slf.get().filled_in_either(other.get());
        Ok(Self { filled, ..difference.into() }.into_pyobject(slf.py())?.into_any())
    }

    fn __rsub__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        combined(slf, other, "subtract", true)
    }

    fn __mul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        combined(slf, other, "multiply", false)
    }

    fn __rmul__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        combined(slf, other, "multiply", true)
    }

    fn __truediv__<'py>(slf: &Bound<'py, Self>, other: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        combined(slf, other, "divide", false)
    }

    fn __neg__(&self, py: Python<'_>) -> PyResult<Self> {
        self.scaled(py, RealNumber(1.0), RealNumber(-1.0))
    }

    fn __pos__(&self) -> Self {
        self.clone()
    }

    /// Element by element, as of the array.
    fn __richcmp__<'py>(
        &self,
        py: Python<'py>,
        other: &Bound<'py, PyAny>,
        operation: CompareOp,
    ) -> PyResult<Bound<'py, PyAny>> {
        let other = py.import("fractal_contact._arrays")?.call_method1("operand", (other,))?;
        self.heights(py)?.rich_compare(other, operation)
    }

    /// The map with what is known of where it comes from.
    #[staticmethod]
    #[pyo3(signature = (map, axes, filled))]
    fn _with_origin(
        map: &Self,
        axes: Option<String>,
        filled: Option<PyReadonlyArray2<'_, bool>>,
    ) -> PyResult<Self> {
        let filled = filled.map(|filled| filled.to_vec()).transpose()?.map(Arc::from);
        Ok(Self { axes, filled, ..map.clone() })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let undefined = if self.undefined() > 0 { "no_contact" } else { "error" };
        reduced(py, "height_map", (self.array(py)?, self.size(), undefined, &self.axes, self.filled(py)?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (rows, columns) = self.shape();
        let (x, y) = self.size();
        let undefined =
            if self.undefined() > 0 { format!(", {} undefined", self.undefined()) } else { String::new() };
        let rms = self.rms_height(py)?;
        Ok(format!(
            "<HeightMap: {rows} rows x {columns} columns, {x:e} x {y:e}, rms height {rms:.4e}{undefined}>"
        ))
    }

    fn _repr_html_(slf: Bound<'_, Self>) -> PyResult<Bound<'_, PyAny>> {
        slf.py().import("fractal_contact._html")?.call_method1("height_map", (&slf,))
    }
}
