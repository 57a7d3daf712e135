//! Small valid files of every binary format, written here byte by byte from the description of the format.

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
mod sdf;
mod sur;
mod tiff;
mod tmd;
mod wsxm;
pub mod x3p;

/// A small file, and what is in it.
#[derive(Debug, Clone)]
pub struct Small {
    /// Word of the format, and what is special about this file.
    pub name: &'static str,
    pub bytes: Vec<u8>,
    /// Columns and rows of the channel `number`.
    pub number: usize,
    pub shape: [usize; 2],
    /// Sides in metres; `None` where the file does not say it.
    pub size: Option<[f64; 2]>,
    /// Heights in metres, or as they stand where there is no unit; row by row, NaN where undefined.
    pub heights: Vec<f64>,
    /// Whether heights are compressed: a reader may hold a thousand times the file's length.
    pub compressed: bool,
}

/// All of them, two at least for each format: with undefined points or another type of numbers, where it has
/// such.
pub fn all() -> Vec<Small> {
    let of_all = [
        al3d::files(),
        metropro::files(),
        opd::files(),
        plu::files(),
        gwy::files(),
        hdf5::files(),
        nanoscope::files(),
        netcdf::files(),
        sdf::files(),
        sur::files(),
        tiff::files(),
        ibw::files(),
        mi::files(),
        nid::files(),
        wsxm::files(),
        x3p::files(),
        bcr::files(),
        frt::files(),
        gsf::files(),
        mat::files(),
        nms::files(),
        opdx::files(),
        tmd::files(),
    ];
    of_all.into_iter().flatten().collect()
}
