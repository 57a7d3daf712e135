//! MI, of Molecular Imaging's, Agilent's and Keysight's probe microscopes: a text header of keys in 14
//! columns and values, and the maps one after another.
//!
//! After Gwyddion's `mifile.c`, which C. Anderson of Molecular Imaging wrote, and `SurfaceTopography`'s
//! `IO/MI.py`. `bufferLabel` begins the entries of a map; the line `data` ends the header and says the type:
//! little-endian int16 (`BINARY`, nothing) or int32 (`BINARY_32`). A height is `bufferRange * number / 2^15`
//! (`2^31`) in `bufferUnit`: the range contains `zSensitivity` already (in a real file 2.9025 um are 1.35e-8
//! m/V times the 215 V of the converter). Values in volts are no heights, nor are amplitudes and deflections
//! in metres. `xLength` and `yLength` are metres.
//!
//! The first line of the file is the bottom of the image, so the last row, whatever `scanUp` says. Not read:
//! spectra, data as text; `reverseX` and its like, which no reader uses: a note says where one is set.

use super::prelude::*;
use crate::channel::{check_number, check_rest};
use crate::entries::{HeaderLine, Section, TextHeader};

const IMAGE: &[u8] = b"fileType      Image";
const SPECTRA: &[u8] = b"fileType      Spectroscopy";
/// Columns of a key.
const KEY: usize = 14;
/// Longest header that is read: those of files have 5 kB.
const LONGEST: u64 = 1 << 20;

pub(crate) const READER: Reader = Reader {
    format: Format::Mi,
    recognises: |start, _| start.starts_with(IMAGE) || start.starts_with(SPECTRA),
    channels,
};

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.start(LONGEST)?;
    if bytes.starts_with(SPECTRA) {
        return Err(source.wrong(0, "an image; this file holds spectra"));
    }
    let header = TextHeader::up_to_end(source, &bytes, line, "the line data before this")?;
    let mut lines = bytes[..header.end as usize].trim_ascii_end().rsplit(|&b| b == b'\n');
    let number = match lines.next().unwrap_or_default().get(KEY..).unwrap_or_default().trim_ascii() {
        b"" | b"BINARY" => NumberType::I16,
        b"BINARY_32" => NumberType::I32,
        _ => return Err(source.wrong(header.end, "data of the type BINARY or BINARY_32 before this")),
    };
    let [about, maps @ ..] = header.sections() else { return Ok(Vec::new()) };
    check_number(source, 0, maps.len())?;
    let shape = [about.whole("ypixels")?, about.whole("xpixels")?];
    let length = number.bytes_of(shape).ok_or_else(|| about.wrong("ypixels", "fewer points"))?;
    let extent = ["xlength", "ylength"].map(|key| about.side(key, "m"));
    let one = |i: usize, map: &Section| {
        let name = map.text("bufferlabel").unwrap_or_default();
        let range = map.some_number("bufferrange")?;
        let raw = RawHeights {
            reversed: [false, true],
            // All numbers together make the range from its negative to itself.
            scale: 2.0 * range / number.values(),
            ..RawHeights::at(header.end.saturating_add((i as u64).saturating_mul(length)), number)
        };
        let unit = StoredUnit::of_signal(name, map.text("bufferunit").unwrap_or_default());
        let mut channel = StoredChannel::new(source, raw, shape, unit, extent)?;
        // Maps of one name differ by it.
        if let Some(direction) = map.text("direction") {
            channel.details.push_str(", ");
            channel.details.extend(direction.to_lowercase().chars().take(32));
        }
        for key in ["reversex", "reversey", "reversez"] {
            if about.text(key) == Some("TRUE") {
                channel.note(format!("the file says {key} TRUE, which is not used"));
            }
        }
        Ok(channel.named(name))
    };
    let name = |map: &Section| map.text("bufferlabel").map(str::to_owned);
    let found = maps.iter().enumerate().map(|(i, map)| StoredChannel::listed(name(map), one(i, map)));
    let mut found = found.collect::<Result<Vec<_>>>()?;
    let end = header.end.saturating_add(length.saturating_mul(maps.len() as u64));
    check_rest(&mut found, source, end, shape[1].saturating_mul(number.bytes()))?;
    Ok(found)
}

fn line(line: &str) -> HeaderLine<'_> {
    let (key, value) = line.split_at_checked(KEY).unwrap_or((line, ""));
    match key.trim_end() {
        "data" => HeaderLine::End,
        "bufferLabel" => HeaderLine::First(key, value),
        // What goes on from the line before.
        other if other.is_empty() || other.starts_with(' ') => HeaderLine::Passed,
        _ => HeaderLine::Entry(key, value),
    }
}
