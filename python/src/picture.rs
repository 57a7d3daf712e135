//! Pictures of maps and fields for notebooks.

use crate::errors::plain;
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// A PNG with a pixel for each value, the last row on top: viridis from `low` to `high`, values that are not
/// finite grey.
#[pyfunction]
pub fn picture<'py>(
    py: Python<'py>,
    values: PyReadonlyArray2<'py, f64>,
    low: f64,
    high: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let columns = values.shape()[1];
    // In single precision neither the ends nor a value between them overflows.
    let scale = if high > low { high - low } else { 1.0 };
    let pixels: Vec<f32> = values.as_array().iter().map(|value| ((value - low) / scale) as f32).collect();
    let ends = [0.0, if high > low { 1.0 } else { 0.0 }];
    let png = fractal_contact::plots::encode_viridis(columns, &pixels, ends, false);
    Ok(PyBytes::new(py, &png.map_err(|error| plain(py, "Error", &error.to_string()))?))
}
