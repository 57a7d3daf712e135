//! How the format of a file is told from its content and its name.

use crate::error::ContentError;
use crate::format::Format;
use std::path::Path;

/// First bytes of an NPY file.
pub(crate) const NPY: &[u8] = b"\x93NUMPY";

/// Bytes that [`Format::detect`] wants to see.
pub(crate) const SNIFF: usize = 16;

/// First bytes of files that people try, with what they are and what to do.
const FOREIGN: [(&[u8], &str, &str); 9] = [
    (b"\x89HDF", "an HDF5 file", "export the data set of heights as NPY"),
    (b"PK\x03\x04", "an archive (NPZ, X3P, XLSX)", "take the array out of it and save it as NPY"),
    (b"GWYP", "a Gwyddion file", "export the channel as text matrix, with the header"),
    (b"\x89PNG", "a PNG picture", "grey values are no heights; export the heights as text or NPY"),
    (b"II*\0", "a TIFF picture", "export the heights as text or NPY"),
    (b"MM\0*", "a TIFF picture", "export the heights as text or NPY"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"\xff\xfe", "text in UTF-16", "save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16", "save it as UTF-8"),
];

impl Format {
    /// The format by request, the first bytes and the name's ending; `None` for text that may be a
    /// matrix or points.
    pub(crate) fn detect(
        requested: Option<Self>,
        path: &Path,
        start: &[u8],
    ) -> Result<Option<Self>, ContentError> {
        if start.is_empty() {
            return Err(ContentError::Empty);
        }
        let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let by_name = match ending.as_deref() {
            Some("npy") => Some(Self::Npy),
            Some("xyz") => Some(Self::Xyz),
            _ => None,
        };
        let expected = requested.or(by_name);
        if start.starts_with(NPY) {
            return match expected {
                None | Some(Self::Npy) => Ok(Some(Self::Npy)),
                Some(expected) => Err(ContentError::NotOfFormat { expected, found: Self::Npy }),
            };
        }
        if let Some((_, what, remedy)) = FOREIGN.iter().find(|(magic, ..)| start.starts_with(magic)) {
            return Err(ContentError::Foreign { what, remedy });
        }
        if expected == Some(Self::Npy) {
            return Err(ContentError::Header {
                offset: 0,
                expected: "the bytes 93 4e 55 4d 50 59 of an NPY file",
            });
        }
        Ok(expected)
    }
}
