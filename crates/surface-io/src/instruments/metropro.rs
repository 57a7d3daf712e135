//! MetroPro .dat, of Zygo's interferometers: a header of 834 or 4096 bytes, the intensities, and the phase as big-endian int32 row by row.
//!
//! Height of a count in metres: interference scale x obliquity x wavelength over 4096, 32768 or 131072 by the phase resolution
//! (MetroPro Reference Guide, OMP-0347; the readers of Gwyddion and `SurfaceTopography` agree). Numbers from 2147483640 on
//! are undefined; a lateral resolution of 0 is no size. The first row of the file is y = 0. Intensities are not read.
//!
//! Not read: files with the mark of another sign. Gwyddion, `SurfaceTopography` and itom turn their heights over; the formula of the
//! guide has no sign, and other readers follow it.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredUnit, Undefined};
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
    /// Format, 1 to 3, and length of the header.
    header: (u16, u32),
    /// Bytes of the intensities and of the phase by their shapes.
    by_shape: [u64; 2],
    /// The same as the header states them.
    stated: [u64; 2],
    columns: usize,
    rows: usize,
    /// Height of a fringe.
    fringe: f64,
    cell: f64,
    resolution: i16,
    sign: i16,
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.bytes(FORMAT, 0, HEADER)?;
    let phase = Phase::read(&bytes).map_err(|end: EndOfFields| end.of(source, FORMAT))?;
    let format = u16::from(bytes[3] - 0x6e);
    let header = if format == 3 { LONG_HEADER } else { HEADER };
    let wrong = |offset: u64, expected: String| Err(source.wrong(FORMAT, offset, expected));
    if (phase.header.0, u64::from(phase.header.1)) != (format, header) {
        let (found, length) = phase.header;
        return wrong(
            4,
            format!("the format {format} and {header} bytes of header, found {found} and {length}"),
        );
    }
    for (i, at) in [(0, 60), (1, 72)] {
        let [own, stated] = [phase.by_shape, phase.stated].map(|n| n[i]);
        if own != stated {
            return wrong(at, format!("{own} bytes, as width and height before say, found {stated}"));
        }
    }
    let counts = match (phase.resolution, format) {
        (0, _) => 4096.0,
        (1, _) => 32768.0,
        (2, 2..) => 131_072.0,
        _ => return wrong(218, "a phase resolution of 0 or 1, or 2 from the second format on".into()),
    };
    let scale = phase.fringe / counts;
    if !(scale.is_finite() && scale > 0.0) {
        return wrong(164, "a scale, a wavelength and an obliquity above 0".into());
    }
    if phase.sign != 0 {
        let expected =
            "no mark of another sign: readers disagree whether heights are turned over; export text";
        return wrong(232, expected.into());
    }
    let raw = RawHeights {
        scale,
        undefined: Undefined::AtLeast(2_147_483_640.0),
        ..RawHeights::new(FORMAT, Bytes::File(header + phase.stated[0]), NumberType::I32.big_endian())
    };
    let Phase { rows, columns, cell, .. } = phase;
    let side = (cell > 0.0).then(|| Quantity::new(cell, Dimension::LENGTH).ok().map(Extent::Cell)).flatten();
    Ok(vec![StoredChannel::new(source, raw, [rows, columns], StoredUnit::written("m"), [side; 2])?])
}

impl Phase {
    fn read(bytes: &[u8]) -> Result<Self, EndOfFields> {
        let mut fields = Fields::big(bytes, 0);
        let header = (fields.go(4).u16()?, fields.u32()?);
        let intensities: [u16; 3] = [fields.go(52).u16()?, fields.u16()?, fields.u16()?];
        let of_intensities = fields.go(60).u32()?;
        let [columns, rows] = [fields.go(68).u16()?, fields.u16()?];
        let of_phase = fields.u32()?;
        let [interference, wavelength] = [fields.go(164).f32()?, fields.f32()?];
        let obliquity = fields.go(176).f32()?;
        let before = 2 * intensities.iter().map(|&n| u64::from(n)).product::<u64>();
        Ok(Self {
            header,
            by_shape: [before, 4 * u64::from(columns) * u64::from(rows)],
            stated: [of_intensities, of_phase].map(u64::from),
            columns: columns.into(),
            rows: rows.into(),
            fringe: interference * obliquity * wavelength,
            cell: fields.go(184).f32()?,
            resolution: fields.go(218).i16()?,
            sign: fields.go(232).i16()?,
        })
    }
}
