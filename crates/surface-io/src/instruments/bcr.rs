//! BCR-STM and BCRF, of the program SPIP of Image Metrology: a text header of 2048 or more characters, the
//! heights row by row as int16 (`bcrstm`) or float32 (`bcrf`). In the kinds `bcrstm_unicode` and
//! `bcrf_unicode` the characters of the header have two bytes.
//!
//! After Image Metrology's description of the format, Gwyddion's `bcrfile.c` and the reader of
//! `SurfaceTopography` (`IO/BCR.py`). Height = `bit2nm` x number in `zunit` (nm without it, as the sides are
//! in `xunit` and `yunit`); the first row of the file is y = 0. `intelmode` 0 is big-endian. Where
//! `voidpixels` is given and not 0, the integer 32767 and floats from 1.7e38 on are undefined points.
//!
//! `zmin` is not used: Gwyddion moves all heights so that the lowest is `zmin`, `SurfaceTopography` does not.
//! Not read: force curves.

use super::prelude::*;
use crate::entries::{HeaderLine, TextHeader};

/// What may stand before text of two bytes a character.
const MARK: &[u8] = b"\xff\xfe";
const KEY: &str = "fileformat";
/// Characters of the header where it does not say how many.
const HEADER: u64 = 2048;
/// Longest header that is read, in bytes.
const LONGEST: u64 = 1 << 16;
/// Floats from here on are undefined.
const VOID: f64 = 1.7e38;

pub(crate) const READER: Reader = Reader {
    format: Format::Bcr,
    recognises: |start, _| {
        let text = text(&start[..start.len().min(128)]).0;
        let value = text.strip_prefix(KEY).and_then(|rest| rest.trim_start().strip_prefix('='));
        value.is_some_and(|value| value.trim_start().starts_with("bcr"))
    },
    channels,
};

/// Text of one or two bytes a character, and how many.
fn text(bytes: &[u8]) -> (String, u64) {
    let bytes = bytes.strip_prefix(MARK).unwrap_or(bytes);
    if bytes.get(1) != Some(&0) {
        return (decoded(bytes), 1);
    }
    let units = bytes.chunks_exact(2).map(|two| u16::from_le_bytes([two[0], two[1]]));
    (char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect(), 2)
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let start = source.start(LONGEST)?;
    let marked = if start.starts_with(MARK) { MARK.len() as u64 } else { 0 };
    let wide = text(&start).1;
    let subject = source.subject().clone();
    let header = |bytes: u64| {
        let (text, _) = text(&start[..start.len().min(bytes as usize)]);
        let (header, _) = TextHeader::read(&subject, text.as_bytes(), |line| {
            if line.starts_with(['%', '#']) { HeaderLine::Passed } else { HeaderLine::entry(line, '=') }
        })?;
        Ok(header)
    };
    let first = header(HEADER * wide)?;
    let characters = match first.section("").text("headersize") {
        Some(_) => first.section("").whole("headersize")? as u64,
        None => HEADER,
    };
    let begin = characters.saturating_mul(wide).saturating_add(marked);
    let header = header(begin)?;
    let header = header.section("");
    let little = header.text("intelmode") != Some("0");
    let kind = header.text(KEY).unwrap_or_default();
    let number = match kind.trim_end_matches("_unicode") {
        "bcrstm" => NumberType::I16,
        "bcrf" => NumberType::F32,
        _ => return Err(header.wrong(KEY, "bcrstm or bcrf, with _unicode or without it")),
    };
    if kind.ends_with("_unicode") != (wide == 2) {
        return Err(header.wrong(KEY, format!("the kind of a header of {wide} byte a character")));
    }
    if header.number("forcecurve")?.is_some_and(|curve| curve.abs() > 0.0) {
        return Err(header.wrong("forcecurve", "0, a map"));
    }
    let [rows, columns] = [header.whole("ypixels")?, header.whole("xpixels")?];
    let void = header.number("voidpixels")?.is_some_and(|count| count.abs() > 0.0);
    let undefined = match number {
        NumberType::F32 => Undefined::AtLeast(VOID),
        _ if void => Undefined::Equal(i16::MAX.into()),
        _ => Undefined::None,
    };
    let scale = header.number("bit2nm")?;
    if scale.is_none() && !number.is_float() {
        return Err(header.wrong("bit2nm", "the height of a count"));
    }
    let number = if little { number } else { number.big_endian() };
    let raw = RawHeights { scale: scale.unwrap_or(1.0), undefined, ..RawHeights::at(begin, number) };
    let unit = |key: &str| header.text(key).filter(|unit| !unit.is_empty()).unwrap_or("nm");
    let lengths = [header.number("xlength")?, header.number("ylength")?];
    let extent = [0, 1].map(|i| Extent::of_side(lengths[i]?, unit(["xunit", "yunit"][i])));
    let heights = StoredUnit::written(unit("zunit"));
    let mut channel = StoredChannel::new(source, raw, [rows, columns], heights, extent)?;
    channel.note_sides("sides", lengths, unit("xunit"));
    source.ends(begin, number.bytes() as u64 * rows as u64 * columns as u64)?;
    Ok(vec![channel])
}
