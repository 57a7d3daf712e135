//! Models by name, and contacts that they have planned.

use crate::contact::Contact;
use crate::errors::{of_model, of_planning};
use crate::memory;
use crate::pool;
use crate::scene::{Scene, optional};
use fractal_contact::analytic::{GreenwoodWilliamson, Persson, greenwood_williamson::SummitHeights};
use fractal_contact::bem3d::Method;
use fractal_contact::models::{MODELS, ModelRecord, abilities};
use fractal_contact::{
    Abilities, Bem3d, ContactModel, Equivalent, Error, Mdr1d, Paths, PreparedContact, RequiredMemory,
    Scene as RustScene, Source,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// A model that is chosen at run time.
#[derive(Clone)]
pub struct Shared(Arc<dyn ContactModel>);

impl ContactModel for Shared {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn sources(&self) -> &'static [Source] {
        self.0.sources()
    }

    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn prepare(&self, scene: &RustScene, seed: u64) -> fractal_contact::Result<Box<dyn PreparedContact>> {
        self.0.prepare(scene, seed)
    }

    fn least_memory(&self, scene: &RustScene) -> Option<RequiredMemory> {
        self.0.least_memory(scene)
    }
}

/// A way to answer what force, approach and stiffness belong together.
#[pyclass(frozen, module = "fractal_contact._core")]
#[derive(Clone)]
pub struct Model {
    pub model: Shared,
    /// Whether its solves may be long enough to leave the interpreter's thread.
    long: bool,
}

/// The models of the library.
///
/// Returns
/// -------
/// list of dict
///     ``name`` (in scenes and tables), ``title``, ``class`` (in Python), ``about``, ``accuracy`` and ``has_options``.
#[pyfunction]
pub fn models(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let row = |record: &ModelRecord| {
        let row = PyDict::new(py);
        row.set_item("name", record.name())?;
        row.set_item("title", record.title)?;
        row.set_item("class", record.class)?;
        row.set_item("about", record.about)?;
        row.set_item("accuracy", record.accuracy)?;
        row.set_item("has_options", record.has_options)?;
        Ok(row)
    };
    MODELS.iter().map(row).collect()
}

/// A model by the name that scenes give it.
#[pyfunction]
#[pyo3(signature = (name, options, inner=None))]
pub fn model(
    py: Python<'_>,
    name: &str,
    options: &Bound<'_, PyDict>,
    inner: Option<&Model>,
) -> PyResult<Model> {
    let model: Arc<dyn ContactModel> = match name {
        "bem3d" => Arc::new(bem3d(py, options)?),
        "mdr1d" => {
            let elements = optional(options, "elements")?.unwrap_or(Mdr1d::default().elements);
            Arc::new(Mdr1d { elements })
        }
        "persson" => {
            let gamma = optional(options, "gamma")?.unwrap_or(Persson::default().gamma);
            Arc::new(Persson { gamma })
        }
        "greenwood_williamson" => {
            let heights = match optional::<String>(options, "heights")?.as_deref() {
                None | Some("gaussian") => SummitHeights::Gaussian,
                Some("exponential") => SummitHeights::Exponential,
                Some(other) => {
                    return Err(PyValueError::new_err(format!(
                        "heights is {other:?}: expected \"gaussian\" or \"exponential\""
                    )));
                }
            };
            Arc::new(GreenwoodWilliamson { heights })
        }
        "equivalent" => {
            let Some(Model { model, .. }) = inner else {
                return Err(PyTypeError::new_err("equivalent takes a model that presses"));
            };
            let standard = Equivalent::new(model.clone());
            Arc::new(Equivalent {
                per_decade: optional(options, "per_decade")?.unwrap_or(standard.per_decade),
                decades: optional(options, "decades")?.unwrap_or(standard.decades),
                model: standard.model,
            })
        }
        _ => match ModelRecord::named(name) {
            Some(record) if !record.has_options => Arc::new(record.model),
            _ => return Err(PyValueError::new_err(format!("no model is called {name:?}"))),
        },
    };
    let has_options = ModelRecord::named(name).is_none_or(|record| record.has_options);
    let long = has_options || model.abilities().paths == Paths::Needed;
    Ok(Model { model: Shared(model), long })
}

fn bem3d(py: Python<'_>, options: &Bound<'_, PyDict>) -> PyResult<Bem3d> {
    let standard = Bem3d::default();
    let method = match optional::<String>(options, "method")?.as_deref() {
        None | Some("auto") => Method::Auto,
        Some("iterative") => Method::Iterative,
        Some("single_level") => Method::SingleLevel,
        Some(other) => {
            return Err(PyValueError::new_err(format!(
                "method is {other:?}: expected \"auto\", \"iterative\" or \"single_level\""
            )));
        }
    };
    let tolerance: f64 = optional(options, "tolerance")?.unwrap_or(standard.tolerance);
    if !(tolerance.is_finite() && tolerance > 0.0) {
        return Err(of_model(py, Error::domain("tolerance", tolerance, "a finite number > 0")));
    }
    Ok(Bem3d {
        cells: optional(options, "cells")?.unwrap_or(standard.cells),
        rows: optional(options, "rows")?,
        tolerance,
        max_outer_iterations: optional(options, "max_outer_iterations")?
            .unwrap_or(standard.max_outer_iterations),
        method,
    })
}

impl Model {
    /// `MemoryError` where a contact of a scene needs more than there is; otherwise whether that is much.
    fn check_memory(&self, py: Python<'_>, scene: &RustScene) -> PyResult<bool> {
        let least = self.model.least_memory(scene);
        let large = memory::is_large(least.as_ref());
        least.map_or(Ok(()), |RequiredMemory { what, bytes }| memory::check(py, what, bytes))?;
        Ok(large)
    }
}

#[pymethods]
impl Model {
    /// Name of the model, as in scenes.
    #[getter]
    fn name(&self) -> &'static str {
        self.model.name()
    }

    /// What it is built on: (citation, what is taken from it).
    #[getter]
    fn sources(&self) -> Vec<(&'static str, &'static str)> {
        self.model.sources().iter().map(|source| (source.citation, source.what)).collect()
    }

    /// What it can do, in words.
    #[getter]
    fn supports<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (about, words) in abilities(&self.model) {
            dict.set_item(about, PyTuple::new(py, words)?)?;
        }
        Ok(dict)
    }

    fn prepare(&self, py: Python<'_>, scene: &Scene, seed: u64) -> PyResult<Contact> {
        let large = self.check_memory(py, &scene.0)?;
        let scene = scene.0.clone();
        // Any model may measure a map.
        let contact = pool::call(py, || self.model.prepare(&scene, seed))?;
        contact
            .map(|contact| Contact::new(contact, &scene, self.long, large))
            .map_err(|error| of_planning(py, error, &scene))
    }
}
