//! Formats of files.

use crate::keyword::keywords;
use std::fmt;

/// What to do with a file of another program.
pub(crate) const EXPORT: &str = "not read; export X3P, SDF, GWY or text with that program";

/// Declares the formats: each with its word and its name.
macro_rules! formats {
    ($($(#[$about:meta])* $name:ident = $word:literal, $shown:literal;)*) => {
        keywords! {
            /// A format that is read.
            #[derive(Hash)]
            #[non_exhaustive]
            Format: "format";
            $($(#[$about])* $name = $word,)*
        }

        impl fmt::Display for Format {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(match self { $(Self::$name => $shown,)* })
            }
        }
    };
}

formats! {
    /// NumPy's array file.
    Npy = "npy", "NPY";
    /// Heights as text, one row per line.
    Text = "text", "a text matrix";
    /// Points x, y, z as text, one per line, in any order.
    Xyz = "xyz", "XYZ points";
    /// Points x, z of a profile as text, one per line: a body that is uniform along y.
    Profile = "profile", "a profile x, z";
    /// Gwyddion's own file.
    Gwy = "gwy", "GWY (Gwyddion)";
    /// Nanoscope, of Digital Instruments, Veeco and Bruker.
    Nanoscope = "nanoscope", "Nanoscope";
    /// HDF5, data sets of any program.
    Hdf5 = "hdf5", "HDF5";
    /// Grey images of numbers.
    Tiff = "tiff", "TIFF";
    /// Surface data file of ISO 25178-71.
    Sdf = "sdf", "SDF (ISO 25178-71)";
    /// Digital Surf's (MountainsMap) file.
    Sur = "sur", "SUR (Digital Surf)";
    /// The XML container of ISO 25178-72.
    X3p = "x3p", "X3P (ISO 25178-72)";
    /// Classic NetCDF as contact.engineering writes it.
    NetCdf = "netcdf", "NetCDF-3";
    /// AL3D, of Alicona.
    Al3d = "al3d", "AL3D (Alicona)";
    /// MetroPro .dat, of Zygo.
    MetroPro = "metropro", "MetroPro (Zygo)";
    /// OPD, of Wyko, Veeco and Bruker.
    Opd = "opd", "OPD (Wyko)";
    /// PLu, of Sensofar.
    Plu = "plu", "PLu (Sensofar)";
    /// Points as MetroPro exports them.
    ZygoXyz = "zygo_xyz", "Zygo XYZ";
    /// Igor binary wave, of Asylum Research and others.
    Ibw = "ibw", "IBW (Igor)";
    /// NID, of Nanosurf.
    Nid = "nid", "NID (Nanosurf)";
    /// WSxM's images (STP, TOP).
    Wsxm = "wsxm", "WSxM";
    /// MI, of Molecular Imaging, Agilent and Keysight.
    Mi = "mi", "MI (Molecular Imaging)";
    /// BCR-STM and BCRF, of Image Metrology.
    Bcr = "bcr", "BCR-STM (Image Metrology)";
    /// FRT, of the profilers MicroProf.
    Frt = "frt", "FRT (MicroProf)";
    /// Gwyddion's simple field.
    Gsf = "gsf", "GSF (Gwyddion simple field)";
    /// MATLAB version 5, matrices of any program; version 7.3 is HDF5.
    Mat = "mat", "MATLAB";
    /// NMS, of Nanofocus.
    Nms = "nms", "NMS (Nanofocus)";
    /// OPDx, of the profilers Dektak.
    Opdx = "opdx", "OPDx (Dektak)";
    /// TMD, of TrueMap and GelSight.
    Tmd = "tmd", "TMD (TrueMap)";
}
