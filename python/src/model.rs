//! Models by name, and contacts that they have planned.

use crate::contact::PyContact;
use crate::errors::{of_planning, of_values};
use crate::memory;
use crate::numbers::Seed;
use crate::pool;
use crate::scene::PyScene;
use crate::toml_text::toml_text;
use fractal_contact::models::{MODELS, ModelRecord, abilities};
use fractal_contact::scenes::Numerics;
use fractal_contact::{
    Abilities, ContactModel, Effects, Equivalent, Error, Outputs, Paths, PreparedContact, RequiredMemory,
    Scene as RustScene, Source, Stop,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::sync::Arc;

/// A model that is chosen at run time.
#[derive(Clone)]
pub struct SharedModel(Arc<dyn ContactModel>);

impl ContactModel for SharedModel {
    fn name(&self) -> &'static str {
        self.0.name()
    }

    fn sources(&self) -> &'static [Source] {
        self.0.sources()
    }

    fn sources_of(&self, effects: &Effects) -> Vec<Source> {
        self.0.sources_of(effects)
    }

    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn prepare(&self, scene: &RustScene, seed: u64) -> fractal_contact::Result<Box<dyn PreparedContact>> {
        self.0.prepare(scene, seed)
    }

    fn prepare_until(
        &self,
        scene: &RustScene,
        seed: u64,
        stop: Stop<'_>,
    ) -> fractal_contact::Result<Box<dyn PreparedContact>> {
        self.0.prepare_until(scene, seed, stop)
    }

    fn least_memory(&self, scene: &RustScene) -> Option<RequiredMemory> {
        self.0.least_memory(scene)
    }
}

/// A model of contact, which relates force, approach and stiffness.
#[pyclass(name = "Model", frozen, module = "fractal_contact._core")]
#[derive(Clone)]
pub struct PyModel {
    pub model: SharedModel,
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

/// Which effects each model combines.
///
/// Returns
/// -------
/// list of dict
///     For every two effects of a model that a scene can have together: ``model`` (its name), ``effects`` (both
///     in words), ``keys`` (both names in `Effects`), ``combined``, and ``reason`` (why not, or None).
#[pyfunction]
pub fn combinations(py: Python<'_>) -> PyResult<Vec<Bound<'_, PyDict>>> {
    let mut rows = Vec::new();
    for record in MODELS {
        for (one, other, reason) in record.model.abilities().pairs() {
            let row = PyDict::new(py);
            row.set_item("model", record.name())?;
            row.set_item("effects", (one.words(), other.words()))?;
            row.set_item("keys", (one.key(), other.key()))?;
            row.set_item("combined", reason.is_none())?;
            row.set_item("reason", reason)?;
            rows.push(row);
        }
    }
    Ok(rows)
}

/// A model by the name that scenes give it.
#[pyfunction]
#[pyo3(signature = (name, options, inner=None))]
pub fn model(
    py: Python<'_>,
    name: &str,
    options: &Bound<'_, PyDict>,
    inner: Option<&PyModel>,
) -> PyResult<PyModel> {
    let numerics = Numerics::named(name);
    let numerics = numerics.ok_or_else(|| PyValueError::new_err(format!("no model is called {name:?}")))?;
    let options = toml_text(options, name)?;
    let numerics = numerics.configured(&options).map_err(|error| of_values(py, &error))?;
    let model: Arc<dyn ContactModel> = match (numerics, inner) {
        (Numerics::Equivalent(equivalent), Some(PyModel { model, .. })) => Arc::new(Equivalent {
            model: model.clone(),
            per_decade: equivalent.per_decade,
            decades: equivalent.decades,
        }),
        (Numerics::Equivalent(_), None) => {
            return Err(PyTypeError::new_err("equivalent takes a model that presses"));
        }
        (numerics, _) => numerics.model(),
    };
    let has_options = ModelRecord::named(name).is_none_or(|record| record.has_options);
    let long = has_options || model.abilities().paths == Paths::Needed;
    Ok(PyModel { model: SharedModel(model), long })
}

impl PyModel {
    /// A contact of a scene, and the scene that it is of. Where the caller named no outputs that is the stiffness,
    /// or nothing of a model that has none.
    pub fn planned(
        model: &SharedModel,
        scene: &PyScene,
        seed: u64,
    ) -> (RustScene, fractal_contact::Result<Box<dyn PreparedContact>>) {
        let contact = model.prepare(&scene.scene, seed);
        let (true, Err(Error::Unsupported { .. })) = (scene.default_outputs, &contact) else {
            return (scene.scene.clone(), contact);
        };
        let bare = RustScene { outputs: Outputs::default(), ..scene.scene.clone() };
        let contact = model.prepare(&bare, seed);
        (bare, contact)
    }

    /// `MemoryError` where a contact of a scene needs more than there is; otherwise whether that is much.
    fn check_memory(&self, py: Python<'_>, scene: &RustScene) -> PyResult<bool> {
        let least = self.model.least_memory(scene);
        let large = memory::is_large(least.as_ref());
        least.map_or(Ok(()), |RequiredMemory { what, bytes }| memory::check(py, what, bytes))?;
        Ok(large)
    }
}

#[pymethods]
impl PyModel {
    /// Name of the model, as in scenes.
    #[getter]
    fn name(&self) -> &'static str {
        self.model.name()
    }

    /// Publications that it is built on: (citation, what is taken from it).
    #[getter]
    fn sources(&self) -> Vec<(&'static str, &'static str)> {
        self.model.sources().iter().map(|source| (source.citation, source.what)).collect()
    }

    /// Its abilities, in words.
    #[getter]
    fn supports<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (about, words) in abilities(&self.model) {
            dict.set_item(about, PyTuple::new(py, words)?)?;
        }
        Ok(dict)
    }

    fn prepare(&self, py: Python<'_>, scene: &PyScene, seed: Seed) -> PyResult<PyContact> {
        let large = self.check_memory(py, &scene.scene)?;
        // Any model may measure a map.
        let (model, scene) = (self.model.clone(), scene.clone());
        let (scene, contact) = pool::call(py, move || Self::planned(&model, &scene, seed.0))?;
        contact
            .map(|contact| PyContact::new(contact, &scene, self.long, large))
            .map_err(|error| of_planning(py, error, &scene))
    }
}
