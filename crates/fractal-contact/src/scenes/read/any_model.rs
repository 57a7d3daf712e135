//! A model behind one of the two traits: of the library, or of the user's own.

use contact_model::{ContactModel, HistoryModel, Source};
use std::fmt;
use std::sync::Arc;

/// A model behind one of the two traits.
#[allow(missing_debug_implementations)] // Trait objects.
#[derive(Clone)]
pub enum AnyModel {
    /// It answers one load, whatever came before.
    Contact(Arc<dyn ContactModel>),
    /// It follows a path.
    History(Arc<dyn HistoryModel>),
}

impl AnyModel {
    /// Its sources.
    pub fn sources(&self) -> &'static [Source] {
        match self {
            Self::Contact(model) => model.sources(),
            Self::History(model) => model.sources(),
        }
    }
}

/// A model of a [`crate::scenes::Registry`]. Two of one name and version are the same.
#[derive(Clone)]
pub struct RegisteredModel {
    name: &'static str,
    version: String,
    model: AnyModel,
}

impl RegisteredModel {
    pub(crate) fn new(name: &'static str, version: String, model: AnyModel) -> Self {
        Self { name, version, model }
    }

    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// What was given when it was added.
    pub fn version(&self) -> &str {
        &self.version
    }

    pub(crate) fn model(&self) -> AnyModel {
        self.model.clone()
    }

    pub(crate) fn is_history(&self) -> bool {
        matches!(self.model, AnyModel::History(_))
    }
}

impl PartialEq for RegisteredModel {
    fn eq(&self, other: &Self) -> bool {
        (self.name, &self.version, self.is_history()) == (other.name, &other.version, other.is_history())
    }
}

// Part of the key of stored results.
impl fmt::Debug for RegisteredModel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.name, self.version)
    }
}
