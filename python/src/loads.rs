//! Loads and steps from the keywords of Python.

use crate::numbers::RealNumber;
use fractal_contact::{Load, Normalisation, Tangential};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyString;

/// The load of a kind.
pub fn load_of(normalisation: &Normalisation, kind: &str, value: f64) -> Load {
    match kind {
        "mean_pressure" => Load::force(value * normalisation.length.powi(2)),
        "approach" => Load::approach(value),
        "mean_gap" => Load::mean_gap(value),
        _ => Load::force(value),
    }
}

/// The one load that is given.
pub fn load(
    normalisation: &Normalisation,
    force: Option<RealNumber>,
    approach: Option<RealNumber>,
    mean_pressure: Option<RealNumber>,
    mean_gap: Option<RealNumber>,
) -> PyResult<Load> {
    let (kind, value) = match (force, approach, mean_pressure, mean_gap) {
        (Some(force), None, None, None) => ("force", force),
        (None, Some(approach), None, None) => ("approach", approach),
        (None, None, Some(pressure), None) => ("mean_pressure", pressure),
        (None, None, None, Some(gap)) => ("mean_gap", gap),
        _ => {
            return Err(PyTypeError::new_err(
                "give exactly one of force, approach, mean_pressure and mean_gap",
            ));
        }
    };
    Ok(load_of(normalisation, kind, value.0))
}

/// A number along x, or two along x and along y.
fn components(value: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    // What is a number is one, and its own error tells of what is neither.
    let number = value.extract::<RealNumber>();
    let (Err(error), false) = (&number, value.is_instance_of::<PyString>()) else {
        return number.map(|RealNumber(along_x)| [along_x, 0.0]);
    };
    let Ok(items) = value.try_iter() else { return Err(error.clone_ref(value.py())) };
    // One more than there may be, of what may never end.
    let values =
        items.take(3).map(|item| Ok(item?.extract::<RealNumber>()?.0)).collect::<PyResult<Vec<f64>>>()?;
    let shown = |count: usize| if count < 3 { count.to_string() } else { "more than two".to_owned() };
    values.try_into().map_err(|values: Vec<f64>| {
        let count = shown(values.len());
        PyValueError::new_err(format!(
            "a tangential load of {count} components: expected one number along x, or two along x and along y"
        ))
    })
}

/// The tangential load, where one is given.
pub fn tangential(
    force: Option<&Bound<'_, PyAny>>,
    displacement: Option<&Bound<'_, PyAny>>,
) -> PyResult<Tangential> {
    match (force, displacement) {
        (None, None) => Ok(Tangential::default()),
        (Some(force), None) => components(force).map(Tangential::Force),
        (None, Some(displacement)) => components(displacement).map(Tangential::Displacement),
        _ => Err(PyTypeError::new_err("give at most one of tangential_force and tangential_displacement")),
    }
}
