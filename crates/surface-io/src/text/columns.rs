//! The columns of a table as its heading names them, and the maps that they are.
//!
//! A heading has a cell for each column: the name of a quantity, and often its unit, as `x [um]`, `z (nm)`,
//! `X_um` or `y/mm`. Units may also stand in a line of their own below the names. [`layout`] alone decides
//! what the columns are:
//!
//! - x, y and others are points of a map; heights where there are columns of heights, else every other column
//!   is a channel of its own.
//! - One coordinate and others are profiles, likewise.
//! - Numbers of rows and columns (`row`, `col`) are places without a length: the side of a cell is asked for.
//! - Degrees are no lengths, and columns without a coordinate are no map: both are refused.
//! - Without a heading the numbers decide, or the format that was requested.

use super::statement::{WORDS, key_and_value};
use super::{Delimiter, TextTable};
use crate::array::axis_of;
use crate::channel::{MOST_CHANNELS, StoredUnit};
use crate::error::ContentError;
use crate::format::Format;
use crate::options::ReadOptions;
use crate::points::is_full_grid;
use crate::provenance::contradiction;
use crate::quantity::{Dimension, Unit};
use std::fmt;

/// What the values of a column are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
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
pub(super) struct Column {
    /// As written.
    cell: String,
    name: String,
    kind: Kind,
    /// As written, empty for none.
    unit: String,
}

impl fmt::Display for Column {
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
fn symbol(text: &str) -> &str {
    WORDS.iter().find(|(word, _)| word.eq_ignore_ascii_case(text)).map_or(text, |(_, unit)| unit)
}

impl Column {
    fn new(cell: &str) -> Self {
        let cell = cell.trim().trim_matches('"').trim();
        let (name, unit) = Self::split(cell).unwrap_or((cell, ""));
        let mut column =
            Self { cell: cell.to_owned(), name: name.to_owned(), kind: Kind::Other, unit: unit.to_owned() };
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

    fn kind(&self) -> Kind {
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
            (Some(axis), name) if !is_length && (degrees || name.starts_with('l')) => Kind::Degrees(axis),
            (Some(axis), name)
                if !is_length && (pixels || name.starts_with("col") || name.starts_with("row")) =>
            {
                Kind::Index(axis)
            }
            (Some(axis), _) => Kind::Coordinate(axis),
            // As ParaView writes points.
            (None, "points 0") => Kind::Coordinate(0),
            (None, "points 1") => Kind::Coordinate(1),
            (None, "points 2" | "z" | "height" | "heights" | "elevation" | "altitude" | "topography")
                if unit.is_empty() || is_length =>
            {
                Kind::Height
            }
            (None, "distance" | "lateral" | "position" | "scan position" | "lateral distance") => Kind::Along,
            _ => Kind::Other,
        }
    }

    fn length(&self) -> Option<Unit> {
        length_or_other(&self.unit).filter(|unit| unit.dimension() == Dimension::LENGTH)
    }

    /// Whether the cell is more than a word.
    fn tells(&self) -> bool {
        self.kind != Kind::Other || !self.unit.is_empty()
    }

    /// Whether the cell can be nothing but the name of a column: a known one, or words with a unit.
    fn is_named(&self) -> bool {
        let words = !self.cell.contains(|c: char| c.is_ascii_digit() || matches!(c, ':' | '='));
        self.kind != Kind::Other || (words && !self.unit.is_empty())
    }

    /// The axis that these are places along: 0 for x, 1 for y.
    fn axis(&self) -> Option<usize> {
        match self.kind {
            Kind::Coordinate(axis) | Kind::Index(axis) | Kind::Degrees(axis) => Some(axis),
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
fn heading_cells(line: &str, own: Delimiter, count: usize) -> Option<(Delimiter, Vec<Column>)> {
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
            .then(|| (delimiter, cells.iter().map(|cell| Column::new(cell)).collect()))
    })
}

/// The units in a line of nothing else, one for each column.
fn units(line: &str, own: Delimiter, count: usize) -> Option<Vec<String>> {
    let (_, cells) = heading_cells(line, own, count)?;
    let unit = |column: &Column| {
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
pub(super) fn named(lines: &[String], title: Option<&str>, own: Delimiter, count: usize) -> Vec<Column> {
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
            && cells.iter().filter(|cell| Column::new(cell).is_named()).count() >= 2
    })
}

/// One map of the points of a table: which columns are their coordinates, and which their values.
#[derive(Debug)]
pub(crate) struct PointColumns {
    /// Along x and y, or along a profile.
    pub(crate) axes: Vec<AxisColumn>,
    pub(crate) value: usize,
    /// Name of the channel, where several columns are channels.
    pub(crate) name: Option<String>,
    pub(crate) unit: StoredUnit,
    pub(crate) notes: Vec<String>,
}

/// A column of coordinates.
#[derive(Debug)]
pub(crate) struct AxisColumn {
    pub(crate) at: usize,
    pub(crate) unit: Option<Unit>,
    /// Whether these are numbers of rows or columns, in steps of 1 without a length.
    pub(crate) index: bool,
}

/// What a table of numbers is.
#[derive(Debug)]
pub(crate) enum Layout {
    Matrix,
    Points(Vec<PointColumns>),
    Profiles(Vec<PointColumns>),
}

impl Layout {
    pub(crate) fn format(&self) -> Format {
        match self {
            Self::Matrix => Format::Text,
            Self::Points(_) => Format::Xyz,
            Self::Profiles(_) => Format::Profile,
        }
    }
}

/// What a table is: as its heading names its columns, and as its numbers are where it has no such heading.
///
/// # Errors
/// [`ContentError::Columns`] where the named columns are no map; [`ContentError::Ambiguous`] for three columns
/// without a name that may be points or a matrix; [`ContentError::NoPoint`] where the number of columns is not
/// that of the requested format; contradictions between statements about units.
pub(crate) fn layout(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    if requested == Some(Format::Text) || !table.heading.columns.iter().any(Column::tells) {
        return by_numbers(table, requested, declared);
    }
    by_names(table, requested, declared)
}

/// The columns in the order x, y, z or x, z.
fn by_numbers(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    let format = match requested {
        Some(format) => format,
        None => format_of(table)?,
    };
    let expected = match format {
        Format::Xyz if table.columns != 3 => "x, y and z of one point",
        Format::Profile if table.columns != 2 => "x and z of one point of a profile",
        Format::Xyz | Format::Profile => {
            let (last, unit) = (table.columns - 1, lateral_unit(table, None, declared)?);
            let axes = (0..last).map(|at| AxisColumn { at, unit: unit.clone(), index: false }).collect();
            let names = table.heading.named();
            let notes = names.map(|names| format!("{names}, which are taken in the order of points"));
            let (unit, notes) = (table.heading.stored_unit(), notes.into_iter().collect());
            let points = vec![PointColumns { axes, value: last, name: None, unit, notes }];
            return Ok(if format == Format::Xyz { Layout::Points(points) } else { Layout::Profiles(points) });
        }
        _ => return Ok(Layout::Matrix),
    };
    Err(ContentError::NoPoint { line: table.first_line(), found: table.columns, expected })
}

/// Whether numbers without names are a matrix, points or a profile.
fn format_of(table: &TextTable) -> Result<Format, ContentError> {
    if table.columns == 3 && table.rows() > 3 {
        // Numbers whose first two columns are all places of a grid, each once, are no heights.
        let places = || is_full_grid(table).then_some(Format::Xyz);
        let ambiguous = ContentError::Ambiguous { lines: table.rows() };
        return table.heading.format().or_else(places).ok_or(ambiguous);
    }
    Ok(if table.is_profile() { Format::Profile } else { Format::Text })
}

/// The columns by their names.
fn by_names(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    let columns = &table.heading.columns;
    let refused = |problem: String| {
        let columns: Vec<String> = columns.iter().map(ToString::to_string).collect();
        ContentError::Columns { columns: columns.join(", "), problem }
    };
    let of = |is: &dyn Fn(&Column) -> bool| -> Vec<usize> {
        (0..columns.len()).filter(|&at| is(&columns[at])).collect()
    };
    let [along_x, along_y] = [0, 1].map(|axis| of(&|column| column.axis() == Some(axis)));
    for places in [&along_x, &along_y] {
        if let [first, second, ..] = places[..] {
            let (first, second) = (&columns[first], &columns[second]);
            return Err(refused(format!("{first} and {second} are along one axis, expected one of them")));
        }
    }
    if let Some(column) = columns.iter().find(|column| matches!(column.kind, Kind::Degrees(_))) {
        let remedy = "project the points to lengths, such as metres of easting and northing";
        return Err(refused(format!("{column} is an angle, and no length: {remedy}")));
    }
    let (mut x, mut y) = (along_x.first().copied(), along_y.first().copied());
    let heights = of(&|column| column.kind == Kind::Height);
    let mut others = of(&|column| column.kind == Kind::Other && !column.name.is_empty());
    if let (None, None) = (x, y) {
        x = of(&|column| column.kind == Kind::Along).first().copied();
    } else {
        others.extend(of(&|column| column.kind == Kind::Along));
        others.sort_unstable();
    }
    let mut values = if heights.is_empty() { others } else { heights };
    if let (Some(Format::Profile), Some(_), Some(value), []) = (requested, x, y, &values[..]) {
        // y over x.
        (y, values) = (None, vec![value]);
    }
    let leave = "skip_lines leaves out the heading, and format = \"text\" takes all columns for heights";
    let axes = match (x, y) {
        (None, None) => {
            return Err(refused(format!(
                "expected coordinates x and y, or x of a profile, among them; {leave}"
            )));
        }
        (Some(x), Some(y)) => vec![x, y],
        (Some(along), None) | (None, Some(along)) => vec![along],
    };
    let wrong = match (requested, axes.len()) {
        (Some(Format::Xyz), 1) => Some("points need x and y"),
        (Some(Format::Profile), 2) => Some("a profile needs x and heights alone"),
        _ => None,
    };
    if let Some(wrong) = wrong {
        return Err(refused(format!("{wrong}; {leave}")));
    }
    if values.is_empty() {
        let remedy = "expected a column of heights beside the coordinates";
        let profile = "format = \"profile\" takes y for heights over x";
        return Err(refused(if columns.len() == 2 {
            format!("{remedy}; {profile}")
        } else {
            remedy.to_owned()
        }));
    }
    if values.len() > MOST_CHANNELS {
        return Err(refused(format!(
            "expected at most {MOST_CHANNELS} columns of heights, found {}",
            values.len()
        )));
    }
    let unused: Vec<String> = (0..columns.len())
        .filter(|at| !axes.contains(at) && !values.contains(at) && !columns[*at].cell.is_empty())
        .map(|at| columns[at].to_string())
        .collect();
    let several = values.len() > 1;
    let mut maps = Vec::with_capacity(values.len());
    let places = axes;
    for value in values {
        let axes = places.iter().map(|&at| axis_column(table, at, declared)).collect::<Result<_, _>>()?;
        let column = &columns[value];
        let named = several || column.kind == Kind::Other;
        let mut notes = Vec::new();
        if !unused.is_empty() {
            notes.push(format!(
                "the heading names further columns, which are not used: {}",
                unused.join(", ")
            ));
        }
        let name = named.then(|| column.name.clone());
        maps.push(PointColumns { axes, value, name, unit: unit_of_values(table, column)?, notes });
    }
    Ok(if places.len() == 2 { Layout::Points(maps) } else { Layout::Profiles(maps) })
}

/// The unit of the values of a column: that of its heading, or of a statement about heights.
fn unit_of_values(table: &TextTable, column: &Column) -> Result<StoredUnit, ContentError> {
    match (StoredUnit::written(symbol(&column.unit)), table.heading.stored_unit()) {
        (StoredUnit::Unknown, stated) => Ok(stated),
        (StoredUnit::Heights(own), StoredUnit::Heights(stated)) if !own.same(&stated) => {
            Err(ContentError::contradiction(
                "two lines of the header",
                format!("value units: {stated}"),
                format!("the column {column}"),
            ))
        }
        (own, _) => Ok(own),
    }
}

fn axis_column(table: &TextTable, at: usize, declared: &ReadOptions) -> Result<AxisColumn, ContentError> {
    let column = &table.heading.columns[at];
    if let Kind::Index(_) = column.kind {
        if declared.lateral_unit.is_some() {
            let reason =
                "the heading names numbers of rows or columns, which have no unit; cell says their step";
            return Err(ContentError::Useless { what: "lateral_unit", reason });
        }
        return Ok(AxisColumn { at, unit: None, index: true });
    }
    let own = column.length();
    if own.is_none() && !column.unit.is_empty() {
        let problem = format!("{column}: expected a length as the unit of a coordinate");
        return Err(ContentError::Columns { columns: column.to_string(), problem });
    }
    Ok(AxisColumn { at, unit: lateral_unit(table, own, declared)?, index: false })
}

/// The unit of coordinates: of their column, of a statement of the heading, or as given.
///
/// # Errors
/// [`ContentError::Contradiction`] where two of them differ.
fn lateral_unit(
    table: &TextTable,
    own: Option<Unit>,
    declared: &ReadOptions,
) -> Result<Option<Unit>, ContentError> {
    let file = match (own, table.heading.lateral_unit.clone()) {
        (Some(own), Some(stated)) if !own.same(&stated) => {
            return Err(contradiction("unit of x and y", &own, &stated));
        }
        (own, stated) => own.or(stated),
    };
    let given = &declared.lateral_unit;
    if let (Some(a), Some(b)) = (&file, given)
        && !a.same(b)
    {
        return Err(contradiction("unit of x and y", a, b));
    }
    Ok(given.clone().or(file))
}
