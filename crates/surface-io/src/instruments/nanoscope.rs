//! Nanoscope, the files of Digital Instruments, Veeco and Bruker (.001, .spm): a text header of lines `\Key: value` in sections `\*Name`,
//! integers behind it.
//!
//! The height of a count is that of the whole range over the counts: the hard value of `@2:Z scale` (volts) times the soft scale that it
//! names (`[Sens. Zsens]`, nm/V) over 256^(bytes a pixel); from version 9.2 on integers have four bytes whatever that entry says
//! (<http://www.physics.arizona.edu/~smanne/DI/software/fileformats.html>; the readers of Gwyddion and `SurfaceTopography` agree). A channel
//! whose soft scale is no length per volt (phase, amplitude) holds counts. The first line in the file is the last row: y goes upwards,
//! whatever the direction of the frame.
//!
//! `Scan Size` has the side along y where both sides have the ratio of `Aspect Ratio`; readers disagree on the side of other images,
//! which is left open. All lines are read, also those beyond `Valid data len`: the details tell how many are valid.
//!
//! Not read: versions before 4.3 (no `@2:Z scale`), data as text, force curves, files whose line ends were changed.

use crate::channel::{Bytes, RawHeights, StoredChannel, StoredHeights, StoredUnit};
use crate::error::Result;
use crate::extent::Extent;
use crate::format::Format;
use crate::number_type::NumberType;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::reader::Reader;
use crate::source::Source;

const FORMAT: Format = Format::Nanoscope;
/// First bytes, in small letters.
const BEGINNINGS: [&[u8]; 3] = [b"\\*file list", b"\\*ec file list", b"\\*force file list"];
const END: &str = "\\*file list end";
/// Longest header that is read: those of files have 8 to 80 kB.
const LONGEST: u64 = 1 << 20;
/// Integers have four bytes from this version on.
const WIDE: u32 = 0x0920_0000;

pub(crate) const READER: Reader = Reader { format: FORMAT, recognises, channels };

fn recognises(start: &[u8], _: u64) -> bool {
    let mut lines = start.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.next().unwrap_or_default();
    // An export as text has the same header, and numbers behind it.
    BEGINNINGS.iter().any(|b| first.eq_ignore_ascii_case(b))
        && lines.all(|line| line.first().is_none_or(|&b| b == b'\\' || b < b' '))
}

/// A section: its name and its lines, keys in small letters, each with its offset.
struct Section {
    name: String,
    entries: Vec<(String, String, u64)>,
}

impl Section {
    fn find(&self, key: &str) -> Option<&str> {
        self.entries.iter().find(|e| e.0 == key).map(|e| e.1.as_str())
    }
}

fn channels(source: &mut Source<'_>) -> Result<Vec<StoredChannel>> {
    let (sections, end) = sections(source)?;
    let lists = |ending: &'static str| sections.iter().filter(move |s| s.name.ends_with(ending));
    let find = |ending: &'static str, key: &str| lists(ending).find_map(|s| s.find(key));
    let version = find("file list", "version").unwrap_or_default().trim_start_matches("0x");
    let version = u32::from_str_radix(version, 16).unwrap_or(0);
    let context = find("file list", "start context").unwrap_or_default();
    let curves = sections.first().is_some_and(|s| s.name == "force file list");
    if curves || sections.iter().any(|s| s.find("operating mode") == Some("Force")) || context == "FOL" {
        return Err(source.wrong(FORMAT, 0, "a map; this file holds force curves"));
    }
    let scales = |key: &str| {
        ["scanner list", "microscope list", "scan list", "afm list", "stm list"]
            .iter()
            .find_map(|list| find(list, key))
    };
    lists("image list").map(|image| channel(source, image, (version, end), &scales)).collect()
}

/// Reads the header up to its end, whose offset comes with it.
fn sections(source: &mut Source<'_>) -> Result<(Vec<Section>, u64)> {
    let bytes = source.start(LONGEST)?;
    let mut sections: Vec<Section> = Vec::new();
    let mut at = 0;
    for line in bytes.split_inclusive(|&b| b == b'\n') {
        let offset = at;
        at += line.len() as u64;
        if offset == 0 && (!line.ends_with(b"\r\n") || line.ends_with(b"\r\r\n")) {
            // Numbers that look like line ends were changed too, and those behind them moved.
            let expected = "lines that end in CR LF; this file was copied as text, which damages its numbers";
            return Err(source.wrong(FORMAT, offset, expected));
        }
        // Latin-1: degrees, and a tilde or the micro sign for micro.
        let line: String = line.trim_ascii().iter().map(|&b| char::from(b)).collect();
        if line.to_ascii_lowercase() == END {
            return Ok((sections, at));
        }
        let Some(entry) = line.strip_prefix('\\') else {
            return Err(source.wrong(FORMAT, offset, "a line of the header that begins with a backslash"));
        };
        if let Some(name) = entry.strip_prefix('*') {
            sections.push(Section { name: name.to_ascii_lowercase(), entries: Vec::new() });
        } else if let Some(section) = sections.last_mut() {
            // A key may hold a colon, as in `@2:Z scale: ...`.
            let (key, value) = entry.split_once(": ").unwrap_or((entry.trim_end_matches(':'), ""));
            section.entries.push((key.to_ascii_lowercase(), value.trim().to_owned(), offset));
        }
    }
    Err(source.wrong(FORMAT, at, "the line \\*File list end of the header (cut short?)"))
}

fn channel<'s>(
    source: &Source<'_>,
    image: &Section,
    (version, end): (u32, u64),
    scales: &impl Fn(&str) -> Option<&'s str>,
) -> Result<StoredChannel> {
    let at = |key: &str| image.entries.iter().find(|e| e.0 == key).map_or(0, |e| e.2);
    let number = |key: &'static str| {
        let found = image.find(key).and_then(|text| text.parse::<u64>().ok());
        found.ok_or_else(|| source.wrong(FORMAT, at(key), format!("a whole number as {key:?} of an image")))
    };
    let (columns, rows) = (number("samps/line")?, number("number of lines")?);
    let (offset, length) = (number("data offset")?, number("data length")?);
    let pixel = if image.find("bytes/pixel").is_some() { number("bytes/pixel")? } else { 2 };
    if !matches!(pixel, 2 | 4) {
        return Err(source.wrong(FORMAT, at("bytes/pixel"), "2 or 4 bytes a pixel"));
    }
    let points = columns.checked_mul(rows);
    let wide =
        pixel == 4 || (version >= WIDE && points.and_then(|n| n.checked_mul(4)).is_some_and(|n| n <= length));
    let kind = if wide { NumberType::I32 } else { NumberType::I16 };
    if points.and_then(|n| n.checked_mul(kind.bytes() as u64)).is_none_or(|bytes| bytes != length) {
        let size = kind.bytes();
        let expected = format!("a data length of {columns} x {rows} numbers of {size} bytes, found {length}");
        return Err(source.wrong(FORMAT, at("data length"), expected));
    }
    if offset < end {
        let expected = format!("a data offset behind the header, which ends at {end}, found {offset}");
        return Err(source.wrong(FORMAT, at("data offset"), expected));
    }
    let (columns, rows) = (columns as usize, rows as usize);
    let mut raw =
        RawHeights { reversed: [false, true], ..RawHeights::new(FORMAT, Bytes::File(offset), kind) };
    raw.check(source, rows, columns)?;
    let key = ["@4:z scale", "@2:z scale"].into_iter().find(|key| image.find(key).is_some());
    let Some(key) = key else {
        return Err(source.wrong(FORMAT, offset, "an entry @2:Z scale of each image (version 4.3 or later)"));
    };
    let unreadable =
        || source.wrong(FORMAT, at(key), "a Z scale such as V [Sens. Zsens] (0.005 V/LSB) 2.9 V");
    let scale = Scale::read(image.find(key).unwrap_or_default()).ok_or_else(unreadable)?;
    let unit = match scale.height(scales) {
        Some((height, unit)) => {
            // All counts together make the range of the hard value.
            raw.scale = height / 256_f64.powi(pixel as i32);
            StoredUnit::Heights(unit)
        }
        None => StoredUnit::NoHeights(None),
    };
    let mut details = raw.details();
    // Images of one name differ by these.
    for (key, behind) in [("scan line", " scan"), ("line direction", "")] {
        if let Some(word) = image.find(key) {
            let word: String = word.to_lowercase().chars().take(32).collect();
            details = format!("{details}, {word}{behind}");
        }
    }
    let valid = ["valid data len x", "valid data len y"].map(|key| image.find(key)?.parse::<usize>().ok());
    if let [Some(x), Some(y)] = valid
        && [x, y] != [columns, rows]
    {
        details = format!("{details}, of them {x} x {y} valid");
    }
    Ok(StoredChannel {
        name: name(image),
        details,
        rows,
        columns,
        unit,
        extent: extents(image.find("scan size").unwrap_or_default(), image.find("aspect ratio")),
        heights: StoredHeights::Raw(raw),
    })
}

/// Name of what an image shows: the word in brackets, or else the one in quotes.
fn name(image: &Section) -> Option<String> {
    let keys = ["@2:image data", "@3:image data", "@4:image data", "image data"];
    let data = keys.into_iter().find_map(|key| image.find(key))?;
    let inside = |open: char, close: char| {
        let (_, rest) = data.split_once(open)?;
        let (word, _) = rest.split_once(close)?;
        (!word.trim().is_empty()).then(|| word.trim().to_owned())
    };
    inside('[', ']').or_else(|| inside('"', '"')).or_else(|| (!data.is_empty()).then(|| data.to_owned()))
}

/// `V [soft scale] (hard scale) value unit`.
struct Scale<'a> {
    soft: Option<&'a str>,
    value: f64,
    unit: &'a str,
}

impl<'a> Scale<'a> {
    fn read(text: &'a str) -> Option<Self> {
        let mut rest = text.trim().strip_prefix(['V', 'C', 'S'])?.trim_start();
        let mut soft = None;
        if let Some(inner) = rest.strip_prefix('[') {
            let (name, behind) = inner.split_once(']')?;
            soft = (!name.trim().is_empty()).then(|| name.trim());
            rest = behind.trim_start();
        }
        if rest.starts_with('(') {
            // Units may have brackets of their own.
            let mut depth = 0;
            let end = rest.find(|c| {
                depth += i32::from(c == '(') - i32::from(c == ')');
                depth == 0
            })?;
            rest = rest[end + 1..].trim_start();
        }
        let (value, unit) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
        let value = value.parse::<f64>().ok().filter(|v| v.is_finite())?;
        Some(Self { soft, value, unit: unit.trim() })
    }

    /// Height of the whole range and its unit; `None` where the soft scale is no length per unit of the hard value.
    fn height<'s>(&self, scales: &impl Fn(&str) -> Option<&'s str>) -> Option<(f64, Unit)> {
        let soft = Scale::read(scales(&format!("@{}", self.soft?.to_ascii_lowercase()))?)?;
        let (length, per) = soft.unit.split_once('/')?;
        let unit = length_unit(length)?;
        let (hard, per): (Unit, Unit) = (self.unit.parse().ok()?, per.trim().parse().ok()?);
        if hard.dimension() != per.dimension() {
            return None;
        }
        let height = self.value * (hard.to_si(1.0) / per.to_si(1.0)) * soft.value;
        (height.is_finite() && height.abs() > 0.0).then_some((height, unit))
    }
}

/// A unit of length; a tilde stands for micro.
fn length_unit(text: &str) -> Option<Unit> {
    let unit: Unit = text.trim().replace('~', "u").parse().ok()?;
    (unit.dimension() == Dimension::LENGTH).then_some(unit)
}

/// `10 10 ~m`, or one number for a square; without the second side where the aspect ratio, x to y, is another one.
fn extents(text: &str, aspect: Option<&str>) -> [Option<Extent>; 2] {
    /// Digits that are printed of a side.
    const PRINTED: f64 = 5e-3;
    let words: Vec<&str> = text.split_whitespace().collect();
    let (x, y, unit) = match words[..] {
        [x, y, unit] => (x, y, unit),
        [side, unit] => (side, side, unit),
        _ => return [None; 2],
    };
    let Some(unit) = length_unit(unit) else { return [None; 2] };
    let [x, y] = [x, y].map(|side| {
        let length = Quantity::of(side.parse().ok()?, &unit).ok()?;
        (length.value() > 0.0).then_some(length)
    });
    let (Some(x), Some(y)) = (x, y) else { return [None; 2] };
    let ratio = aspect.map_or(Some(x.value() / y.value()), ratio);
    let agree = ratio.is_some_and(|ratio| (x.value() / y.value() / ratio - 1.0).abs() <= PRINTED);
    [Some(Extent::Side(x)), agree.then_some(Extent::Side(y))]
}

/// `2:1`.
fn ratio(text: &str) -> Option<f64> {
    let (x, y) = text.split_once(':')?;
    Some(x.trim().parse::<f64>().ok()? / y.trim().parse::<f64>().ok()?)
}
