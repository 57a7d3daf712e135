//! The file that an error is about.

use crate::error::{ContentError, Error};
use crate::format::Format;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The subject of errors: a file, and the format as which it is read.
#[derive(Debug, Clone)]
pub(crate) struct Subject(Arc<(PathBuf, Option<Format>)>);

impl Subject {
    pub(crate) fn new(path: &Path, format: Option<Format>) -> Self {
        Self(Arc::new((path.to_owned(), format)))
    }

    /// An error about this file.
    pub(crate) fn content(&self, problem: ContentError) -> Error {
        Error::content(&self.0.0)(problem)
    }

    /// An error about what stands at an offset of a binary file.
    pub(crate) fn wrong(&self, offset: u64, expected: impl Into<String>) -> Error {
        let format = self.0.1.unwrap_or(Format::Text);
        self.content(ContentError::Binary { format, offset, expected: expected.into() })
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0.0
    }
}
