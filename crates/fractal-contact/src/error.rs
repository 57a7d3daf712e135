//! The one error type of this crate.

use crate::diagnostic::Diagnostic;
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Result of everything in this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a scene and its results.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A mistake in a scene.
    Scene(Box<Diagnostic>),
    /// The operating system refused to read or write.
    File {
        /// What was being done.
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A model refused its numbers.
    Model {
        /// What was being computed.
        what: String,
        /// The reason, with the value.
        source: contact_model::Error,
    },
    /// A surface cannot be read or written.
    Surface(surface_io::Error),
    /// A table or a picture could not be made.
    Figures(figures::Error),
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

    pub(crate) fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }

    pub(crate) fn model(what: impl Into<String>) -> impl FnOnce(contact_model::Error) -> Self {
        let what = what.into();
        move |source| Self::Model { what, source }
    }
}

impl From<Diagnostic> for Error {
    fn from(diagnostic: Diagnostic) -> Self {
        Self::Scene(Box::new(diagnostic))
    }
}

impl From<figures::Error> for Error {
    fn from(error: figures::Error) -> Self {
        Self::Figures(error)
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Scene(diagnostic) => write!(f, "{diagnostic}"),
            Self::File { action, path, source } => {
                write!(f, "error: cannot {action} {}: {source}", path.display())
            }
            Self::Model { what, source } => write!(f, "error: {what}: {source}"),
            Self::Surface(error) => write!(f, "error: {error}"),
            Self::Figures(error) => write!(f, "error: {error}"),
            Self::Argument { name, reason } => write!(f, "error: {name}: {reason}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Scene(diagnostic) => Some(diagnostic),
            Self::File { source, .. } => Some(source),
            Self::Model { source, .. } => Some(source),
            Self::Surface(error) => Some(error),
            Self::Figures(error) => Some(error),
            Self::Argument { .. } => None,
        }
    }
}
