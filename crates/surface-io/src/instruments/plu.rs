//! PLu, of Sensofar's confocal microscopes: a header of 500 bytes, then layers of heights in micrometres, float32 row by row.
//!
//! The file has no first bytes of its own: it is told by its type (3, a topography), two shapes that agree, cells of positive sides and its
//! length (Gwyddion's and `SurfaceTopography`'s descriptions agree). 1000001 is undefined; the first row of the file is y = 0.
//!
//! Further layers are read where no pictures are (`SurfaceTopography` has them one behind another); where they stand beside pictures no
//! description says, and only the first layer is read. Profiles and the pictures are not read.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredUnit, Undefined};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity};
use crate::reader::Reader;
use crate::source::{EndOfFields, Fields, Source};

const FORMAT: Format = Format::Plu;
/// Bytes before the first layer, and those of a layer's shape and range.
const HEADER: u64 = 500;
const SHAPE: u64 = 8;
const RANGE: u64 = 8;
const TOPOGRAPHY: u32 = 3;
const UNDEFINED: f64 = 1_000_001.0;
/// Most points along a side: stitched maps have tens of thousands.
const MOST: u32 = 1 << 20;

pub(crate) const READER: Reader = Reader { format: FORMAT, recognises, channels };

/// The header as far as it counts.
#[derive(Debug, PartialEq)]
struct Header {
    shape: [u32; 2],
    cell: [f64; 2],
    kind: u32,
    layers: u8,
    pictures: u8,
    /// Shape of the first layer.
    first: [u32; 2],
}

impl Header {
    fn read(bytes: &[u8]) -> Result<Self, EndOfFields> {
        let mut fields = Fields::little(bytes, 0);
        let shape = [fields.go(388).u32()?, fields.u32()?];
        let cell = [fields.go(404).f32()?, fields.f32()?];
        let kind = fields.go(428).u32()?;
        let layers = fields.go(489).u8()?;
        let pictures = fields.go(492).u8()?;
        let first = [fields.go(500).u32()?, fields.u32()?];
        Ok(Self { shape, cell, kind, layers, pictures, first })
    }
}

fn recognises(start: &[u8], length: u64) -> bool {
    let Ok(header) = Header::read(start) else { return false };
    // The date, in letters, and zeros behind it.
    let date = start[..128].split(|&b| b == 0).next().unwrap_or_default();
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

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.bytes(FORMAT, 0, HEADER + SHAPE)?;
    let header = Header::read(&bytes).map_err(|end| end.of(source, FORMAT))?;
    let side = |micrometres: f64| Quantity::new(micrometres * 1e-6, Dimension::LENGTH).ok().map(Extent::Cell);
    let mut at = HEADER;
    let mut channels = Vec::new();
    let layers = if header.pictures == 0 { header.layers } else { 1 };
    for layer in 0..layers {
        let shape = source.bytes(FORMAT, at, SHAPE)?;
        let mut fields = Fields::little(&shape, at);
        let mut sides = || Ok([fields.u32()?, fields.u32()?]);
        let [rows, columns] = sides().map_err(|end: EndOfFields| end.of(source, FORMAT))?;
        if [rows, columns] != header.shape {
            let [rows, columns] = header.shape;
            return Err(source.wrong(FORMAT, at, format!("a layer of {rows} rows of {columns} points")));
        }
        let raw = RawHeights {
            undefined: Undefined::Equal(UNDEFINED),
            ..RawHeights::new(FORMAT, Bytes::File(at + SHAPE), NumberType::F32)
        };
        let shape = [rows as usize, columns as usize];
        let mut channel =
            StoredChannel::new(source, raw, shape, StoredUnit::written("um"), header.cell.map(side))?;
        channel.name = Some(format!("layer{layer}"));
        if header.layers > layers {
            channel.details = format!("{}, the first of {} layers", channel.details, header.layers);
        }
        channels.push(channel);
        let points = u64::from(rows) * u64::from(columns);
        at += SHAPE + 4 * points + RANGE;
    }
    Ok(channels)
}
