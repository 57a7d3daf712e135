//! SUR, the file of Digital Surf's MountainsMap, uncompressed and compressed (zlib).
//!
//! After Gwyddion's `surffile.c`, SurfaceTopography's `IO/SUR.py`, surfalize's `file/sur.py` and RosettaSciIO's `digitalsurf/_api.py`
//! (<https://github.com/hyperspy/rosettasciio>). Little-endian; an object is a header of 512 bytes, a comment, a private part and integers
//! of 16 or 32 bits, row by row; row j is y = j * step, as SurfaceTopography and surfalize have it. A height is
//! `Z step * number + Z offset` in the unit of the Z step, as in Gwyddion and surfalize; RosettaSciIO counts numbers from `Zmin`,
//! SurfaceTopography leaves out the offset: the difference is one constant for all heights. With `special points` the number `Zmin - 2` is
//! an undefined point.
//!
//! Several objects (a surface and its intensity, series) are several channels; images are no heights. Not read: profiles, force curves,
//! spectra, files of a Macintosh, and surfaces that the header calls inverted: SurfaceTopography 1.27 and Gwyddion invert the numbers then,
//! surfalize and RosettaSciIO do not, and hills would be taken for valleys.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredHeights, StoredUnit, Undefined};
use crate::error::{ContentError, Result};
use crate::extent::Extent;
use crate::format::Format;
use crate::inflate::{Packed, Packing};
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::reader::Reader;
use crate::source::{EndOfFields, Fields, Source};

const FORMAT: Format = Format::Sur;
const PLAIN: &[u8] = b"DIGITAL SURF";
const COMPRESSED: &[u8] = b"DSCOMPRESSED";
const HEADER: u64 = 512;
/// Streams of one object; MountainsMap writes up to 8.
const STREAMS: u32 = 1024;

pub(crate) const READER: Reader =
    Reader { format: FORMAT, recognises: |start, _| is_object(start), channels };

fn is_object(start: &[u8]) -> bool {
    start.starts_with(PLAIN) || start.starts_with(COMPRESSED)
}

/// What is kept of a header.
#[derive(Debug)]
struct Header {
    machine: u16,
    objects: u16,
    kind: u16,
    name: String,
    channels: u16,
    special: bool,
    bits: u16,
    lowest: i32,
    count: [i32; 2],
    total: u32,
    step: [f64; 3],
    z_axis: String,
    unit: [String; 3],
    inverted: bool,
    behind: u64,
    z_offset: f64,
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let mut found = Vec::new();
    let (mut at, mut most, mut first_kind) = (0, 1, 0);
    // Older writers have the code of a material where newer ones have the number of channels: what follows decides.
    while found.len() < most && source.length() - at >= HEADER {
        let bytes = source.bytes(FORMAT, at, HEADER)?;
        if !is_object(&bytes) {
            break;
        }
        let header = header(&bytes).map_err(|e| e.of(source, FORMAT))?;
        if found.is_empty() {
            most = usize::from(header.objects.max(1)) * usize::from(header.channels.max(1));
            first_kind = header.kind;
        }
        // Of a surface with an image, the surface is first.
        let image = matches!(header.kind, 3 | 10 | 12 | 18)
            || (matches!(first_kind, 11 | 13 | 16) && !found.is_empty());
        let (channel, end) = object(source, at, &header, (image, bytes.starts_with(COMPRESSED)))?;
        found.push(channel);
        at = end;
    }
    if found.is_empty() {
        return Err(source.wrong(
            FORMAT,
            source.length(),
            format!("a header of {HEADER} bytes (cut short?)"),
        ));
    }
    Ok(found)
}

fn header(bytes: &[u8]) -> Result<Header, EndOfFields> {
    let mut f = Fields::little(bytes, 0);
    f.go(12);
    let (machine, objects) = (f.u16()?, f.u16()?);
    f.u16()?;
    let (kind, name) = (f.u16()?, f.text(30)?);
    f.go(80);
    let channels = f.u16()?;
    f.go(86);
    let special = f.u16()? == 1;
    f.go(98);
    let (bits, lowest) = (f.u16()?, f.i32()?);
    f.i32()?;
    let (count, total) = ([f.i32()?, f.i32()?], f.u32()?);
    let step = [f.f32()?, f.f32()?, f.f32()?];
    f.go(164);
    let z_axis = f.text(16)?;
    let unit = [f.text(16)?, f.text(16)?, f.text(16)?];
    f.go(290);
    let inverted = f.u16()? != 0;
    f.go(334);
    let behind = HEADER + u64::from(f.u16()?) + u64::from(f.u16()?);
    f.go(474);
    let z_offset = f.f32()?;
    Ok(Header {
        machine,
        objects,
        kind,
        name,
        channels,
        special,
        bits,
        lowest,
        count,
        total,
        step,
        z_axis,
        unit,
        inverted,
        behind,
        z_offset,
    })
}

/// The channel of an object and the offset of its end.
fn object(
    source: &mut Source<'_>,
    at: u64,
    header: &Header,
    (image, compressed): (bool, bool),
) -> Result<(StoredChannel, u64)> {
    let wrong =
        |source: &Source<'_>, inside: u64, expected: String| Err(source.wrong(FORMAT, at + inside, expected));
    if header.machine != 0 {
        return wrong(source, 12, format!("0, the format of a PC, found {}", header.machine));
    }
    let number = match header.bits {
        16 => NumberType::I16,
        32 => NumberType::I32,
        bits => return wrong(source, 98, format!("16 or 32 bits for a number, found {bits}")),
    };
    let [x, y, z] = header.step;
    let [Ok(columns), Ok(rows)] = header.count.map(usize::try_from) else {
        return wrong(source, 108, "numbers of columns and rows".to_owned());
    };
    // Gwyddion calls surfaces profiles.
    let is_surface = matches!(header.kind, 1 | 2 | 3 | 5 | 8 | 10 | 11 | 12 | 13 | 16 | 18);
    if !is_surface || (header.kind == 1 && rows == 1) {
        let expected =
            format!("a surface or an image, found {} of type {}", kind_name(header.kind), header.kind);
        return wrong(source, 18, expected);
    }
    if columns as u64 * rows as u64 != u64::from(header.total) {
        let expected = format!("{columns} x {rows} numbers, found {}", header.total);
        return wrong(source, 116, expected);
    }
    if columns == 0 || rows == 0 {
        return Err(source.content(ContentError::NoCells { rows: rows as u64, columns: columns as u64 }));
    }
    if !(z.is_finite() && z.abs() > 0.0 && header.z_offset.is_finite()) {
        return wrong(source, 128, format!("a step along z other than 0 and an offset, found {z}"));
    }
    if header.inverted && !image {
        let expected = "no mark of an inversion: readers disagree whether the numbers are inverted already; export X3P or text";
        return wrong(source, 290, expected.to_owned());
    }
    let mark = f64::from(header.lowest) - 2.0;
    let undefined = if header.special { Undefined::Equal(mark) } else { Undefined::None };
    let data = at + header.behind;
    let shift = header.z_offset;
    let raw =
        move |bytes| RawHeights { scale: z, shift, undefined, ..RawHeights::new(FORMAT, bytes, number) };
    let plain = raw(Bytes::File(data));
    let mut details = plain.details();
    let length = u64::from(header.total) * number.bytes() as u64;
    let (heights, end) = if compressed {
        details += ", compressed";
        let (streams, end) = streams(source, data, length)?;
        let read = move |source: &mut Source<'_>| {
            let mut bytes = Vec::new();
            for stream in &streams {
                stream.unpack(source, FORMAT, &mut bytes)?;
            }
            raw(Bytes::Held(bytes)).read(source, rows, columns)
        };
        (StoredHeights::Deferred(Box::new(read)), end)
    } else {
        plain.check(source, rows, columns)?;
        (StoredHeights::Raw(plain), data + length)
    };
    let side = |step: f64, unit: &str| {
        let unit = unit.parse::<Unit>().ok().filter(|unit| unit.dimension() == Dimension::LENGTH)?;
        let cell = Quantity::new(unit.to_si(step), Dimension::LENGTH).ok().filter(|cell| cell.value() > 0.0);
        cell.map(Extent::Cell)
    };
    let unit = StoredUnit::written(&header.unit[2]);
    let channel = StoredChannel {
        name: [&header.name, &header.z_axis].into_iter().find(|name| !name.is_empty()).cloned(),
        details,
        rows,
        columns,
        unit: match unit {
            StoredUnit::NoHeights(unit) => StoredUnit::NoHeights(unit),
            _ if image => StoredUnit::NoHeights(None),
            unit => unit,
        },
        extent: [side(x, &header.unit[0]), side(y, &header.unit[1])],
        heights,
    };
    Ok((channel, end))
}

/// The streams of a compressed object that unpack to so many bytes, and the offset of their end.
fn streams(source: &mut Source<'_>, data: u64, length: u64) -> Result<(Vec<Packed>, u64)> {
    let count = source.bytes(FORMAT, data, 4)?;
    let count = Fields::little(&count, data).u32().map_err(|e| e.of(source, FORMAT))?;
    if !(1..=STREAMS).contains(&count) {
        return Err(source.wrong(FORMAT, data, format!("1 to {STREAMS} streams, found {count}")));
    }
    let bytes = source.bytes(FORMAT, data + 4, 8 * u64::from(count))?;
    let mut fields = Fields::little(&bytes, data + 4);
    let mut end = data + 4 + bytes.len() as u64;
    let (mut found, mut total) = (Vec::new(), 0);
    for _ in 0..count {
        let lengths = |f: &mut Fields<'_>| Ok([u64::from(f.u32()?), u64::from(f.u32()?)]);
        let [unpacked, packed] = lengths(&mut fields).map_err(|e: EndOfFields| e.of(source, FORMAT))?;
        let stream = Packed { packing: Packing::Zlib, offset: end, length: packed, unpacked };
        stream.check(source, FORMAT)?;
        found.push(stream);
        end += packed;
        total += unpacked;
    }
    if total != length {
        return Err(source.wrong(FORMAT, data, format!("streams of {length} bytes unpacked, found {total}")));
    }
    Ok((found, end))
}

/// Names of types that are not read.
fn kind_name(kind: u16) -> &'static str {
    match kind {
        1 => "a profile",
        4 => "a series of profiles",
        6 | 9 => "a disc",
        7 => "a profile of several layers",
        14 | 15 => "force curves",
        17 => "a contour",
        20 | 21 => "spectra",
        _ => "an object",
    }
}
