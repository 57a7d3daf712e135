//! How the format of a file is told from its content and its name.

use crate::error::ContentError;
use crate::format::Format;
use crate::instruments::READERS;
use std::path::Path;

/// First bytes of files that people try, with what they are and what to do.
const FOREIGN: [(&[u8], &str, &str); 6] = [
    (b"PK\x03\x04", "an archive (NPZ, XLSX, X3P)", "take the file of heights out of it"),
    (b"\x89PNG", "a PNG picture", "grey values are no heights; export the heights as text or NPY"),
    (b"\xff\xd8\xff", "a JPEG picture", "grey values are no heights; export the heights as text or NPY"),
    (b"\x1f\x8b", "a gzip archive", "unpack it first"),
    (b"\xff\xfe", "text in UTF-16", "save it as UTF-8"),
    (b"\xfe\xff", "text in UTF-16", "save it as UTF-8"),
];

/// The format by request, the first bytes and the name's ending; `None` for text that may be a matrix or points.
pub(crate) fn detect(
    requested: Option<Format>,
    path: &Path,
    start: &[u8],
    length: u64,
) -> Result<Option<Format>, ContentError> {
    if start.is_empty() {
        return Err(ContentError::Empty);
    }
    let ending = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let by_name = match ending.as_deref() {
        Some("npy") => Some(Format::Npy),
        Some("xyz") => Some(Format::Xyz),
        _ => None,
    };
    let expected = requested.or(by_name);
    let found = READERS.iter().find(|reader| (reader.recognises)(start, length)).map(|reader| reader.format);
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
