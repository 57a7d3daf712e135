//! What the jobs of a scene share besides the scene itself.

use crate::scenes::read::Numerics;
use contact_model::{ContactModel, Surface};
use mdr1d::Ensemble;
use std::sync::{Arc, OnceLock};

/// The plan of the lines of a scene, which is made once when the first of its jobs needs it. The states do not
/// depend on it.
#[derive(Debug, Default)]
pub(crate) struct SharedModels {
    /// `None` where no such lines can be planned.
    lines: OnceLock<Option<Arc<Ensemble>>>,
}

impl SharedModels {
    /// The model for a surface of the scene: lines of one spectrum share plans, amplitudes and memory.
    pub fn model(&self, numerics: &Numerics, surface: &Surface) -> Arc<dyn ContactModel> {
        let (Numerics::Mdr1d(lines), Surface::SelfAffine(surface)) = (numerics, surface) else {
            return numerics.model();
        };
        let planned = self.lines.get_or_init(|| Ensemble::new(surface, lines.elements).ok().map(Arc::new));
        match planned {
            Some(ensemble) => Arc::<Ensemble>::clone(ensemble),
            // The model says why it refuses the surface.
            None => numerics.model(),
        }
    }
}
