//! TIFF of Park Systems' (PSIA's) microscopes: beside a picture, tags hold one map and its header.
//!
//! After Gwyddion's `psia.c` and `SurfaceTopography`'s `IO/PS.py`. A height is `gain * (scale * number +
//! offset)` in the unit of the data, where that is a length (a scale of 0 is taken for 1 and noted), as in
//! Gwyddion; `SurfaceTopography` leaves the offset out. Numbers are little-endian int16, from the second
//! version on also int32 or float32, row by row. The sides are micrometres. The first row of the file is the
//! bottom of the image, so the last row. A fast axis along y is a note: Gwyddion turns such a map by a
//! quarter turn.
//!
//! Not read: line profiles, spectra, logarithms and squares, the picture.

use super::directory::Directories;
use crate::fields::Wide;
use crate::instruments::prelude::*;

/// Tags, and the number in the first of them.
const MARK: u16 = 50432;
const MAGIC: u32 = 0x0e03_1301;
const VERSION: u16 = 50433;
const DATA: u16 = 50434;
const HEADER: u16 = 50435;
/// The first version, and the second, which has types of numbers.
const FIRST: u32 = 0x0100_0001;
const SECOND: u32 = 0x0100_0002;
/// Bytes of the header that are read.
const LENGTH: u64 = 356;

header! {
    /// What is kept of the header.
    struct ParkHeader {
        /// 0 a map, 1 a line, 2 spectra with a map.
        kind: u32 = 0,
        name: Wide<32> = 4,
        columns: u32 = 100,
        rows: u32 = 104,
        swapped: u32 = 136,
        side: [f64; 2] = 140,
        gain: f64 = 220,
        scale: f64 = 228,
        offset: f64 = 236,
        unit: Wide<8> = 244,
        /// Whether numbers are logarithms, or squares.
        other: [u32; 2] = 276,
        number: u32 = 348,
    }
}

/// The map of a file of this kind; `None` for another TIFF.
pub(super) fn channel(source: &mut OpenedFile<'_>, tags: &Directories) -> Result<Option<StoredChannel>> {
    if tags.number(source, 0, MARK)? != Some(MAGIC.into()) {
        return Ok(None);
    }
    let version = tags.number(source, 0, VERSION)?.map_or(0, |version| version as u32);
    let (Some((at, length)), Some((data, bytes)), FIRST | SECOND) =
        (tags.bytes(0, HEADER), tags.bytes(0, DATA), version)
    else {
        let expected = format!("Park's version 1 or 2, a header and data, found version {version:#x}");
        return Err(source.wrong(0, expected));
    };
    if length < LENGTH {
        return Err(source.wrong(at, format!("a header of {LENGTH} bytes at least, found {length}")));
    }
    let header = ParkHeader::of(&mut source.fields(ByteOrder::Little, at, LENGTH)?)?;
    let wrong = |offset: u64, expected: String| Err(source.wrong(at + offset, expected));
    if header.kind == 1 || header.other != [0; 2] {
        return wrong(
            0,
            format!("a map, no line, logarithms or squares, found {:?}", (header.kind, header.other)),
        );
    }
    let number = match (version, header.number) {
        (FIRST, _) | (_, 0) => NumberType::I16,
        (_, 1) => NumberType::I32,
        (_, 2) => NumberType::F32,
        (_, other) => return wrong(348, format!("a type of numbers from 0 to 2, found {other}")),
    };
    if number.bytes_of([header.rows, header.columns]) != Some(bytes) {
        let size = number.bytes();
        let expected =
            format!("{} x {} numbers of {size} bytes, found {bytes} bytes", header.columns, header.rows);
        return wrong(100, expected);
    }
    let scale = if header.scale.abs() > 0.0 { header.scale } else { 1.0 };
    let (scale, shift) = (header.gain * scale, header.gain * header.offset);
    let raw = RawHeights { reversed: [false, true], scale, shift, ..RawHeights::at(data, number) };
    let shape = [header.rows as usize, header.columns as usize];
    let extent = header.side.map(|side| Extent::of_side(side, "um"));
    let unit = StoredUnit::of_signal(&header.name, &header.unit);
    let channel = StoredChannel::new(source, raw, shape, unit, extent)?;
    let mut channel = channel.named(&header.name);
    if header.scale.abs() <= 0.0 {
        channel.note("the file says a scale of 0, which is taken for 1");
    }
    if header.swapped != 0 {
        channel.note("the fast axis of the scan was y: other readers turn this map by a quarter turn");
    }
    Ok(Some(channel))
}
