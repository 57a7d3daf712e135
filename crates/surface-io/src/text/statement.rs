//! One line of a header: its key, and lengths as programs write them.

use crate::quantity::{Dimension, Quantity};

/// A side and how far it may be rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Side {
    pub(crate) quantity: Quantity,
    /// Half of the last decimal that is printed, relative; 0 for whole numbers and those with an exponent.
    pub(crate) rounding: f64,
}

/// What a key is about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum HeadingStatement {
    /// Name of the channel.
    Channel,
    /// Side of the map along an axis; whether the key is one of scans, not a word of everyday.
    Side(usize, bool),
    /// Both sides, or the one of a square map.
    Size,
    /// Side of a cell along an axis, or along both.
    Cell(Option<usize>),
    /// Number of columns (axis 0) or rows (axis 1).
    Count(usize),
    HeightUnit,
    LateralUnit,
    /// Unit of the numbers, perhaps before they are converted to heights.
    DataUnit,
    /// Height of one unit of a number, in this unit.
    Factor(String),
    /// Nanometres of one count.
    BitToNm,
    /// A number that stands for an undefined point.
    Missing,
}

/// Kind, key and value of a line `key: value` or `key = value`, or with a tab between; `None` for what means
/// nothing here.
pub(super) fn key_and_value(text: &str) -> Option<(HeadingStatement, String, String)> {
    let text = text.trim().trim_start_matches(['\\', '@', '*']);
    let joined = joined(text);
    let of_table = joined.is_some();
    let text = &joined.unwrap_or_else(|| text.to_owned());
    // The second colon is that of Japanese.
    let between = text.find([':', '=', '\u{ff1a}']).or_else(|| text.find('\t')).or_else(|| grid(text));
    let (key, value) = match between {
        Some(between) => text.split_at(between),
        // `Z-data (um)`: the line above numbers.
        None => (text.as_str(), " "),
    };
    let value = unquoted(value.trim_start_matches([':', '=', '\u{ff1a}', '\t', ' ']));
    let key = unquoted(key);
    let lower = key.to_lowercase();
    if let Some(of) = lower.strip_prefix("height conversion factor") {
        // Cut out of the text as written: upper and lower case differ in units.
        let of = key.get(key.len() - of.len()..)?.trim().strip_prefix("(->")?.strip_suffix(')')?;
        return Some((HeadingStatement::Factor(of.trim().to_owned()), lower, value.to_owned()));
    }
    // A unit behind the key is that of the value.
    let (name, unit) = match key.strip_suffix([')', ']']).and_then(|k| k.rsplit_once(['(', '['])) {
        Some((name, unit)) => (name.trim(), unit.trim()),
        None => (key, ""),
    };
    let words = name.to_lowercase().replace(['_', '-'], " ");
    let words: Vec<&str> = words.split_whitespace().collect();
    let words = words.join(" ");
    // Of Keyence's tables the unit is that of the numbers; elsewhere it may be that of anything.
    let statement = if words == "unit" && of_table { HeadingStatement::DataUnit } else { known(&words)? };
    if between.is_none() && statement != HeadingStatement::HeightUnit {
        return None;
    }
    let value = if unit.is_empty() { value.to_owned() } else { format!("{value} {unit}") };
    Some((statement, words, value))
}

/// Cells of a line of a table as a key and its value: `"XY Calibration","7.4","um"`, also with semicolons,
/// tabs or without quotes; `None` for other lines.
fn joined(text: &str) -> Option<String> {
    let quoted = text.strip_prefix('"');
    let delimiter = [';', ',', '\t'].into_iter().find(|&delimiter| match quoted {
        Some(_) => text.contains(&['"', delimiter, '"'].iter().collect::<String>()),
        None => delimiter != '\t' && text.contains(delimiter) && !text.contains([':', '=', '\t']),
    })?;
    let between = if quoted.is_some() { format!("\"{delimiter}\"") } else { delimiter.to_string() };
    let (key, value) = quoted.unwrap_or(text).split_once(&between)?;
    let value = value.trim_end_matches('"').replace(&between, " ");
    Some(format!("{}: {}", key.trim(), value.trim()))
}

/// Where the key of a line of an ESRI grid ends: `ncols 4`.
fn grid(text: &str) -> Option<usize> {
    let between = text.find(' ')?;
    let known = ["ncols", "nrows", "cellsize", "nodata_value"];
    known.contains(&text[..between].to_lowercase().as_str()).then_some(between)
}

fn unquoted(text: &str) -> &str {
    text.trim().trim_matches('"').trim()
}

fn known(words: &str) -> Option<HeadingStatement> {
    Some(match words {
        "channel" | "channel name" => HeadingStatement::Channel,
        "width" => HeadingStatement::Side(0, false),
        "height" => HeadingStatement::Side(1, false),
        "x length" | "xlength" | "x size" | "size x" | "x range" | "x amplitude" | "scan size x"
        | "x scan size" | "scan range x" | "x scan range" | "length x" => HeadingStatement::Side(0, true),
        "y length" | "ylength" | "y size" | "size y" | "y range" | "y amplitude" | "scan size y"
        | "y scan size" | "scan range y" | "y scan range" | "length y" => HeadingStatement::Side(1, true),
        "scan size" | "scan range" | "scan area" | "image size" | "field of view" => HeadingStatement::Size,
        "pixel size" | "pixelsize" | "cell size" | "cellsize" | "xy calibration" | "point spacing"
        | "sample spacing" => HeadingStatement::Cell(None),
        "x pixel size" | "pixel size x" | "x spacing" | "spacing x" | "x step" | "step x" | "x increment"
        | "dx" | "x resolution" => HeadingStatement::Cell(Some(0)),
        "y pixel size" | "pixel size y" | "y spacing" | "spacing y" | "y step" | "step y" | "y increment"
        | "dy" | "y resolution" => HeadingStatement::Cell(Some(1)),
        "x pixels" | "pixels x" | "columns" | "number of columns" | "samps/line" | "samples/line" | "nx"
        | "w" | "ncols" | "numcols" | "horizontal" => HeadingStatement::Count(0),
        "y pixels" | "pixels y" | "rows" | "number of rows" | "number of lines" | "lines" | "ny" | "h"
        | "nrows" | "numrows" | "vertical" => HeadingStatement::Count(1),
        "value units"
        | "value unit"
        | "werteeinheiten"
        | "z unit"
        | "z units"
        | "height unit"
        | "height units"
        | "unit z"
        | "exported image units"
        | "z data" => HeadingStatement::HeightUnit,
        "lateral units" | "lateral unit" | "xy unit" | "xy units" | "x unit" | "x units" | "y unit"
        | "y units" => HeadingStatement::LateralUnit,
        "data unit" => HeadingStatement::DataUnit,
        "nodata value" => HeadingStatement::Missing,
        "bit2nm" => HeadingStatement::BitToNm,
        _ => return translated(words),
    })
}

/// The labels of Gwyddion's exports in the languages that it speaks besides English, as its own catalogues
/// (version 2.62) have them: Czech, German, Spanish, French, Italian, Japanese, Korean, Brazilian Portuguese
/// and Russian.
const TRANSLATED: [(HeadingStatement, &[&str]); 5] = [
    (HeadingStatement::Channel, &["kanál", "kanal", "canal", "canale", "チャネル", "채널", "канал"]),
    (
        HeadingStatement::Side(0, false),
        &["šířka", "breite", "anchura", "largeur", "larghezza", "幅", "폭", "largura", "ширина"],
    ),
    (
        HeadingStatement::Side(1, false),
        &["výška", "höhe", "altura", "hauteur", "altezza", "高さ", "높이", "высота"],
    ),
    (
        HeadingStatement::HeightUnit,
        &[
            "jednotky hodnot",
            "einheiten",
            "unités",
            "unità valore",
            "値の単位",
            "값 단위",
            "unidades de valor",
            "единицы измерения",
        ],
    ),
    (
        HeadingStatement::LateralUnit,
        &[
            "jednotky rozměrů",
            "unités latérales",
            "unità laterali",
            "水平単位",
            "unidades de laterais",
            "единицы горизонтальных размеров",
        ],
    ),
];

fn translated(words: &str) -> Option<HeadingStatement> {
    TRANSLATED.iter().find(|(_, labels)| labels.contains(&words)).map(|(statement, _)| statement.clone())
}

/// Words of units that programs print.
pub(super) const WORDS: [(&str, &str); 12] = [
    ("microns", "um"),
    ("micron", "um"),
    ("micrometers", "um"),
    ("micrometer", "um"),
    ("micrometres", "um"),
    ("micrometre", "um"),
    ("nanometers", "nm"),
    ("nanometer", "nm"),
    ("millimeters", "mm"),
    ("millimeter", "mm"),
    // The micro sign of Nanoscope's headers.
    ("~m", "um"),
    ("Angstrom", "angstrom"),
];

/// One or two lengths or plain numbers: `10 um`, `10 um x 5 um`, `10 x 5 um`, `10 5 um`; `None` for other
/// words.
pub(super) fn lengths(text: &str) -> Option<Vec<Side>> {
    let text = text.trim();
    let one = |text: &str| quantity(text).map(|side| vec![side]);
    if let Some(side) = one(text) {
        return Some(side);
    }
    let parts: Vec<&str> = text.split([' ', '\t', 'x', '\u{d7}']).filter(|part| !part.is_empty()).collect();
    let joined = match parts[..] {
        [x, y, unit] if number(x) && number(y) => [format!("{x} {unit}"), format!("{y} {unit}")],
        [x, unit, y, also] if number(x) && number(y) => [format!("{x} {unit}"), format!("{y} {also}")],
        _ => return None,
    };
    Some(vec![quantity(&joined[0])?, quantity(&joined[1])?])
}

fn number(text: &str) -> bool {
    text.replacen(',', ".", 1).parse::<f64>().is_ok()
}

/// A length or a plain number; `None` for other words.
fn quantity(text: &str) -> Option<Side> {
    let mut text = text.trim().to_owned();
    if let Some((word, symbol)) = WORDS.iter().find(|(word, _)| text.ends_with(word)) {
        text.truncate(text.len() - word.len());
        text += symbol;
    }
    if is_decimal_comma(text.split_whitespace().next()?) {
        text = text.replacen(',', ".", 1);
    }
    let quantity: Quantity = text.parse().ok()?;
    let known = quantity.dimension() == Dimension::LENGTH || quantity.dimension() == Dimension::NONE;
    let number = text.trim().split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-'))).next()?;
    let exponent = text.trim()[number.len()..].starts_with(['e', 'E']);
    let rounding = match (number.split_once('.'), number.parse::<f64>()) {
        (Some((_, decimals)), Ok(number)) if !exponent => {
            0.5 * 0.1_f64.powf(decimals.len() as f64) / number.abs()
        }
        _ => 0.0,
    };
    known.then_some(Side { quantity, rounding })
}

/// Whether a comma between digits can be no other than that of decimals: one of thousands has three digits
/// behind it.
pub(super) fn is_decimal_comma(text: &str) -> bool {
    let Some((whole, rest)) = text.split_once(',') else { return false };
    let digits = rest.bytes().take_while(u8::is_ascii_digit).count();
    let whole = whole.trim_start_matches(['+', '-']);
    digits > 0
        && whole.bytes().all(|b| b.is_ascii_digit())
        && !text.contains('.')
        && !rest.contains(',')
        && (digits != 3 || whole.is_empty() || whole == "0")
}
