//! Contacts that depend on their path.

use super::finite_range::{FiniteRangeContact, WithoutAdhesion};
use super::options::Bem3d;
use super::prepared::NAME;
use crate::tuning::Tuning;
use contact_model::{
    Adhesion, ContactModel, Effects, Error, History, HistoryModel, Result, Scene, Source, Step, Tangential,
};

impl HistoryModel for Bem3d {
    fn name(&self) -> &'static str {
        ContactModel::name(self)
    }

    fn sources(&self) -> &'static [Source] {
        ContactModel::sources(self)
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn History>> {
        scene.validate()?;
        match scene.effects.adhesion {
            Adhesion::FiniteRange { work, range, law } if work > 0.0 => Ok(Box::new(
                FiniteRangeContact::new(self, scene, seed, (work, range, law), &Tuning::DEFAULT)?,
            )),
            Adhesion::FiniteRange { .. } => {
                let effects = Effects { adhesion: Adhesion::Off, ..scene.effects };
                let scene = Scene { effects, ..scene.clone() };
                Ok(Box::new(WithoutAdhesion::new(ContactModel::prepare(self, &scene, seed)?)))
            }
            _ => Err(Error::unsupported(NAME, "a history of a contact without adhesion of finite range")),
        }
    }
}

/// A step whose tangential load is nothing: there is no friction.
///
/// # Errors
/// [`Error::Unsupported`] for any other.
pub(super) fn without_tangential(step: Step) -> Result<()> {
    let (Tangential::Force(value) | Tangential::Displacement(value)) = step.tangential else {
        return Err(Error::unsupported(NAME, "a tangential load"));
    };
    if value.abs() > 0.0 { Err(Error::unsupported(NAME, "a tangential load")) } else { Ok(()) }
}
