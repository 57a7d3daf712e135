//! WSxM's images of probe microscopes (STP, TOP): a text header of lines `Key: value` in sections
//! `[Name]`, and one map behind it.
//!
//! After Gwyddion's `wsxmfile.c` and `SurfaceTopography`'s `IO/WSXM.py`. Numbers are little-endian, of `Image
//! Data Type` (int16 where there is none), row by row. Doubles and floats are heights in the unit of `Z
//! Amplitude`; an integer is worth `Z Amplitude` over `Maximum` less `Minimum`, which are integers of the
//! file. Gwyddion makes the range of all numbers the amplitude instead: the same within the digits that the
//! header prints. Heights are not counted from the smallest one: so the doubles and the integers of one map
//! are the same.
//!
//! The first number is the last of the last row: both readers turn the image by half a turn. The header ends
//! at its last line, whatever `Image header size` says (some programs miscount it). `X Amplitude` and `Y
//! Amplitude` are the sides. A `Z Amplitude` that is no length makes no heights.
//!
//! Not read: curves, movies, the offsets and the calibration of the scanner, which `Z Amplitude` contains: in
//! a real file 18.8851 nm are 973 counts of 20 V / 2^16 at a gain of 3 and 21.2 nm/V.

use super::prelude::*;
use crate::channel::check_rest;
use crate::entries::{HeaderLine, SIX_DIGITS, TextHeader, number_and_text};

const MAGIC: &[u8] = b"WSxM file copyright";
/// The second line of images; curves and movies have another one.
const IMAGE: &[u8] = b"SxM Image file";
/// Longest header that is read: those of files have 2 to 5 kB.
const LONGEST: u64 = 1 << 20;
pub(crate) const READER: Reader = Reader {
    format: Format::Wsxm,
    recognises: |start, _| {
        let second = start.split(|&b| b == b'\n').nth(1).unwrap_or_default();
        start.starts_with(MAGIC) && second.trim_ascii() == IMAGE
    },
    channels,
};

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.start(LONGEST)?;
    let header = TextHeader::up_to_end(source, &bytes, line, "the line [Header end] before this")?;
    let [general, control, other] =
        ["general info", "control", "miscellaneous"].map(|name| header.section(name));
    let number = match general.text("image data type") {
        None | Some("short" | "integer") => NumberType::I16,
        Some("float") => NumberType::F32,
        Some("double") => NumberType::F64,
        Some(_) => return Err(general.wrong("image data type", "short, float or double")),
    };
    let amplitude = general.text("z amplitude").and_then(number_and_text);
    let range = match (other.number("minimum")?, other.number("maximum")?) {
        (Some(low), Some(high)) => Some((high - low, low.abs() + high.abs())),
        _ => None,
    };
    let scale = match (amplitude, range) {
        (None, _) => 1.0,
        (Some((height, _)), Some((range, size))) if number.is_float() => {
            if (height - range).abs() > SIX_DIGITS * (height.abs() + size) {
                let expected = format!("the amplitude {range}, Maximum less Minimum,");
                return Err(general.wrong("z amplitude", expected));
            }
            1.0
        }
        (Some(_), None) if number.is_float() => 1.0,
        (Some((height, _)), Some((range, _))) => height / range,
        (Some(_), None) => return Err(other.wrong("maximum", "Maximum and Minimum of the integers")),
    };
    let name = general.text("acquisition channel").unwrap_or_default();
    let unit = amplitude.map_or(StoredUnit::Unknown, |(_, unit)| StoredUnit::of_signal(name, unit));
    let sides = ["x amplitude", "y amplitude"].map(|key| number_and_text(control.text(key)?));
    let raw = RawHeights { reversed: [true; 2], scale, ..RawHeights::at(header.end, number) };
    let shape @ [rows, columns] = [general.whole("number of rows")?, general.whole("number of columns")?];
    let extent = sides.map(|side| side.and_then(|(side, unit)| Extent::of_side(side, unit)));
    let mut channel = StoredChannel::new(source, raw, shape, unit, extent)?;
    let written = sides[0].map_or("", |(_, unit)| unit);
    channel.note_sides("sides", sides.map(|side| side.map(|(side, _)| side)), written);
    let mut channels = [channel.named(name)];
    if amplitude.is_none() {
        channels[0].note("no Z Amplitude with a number: the numbers of the file as they stand");
    }
    let line = columns * number.bytes();
    check_rest(&mut channels, source, header.end + (rows * line) as u64, line)?;
    Ok(channels.into())
}

fn line(line: &str) -> HeaderLine<'_> {
    let line = line.trim();
    if line == "[Header end]" {
        return HeaderLine::End;
    }
    HeaderLine::in_section(line, ':')
}
