//! The trait of models and that of planned contacts: plan once, solve often, follow paths.

use crate::abilities::Abilities;
use crate::effects::Effects;
use crate::error::{Error, Result};
use crate::load::Load;
use crate::memory::PathMemory;
use crate::normalisation::Normalisation;
use crate::pull_off::LargestPull;
use crate::scene::Scene;
use crate::state::ContactState;
use crate::step::Step;
use std::borrow::Cow;

/// A publication that a model is built on. It goes into the header of every CSV file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Source {
    /// Authors, journal, year, pages.
    pub citation: &'static str,
    /// What is taken from it (equations).
    pub what: &'static str,
}

/// Memory that a piece of work needs.
#[derive(Debug, Clone, PartialEq)]
pub struct RequiredMemory {
    /// What needs it, with its size, such as `a contact of 257 columns x 257 rows`.
    pub what: Cow<'static, str>,
    /// Number of bytes, approximately.
    pub bytes: f64,
}

/// An observer of a solve: it may end the solve, and it receives the residuals.
///
/// Every `Fn() -> bool` is an observer that ignores the residuals. A solver never reads a clock itself.
///
/// ```
/// use contact_model::{Stop, Watch};
/// use std::cell::Cell;
///
/// struct Last(Cell<f64>);
///
/// impl Watch for Last {
///     fn stops(&self) -> bool {
///         false
///     }
///     fn residual(&self, residual: f64, _tolerance: f64) {
///         self.0.set(residual);
///     }
/// }
/// let last = Last(Cell::new(f64::NAN));
/// let solve = |stop: Stop<'_>| stop.residual(1e-3, 1e-6);
/// solve(&last);
/// solve(&|| false);
/// assert_eq!(last.0.get(), 1e-3);
/// ```
pub trait Watch {
    /// `true` means stop now.
    fn stops(&self) -> bool;

    /// After an iteration of the load in hand: its largest residual, dimensionless, and the tolerance that
    /// ends the solve. Residuals need not fall from one iteration to the next.
    fn residual(&self, residual: f64, tolerance: f64) {
        let _ = (residual, tolerance);
    }
}

impl<F: Fn() -> bool> Watch for F {
    fn stops(&self) -> bool {
        self()
    }
}

/// Polled between iterations, and in long ones within them. Once it has said stop, it should go on to say so.
pub type Stop<'a> = &'a dyn Watch;

/// The [`Stop`] that never stops.
pub fn never() -> bool {
    false
}

/// A piece of work was left unfinished because its [`Stop`] said so. What it would have written is undefined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Interrupted;

impl Interrupted {
    /// The error of a solve that was stopped before it had a state: [`Error::Stopped`] without one.
    pub fn without_state(self) -> Error {
        Error::Stopped { best: None }
    }
}

/// Ends a solve that was stopped before it has a state.
///
/// # Errors
/// [`Error::Stopped`] without a state, where `stop` says so.
pub fn check_stop(stop: Stop<'_>) -> Result<()> {
    if stop.stops() { Err(Error::Stopped { best: None }) } else { Ok(()) }
}

/// A model of contact, which relates force, approach and stiffness: it plans a contact once for many solves.
pub trait ContactModel: Send + Sync {
    /// Short name, the same in code, CSV and README (`bem3d`, `mdr1d`, ...).
    fn name(&self) -> &'static str;

    /// The publications that it is built on.
    fn sources(&self) -> &'static [Source];

    /// Publications for these effects, in addition to [`Self::sources`].
    fn sources_of(&self, _effects: &Effects) -> Vec<Source> {
        Vec::new()
    }

    /// Its abilities. [`Abilities::refuse`] checks a scene against them, and help, tables and refusals follow
    /// from them.
    fn abilities(&self) -> Abilities;

    /// Checks the scene against what this model can do, and plans: draws the surface from `seed` where the
    /// scene calls for one, builds tables.
    ///
    /// # Errors
    /// [`crate::Error::Unsupported`] for a surface, effect or output that the model lacks (never a silent
    /// elastic answer), [`crate::Error::Domain`] or [`crate::Error::Shape`] for numbers that make no sense.
    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>>;

    /// As [`ContactModel::prepare`], unless the stop ends it: for models that draw large surfaces. By default the stop is
    /// not asked.
    ///
    /// # Errors
    /// [`crate::Error::Stopped`] by the stop; as [`ContactModel::prepare`].
    fn prepare_until(&self, scene: &Scene, seed: u64, stop: Stop<'_>) -> Result<Box<dyn PreparedContact>> {
        let _ = stop;
        self.prepare(scene, seed)
    }

    /// The least memory that [`ContactModel::prepare`] and a light load need, the surface that is drawn
    /// included; `None` where that does not grow with a grid. Callers compare it with the memory that is
    /// available; a model does not ask the system.
    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        let _ = scene;
        None
    }
}

// What wraps a model takes one that is chosen at run time, too.
impl<M: ContactModel + ?Sized> ContactModel for &M {
    fn name(&self) -> &'static str {
        (**self).name()
    }

    fn sources(&self) -> &'static [Source] {
        (**self).sources()
    }

    fn sources_of(&self, effects: &Effects) -> Vec<Source> {
        (**self).sources_of(effects)
    }

    fn abilities(&self) -> Abilities {
        (**self).abilities()
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        (**self).prepare(scene, seed)
    }

    fn prepare_until(&self, scene: &Scene, seed: u64, stop: Stop<'_>) -> Result<Box<dyn PreparedContact>> {
        (**self).prepare_until(scene, seed, stop)
    }

    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        (**self).least_memory(scene)
    }
}

/// A planned contact, which can be solved many times. It owns tables, plans and the warm start.
pub trait PreparedContact: Send {
    /// The normalisation of this surface, with its own measured rms height.
    fn normalisation(&self) -> Normalisation;

    /// Solves for one load from no contact; `stop` is polled as [`Stop`] says.
    ///
    /// Loads solved before change the result by no more than the stated tolerance; increasing loads are the
    /// fastest order. This also holds for effects with a memory: each load is reached from the virgin surface
    /// in one step, and a path that was followed is forgotten. The next step
    /// ([`PreparedContact::advance_until`]) goes on from the load that was solved.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] for a negative or non-finite load, [`crate::Error::OutOfRange`] where the
    /// model does not hold, [`crate::Error::Unsupported`] for a tangential load without friction,
    /// [`crate::Error::NotConverged`] and [`crate::Error::Stopped`] with the best state.
    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState>;

    /// Solves for one load as a step from no contact: [`PreparedContact::solve_until`] for models whose
    /// states depend on the path.
    ///
    /// # Errors
    /// As [`PreparedContact::advance_until`].
    fn solve_as_step(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.restart();
        let mut state = self.advance_until(Step::new(0.0, load), stop)?;
        // A load alone has no time.
        state.time = None;
        Ok(state)
    }

    /// Solves for one load.
    ///
    /// # Errors
    /// As [`PreparedContact::solve_until`].
    fn solve(&mut self, load: Load) -> Result<ContactState> {
        self.solve_until(load, &never)
    }

    /// Advances to the end of the next step of a path; `stop` is polled as [`Stop`] says. **A step that
    /// fails leaves the contact as it was before.**
    ///
    /// A contact without a memory solves for the load of the step, whatever came before.
    ///
    /// # Errors
    /// As [`PreparedContact::solve_until`], and [`Step::validated`]; [`Error::OutOfRange`] for steps beyond
    /// what the model holds for (gross slip, a time from which the contact would shrink).
    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        let Step { time, load } = step.validated_with_adhesion(f64::NEG_INFINITY)?;
        Ok(self.solve_until(load, stop)?.with_time(time))
    }

    /// Advances to the end of the next step of a path.
    ///
    /// # Errors
    /// As [`PreparedContact::advance_until`].
    fn advance(&mut self, step: Step) -> Result<ContactState> {
        self.advance_until(step, &never)
    }

    /// Follows a whole path from the current state: one state per step, each with the largest pull so far.
    ///
    /// # Errors
    /// As [`PreparedContact::advance_until`], at the first step that fails; the contact then stands at the
    /// end of the step before it.
    fn follow(&mut self, path: &[Step]) -> Result<Vec<ContactState>> {
        let mut largest = LargestPull::default();
        path.iter().map(|step| Ok(largest.enter(step.load.normal, self.advance(*step)?))).collect()
    }

    /// The memory of the loads so far, of a path or each by itself, which together with the next load
    /// determines the next state: another contact of the same model, scene and seed continues from it with
    /// identical bits ([`PreparedContact::recall`]). `None` where a model has no such memory: its paths must
    /// be followed anew, and each load by itself is solved without those before it.
    ///
    /// # Errors
    /// [`Error::OutOfMemory`] where there is no room for it.
    fn memory(&self) -> Result<Option<PathMemory>> {
        Ok(None)
    }

    /// Restores a contact of the same model, scene and seed to what it was when it gave this memory. The next
    /// call must be the one that followed there, of [`PreparedContact::advance_until`] or
    /// [`PreparedContact::solve_until`].
    ///
    /// # Errors
    /// [`Error::Shape`] for a memory that this model did not write on this surface; the contact is then as
    /// after [`PreparedContact::restart`].
    fn recall(&mut self, memory: &PathMemory) -> Result<()> {
        self.restart();
        Err(PathMemory::unreadable(memory.bytes().len()))
    }

    /// Forgets the path: the next step starts from no contact at time 0.
    fn restart(&mut self) {}

    /// Memory that a solve for this load needs beyond what the contact holds, approximately; `None` where
    /// that does not grow with a grid. As with [`ContactModel::least_memory`], callers compare it with the
    /// memory that is available.
    fn required_memory(&self, load: Load) -> Option<RequiredMemory> {
        let _ = load;
        None
    }

    /// Solves for loads in their order and passes each result with its number to the observer, as soon as it
    /// is known.
    ///
    /// A load that does not converge or that the model refuses is an error that the observer gets; the sweep
    /// goes on unless the observer returns an error, which ends it. [`Error::into_best`] takes the state of a
    /// load that did not converge.
    ///
    /// # Errors
    /// [`Error::Stopped`] where `stop` says so (the observer does not get it), or the error of the observer.
    ///
    /// ```
    /// use contact_model::{Load, PreparedContact, Result, never};
    /// /// Stiffness under each force; `None` where the model refuses it.
    /// fn stiffnesses(contact: &mut dyn PreparedContact, forces: &[f64]) -> Result<Vec<Option<f64>>> {
    ///     let loads: Vec<Load> = forces.iter().map(|&f| Load::force(f)).collect();
    ///     let mut found = Vec::new();
    ///     contact.sweep(&loads, &never, &mut |_, state| {
    ///         found.push(state.ok().and_then(|s| s.stiffness));
    ///         Ok(())
    ///     })?;
    ///     Ok(found)
    /// }
    /// ```
    fn sweep(
        &mut self,
        loads: &[Load],
        stop: Stop<'_>,
        observer: &mut dyn FnMut(usize, Result<ContactState>) -> Result<()>,
    ) -> Result<()> {
        for (i, &load) in loads.iter().enumerate() {
            match self.solve_until(load, stop) {
                Err(stopped @ Error::Stopped { .. }) => return Err(stopped),
                result => observer(i, result)?,
            }
        }
        Ok(())
    }
}
