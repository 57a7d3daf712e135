//! AL3D, of Alicona's focus-variation microscopes: a list of tags of 52 bytes, and at `DepthImageOffset` the heights in metres, float32 row
//! by row, rows padded to eight bytes (Alicona's description of the format; the readers of Gwyddion and `SurfaceTopography` agree).
//!
//! The first row of the file is y = 0. Undefined are NaN and what `InvalidPixelValue` says. The picture and the quality map are not read.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredUnit, Undefined};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity};
use crate::reader::Reader;
use crate::source::{Fields, Source};

const FORMAT: Format = Format::Al3d;
const MAGIC: &[u8] = b"AliconaImaging\0\r\n";
/// Bytes of a tag: its name, its value, a line break.
const TAG: u64 = 52;
/// Most tags that are read.
const MOST: u64 = 4096;

pub(crate) const READER: Reader =
    Reader { format: FORMAT, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let begin = MAGIC.len() as u64;
    let [(version, _), (count, tags)] = [tag(source, begin)?, tag(source, begin + TAG)?];
    let tags: u64 = tags.parse().unwrap_or(u64::MAX);
    if version != "Version" || count != "TagCount" || tags > MOST {
        return Err(source.wrong(FORMAT, begin, "the tags Version and TagCount (at most 4096)"));
    }
    let tags: Vec<(String, String)> =
        (2..tags + 2).map(|i| tag(source, begin + i * TAG)).collect::<Result<_>>()?;
    let find = |key: &str| tags.iter().find(|t| t.0 == key).map(|t| t.1.as_str());
    let count = |key: &str| {
        let found = find(key).and_then(|text| text.parse::<u32>().ok());
        found.ok_or_else(|| source.wrong(FORMAT, begin, format!("a tag {key} with a whole number")))
    };
    let (columns, rows) = (count("Cols")? as usize, count("Rows")? as usize);
    let (offset, end) = (u64::from(count("DepthImageOffset")?), begin + (tags.len() as u64 + 2) * TAG);
    // 0 stands for none.
    if offset < end {
        let expected = format!("heights behind the tags, DepthImageOffset >= {end}");
        return Err(source.wrong(FORMAT, begin, expected));
    }
    let number = |key: &str| find(key).and_then(|text| text.parse::<f64>().ok());
    let side = |key: &str| {
        let cell = number(key).filter(|cell| *cell > 0.0)?;
        Quantity::new(cell, Dimension::LENGTH).ok().map(Extent::Cell)
    };
    let undefined = number("InvalidPixelValue").filter(|mark| mark.is_finite());
    let raw = RawHeights {
        line_bytes: Some((4 * columns as u64).div_ceil(8) * 8),
        undefined: undefined.map_or(Undefined::None, Undefined::Near),
        ..RawHeights::new(FORMAT, Bytes::File(offset), NumberType::F32)
    };
    let extent = [side("PixelSizeXMeter"), side("PixelSizeYMeter")];
    Ok(vec![StoredChannel::new(source, raw, [rows, columns], StoredUnit::written("m"), extent)?])
}

/// Name and value of the tag at an offset.
fn tag(source: &mut Source<'_>, offset: u64) -> Result<(String, String)> {
    let bytes = source.bytes(FORMAT, offset, TAG)?;
    let mut fields = Fields::little(&bytes, offset);
    let mut texts = || Ok((fields.text(20)?, fields.text(30)?));
    let found = texts().map_err(|end: crate::source::EndOfFields| end.of(source, FORMAT))?;
    if &bytes[50..] != b"\r\n" {
        return Err(source.wrong(FORMAT, offset + 50, "a line break behind each tag"));
    }
    Ok(found)
}
