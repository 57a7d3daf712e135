//! Loads and steps from the keywords of Python.

use fractal_contact::{Load, Normalisation, Tangential};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;

/// The load of a kind.
pub fn load_of(normalisation: &Normalisation, kind: &str, value: f64) -> Load {
    match kind {
        "mean_pressure" => Load::Force(value * normalisation.length.powi(2)),
        "approach" => Load::Approach(value),
        "mean_gap" => Load::MeanGap(value),
        _ => Load::Force(value),
    }
}

/// The one load that is given.
pub fn load(
    normalisation: &Normalisation,
    force: Option<f64>,
    approach: Option<f64>,
    mean_pressure: Option<f64>,
    mean_gap: Option<f64>,
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
    Ok(load_of(normalisation, kind, value))
}

/// The tangential load, where one is given.
pub fn tangential(force: Option<f64>, displacement: Option<f64>) -> PyResult<Tangential> {
    match (force, displacement) {
        (None, None) => Ok(Tangential::default()),
        (Some(force), None) => Ok(Tangential::Force(force)),
        (None, Some(displacement)) => Ok(Tangential::Displacement(displacement)),
        _ => Err(PyTypeError::new_err("give at most one of tangential_force and tangential_displacement")),
    }
}
