//! Many surfaces at a time.

use crate::errors::of_model;
use crate::model::Model;
use crate::pool;
use crate::scene::Scene;
use crate::state;
use fractal_contact::{ContactModel, ContactState as RustState, Error, Load};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    let Some(model) = model.of_loads() else {
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
