//! Files that are written whole or not at all.
//!
//! What is in a file if the program is killed while it writes? With [`write_whole`] either the old content or
//! the new one. The content is first written to a temporary file in the same directory and flushed to the
//! disk. The temporary file is then renamed. [`clean`] removes the temporary files of killed processes.
//!
//! [`read`] reads a file only if its length is known before memory is allocated.
//!
//! # What it does not do
//!
//! It knows no format of any file.

mod error;
mod whole;

pub use error::{Error, Result};
pub use whole::{clean, create_directory, read, write_all, write_whole};
