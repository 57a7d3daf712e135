//! Contacts that remember: friction and rheology under a path of loads.
//!
//! A [`crate::ContactModel`] answers one load, whatever came before. With friction or a viscous material the answer depends on the path: a
//! [`HistoryModel`] plans a [`History`], which takes the path [`Step`] by step and keeps what has to be remembered.

use crate::error::{Error, Result};
use crate::load::Load;
use crate::model::{RequiredMemory, Source, Stop};
use crate::normalisation::Normalisation;
use crate::scene::Scene;
use crate::state::ContactState;

/// The tangential load, in one fixed direction. Signed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tangential {
    /// Tangential force.
    Force(f64),
    /// Tangential displacement of the bodies relative to each other, far from the contact.
    Displacement(f64),
}

impl Default for Tangential {
    /// No tangential force.
    fn default() -> Self {
        Self::Force(0.0)
    }
}

/// The end of a straight segment of a path; it begins where the last one ended. Before the first step: time 0, no contact, no load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Time at the end of the segment; it never decreases. Equal times are a jump. Friction alone does not look at it.
    pub time: f64,
    /// Normal load at the end.
    pub normal: Load,
    /// Tangential load at the end.
    pub tangential: Tangential,
}

impl Step {
    /// A step of the normal load alone.
    pub fn normal(time: f64, normal: Load) -> Self {
        Self { time, normal, tangential: Tangential::default() }
    }

    /// The step itself where its numbers make sense after a step that ended at `last`.
    ///
    /// # Errors
    /// [`Error::Domain`] for a time before `last`, a normal load as [`Load::validated`], or a tangential load that is not finite.
    pub fn validated(self, last: f64) -> Result<Self> {
        self.normal.validated()?;
        self.validated_with_adhesion(last)
    }

    /// The same for models with adhesion, which can pull.
    ///
    /// # Errors
    /// As [`Step::validated`], with [`Load::validated_with_adhesion`].
    pub fn validated_with_adhesion(self, last: f64) -> Result<Self> {
        if !(self.time.is_finite() && self.time >= last) {
            return Err(Error::domain(
                "time",
                self.time,
                format!("a finite number >= {last}, the last time"),
            ));
        }
        self.normal.validated_with_adhesion()?;
        let (name, value) = match self.tangential {
            Tangential::Force(force) => ("tangential force", force),
            Tangential::Displacement(displacement) => ("tangential displacement", displacement),
        };
        if value.is_finite() { Ok(self) } else { Err(Error::domain(name, value, "a finite number")) }
    }
}

/// The state at the end of a step.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HistoryState {
    /// Its time.
    pub time: f64,
    /// Its normal part, with the evidence.
    pub normal: ContactState,
    /// Contact radius, of round contacts; of an equivalent profile that of the round contact of the same stiffness, `k/(2 E*)`.
    pub contact_radius: Option<f64>,
    /// Its tangential part, of models with friction.
    pub tangential: Option<TangentialState>,
}

impl HistoryState {
    /// A state without a radius and a tangential part yet.
    pub fn new(time: f64, normal: ContactState) -> Self {
        Self { time, normal, contact_radius: None, tangential: None }
    }

    /// With a contact radius.
    #[must_use]
    pub fn with_contact_radius(self, radius: impl Into<Option<f64>>) -> Self {
        Self { contact_radius: radius.into(), ..self }
    }

    /// With a tangential part.
    #[must_use]
    pub fn with_tangential(self, tangential: impl Into<Option<TangentialState>>) -> Self {
        Self { tangential: tangential.into(), ..self }
    }
}

/// The tangential part of a state.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TangentialState {
    /// Tangential force.
    pub force: f64,
    /// Tangential displacement.
    pub displacement: f64,
    /// Radius inside which the traction is below what friction can hold, of round contacts (of an equivalent profile as the contact
    /// radius): the contact radius without any slip, 0 in full slip.
    pub stick_radius: Option<f64>,
    /// Energy that friction has dissipated since the first step, >= 0.
    pub dissipated: f64,
}

impl TangentialState {
    /// A state in which nothing slipped yet and no stick radius is known.
    pub fn new(force: f64, displacement: f64) -> Self {
        Self { force, displacement, stick_radius: None, dissipated: 0.0 }
    }

    /// With a stick radius.
    #[must_use]
    pub fn with_stick_radius(self, radius: impl Into<Option<f64>>) -> Self {
        Self { stick_radius: radius.into(), ..self }
    }

    /// With the energy that friction has dissipated since the first step.
    #[must_use]
    pub fn with_dissipated(self, dissipated: f64) -> Self {
        Self { dissipated, ..self }
    }
}

/// A way to answer what happens along a path: plan once. Which effect it is about is in the scene.
pub trait HistoryModel: Send + Sync {
    /// Short name, the same in code, CSV and README.
    fn name(&self) -> &'static str;

    /// What it is built on.
    fn sources(&self) -> &'static [Source];

    /// Checks the scene against what this model can do, and plans, as [`crate::ContactModel::prepare`].
    ///
    /// # Errors
    /// [`Error::Unsupported`] for a surface, effect or output that the model lacks, [`Error::Domain`] or [`Error::Shape`] for
    /// numbers that make no sense.
    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn History>>;

    /// What planning and a light load need at least, as [`crate::ContactModel::least_memory`].
    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        let _ = scene;
        None
    }
}

/// A planned contact that remembers its path.
pub trait History: Send {
    /// The normalisation of this very surface.
    fn normalisation(&self) -> Normalisation;

    /// What a step under this load needs beyond what the history holds, as [`crate::PreparedContact::required_memory`].
    fn required_memory(&self, load: Load) -> Option<RequiredMemory> {
        let _ = load;
        None
    }

    /// Goes to the end of the next step. **A step that fails leaves the history as it was before.**
    ///
    /// # Errors
    /// [`Error::Domain`] as [`Step::validated`], [`Error::OutOfRange`] for loads beyond what the model holds for (gross slip, a time
    /// from which the contact would shrink), [`Error::Unsupported`] for loads that it does not know.
    fn advance(&mut self, step: Step) -> Result<HistoryState>;

    /// The same, where `stop` may say so on the way: before it begins, and between the solves of a model that needs some.
    ///
    /// # Errors
    /// As [`History::advance`]; [`Error::Stopped`].
    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<HistoryState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        self.advance(step)
    }

    /// Forgets the path: back to no contact at time 0.
    fn restart(&mut self);

    /// Goes along a whole path from where it is, one state per step.
    ///
    /// # Errors
    /// As [`History::advance`], at the first step that fails; the history then stands at the end of the step before it.
    fn follow(&mut self, path: &[Step]) -> Result<Vec<HistoryState>> {
        path.iter().map(|step| self.advance(*step)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_checked() {
        let step = Step::normal(1.0, Load::Force(1.0));
        assert!(step.validated(0.0).is_ok() && step.validated(1.0).is_ok());
        let late = step.validated(2.0).unwrap_err().to_string();
        assert_eq!(late, "time = 1: expected a finite number >= 2, the last time");
        assert!(Step { normal: Load::Force(-1.0), ..step }.validated(0.0).is_err());
        assert!(Step { tangential: Tangential::Force(f64::NAN), ..step }.validated(0.0).is_err());
        assert!(Step { tangential: Tangential::Displacement(-3.0), ..step }.validated(0.0).is_ok());
    }
}
