//! Models by name, and contacts that they have planned.

use crate::contact::Contact;
use crate::errors::of_model;
use crate::history::History;
use crate::memory;
use crate::pool;
use crate::scene::{Scene, optional};
use fractal_contact::analytic::{
    AdhesiveWave, CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, MaugisDugdale, Persson,
    PowerLaw, PowerLawBody, Westergaard, greenwood_williamson::SummitHeights,
};
use fractal_contact::bem3d::{Bem3dPath, Method};
use fractal_contact::mdr1d::{PartialSlip, Viscoelastic};
use fractal_contact::{
    Bem3d, ContactModel, Equivalent, Error, HistoryModel, Mdr1d, PreparedContact, RequiredMemory,
    Scene as RustScene, Source,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
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

    fn prepare(&self, scene: &RustScene, seed: u64) -> fractal_contact::Result<Box<dyn PreparedContact>> {
        self.0.prepare(scene, seed)
    }

    fn least_memory(&self, scene: &RustScene) -> Option<RequiredMemory> {
        self.0.least_memory(scene)
    }
}

#[derive(Clone)]
enum Kind {
    /// It answers loads one by one.
    Loads(Shared),
    /// It follows a path.
    Path(Arc<dyn HistoryModel>),
}

/// A way to answer what force, approach and stiffness belong together.
#[pyclass(frozen, module = "fractal_contact._core")]
#[derive(Clone)]
pub struct Model {
    kind: Kind,
    /// Whether its solves are long enough to leave the interpreter's thread.
    long: bool,
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
    let shared = |model: Arc<dyn ContactModel>| Kind::Loads(Shared(model));
    let kind = match name {
        "bem3d" => shared(Arc::new(bem3d(py, options)?)),
        "bem3d_path" => Kind::Path(Arc::new(Bem3dPath(bem3d(py, options)?))),
        "mdr1d" => {
            let elements = optional(options, "elements")?.unwrap_or(Mdr1d::default().elements);
            shared(Arc::new(Mdr1d { elements }))
        }
        "hertz" => shared(Arc::new(Hertz)),
        "flat_punch" => shared(Arc::new(FlatPunch)),
        "power_law_body" => shared(Arc::new(PowerLawBody)),
        "power_law" => shared(Arc::new(PowerLaw)),
        "jkr" => shared(Arc::new(Jkr)),
        "westergaard" => shared(Arc::new(Westergaard)),
        "adhesive_wave" => shared(Arc::new(AdhesiveWave)),
        "maugis_dugdale" => shared(Arc::new(MaugisDugdale)),
        "persson" => {
            let gamma = optional(options, "gamma")?.unwrap_or(Persson::default().gamma);
            shared(Arc::new(Persson { gamma }))
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
            shared(Arc::new(GreenwoodWilliamson { heights }))
        }
        "equivalent" => {
            let Some(Model { kind: Kind::Loads(model), .. }) = inner else {
                return Err(PyTypeError::new_err("equivalent takes a model that answers loads one by one"));
            };
            let standard = Equivalent::new(model.clone());
            Kind::Path(Arc::new(Equivalent {
                per_decade: optional(options, "per_decade")?.unwrap_or(standard.per_decade),
                decades: optional(options, "decades")?.unwrap_or(standard.decades),
                model: standard.model,
            }))
        }
        "cattaneo_mindlin" => Kind::Path(Arc::new(CattaneoMindlin)),
        "partial_slip" => Kind::Path(Arc::new(PartialSlip)),
        "viscoelastic" => Kind::Path(Arc::new(Viscoelastic)),
        other => return Err(PyValueError::new_err(format!("no model is called {other:?}"))),
    };
    Ok(Model { kind, long: matches!(name, "bem3d" | "bem3d_path" | "mdr1d" | "equivalent" | "viscoelastic") })
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
    /// What a contact of a scene needs at least; `None` where that does not grow with a grid.
    pub fn least_memory(&self, scene: &RustScene) -> Option<RequiredMemory> {
        match &self.kind {
            Kind::Loads(model) => model.least_memory(scene),
            Kind::Path(model) => model.least_memory(scene),
        }
    }

    /// `MemoryError` where a contact of a scene needs more than there is; otherwise whether that is much.
    fn check_memory(&self, py: Python<'_>, scene: &RustScene) -> PyResult<bool> {
        let least = self.least_memory(scene);
        let large = memory::is_large(least.as_ref());
        least.map_or(Ok(()), |RequiredMemory { what, bytes }| memory::check(py, what, bytes))?;
        Ok(large)
    }

    /// The model, where it answers loads one by one.
    pub fn of_loads(&self) -> Option<&Shared> {
        match &self.kind {
            Kind::Loads(model) => Some(model),
            Kind::Path(_) => None,
        }
    }
}

#[pymethods]
impl Model {
    /// Name of the model, as in scenes.
    #[getter]
    fn name(&self) -> &'static str {
        match &self.kind {
            Kind::Loads(model) => model.name(),
            Kind::Path(model) => model.name(),
        }
    }

    /// What it is built on: (citation, what is taken from it).
    #[getter]
    fn sources(&self) -> Vec<(&'static str, &'static str)> {
        let sources = match &self.kind {
            Kind::Loads(model) => model.sources(),
            Kind::Path(model) => model.sources(),
        };
        sources.iter().map(|source| (source.citation, source.what)).collect()
    }

    fn prepare(&self, py: Python<'_>, scene: &Scene, seed: u64) -> PyResult<Contact> {
        let Kind::Loads(model) = &self.kind else {
            return Err(PyTypeError::new_err("this model follows a path: use history()"));
        };
        let large = self.check_memory(py, &scene.0)?;
        let scene = scene.0.clone();
        // Any model may measure a map.
        let contact = pool::call(py, || model.prepare(&scene, seed))?;
        contact
            .map(|contact| Contact::new(contact, &scene, self.long, large))
            .map_err(|error| of_model(py, error))
    }

    fn history(&self, py: Python<'_>, scene: &Scene, seed: u64) -> PyResult<History> {
        let Kind::Path(model) = &self.kind else {
            return Err(PyTypeError::new_err("this model answers loads one by one: use prepare()"));
        };
        let large = self.check_memory(py, &scene.0)?;
        let scene = scene.0.clone();
        let history = pool::call(py, || model.prepare(&scene, seed))?;
        history.map(|history| History::new(history, self.long, large)).map_err(|error| of_model(py, error))
    }
}
