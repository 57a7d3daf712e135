//! AL3D, of Alicona's focus-variation microscopes: a list of tags of 52 bytes, and at `DepthImageOffset` the
//! heights in metres, float32 row by row, rows padded to eight bytes (Alicona's description of the format;
//! the readers of Gwyddion and `SurfaceTopography` agree).
//!
//! The first row of the file is y = 0. NaN and the value of `InvalidPixelValue` are undefined points. The
//! picture and the quality map are not read.

use super::prelude::*;

const MAGIC: &[u8] = b"AliconaImaging\0\r\n";
/// Bytes of a tag: its name, its value, a line break.
const TAG: u64 = 52;
/// Most tags that are read.
const MOST: u64 = 4096;

pub(crate) const READER: Reader =
    Reader { format: Format::Al3d, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let begin = MAGIC.len() as u64;
    let [(version, _), (count, tags)] = [tag(source, begin)?, tag(source, begin + TAG)?];
    let tags: u64 = tags.parse().unwrap_or(u64::MAX);
    if &*version != "Version" || &*count != "TagCount" || tags > MOST {
        return Err(source.wrong(begin, "the tags Version and TagCount (at most 4096)"));
    }
    let tags = (2..tags + 2).map(|i| tag(source, begin + i * TAG)).collect::<Result<Vec<_>>>()?;
    let find = |key: &str| tags.iter().find(|t| &*t.0 == key).map(|t| &*t.1);
    let count = |key: &str| {
        let found = find(key).and_then(|text| text.parse::<u32>().ok());
        found.ok_or_else(|| source.wrong(begin, format!("a tag {key} with a whole number")))
    };
    let (columns, rows) = (count("Cols")? as usize, count("Rows")? as usize);
    let (offset, end) = (u64::from(count("DepthImageOffset")?), begin + (tags.len() as u64 + 2) * TAG);
    // 0 stands for none.
    if offset < end {
        let expected = format!("heights behind the tags, DepthImageOffset >= {end}");
        return Err(source.wrong(begin, expected));
    }
    let number = |key: &str| find(key).and_then(|text| text.parse::<f64>().ok());
    let undefined = number("InvalidPixelValue").filter(|mark| mark.is_finite());
    let raw = RawHeights {
        line_bytes: Some((4 * columns as u64).div_ceil(8) * 8),
        undefined: undefined.map_or(Undefined::None, Undefined::Near),
        ..RawHeights::at(offset, NumberType::F32)
    };
    let side = |key: &str| Extent::of_cell(number(key)?, "m");
    let extent = [side("PixelSizeXMeter"), side("PixelSizeYMeter")];
    Ok(vec![StoredChannel::new(source, raw, [rows, columns], StoredUnit::written("m"), extent)?])
}

/// Name and value of the tag at an offset.
fn tag(source: &mut OpenedFile<'_>, offset: u64) -> Result<(Text<20>, Text<30>)> {
    let mut fields = source.fields(ByteOrder::Little, offset, TAG)?;
    let tag = (fields.get()?, fields.get()?);
    if fields.take(2)? != b"\r\n" {
        return Err(source.wrong(offset + 50, "a line break behind each tag"));
    }
    Ok(tag)
}
