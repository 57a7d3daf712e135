//! SDF, the surface data file of ISO 25178-71, as text and binary, and its forerunner BCR.
//!
//! After the readers of SurfaceTopography 1.27 (`IO/SDF.py`) and surfalize (`file/sdf.py`), both from the
//! standard, and Gwyddion's `sdfile.c`. The scales along x, y and z are metres. Profiles follow one another,
//! their points along x. Binary files are little-endian. Undefined points are `BAD` in text and NaN.
//!
//! - **ISO 1.0, 2.0.** Row j is profile j. The smallest number of a type is undefined (surfalize from the
//!   standard), of unsigned integers of 16 and 32 bits the largest (SurfaceTopography from Gwyddion).
//! - **BCR 0.0, 1.0.** The first profile is that of the largest y; the largest number of a type is undefined:
//!   as users report of it (surfalize, issue 33). Its description, EUR 15178 EN, was not at hand.
//!
//! Not read: compressed data, the trailer. `Micromap` states its scales in the trailer: the size of its maps
//! is unknown here.

use super::prelude::*;
use crate::channel::undefined_heights;
use crate::entries::{HeaderLine, TextHeader};

/// Behind an `a` for text or a `b` for numbers.
const REVISIONS: [&[u8]; 4] = [b"ISO-1.0", b"ISO-2.0", b"BCR-0.0", b"BCR-1.0"];
/// The data of a text begin before this offset.
const LONGEST: u64 = 1 << 16;

pub(crate) const READER: Reader = Reader {
    format: Format::Sdf,
    recognises: |start, _| {
        matches!(start.first(), Some(b'a' | b'b')) && REVISIONS.iter().any(|r| start[1..].starts_with(r))
    },
    channels,
};

/// What both kinds of header say.
struct SdfHeader {
    manufacturer: String,
    /// Points of a profile, and profiles.
    count: [usize; 2],
    /// Metres along x, y and z.
    scale: [f64; 3],
    compression: f64,
    kind: f64,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let start = source.start(LONGEST)?;
    let (header, offset) = if start[0] == b'a' {
        text_header(source, &start)?
    } else {
        binary_header(source, start[4] == b'-' && start.starts_with(b"bISO-2"))?
    };
    let bcr = start[1..].starts_with(b"BCR");
    let ([columns, rows], [x, y, z]) = (header.count, header.scale);
    source.check_cells([rows, columns])?;
    if header.compression.abs() > 0.0 {
        return Err(source.wrong(0, format!("Compression 0, found {}", header.compression)));
    }
    if !(z.is_finite() && z.abs() > 0.0) {
        return Err(source.wrong(0, format!("Zscale other than 0, found {z}")));
    }
    let known = number(header.kind as u8, bcr).filter(|_| header.kind.fract().abs() <= 0.0);
    let Some((number, undefined)) = known else {
        let expected = format!("a type of numbers from 0 to 7, found {}", header.kind);
        return Err(source.wrong(offset, expected));
    };
    let raw = RawHeights { reversed: [false, bcr], scale: z, undefined, ..RawHeights::at(offset, number) };
    let known = !header.manufacturer.starts_with("Micromap");
    let cell = |scale: f64| Extent::of_cell(scale, "m").filter(|_| known);
    let (shape, unit, extent) = ([rows, columns], StoredUnit::written("m"), [cell(x), cell(y)]);
    if start[0] != b'a' {
        return Ok(vec![StoredChannel::new(source, raw, shape, unit, extent)?]);
    }
    // One digit and one space at least for each.
    let left = source.length() - offset;
    if columns.checked_mul(rows).is_none_or(|count| count as u64 > left.div_ceil(2)) {
        let expected = format!("{columns} x {rows} numbers, there are {left} bytes (cut short?)");
        return Err(source.wrong(offset, expected));
    }
    let read = move |source: &mut OpenedFile<'_>| numbers(source, offset, &raw, shape);
    Ok(vec![StoredChannel::deferred("text, row by row".to_owned(), shape, unit, extent, read)])
}

/// A type of numbers, and which of them stands for undefined points.
fn number(kind: u8, bcr: bool) -> Option<(NumberType, Undefined)> {
    let (letter, size, smallest, largest) = match kind {
        0 => return Some((NumberType::U8, Undefined::None)),
        1 => (b'u', 2, u16::MAX.into(), u16::MAX.into()),
        2 => (b'u', 4, u32::MAX.into(), u32::MAX.into()),
        3 => (b'f', 4, f32::MIN.into(), f32::MAX.into()),
        4 => (b'i', 1, i8::MIN.into(), i8::MAX.into()),
        5 => (b'i', 2, i16::MIN.into(), i16::MAX.into()),
        6 => (b'i', 4, i32::MIN.into(), i32::MAX.into()),
        7 => (b'f', 8, f64::MIN, f64::MAX),
        _ => return None,
    };
    let mark = if bcr { largest } else { smallest };
    Some((NumberType::new(letter, size, true)?, Undefined::Equal(mark)))
}

/// The header, and the offset of its end; numbers of points and profiles have 16 bits, or 32.
fn binary_header(source: &mut OpenedFile<'_>, wide: bool) -> Result<(SdfHeader, u64)> {
    let little = ByteOrder::Little;
    let (count, at) = if wide {
        (source.get::<[u32; 2]>(little, 42)?.map(|count| count as usize), 50)
    } else {
        (source.get::<[u16; 2]>(little, 42)?.map(usize::from), 46)
    };
    let manufacturer = source.get::<Text<10>>(little, 8)?.to_string();
    let scale = source.get(little, at)?;
    let [compression, kind, _] = source.get::<[u8; 3]>(little, at + 32)?.map(f64::from);
    Ok((SdfHeader { manufacturer, count, scale, compression, kind }, at + 35))
}

/// The header of a text, and the offset behind the asterisk that ends it.
fn text_header(source: &OpenedFile<'_>, start: &[u8]) -> Result<(SdfHeader, u64)> {
    let Some(end) = start.windows(2).position(|two| two == b"\n*") else {
        let expected = "a line with an asterisk at the end of the header before this";
        return Err(source.wrong(start.len() as u64, expected));
    };
    let (header, _) = TextHeader::read(source.subject(), &start[..=end], |line| {
        if line.trim_start().starts_with(';') { HeaderLine::Passed } else { HeaderLine::entry(line, '=') }
    })?;
    let section = header.section("");
    let number = |key: &str| Ok(section.number(key)?.unwrap_or(0.0));
    let scale = |key: &str| Ok(section.number(key)?.unwrap_or(f64::NAN));
    let header = SdfHeader {
        manufacturer: section.text("manufacid").unwrap_or_default().to_owned(),
        count: [section.whole("numpoints")?, section.whole("numprofiles")?],
        scale: [scale("xscale")?, scale("yscale")?, scale("zscale")?],
        compression: number("compression")?,
        kind: section.number("datatype")?.unwrap_or(7.0),
    };
    Ok((header, end as u64 + 2))
}

/// Numbers as text from an offset on, up to an asterisk or the end; comments begin with a semicolon.
fn numbers(
    source: &mut OpenedFile<'_>,
    offset: u64,
    raw: &RawHeights,
    shape: [usize; 2],
) -> Result<Vec<f64>> {
    let [rows, columns] = shape;
    let bytes = source.bytes(offset, source.length() - offset)?;
    let mut heights = undefined_heights(source, rows, columns)?;
    let mut found = 0;
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        let data = line.split(|&b| b == b';').next().unwrap_or_default();
        let (data, last) = match data.iter().position(|&b| b == b'*') {
            Some(end) => (&data[..end], true),
            None => (data, false),
        };
        for token in data.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty()) {
            let begins = offset + (token.as_ptr() as usize - bytes.as_ptr() as usize) as u64;
            if found == rows * columns {
                return Err(source.wrong(begins, format!("an asterisk behind {found} numbers")));
            }
            let text = std::str::from_utf8(token).unwrap_or_default();
            let number = if text == "BAD" { Ok(f64::NAN) } else { text.parse() };
            let number = number.map_err(|_| {
                let found: String = String::from_utf8_lossy(token).chars().take(32).collect();
                source.wrong(begins, format!("a number or BAD, found {found:?}"))
            })?;
            raw.put_number(&mut heights, shape, [found / columns, found % columns], number);
            found += 1;
        }
        if last {
            break;
        }
    }
    if found < rows * columns {
        let expected = format!("{} numbers before this, found {found} (cut short?)", rows * columns);
        return Err(source.wrong(source.length(), expected));
    }
    Ok(heights)
}
