//! Binary formats of instruments and programs, each told by its first bytes.

mod al3d;
mod gwy;
mod hdf5;
mod ibw;
mod metropro;
mod mi;
mod nanoscope;
mod netcdf;
mod nid;
mod opd;
mod plu;
mod sdf;
mod sur;
mod tiff;
mod wsxm;
mod x3p;
mod zygo_xyz;

pub use gwy::gwy;
pub use hdf5::hdf5;
pub use netcdf::netcdf;
pub use x3p::x3p;

use crate::npy;
use crate::reader::Reader;

/// All readers; no file is recognised by two.
pub(crate) const READERS: &[Reader] = &[
    npy::READER,
    al3d::READER,
    gwy::READER,
    hdf5::READER,
    ibw::READER,
    metropro::READER,
    mi::READER,
    nanoscope::READER,
    netcdf::READER,
    nid::READER,
    opd::READER,
    plu::READER,
    sdf::READER,
    sur::READER,
    tiff::READER,
    wsxm::READER,
    x3p::READER,
    zygo_xyz::READER,
];
