//! Models written by the user.

use contact_model::ContactModel;
use std::fmt;
use std::sync::Arc;

/// A model of a [`crate::scenes::Registry`]. Two models with the same name and version are equal.
#[derive(Clone)]
pub struct RegisteredModel {
    name: &'static str,
    version: String,
    model: Arc<dyn ContactModel>,
}

impl RegisteredModel {
    pub(crate) fn new(name: &'static str, version: String, model: Arc<dyn ContactModel>) -> Self {
        Self { name, version, model }
    }

    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The version that was given when it was added.
    pub fn version(&self) -> &str {
        &self.version
    }

    pub(crate) fn model(&self) -> Arc<dyn ContactModel> {
        Arc::clone(&self.model)
    }
}

impl PartialEq for RegisteredModel {
    fn eq(&self, other: &Self) -> bool {
        (self.name, &self.version) == (other.name, &other.version)
    }
}

// Part of the key of stored results.
impl fmt::Debug for RegisteredModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.version)
    }
}
