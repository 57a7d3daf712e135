//! Maps of heights.

use crate::errors::of_model;
use crate::memory;
use crate::pool;
use fractal_contact::surface_io::{Dimension, Sides, Unit};
use fractal_contact::{Cells, HeightMap as RustMap, Size};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::IntoPyObjectExt;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use std::sync::Arc;

/// Most values along a side of the picture in a notebook.
const MOST: usize = 256;

/// Heights on a rectangle of equal cells, seen from outside its body: large values touch first.
///
/// Parameters
/// ----------
/// heights : array_like
///     Two-dimensional, ``[row, column]``: columns along x, rows along y, of any real type. A masked array has
///     undefined points where it is masked.
/// size : float, str, (float, float) or (str, str)
///     Side of a square or sides ``(Lx, Ly)`` of the rectangle, in the unit of the heights; texts with a unit, such as
///     ``"1 mm"`` or ``"2 mm x 1 mm"``, are metres.
/// unit : str, optional
///     Unit of the heights in the array, such as ``"nm"``: the map is then in metres.
/// undefined : {"error", "no_contact"}
///     What NaN means: an error, or a point that cannot touch. Masked points cannot touch either way.
#[pyclass(frozen, module = "fractal_contact")]
#[derive(Clone)]
pub struct HeightMap(pub Arc<RustMap>);

impl From<RustMap> for HeightMap {
    fn from(map: RustMap) -> Self {
        Self(Arc::new(map))
    }
}

/// A number or a pair of numbers, as sides or cells.
#[derive(FromPyObject)]
pub enum OneOrTwo<T> {
    One(T),
    Two((T, T)),
}

impl OneOrTwo<f64> {
    pub fn size(self) -> Size {
        match self {
            Self::One(side) => side.into(),
            Self::Two((x, y)) => [x, y].into(),
        }
    }
}

/// Sides as numbers, or as texts with units.
#[derive(FromPyObject)]
enum Extent {
    Numbers(OneOrTwo<f64>),
    Text(String),
    Texts((String, String)),
}

impl Extent {
    fn size(self) -> PyResult<Size> {
        let text = match self {
            Self::Numbers(numbers) => return Ok(numbers.size()),
            Self::Text(text) => text,
            Self::Texts((x, y)) => format!("{x} x {y}"),
        };
        let sides: Sides =
            text.parse().map_err(|error| PyValueError::new_err(format!("size = {text:?}: {error}")))?;
        let [x, y] = sides.both();
        if [x, y].iter().any(|side| ![Dimension::LENGTH, Dimension::NONE].contains(&side.dimension())) {
            return Err(PyValueError::new_err(format!("size = {text:?}: expected lengths")));
        }
        Ok([x.value(), y.value()].into())
    }
}

impl HeightMap {
    /// An error where there is no memory for another map of this size.
    fn copied(&self, py: Python<'_>) -> PyResult<()> {
        let cells = self.0.cells();
        memory::check_grid(py, "a map", cells, cells.map_bytes())
    }
}

#[pymethods]
impl HeightMap {
    #[new]
    #[pyo3(signature = (heights, size, *, unit=None, undefined="error"))]
    fn new(
        py: Python<'_>,
        heights: &Bound<'_, PyAny>,
        size: Extent,
        unit: Option<&str>,
        undefined: &str,
    ) -> PyResult<Self> {
        let size = size.size()?;
        // Numpy's own rules for types, masks and memory orders.
        let prepared = py.import("fractal_contact._arrays")?.call_method1("heights", (heights, undefined))?;
        let (array, partly): (PyReadonlyArray2<'_, f64>, bool) = prepared.extract()?;
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
        map.map(Self::from).map_err(|error| of_model(py, error))
    }

    /// numpy.ndarray: a copy of the heights, [row, column]; NaN at undefined points.
    #[getter]
    fn heights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.copied(py)?;
        let values = self.0.heights().iter().map(|h| if h.is_finite() { *h } else { f64::NAN }).collect();
        PyArray1::from_vec(py, values).reshape([self.0.rows(), self.0.columns()])
    }

    /// (int, int): rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.0.rows(), self.0.columns())
    }

    /// (float, float): sides (Lx, Ly).
    #[getter]
    fn size(&self) -> (f64, f64) {
        (self.0.size().x, self.0.size().y)
    }

    /// (float, float): sides of a cell (dx, dy).
    #[getter]
    fn cell(&self) -> (f64, f64) {
        (self.0.dx(), self.0.dy())
    }

    /// int: number of undefined points.
    #[getter]
    fn undefined(&self) -> usize {
        self.0.undefined()
    }

    /// float: rms height about the mean of the defined points.
    #[getter]
    fn rms_height(&self, py: Python<'_>) -> PyResult<f64> {
        // On the pool, as all that shares its work: the threads of rayon's own pool do not survive a fork.
        self.copied(py)?;
        pool::call(py, || {
            let defined: Vec<f64> = self.0.defined().collect();
            fractal_contact::surface_gen::rms_height(&defined)
        })
    }

    /// The map with x and y exchanged.
    fn transposed(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        Ok(self.0.transposed().into())
    }

    /// The map with x reversed.
    fn mirrored(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        Ok(self.0.mirrored().into())
    }

    /// The map turned by a quarter from x to y.
    fn rotated(&self, py: Python<'_>) -> PyResult<Self> {
        self.copied(py)?;
        Ok(self.0.rotated().into())
    }

    /// The map of the rows and columns from the first to before the second of each pair.
    ///
    /// Parameters
    /// ----------
    /// rows, columns : (int, int)
    ///     First, and the one after the last.
    fn cropped(&self, py: Python<'_>, rows: (usize, usize), columns: (usize, usize)) -> PyResult<Self> {
        let [wide, high] = [columns, rows].map(|(first, end)| end.saturating_sub(first));
        let cells = Cells { columns: wide.min(self.0.columns()), rows: high.min(self.0.rows()) };
        memory::check_grid(py, "a map", cells, cells.map_bytes())?;
        let map = self.0.cropped(columns.0..columns.1, rows.0..rows.1);
        map.map(Self::from).map_err(|error| of_model(py, error))
    }

    /// The map with its sides and its heights multiplied.
    fn scaled(&self, py: Python<'_>, lateral: f64, vertical: f64) -> PyResult<Self> {
        self.copied(py)?;
        self.0.scaled(lateral, vertical).map(Self::from).map_err(|error| of_model(py, error))
    }

    fn __add__(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        self.copied(py)?;
        self.0.plus(&other.0).map(Self::from).map_err(|error| of_model(py, error))
    }

    fn __sub__(&self, py: Python<'_>, other: &Self) -> PyResult<Self> {
        self.copied(py)?;
        self.0.minus(&other.0).map(Self::from).map_err(|error| of_model(py, error))
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let undefined = if self.undefined() > 0 { "no_contact" } else { "error" };
        let arguments = (self.heights(py)?, self.size(), undefined).into_pyobject(py)?;
        Ok((py.import("fractal_contact._arrays")?.getattr("restored")?, arguments))
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

    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let (rows, columns) = self.shape();
        let step = rows.max(columns).div_ceil(MOST);
        let (down, across) = (rows.div_ceil(step), columns.div_ceil(step));
        let at = |i: usize| self.0.heights()[(i / across) * step * columns + (i % across) * step] as f32;
        let values: Vec<f32> = (0..down * across).map(at).collect();
        let finite = || values.iter().copied().filter(|v| v.is_finite());
        let ends = [finite().fold(f32::INFINITY, f32::min), finite().fold(f32::NEG_INFINITY, f32::max)];
        let png = fractal_contact::plots::encode_viridis(across, &values, ends, false)
            .map_err(|error| crate::errors::plain(py, "Error", &error.to_string()))?;
        let image = py.import("base64")?.call_method1("b64encode", (png.into_py_any(py)?,))?;
        let image: String = image.call_method1("decode", ("ascii",))?.extract()?;
        let told = self.__repr__(py)?.replace('<', "&lt;").replace('>', "&gt;");
        Ok(format!(
            "<div>{told}</div><img alt=\"heights, the first row at the bottom\" width=\"320\" \
             style=\"image-rendering: pixelated\" src=\"data:image/png;base64,{image}\">"
        ))
    }
}
