//! Planned contacts.

use crate::errors::of_model;
use crate::exclusive::Exclusive;
use crate::load_order::{LastLoad, check_rising};
use crate::memory;
use crate::pool;
use crate::state::{self, ContactState};
use fractal_contact::{
    ContactState as RustState, Error, Hardness, Load, Normalisation as RustNormalisation, PreparedContact,
    Scene,
};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, PoisonError};

/// What a solve had reached when a signal came: its result, or the best state so far.
pub type Reached<R> = Result<R, Option<Box<RustState>>>;

/// Runs on the pool where it may be long; Ctrl-C and errors become exceptions. `keep` is given what an interrupted solve had reached.
pub fn solved<R: Send>(
    py: Python<'_>,
    long: bool,
    keep: impl FnOnce(Reached<R>),
    work: impl FnOnce(&(dyn Fn() -> bool + Sync)) -> fractal_contact::Result<R> + Send,
) -> PyResult<R> {
    let (result, raised) = if long {
        pool::run(py, &mut |_| Ok(()), work)?
    } else {
        (py.detach(|| work(&fractal_contact::never)), None)
    };
    match (result, raised) {
        (Err(Error::Stopped { best }), Some(raised)) => {
            keep(Err(best));
            Err(raised)
        }
        // It was done before it heard of the signal.
        (Ok(found), Some(raised)) => {
            keep(Ok(found));
            Err(raised)
        }
        (result, _) => result.map_err(|error| of_model(py, error)),
    }
}

/// What turns forces and stiffnesses into the dimensionless ones of the paper.
#[pyclass(frozen, module = "fractal_contact")]
#[derive(Clone)]
pub struct Normalisation(pub RustNormalisation);

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
///
/// Threads that solve on one contact do so one after the other, in the order of asking.
///
/// With a hardness each load is solved from the virgin surface: a load smaller than the one before is refused, because the indentation of
/// that one would be forgotten. ``Bem3dPath(...).history(scene)`` follows the indentation along any path.
#[pyclass(frozen, module = "fractal_contact")]
pub struct Contact {
    inner: Exclusive<Inner>,
    normalisation: RustNormalisation,
    long: bool,
    /// Whether its memory is looked at before each solve.
    large: bool,
    /// Whether the surface yields, so that the order of loads matters.
    yields: bool,
    best: Mutex<Option<Py<ContactState>>>,
}

struct Inner {
    contact: Box<dyn PreparedContact>,
    /// Of a contact that yields.
    last: Option<LastLoad>,
}

impl Contact {
    /// A contact of a scene whose solves are long, or not.
    pub fn new(contact: Box<dyn PreparedContact>, scene: &Scene, long: bool, large: bool) -> Self {
        let normalisation = contact.normalisation();
        let inner = Exclusive::new(Inner { contact, last: None });
        let yields = scene.effects.hardness != Hardness::Off;
        Self { inner, normalisation, long, large, yields, best: Mutex::new(None) }
    }

    fn area(&self) -> f64 {
        self.normalisation.length.powi(2)
    }

    fn set_best(&self, best: Py<ContactState>) {
        let before = self.best.lock().unwrap_or_else(PoisonError::into_inner).replace(best);
        // Outside of the lock: the end of an array may call Python, which may ask for `best`.
        drop(before);
    }
}

/// The load of a kind.
pub fn load_of(normalisation: &RustNormalisation, kind: &str, value: f64) -> Load {
    match kind {
        "mean_pressure" => Load::Force(value * normalisation.length.powi(2)),
        "approach" => Load::Approach(value),
        "mean_gap" => Load::MeanGap(value),
        _ => Load::Force(value),
    }
}

/// The one load that is given.
pub fn load(
    normalisation: &RustNormalisation,
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
    ///     With a hardness also for a load smaller than the one before.
    /// OutOfMemory
    ///     For contact that fills so much of a large grid that it does not fit in memory.
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
        let mut inner = self.inner.take(py)?;
        let Inner { contact, last } = &mut *inner;
        if let Some(last) = last {
            last.check(py, load, mean_pressure.map(|_| self.area()))?;
        }
        if self.large {
            memory::check_solve(py, contact, |contact| contact.required_memory(load))?;
        }
        let result = solved(
            py,
            self.long,
            |reached| best = reached.map_or_else(|best| best.map(|best| *best), Some),
            |stop| contact.solve_until(load, &|| stop()),
        );
        if let (Ok(state), true) = (&result, self.yields) {
            *last = Some(LastLoad::new(load, state));
        }
        drop(inner);
        if let Some(best) = best {
            self.set_best(state::of(py, best)?);
        }
        state::of(py, result?)
    }

    /// Solves for loads in their order: an iterator that yields each state as soon as it is there.
    ///
    /// Parameters
    /// ----------
    /// force, approach, mean_pressure, mean_gap : iterable of float
    ///     Exactly one of them. Increasing loads are the fastest order, and the only one with a hardness.
    ///
    /// Yields
    /// ------
    /// ContactState
    #[pyo3(signature = (*, force=None, approach=None, mean_pressure=None, mean_gap=None))]
    fn sweep<'py>(
        slf: &Bound<'py, Self>,
        force: Option<Bound<'py, PyAny>>,
        approach: Option<Bound<'py, PyAny>>,
        mean_pressure: Option<Bound<'py, PyAny>>,
        mean_gap: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let loads = PyDict::new(slf.py());
        loads.set_item("force", force)?;
        loads.set_item("approach", approach)?;
        loads.set_item("mean_pressure", mean_pressure)?;
        loads.set_item("mean_gap", mean_gap)?;
        slf.py().import("fractal_contact._models")?.call_method("sweep", (slf,), Some(&loads))
    }

    /// Forgets the loads before: with a hardness the next load may be any.
    ///
    /// Other contacts take loads in any order at any time.
    fn restart(&self, py: Python<'_>) -> PyResult<()> {
        self.inner.take(py)?.last = None;
        Ok(())
    }

    /// Refuses the loads of a sweep that a solve would refuse later, because of their order.
    fn _check_order(&self, py: Python<'_>, kind: &str, values: Vec<f64>) -> PyResult<()> {
        if !self.yields {
            return Ok(());
        }
        let area = (kind == "mean_pressure").then(|| self.area());
        let loads: Vec<Load> =
            values.iter().map(|value| load_of(&self.normalisation, kind, *value)).collect();
        if let (Some(last), Some(first)) = (&self.inner.take(py)?.last, loads.first()) {
            last.check(py, *first, area)?;
        }
        check_rising(py, &loads, area)
    }

    /// Normalisation: of this very surface.
    #[getter]
    fn normalisation(&self) -> Normalisation {
        Normalisation(self.normalisation)
    }

    /// ContactState or None: what the last solve had reached that a signal such as Ctrl-C interrupted.
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
