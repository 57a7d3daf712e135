//! Formats of instruments and programs, each recognised by its content.

mod al3d;
mod bcr;
mod frt;
mod gsf;
mod gwy;
#[cfg(feature = "hdf5")]
mod hdf5;
mod ibw;
#[cfg(not(all(feature = "hdf5", feature = "tiff", feature = "x3p")))]
mod left_out;
mod magic;
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
#[cfg(feature = "tiff")]
mod tiff;
mod tmd;
mod wsxm;
#[cfg(feature = "x3p")]
mod x3p;
mod zygo_xyz;

pub use gwy::gwy;
#[cfg(feature = "hdf5")]
pub use hdf5::hdf5;
#[cfg(not(feature = "hdf5"))]
pub use left_out::hdf5;
#[cfg(not(feature = "x3p"))]
pub use left_out::x3p;
pub use netcdf::netcdf;
#[cfg(feature = "x3p")]
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
    #[cfg(feature = "hdf5")]
    hdf5::READER,
    #[cfg(not(feature = "hdf5"))]
    left_out::HDF5,
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
    #[cfg(feature = "tiff")]
    tiff::READER,
    #[cfg(not(feature = "tiff"))]
    left_out::TIFF,
    tmd::READER,
    wsxm::READER,
    #[cfg(feature = "x3p")]
    x3p::READER,
    #[cfg(not(feature = "x3p"))]
    left_out::X3P,
    zygo_xyz::READER,
];

#[cfg(test)]
mod tests;
