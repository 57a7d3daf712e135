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

    /// A height and what is behind it; `nan` at an undefined point.
    pub(crate) fn add_height(&mut self, height: f64, behind: char) {
        if height.is_finite() {
            self.add(format_args!("{height:e}{behind}"));
        } else {
            self.add(format_args!("nan{behind}"));
        }
    }

    pub(crate) fn add(&mut self, arguments: fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.text.write_fmt(arguments);
    }
}
