//! MetroPro .dat, of Zygo's interferometers: a header of 834 or 4096 bytes, the intensities, and the phase as big-endian int32 row by row.
//!
//! Height of a count in metres: interference scale x obliquity x wavelength over 4096, 32768 or 131072 by the phase resolution, its sign as
//! the header says (MetroPro Reference Guide, OMP-0347; the readers of Gwyddion and `SurfaceTopography` agree). Numbers from 2147483640 on
//! are undefined; a lateral resolution of 0 is no size. The first row of the file is y = 0. Intensities are not read.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredHeights, StoredUnit, Undefined};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity};
use crate::reader::Reader;
use crate::source::{EndOfFields, Fields, Source};

const FORMAT: Format = Format::MetroPro;
/// First three bytes; the fourth is that of the header.
const MAGIC: &[u8] = b"\x88\x1b\x03";
const HEADER: u64 = 834;
const LONG_HEADER: u64 = 4096;

pub(crate) const READER: Reader = Reader {
    format: FORMAT,
    recognises: |start, _| start.starts_with(MAGIC) && matches!(start.get(3), Some(0x6f..=0x71)),
    channels,
};

/// What the header says of the phase.
struct Phase {
    offset: u64,
    columns: usize,
    rows: usize,
    scale: f64,
    cell: f64,
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.bytes(FORMAT, 0, HEADER)?;
    let header = if bytes[3] == 0x71 { LONG_HEADER } else { HEADER };
    let phase = phase(&bytes, header).map_err(|end: EndOfFields| end.of(source, FORMAT))?;
    let Some(Phase { offset, columns, rows, scale, cell }) = phase else {
        let expected = format!("a header of {header} bytes and a phase resolution of 0, 1 or 2");
        return Err(source.wrong(FORMAT, 6, expected));
    };
    if !(scale.is_finite() && scale.abs() > 0.0) {
        return Err(source.wrong(FORMAT, 164, "a scale, a wavelength and an obliquity other than 0"));
    }
    let raw = RawHeights {
        scale,
        undefined: Undefined::AtLeast(2_147_483_640.0),
        ..RawHeights::new(FORMAT, Bytes::File(offset), NumberType::I32.big_endian())
    };
    raw.check(source, rows, columns)?;
    let side = (cell > 0.0).then(|| Quantity::new(cell, Dimension::LENGTH).ok().map(Extent::Cell)).flatten();
    Ok(vec![StoredChannel {
        name: None,
        details: raw.details(),
        rows,
        columns,
        unit: StoredUnit::written("m"),
        extent: [side; 2],
        heights: StoredHeights::Raw(raw),
    }])
}

/// `None` for a header of another length or resolution.
fn phase(bytes: &[u8], header: u64) -> Result<Option<Phase>, EndOfFields> {
    let mut fields = Fields::big(bytes, 0);
    let length = fields.go(6).u32()?;
    let intensities: [u16; 3] = [fields.go(52).u16()?, fields.u16()?, fields.u16()?];
    let [columns, rows] = [fields.go(68).u16()?, fields.u16()?];
    let [interference, wavelength] = [fields.go(164).f32()?, fields.f32()?];
    let obliquity = fields.go(176).f32()?;
    let cell = fields.go(184).f32()?;
    let counts = match fields.go(218).i16()? {
        0 => 4096.0,
        1 => 32768.0,
        2 => 131_072.0,
        _ => return Ok(None),
    };
    let sign = if fields.go(232).i16()? == 0 { 1.0 } else { -1.0 };
    let before = 2 * intensities.iter().map(|&n| u64::from(n)).product::<u64>();
    Ok((u64::from(length) == header).then(|| Phase {
        offset: header + before,
        columns: columns.into(),
        rows: rows.into(),
        scale: sign * interference * obliquity * wavelength / counts,
        cell,
    }))
}
