//! Binary formats of instruments and programs, each told by its first bytes.

mod gwy;
mod hdf5;
mod nanoscope;
mod tiff;

pub use hdf5::hdf5;

use crate::npy;
use crate::reader::Reader;

/// All readers; no file is recognised by two.
pub(crate) const READERS: &[Reader] =
    &[npy::READER, gwy::READER, nanoscope::READER, hdf5::READER, tiff::READER];
