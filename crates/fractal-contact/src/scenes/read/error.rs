//! The one error type of this crate.

use crate::scenes::read::diagnostic::Diagnostic;
use std::fmt;

/// Result of everything in this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a scene and its results.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A mistake in a scene.
    Scene(Box<Diagnostic>),
    /// A surface cannot be read or written.
    Surface(surface_io::Error),
    /// A model refused its numbers, or a file could not be read or written.
    Run(runs::Error),
    /// An argument of the command line.
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

impl From<runs::Error> for Error {
    fn from(error: runs::Error) -> Self {
        Self::Run(error)
    }
}

impl From<runs::files::Error> for Error {
    fn from(error: runs::files::Error) -> Self {
        Self::Run(error.into())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) => write!(f, "{diagnostic}"),
            Self::Surface(error) => write!(f, "error: {error}"),
            Self::Run(error) => write!(f, "error: {error}"),
            Self::Argument { name, reason } => write!(f, "error: {name}: {reason}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Scene(diagnostic) => Some(diagnostic),
            Self::Surface(error) => Some(error),
            Self::Run(error) => Some(error),
            Self::Argument { .. } => None,
        }
    }
}
