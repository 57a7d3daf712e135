//! PLu, of Sensofar's confocal microscopes: a header of 500 bytes, then layers of heights in micrometres,
//! float32 row by row.
//!
//! The file has no first bytes of its own: it is recognised by its type (3, a topography), two shapes that
//! agree, cells of positive sides and its length (Gwyddion's and `SurfaceTopography`'s descriptions agree).
//! 1000001 is undefined; the first row of the file is y = 0.
//!
//! Further layers are read where no pictures are (`SurfaceTopography` has them one behind another); where
//! they stand beside pictures no description says, and only the first layer is read. Profiles and the
//! pictures are not read.

use super::prelude::*;

/// Bytes before the first layer, and those of a layer's shape and range.
const HEADER: u64 = 500;
const SHAPE: u64 = 8;
const RANGE: u64 = 8;
const TOPOGRAPHY: u32 = 3;
const UNDEFINED: f64 = 1_000_001.0;
/// Most points along a side: stitched maps have tens of thousands.
const MOST: u32 = 1 << 20;

pub(crate) const READER: Reader = Reader { format: Format::Plu, recognises, channels };

header! {
    /// The header as far as it counts.
    struct PluHeader {
        /// In letters, zeros behind it.
        date: [u8; 128] = 0,
        /// Rows and columns.
        shape: [u32; 2] = 388,
        cell: [f32; 2] = 404,
        kind: u32 = 428,
        layers: u8 = 489,
        pictures: u8 = 492,
        /// Shape of the first layer.
        first: [u32; 2] = 500,
    }
}

fn recognises(start: &[u8], length: u64) -> bool {
    let Ok(header) = PluHeader::of(&mut ByteFields::of_start(ByteOrder::Little, start)) else { return false };
    let date = header.date.split(|&b| b == 0).next().unwrap_or_default();
    let [rows, columns] = header.shape.map(|n| u64::from(n.min(MOST)));
    let bytes = 4 * rows * columns;
    (8..128).contains(&date.len())
        && date.iter().all(|b| b.is_ascii_graphic() || *b == b' ' || *b >= 0x80)
        && header.kind == TOPOGRAPHY
        && header.shape.iter().all(|n| (1..MOST).contains(n))
        && header.first == header.shape
        && header.layers > 0
        && header.cell.iter().all(|cell| cell.is_finite() && *cell > 0.0)
        && HEADER + SHAPE + bytes + RANGE <= length
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let header = PluHeader::of(&mut source.fields(ByteOrder::Little, 0, HEADER + SHAPE)?)?;
    let [rows, columns] = header.shape;
    let mut at = HEADER;
    let mut channels = Vec::new();
    let layers = if header.pictures == 0 { header.layers } else { 1 };
    for layer in 0..layers {
        if source.get::<[u32; 2]>(ByteOrder::Little, at)? != header.shape {
            return Err(source.wrong(at, format!("a layer of {rows} rows of {columns} points")));
        }
        let raw = RawHeights {
            undefined: Undefined::Equal(UNDEFINED),
            ..RawHeights::at(at + SHAPE, NumberType::F32)
        };
        let extent = header.cell.map(|cell| Extent::of_cell(cell.into(), "um"));
        let shape = [rows as usize, columns as usize];
        let mut channel = StoredChannel::new(source, raw, shape, StoredUnit::written("um"), extent)?;
        if header.layers > layers {
            channel.detail(&format!("the first of {} layers", header.layers));
        }
        channels.push(channel.named(&format!("layer{layer}")));
        at += SHAPE + 4 * u64::from(rows) * u64::from(columns) + RANGE;
    }
    Ok(channels)
}
