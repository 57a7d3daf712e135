//! Scene files.

use crate::errors::of_scene;
use crate::pool;
use crate::scene::Scene;
use fractal_contact::runs::Progress;
use fractal_contact::scenes::{Options, Plan, SceneFile as RustSceneFile, SceneOutcome, run};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// A scene file: what is pressed, what is asked and which effects count.
#[pyclass(frozen, module = "fractal_contact")]
pub struct SceneFile(RustSceneFile);

#[pymethods]
impl SceneFile {
    /// Reads a file.
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        py.detach(|| RustSceneFile::read(&path)).map(Self).map_err(|error| of_scene(py, &error))
    }

    /// Reads a text; relative paths in it count from `directory`.
    #[staticmethod]
    #[pyo3(signature = (text, *, directory=PathBuf::new(), name="scene".to_owned()))]
    fn from_toml(py: Python<'_>, text: String, directory: PathBuf, name: String) -> PyResult<Self> {
        let path = directory.join(format!("{name}.toml"));
        py.detach(|| RustSceneFile::parse(&path, text)).map(Self).map_err(|error| of_scene(py, &error))
    }

    /// str: the file itself.
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }

    /// list of str: its models.
    #[getter]
    fn models(&self) -> Vec<&'static str> {
        self.0.models.iter().map(fractal_contact::scenes::Numerics::name).collect()
    }

    /// What will be computed, what not and why, what it will cost.
    fn plan(&self, py: Python<'_>) -> PyResult<String> {
        let planned = py.detach(|| Plan::new(&self.0).map(|plan| plan.to_string()));
        planned.map_err(|error| of_scene(py, &error))
    }

    fn _scene(&self, py: Python<'_>, model: usize, surface: usize) -> PyResult<Scene> {
        let Some(numerics) = self.0.models.get(model) else {
            return Err(pyo3::exceptions::PyIndexError::new_err(format!(
                "the scene has no model number {model}"
            )));
        };
        let scene = py.detach(|| self.0.scene(numerics, self.0.seed(surface)));
        scene.map(Scene).map_err(|error| crate::errors::of_model(py, error))
    }

    fn __repr__(&self) -> String {
        format!("<SceneFile: {} by {}>", self.0.surface.describe(), self.models().join(", "))
    }
}

/// Relative cost of what is done and of all.
#[derive(Default)]
struct Counter {
    done: AtomicU64,
    total: AtomicU64,
}

impl Progress for Counter {
    fn begin(&self, _: &str, total: u64) {
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    fn advance(&self, cost: u64, _: bool) {
        self.done.fetch_add(cost, Ordering::Relaxed);
    }

    fn end(&self) {}
}

/// Runs a scene as the program does; the files, the summary and the counts by their names.
#[pyfunction]
#[pyo3(signature = (scene, out, threads, fresh, progress))]
pub fn run_scene<'py>(
    py: Python<'py>,
    scene: &SceneFile,
    out: PathBuf,
    threads: Option<usize>,
    fresh: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let threads = threads.map_or_else(pool::threads, Ok)?.max(1);
    let (counter, file) = (Counter::default(), scene.0.clone());
    let mut told = 0;
    let mut listen = |py: Python<'_>| {
        let (done, total) = (counter.done.load(Ordering::Relaxed), counter.total.load(Ordering::Relaxed));
        if let (Some(progress), true) = (&progress, done != told) {
            told = done;
            progress.call1(py, (done, total))?;
        }
        Ok(())
    };
    let (outcome, raised) = pool::run(py, &mut listen, |stop| {
        let chosen = file.with_grid_for_accuracy(stop)?;
        let plan = Plan::calibrated(&chosen)?;
        run(&chosen, &plan, &Options { out, threads, fresh }, &counter, stop)
    })?;
    raised.map_or(Ok(()), Err)?;
    if let (Some(progress), true) = (&progress, outcome.is_ok()) {
        let total = counter.total.load(Ordering::Relaxed);
        progress.call1(py, (total, total))?;
    }
    let outcome: SceneOutcome = outcome.map_err(|error| of_scene(py, &error))?;
    let dict = PyDict::new(py);
    dict.set_item("files", &outcome.files)?;
    dict.set_item("summary", &outcome.summary)?;
    dict.set_item("notes", &outcome.notes)?;
    dict.set_item("requested", outcome.requested)?;
    dict.set_item("states", outcome.states)?;
    dict.set_item("failed", outcome.failed)?;
    dict.set_item("kept", outcome.kept)?;
    dict.set_item("seconds", outcome.seconds)?;
    Ok(dict)
}
