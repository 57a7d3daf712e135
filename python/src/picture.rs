//! Pictures of maps and fields for notebooks.

use crate::errors::plain;
use fractal_contact::Cells;
use fractal_contact::plots;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// Most pixels along a side: a picture is 320 to 400 pixels of the screen wide, which may be finer ones.
const MOST: usize = 512;

/// A PNG, the last row on top: viridis from `low` to `high`, values that are not finite grey. Up to 512 values
/// along a side have a pixel each; of more, a pixel shows one of those that lie on it, so chosen that shares
/// of areas, means and extrema are kept, and the text says so.
#[pyfunction]
pub fn picture<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    low: f64,
    high: f64,
) -> PyResult<(Bound<'py, PyBytes>, String)> {
    let [rows, columns] = [values.shape()[0], values.shape()[1]];
    let values: Vec<f64> = values.as_array().iter().copied().collect();
    let cells = Cells { columns, rows };
    let (pixels, shown) = plots::shown_cells(cells, MOST, &values);
    let shown: Vec<f64> = shown.into_iter().map(|cell| values[cell]).collect();
    let png = plots::encode_viridis(pixels.columns, &shown, [low, high], false);
    let png = png.map_err(|error| plain(py, "Error", &error.to_string()))?;
    Ok((PyBytes::new(py, &png), plots::reduction(cells, pixels).unwrap_or_default()))
}
