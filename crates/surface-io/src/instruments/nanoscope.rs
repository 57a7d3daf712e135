//! Nanoscope, the files of Digital Instruments, Veeco and Bruker (.001, .spm): a text header of lines
//! `\Key: value` in sections `\*Name`, integers behind it.
//!
//! The height of a count is that of the whole range over the counts: the hard value of `@2:Z scale` (volts)
//! times the soft scale that it names (`[Sens. Zsens]`, nm/V) over 256^(bytes a pixel); from version 9.2 on
//! integers have four bytes whatever that entry says
//! (<http://www.physics.arizona.edu/~smanne/DI/software/fileformats.html>; the readers of Gwyddion and
//! `SurfaceTopography` agree). A channel whose soft scale is no length per volt (phase, amplitude) holds
//! counts. The first line in the file is the last row: y goes upwards, whatever the direction of the frame.
//!
//! `Scan Size` has the side along y where both sides have the ratio of `Aspect Ratio`; readers disagree on
//! the side of other images, which is left open and noted. All lines are read, also those beyond
//! `Valid data len`: the details tell how many are valid.
//!
//! Not read: versions before 4.3 (no `@2:Z scale`), data as text, force curves, files whose line ends were
//! changed.

use super::prelude::*;
use crate::entries::{HeaderLine, Section, TextHeader};
use crate::provenance::PRINTED;
use crate::quantity::{Dimension, Unit};

/// First bytes, in small letters.
const BEGINNINGS: [&[u8]; 3] = [b"\\*file list", b"\\*ec file list", b"\\*force file list"];
/// Longest header that is read: those of files have 8 to 80 kB.
const LONGEST: u64 = 1 << 20;
/// Integers have four bytes from this version on.
const WIDE: u32 = 0x0920_0000;

pub(crate) const READER: Reader = Reader { format: Format::Nanoscope, recognises, channels };

fn recognises(start: &[u8], _: u64) -> bool {
    let mut lines = start.split(|&b| b == b'\n').map(<[u8]>::trim_ascii);
    let first = lines.next().unwrap_or_default();
    // An export as text has the same header, and numbers behind it.
    BEGINNINGS.iter().any(|b| first.eq_ignore_ascii_case(b))
        && lines.all(|line| line.first().is_none_or(|&b| b == b'\\' || b < b' '))
}

fn channels(source: &mut OpenedFile<'_>) -> Result<Vec<StoredChannel>> {
    let bytes = source.start(LONGEST)?;
    let first = bytes.split_inclusive(|&b| b == b'\n').next().unwrap_or_default();
    if !first.ends_with(b"\r\n") || first.ends_with(b"\r\r\n") {
        // Numbers that look like line ends were changed too, and those behind them moved.
        let expected = "lines that end in CR LF; this file was copied as text, which damages its numbers";
        return Err(source.wrong(0, expected));
    }
    let expected = "the line \\*File list end of the header";
    let header = TextHeader::up_to_end(source, &bytes, line, expected)?;
    let lists = |ending: &'static str| header.sections().iter().filter(move |s| s.name.ends_with(ending));
    let find = |ending: &'static str, key: &str| lists(ending).find_map(|s| s.text(key));
    let version = find("file list", "version").unwrap_or_default().trim_start_matches("0x");
    let version = u32::from_str_radix(version, 16).unwrap_or(0);
    let curves = header
        .sections()
        .iter()
        .any(|s| s.name == "force file list" || s.text("operating mode") == Some("Force"));
    if curves || find("file list", "start context") == Some("FOL") {
        return Err(source.wrong(0, "a map; this file holds force curves"));
    }
    let scales = |key: &str| {
        ["scanner list", "microscope list", "scan list", "afm list", "stm list"]
            .iter()
            .find_map(|list| find(list, key))
    };
    let one =
        |image| StoredChannel::listed(name(image), channel(source, image, (version, header.end), &scales));
    lists("image list").map(one).collect()
}

fn line(line: &str) -> HeaderLine<'_> {
    if line.trim().eq_ignore_ascii_case("\\*File list end") {
        return HeaderLine::End;
    }
    let Some(entry) = line.trim().strip_prefix('\\') else {
        return HeaderLine::Wrong("a line of the header that begins with a backslash");
    };
    if let Some(name) = entry.strip_prefix('*') {
        return HeaderLine::Section(name);
    }
    // A key may hold a colon, as in `@2:Z scale: ...`.
    let (key, value) = entry.split_once(": ").unwrap_or((entry.trim_end_matches(':'), ""));
    HeaderLine::Entry(key, value)
}

fn channel<'s>(
    source: &OpenedFile<'_>,
    image: &Section,
    (version, end): (u32, u64),
    scales: &impl Fn(&str) -> Option<&'s str>,
) -> Result<StoredChannel> {
    let (columns, rows) = (image.whole("samps/line")?, image.whole("number of lines")?);
    let shape = [rows, columns];
    let (mut raw, range, offset) = counts(image, shape, version, end)?;
    let key = ["@4:z scale", "@2:z scale"].into_iter().find(|key| image.text(key).is_some());
    let Some(key) = key else {
        return Err(source.wrong(offset, "an entry @2:Z scale of each image (version 4.3 or later)"));
    };
    let scale = NanoscopeScale::read(image.text(key).unwrap_or_default());
    let unit = match scale.as_ref().and_then(|scale| scale.height(scales)) {
        Some((height, unit)) => {
            // All counts together make the range of the hard value.
            raw.scale = height / range;
            StoredUnit::Heights(unit)
        }
        None => StoredUnit::NoHeights(None),
    };
    let (size, aspect) = (image.text("scan size").unwrap_or_default(), image.text("aspect ratio"));
    let extent = extents(size, aspect);
    let mut channel = StoredChannel::new(source, raw, shape, unit, extent)?;
    channel.name = name(image);
    add_details(&mut channel, image);
    if scale.is_none() {
        channel.note(format!("no Z scale that can be read: {:?}", image.text(key).unwrap_or_default()));
    }
    if let ([Some(_), None], Some(aspect)) = (extent, aspect) {
        channel.note(format!(
            "the file says Scan Size {size} beside Aspect Ratio {aspect}; readers disagree on the side along y then"
        ));
    }
    Ok(channel)
}

/// The integers of an image behind a header that ends at `end`, the number of counts of their whole range,
/// and their offset.
fn counts(image: &Section, shape: [usize; 2], version: u32, end: u64) -> Result<(RawHeights, f64, u64)> {
    let (offset, length) = (image.whole("data offset")? as u64, image.whole("data length")? as u64);
    let pixel = if image.text("bytes/pixel").is_some() { image.whole("bytes/pixel")? } else { 2 };
    let range = match pixel {
        2 => 65_536.0,
        4 => 4_294_967_296.0,
        _ => return Err(image.wrong("bytes/pixel", "2 or 4 bytes")),
    };
    let bytes = |number: NumberType| number.bytes_of(shape);
    let wide = pixel == 4 || (version >= WIDE && bytes(NumberType::I32).is_some_and(|bytes| bytes <= length));
    let kind = if wide { NumberType::I32 } else { NumberType::I16 };
    if bytes(kind) != Some(length) {
        let [rows, columns] = shape;
        let expected = format!("{columns} x {rows} numbers of {} bytes", kind.bytes());
        return Err(image.wrong("data length", expected));
    }
    if offset < end {
        return Err(image.wrong("data offset", format!("a place behind the header, which ends at {end},")));
    }
    let raw = RawHeights { reversed: [false, true], ..RawHeights::at(offset, kind) };
    Ok((raw, range, offset))
}

/// Adds by what images of one name differ, and how many of the numbers are valid.
fn add_details(channel: &mut StoredChannel, image: &Section) {
    for (key, behind) in [("scan line", " scan"), ("line direction", "")] {
        if let Some(word) = image.text(key) {
            let word: String = word.to_lowercase().chars().take(32).collect();
            channel.detail(&format!("{word}{behind}"));
        }
    }
    let valid = ["valid data len x", "valid data len y"].map(|key| image.text(key)?.parse::<usize>().ok());
    if let [Some(x), Some(y)] = valid
        && [x, y] != [channel.columns, channel.rows]
    {
        channel.detail(&format!("of them {x} x {y} valid"));
    }
}

/// Name of what an image shows: the word in brackets, or else the one in quotes.
fn name(image: &Section) -> Option<String> {
    let keys = ["@2:image data", "@3:image data", "@4:image data", "image data"];
    let data = keys.into_iter().find_map(|key| image.text(key))?;
    let inside = |open: char, close: char| {
        let (_, rest) = data.split_once(open)?;
        let (word, _) = rest.split_once(close)?;
        (!word.trim().is_empty()).then(|| word.trim().to_owned())
    };
    inside('[', ']').or_else(|| inside('"', '"')).or_else(|| (!data.is_empty()).then(|| data.to_owned()))
}

/// `V [soft scale] (hard scale) value unit`.
struct NanoscopeScale<'a> {
    soft: Option<&'a str>,
    value: f64,
    unit: &'a str,
}

impl<'a> NanoscopeScale<'a> {
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

    /// Height of the whole range and its unit; `None` where the soft scale is no length per unit of the hard
    /// value.
    fn height<'s>(&self, scales: &impl Fn(&str) -> Option<&'s str>) -> Option<(f64, Unit)> {
        let soft = NanoscopeScale::read(scales(&format!("@{}", self.soft?.to_ascii_lowercase()))?)?;
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

/// `10 10 ~m`, or one number for a square; without the second side where the aspect ratio, x to y, is another
/// one.
fn extents(text: &str, aspect: Option<&str>) -> [Option<Extent>; 2] {
    let words: Vec<&str> = text.split_whitespace().collect();
    let (x, y, unit) = match words[..] {
        [x, y, unit] => (x, y, unit),
        [side, unit] => (side, side, unit),
        _ => return [None; 2],
    };
    let number = |text: &str| text.parse::<f64>().ok();
    let ratio =
        |text: &str| text.split_once(':').and_then(|(x, y)| Some(number(x.trim())? / number(y.trim())?));
    let (Some(x), Some(y)) = (number(x), number(y)) else { return [None; 2] };
    let agree = aspect.map_or(Some(x / y), ratio).is_some_and(|ratio| (x / y / ratio - 1.0).abs() <= PRINTED);
    let side = |side: f64| Extent::of_side(side, &unit.replace('~', "u"));
    [side(x), if agree { side(y) } else { None }]
}
