//! MAT, the file of MATLAB of version 5 (up to 7.2), as SciPy and Octave write it too: every matrix of real
//! numbers is a channel.
//!
//! After "MAT-File Format" of `MathWorks`. A header of 128 bytes with the order of bytes, then elements of a
//! tag (type and length) and data, filled up to eight bytes; an element may be packed by zlib. A matrix is a
//! list of elements: its class and flags, its shape, its name, and its numbers column by column, of a type
//! that may be smaller than that of the class.
//!
//! Height = number, without a unit; NaN are undefined points. MATLAB's `surf`, `mesh` and `imagesc` draw the
//! matrix Z(row, column) over y and x: the first index is taken for y, row 1 for y = 0, which is noted;
//! [`crate::Axes`] `xy` takes it for x, as `SurfaceTopography` does. No variable is taken for a size or for
//! coordinates.
//!
//! Passed are scalars, text, structures, cells, sparse matrices and arrays of three dimensions; complex
//! matrices are listed and not read. Version 7.3 is HDF5; version 4 is not read.

use super::prelude::*;
use crate::channel::FileAxes;
use crate::inflate::{Packed, Packing};
use crate::options::Axes;
use flate2::read::ZlibDecoder;
use std::io::Read as _;

const HEADER: u64 = 128;
const MATRIX: u32 = 14;
const PACKED: u32 = 15;
/// Classes of matrices of numbers.
const CLASSES: std::ops::RangeInclusive<u8> = 6..=15;
const COMPLEX: u8 = 8;
/// Bytes of a matrix before its numbers that are looked at: names have 63 letters.
const START: u64 = 1024;
/// Types of numbers by their codes.
const TYPES: [&str; 14] = ["", "i1", "u1", "i2", "u2", "i4", "u4", "f4", "", "f8", "", "", "i8", "u8"];
/// Most matrices that are read.
const MOST: usize = 1000;

pub(crate) const READER: Reader = Reader {
    format: Format::Mat,
    recognises: |start, _| start.starts_with(b"MATLAB 5.0 MAT-file") && order(start).is_some(),
    channels,
};

/// The order of bytes by the mark of the header, beside version 1.
fn order(start: &[u8]) -> Option<ByteOrder> {
    match start.get(124..128)? {
        [0, 1, b'I', b'M'] => Some(ByteOrder::Little),
        [1, 0, b'M', b'I'] => Some(ByteOrder::Big),
        _ => None,
    }
}

/// What is kept of a matrix.
struct Matrix {
    name: String,
    shape: [usize; 2],
    complex: bool,
    number: NumberType,
    /// Where its numbers begin in its element, and their bytes.
    at: u64,
    bytes: u64,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let order = order(&source.start(HEADER)?).unwrap_or(ByteOrder::Little);
    let mut found = Vec::new();
    let mut at = HEADER;
    while at < source.length() {
        let [kind, length] = source.get::<[u32; 2]>(order, at)?;
        let (begin, length) = (at + 8, u64::from(length));
        if begin + length > source.length() {
            let expected = format!("{length} bytes here, the file ends at {} (cut short?)", source.length());
            return Err(source.wrong(begin, expected));
        }
        let start = match kind {
            MATRIX => source.bytes(at, 8 + length.min(START)),
            PACKED => unpacked(source, begin, length),
            _ => Ok(Vec::new()),
        };
        let subject = source.subject().clone();
        let matrix = start.and_then(|start| matrix(&mut ByteFields::new(subject, order, at, start)));
        if let Some(matrix) = matrix.transpose() {
            let name = matrix.as_ref().ok().map(|matrix| matrix.name.clone());
            let packed = (kind == PACKED).then_some((begin, length));
            let channel = matrix.and_then(|matrix| channel(source, matrix, at, packed));
            found.push(StoredChannel::listed(name, channel)?);
        }
        if found.len() > MOST {
            return Err(source.wrong(at, format!("{MOST} matrices at most")));
        }
        // Packed elements are not filled up.
        at = begin + if kind == PACKED { length } else { length.next_multiple_of(8) };
    }
    if found.is_empty() {
        return Err(source.wrong(HEADER, "a matrix of real numbers of two dimensions"));
    }
    Ok(found)
}

/// The beginning of what is packed.
fn unpacked(source: &mut OpenedFile<'_>, offset: u64, length: u64) -> Result<Vec<u8>> {
    let mut start = Vec::new();
    let read = ZlibDecoder::new(source.part(offset, length)?).take(START).read_to_end(&mut start);
    read.map_err(|error| source.wrong(offset, format!("a packed element ({error})")))?;
    Ok(start)
}

/// The matrix in the beginning of an element; `None` for all else.
fn matrix(fields: &mut ByteFields<'_>) -> Result<Option<Matrix>> {
    if fields.left() == 0 || fields.get::<[u32; 2]>()?[0] != MATRIX {
        return Ok(None);
    }
    let (_, flags) = element(fields, 4)?;
    let after = fields.place();
    let [class, flags, ..] = fields.go(flags).get::<u32>()?.to_le_bytes();
    fields.go(after);
    let (bytes, shape) = element(fields, 8)?;
    if !CLASSES.contains(&class) || bytes != 8 {
        return Ok(None);
    }
    let after = fields.place();
    let shape = fields.go(shape).get::<[u32; 2]>()?.map(|count| count as usize);
    fields.go(after);
    let (letters, at) = element(fields, 0)?;
    let after = fields.place();
    let name = fields.go(at).text(letters as usize)?;
    if shape == [1, 1] || shape.contains(&0) {
        return Ok(None);
    }
    let kind = fields.go(after).get::<u32>()?;
    // Small numbers stand in the tag.
    let (kind, bytes) = if kind > 0xffff { (kind & 0xffff, kind >> 16) } else { (kind, fields.get()?) };
    let number = NumberType::of_code(kind.into(), &TYPES, fields.order());
    let expected = || format!("a type of numbers from 1 to 13 before this, found {kind}");
    let number = number.ok_or_else(|| fields.wrong(expected()))?;
    let complex = flags & COMPLEX != 0;
    let at = fields.place() as u64;
    Ok(Some(Matrix { name, shape, complex, number, at, bytes: bytes.into() }))
}

/// Number and place of the bytes of an element's data, at least `least` bytes; the next element is behind it.
fn element(fields: &mut ByteFields<'_>, least: u32) -> Result<(u32, usize)> {
    let kind: u32 = fields.get()?;
    let small = kind > 0xffff;
    let bytes = if small { kind >> 16 } else { fields.get()? };
    let at = fields.place();
    let end = if small { 4 } else { (bytes as usize).next_multiple_of(8) };
    if bytes < least || end > fields.left() || (small && bytes > 4) {
        return Err(fields.wrong(format!("{least} bytes or more that are there, found {bytes}")));
    }
    fields.go(at + end);
    Ok((bytes, at))
}

fn channel(
    source: &OpenedFile<'_>,
    matrix: Matrix,
    begin: u64,
    packed: Option<(u64, u64)>,
) -> Result<StoredChannel> {
    let Matrix { name, shape: [rows, columns], complex, number, at, bytes } = matrix;
    let wrong = |expected: String| Err(source.wrong(begin, expected));
    if complex {
        return wrong("real numbers, found complex ones".into());
    }
    if number.bytes_of([rows, columns]) != Some(bytes) {
        let size = number.bytes();
        return wrong(format!("{rows} x {columns} numbers of {size} bytes, found {bytes} bytes"));
    }
    let raw = move |place| RawHeights { order: AxisOrder::Columns, ..RawHeights::new(place, number) };
    let unit = StoredUnit::Unknown;
    let mut channel = if let Some((offset, length)) = packed {
        let packed = Packed { packing: Packing::Zlib, offset, length, unpacked: at + bytes };
        packed.check(source)?;
        let details = format!("{}, packed", raw(Bytes::Held(Vec::new())).details());
        StoredChannel::deferred(details, [rows, columns], unit, [None; 2], move |source| {
            let mut plain = Vec::new();
            packed.unpack(source, &mut plain)?;
            plain.drain(..at as usize);
            raw(Bytes::Held(plain)).read(source, rows, columns)
        })
    } else {
        StoredChannel::new(source, raw(Bytes::File(begin + at)), [rows, columns], unit, [None; 2])?
    };
    channel.compared = number;
    channel.take_axes(FileAxes::Assumed(Axes::Yx), "MATLAB draws rows along y");
    Ok(channel.named(&name))
}
