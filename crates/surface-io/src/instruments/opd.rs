//! OPD, of Wyko's (Veeco's, Bruker's) interferometers: a directory of named blocks, and the blocks one after another.
//!
//! Height of a number in nanometres: `Wavelength` over `Mult`; a point is `Pixel_size` millimetres wide, and that times `Aspect` high
//! (the readers of Gwyddion and `SurfaceTopography` agree). Heights stand column by column, the last row first. Undefined are float32 from
//! 1e38 on and int16 from 32766 on. Intensities are not read.

use crate::channel::{AxisOrder, Bytes, RawHeights, StoredChannel, StoredUnit, Undefined};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity};
use crate::reader::Reader;
use crate::source::{EndOfFields, Fields, Source};

const FORMAT: Format = Format::Opd;
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
    format: FORMAT,
    recognises: |start, _| start.get(2..).is_some_and(|rest| rest.starts_with(b"Directory\0")),
    channels,
};

/// An entry, and where its block begins.
struct Block {
    name: String,
    kind: i16,
    length: u64,
    offset: u64,
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let blocks = blocks(source)?;
    let mut number = |name: &str| -> Result<Option<f64>> {
        let block = blocks.iter().find(|b| b.name == name && b.length > 0);
        let Some(block) = block else { return Ok(None) };
        let kind = match (block.kind, block.length) {
            (8, 8..) => NumberType::F64,
            (6, 2) => NumberType::I16,
            (6 | 12, 4) => NumberType::I32,
            (7, 4..) => NumberType::F32,
            _ => {
                let expected =
                    format!("a number as {name}, found {} bytes of type {}", block.length, block.kind);
                return Err(source.wrong(FORMAT, block.offset, expected));
            }
        };
        let bytes = source.bytes(FORMAT, block.offset, kind.bytes() as u64)?;
        let mut fields = Fields::little(&bytes, block.offset);
        fields.number(kind).map(Some).map_err(|end| end.of(source, FORMAT))
    };
    let (wavelength, mult) = (number("Wavelength")?, number("Mult")?.unwrap_or(1.0));
    let (aspect, pixel) = (number("Aspect")?.unwrap_or(1.0), number("Pixel_size")?);
    let scale = wavelength.map(|w| w / mult).filter(|s| s.is_finite() && *s > 0.0);
    let Some(scale) = scale else {
        return Err(source.wrong(FORMAT, DIRECTORY, "blocks Wavelength and Mult above 0"));
    };
    let side = |millimetres: Option<f64>| {
        let length = millimetres.filter(|l| *l > 0.0)? * 1e-3;
        Quantity::new(length, Dimension::LENGTH).ok().map(Extent::Cell)
    };
    let extent = [side(pixel), side(pixel.map(|p| p * aspect))];
    let mut channels = Vec::new();
    for block in blocks.iter().filter(|b| b.kind == ARRAY && HEIGHTS.contains(&b.name.as_str())) {
        let bytes = source.bytes(FORMAT, block.offset, 6)?;
        let mut fields = Fields::little(&bytes, block.offset);
        let mut three = || Ok([fields.u16()?, fields.u16()?, fields.u16()?]);
        let [columns, rows, size] = three().map_err(|end: EndOfFields| end.of(source, FORMAT))?;
        let (kind, undefined) = match size {
            2 => (NumberType::I16, Undefined::AtLeast(32766.0)),
            4 => (NumberType::F32, Undefined::AtLeast(1e38_f32.into())),
            _ => return Err(source.wrong(FORMAT, block.offset + 4, "numbers of 2 or 4 bytes")),
        };
        let points = u64::from(columns) * u64::from(rows);
        if 6 + points * u64::from(size) > block.length {
            let expected = format!("a block of {columns} x {rows} numbers, found {} bytes", block.length);
            return Err(source.wrong(FORMAT, block.offset, expected));
        }
        let raw = RawHeights {
            order: AxisOrder::Columns,
            reversed: [false, true],
            scale,
            undefined,
            ..RawHeights::new(FORMAT, Bytes::File(block.offset + 6), kind)
        };
        let shape = [usize::from(rows), usize::from(columns)];
        let channel = StoredChannel::new(source, raw, shape, StoredUnit::written("nm"), extent)?;
        channels.push(StoredChannel { name: Some(block.name.clone()), ..channel });
    }
    Ok(channels)
}

/// The directory, whose first entry is itself.
fn blocks(source: &mut Source<'_>) -> Result<Vec<Block>> {
    let first = source.bytes(FORMAT, DIRECTORY, ENTRY)?;
    let (_, _, length) = entry(&first, DIRECTORY).map_err(|end| end.of(source, FORMAT))?;
    if length == 0 || length % ENTRY != 0 || length / ENTRY > MOST {
        let expected =
            format!("a directory of whole entries of {ENTRY} bytes, at most {MOST}, found {length} bytes");
        return Err(source.wrong(FORMAT, DIRECTORY, expected));
    }
    let bytes = source.bytes(FORMAT, DIRECTORY, length)?;
    let mut offset = DIRECTORY + length;
    let mut blocks = Vec::new();
    for (i, raw) in bytes.chunks_exact(ENTRY as usize).enumerate().skip(1) {
        let at = DIRECTORY + i as u64 * ENTRY;
        let (name, kind, length) = entry(raw, at).map_err(|end| end.of(source, FORMAT))?;
        blocks.push(Block { name, kind, length, offset });
        offset += length;
    }
    Ok(blocks)
}

/// Name, type and length; a negative length is none.
fn entry(bytes: &[u8], offset: u64) -> Result<(String, i16, u64), EndOfFields> {
    let mut fields = Fields::little(bytes, offset);
    let (name, kind) = (fields.text(16)?, fields.i16()?);
    Ok((name, kind, u64::try_from(fields.i32()?).unwrap_or(0)))
}
