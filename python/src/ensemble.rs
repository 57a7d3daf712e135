//! Many surfaces at a time.

use crate::errors::{of_planning, of_solve, plain, stopped};
use crate::load_order::check_rising;
use crate::loads::load_of;
use crate::memory;
use crate::model::{PyModel, SharedModel};
use crate::numbers::Seed;
use crate::pool::{self, StopToken};
use crate::scene::PyScene;
use crate::state::{self, StateOrigin};
use fractal_contact::runs::{Threads, run_jobs, threads_for_memory};
use fractal_contact::{
    ContactModel, ContactState as RustState, Error, Hardness, Load, Outputs, RequiredMemory, Result,
    Scene as RustScene, Stop,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Threads that can have a surface each at the same time, by the memory that one needs.
///
/// `MemoryError` where all states, which are kept until the end, do not fit in beside one surface.
fn surfaces_in_memory(
    py: Python<'_>,
    model: &SharedModel,
    scene: &RustScene,
    (surfaces, loads): (usize, usize),
) -> PyResult<Threads> {
    let bytes =
        |scene: &RustScene| model.least_memory(scene).map_or(0.0, |RequiredMemory { bytes, .. }| bytes);
    let (one, bare) = (bytes(scene), bytes(&RustScene { outputs: Outputs::default(), ..scene.clone() }));
    // Each state, and each list of them, as a value of Rust and as one of Python; the fields are moved.
    let list = 2.0 * (size_of::<Result<Vec<RustState>>>() + size_of::<Vec<usize>>()) as f64;
    let state = 2.0 * size_of::<Result<RustState>>() as f64 + (one - bare);
    let states = surfaces as f64 * (list + loads as f64 * state);
    memory::check(py, format!("an ensemble of {surfaces} surfaces x {loads} loads"), states + one)?;
    let total = pool::threads()?;
    let jobs = threads_for_memory(total, one.max(1.0), "surfaces", surfaces);
    Ok(Threads { total, jobs: jobs.map_err(|error| plain(py, "Error", &error.to_string()))? })
}

/// The states of many surfaces under the same loads, surfaces in parallel.
///
/// `progress` is called with the number of surfaces that are done and that of all.
#[pyfunction]
#[pyo3(signature = (model, scene, loads, seed, surfaces, progress, stop=None))]
#[allow(clippy::too_many_arguments)] // One for each keyword.
pub fn ensemble(
    py: Python<'_>,
    model: &PyModel,
    scene: &PyScene,
    loads: Vec<(String, f64)>,
    seed: Seed,
    surfaces: usize,
    progress: Option<Py<PyAny>>,
    stop: Option<Py<PyAny>>,
) -> PyResult<Vec<Vec<Py<PyAny>>>> {
    let token = StopToken::new(py, stop.as_ref())?;
    let model = &model.model;
    let (asked, done, mut told) = (scene, AtomicUsize::new(0), 0);
    let scene = &asked.scene;
    if scene.effects.hardness != Hardness::Off {
        check_order(py, &loads)?;
    }
    let threads = surfaces_in_memory(py, model, scene, (surfaces, loads.len()))?;
    let answer = |index: usize, stop: Stop<'_>| {
        let seed = fractal_contact::surface_gen::surface_seed(seed.0, index as u64);
        let (scene, contact) = PyModel::planned(model, asked, seed);
        let mut contact = contact?;
        let origin = StateOrigin::new(&scene, contact.normalisation());
        let unit = &origin.normalisation;
        let given = |(kind, value): &(String, f64)| match kind.as_str() {
            "force_bar" => Ok(Load::force(unit.force(*value)?)),
            kind => Ok(load_of(unit, kind, *value)),
        };
        let loads = loads.iter().map(given).collect::<Result<Vec<Load>>>()?;
        memory::check_loads(&*contact, &loads)?;
        let mut found = Vec::new();
        contact.sweep(&loads, stop, &mut |_, state| {
            found.push(state);
            Ok(())
        })?;
        done.fetch_add(1, Ordering::Relaxed);
        Ok((origin, found))
    };
    let mut listen = |py: Python<'_>| {
        let now = done.load(Ordering::Relaxed);
        if let (Some(progress), true) = (&progress, now != told) {
            told = now;
            progress.call1(py, (now, surfaces))?;
        }
        Ok(())
    };
    let (found, raised) = pool::run(py, token, &mut listen, |stop| {
        // A loop for each thread: one that waits for helpers does not begin another surface, which would need
        // memory of its own.
        run_jobs(threads, &(0..surfaces).collect::<Vec<usize>>(), stop, answer)
    })?;
    let Finished { surfaces: finished, failed } = Finished::of(py, found)?;
    if let (Some(error), None) = (failed, &raised) {
        return Err(of_planning(py, error, scene));
    }
    let raised = raised.or_else(|| (finished.len() < surfaces).then(|| stopped(py)));
    if let Some(raised) = raised {
        // What is finished goes with the exception.
        let by_number = PyDict::new(py);
        for (index, states) in finished {
            by_number.set_item(index, states)?;
        }
        raised.value(py).setattr("finished", by_number)?;
        return Err(raised);
    }
    if let Some(progress) = &progress {
        progress.call1(py, (surfaces, surfaces))?;
    }
    Ok(finished.into_iter().map(|(_, states)| states).collect())
}

/// With a hardness loads must not decrease; the order of their values is that of the loads on every surface.
fn check_order(py: Python<'_>, loads: &[(String, f64)]) -> PyResult<()> {
    let values: Vec<Load> = loads
        .iter()
        .map(|(kind, value)| match kind.as_str() {
            "approach" => Load::approach(*value),
            "mean_gap" => Load::mean_gap(*value),
            _ => Load::force(*value),
        })
        .collect();
    let pressures = loads.first().is_some_and(|(kind, _)| kind == "mean_pressure");
    check_rising(py, &values, pressures.then_some(1.0))
}

/// The surfaces that were solved, with their numbers, and the error of the first one that failed.
struct Finished {
    surfaces: Vec<(usize, Vec<Py<PyAny>>)>,
    failed: Option<Error>,
}

/// The states of a surface under all loads, or why it has none; `None` where it was not begun.
type OfSurface = Option<Result<(StateOrigin, Vec<Result<RustState>>)>>;

impl Finished {
    fn of(py: Python<'_>, found: Vec<OfSurface>) -> PyResult<Self> {
        // A load that was refused stands for itself among the others.
        let one = |origin: &StateOrigin, state: Result<RustState>| -> PyResult<Py<PyAny>> {
            match state {
                Ok(state) => Ok(state::of(py, state, origin)?.into_any()),
                Err(error) => Ok(of_solve(py, error, origin).into_value(py).into_any()),
            }
        };
        let mut finished = Self { surfaces: Vec::new(), failed: None };
        for (index, states) in found.into_iter().enumerate() {
            match states {
                Some(Ok((origin, states))) => {
                    let states = states.into_iter().map(|state| one(&origin, state));
                    finished.surfaces.push((index, states.collect::<PyResult<Vec<_>>>()?));
                }
                // After a failure those in flight are stopped: their reason is not the reason.
                None | Some(Err(Error::Stopped { .. })) => {}
                Some(Err(error)) => finished.failed = finished.failed.or(Some(error)),
            }
        }
        Ok(finished)
    }
}
