//! Planned contacts.

use crate::errors::{of_model, of_solve, stopped};
use crate::exclusive::Exclusive;
use crate::load_order::{Highest, check_rising};
use crate::loads::{load, load_of, tangential};
use crate::memory;
use crate::numbers::RealNumber;
use crate::pool::{self, StopToken};
use crate::state::{self, PyContactState, StateOrigin};
use fractal_contact::{
    ContactState as RustState, Error, Hardness, LargestPull, Load, Normalisation as RustNormalisation,
    PathMemory, PreparedContact, Scene, Status, Step,
};
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict as _, PyBytes, PyTuple};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, PoisonError};

/// The loads that a call may name one of.
const LOADS: [&str; 4] = ["force", "approach", "mean_pressure", "mean_gap"];

/// Conversion of forces and stiffnesses to the dimensionless ones of the paper.
#[pyclass(name = "Normalisation", frozen, eq, module = "fractal_contact")]
#[derive(Clone, PartialEq)]
pub struct PyNormalisation(pub RustNormalisation);

#[pymethods]
impl PyNormalisation {
    /// float: contact modulus E*.
    #[getter]
    fn contact_modulus(&self) -> f64 {
        self.0.contact_modulus
    }

    /// float: L = sqrt(Lx Ly).
    #[getter]
    fn length(&self) -> f64 {
        self.0.length
    }

    /// float or None: measured rms height of this surface.
    #[getter]
    fn rms_height(&self) -> Option<f64> {
        self.0.height
    }

    /// The force F for F_bar = F/(E* h L).
    ///
    /// Parameters
    /// ----------
    /// force_bar : float
    ///     The dimensionless force.
    ///
    /// Returns
    /// -------
    /// float
    fn force(&self, py: Python<'_>, force_bar: RealNumber) -> PyResult<f64> {
        self.0.force(force_bar.0).map_err(|error| of_model(py, error))
    }

    /// The dimensionless force F_bar = F/(E* h L) for F.
    ///
    /// Parameters
    /// ----------
    /// force : float
    ///     The force, in the unit of the scene.
    ///
    /// Returns
    /// -------
    /// float
    fn force_bar(&self, py: Python<'_>, force: RealNumber) -> PyResult<f64> {
        self.0.force_bar(force.0).map_err(|error| of_model(py, error))
    }

    /// The dimensionless stiffness k_bar = k/(1.1419 E* L) for k.
    ///
    /// Parameters
    /// ----------
    /// stiffness : float
    ///     The stiffness, in the unit of the scene.
    ///
    /// Returns
    /// -------
    /// float
    fn stiffness_bar(&self, stiffness: RealNumber) -> f64 {
        self.0.stiffness_bar(stiffness.0)
    }

    fn __hash__(&self) -> u64 {
        // Of equal ones equal: both numbers are positive.
        self.0.contact_modulus.to_bits() ^ self.0.length.to_bits().rotate_left(32)
    }

    /// From the bytes of `__reduce__`.
    #[staticmethod]
    fn _of_bytes(py: Python<'_>, bytes: &[u8]) -> PyResult<Self> {
        state::of_bytes(py, bytes).map(Self)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        state::reduced(py, "normalisation", (state::bytes(py, &self.0)?,))
    }

    fn __repr__(&self) -> String {
        let RustNormalisation { contact_modulus, length, height, .. } = self.0;
        format!(
            "<Normalisation: contact_modulus={contact_modulus:e}, length={length:e}, rms_height={}>",
            height.map_or("None".into(), |h| format!("{h:e}"))
        )
    }
}

/// A planned contact: solve often, follow paths.
///
/// It keeps tables, plans and the last state, from which the next solve starts.
///
/// `solve` and `sweep` start each load from no contact; `advance` and `follow` continue a path of loads from
/// the current state. Threads that share one contact use it one after the other, in the order of their calls.
///
/// With a hardness `solve` begins with the virgin surface: a load smaller than one before is refused, because
/// the indentation of that one would be forgotten. `advance` and `follow` keep it, along any path.
#[pyclass(name = "Contact", frozen, weakref, module = "fractal_contact")]
pub struct PyContact {
    inner: Exclusive<Inner>,
    origin: StateOrigin,
    long: bool,
    /// Whether its memory is looked at before each solve.
    large: bool,
    /// Number of answers.
    answers: AtomicU32,
    /// Whether the surface yields, so that the order of loads matters.
    yields: bool,
    best: Mutex<Option<Py<PyContactState>>>,
    last: Mutex<Option<Py<PyContactState>>>,
}

struct Inner {
    contact: Box<dyn PreparedContact>,
    /// Of a contact that yields.
    highest: Option<Highest>,
    /// Of the path.
    largest: LargestPull,
}

/// What is asked of a contact.
enum Asked {
    Load(Load),
    Step(Step),
}

impl PyContact {
    /// A contact of a scene whose solves are long, or not.
    pub fn new(contact: Box<dyn PreparedContact>, scene: &Scene, long: bool, large: bool) -> Self {
        let origin = StateOrigin::new(scene, contact.normalisation());
        let inner = Exclusive::new(Inner { contact, highest: None, largest: LargestPull::default() });
        let yields = scene.effects.hardness != Hardness::Off;
        let (best, last) = (Mutex::new(None), Mutex::new(None));
        Self { inner, origin, long, large, answers: AtomicU32::new(0), yields, best, last }
    }

    fn normalisation(&self) -> &RustNormalisation {
        &self.origin.normalisation
    }

    fn area(&self) -> f64 {
        self.normalisation().length.powi(2)
    }

    /// Solves, on the pool where that may be long; Ctrl-C and errors become exceptions.
    ///
    /// States that are replaced end outside of all locks: the end of an array may call Python, which may ask
    /// for this contact.
    fn answer(
        &self,
        py: Python<'_>,
        asked: &Asked,
        area: Option<f64>,
        token: StopToken<'_>,
    ) -> PyResult<Py<PyContactState>> {
        if token.is_set(py)? {
            return Err(stopped(py));
        }
        let load = match asked {
            Asked::Load(load) => *load,
            Asked::Step(step) => step.load,
        };
        let mut inner = self.inner.take_unless(py, token)?;
        let Inner { contact, highest, largest } = &mut *inner;
        if let (Asked::Load(_), Some(highest)) = (asked, &highest) {
            highest.check(py, load.normal, area)?;
        }
        if self.large {
            memory::check_solve(py, contact, |contact| contact.required_memory(load))?;
        } else if self.answers.fetch_add(1, Ordering::Relaxed) % memory::MANY == memory::MANY - 1 {
            memory::check_many(py)?;
        }
        let mut work = |stop: &(dyn Fn() -> bool + Sync)| match asked {
            Asked::Load(load) => contact.solve_until(*load, &|| stop()),
            Asked::Step(step) => contact.advance_until(*step, &|| stop()),
        };
        let (result, raised) = if self.long {
            pool::run(py, token, &mut |_| Ok(()), work)?
        } else {
            (py.detach(|| work(&fractal_contact::never)), None)
        };
        let result = match (asked, result) {
            (Asked::Step(_), Ok(state)) => Ok(largest.enter(load.normal, state)),
            (Asked::Step(_), Err(Error::NotConverged { best }))
                if best.report.status == Status::PulledOff =>
            {
                Err(Error::NotConverged { best: Box::new(largest.enter(load.normal, *best)) })
            }
            (Asked::Step(_), failed) => failed,
            (Asked::Load(_), result) => {
                *largest = LargestPull::default();
                result
            }
        };
        if let (Ok(state), true) = (&result, self.yields) {
            *highest = Some(Highest::of(highest.take(), load.normal, state));
        }
        let (answer, ended) = self.told(py, asked, result, raised);
        drop(inner);
        drop(ended);
        answer
    }

    /// The state or the exception of a solve, and the states that it replaces.
    fn told(
        &self,
        py: Python<'_>,
        asked: &Asked,
        result: fractal_contact::Result<RustState>,
        raised: Option<PyErr>,
    ) -> (PyResult<Py<PyContactState>>, Vec<Option<Py<PyContactState>>>) {
        let of = |state: RustState| state::of(py, state, &self.origin);
        let mut ended = Vec::new();
        let answer = match (result, raised) {
            (Ok(state), raised) => of(state).and_then(|state| {
                ended.push(replaced(&self.last, Some(state.clone_ref(py))));
                if raised.is_some() {
                    // It was done before it heard of the signal.
                    ended.push(replaced(&self.best, Some(state.clone_ref(py))));
                }
                raised.map_or(Ok(state), Err)
            }),
            (Err(error), raised) => {
                if let Asked::Load(_) = asked {
                    // The path before it is forgotten.
                    ended.push(replaced(&self.last, None));
                }
                match (error, raised) {
                    (Error::Stopped { best }, Some(raised)) => {
                        let best = best.map(|best| of(*best)).transpose();
                        best.and_then(|best| {
                            ended.extend(best.map(|best| replaced(&self.best, Some(best))));
                            Err(raised)
                        })
                    }
                    (error, _) => Err(of_solve(py, error, &self.origin)),
                }
            }
        };
        (answer, ended)
    }
}

/// Sets a state; the one before it.
#[must_use]
fn replaced(
    place: &Mutex<Option<Py<PyContactState>>>,
    state: Option<Py<PyContactState>>,
) -> Option<Py<PyContactState>> {
    std::mem::replace(&mut *place.lock().unwrap_or_else(PoisonError::into_inner), state)
}

fn shown(py: Python<'_>, place: &Mutex<Option<Py<PyContactState>>>) -> Option<Py<PyContactState>> {
    place.lock().unwrap_or_else(PoisonError::into_inner).as_ref().map(|state| state.clone_ref(py))
}

#[pymethods]
impl PyContact {
    /// Solves for one load, from no contact: a path that was followed is forgotten.
    ///
    /// Parameters
    /// ----------
    /// force, approach, mean_pressure, mean_gap : float
    ///     Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries.
    /// stop : threading.Event, optional
    ///     Set by another thread, it stops the solve, also within an iteration.
    ///
    /// Returns
    /// -------
    /// ContactState
    ///
    /// Raises
    /// ------
    /// DomainError, OutOfRange, Unsupported
    ///     For a load that makes no sense or that the model does not hold for.
    ///     With a hardness also for a load smaller than one before.
    /// OutOfMemory
    ///     For contact that fills so much of a large grid that it does not fit in memory.
    /// NotConverged, Stopped
    ///     With the state that was reached as ``best``.
    #[pyo3(signature = (*, force=None, approach=None, mean_pressure=None, mean_gap=None, stop=None))]
    fn solve(
        &self,
        py: Python<'_>,
        force: Option<RealNumber>,
        approach: Option<RealNumber>,
        mean_pressure: Option<RealNumber>,
        mean_gap: Option<RealNumber>,
        stop: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyContactState>> {
        let token = StopToken::new(py, stop.as_ref())?;
        let load = load(self.normalisation(), force, approach, mean_pressure, mean_gap)?;
        self.answer(py, &Asked::Load(load), mean_pressure.map(|_| self.area()), token)
    }

    /// Solves for loads in their order: an iterator that yields each state as soon as it is known.
    ///
    /// Parameters
    /// ----------
    /// force, approach, mean_pressure, mean_gap : iterable of float
    ///     Exactly one of them. Increasing loads are the fastest order, and the only one with a hardness. With
    ///     ``steps`` the first and the last load.
    /// steps : int, optional
    ///     Number of states, at least 2, which are equally spaced in the logarithm of the contact area between those of
    ///     the two loads, to a twentieth of a step or as the cells allow. The scene has to compute the area. The loads
    ///     between are found by two to three solves each.
    /// stop : threading.Event, optional
    ///     As in `solve`.
    ///
    /// Yields
    /// ------
    /// ContactState
    #[pyo3(signature = (*, force=None, approach=None, mean_pressure=None, mean_gap=None, steps=None, stop=None))]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn sweep<'py>(
        slf: &Bound<'py, Self>,
        force: Option<Bound<'py, PyAny>>,
        approach: Option<Bound<'py, PyAny>>,
        mean_pressure: Option<Bound<'py, PyAny>>,
        mean_gap: Option<Bound<'py, PyAny>>,
        steps: Option<Bound<'py, PyAny>>,
        stop: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let values = [force, approach, mean_pressure, mean_gap, steps, stop];
        let loads = LOADS.into_iter().chain(["steps", "stop"]).zip(values).into_py_dict(slf.py())?;
        slf.py().import("fractal_contact._models")?.call_method("sweep", (slf,), Some(&loads))
    }

    /// Advances to the end of the next step of a path. A step that fails leaves the contact as it was.
    ///
    /// Parameters
    /// ----------
    /// time : float
    ///     Time at the end of the step; it never decreases. With friction alone it has no influence.
    /// force, approach, mean_pressure, mean_gap : float
    ///     Exactly one of them. ``mean_pressure`` is over Lx Ly, ``mean_gap`` for periodic boundaries. The first
    ///     three may be negative with adhesion.
    /// tangential_force, tangential_displacement : float or (float, float), optional
    ///     At most one of them: along x, or along x (columns) and along y (rows); no tangential force otherwise.
    ///     A force is at most ``sliding_force``; at that the displacement is the least at which the contact
    ///     slides.
    /// stop : threading.Event, optional
    ///     As in `solve`.
    ///
    /// Returns
    /// -------
    /// ContactState
    ///
    /// Raises
    /// ------
    /// DomainError, OutOfRange, Unsupported
    ///     For a load that makes no sense or that the model does not hold for.
    /// NotConverged, Stopped
    ///     With the state that was reached as ``best``; beyond pull-off that is the last stable state.
    #[pyo3(signature = (time=RealNumber(0.0), *, force=None, approach=None, mean_pressure=None, mean_gap=None,
                        tangential_force=None, tangential_displacement=None, stop=None),
           text_signature = "($self, time=0.0, *, force=None, approach=None, mean_pressure=None, mean_gap=None, \
                             tangential_force=None, tangential_displacement=None, stop=None)")]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn advance(
        &self,
        py: Python<'_>,
        time: RealNumber,
        force: Option<RealNumber>,
        approach: Option<RealNumber>,
        mean_pressure: Option<RealNumber>,
        mean_gap: Option<RealNumber>,
        tangential_force: Option<Bound<'_, PyAny>>,
        tangential_displacement: Option<Bound<'_, PyAny>>,
        stop: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyContactState>> {
        let token = StopToken::new(py, stop.as_ref())?;
        let normal = load(self.normalisation(), force, approach, mean_pressure, mean_gap)?;
        let tangential = tangential(tangential_force.as_ref(), tangential_displacement.as_ref())?;
        self.answer(py, &Asked::Step(Step::new(time.0, normal.with_tangential(tangential))), None, token)
    }

    /// Follows a path: an iterator that yields the state at the end of each step as soon as it is known.
    ///
    /// Where a step raises, the states yielded before remain, and the contact is at the end of the step before.
    ///
    /// Parameters
    /// ----------
    /// time : float or iterable of float
    ///     Time at the end of each step.
    /// force, approach, mean_pressure, mean_gap : float or iterable of float
    ///     Exactly one of them, as in `advance`.
    /// tangential_force, tangential_displacement : float, iterable of float or of (float, float), optional
    ///     At most one of them, along x or along x and y. Iterables have one number, or two, for each step; a
    ///     number alone is that of every step.
    /// stop : threading.Event, optional
    ///     As in `solve`.
    ///
    /// Yields
    /// ------
    /// ContactState
    #[pyo3(signature = (time=None, *, force=None, approach=None, mean_pressure=None, mean_gap=None,
                        tangential_force=None, tangential_displacement=None, stop=None))]
    #[allow(clippy::too_many_arguments)] // One for each keyword.
    fn follow<'py>(
        slf: &Bound<'py, Self>,
        time: Option<Bound<'py, PyAny>>,
        force: Option<Bound<'py, PyAny>>,
        approach: Option<Bound<'py, PyAny>>,
        mean_pressure: Option<Bound<'py, PyAny>>,
        mean_gap: Option<Bound<'py, PyAny>>,
        tangential_force: Option<Bound<'py, PyAny>>,
        tangential_displacement: Option<Bound<'py, PyAny>>,
        stop: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let values =
            [force, approach, mean_pressure, mean_gap, time, tangential_force, tangential_displacement, stop];
        let names = LOADS.into_iter().chain(["time", "tangential_force", "tangential_displacement", "stop"]);
        let steps = names.zip(values).into_py_dict(slf.py())?;
        slf.py().import("fractal_contact._models")?.call_method("follow", (slf,), Some(&steps))
    }

    /// Forgets the loads and the path before: back to no contact at time 0.
    fn restart(&self, py: Python<'_>) -> PyResult<()> {
        let mut inner = self.inner.take(py)?;
        inner.contact.restart();
        (inner.highest, inner.largest) = (None, LargestPull::default());
        let before = replaced(&self.last, None);
        drop(inner);
        drop(before);
        Ok(())
    }

    /// The memory of the loads so far, of a path or each by itself, as bytes.
    ///
    /// Together with the next load it determines the next state. `recall` of a contact of the same model, scene and
    /// seed continues from it with identical bits, also in another process of the same version on the same kind of
    /// processor.
    ///
    /// Returns
    /// -------
    /// bytes or None
    ///     None for models without such a memory, whose paths must be followed anew.
    fn memory<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyBytes>>> {
        let mut inner = self.inner.take(py)?;
        // Exclusive, for another thread.
        let Inner { contact, highest, largest } = &mut *inner;
        let kept = py.detach(move || {
            let Some(memory) = contact.memory()? else { return Ok(None) };
            PathMemory::of(&(&*highest, &*largest, memory.bytes())).map(Some)
        });
        let kept = kept.map_err(|error| of_model(py, error))?;
        Ok(kept.map(|kept| PyBytes::new(py, kept.bytes())))
    }

    /// Restores a contact of the same model, scene and seed to where it gave its `memory`.
    ///
    /// The states before that are not in the memory: `last` is None.
    ///
    /// Parameters
    /// ----------
    /// memory : bytes
    ///     What `memory` gave.
    ///
    /// Raises
    /// ------
    /// ShapeError
    ///     For bytes of another model or surface. The contact is then as after `restart`.
    fn recall(&self, py: Python<'_>, memory: &[u8]) -> PyResult<()> {
        let mut inner = self.inner.take(py)?;
        let Inner { contact, highest, largest } = &mut *inner;
        let kept = PathMemory::from_bytes(memory.to_vec());
        (*highest, *largest) = (None, LargestPull::default());
        let recalled = py.detach(|| {
            contact.restart();
            let (before, pulled, memory): (_, _, Vec<u8>) = kept.read()?;
            contact.recall(&PathMemory::from_bytes(memory))?;
            Ok((before, pulled))
        });
        let recalled = recalled.map(|found| (*highest, *largest) = found);
        let before = replaced(&self.last, None);
        drop(inner);
        drop(before);
        recalled.map_err(|error| of_model(py, error))
    }

    /// Refuses the loads of a sweep that a solve would refuse later, because of their order.
    fn _check_order(&self, py: Python<'_>, kind: &str, values: Vec<f64>) -> PyResult<()> {
        if !self.yields {
            return Ok(());
        }
        let area = (kind == "mean_pressure").then(|| self.area());
        let loads: Vec<Load> =
            values.iter().map(|value| load_of(self.normalisation(), kind, *value)).collect();
        if let (Some(highest), Some(first)) = (&self.inner.take(py)?.highest, loads.first()) {
            highest.check(py, first.normal, area)?;
        }
        check_rising(py, &loads, area)
    }

    /// Whether the order of loads matters, because the surface yields.
    #[getter]
    fn _yields(&self) -> bool {
        self.yields
    }

    /// Normalisation: that of this surface.
    #[getter(normalisation)]
    fn shown_normalisation(&self) -> PyNormalisation {
        PyNormalisation(self.origin.normalisation)
    }

    /// ContactState or None: the best state of the last solve that a signal such as Ctrl-C interrupted.
    #[getter]
    fn best(&self, py: Python<'_>) -> Option<Py<PyContactState>> {
        shown(py, &self.best)
    }

    /// ContactState or None: the state at the end of the last solve or step that was complete, where the next
    /// step begins; None before the first, and after a solve that failed.
    ///
    /// It says where the contact stands after a step that failed, or that a signal such as Ctrl-C
    /// interrupted.
    #[getter]
    fn last(&self, py: Python<'_>) -> Option<Py<PyContactState>> {
        shown(py, &self.last)
    }

    fn __repr__(&self) -> String {
        let RustNormalisation { contact_modulus, length, height, .. } = self.origin.normalisation;
        let height = height.map_or("none".into(), |h| format!("{h:.4e}"));
        format!("<Contact: contact_modulus={contact_modulus:e}, length={length:e}, rms height {height}>")
    }
}
