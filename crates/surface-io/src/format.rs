//! Formats of files.

use std::fmt;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// NumPy's array file.
    Npy,
    /// Heights as text, one row per line.
    Text,
    /// Points x, y, z as text, one per line, in any order.
    Xyz,
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Npy => "NPY",
            Self::Text => "a text matrix",
            Self::Xyz => "XYZ points",
        })
    }
}
