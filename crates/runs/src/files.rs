//! Files written whole or not at all: those of `surface_io`, with this crate's errors.

use crate::error::Result;
use std::path::Path;

/// Creates a directory and those above it.
///
/// # Errors
/// [`crate::Error::File`] where the system refuses.
pub fn create_directory(path: &Path) -> Result<()> {
    Ok(surface_io::files::create_directory(path)?)
}

/// Reads a file of at most `largest` bytes. A pipe or a device, which may never end, is refused unread, and so is a longer file.
///
/// # Errors
/// [`crate::Error::File`] where the system refuses, [`crate::Error::Content`] for what is refused here.
pub fn read(path: &Path, largest: u64) -> Result<Vec<u8>> {
    Ok(surface_io::files::read(path, largest)?)
}

/// Writes a file whole: into a temporary name beside it, then renamed over it. A failure leaves no file, and an old one as it was.
///
/// # Errors
/// [`crate::Error::File`] where the system refuses (permission, full disk).
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<()> {
    Ok(surface_io::files::write_whole(path, bytes)?)
}

/// Removes what interrupted runs left half-written in a directory; files of a running process stay.
///
/// # Errors
/// [`crate::Error::File`] when the directory cannot be read.
pub fn clean(directory: &Path) -> Result<()> {
    Ok(surface_io::files::clean(directory)?)
}
