//! Errors of the library as the exceptions of `fractal_contact._errors`, with their numbers as attributes.

use crate::state::{self, PyContactState, StateOrigin};
use fractal_contact::models::{ModelRecord, able};
use fractal_contact::runs::{self, files};
use fractal_contact::{ContactState as RustState, Error, Scene, scenes, surface_io};
use pyo3::exceptions::{PyOSError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyTuple, PyType};
use std::io;
use std::path::Path;

/// An exception class of `fractal_contact._errors`.
fn class<'py>(py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyType>> {
    static MODULE: PyOnceLock<Py<PyModule>> = PyOnceLock::new();
    let module =
        MODULE.get_or_try_init(py, || py.import("fractal_contact._errors").map(Bound::unbind))?.bind(py);
    Ok(module.getattr(name)?.cast_into::<PyType>()?)
}

/// An exception with a message and attributes.
pub fn exception(py: Python<'_>, name: &str, message: &str, attributes: &Bound<'_, PyDict>) -> PyErr {
    let raise = || -> PyResult<PyErr> {
        let value = class(py, name)?.call1((message,))?;
        for (key, attribute) in attributes {
            value.setattr(key.cast_into()?, attribute)?;
        }
        Ok(PyErr::from_value(value))
    };
    raise().unwrap_or_else(|error| error)
}

/// An exception without numbers.
pub fn plain(py: Python<'_>, name: &str, message: &str) -> PyErr {
    exception(py, name, message, &PyDict::new(py))
}

/// An error of a call that solves nothing, which has no state.
pub fn of_model(py: Python<'_>, error: Error) -> PyErr {
    let message = error.to_string();
    of_any(py, error, &message, &PyDict::new(py), None)
}

/// An error of a contact of this origin.
pub fn of_solve(py: Python<'_>, error: Error, origin: &StateOrigin) -> PyErr {
    let message = error.to_string();
    of_any(py, error, &message, &PyDict::new(py), Some(origin))
}

/// What was stopped before it had begun, or without a state.
pub fn stopped(py: Python<'_>) -> PyErr {
    of_model(py, Error::Stopped { best: None })
}

/// An error of a model that plans a scene: what the model lacks is told with the models that have it.
pub fn of_planning(py: Python<'_>, error: Error, scene: &Scene) -> PyErr {
    let (mut message, attributes) = (error.to_string(), PyDict::new(py));
    if let Error::Unsupported { model, .. } = &error
        && ModelRecord::named(model).is_some()
    {
        let able: Vec<&ModelRecord> = able(scene).filter(|record| record.name() != *model).collect();
        let names: Vec<&str> = able.iter().map(|record| record.name()).collect();
        if !able.is_empty() {
            let classes: Vec<String> = able.iter().map(|record| format!("fc.{}", record.class)).collect();
            message += &format!("; models that may: {}", classes.join(", "));
        }
        // A failure to say more is none of the caller.
        let _ = PyTuple::new(py, names).and_then(|names| attributes.set_item("able", names));
    }
    of_any(py, error, &message, &attributes, None)
}

fn of_any(
    py: Python<'_>,
    error: Error,
    message: &str,
    attributes: &Bound<'_, PyDict>,
    origin: Option<&StateOrigin>,
) -> PyErr {
    let state = |best: RustState| -> PyResult<Option<Py<PyContactState>>> {
        origin.map(|origin| state::of(py, best, origin)).transpose()
    };
    let fill = || -> PyResult<&str> {
        Ok(match error {
            Error::Domain { name, value, expected } => {
                attributes.set_item("quantity", name)?;
                attributes.set_item("value", value)?;
                attributes.set_item("expected", expected)?;
                "DomainError"
            }
            Error::Shape { name, found, expected } => {
                attributes.set_item("quantity", name)?;
                attributes.set_item("value", found)?;
                attributes.set_item("expected", expected)?;
                "ShapeError"
            }
            Error::Unsupported { model, what } => {
                attributes.set_item("model", model)?;
                attributes.set_item("what", what)?;
                "Unsupported"
            }
            Error::OutOfRange { name, value, min, max } => {
                attributes.set_item("quantity", name)?;
                attributes.set_item("value", value)?;
                attributes.set_item("low", min)?;
                attributes.set_item("high", max)?;
                "OutOfRange"
            }
            Error::OutOfMemory { what, bytes, available } => {
                attributes.set_item("what", what)?;
                attributes.set_item("needed", bytes)?;
                attributes.set_item("available", available)?;
                "OutOfMemory"
            }
            Error::NotConverged { best } => {
                attributes.set_item("best", state(*best)?)?;
                "NotConverged"
            }
            Error::Stopped { best } => {
                let best = best.map(|best| state(*best)).transpose()?.flatten();
                attributes.set_item("best", best)?;
                "Stopped"
            }
            _ => "Error",
        })
    };
    match fill() {
        Ok(name) => exception(py, name, message, attributes),
        Err(error) => error,
    }
}

/// A refusal of the system as Python has it: `FileNotFoundError`, `PermissionError` and other classes of
/// `OSError`.
fn of_system(path: &Path, source: &io::Error) -> Option<PyErr> {
    let code = source.raw_os_error()?;
    let reason = source.to_string();
    let reason = reason.split(" (os error").next().unwrap_or_default().to_owned();
    Some(PyOSError::new_err((code, reason, path.as_os_str().to_owned())))
}

/// An error of the file of a surface.
pub fn of_surface(py: Python<'_>, error: &surface_io::Error) -> PyErr {
    let system = match error {
        surface_io::Error::System { path, source, .. } => of_system(path, source),
        _ => None,
    };
    system.unwrap_or_else(|| plain(py, "ReadError", &error.to_string()))
}

/// An error of a scene or its files.
pub fn of_scene(py: Python<'_>, error: &scenes::Error) -> PyErr {
    let system = match error {
        scenes::Error::Run(runs::Error::File(files::Error::System { path, source, .. })) => {
            of_system(path, source)
        }
        scenes::Error::Surface(error) => return of_surface(py, error),
        _ => None,
    };
    if let Some(system) = system {
        return system;
    }
    let name = match error {
        scenes::Error::Scene(_) => "SceneError",
        _ => "Error",
    };
    plain(py, name, error.to_string().trim_start_matches("error: "))
}

/// An error of values that the reader of scenes read.
pub fn of_values(py: Python<'_>, error: &scenes::Diagnostic) -> PyErr {
    match error.domain() {
        Some(domain) => of_model(py, domain.clone()),
        None if error.is_type() => PyTypeError::new_err(error.message().to_owned()),
        None => {
            let help = error.help().map_or_else(String::new, |help| format!("; {help}"));
            PyValueError::new_err(format!("{}{help}", error.message()))
        }
    }
}
