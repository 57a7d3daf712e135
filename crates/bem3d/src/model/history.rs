//! Paths of loads: what the contact remembers.

use super::Bem3d;
use super::options::NAME;
use crate::parts::Recorder;
use crate::tuning::Tuning;
use contact_model::{
    Adhesion, ContactModel, Error, Hardness, History, HistoryModel, RequiredMemory, Result, Scene, Source,
};

/// The boundary-element model along a path of loads, for effects that remember it: hardness and adhesion.
///
/// ```
/// use bem3d::{Bem3d, Bem3dPath, Hardness, HistoryModel, Load, Scene, Step, Surface};
/// // A sphere is pressed until its middle flows, and unloaded: the indentation stays.
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
/// scene.effects.hardness = Hardness::Limit { pressure: 0.1 };
/// let mut path = Bem3dPath(Bem3d { cells: 32, ..Bem3d::default() }).prepare(&scene, 0)?;
/// let loaded = path.advance(Step::normal(1.0, Load::Force(0.02)))?.normal.plastic.unwrap();
/// let unloaded = path.advance(Step::normal(2.0, Load::Force(0.0)))?.normal.plastic.unwrap();
/// assert!(loaded.area > 0.0 && unloaded.area == 0.0 && unloaded.volume == loaded.volume);
/// # Ok::<(), bem3d::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Bem3dPath(pub Bem3d);

impl HistoryModel for Bem3dPath {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        self.0.sources()
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn History>> {
        scene.validate()?;
        if scene.effects.hardness == Hardness::Off && scene.effects.adhesion == Adhesion::Off {
            let what = "a path without hardness or adhesion: nothing depends on it";
            return Err(Error::unsupported(NAME, what));
        }
        Ok(Box::new(self.0.prepared(scene, seed, &Tuning::DEFAULT, &Recorder::default())?))
    }

    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        Some(self.0.memory(scene))
    }
}
