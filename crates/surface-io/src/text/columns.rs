//! The columns of a table as its heading names them.
//!
//! A heading has a cell for each column: the name of a quantity, and often its unit, as `x [um]`, `z (nm)`,
//! `X_um` or `y/mm`. Units may also stand in a line of their own below the names.

use super::delimiter::Delimiter;
use super::statement::{WORDS, key_and_value};
use crate::array::axis_of;
use crate::channel::MOST_CHANNELS;
use crate::quantity::{Dimension, Unit};
use std::fmt;

/// What the values of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColumnKind {
    /// Coordinates along x (0) or y (1).
    Coordinate(usize),
    /// Numbers of columns (0) or rows (1).
    Index(usize),
    /// Longitudes (0) or latitudes (1).
    Degrees(usize),
    /// Coordinates along a profile of any direction.
    Along,
    Height,
    Other,
}

/// A column as its heading names it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TextColumn {
    /// As written.
    pub(crate) cell: String,
    pub(crate) name: String,
    pub(crate) kind: ColumnKind,
    /// As written, empty for none.
    pub(crate) unit: String,
}

impl fmt::Display for TextColumn {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (self.cell.as_str(), self.unit.as_str()) {
            ("", _) => f.write_str("(no name)"),
            (cell, unit) if unit.is_empty() || self.name != *cell => f.write_str(cell),
            (cell, unit) => write!(f, "{cell} ({unit})"),
        }
    }
}

/// Units that are no product of symbols.
const OTHER_UNITS: [&str; 14] = [
    "px", "pixel", "pixels", "pix", "deg", "degree", "degrees", "\u{b0}", "rad", "a.u.", "counts", "count",
    "lsb", "1",
];

/// The unit in a text, where it is one.
fn unit_of(text: &str) -> Option<&str> {
    let text = text.trim();
    let known = OTHER_UNITS.contains(&text.to_lowercase().as_str()) || length_or_other(text).is_some();
    (known && !text.is_empty()).then_some(text)
}

/// A unit as programs write it, also in words.
fn length_or_other(text: &str) -> Option<Unit> {
    Unit::of_file(symbol(text)).ok()
}

/// The symbol of a unit in words.
pub(crate) fn symbol(text: &str) -> &str {
    WORDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)).map_or(text, |(_, unit)| unit)
}

impl TextColumn {
    fn new(cell: &str) -> Self {
        let cell = cell.trim().trim_matches('"').trim();
        let (name, unit) = Self::split(cell).unwrap_or((cell, ""));
        let mut column = Self {
            cell: cell.to_owned(),
            name: name.to_owned(),
            kind: ColumnKind::Other,
            unit: unit.to_owned(),
        };
        column.kind = column.kind();
        column
    }

    /// Name and unit of a cell with both.
    fn split(cell: &str) -> Option<(&str, &str)> {
        let bracketed = cell.strip_suffix([']', ')']).and_then(|cell| cell.rsplit_once(['[', '(']));
        let (name, unit) = if let Some((name, unit)) = bracketed.or_else(|| cell.split_once('/')) {
            (name, unit_of(unit)?)
        } else {
            // Behind a name alone only a length is taken for a unit.
            let (name, unit) = cell.rsplit_once(['_', ' '])?;
            let length = length_or_other(unit).filter(|unit| unit.dimension() == Dimension::LENGTH);
            (name, length.map(|_| unit)?)
        };
        let name = name.trim_end_matches(['_', ' ']);
        let name = name.strip_suffix(" in").or_else(|| name.strip_suffix("_in")).unwrap_or(name);
        (!name.trim().is_empty()).then_some((name.trim(), unit))
    }

    fn kind(&self) -> ColumnKind {
        let lower = self.name.to_lowercase().replace(['_', '-', ':', '.'], " ");
        let words: Vec<&str> = lower.split_whitespace().collect();
        let words = match &words[..] {
            [name, "coordinate" | "coord" | "position" | "pos" | "axis" | "value" | "values"] => name,
            words => &*words.join(" "),
        };
        let is_length = self.length().is_some();
        let unit = self.unit.to_lowercase();
        let pixels = ["px", "pixel", "pixels", "pix"].contains(&unit.as_str());
        let degrees = unit.starts_with("deg") || unit == "\u{b0}";
        match (axis_of(words), words) {
            (Some(axis), name) if !is_length && (degrees || name.starts_with('l')) => {
                ColumnKind::Degrees(axis)
            }
            (Some(axis), name)
                if !is_length && (pixels || name.starts_with("col") || name.starts_with("row")) =>
            {
                ColumnKind::Index(axis)
            }
            (Some(axis), _) => ColumnKind::Coordinate(axis),
            // As ParaView writes points.
            (None, "points 0") => ColumnKind::Coordinate(0),
            (None, "points 1") => ColumnKind::Coordinate(1),
            (None, "points 2" | "z" | "height" | "heights" | "elevation" | "altitude" | "topography")
                if unit.is_empty() || is_length =>
            {
                ColumnKind::Height
            }
            (None, "distance" | "lateral" | "position" | "scan position" | "lateral distance") => {
                ColumnKind::Along
            }
            _ => ColumnKind::Other,
        }
    }

    pub(crate) fn length(&self) -> Option<Unit> {
        length_or_other(&self.unit).filter(|unit| unit.dimension() == Dimension::LENGTH)
    }

    /// Whether the cell is more than a word.
    pub(crate) fn tells(&self) -> bool {
        self.kind != ColumnKind::Other || !self.unit.is_empty()
    }

    /// Whether the cell can be nothing but the name of a column: a known one, or words with a unit.
    fn is_named(&self) -> bool {
        let words = !self.cell.contains(|c: char| c.is_ascii_digit() || matches!(c, ':' | '='));
        self.kind != ColumnKind::Other || (words && !self.unit.is_empty())
    }

    /// The axis that these are places along: 0 for x, 1 for y.
    pub(crate) fn axis(&self) -> Option<usize> {
        match self.kind {
            ColumnKind::Coordinate(axis) | ColumnKind::Index(axis) | ColumnKind::Degrees(axis) => Some(axis),
            _ => None,
        }
    }
}

/// The cells of a line with a delimiter. Between spaces, a unit in brackets belongs to the word before it.
fn cells(line: &str, delimiter: Delimiter) -> Vec<String> {
    let mut cells: Vec<String> = Vec::new();
    for cell in delimiter.tokens(line.as_bytes()).map(String::from_utf8_lossy) {
        match cells.last_mut() {
            Some(last) if delimiter == Delimiter::Whitespace && cell.starts_with(['[', '(']) => {
                last.push(' ');
                last.push_str(&cell);
            }
            _ => cells.push(cell.into_owned()),
        }
    }
    cells
}

/// The cells of a line that is a heading of this number of columns: none of them a number, in any delimiter,
/// first that of the numbers.
fn heading_cells(line: &str, own: Delimiter, count: usize) -> Option<(Delimiter, Vec<TextColumn>)> {
    // Some programs mark a heading as a comment of their own.
    let line = line.trim_start_matches(['/', '!', '*', ' ']);
    let all = [own, Delimiter::Tab, Delimiter::Semicolon, Delimiter::Comma, Delimiter::Whitespace];
    all.into_iter().find_map(|delimiter| {
        let mut cells = cells(line, delimiter);
        if cells.len() == count + 1 && cells.last().is_some_and(String::is_empty) {
            cells.pop();
        }
        let words = cells.iter().all(|cell| cell.trim_matches('"').parse::<f64>().is_err());
        let some = cells.iter().any(|cell| !cell.is_empty());
        (cells.len() == count && words && some)
            .then(|| (delimiter, cells.iter().map(|cell| TextColumn::new(cell)).collect()))
    })
}

/// The units in a line of nothing else, one for each column.
fn units(line: &str, own: Delimiter, count: usize) -> Option<Vec<String>> {
    let (_, cells) = heading_cells(line, own, count)?;
    let unit = |column: &TextColumn| {
        let text = column.cell.trim_matches(['[', ']', '(', ')']);
        if text.is_empty() { Some(String::new()) } else { unit_of(text).map(str::to_owned) }
    };
    let units: Option<Vec<String>> = cells.iter().map(unit).collect();
    units.filter(|units| units.iter().any(|unit| !unit.is_empty()))
}

/// The columns that the last of these lines names that names any, or the title, the last line of words before
/// the numbers; empty for none.
///
/// Words between spaces may be a sentence: two of them at least have to be names that are known, or to have a
/// unit. The title is believed in a delimiter alone.
pub(super) fn named(lines: &[String], title: Option<&str>, own: Delimiter, count: usize) -> Vec<TextColumn> {
    if count < 2 {
        return Vec::new();
    }
    let mut below = None;
    for line in lines.iter().rev() {
        if let Some(units) = units(line, own, count) {
            below = Some(units);
            continue;
        }
        let Some((delimiter, mut columns)) = heading_cells(line, own, count) else { continue };
        for (column, unit) in columns.iter_mut().zip(below.take().into_iter().flatten()) {
            if column.unit.is_empty() {
                column.unit = unit;
                column.kind = column.kind();
            }
        }
        let telling = columns.iter().filter(|column| column.tells()).count();
        if telling >= if delimiter == Delimiter::Whitespace { 2 } else { 1 } {
            return columns;
        }
    }
    let unknown =
        title.filter(|_| own != Delimiter::Whitespace).filter(|title| key_and_value(title).is_none());
    let found = unknown.and_then(|title| heading_cells(title, own, count));
    found.filter(|(delimiter, _)| *delimiter == own).map_or_else(Vec::new, |(_, columns)| columns)
}

/// Whether a line names two columns at least, and no line of numbers is at hand to say how many
/// columns there are.
pub(super) fn names_axes(line: &str) -> bool {
    let all = [Delimiter::Tab, Delimiter::Semicolon, Delimiter::Comma, Delimiter::Whitespace];
    all.into_iter().any(|delimiter| {
        let cells = cells(line, delimiter);
        (2..=MOST_CHANNELS).contains(&cells.len())
            && cells.iter().filter(|cell| TextColumn::new(cell).is_named()).count() >= 2
    })
}
