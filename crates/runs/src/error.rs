//! The one error type of this crate; it names the place and the expected value.

use crate::files;
use std::fmt;
use std::io;
use std::path::Path;

/// Result of everything in this crate.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a command and its files.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter that makes no sense.
    #[error("{name} = {value}: expected {expected}")]
    Parameter {
        /// The parameter; programs call their flags the same.
        name: &'static str,
        /// The value found.
        value: String,
        /// What was expected instead.
        expected: String,
    },
    /// A file cannot be read or written, or does not hold what it should.
    #[error(transparent)]
    File(#[from] files::Error),
    /// A model or an analysis refused its numbers.
    #[error("{what}: {source}")]
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
        Self::File(files::Error::content(path, reason))
    }

    /// The operating system refused `action` on `path`; for `map_err`.
    pub fn file(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let refused = files::Error::system(action, path);
        move |source| Self::File(refused(source))
    }

    /// A model or an analysis refused its numbers while `what` was computed; for `map_err`.
    pub fn model(what: impl Into<String>) -> impl FnOnce(contact_model::Error) -> Self {
        let what = what.into();
        move |source| Self::Model { what, source }
    }
}
