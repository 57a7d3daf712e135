//! IBW, the binary waves of Igor Pro, as Asylum Research's microscopes write them: headers of 64 and 320
//! bytes, the numbers, and behind them a formula, a note, units and labels.
//!
//! After WaveMetrics' Technical Note 3 (Igor binary format), Gwyddion's `igorfile.c` and
//! `SurfaceTopography`'s `IO/IBW.py` (which reads by igor2). A file is recognised by its version and the
//! checksum of its headers, in either byte order. x runs fastest, then y, then the layers: each layer is a
//! channel, named by its label. The first line is the bottom of the image, so the last row. Values are as
//! they are, in the unit of the wave; a cell is `sfA` wide in the unit of its axis. NaN are undefined points.
//!
//! - **Asylum** (the file ends with `MFP3D` or `Force`, or labels end with `Trace` or `Retrace`). The unit of
//!   the wave is that of the heights only: layers whose label does not begin with `Height` or `ZSensor` hold
//!   amplitudes, phases or voltages, and are no heights (Gwyddion tells units by the same labels).
//! - **Other waves.** The unit is that of all layers.
//!
//! Not read: versions 1 to 3, whose waves have one dimension; complex numbers, texts, waves of four
//! dimensions; the note.

use super::prelude::*;
use crate::channel::check_number;

/// Bytes of both headers of version 5, and of the second one.
const HEADER: u64 = 384;
const WAVE: u64 = 320;
/// Bytes of a label.
const LABEL: u64 = 32;
/// Last bytes of a file of Asylum's programs.
const ASYLUM: [&[u8; 5]; 2] = [b"MFP3D", b"Force"];
/// Ends of their labels.
const DIRECTIONS: [&str; 2] = ["Trace", "Retrace"];
/// Beginnings of labels of heights in such files.
const HEIGHTS: [&str; 2] = ["Height", "ZSensor"];

pub(crate) const READER: Reader =
    Reader { format: Format::Ibw, recognises: |start, _| version(start).is_some(), channels };

/// The version and the byte order, where the sum of all words of the headers is 0.
fn version(start: &[u8]) -> Option<(u16, ByteOrder)> {
    [ByteOrder::Little, ByteOrder::Big].into_iter().find_map(|order| {
        let mut fields = ByteFields::of_start(order, start);
        let version = fields.get::<u16>().ok()?;
        let words = match version {
            1 => 59,
            2 => 63,
            3 => 65,
            5 => HEADER / 2,
            _ => return None,
        };
        let sum = (1..words).try_fold(version, |sum, _| Some(sum.wrapping_add(fields.get().ok()?)))?;
        (sum == 0).then_some((version, order))
    })
}

header! {
    /// Both headers.
    struct IbwHeader {
        /// Bytes of the second header and the numbers.
        wave: u32 = 4,
        /// Bytes of the formula and of the note.
        behind: [u32; 2] = 8,
        /// Bytes of units that are longer than three characters, of the numbers and along each axis.
        units: [u32; 5] = 16,
        labels: [u32; 4] = 36,
        points: u32 = 76,
        kind: u16 = 80,
        name: Text<32> = 92,
        count: [u32; 4] = 132,
        step: [f64; 4] = 148,
        unit: [Text<4>; 5] = 212,
    }
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let start = source.start(HEADER)?;
    let Some((5, order)) = version(&start) else {
        return Err(source.wrong(0, "version 5: waves of older versions have one dimension"));
    };
    let header = IbwHeader::of(&mut source.fields(order, 0, HEADER)?)?;
    let [columns, rows, layers] = shape(source, &header)?;
    let number = number_type(source, &header, order)?;
    check_length(source, &header, [columns, rows, layers], number.bytes() as u64)?;
    let units = units(source, &header, order)?;
    let labels = labels(source, &header, order, layers)?;
    let asylum = is_of_asylum(source, &labels)?;
    let one = u64::from(columns) * u64::from(rows) * number.bytes() as u64;
    let mut found = Vec::new();
    for (layer, label) in (0..).zip(labels) {
        let unit = match StoredUnit::written(&units[0]) {
            _ if asylum && !HEIGHTS.iter().any(|name| label.starts_with(name)) => StoredUnit::NoHeights(None),
            unit => unit,
        };
        let raw = RawHeights { reversed: [false, true], ..RawHeights::at(HEADER + layer * one, number) };
        let name = if label.is_empty() && layers == 1 { header.name.to_string() } else { label };
        let channel = layer_channel(source, &header, raw, unit, &units);
        let channel = channel.map(|channel| channel.named(&name));
        found.push(StoredChannel::listed(Some(name), channel)?);
    }
    Ok(found)
}

/// Columns, rows and layers of the wave.
fn shape(source: &OpenedFile<'_>, header: &IbwHeader) -> Result<[u32; 3]> {
    let [columns, rows, layers, more] = header.count;
    if rows == 0 || more > 0 {
        let expected = format!("a wave of two or three dimensions, found {:?}", header.count);
        return Err(source.wrong(132, expected));
    }
    let layers = layers.max(1);
    check_number(source, 140, layers as usize)?;
    Ok([columns, rows, layers])
}

/// The type of the numbers by its code.
fn number_type(source: &OpenedFile<'_>, header: &IbwHeader, order: ByteOrder) -> Result<NumberType> {
    let letter = if header.kind & 0x40 == 0 { b'i' } else { b'u' };
    let number = match header.kind {
        2 => Some((b'f', 4)),
        4 => Some((b'f', 8)),
        8 | 0x48 => Some((letter, 1)),
        0x10 | 0x50 => Some((letter, 2)),
        0x20 | 0x60 => Some((letter, 4)),
        0x80 | 0xc0 => Some((letter, 8)),
        _ => None,
    };
    let number = number.and_then(|(letter, size)| NumberType::new(letter, size, order == ByteOrder::Little));
    number.ok_or_else(|| source.wrong(80, format!("real numbers, found the type {:#x}", header.kind)))
}

/// Checks that both headers have the numbers of bytes and points of a wave of this shape, whose numbers have
/// `size` bytes.
fn check_length(source: &OpenedFile<'_>, header: &IbwHeader, shape: [u32; 3], size: u64) -> Result<()> {
    let points = shape.into_iter().try_fold(1, |n: u64, count| n.checked_mul(count.into()));
    let bytes =
        points.and_then(|points| points.checked_mul(size)).filter(|_| points == Some(header.points.into()));
    if bytes.is_none_or(|bytes| bytes.checked_add(WAVE) != Some(header.wave.into())) {
        let [columns, rows, layers] = shape;
        let expected = format!(
            "{WAVE} bytes and {columns} x {rows} x {layers} numbers of {size} bytes, found {} bytes and {} numbers",
            header.wave, header.points
        );
        return Err(source.wrong(4, expected));
    }
    Ok(())
}

/// Offset of the long units: they stand behind the numbers, the formula and the note.
fn offset_of_units(header: &IbwHeader) -> u64 {
    HEADER - WAVE + u64::from(header.wave) + header.behind.map(u64::from).iter().sum::<u64>()
}

/// Units of the numbers and along each axis; those of more than three characters stand behind the numbers.
fn units(source: &mut OpenedFile<'_>, header: &IbwHeader, order: ByteOrder) -> Result<Vec<String>> {
    let mut at = offset_of_units(header);
    let mut units = Vec::new();
    for (&long, short) in header.units.iter().zip(&header.unit) {
        let long = u64::from(long);
        units.push(if long == 0 {
            short.to_string()
        } else {
            source.fields(order, at, long)?.text(long as usize)?
        });
        at += long;
    }
    Ok(units)
}

/// Labels of the layers, empty for those without one.
fn labels(
    source: &mut OpenedFile<'_>,
    header: &IbwHeader,
    order: ByteOrder,
    layers: u32,
) -> Result<Vec<String>> {
    let before = header.units.iter().chain(&header.labels[..2]).map(|&bytes| u64::from(bytes));
    let at = offset_of_units(header) + before.sum::<u64>();
    // The first label is that of the axis.
    let mut labels = Vec::new();
    for layer in 0..u64::from(layers) {
        let is_there = (layer + 2) * LABEL <= header.labels[2].into();
        let label =
            if is_there { source.get(order, at + (layer + 1) * LABEL)? } else { Text::<32>::default() };
        labels.push(label.to_string());
    }
    Ok(labels)
}

/// Whether the file is one of Asylum's programs, by its end or its labels.
fn is_of_asylum(source: &mut OpenedFile<'_>, labels: &[String]) -> Result<bool> {
    let end = source.bytes(source.length() - 5, 5)?;
    Ok(ASYLUM.iter().any(|mark| end == *mark)
        || labels.iter().any(|label| DIRECTIONS.iter().any(|word| label.ends_with(word))))
}

/// The channel of a layer, without a name.
fn layer_channel(
    source: &OpenedFile<'_>,
    header: &IbwHeader,
    raw: RawHeights,
    unit: StoredUnit,
    units: &[String],
) -> Result<StoredChannel> {
    let [columns, rows, ..] = header.count.map(|count| count as usize);
    let extent = [0, 1].map(|axis| Extent::of_cell(header.step[axis], &units[axis + 1]));
    let mut channel = StoredChannel::new(source, raw, [rows, columns], unit, extent)?;
    channel.note_sides("cells of", [0, 1].map(|axis| Some(header.step[axis])), &units[1]);
    Ok(channel)
}
