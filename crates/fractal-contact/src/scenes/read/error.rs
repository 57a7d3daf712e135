//! The one error type of this crate.

use crate::scenes::read::Diagnostic;
use std::path::Path;

/// Result of everything in this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a scene and its results.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A mistake in a scene.
    #[error("{0}")]
    Scene(#[source] Box<Diagnostic>),
    /// A surface cannot be read or written.
    #[error("error: {0}")]
    Surface(#[from] surface_io::Error),
    /// A model refused its numbers, or a file could not be read or written.
    #[error("error: {0}")]
    Run(#[from] runs::Error),
    /// An argument of the command line.
    #[error("error: {name}: {reason}")]
    Argument {
        /// The argument.
        name: &'static str,
        /// What is wrong with it.
        reason: String,
    },
}

impl Error {
    /// Whether it is a mistake in a scene.
    pub fn is_scene(&self) -> bool {
        matches!(self, Self::Scene(_))
    }
}

impl From<Diagnostic> for Error {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Scene(Box::new(diagnostic))
    }
}

impl From<plots::Error> for Error {
    fn from(error: plots::Error) -> Self {
        Self::Run(runs::Error::content(Path::new(&error.picture), error.reason))
    }
}

impl From<runs::files::Error> for Error {
    fn from(error: runs::files::Error) -> Self {
        Self::Run(error.into())
    }
}
