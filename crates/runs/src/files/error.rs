//! Errors of files, with the path of the file.

use std::io;
use std::path::{Path, PathBuf};

/// Result type of everything that reads or writes.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused.
    #[error("cannot {action} {}: {source}", .path.display())]
    System {
        /// The action that it refused, such as `open`, `read` or `write`.
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A file does not hold what it should, or cannot hold what is asked of it.
    #[error("{}: {reason}", .path.display())]
    Content {
        /// Where.
        path: PathBuf,
        /// The reason, in words.
        reason: String,
    },
}

impl Error {
    /// The operating system refused `action` on `path`; for `map_err`.
    pub fn system(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::System { action, path, source }
    }

    /// A file that does not hold what it should.
    pub fn content(path: &Path, reason: impl Into<String>) -> Self {
        Self::Content { path: path.to_owned(), reason: reason.into() }
    }
}
