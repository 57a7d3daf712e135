//! Models written by the user, under names that scenes may use.

use crate::models::ModelRecord;
use crate::scenes::read::{Error, RegisteredModel, Result};
use contact_model::ContactModel;
use std::sync::Arc;

/// Models written by the user, which scenes can name in the same way as those of the library.
///
/// A registered model is configured in code: `[models.NAME]` has no keys for it. It receives the surface as
/// the scene describes it. The model itself generates a random surface from the seed; sums of a random
/// surface and a body are not passed on. It solves each of the scene's random surfaces, and its states are
/// stored under its name and version: **change the version with anything that changes a result**, or results
/// stored by an earlier version of the model are reused.
///
/// ```
/// use fractal_contact::scenes::{Plan, Registry, SceneFile};
/// // A model of the library under a name of its own stands for one of the user's.
/// struct Mine;
/// impl contact_model::ContactModel for Mine {
///     fn name(&self) -> &'static str {
///         "mine"
///     }
///     fn sources(&self) -> &'static [contact_model::Source] {
///         &[]
///     }
///     fn abilities(&self) -> contact_model::Abilities {
///         analytic::Hertz.abilities()
///     }
///     fn prepare(
///         &self,
///         scene: &contact_model::Scene,
///         seed: u64,
///     ) -> contact_model::Result<Box<dyn contact_model::PreparedContact>> {
///         analytic::Hertz.prepare(scene, seed)
///     }
/// }
/// let registry = Registry::new().with(Mine, "1")?;
/// let text = "[scene]\nunits = \"none\"\nmodels = [\"hertz\", \"mine\"]\ncontact_modulus = 1\nforce = 1\n\
///             [scene.body]\nkind = \"sphere\"\nradius = 1\nside = 4\n";
/// let scene = SceneFile::parse_with("mine.toml".as_ref(), text.into(), &registry)?;
/// assert_eq!(Plan::new(&scene)?.models[1].name, "mine");
/// assert!(SceneFile::parse("mine.toml".as_ref(), text.into()).is_err());
/// # Ok::<(), fractal_contact::scenes::Error>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Registry {
    models: Vec<RegisteredModel>,
}

impl Registry {
    /// No models.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a model under its own name.
    ///
    /// # Errors
    /// [`Error::Argument`] for a name that the library or the registry has already, one with other characters than
    /// `a` to `z`, digits and `_` (it is part of names of files), and an empty version.
    pub fn with(self, model: impl ContactModel + 'static, version: impl Into<String>) -> Result<Self> {
        let name = model.name();
        self.added(RegisteredModel::new(name, version.into(), Arc::new(model)))
    }

    fn added(mut self, model: RegisteredModel) -> Result<Self> {
        let name = model.name();
        let refused = |reason: &str| {
            Err(Error::Argument {
                name: "name of a registered model",
                reason: format!("\"{name}\" {reason}"),
            })
        };
        let letter = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        if name.is_empty() || !name.chars().all(letter) {
            return refused("has other characters than a to z, 0 to 9 and _");
        }
        if model.version().is_empty() {
            return refused("has no version: give one, and another one whenever results change");
        }
        if ModelRecord::named(name).is_some() {
            return refused("is the name of a model of the library: choose another one");
        }
        if self.models.iter().any(|m| m.name() == name) {
            return refused("is registered twice");
        }
        self.models.push(model);
        Ok(self)
    }

    /// The models in the order added; in a scene built in code each is a
    /// [`crate::scenes::Numerics::Registered`].
    pub fn models(&self) -> &[RegisteredModel] {
        &self.models
    }
}
