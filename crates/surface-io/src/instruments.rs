//! Formats of instruments and programs, each recognised by its content.

mod al3d;
mod bcr;
mod frt;
mod gsf;
mod gwy;
mod hdf5;
mod ibw;
mod mat;
mod metropro;
mod mi;
mod nanoscope;
mod netcdf;
mod nid;
mod nms;
mod opd;
mod opdx;
mod plu;
mod prelude;
mod sdf;
mod sur;
mod tiff;
mod tmd;
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
    bcr::READER,
    frt::READER,
    gsf::READER,
    gwy::READER,
    hdf5::READER,
    ibw::READER,
    mat::READER,
    metropro::READER,
    mi::READER,
    nanoscope::READER,
    netcdf::READER,
    nid::READER,
    nms::READER,
    opd::READER,
    opdx::READER,
    plu::READER,
    sdf::READER,
    sur::READER,
    tiff::READER,
    tmd::READER,
    wsxm::READER,
    x3p::READER,
    zygo_xyz::READER,
];

#[cfg(test)]
mod tests;
