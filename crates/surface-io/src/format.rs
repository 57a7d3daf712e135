//! Formats of files.

use std::fmt;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Format {
    /// NumPy's array file.
    Npy,
    /// Heights as text, one row per line.
    Text,
    /// Points x, y, z as text, one per line, in any order.
    Xyz,
    /// Points x, z of a profile as text, one per line: a body that is uniform along y.
    Profile,
    /// Gwyddion's own file.
    Gwy,
    /// Nanoscope, of Digital Instruments, Veeco and Bruker.
    Nanoscope,
    /// HDF5, data sets of any program.
    Hdf5,
    /// Grey images of numbers.
    Tiff,
    /// Surface data file of ISO 25178-71.
    Sdf,
    /// Digital Surf's (MountainsMap) file.
    Sur,
    /// The XML container of ISO 25178-72.
    X3p,
    /// Classic NetCDF as contact.engineering writes it.
    NetCdf,
    /// AL3D, of Alicona.
    Al3d,
    /// MetroPro .dat, of Zygo.
    MetroPro,
    /// OPD, of Wyko, Veeco and Bruker.
    Opd,
    /// PLu, of Sensofar.
    Plu,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 16] = [
        Self::Npy,
        Self::Text,
        Self::Xyz,
        Self::Profile,
        Self::Gwy,
        Self::Nanoscope,
        Self::Hdf5,
        Self::Tiff,
        Self::Sdf,
        Self::Sur,
        Self::X3p,
        Self::NetCdf,
        Self::Al3d,
        Self::MetroPro,
        Self::Opd,
        Self::Plu,
    ];

    /// The word that stands for it in scenes and on command lines.
    pub fn word(self) -> &'static str {
        self.words().0
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Npy => ("npy", "NPY"),
            Self::Text => ("text", "a text matrix"),
            Self::Xyz => ("xyz", "XYZ points"),
            Self::Profile => ("profile", "a profile x, z"),
            Self::Gwy => ("gwy", "GWY (Gwyddion)"),
            Self::Nanoscope => ("nanoscope", "Nanoscope"),
            Self::Hdf5 => ("hdf5", "HDF5"),
            Self::Tiff => ("tiff", "TIFF"),
            Self::Sdf => ("sdf", "SDF (ISO 25178-71)"),
            Self::Sur => ("sur", "SUR (Digital Surf)"),
            Self::X3p => ("x3p", "X3P (ISO 25178-72)"),
            Self::NetCdf => ("netcdf", "NetCDF-3"),
            Self::Al3d => ("al3d", "AL3D (Alicona)"),
            Self::MetroPro => ("metropro", "MetroPro (Zygo)"),
            Self::Opd => ("opd", "OPD (Wyko)"),
            Self::Plu => ("plu", "PLu (Sensofar)"),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words().1)
    }
}
