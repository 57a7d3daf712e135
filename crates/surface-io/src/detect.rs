//! Detection of the format of a file from its content and its name.

use crate::error::ContentError;
use crate::format::{EXPORT, Format};
use crate::instruments::READERS;
use std::path::Path;

const PICTURE: &str = "grey values are no heights; export the heights as text or NPY";
const SPREADSHEET: &str = "save the sheet as CSV";

const PACKED: &str = "unpack it first";
const CLOUD: &str = "a mesh or a cloud of points is no map of heights; export XYZ points of a grid";
const KEYENCE: &str = "export its CSV of heights";
const TABLE: &str = "export NPY or CSV";

/// A file of another kind: where its mark stands, the mark, what the file is and what to do.
struct Signature(usize, &'static [u8], &'static str, &'static str);

/// Marks of files that people try.
const FOREIGN: [Signature; 72] = [
    Signature(0, b"PK\x03\x04", "an archive (NPZ, XLSX, X3P)", "take the file of heights out of it"),
    Signature(0, b"\x1f\x8b", "a gzip archive", PACKED),
    Signature(0, b"7z\xbc\xaf\x27\x1c", "a 7z archive", PACKED),
    Signature(0, b"Rar!", "a RAR archive", PACKED),
    Signature(0, b"BZh", "a bzip2 archive", PACKED),
    Signature(0, b"\xfd7zXZ", "an xz archive", PACKED),
    Signature(0, b"\x28\xb5\x2f\xfd", "a Zstandard archive", PACKED),
    Signature(0, b"\x04\x22\x4d\x18", "an LZ4 archive", PACKED),
    Signature(257, b"ustar", "a tar archive", PACKED),
    Signature(0, b"\xff\xfe", "text in UTF-16", "save it as UTF-8"),
    Signature(0, b"\xfe\xff", "text in UTF-16", "save it as UTF-8"),
    Signature(0, b"\x89PNG", "a PNG picture", PICTURE),
    Signature(0, b"\xff\xd8\xff", "a JPEG picture", PICTURE),
    Signature(0, b"GIF8", "a GIF picture", PICTURE),
    Signature(0, b"\0\0\0\x0cjP  ", "a JPEG 2000 picture", PICTURE),
    Signature(4, b"ftyp", "a film or a HEIF picture", PICTURE),
    Signature(0, b"RIFF", "a WebP picture or a film", PICTURE),
    Signature(0, b"8BPS", "a Photoshop picture", PICTURE),
    Signature(6, b"\0\0\0\0\x36\0\0\0\x28\0\0\0", "a BMP picture", PICTURE),
    Signature(6, b"\0\0\0\0\x36\x04\0\0\x28\0\0\0", "a BMP picture", PICTURE),
    Signature(0, b"%PDF", "a PDF page", "its pictures are no heights; export the heights as text or NPY"),
    Signature(
        0,
        b"%!PS",
        "a PostScript page",
        "its pictures are no heights; export the heights as text or NPY",
    ),
    Signature(
        0,
        b"\xd0\xcf\x11\xe0",
        "an old workbook of a spreadsheet, or a file of Olympus or Zeiss",
        SPREADSHEET,
    ),
    Signature(0, b"<?xml", "an XML document", EXPORT),
    Signature(0, b"<html", "a page of the web", "save the file itself"),
    Signature(0, b"<!DOCTYPE", "a page of the web", "save the file itself"),
    Signature(0, b"PAR1", "a Parquet table", TABLE),
    Signature(0, b"ARROW1", "a Feather (Arrow) table", TABLE),
    Signature(0, b"FEA1", "a Feather table", TABLE),
    Signature(0, b"SQLite format 3\0", "an SQLite database", TABLE),
    Signature(0, b"VK3_", "a VK3 file of Keyence's microscopes", EXPORT),
    Signature(0, b"VK4_", "a VK4 file of Keyence's microscopes", KEYENCE),
    Signature(0, b"VK6", "a VK6 file of Keyence's microscopes", KEYENCE),
    Signature(0, b"VK7", "a VK7 file of Keyence's microscopes", KEYENCE),
    Signature(0, b"KPK0", "a ZON file of Keyence's profilers", KEYENCE),
    Signature(0, b"DSAA", "a grid of Surfer as text", "export XYZ points"),
    Signature(0, b"DSBB", "a grid of Surfer", "export XYZ points"),
    Signature(0, b"DSRB", "a grid of Surfer", "export XYZ points"),
    Signature(0, b"Zygo ASCII Data File", "Zygo's text of phases", "export XYZ points (Zygo XYZ) or DATX"),
    Signature(0, b":NANONIS_VERSION:", "a Nanonis SXM file", EXPORT),
    Signature(0, b"Grid dim=", "a Nanonis 3DS file of spectra", "a grid of spectra is no map of heights"),
    Signature(0, b"S\0T\0i\0M\0a\0g\0e\0", "an RHK SM4 file", EXPORT),
    Signature(2, b"S\0T\0i\0M\0a\0g\0e\0", "an RHK SM4 file", EXPORT),
    Signature(0, b"STiMage ", "an RHK SM2 file", EXPORT),
    Signature(0, b"[Paramco32]", "a Createc file", EXPORT),
    Signature(0, b"[Parameter]", "a Createc file", EXPORT),
    Signature(0, b"FLAT0100", "a flat file of Omicron's Matrix", EXPORT),
    Signature(0, b"ONTMATRX0101", "a file of Omicron's Matrix", EXPORT),
    Signature(0, b"\x01\xb0\x93\xff", "an MDT file of NT-MDT", EXPORT),
    Signature(0, b"WIT_PR", "a WITec project", EXPORT),
    Signature(0, b"WIT_DA", "a WITec data file", EXPORT),
    Signature(8, b"ARDF", "an ARDF file of Asylum Research", EXPORT),
    Signature(0, b"SPIZ000", "a file of Seiko's microscopes", EXPORT),
    Signature(0, b"GWYO", "a file of Gwyddion 1", "save it with Gwyddion 2"),
    Signature(0, b"ZISRAWFILE", "a CZI file of Zeiss", EXPORT),
    Signature(0, b"\x0e\x03\x13\x01", "an HDF4 file", "convert it to HDF5 (h4toh5)"),
    Signature(0, b"SIMPLE  =", "a FITS image", "export NPY (astropy.io.fits)"),
    Signature(0, b"ENVI\n", "a header of ENVI", EXPORT),
    Signature(0, b"ENVI\r\n", "a header of ENVI", EXPORT),
    Signature(0, b"ply\n", "a mesh (PLY)", CLOUD),
    Signature(0, b"ply\r\n", "a mesh (PLY)", CLOUD),
    Signature(0, b"LASF", "a cloud of points (LAS)", CLOUD),
    Signature(0, b"ASTM-E57", "a cloud of points (E57)", CLOUD),
    Signature(0, b"# .PCD", "a cloud of points (PCD)", CLOUD),
    Signature(0, b"OFF\n", "a mesh (OFF)", CLOUD),
    Signature(0, b"# vtk DataFile", "a VTK file", "export NPY or text"),
    Signature(0, b"<VTKFile", "a VTK file", "export NPY or text"),
    Signature(0, b"<svg", "an SVG drawing", PICTURE),
    Signature(0, b"\x80\x02c", "a pickle of Python", "save the array with numpy.save"),
    Signature(0, b"\x80\x03c", "a pickle of Python", "save the array with numpy.save"),
    Signature(0, b"\x80\x04\x95", "a pickle of Python", "save the array with numpy.save"),
    Signature(0, b"\x80\x05\x95", "a pickle of Python", "save the array with numpy.save"),
];

/// Files without a mark of a few bytes at one place.
fn unmarked(path: &Path, start: &[u8], length: u64) -> Option<ContentError> {
    let begins = &start[..start.len().min(200)];
    let contains = |words: &[u8]| begins.windows(words.len()).any(|window| window == words);
    let tile = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("hgt"));
    let number = |at: usize| start.get(at..at + 4).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let facets = number(80).filter(|_| start[..start.len().min(80)].contains(&0));
    let (what, remedy) = if tile && matches!(length, 2_884_802 | 25_934_402) {
        ("a tile of the Shuttle radar (HGT)", "convert it to GeoTIFF of projected coordinates")
    } else if facets.is_some_and(|facets| 84 + 50 * u64::from(facets) == length && facets > 0)
        || (begins.starts_with(b"solid") && contains(b"facet"))
    {
        ("a mesh (STL)", CLOUD)
    } else if begins.starts_with(b"\x70\0\0\0") && begins.get(8) == Some(&0x2a) {
        ("a LIF file of Leica", EXPORT)
    } else if contains(b"Omicron SPM Control") {
        ("the header (PAR) of Omicron's files", EXPORT)
    } else if is_matlab_4(start, length) {
        ("a MATLAB file of version 4", "save it with -v7 or -v7.3")
    } else {
        return None;
    };
    Some(ContentError::Foreign { what, remedy })
}

/// Whether a file begins with the header of a matrix of MATLAB 4: type (four decimals: order of bytes, 0,
/// type of numbers, kind of matrix), rows, columns, whether it is complex, length of the name, and the name
/// with a zero.
fn is_matlab_4(start: &[u8], length: u64) -> bool {
    let header = |big: bool| {
        let number = |i: usize| {
            let bytes = start.get(4 * i..4 * i + 4)?.try_into().ok()?;
            Some(u64::from(if big { u32::from_be_bytes(bytes) } else { u32::from_le_bytes(bytes) }))
        };
        Some([number(0)?, number(1)?, number(2)?, number(3)?, number(4)?])
    };
    [false, true].into_iter().filter_map(header).any(|[kind, rows, columns, complex, name]| {
        let [order, zero, number, matrix] = [kind / 1000, kind / 100 % 10, kind / 10 % 10, kind % 10];
        let size = [8, 4, 4, 2, 2, 1].get(number as usize).copied().unwrap_or(0);
        let numbers = rows.checked_mul(columns).and_then(|count| count.checked_mul(size * (1 + complex)));
        let ends = start.get(20..20 + name as usize).is_some_and(|name| name.last() == Some(&0));
        order <= 1
            && (zero, size > 0, matrix <= 2, complex <= 1) == (0, true, true, true)
            && ends
            && numbers.is_some_and(|numbers| numbers > 0 && 20 + name + numbers <= length)
    })
}

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
        (expected, None) => match (foreign(start).or_else(|| unmarked(path, start, length)), expected) {
            (Some(error), _) => Err(error),
            (None, None | Some(Format::Text | Format::Xyz | Format::Profile)) => Ok(expected),
            (None, Some(expected)) => Err(ContentError::Other { expected }),
        },
    }
}

/// An archive may be an X3P file or another one: only its members tell.
fn foreign(start: &[u8]) -> Option<ContentError> {
    let begins = |Signature(at, mark, ..): &&Signature| start.get(*at..).is_some_and(|s| s.starts_with(mark));
    FOREIGN.iter().find(begins).map(|Signature(.., what, remedy)| ContentError::Foreign { what, remedy })
}
