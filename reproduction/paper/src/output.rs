//! Pictures and arrays into files.

use runs::{Error, Result, files};
use std::path::{Path, PathBuf};

/// Writes the files of a picture into a directory.
///
/// # Errors
/// A picture that cannot be drawn, files that cannot be written.
pub(crate) fn save(drawn: plots::Result<[(String, Vec<u8>); 2]>, directory: &Path) -> Result<Vec<PathBuf>> {
    Ok(files::write_all(directory, drawn.map_err(refused)?)?)
}

/// A picture that cannot be drawn, as an error of a command.
pub(crate) fn refused(error: plots::Error) -> Error {
    Error::content(Path::new(&error.picture), error.reason)
}

/// Writes numbers as an NPY array of the given shape (float64, row-major), whole or not at all.
///
/// # Errors
/// A shape of another number of values, a file that cannot be written.
pub(crate) fn write_npy(path: &Path, shape: &[usize], values: &[f64]) -> Result<()> {
    let bytes = surface_io::npy(shape, values).map_err(|e| Error::content(path, e.to_string()))?;
    Ok(files::write_whole(path, &bytes)?)
}
