//! Files that are written whole or not at all, and text of files that commands no terminal.
//!
//! What is written goes into a temporary file beside its place, to the disk, and then gets its name
//! ([`write_whole`]); [`clean`] removes what a killed process left. What is read has a length that is known
//! before memory is asked for ([`read`]). Names and texts that come out of files are shown through
//! [`Escaping`].
//!
//! # What it does not do
//!
//! No format of any file.

mod error;
mod escape;
mod whole;

pub use error::{Error, Result};
pub use escape::{Escaping, escaped};
pub use whole::{clean, create_directory, read, write_whole};
