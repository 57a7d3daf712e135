//! Binary formats of instruments and programs, each told by its first bytes.

mod gwy;
mod nanoscope;

use crate::npy;
use crate::reader::Reader;

/// All readers; no file is recognised by two.
pub(crate) const READERS: &[Reader] = &[npy::READER, gwy::READER, nanoscope::READER];
