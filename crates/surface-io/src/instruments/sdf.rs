//! SDF, the surface data file of ISO 25178-71, as text and binary, and its forerunner BCR.
//!
//! After the readers of SurfaceTopography 1.27 (`IO/SDF.py`) and surfalize (`file/sdf.py`), both from the standard, and Gwyddion's
//! `sdfile.c`. The scales along x, y and z are metres. Profiles follow one another, their points along x: row j is profile j. Binary
//! files are little-endian. Undefined points are `BAD` in text, NaN, and the smallest number of a type (surfalize from the standard), of
//! unsigned integers of 16 and 32 bits the largest (SurfaceTopography from Gwyddion).
//!
//! Not read: compressed data, the trailer. `Micromap` states its scales in the trailer: the size of its maps is unknown here.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredHeights, StoredUnit, Undefined};
use crate::error::{ContentError, Result};
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity};
use crate::reader::Reader;
use crate::source::{EndOfFields, Fields, Source};

const FORMAT: Format = Format::Sdf;
const TEXT: [&[u8]; 3] = [b"aISO-1.0", b"aISO-2.0", b"aBCR-0.0"];
/// Numbers of points and profiles have 16 bits, in [`WIDE`] 32.
const BINARY: [&[u8]; 3] = [b"bISO-1.0", WIDE, b"bBCR-0.0"];
const WIDE: &[u8] = b"bISO-2.0";
/// The data of a text begin before this offset.
const LONGEST: u64 = 1 << 16;

pub(crate) const READER: Reader = Reader {
    format: FORMAT,
    recognises: |start, _| TEXT.iter().chain(&BINARY).any(|magic| start.starts_with(magic)),
    channels,
};

/// What both kinds of header say.
#[derive(Debug, Default)]
struct Header {
    manufacturer: String,
    /// Points of a profile, and profiles.
    count: [usize; 2],
    /// Metres along x, y and z.
    scale: [f64; 3],
    compression: i64,
    number: i64,
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let start = source.start(LONGEST)?;
    if TEXT.iter().any(|magic| start.starts_with(magic)) {
        let (header, offset) = text_header(source, &start)?;
        let ([columns, rows], scale) = (header.count, header.scale[2]);
        // One digit and one space at least for each.
        let left = source.length() - offset;
        let fits = (columns as u64).checked_mul(rows as u64).is_some_and(|count| count <= left.div_ceil(2));
        if !fits {
            let expected = format!("{columns} x {rows} numbers, there are {left} bytes (cut short?)");
            return Err(source.wrong(FORMAT, offset, expected));
        }
        let undefined = number(header.number).map_or(Undefined::None, |(_, undefined)| undefined);
        let read = move |source: &mut Source<'_>| numbers(source, offset, columns * rows, (scale, undefined));
        return channel(source, &header, StoredHeights::Deferred(Box::new(read)), "text, row by row".into());
    }
    let (header, offset) = binary_header(&start).map_err(|e| e.of(source, FORMAT))?;
    let Some((number, undefined)) = number(header.number) else {
        let expected = format!("a type of numbers from 0 to 7, found {}", header.number);
        return Err(source.wrong(FORMAT, offset - 2, expected));
    };
    let scale = header.scale[2];
    let raw = RawHeights { scale, undefined, ..RawHeights::new(FORMAT, Bytes::File(offset), number) };
    let [columns, rows] = header.count;
    raw.check(source, rows, columns)?;
    let details = raw.details();
    channel(source, &header, StoredHeights::Raw(raw), details)
}

/// A type of numbers, and which of them stands for undefined points.
fn number(kind: i64) -> Option<(NumberType, Undefined)> {
    let (letter, size, mark) = match kind {
        0 => return Some((NumberType::U8, Undefined::None)),
        1 => (b'u', 2, u16::MAX.into()),
        2 => (b'u', 4, u32::MAX.into()),
        3 => (b'f', 4, f32::MIN.into()),
        4 => (b'i', 1, i8::MIN.into()),
        5 => (b'i', 2, i16::MIN.into()),
        6 => (b'i', 4, i32::MIN.into()),
        7 => (b'f', 8, f64::MIN),
        _ => return None,
    };
    Some((NumberType::new(letter, size, true)?, Undefined::Equal(mark)))
}

fn channel(
    source: &Source<'_>,
    header: &Header,
    heights: StoredHeights,
    details: String,
) -> Result<Vec<StoredChannel>> {
    let ([columns, rows], [x, y, z]) = (header.count, header.scale);
    if columns == 0 || rows == 0 {
        return Err(source.content(ContentError::NoCells { rows: rows as u64, columns: columns as u64 }));
    }
    if header.compression != 0 {
        return Err(source.wrong(FORMAT, 0, format!("Compression 0, found {}", header.compression)));
    }
    if !(z.is_finite() && z.abs() > 0.0) {
        return Err(source.wrong(FORMAT, 0, format!("Zscale other than 0, found {z}")));
    }
    let known = !header.manufacturer.starts_with("Micromap");
    let cell = |scale: f64| {
        let cell = Quantity::new(scale, Dimension::LENGTH).ok().filter(|cell| known && cell.value() > 0.0);
        cell.map(Extent::Cell)
    };
    Ok(vec![StoredChannel {
        name: None,
        details,
        rows,
        columns,
        unit: StoredUnit::heights("m".parse().ok()),
        extent: [cell(x), cell(y)],
        heights,
    }])
}

/// The header, and the offset of its end.
fn binary_header(start: &[u8]) -> Result<(Header, u64), EndOfFields> {
    let mut fields = Fields::little(start, 0);
    fields.go(8);
    let manufacturer = fields.text(10)?;
    fields.take(24)?;
    let count = if start.starts_with(WIDE) {
        [fields.u32()?, fields.u32()?].map(|count| count as usize)
    } else {
        [fields.u16()?, fields.u16()?].map(usize::from)
    };
    let scale = [fields.f64()?, fields.f64()?, fields.f64()?];
    fields.f64()?;
    let (compression, number) = (fields.u8()?.into(), fields.u8()?.into());
    fields.u8()?;
    Ok((Header { manufacturer, count, scale, compression, number }, fields.offset()))
}

/// The header of a text, and the offset behind the line with the asterisk that ends it.
fn text_header(source: &Source<'_>, start: &[u8]) -> Result<(Header, u64)> {
    let mut header = Header { scale: [f64::NAN; 3], ..Header::default() };
    let mut offset = 0;
    for line in start.split_inclusive(|&b| b == b'\n') {
        let begins = offset as u64;
        offset += line.len();
        let line = line.trim_ascii();
        if let [b'*', behind @ ..] = line {
            // What follows in the line are numbers already.
            let back = if behind.is_empty() { 0 } else { behind.len() + 1 };
            return Ok((header, (offset - back.min(offset)) as u64));
        }
        let line = String::from_utf8_lossy(line);
        let Some((name, value)) = line.split_once('=').filter(|_| !line.starts_with(';')) else { continue };
        let (name, value) = (name.trim(), value.trim());
        let wrong = || {
            let found: String = value.chars().take(32).collect();
            source.wrong(FORMAT, begins, format!("a number as {}, found {found:?}", short(name)))
        };
        let number = || value.parse::<f64>().map_err(|_| wrong());
        let whole = || value.parse::<usize>().map_err(|_| wrong());
        match name {
            "ManufacID" => header.manufacturer = value.chars().take(32).collect(),
            "NumPoints" => header.count[0] = whole()?,
            "NumProfiles" => header.count[1] = whole()?,
            "Xscale" => header.scale[0] = number()?,
            "Yscale" => header.scale[1] = number()?,
            "Zscale" => header.scale[2] = number()?,
            "Compression" => header.compression = value.parse().map_err(|_| wrong())?,
            "DataType" => header.number = value.parse().map_err(|_| wrong())?,
            _ => {}
        }
    }
    Err(source.wrong(
        FORMAT,
        start.len() as u64,
        "a line with an asterisk at the end of the header before this",
    ))
}

fn short(text: &str) -> String {
    text.chars().take(32).collect()
}

/// Numbers as text from an offset on, up to an asterisk or the end.
fn numbers(
    source: &mut Source<'_>,
    offset: u64,
    count: usize,
    (scale, undefined): (f64, Undefined),
) -> Result<Vec<f64>> {
    /// Bytes that are read at a time, and the longest number.
    const CHUNK: u64 = 1 << 16;
    const DIGITS: usize = 64;
    let mut heights = Vec::new();
    let refused = |_| ContentError::Memory { bytes: 8 * count as u128 };
    heights.try_reserve_exact(count).map_err(refused).map_err(|e| source.content(e))?;
    let (mut at, mut token, mut begins, mut more) = (offset, Vec::new(), offset, true);
    while more {
        let length = CHUNK.min(source.length() - at);
        let mut bytes = source.bytes(FORMAT, at, length)?;
        if length < CHUNK {
            // The end of the file ends a number.
            bytes.push(b'*');
        }
        for (i, &byte) in bytes.iter().enumerate() {
            if !byte.is_ascii_whitespace() && byte != b'*' {
                if token.is_empty() {
                    begins = at + i as u64;
                }
                if token.len() < DIGITS {
                    token.push(byte);
                }
                continue;
            }
            if !token.is_empty() {
                if heights.len() == count {
                    return Err(source.wrong(FORMAT, begins, format!("an asterisk behind {count} numbers")));
                }
                let text = std::str::from_utf8(&token).unwrap_or_default();
                let number = if text == "BAD" { Ok(f64::NAN) } else { text.parse::<f64>() };
                let number = number.map_err(|_| {
                    let found: String = String::from_utf8_lossy(&token).chars().take(32).collect();
                    source.wrong(FORMAT, begins, format!("a number or BAD, found {found:?}"))
                })?;
                heights.push(if undefined.holds(number) { f64::NAN } else { scale * number });
                token.clear();
            }
            if byte == b'*' {
                more = false;
                break;
            }
        }
        at += length;
    }
    if heights.len() < count {
        let expected = format!("{count} numbers before this, found {} (cut short?)", heights.len());
        return Err(source.wrong(FORMAT, at, expected));
    }
    Ok(heights)
}
