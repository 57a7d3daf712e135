//! NID and EZD, of Nanosurf's probe microscopes: a text header of lines `Key=value` in sections `[Name]`, the
//! mark `#!`, and the maps one after another.
//!
//! After Gwyddion's `ezdfile.c` and `SurfaceTopography`'s `IO/EZD.py`. `Gr0-Ch1=DataSet-0:1` in `[DataSet]`
//! names the section of channel 1 of group 0; maps follow one another by group and channel. All integers of
//! `SaveBits` bits together make the range from `Dim2Min` to `Dim2Min` + `Dim2Range`: a height is `Dim2Range
//! / 2^bits * number + shift`, where the shift is that of the range from one about 0 (from 0 for unsigned
//! integers), as in Gwyddion; `SurfaceTopography` leaves it out. A shift that is 0 within the six digits of
//! the header is 0.
//!
//! The first line of the file is the bottom of the image, so the last row, whatever `Scan direction` says.
//! `Dim0Range` and `Dim1Range` are the sides; without two sides that are lengths (spectra) values are no
//! heights, nor are amplitudes and deflections in metres. Lines behind `CurLine` were not measured: a note
//! says so. Not read: data that are not `Binary`, the calibration (the ranges contain it).

use super::prelude::*;
use crate::channel::{check_number, check_rest};
use crate::entries::{HeaderLine, SIX_DIGITS, Section, TextHeader};

const MAGIC: &[u8] = b"[DataSet]\r\n";
/// What stands between the header and the first map, behind a line break.
const MARK: &[u8] = b"\n#!";
/// Longest header that is read: those of files have 10 to 40 kB.
const LONGEST: u64 = 1 << 20;
pub(crate) const READER: Reader =
    Reader { format: Format::Nid, recognises: |start, _| start.starts_with(MAGIC), channels };

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.start(LONGEST)?;
    let Some(end) = bytes.windows(MARK.len()).position(|part| part == MARK) else {
        return Err(source.wrong(bytes.len() as u64, "the mark #! before this (cut short?)"));
    };
    let (header, _) =
        TextHeader::read(source.subject(), &bytes[..=end], |line| HeaderLine::in_section(line, '='))?;
    let place = |key: &str| {
        let (group, channel) = key.strip_prefix("gr")?.split_once("-ch")?;
        Some([group.parse::<u32>().ok()?, channel.parse().ok()?])
    };
    let set = header.section("dataset");
    let mut maps: Vec<_> = set.entries().filter_map(|(key, name)| Some((place(key)?, key, name))).collect();
    check_number(source, 0, maps.len())?;
    maps.sort_by_key(|map| map.0);
    let mut at = (end + MARK.len()) as u64;
    let (mut channels, mut line_bytes) = (Vec::new(), 1);
    for (_, key, name) in maps {
        let map = header.sections().iter().find(|section| section.name == name.to_lowercase());
        // Where the others are is not known without it.
        let map = map.ok_or_else(|| set.wrong(key, "the name of a section"))?;
        let (shape, number, length) = layout(map)?;
        let title = format!(
            "{} ({})",
            map.text("frame").unwrap_or_default(),
            map.text("dim2name").unwrap_or_default()
        );
        let channel = channel(source, map, at, shape, number).map(|channel| channel.named(&title));
        channels.push(StoredChannel::listed(Some(title), channel)?);
        line_bytes = shape[1].saturating_mul(number.bytes());
        at = at.checked_add(length).ok_or_else(|| map.wrong("points", "fewer points"))?;
    }
    check_rest(&mut channels, source, at, line_bytes)?;
    Ok(channels)
}

/// Rows and columns, the type of the numbers, and the bytes of all.
fn layout(map: &Section) -> Result<([usize; 2], NumberType, u64)> {
    if map.text("savemode") != Some("Binary") {
        return Err(map.wrong("savemode", "Binary"));
    }
    if map.text("saveorder") != Some("Intel") {
        return Err(map.wrong("saveorder", "Intel, little-endian,"));
    }
    let letter = match map.text("savesign") {
        Some("Signed") => b'i',
        Some("Unsigned") => b'u',
        _ => return Err(map.wrong("savesign", "Signed or Unsigned")),
    };
    let number = match map.whole("savebits")? {
        bits @ (8 | 16 | 32) => NumberType::new(letter, bits as u8 / 8, true),
        _ => None,
    };
    let number = number.ok_or_else(|| map.wrong("savebits", "8, 16 or 32 bits"))?;
    let shape = [map.whole("lines")?, map.whole("points")?];
    let length = number.bytes_of(shape).ok_or_else(|| map.wrong("points", "fewer points"))?;
    Ok((shape, number, length))
}

fn channel(
    source: &OpenedFile<'_>,
    map: &Section,
    at: u64,
    shape: [usize; 2],
    number: NumberType,
) -> Result<StoredChannel> {
    let (range, low) = (map.some_number("dim2range")?, map.some_number("dim2min")?);
    let middle = if number.is_signed() { low + range / 2.0 } else { low };
    let shift = if middle.abs() <= SIX_DIGITS * range.abs() { 0.0 } else { middle };
    let scale = range / number.values();
    let raw = RawHeights { reversed: [false, true], scale, shift, ..RawHeights::at(at, number) };
    let side = |range: &str, unit: &str| map.side(range, map.text(unit)?);
    let extent = [side("dim0range", "dim0unit"), side("dim1range", "dim1unit")];
    let unit = match (map.text("dim2unit").unwrap_or_default(), extent) {
        (unit, [Some(_), Some(_)]) => StoredUnit::of_signal(map.text("dim2name").unwrap_or_default(), unit),
        (unit, _) => StoredUnit::NoHeights(Some(unit.to_owned()).filter(|unit| !unit.is_empty())),
    };
    let mut channel = StoredChannel::new(source, raw, shape, unit, extent)?;
    if let Some(line) = map.text("curline").and_then(|line| line.parse::<usize>().ok())
        && line.saturating_add(1) < shape[0]
    {
        channel.note(format!(
            "the scan ended in line {} of {}: the last ones were not measured",
            line + 1,
            shape[0]
        ));
    }
    Ok(channel)
}
