//! MetroPro .dat, of Zygo's interferometers: a header of 834 or 4096 bytes, the intensities, and the phase as
//! big-endian int32 row by row.
//!
//! Height of a count in metres: interference scale x obliquity x wavelength over 4096, 32768 or 131072 by the
//! phase resolution (MetroPro Reference Guide, OMP-0347; the readers of Gwyddion and `SurfaceTopography`
//! agree). Numbers from 2147483640 on are undefined; a lateral resolution of 0 is no size. The first row of
//! the file is y = 0. Intensities are not read.
//!
//! Not read: files with the mark of another sign. Gwyddion, `SurfaceTopography` and itom turn their heights
//! over; the formula of the guide has no sign, and other readers follow it.

use super::prelude::*;

/// First three bytes; the fourth is that of the header.
const MAGIC: &[u8] = b"\x88\x1b\x03";
const HEADER: u64 = 834;
const LONG_HEADER: u64 = 4096;

pub(crate) const READER: Reader = Reader {
    format: Format::MetroPro,
    recognises: |start, _| start.starts_with(MAGIC) && matches!(start.get(3), Some(0x6f..=0x71)),
    channels,
};

header! {
    /// What the header says of the phase.
    struct Phase {
        kind: u8 = 3,
        /// 1 to 3.
        format: u16 = 4,
        length: u32 = 6,
        intensities: [u16; 3] = 52,
        /// Bytes of the intensities, and of the phase.
        of_intensities: u32 = 60,
        columns: u16 = 68,
        rows: u16 = 70,
        bytes: u32 = 72,
        interference: f32 = 164,
        wavelength: f32 = 168,
        obliquity: f32 = 176,
        cell: f32 = 184,
        resolution: i16 = 218,
        sign: i16 = 232,
    }
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let phase = Phase::of(&mut source.fields(ByteOrder::Big, 0, HEADER)?)?;
    let wrong = |offset: u64, expected: String| Err(source.wrong(offset, expected));
    let format = u16::from(phase.kind - 0x6e);
    let header = if format == 3 { LONG_HEADER } else { HEADER };
    if (phase.format, u64::from(phase.length)) != (format, header) {
        let (found, length) = (phase.format, phase.length);
        return wrong(
            4,
            format!("the format {format} and {header} bytes of header, found {found} and {length}"),
        );
    }
    let intensities = 2 * phase.intensities.iter().map(|&n| u64::from(n)).product::<u64>();
    let points = u64::from(phase.columns) * u64::from(phase.rows);
    for (at, own, stated) in [(60, intensities, phase.of_intensities), (72, 4 * points, phase.bytes)] {
        if own != u64::from(stated) {
            return wrong(at, format!("{own} bytes, as width and height before say, found {stated}"));
        }
    }
    let counts = match (phase.resolution, format) {
        (0, _) => 4096.0,
        (1, _) => 32768.0,
        (2, 2..) => 131_072.0,
        _ => return wrong(218, "a phase resolution of 0 or 1, or 2 from the second format on".into()),
    };
    let scale =
        [phase.interference, phase.obliquity, phase.wavelength].map(f64::from).iter().product::<f64>()
            / counts;
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
        ..RawHeights::at(header + intensities, NumberType::I32.big_endian())
    };
    let shape = [phase.rows.into(), phase.columns.into()];
    let side = Extent::of_cell(phase.cell.into(), "m");
    Ok(vec![StoredChannel::new(source, raw, shape, StoredUnit::written("m"), [side; 2])?])
}
