//! OPD, of Wyko's (Veeco's, Bruker's) interferometers: a directory of named blocks, and the blocks one after
//! another.
//!
//! Height of a number in nanometres: `Wavelength` over `Mult`; a point is `Pixel_size` millimetres wide, and
//! that times `Aspect` high (the readers of Gwyddion and `SurfaceTopography` agree). Heights stand column by
//! column, the last row first. Numbers from 1e38 on (float32) and from 32766 on (int16) are undefined points.
//! Intensities are not read.

use super::prelude::*;

/// An entry of the directory: name, type, length, attribute.
const ENTRY: u64 = 24;
/// Where the directory begins.
const DIRECTORY: u64 = 2;
/// Most blocks.
const MOST: u64 = 10_000;
const ARRAY: i16 = 3;
/// Names of blocks of heights.
const HEIGHTS: [&str; 5] = ["RAW DATA", "RAW_DATA", "OPD", "Raw", "SAMPLE_DATA"];

pub(crate) const READER: Reader = Reader {
    format: Format::Opd,
    recognises: |start, _| start.get(2..).is_some_and(|rest| rest.starts_with(b"Directory\0")),
    channels,
};

header! {
    /// An entry of the directory.
    struct OpdEntry {
        name: Text<16> = 0,
        kind: i16 = 16,
        /// A negative length is none.
        length: i32 = 18,
    }
}

/// An entry, and where its block begins.
struct OpdBlock {
    entry: OpdEntry,
    length: u64,
    offset: u64,
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let blocks = blocks(source)?;
    let mut number = |name: &str| -> Result<Option<f64>> {
        let block = blocks.iter().find(|b| &*b.entry.name == name && b.length > 0);
        let Some(OpdBlock { entry, length, offset }) = block else { return Ok(None) };
        let kind = match (entry.kind, length) {
            (8, 8..) => NumberType::F64,
            (6, 2) => NumberType::I16,
            (6 | 12, 4) => NumberType::I32,
            (7, 4..) => NumberType::F32,
            (kind, _) => {
                let expected = format!("a number as {name}, found {length} bytes of type {kind}");
                return Err(source.wrong(*offset, expected));
            }
        };
        source.fields(ByteOrder::Little, *offset, kind.bytes() as u64)?.number(kind).map(Some)
    };
    let (wavelength, mult) = (number("Wavelength")?, number("Mult")?.unwrap_or(1.0));
    let (aspect, pixel) = (number("Aspect")?.unwrap_or(1.0), number("Pixel_size")?);
    let scale = wavelength.map(|w| w / mult).filter(|s| s.is_finite() && *s > 0.0);
    let Some(scale) = scale else {
        return Err(source.wrong(DIRECTORY, "blocks Wavelength and Mult above 0"));
    };
    let side = |times: f64| Extent::of_cell(pixel? * times, "mm");
    let mut channels = Vec::new();
    for OpdBlock { entry, length, offset } in &blocks {
        if entry.kind != ARRAY || !HEIGHTS.contains(&&*entry.name) {
            continue;
        }
        let [columns, rows, size]: [u16; 3] = source.get(ByteOrder::Little, *offset)?;
        let (kind, undefined) = match size {
            2 => (NumberType::I16, Undefined::AtLeast(32766.0)),
            4 => (NumberType::F32, Undefined::AtLeast(1e38_f32.into())),
            _ => return Err(source.wrong(offset + 4, "numbers of 2 or 4 bytes")),
        };
        let points = u64::from(columns) * u64::from(rows);
        if 6 + points * u64::from(size) > *length {
            let expected = format!("a block of {columns} x {rows} numbers, found {length} bytes");
            return Err(source.wrong(*offset, expected));
        }
        let raw = RawHeights {
            order: AxisOrder::Columns,
            reversed: [false, true],
            scale,
            undefined,
            ..RawHeights::at(offset + 6, kind)
        };
        let (shape, extent) = ([rows.into(), columns.into()], [side(1.0), side(aspect)]);
        let channel = StoredChannel::new(source, raw, shape, StoredUnit::written("nm"), extent)?;
        channels.push(channel.named(&entry.name));
    }
    Ok(channels)
}

/// The directory, whose first entry is itself.
fn blocks(source: &mut OpenedFile<'_>) -> Result<Vec<OpdBlock>> {
    let length = u64::try_from(source.get::<i32>(ByteOrder::Little, DIRECTORY + 18)?).unwrap_or(0);
    if length == 0 || length % ENTRY != 0 || length / ENTRY > MOST {
        let expected =
            format!("a directory of whole entries of {ENTRY} bytes, at most {MOST}, found {length} bytes");
        return Err(source.wrong(DIRECTORY, expected));
    }
    let mut offset = DIRECTORY + length;
    let mut blocks = Vec::new();
    for at in (DIRECTORY..offset).step_by(ENTRY as usize).skip(1) {
        let entry = OpdEntry::of(&mut source.fields(ByteOrder::Little, at, ENTRY)?)?;
        let length = u64::try_from(entry.length).unwrap_or(0);
        blocks.push(OpdBlock { entry, length, offset });
        offset += length;
    }
    Ok(blocks)
}
