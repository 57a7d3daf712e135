//! Scene files.

use crate::errors::{of_scene, of_values, stopped};
use crate::memory;
use crate::pool::{self, StopToken};
use crate::quantities::is_count;
use crate::state;
use crate::toml_text::{toml_text, toml_value};
use fractal_contact::Value;
use fractal_contact::runs::Progress;
use fractal_contact::scenes::{
    Error, Options, Plan, Question, SceneFile as RustSceneFile, SceneOutcome, System, run,
};
use fractal_contact::{Cells, Table};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};

/// A scene file: the surface, the material, the effects, the loads and the requested outputs.
///
/// Two of them are equal where their texts are, and the folders from which relative paths count.
#[pyclass(name = "SceneFile", frozen, module = "fractal_contact")]
pub struct PySceneFile(RustSceneFile);

impl PySceneFile {
    /// The scene of a question, whose files are looked up from the folder of `path`.
    fn of(py: Python<'_>, question: Question, path: PathBuf) -> PyResult<Self> {
        let scene = pool::call(py, move || RustSceneFile::of(question, &path))?;
        scene.map(Self).map_err(|error| of_scene(py, &error))
    }
}

#[pymethods]
impl PySceneFile {
    /// Reads a file.
    ///
    /// Parameters
    /// ----------
    /// path : str or path-like
    ///     The file; relative paths in it count from its folder.
    ///
    /// Returns
    /// -------
    /// SceneFile
    #[staticmethod]
    fn read(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        pool::call(py, move || RustSceneFile::read(&path))?.map(Self).map_err(|error| of_scene(py, &error))
    }

    /// Reads a text.
    ///
    /// Parameters
    /// ----------
    /// text : str
    ///     What a file of a scene holds.
    /// directory : str or path-like
    ///     The folder from which relative paths count; the current one by default.
    /// name : str
    ///     What the scene is called in titles.
    ///
    /// Returns
    /// -------
    /// SceneFile
    #[staticmethod]
    #[pyo3(signature = (text, *, directory=PathBuf::new(), name="scene".to_owned()))]
    fn from_toml(py: Python<'_>, text: String, directory: PathBuf, name: String) -> PyResult<Self> {
        let path = directory.join(format!("{name}.toml"));
        pool::call(py, move || RustSceneFile::parse(&path, text))?
            .map(Self)
            .map_err(|error| of_scene(py, &error))
    }

    /// Makes a scene of its tables, with the keys and values of a text.
    ///
    /// Parameters
    /// ----------
    /// tables : dict
    ///     The tables by their names, such as ``scene``, ``effects`` and ``outputs``.
    /// directory : str or path-like
    ///     The folder from which relative paths count; the current one by default.
    /// name : str
    ///     What the scene is called in titles.
    ///
    /// Returns
    /// -------
    /// SceneFile
    #[staticmethod]
    #[pyo3(signature = (tables, *, directory=PathBuf::new(), name="scene".to_owned()))]
    fn from_dict(
        py: Python<'_>,
        tables: &Bound<'_, PyDict>,
        directory: PathBuf,
        name: String,
    ) -> PyResult<Self> {
        let text = toml_text(tables, "the scene")?;
        let question = Question::parse(&text).map_err(|mistake| of_scene(py, &mistake.into()))?;
        Self::of(py, question, directory.join(format!("{name}.toml")))
    }

    /// Gives the same scene with other values of some keys.
    ///
    /// Parameters
    /// ----------
    /// keys : dict
    ///     The values, each by its table and its name: ``scene.replaced({"scene.surface.cells": 64})``.
    ///
    /// Returns
    /// -------
    /// SceneFile
    fn replaced(&self, py: Python<'_>, keys: &Bound<'_, PyDict>) -> PyResult<Self> {
        let mut question = Question::parse(&self.0.text).map_err(|mistake| of_scene(py, &mistake.into()))?;
        for (key, value) in keys {
            let key: String = key.extract()?;
            let set = question.set(&key, &toml_value(&value, &key)?);
            set.map_err(|mistake| of_scene(py, &mistake.into()))?;
        }
        Self::of(py, question, self.0.path.clone())
    }

    /// str: the file itself.
    #[getter]
    fn text(&self) -> &str {
        &self.0.text
    }

    /// (float, float): sides (Lx, Ly) of its rectangle.
    #[getter]
    fn size(&self) -> (f64, f64) {
        let size = self.0.surface.size();
        (size.x, size.y)
    }

    /// list of str: its models.
    #[getter]
    fn models(&self) -> Vec<&'static str> {
        self.0.models.iter().map(fractal_contact::scenes::Numerics::name).collect()
    }

    /// Says what will be computed, what will not and why, and what it will cost.
    ///
    /// Returns
    /// -------
    /// str
    fn plan(&self, py: Python<'_>) -> PyResult<String> {
        let file = self.0.clone();
        let planned = pool::call(py, move || Plan::new(&file).map(|plan| plan.to_string()))?;
        planned.map_err(|error| of_scene(py, &error))
    }

    fn __eq__(&self, other: &Self) -> bool {
        (&self.0.text, &self.0.path) == (&other.0.text, &other.0.path)
    }

    fn __hash__(&self) -> u64 {
        let mut state = DefaultHasher::new();
        (&self.0.text, &self.0.path).hash(&mut state);
        state.finish()
    }

    /// The text and where it stands: files that it names are read again.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        state::reduced(py, "scene_file", (&self.0.text, self.0.path.as_os_str()))
    }

    fn __repr__(&self) -> String {
        format!("<SceneFile: {} by {}>", self.0.surface.describe(self.0.system), self.models().join(", "))
    }
}

/// ``OutOfMemory`` where there is no room for the heights of a map as an array, in its file and in the solver.
///
/// The solves are looked at when the scene is run.
#[pyfunction]
pub fn check_pressed_map(py: Python<'_>, columns: usize, rows: usize) -> PyResult<()> {
    /// Bytes for each point.
    const HEIGHTS: f64 = 64.0;
    memory::check_grid(
        py,
        "the contact of a map",
        Cells { columns, rows },
        HEIGHTS * columns as f64 * rows as f64,
    )
}

/// The scene of a map that is pressed, of its keys in their order.
///
/// Each has its value, and whether the numbers in it have units. The whole scene is in SI units, or in any.
#[pyfunction]
pub fn press_scene(
    py: Python<'_>,
    keys: Vec<(String, Bound<'_, PyAny>, bool)>,
    si: bool,
    path: PathBuf,
) -> PyResult<PySceneFile> {
    let system = |units: bool| if units { System::Si } else { System::None };
    let mut question = Question::default();
    for (key, value, units) in keys {
        question.units = system(units);
        question.set(&key, &toml_value(&value, &key)?).map_err(|mistake| of_values(py, &mistake))?;
    }
    question.units = system(si);
    let scene = pool::call(py, move || RustSceneFile::of(question, &path))?;
    let told = |error| match error {
        // It has no place in a file of the user.
        Error::Scene(mistake) => Error::from(mistake.told_of("the scene of this call")),
        other => other,
    };
    scene.map(PySceneFile).map_err(|error| of_scene(py, &told(error)))
}

/// Relative cost of what is done and of all.
#[derive(Default)]
struct CostCounter {
    done: AtomicU64,
    total: AtomicU64,
}

impl Progress for CostCounter {
    fn begin(&self, _: &str, total: u64) {
        self.done.store(0, Ordering::Relaxed);
        self.total.store(total, Ordering::Relaxed);
    }

    fn advance(&self, cost: u64, _: bool) {
        self.done.fetch_add(cost, Ordering::Relaxed);
    }

    fn end(&self) {}
}

/// Columns of numbers of surfaces and states, from 0.
const NUMBERS_OF: [&str; 2] = ["surface", "state"];

/// The columns of a table: counts that all rows have as arrays of whole numbers, other numbers as arrays with NaN
/// where there is none, texts as lists.
fn columns<'py>(py: Python<'py>, table: &Table) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (i, column) in table.columns().iter().enumerate() {
        let values = || table.rows().iter().map(|row| &row[i]);
        let count = |value: &Value| match value {
            Value::Count(count) => i64::try_from(*count).ok(),
            _ => None,
        };
        let whole = values().map(count).collect::<Option<Vec<_>>>();
        if let Some(whole) = whole.filter(|_| NUMBERS_OF.contains(&column.name) || is_count(column.name)) {
            dict.set_item(column.name, PyArray1::from_vec(py, whole))?;
        } else if values().all(|value| matches!(value, Value::Number(_) | Value::Count(_) | Value::Empty)) {
            let number = |value: &Value| match value {
                Value::Number(number) => *number,
                Value::Count(count) => *count as f64,
                _ => f64::NAN,
            };
            dict.set_item(column.name, PyArray1::from_vec(py, values().map(number).collect()))?;
        } else {
            let text = |value: &Value| match value {
                Value::Text(text) => text.clone(),
                Value::Flag(flag) => flag.to_string(),
                Value::Number(number) => fractal_contact::runs::number(*number),
                Value::Count(count) => count.to_string(),
                Value::Empty => String::new(),
            };
            dict.set_item(column.name, values().map(text).collect::<Vec<_>>())?;
        }
    }
    Ok(dict)
}

/// Runs a scene as the program does; the files, the summary and the counts by their names.
#[pyfunction]
#[pyo3(signature = (scene, out, threads, fresh, drawn_states, progress, stop=None))]
#[allow(clippy::too_many_arguments)] // One for each keyword.
pub fn run_scene<'py>(
    py: Python<'py>,
    scene: &PySceneFile,
    out: PathBuf,
    threads: Option<usize>,
    fresh: bool,
    drawn_states: Option<Vec<usize>>,
    progress: Option<Py<PyAny>>,
    stop: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyDict>> {
    let token = StopToken::new(py, stop.as_ref())?;
    let threads = threads.map_or_else(pool::threads, Ok)?.max(1);
    let (counter, mut file) = (CostCounter::default(), scene.0.clone());
    if let Some(states) = drawn_states {
        file = file.drawing(states).map_err(|error| of_values(py, &error))?;
    }
    let mut told = 0;
    let mut listen = |py: Python<'_>| {
        let (done, total) = (counter.done.load(Ordering::Relaxed), counter.total.load(Ordering::Relaxed));
        if let (Some(progress), true) = (&progress, done != told) {
            told = done;
            progress.call1(py, (done, total))?;
        }
        Ok(())
    };
    let (outcome, raised) = pool::run(py, token, &mut listen, |stop| {
        let options = Options { out, threads, fresh };
        let chosen = file.with_grid_for_accuracy(&options, &counter, stop)?;
        let plan = Plan::calibrated(&chosen)?;
        run(&chosen, &plan, &options, &counter, stop)
    })?;
    raised.map_or(Ok(()), Err)?;
    // What was finished is kept, and the next run goes on from it.
    if token.is_set(py)? && !outcome.as_ref().is_ok_and(|outcome| !outcome.stopped) {
        return Err(stopped(py));
    }
    if let (Some(progress), true) = (&progress, outcome.is_ok()) {
        let total = counter.total.load(Ordering::Relaxed);
        progress.call1(py, (total, total))?;
    }
    let outcome: SceneOutcome = outcome.map_err(|error| of_scene(py, &error))?;
    let dict = PyDict::new(py);
    let results = outcome.results.as_ref().map_or_else(|| Ok(PyDict::new(py)), |table| columns(py, table))?;
    dict.set_item("results", results)?;
    dict.set_item("files", &outcome.files)?;
    dict.set_item("summary", &outcome.summary)?;
    dict.set_item("notes", &outcome.notes)?;
    dict.set_item("requested", outcome.requested)?;
    dict.set_item("states", outcome.states)?;
    dict.set_item("failed", outcome.failed)?;
    dict.set_item("pulled_off", outcome.pulled_off)?;
    dict.set_item("kept", outcome.kept)?;
    dict.set_item("seconds", outcome.seconds)?;
    Ok(dict)
}
