//! Files that are written whole or not at all, and text out of files that is safe to show in a terminal.
//!
//! A file is first written to a temporary file in the same directory, flushed to the disk, and then renamed
//! ([`write_whole`]); [`clean`] removes the temporary files of killed processes. A file is read only if its
//! length is known before memory is allocated ([`read`]). Names and texts that come out of files are shown
//! through [`Escaping`].
//!
//! # What it does not do
//!
//! It knows no format of any file.

mod error;
mod escape;
mod whole;

pub use error::{Error, Result};
pub use escape::{Escaping, escaped};
pub use whole::{clean, create_directory, read, write_whole};
