//! The one error type of this crate: where, and what was expected.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Result of everything in this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a command and its files.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// A parameter that makes no sense.
    Parameter {
        /// The parameter; programs call their flags the same.
        name: &'static str,
        /// The value found.
        value: String,
        /// What was expected instead.
        expected: String,
    },
    /// The operating system refused to read or write.
    File {
        /// What was being done (`write`, `create`, ...).
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A file does not hold what it should.
    Content {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        reason: String,
    },
    /// A model or an analysis refused its numbers.
    Model {
        /// What was being computed.
        what: String,
        /// The reason, with the value.
        source: contact_model::Error,
    },
}

impl Error {
    /// A parameter that makes no sense.
    pub fn parameter(name: &'static str, value: impl fmt::Display, expected: impl Into<String>) -> Self {
        let mut value = value.to_string();
        // A number beyond 1e20 would be a row of zeros.
        if let (true, Ok(number)) = (value.len() > 20, value.parse::<f64>()) {
            value = format!("{number:e}");
        }
        Self::Parameter { name, value, expected: expected.into() }
    }

    /// A file that does not hold what it should.
    pub fn content(path: &Path, reason: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), reason: reason.into() }
    }

    /// The operating system refused `action` on `path`; for `map_err`.
    pub fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::File { action, path, source }
    }

    /// A model or an analysis refused its numbers while `what` was computed; for `map_err`.
    pub fn model(what: impl Into<String>) -> impl FnOnce(contact_model::Error) -> Self {
        let what = what.into();
        move |source| Self::Model { what, source }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Parameter { name, value, expected } => write!(f, "{name} = {value}: expected {expected}"),
            Self::File { action, path, source } => write!(f, "cannot {action} {}: {source}", path.display()),
            Self::Content { path, reason } => write!(f, "{}: {reason}", path.display()),
            Self::Model { what, source } => write!(f, "{what}: {source}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::File { source, .. } => Some(source),
            Self::Model { source, .. } => Some(source),
            Self::Parameter { .. } | Self::Content { .. } => None,
        }
    }
}

impl From<surface_io::Error> for Error {
    fn from(error: surface_io::Error) -> Self {
        match error {
            surface_io::Error::System { action, path, source } => Self::File { action, path, source },
            surface_io::Error::Content { path, problem } => {
                Self::Content { path, reason: problem.to_string() }
            }
            other => Self::Content { path: std::path::PathBuf::new(), reason: other.to_string() },
        }
    }
}
