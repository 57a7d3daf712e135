//! Detection of the format of a file from its content and its name.

use crate::error::ContentError;
use crate::format::{EXPORT, Format};
use crate::instruments::READERS;
use std::path::Path;

const PICTURE: &str = "grey values are no heights; export the heights as text or NPY";
const SPREADSHEET: &str = "save the sheet as CSV";

/// First bytes of files that people try, with what they are and what to do.
const FOREIGN: [(&[u8], &str, &str); 37] = [
    (b"PK\x03\x04", "an archive (NPZ, XLSX, X3P)", "take the file of heights out of it"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"7z\xbc\xaf", "a 7z archive", "unpack it first"),
    (b"Rar!", "a RAR archive", "unpack it first"),
    (b"BZh", "a bzip2 archive", "unpack it first"),
    (b"\xfd7zXZ", "an xz archive", "unpack it first"),
    (b"\xff\xfe", "text in UTF-16", "save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16", "save it as UTF-8"),
    (b"\x89PNG", "a PNG picture", PICTURE),
    (b"\xff\xd8\xff", "a JPEG picture", PICTURE),
    (b"GIF8", "a GIF picture", PICTURE),
    (b"\0\0\0\x0cjP  ", "a JPEG 2000 picture", PICTURE),
    (b"RIFF", "a WebP picture or a film", PICTURE),
    (b"%PDF", "a PDF page", "its pictures are no heights; export the heights as text or NPY"),
    (b"\xd0\xcf\x11\xe0", "an old workbook of a spreadsheet, or a file of Olympus or Zeiss", SPREADSHEET),
    (b"<?xml", "an XML document", EXPORT),
    (b"<html", "a page of the web", "save the file itself"),
    (b"<!DOCTYPE", "a page of the web", "save the file itself"),
    (b"VK3_", "a VK file of Keyence's microscopes", EXPORT),
    (b"VK4_", "a VK4 file of Keyence's microscopes", "export its CSV of heights"),
    (b"VK6", "a VK6 file of Keyence's microscopes", "export its CSV of heights"),
    (b"KPK0", "a file of Keyence's profilers", "export its CSV of heights"),
    (b"DSAA", "a grid of Surfer as text", "export XYZ points"),
    (b"DSBB", "a grid of Surfer", "export XYZ points"),
    (b"DSRB", "a grid of Surfer", "export XYZ points"),
    (b"Zygo ASCII Data File", "Zygo's text of phases", "export XYZ points (Zygo XYZ) or DATX"),
    (b":NANONIS_VERSION:", "a Nanonis SXM file", EXPORT),
    (b"S\0T\0i\0M\0a\0g\0e\0", "an RHK SM4 file", EXPORT),
    (b"[Paramco32]", "a Createc file", EXPORT),
    (b"[Parameter]", "a Createc file", EXPORT),
    (b"FLAT0100", "a flat file of Omicron's Matrix", EXPORT),
    (b"ONTMATRX0101", "a file of Omicron's Matrix", EXPORT),
    (b"\x01\xb0\x93\xff", "an MDT file of NT-MDT", EXPORT),
    (b"\x0e\x03\x13\x01", "an HDF4 file", "convert it to HDF5 (h4toh5)"),
    (b"SIMPLE  =", "a FITS image", "export NPY (astropy.io.fits)"),
    (b"ply\n", "a mesh (PLY)", "a mesh is no map of heights; export XYZ points of a grid"),
    (b"# vtk DataFile", "a VTK file", "export NPY or text"),
];

/// The format by request, the first bytes and the name's ending; `None` for text that may be a matrix or
/// points.
pub(crate) fn detect(
    requested: Option<Format>,
    path: &Path,
    start: &[u8],
    length: u64,
) -> Result<Option<Format>, ContentError> {
    if start.is_empty() {
        return Err(ContentError::Empty);
    }
    let found = READERS.iter().find(|reader| (reader.recognises)(start, length)).map(|reader| reader.format);
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let by_name = match ending.as_deref() {
        Some("npy") => Some(Format::Npy),
        // A word for points of any program.
        Some("xyz") if found != Some(Format::ZygoXyz) => Some(Format::Xyz),
        _ => None,
    };
    let expected = requested.or(by_name);
    match (expected, found) {
        (Some(expected), Some(found)) if expected != found => {
            Err(foreign(start).unwrap_or(ContentError::NotOfFormat { expected, found }))
        }
        (_, Some(found)) => Ok(Some(found)),
        (expected, None) => match (foreign(start), expected) {
            (Some(error), _) => Err(error),
            (None, None | Some(Format::Text | Format::Xyz | Format::Profile)) => Ok(expected),
            (None, Some(expected)) => Err(ContentError::Other { expected }),
        },
    }
}

/// An archive may be an X3P file or another one: only its members tell.
fn foreign(start: &[u8]) -> Option<ContentError> {
    let found = FOREIGN.iter().find(|(magic, ..)| start.starts_with(magic));
    found.map(|(_, what, remedy)| ContentError::Foreign { what, remedy })
}
