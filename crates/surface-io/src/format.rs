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
    /// Gwyddion's own file.
    Gwy,
    /// Nanoscope, of Digital Instruments, Veeco and Bruker.
    Nanoscope,
    /// HDF5, data sets of any program.
    Hdf5,
    /// Grey images of numbers.
    Tiff,
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 7] =
        [Self::Npy, Self::Text, Self::Xyz, Self::Gwy, Self::Nanoscope, Self::Hdf5, Self::Tiff];

    /// The word that stands for it in scenes and on command lines.
    pub fn word(self) -> &'static str {
        self.words().0
    }

    fn words(self) -> (&'static str, &'static str) {
        match self {
            Self::Npy => ("npy", "NPY"),
            Self::Text => ("text", "a text matrix"),
            Self::Xyz => ("xyz", "XYZ points"),
            Self::Gwy => ("gwy", "GWY (Gwyddion)"),
            Self::Nanoscope => ("nanoscope", "Nanoscope"),
            Self::Hdf5 => ("hdf5", "HDF5"),
            Self::Tiff => ("tiff", "TIFF"),
        }
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.words().1)
    }
}
