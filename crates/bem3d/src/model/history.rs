//! Paths of loads: what the contact remembers.

use super::Bem3d;
use super::adhesive::{AdhesiveContact, WithoutAdhesion};
use super::options::NAME;
use super::plastic_path::PlasticPath;
use super::prepared::refuse_together;
use super::profile;
use crate::tuning::Tuning;
use contact_model::{
    Abilities, Adhesion, ContactModel, Error, Hardness, PreparedContact, RequiredMemory, Result, Scene,
    Source,
};

/// The boundary-element model along a path of loads, for effects that remember it: hardness and adhesion.
///
/// ```
/// use bem3d::{Bem3d, Bem3dPath, ContactModel, Hardness, Load, Scene, Step, Surface};
/// // A sphere is pressed until its middle flows, and unloaded: the indentation stays.
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
/// let mut path = Bem3dPath(Bem3d { cells: 32, ..Bem3d::default() }).prepare(&scene, 0)?;
/// let loaded = path.advance(Step::normal(1.0, Load::Force(0.02)))?.plastic.unwrap();
/// let unloaded = path.advance(Step::normal(2.0, Load::Force(0.0)))?.plastic.unwrap();
/// assert!(loaded.area > 0.0 && unloaded.area == 0.0 && unloaded.volume == loaded.volume);
/// # Ok::<(), bem3d::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bem3dPath(pub Bem3d);

impl ContactModel for Bem3dPath {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        self.0.sources()
    }

    fn abilities(&self) -> Abilities {
        self.0.abilities()
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        scene.validate()?;
        refuse_together(&scene.effects)?;
        profile::check(scene)?;
        match scene.effects.adhesion {
            Adhesion::ShortRange { work } | Adhesion::FiniteRange { work, .. } if work > 0.0 => {
                Ok(Box::new(AdhesiveContact::new(&self.0, scene, seed, &Tuning::DEFAULT)?))
            }
            Adhesion::ShortRange { .. } | Adhesion::FiniteRange { .. } => {
                Ok(Box::new(WithoutAdhesion::new(ContactModel::prepare(&self.0, scene, seed)?)))
            }
            Adhesion::Off if scene.effects.hardness == Hardness::Off => {
                Err(Error::unsupported(NAME, "a path without hardness or adhesion: nothing depends on it"))
            }
            Adhesion::Off => {
                Ok(Box::new(PlasticPath::new(self.0.prepared(scene, seed, &Tuning::DEFAULT)?)))
            }
            other => Err(Error::unsupported(NAME, format!("the adhesion {other:?}"))),
        }
    }

    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        Some(self.0.memory(scene))
    }
}
