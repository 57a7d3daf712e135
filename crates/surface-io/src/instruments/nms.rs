//! NMS, of the confocal microscopes µsurf of Nanofocus (also called `.orginal`): a header of 3468 bytes, the
//! heights as uint16 row by row, then the intensities, one byte each.
//!
//! After musurf-reader (<https://github.com/drocheam/musurf-reader>) and the reader of `SurfaceTopography`
//! 1.27.1. Height in µm of the number n: `low + (high - low) (n - first) / (last - first)`, where the numbers
//! `first` and `last` stand at offset 8 and the heights `low` and `high` of them at 16. The first row of the
//! file is y = 0. Where there are intensities, points of the intensity 0 are undefined.
//!
//! The sides of a cell at offset 1376 are nanometres: a file of a 100x objective, whose field is 160 µm, has
//! 512 cells and there the bytes `25 8a bb f6 ff 87 73 40`, 312.5. `SurfaceTopography` 1.27.1 takes them for
//! 312.5 mm and gets a map of 160 m. It also divides by 65534 instead of `last - first` = `ff ff 00 00` =
//! 65535: the largest number of that file is 65535, and its height is `high` to the last bit only with 65535.
//!
//! Not read: other versions than `OM_MS_2.0`, other numbers than uint16, profiles, files of several images
//! (SMS, SMT).

use super::prelude::*;
use crate::channel::MaskedHeights;

const VERSION: &[u8] = b"OM_MS_2.0\0";
const HEADER: u64 = 3468;

pub(crate) const READER: Reader = Reader {
    format: Format::Nms,
    recognises: |start, _| start.get(32..).is_some_and(|start| start.starts_with(VERSION)),
    channels,
};

header! {
    /// What counts of the header.
    struct NmsHeader {
        /// 2: uint16.
        kind: u32 = 0,
        /// 1: a map.
        dimensions: u32 = 4,
        /// First and last number of the range, and the heights that they stand for.
        numbers: [u32; 2] = 8,
        range: [f64; 2] = 16,
        name: Text<64> = 52,
        /// Columns and rows.
        shape: [u32; 2] = 1368,
        cell: [f64; 2] = 1376,
        intensities: u32 = 1416,
    }
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let header = NmsHeader::of(&mut source.fields(ByteOrder::Little, 0, HEADER)?)?;
    if [header.kind, header.dimensions] != [2, 1] {
        let expected = format!("a map of uint16 (2, 1), found {}, {}", header.kind, header.dimensions);
        return Err(source.wrong(0, expected));
    }
    let ([first, last], [low, high]) = (header.numbers.map(f64::from), header.range);
    let scale = (high - low) / (last - first);
    let raw = RawHeights { scale, shift: low - scale * first, ..RawHeights::at(HEADER, NumberType::U16) };
    let [columns, rows] = header.shape.map(|count| count as usize);
    let extent = header.cell.map(|cell| Extent::of_cell(cell, "nm"));
    let (shape, unit) = ([rows, columns], StoredUnit::written("um"));
    raw.check(source, rows, columns)?;
    let points = u64::from(header.shape[0]) * u64::from(header.shape[1]);
    let intensities = HEADER + 2 * points;
    let channel = if header.intensities == 0 {
        source.ends(HEADER, 2 * points)?;
        StoredChannel::new(source, raw, shape, unit, extent)?
    } else {
        source.ends(HEADER, 3 * points)?;
        // The heights of the mask are 1 where the intensity is 0, and undefined elsewhere.
        let dark = RawHeights {
            shift: 1.0,
            undefined: Undefined::AtLeast(1.0),
            ..RawHeights::at(intensities, NumberType::U8)
        };
        let masked = MaskedHeights { raw, mask: dark, detail: "points of intensity 0 undefined" };
        StoredChannel::masked(source, masked, shape, unit, extent)?
    };
    Ok(vec![channel.named(&header.name)])
}
