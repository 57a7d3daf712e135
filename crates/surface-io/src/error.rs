//! The one error type of this crate: which file, where in it, which value, what to do.

use crate::format::Format;
use crate::quantity::{Quantity, QuantityError};
use contact_model::Escaping;
use contact_model::units::number;
use std::fmt::{self, Write as _};
use std::io;
use std::path::{Path, PathBuf};

/// Result type of everything that reads.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong with a file.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused.
    System {
        /// The action that it refused, such as `open` or `read`.
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// The file, or a request for it, does not give a surface.
    Content {
        /// Where.
        path: PathBuf,
        /// What is wrong.
        problem: ContentError,
    },
}

impl Error {
    pub(crate) fn system(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::System { action, path, source }
    }

    pub(crate) fn content(path: &Path) -> impl FnOnce(ContentError) -> Self {
        let path = path.to_owned();
        move |problem| Self::Content { path, problem }
    }

    /// The problem, where the system did not refuse.
    pub fn problem(&self) -> Option<&ContentError> {
        match self {
            Self::Content { problem, .. } => Some(problem),
            Self::System { .. } => None,
        }
    }
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A value of a line of text, both counted from 1.
    Line {
        /// Line.
        line: usize,
        /// Number of the value in it.
        value: usize,
    },
    /// A cell of a map, both counted from 0.
    Cell {
        /// Row.
        row: usize,
        /// Column.
        column: usize,
    },
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { line, value } => write!(f, "line {line}, value {value}"),
            Self::Cell { row, column } => write!(f, "row {row}, column {column} (counted from 0)"),
        }
    }
}

/// A problem with the content of a file, or with a request for it.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ContentError {
    /// The file has no data.
    #[error("no data in it: it is empty or has nothing but comments; export it again")]
    Empty,
    /// Not a regular file.
    #[error("not a regular file: its length is needed before it is read")]
    NotAFile,
    /// The file is longer than allowed.
    #[error("{bytes} bytes: at most {largest} are read; raise largest_bytes for more")]
    TooLarge {
        /// Length in bytes.
        bytes: u64,
        /// Largest length allowed.
        largest: u64,
    },
    /// The file ended before the length that the system gave for it: another program is writing it.
    #[error("ended after {found} of {expected} bytes: is it being written? read it again later")]
    Changed {
        /// Length at the beginning, in bytes.
        expected: u64,
        /// Bytes that could be read.
        found: u64,
    },
    /// There is not enough memory for its numbers.
    #[error("no memory for its numbers, {bytes} bytes: crop or average it on a larger machine")]
    Memory {
        /// Bytes requested.
        bytes: u128,
    },
    /// The file is of another kind.
    #[error("looks like {what}: {remedy}")]
    Foreign {
        /// What it looks like.
        what: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// An archive that is no X3P file.
    #[error("an archive of {members}: take the file of heights out of it")]
    Archive {
        /// Names of its members; of many the first.
        members: String,
    },
    /// The file does not have the expected format.
    #[error("expected {expected}, but the content is {found}: correct the name or the format")]
    NotOfFormat {
        /// The format expected from the request or by the name's ending.
        expected: Format,
        /// The format that it looks like.
        found: Format,
    },
    /// The text has three columns, which may be a matrix or points.
    #[error(
        "{lines} lines of three numbers are points or a matrix of three columns: say format = \"xyz\" or format = \"text\""
    )]
    Ambiguous {
        /// Number of lines of three.
        lines: usize,
    },
    /// A byte that does not occur in text.
    #[error(
        "byte 0x{byte:02x} at offset {offset} does not occur in text: expected numbers as text, or a binary format that is read"
    )]
    NoText {
        /// Offset in bytes.
        offset: usize,
        /// The byte.
        byte: u8,
    },
    /// A format that this build leaves out.
    #[error(
        "{format}: left out of this build, with the feature {} of the crate surface-io it is read and written",
        .format.word()
    )]
    LeftOut {
        /// The format; its word is the name of the feature.
        format: Format,
    },
    /// The file does not have the requested binary format.
    #[error("expected {expected}, but the file does not begin like one")]
    Other {
        /// The requested format.
        expected: Format,
    },
    /// The content of a binary file at some place contradicts its format.
    #[error("{format}, offset {offset}: expected {expected}")]
    Binary {
        /// The format.
        format: Format,
        /// Offset in bytes.
        offset: u64,
        /// What was expected there.
        expected: String,
    },
    /// The request fits no channel, or more than one.
    #[error(
        "{}: the channels are {list}",
        match (.choice, .matching) {
            (Some(choice), 0) => format!("channel {choice} is not in the file"),
            (Some(choice), n) => format!("{n} channels are called {choice}, say channel = NUMBER"),
            (None, 0) => "no channel of the file has heights".to_owned(),
            (None, n) => format!("{n} channels of the file have heights, say channel = NUMBER or NAME"),
        }
    )]
    Channel {
        /// The requested channel.
        choice: Option<String>,
        /// Number of channels that fit the request.
        matching: usize,
        /// All channels.
        list: String,
    },
    /// A channel that cannot be read, of a file with others.
    #[error("channel {channel}")]
    Unread {
        /// Number, name and what is wrong.
        channel: String,
    },
    /// A channel whose values are no heights.
    #[error("channel {what}: its values are no heights{notes}")]
    NoHeights {
        /// Number, name and unit.
        what: String,
        /// Notes of the file about it in brackets; empty for none.
        notes: String,
    },
    /// The heading of a text names columns that are no map.
    #[error("the heading names the columns {columns}: {problem}")]
    Columns {
        /// The columns as the heading has them.
        columns: String,
        /// The problem with them, and what was expected.
        problem: String,
    },
    /// The header of an NPY file is not one.
    #[error("header of an NPY file, offset {offset}: expected {expected}")]
    Header {
        /// Offset in bytes.
        offset: usize,
        /// What was expected there.
        expected: &'static str,
    },
    /// Numbers of a type that holds no heights.
    #[error(
        "numbers of type {found}: expected float64, float32, float16 or integers; numpy's astype('f8') converts"
    )]
    Type {
        /// The type as written.
        found: String,
    },
    /// Not two dimensions.
    #[error("an array of {} dimensions {found:?}: expected two, rows and columns", .found.len())]
    Shape {
        /// The lengths of the axes.
        found: Vec<u64>,
    },
    /// An array without rows or without columns.
    #[error("an array of {rows} rows x {columns} columns: expected at least 1 of each")]
    NoCells {
        /// Rows.
        rows: u64,
        /// Columns.
        columns: u64,
    },
    /// The length of the file is not that of its shape.
    #[error(
        "{found} bytes after the header: {rows} x {columns} numbers take {expected} ({})",
        if *.expected > u128::from(*.found) { "cut short" } else { "more than one array?" }
    )]
    Length {
        /// Rows.
        rows: u64,
        /// Columns.
        columns: u64,
        /// Bytes that the shape takes.
        expected: u128,
        /// Bytes after the header.
        found: u64,
    },
    /// A text stands in the place of a number.
    #[error("{place}: {text:?}: {kind}")]
    Number {
        /// Where.
        place: Place,
        /// What is written there, shortened.
        text: String,
        /// Why it is no number.
        kind: NumberKind,
    },
    /// Commas stand between numbers and are their decimal signs too.
    #[error(
        "commas are decimal signs and separators at once: export the file with semicolons or tabs as separators, and say \
         decimal = \"comma\" (--decimal comma); where every field is a height of its own, say format = \"text\""
    )]
    Commas,
    /// One number in each line, which is neither a map nor a profile.
    #[error(
        "one column of {rows} numbers: a profile needs two columns, x and z, and a map several (format = \"text\" with both sides of \
         size reads a map of one column)"
    )]
    OneColumn {
        /// Lines of data.
        rows: usize,
    },
    /// A height is infinite.
    #[error("{place}: {value}: expected a finite height; write nan where nothing was measured")]
    Infinite {
        /// Where.
        place: Place,
        /// The value.
        value: f64,
    },
    /// An integer cannot be represented as a double.
    #[error("{place}: {value} is not a double: convert to float64 and decide what is rounded")]
    Inexact {
        /// Where.
        place: Place,
        /// The integer.
        value: i128,
    },
    /// A text has more maps than are read.
    #[error("line {line} begins another map: at most {most} are read from one text")]
    TooManyMaps {
        /// Most maps.
        most: usize,
        /// The line, from 1.
        line: usize,
    },
    /// The first line and the first value of each line may be coordinates.
    #[error(
        "the {what} numbers in equal steps: coordinates or heights? say border = \"axes\" or border = \"heights\""
    )]
    Border {
        /// What they are of.
        what: &'static str,
    },
    /// A line with another number of values than the first one.
    #[error("line {line} has {}: expected {expected} as in line {first}", values(*.found))]
    Ragged {
        /// Line, from 1.
        line: usize,
        /// Values found.
        found: usize,
        /// Values of the first line.
        expected: usize,
        /// The first line of data, from 1.
        first: usize,
    },
    /// Lines without as many values as a point has.
    #[error("line {line} has {}: expected {expected}", values(*.found))]
    NoPoint {
        /// Line, from 1.
        line: usize,
        /// Values found.
        found: usize,
        /// What was expected.
        expected: &'static str,
    },
    /// A profile with points without a height, or with places without a point.
    #[error(
        "{undefined} of the {points} places of the profile have no height: expected one at each; cut it where it is whole"
    )]
    Gaps {
        /// Places without a height.
        undefined: usize,
        /// All places.
        points: usize,
    },
    /// A point without a coordinate.
    #[error("line {line} has no {axis}: expected all coordinates of a point (z may be missing)")]
    Coordinate {
        /// `x` or `y`.
        axis: char,
        /// Line, from 1.
        line: usize,
    },
    /// Two points at one place of the grid.
    #[error(
        "the points of lines {first} and {second} are both at x = {}, y = {}: expected one height for each place",
        .at[0], .at[1]
    )]
    Duplicate {
        /// Line of the first of them, from 1.
        first: usize,
        /// Line of the second one.
        second: usize,
        /// Their coordinates.
        at: [f64; 2],
    },
    /// A coordinate off the grid.
    #[error(
        "{axis} = {value} is off the grid {axis} = {origin} + i * {spacing}: expected points of a regular grid (scattered points are \
         not interpolated); say cell where noise hides the spacing"
    )]
    Irregular {
        /// `x` or `y`.
        axis: char,
        /// The coordinate.
        value: f64,
        /// Origin of the grid.
        origin: f64,
        /// Spacing of the grid.
        spacing: f64,
    },
    /// A grid most of whose points are missing.
    #[error(
        "{points} points on a grid of {rows} x {columns}: expected heights at half of the places at least; say cell where noise \
         hides the spacing"
    )]
    Sparse {
        /// Points.
        points: usize,
        /// Rows.
        rows: f64,
        /// Columns.
        columns: f64,
    },
    /// Undefined points without an instruction how to treat them.
    #[error(
        "{undefined} of {points} points are undefined, the first in {first}: say undefined (no_contact: they cannot touch) or \
         fill (neighbours, plane or a height)"
    )]
    Undefined {
        /// Points without a height.
        undefined: usize,
        /// All points.
        points: usize,
        /// The first undefined one.
        first: Place,
    },
    /// No point is defined.
    #[error("{points} of {points} points are undefined: expected one height at least")]
    AllUndefined {
        /// All points.
        points: usize,
    },
    /// Neither the file nor the caller states a value that is needed.
    #[error(
        "{what} is {}: {remedy}{}",
        if .seen.is_empty() { "neither in the file nor given" } else { "not known" },
        if .seen.is_empty() { String::new() } else { format!(" (of the file: {})", .seen.join("; ")) }
    )]
    Unspecified {
        /// What.
        what: &'static str,
        /// Statements of the file about it that are not used, with the reasons.
        seen: Vec<String>,
        /// How the caller can state it.
        remedy: &'static str,
    },
    /// The file and the caller, or two statements of one of them, say different things.
    #[error("{what}: {first}, but {second}")]
    Contradiction {
        /// About what.
        what: &'static str,
        /// One statement.
        first: String,
        /// The other.
        second: String,
    },
    /// An option does not apply to the format.
    #[error("{what} was given: {reason}")]
    Useless {
        /// The option.
        what: &'static str,
        /// Why it does not apply.
        reason: &'static str,
    },
    /// A number out of its range.
    #[error("{what} = {}: expected {expected}", number(*.value))]
    OutOfRange {
        /// What.
        what: &'static str,
        /// The number.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// The comment of a text says a unit that heights or coordinates do not have.
    #[error("line {line}, {key}: {source}; skip_lines leaves out a header")]
    Heading {
        /// Line, from 1.
        line: usize,
        /// What it says, such as `value units`.
        key: String,
        /// Why.
        source: QuantityError,
    },
    /// The comment of a text says a side that is not positive.
    #[error("line {line}, {key} = {value}: expected a length > 0; skip_lines leaves out a header")]
    Side {
        /// Line, from 1.
        line: usize,
        /// What it says, `width` or `height`.
        key: String,
        /// The length.
        value: Quantity,
    },
    /// A quantity that cannot be read.
    #[error("{what}: {source}")]
    Quantity {
        /// What.
        what: &'static str,
        /// Why.
        source: QuantityError,
    },
    /// The rectangle to be cut out leaves the map.
    #[error(
        "crop of {} x {} cells from row {}, column {}: the map has {} rows of {}",
        .cells[0], .cells[1], .from[0], .from[1], .shape[0], .shape[1]
    )]
    Crop {
        /// First row and column of the rectangle.
        from: [usize; 2],
        /// Its rows and columns.
        cells: [usize; 2],
        /// Rows and columns of the map.
        shape: [usize; 2],
    },
    /// A cut-off wavelength across the scan lines that the map does not have.
    #[error(
        "filter_across = {}: expected a wavelength from {}, four cells, to {}, the side of the map across the scan lines",
        number(*.value), number(*.least), number(*.side)
    )]
    CutOff {
        /// The cut-off.
        value: f64,
        /// Four cells.
        least: f64,
        /// The side of the map along y.
        side: f64,
    },
    /// More cells than the map has along one axis, or none.
    #[error("{cells} {what}: expected 1 to {found}, as many as the map has; finer cells would be invented")]
    Resample {
        /// `columns` or `rows`.
        what: &'static str,
        /// The requested number.
        cells: usize,
        /// That of the map.
        found: usize,
    },
    /// Too few defined points, or all in a line, for a trend.
    #[error("a trend of {unknowns} unknowns is not determined by the {present} defined points")]
    Trend {
        /// Defined points.
        present: usize,
        /// Unknowns of the trend.
        unknowns: usize,
    },
    /// Heights that are finite in the file overflow when they are converted or fitted.
    #[error("height {value}: beyond the range of double precision after conversion")]
    Overflow {
        /// The largest height by amount.
        value: f64,
    },
    /// The ending of the name belongs to none of the formats that are written.
    #[error("the name ends in {found:?}: expected npy, h5, txt, xyz, vti, x3p, gwy or nc")]
    Ending {
        /// The ending, shortened.
        found: String,
    },
    /// The library of the format does not write the map.
    #[error("cannot be written: {reason}")]
    Unwritten {
        /// Its reason.
        reason: String,
    },
    /// A field with a number that is not finite (nor NaN at an undefined point, where those are written).
    #[error("{field}: value {at} (counted from 0) is {value}: expected finite numbers")]
    NotFinite {
        /// Name of the field.
        field: String,
        /// Number of the value, from 0, row by row.
        at: usize,
        /// The value.
        value: f64,
    },
    /// Two maps that do not lie over each other.
    #[error(
        "two maps {} and {} long, the second moved by {offset}: expected one cell at least that both cover",
        .sides[0], .sides[1]
    )]
    Apart {
        /// Their sides along one axis.
        sides: [f64; 2],
        /// Distance of their middles.
        offset: f64,
    },
    /// The map was refused.
    #[error("{0}")]
    Map(#[source] contact_model::Error),
}

impl ContentError {
    /// A number out of its range.
    pub(crate) fn out_of_range(what: &'static str, value: f64, expected: &'static str) -> Self {
        Self::OutOfRange { what, value, expected }
    }

    /// The error for a value that neither the file nor the caller states, with the notes of the file about
    /// it.
    pub(crate) fn unspecified(what: &'static str, seen: Vec<String>, remedy: &'static str) -> Self {
        Self::Unspecified { what, seen, remedy }
    }

    /// Heights without a unit, of a file with these notes.
    pub(crate) fn no_unit(seen: &[String]) -> Self {
        let remedy = "say unit, such as nm";
        Self::unspecified("the unit of the heights", seen.to_vec(), remedy)
    }

    /// A channel whose values are no heights, of a file with these notes.
    pub(crate) fn no_heights(what: String, notes: &[String]) -> Self {
        let notes = if notes.is_empty() { String::new() } else { format!(" ({})", notes.join("; ")) };
        Self::NoHeights { what, notes }
    }

    /// Two statements that differ.
    pub(crate) fn contradiction(
        what: &'static str,
        first: impl Into<String>,
        second: impl Into<String>,
    ) -> Self {
        Self::Contradiction { what, first: first.into(), second: second.into() }
    }

    /// A quantity that cannot be read.
    pub(crate) fn quantity(what: &'static str) -> impl FnOnce(QuantityError) -> Self {
        move |source| Self::Quantity { what, source }
    }
}

/// Why a text is no number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberKind {
    /// No number at all.
    None,
    /// A comma where a point is expected.
    DecimalComma,
    /// Two numbers with a space between where the delimiter is another one.
    Two,
    /// Beyond the range of doubles.
    TooLarge,
}

/// A number of values, in words.
fn values(count: usize) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{count} value{ending}")
}

impl fmt::Display for NumberKind {
    /// What to do about it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::None => "expected a number (comments begin with # or %; skip_lines leaves out a heading)",
            Self::DecimalComma => "a decimal comma? say decimal = \"comma\"",
            Self::Two => {
                "two numbers between two delimiters: one delimiter per file, and decimal commas need decimal = \"comma\""
            }
            Self::TooLarge => "beyond the range of double precision",
        })
    }
}

impl fmt::Display for Error {
    /// On one line: paths and what is quoted of a file are shown with their control characters escaped.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut f = Escaping::of_line(f);
        match self {
            Self::System { action, path, source } => {
                write!(f, "cannot {action} {}: {source}", path.display())
            }
            Self::Content { path, problem } => write!(f, "{}: {problem}", path.display()),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::System { source, .. } => Some(source),
            Self::Content { problem, .. } => problem.source(),
        }
    }
}
