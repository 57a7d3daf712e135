//! Models by name, and contacts that they have planned.

use crate::errors::of_model;
use crate::pool;
use crate::scene::{Scene, optional};
use crate::state::{self, ContactState, HistoryState};
use fractal_contact::analytic::{
    CattaneoMindlin, FlatPunch, GreenwoodWilliamson, Hertz, Jkr, Persson, PowerLaw, PowerLawBody,
    Westergaard, greenwood_williamson::SummitHeights,
};
use fractal_contact::bem3d::Method;
use fractal_contact::mdr1d::{PartialSlip, Viscoelastic};
use fractal_contact::{
    Bem3d, ContactModel, ContactState as RustState, Equivalent, Error, History as RustHistory, HistoryModel,
    HistoryState as RustHistoryState, Load, Mdr1d, Normalisation as RustNormalisation, PreparedContact,
    Scene as RustScene, Source, Step, Tangential,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Arc, Mutex, PoisonError};

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
    Ok(Model { kind, long: matches!(name, "bem3d" | "mdr1d" | "equivalent" | "viscoelastic") })
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

/// Runs on the pool where it may be long; Ctrl-C and errors become exceptions. `keep` is given the state that an interrupted solve reached.
fn solved<R: Send>(
    py: Python<'_>,
    long: bool,
    keep: impl FnOnce(RustState),
    work: impl FnOnce(&(dyn Fn() -> bool + Sync)) -> fractal_contact::Result<R> + Send,
) -> PyResult<R> {
    let (result, raised) = if long {
        pool::run(py, &mut |_| Ok(()), work)?
    } else {
        (py.detach(|| work(&fractal_contact::never)), None)
    };
    match (result, raised) {
        (Err(Error::Stopped { best }), Some(raised)) => {
            if let Some(best) = best {
                keep(*best);
            }
            Err(raised)
        }
        // It was done before it heard of the signal: the signal comes first, the solve can be asked for again.
        (Ok(_), Some(raised)) => Err(raised),
        (result, _) => result.map_err(|error| of_model(py, error)),
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
        let (scene, long) = (scene.0.clone(), self.long);
        let contact = solved(py, long, |_| (), |_| model.prepare(&scene, seed))?;
        let normalisation = contact.normalisation();
        let inner = Arc::new(Mutex::new(contact));
        Ok(Contact { inner, normalisation, long, best: Mutex::new(None) })
    }

    fn history(&self, py: Python<'_>, scene: &Scene, seed: u64) -> PyResult<History> {
        let Kind::Path(model) = &self.kind else {
            return Err(PyTypeError::new_err("this model answers loads one by one: use prepare()"));
        };
        let (scene, long) = (scene.0.clone(), self.long);
        let history = solved(py, long, |_| (), |_| model.prepare(&scene, seed))?;
        let normalisation = history.normalisation();
        Ok(History { inner: Mutex::new(history), normalisation, long })
    }
}

/// What turns forces and stiffnesses into the dimensionless ones of the paper.
#[pyclass(frozen, module = "fractal_contact")]
#[derive(Clone)]
pub struct Normalisation(RustNormalisation);

#[pymethods]
impl Normalisation {
    /// float: effective modulus E*.
    #[getter]
    fn modulus(&self) -> f64 {
        self.0.modulus
    }

    /// float: L = sqrt(Lx Ly).
    #[getter]
    fn length(&self) -> f64 {
        self.0.length
    }

    /// float or None: measured rms height of this very surface.
    #[getter]
    fn rms_height(&self) -> Option<f64> {
        self.0.height
    }

    /// F for F_bar = F/(E* h L).
    fn force(&self, py: Python<'_>, force_bar: f64) -> PyResult<f64> {
        self.0.force(force_bar).map_err(|error| of_model(py, error))
    }

    /// F_bar = F/(E* h L) for F.
    fn force_bar(&self, py: Python<'_>, force: f64) -> PyResult<f64> {
        self.0.force_bar(force).map_err(|error| of_model(py, error))
    }

    /// k_bar = k/(1.1419 E* L) for k.
    fn stiffness_bar(&self, stiffness: f64) -> f64 {
        self.0.stiffness_bar(stiffness)
    }

    fn __repr__(&self) -> String {
        let RustNormalisation { modulus, length, height, .. } = self.0;
        format!(
            "<Normalisation: modulus={modulus:e}, length={length:e}, rms_height={}>",
            height.map_or("None".into(), |h| format!("{h:e}"))
        )
    }
}

/// A planned contact: solve often. It keeps tables, plans and the last state, from which the next solve starts.
#[pyclass(frozen, module = "fractal_contact")]
pub struct Contact {
    inner: Arc<Mutex<Box<dyn PreparedContact>>>,
    normalisation: RustNormalisation,
    long: bool,
    best: Mutex<Option<Py<ContactState>>>,
}

/// The one load that is given.
pub fn load(
    normalisation: &RustNormalisation,
    force: Option<f64>,
    approach: Option<f64>,
    mean_pressure: Option<f64>,
    mean_gap: Option<f64>,
) -> PyResult<Load> {
    match (force, approach, mean_pressure, mean_gap) {
        (Some(force), None, None, None) => Ok(Load::Force(force)),
        (None, Some(approach), None, None) => Ok(Load::Approach(approach)),
        (None, None, Some(pressure), None) => Ok(Load::Force(pressure * normalisation.length.powi(2))),
        (None, None, None, Some(gap)) => Ok(Load::MeanGap(gap)),
        _ => Err(PyTypeError::new_err("give exactly one of force, approach, mean_pressure and mean_gap")),
    }
}

#[pymethods]
impl Contact {
    /// Solves for one load.
    ///
    /// Parameters
    /// ----------
    /// force, approach, mean_pressure, mean_gap : float
    ///     Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries.
    ///
    /// Returns
    /// -------
    /// ContactState
    ///
    /// Raises
    /// ------
    /// DomainError, OutOfRange, Unsupported
    ///     For a load that makes no sense or that the model does not hold for.
    /// NotConverged
    ///     With the state that was reached as ``best``.
    #[pyo3(signature = (*, force=None, approach=None, mean_pressure=None, mean_gap=None))]
    fn solve(
        &self,
        py: Python<'_>,
        force: Option<f64>,
        approach: Option<f64>,
        mean_pressure: Option<f64>,
        mean_gap: Option<f64>,
    ) -> PyResult<Py<ContactState>> {
        let load = load(&self.normalisation, force, approach, mean_pressure, mean_gap)?;
        let mut best = None;
        let inner = &self.inner;
        let result = solved(
            py,
            self.long,
            |state| best = Some(state),
            |stop| inner.lock().unwrap_or_else(PoisonError::into_inner).solve_until(load, &|| stop()),
        );
        if let Some(best) = best {
            *self.best.lock().unwrap_or_else(PoisonError::into_inner) = Some(state::of(py, best)?);
        }
        state::of(py, result?)
    }

    /// Solves for loads in their order: an iterator that yields each state as soon as it is there.
    ///
    /// Parameters
    /// ----------
    /// force, approach, mean_pressure, mean_gap : iterable of float
    ///     Exactly one of them. Increasing loads are the fastest order.
    ///
    /// Yields
    /// ------
    /// ContactState
    #[pyo3(signature = (**loads))]
    fn sweep<'py>(slf: &Bound<'py, Self>, loads: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("fractal_contact._models")?.call_method("sweep", (slf,), loads)
    }

    /// Normalisation: of this very surface.
    #[getter]
    fn normalisation(&self) -> Normalisation {
        Normalisation(self.normalisation)
    }

    /// ContactState or None: what a solve had reached that Ctrl-C interrupted.
    #[getter]
    fn best(&self, py: Python<'_>) -> Option<Py<ContactState>> {
        self.best.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|best| best.clone_ref(py))
    }

    fn __repr__(&self) -> String {
        let RustNormalisation { modulus, length, height, .. } = self.normalisation;
        let height = height.map_or("none".into(), |h| format!("{h:.4e}"));
        format!("<Contact: modulus={modulus:e}, length={length:e}, rms height {height}>")
    }
}

/// A planned contact that remembers its path.
#[pyclass(frozen, module = "fractal_contact")]
pub struct History {
    inner: Mutex<Box<dyn RustHistory>>,
    normalisation: RustNormalisation,
    long: bool,
}

#[pymethods]
impl History {
    /// Goes to the end of the next step. A step that fails leaves the history as it was.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     At the end of the step; it never decreases. Friction alone does not look at it.
    /// force, approach, mean_pressure : float
    ///     Exactly one of them.
    /// tangential_force, tangential_displacement : float, optional
    ///     At most one of them; no tangential force otherwise.
    ///
    /// Returns
    /// -------
    /// HistoryState
    #[pyo3(signature = (time=0.0, *, force=None, approach=None, mean_pressure=None, tangential_force=None,
                        tangential_displacement=None))]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn advance(
        &self,
        py: Python<'_>,
        time: f64,
        force: Option<f64>,
        approach: Option<f64>,
        mean_pressure: Option<f64>,
        tangential_force: Option<f64>,
        tangential_displacement: Option<f64>,
    ) -> PyResult<Py<HistoryState>> {
        let normal = load(&self.normalisation, force, approach, mean_pressure, None)?;
        let tangential = match (tangential_force, tangential_displacement) {
            (None, None) => Tangential::default(),
            (Some(force), None) => Tangential::Force(force),
            (None, Some(displacement)) => Tangential::Displacement(displacement),
            _ => {
                return Err(PyTypeError::new_err(
                    "give at most one of tangential_force and tangential_displacement",
                ));
            }
        };
        let step = Step { time, normal, tangential };
        let inner = &self.inner;
        let state: RustHistoryState = solved(
            py,
            self.long,
            |_| (),
            |stop| inner.lock().unwrap_or_else(PoisonError::into_inner).advance_until(step, &|| stop()),
        )?;
        state::of_history(py, state)
    }

    /// Forgets the path: back to no contact at time 0.
    fn restart(&self, py: Python<'_>) {
        let inner = &self.inner;
        py.detach(|| inner.lock().unwrap_or_else(PoisonError::into_inner).restart());
    }

    /// Normalisation: of this very surface.
    #[getter]
    fn normalisation(&self) -> Normalisation {
        Normalisation(self.normalisation)
    }

    fn __repr__(&self) -> String {
        format!("<History: modulus={:e}, length={:e}>", self.normalisation.modulus, self.normalisation.length)
    }
}

/// The states of many surfaces under the same loads, surfaces in parallel.
///
/// `progress` is called with the number of surfaces that are done and that of all.
#[pyfunction]
#[pyo3(signature = (model, scene, loads, seed, surfaces, progress))]
pub fn ensemble(
    py: Python<'_>,
    model: &Model,
    scene: &Scene,
    loads: Vec<(String, f64)>,
    seed: u64,
    surfaces: usize,
    progress: Option<Py<PyAny>>,
) -> PyResult<Vec<Vec<Py<PyAny>>>> {
    use rayon::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    let Kind::Loads(model) = &model.kind else {
        return Err(PyTypeError::new_err("this model follows a path"));
    };
    let (scene, done, mut told) = (scene.0.clone(), AtomicUsize::new(0), 0);
    let answer = |index: usize, stop: &(dyn Fn() -> bool + Sync)| {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let seed = fractal_contact::surface_gen::surface_seed(seed, index as u64);
        let mut contact = model.prepare(&scene, seed)?;
        let normalisation = contact.normalisation();
        let given = |(kind, value): &(String, f64)| match kind.as_str() {
            "force_bar" => Ok(Load::Force(normalisation.force(*value)?)),
            "mean_pressure" => Ok(Load::Force(value * normalisation.length.powi(2))),
            "approach" => Ok(Load::Approach(*value)),
            "mean_gap" => Ok(Load::MeanGap(*value)),
            _ => Ok(Load::Force(*value)),
        };
        let loads = loads.iter().map(given).collect::<fractal_contact::Result<Vec<Load>>>()?;
        let mut found = Vec::new();
        contact.sweep(&loads, &|| stop(), &mut |_, state| {
            found.push(state);
            Ok(())
        })?;
        done.fetch_add(1, Ordering::Relaxed);
        Ok(found)
    };
    let mut listen = |py: Python<'_>| {
        let now = done.load(Ordering::Relaxed);
        if let (Some(progress), true) = (&progress, now != told) {
            told = now;
            progress.call1(py, (now, surfaces))?;
        }
        Ok(())
    };
    let (found, raised) = pool::run(py, &mut listen, |stop| {
        (0..surfaces)
            .into_par_iter()
            .map(|index| answer(index, stop))
            .collect::<Vec<fractal_contact::Result<_>>>()
    })?;
    // A load that was refused stands for itself among the others.
    let one = |state: fractal_contact::Result<RustState>| -> PyResult<Py<PyAny>> {
        match state {
            Ok(state) => Ok(state::of(py, state)?.into_any()),
            Err(error) => Ok(of_model(py, error).into_value(py).into_any()),
        }
    };
    let mut surfaces_done = Vec::new();
    for (index, states) in found.into_iter().enumerate() {
        match (states, &raised) {
            (Ok(states), _) => {
                surfaces_done.push((index, states.into_iter().map(one).collect::<PyResult<Vec<_>>>()?));
            }
            (Err(error), None) => return Err(of_model(py, error)),
            (Err(_), Some(_)) => {}
        }
    }
    if let Some(raised) = raised {
        // What is finished goes with the exception.
        let finished = PyDict::new(py);
        for (index, states) in surfaces_done {
            finished.set_item(index, states)?;
        }
        raised.value(py).setattr("finished", finished)?;
        return Err(raised);
    }
    if let Some(progress) = &progress {
        progress.call1(py, (surfaces, surfaces))?;
    }
    Ok(surfaces_done.into_iter().map(|(_, states)| states).collect())
}
