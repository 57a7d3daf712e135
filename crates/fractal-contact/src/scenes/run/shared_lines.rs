//! The plan of the random lines of a scene, which its jobs share.

use crate::scenes::read::Numerics;
use contact_model::{ContactModel, Surface};
use mdr1d::Ensemble;
use std::sync::{Arc, OnceLock};

/// The plan of the random lines of a scene. The first job that needs it makes it, and the states do not depend on
/// it.
#[derive(Debug, Default)]
pub(crate) struct SharedLines {
    /// `None` where no such lines can be planned.
    plan: OnceLock<Option<Arc<Ensemble>>>,
}

impl SharedLines {
    /// The model for a surface of the scene. Random lines of one spectrum share transforms, amplitudes and memory;
    /// every other model is the one that the scene names.
    pub fn model(&self, numerics: &Numerics, surface: &Surface) -> Arc<dyn ContactModel> {
        let (Numerics::Mdr1d(lines), Surface::SelfAffine(surface)) = (numerics, surface) else {
            return numerics.model();
        };
        let planned = self.plan.get_or_init(|| Ensemble::new(surface, lines.elements).ok().map(Arc::new));
        match planned {
            Some(ensemble) => Arc::<Ensemble>::clone(ensemble),
            // The model says why it refuses the surface.
            None => numerics.model(),
        }
    }
}
