//! Binary formats of instruments and programs, each told by its first bytes.

mod gwy;
mod netcdf;
mod sdf;
mod sur;
mod x3p;

pub use gwy::gwy;
pub use netcdf::netcdf;
pub use x3p::x3p;

use crate::npy;
use crate::reader::Reader;

/// All readers; no file is recognised by two.
pub(crate) const READERS: &[Reader] =
    &[npy::READER, gwy::READER, sdf::READER, sur::READER, x3p::READER, netcdf::READER];
