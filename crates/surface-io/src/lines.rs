//! Lines of text that are written.

use std::fmt::{self, Write as _};
/// Text that grows.
pub(crate) struct Lines {
    pub(crate) text: String,
}

impl Lines {
    pub(crate) fn new(mut head: String, more: usize) -> Self {
        head.reserve(more);
        Self { text: head }
    }

    pub(crate) fn add(&mut self, arguments: fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.text.write_fmt(arguments);
    }
}
