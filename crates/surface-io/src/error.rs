//! The one error type of this crate: which file, where in it, which value, what to do.

mod display;

use crate::format::Format;
use crate::quantity::{Quantity, QuantityError};
use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Result of everything that reads or writes.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong with a file.
#[derive(Debug)]
#[non_exhaustive]
pub enum Error {
    /// The operating system refused to read or write.
    System {
        /// What was being done (`open`, `read`, `write`, ...).
        action: &'static str,
        /// Where.
        path: PathBuf,
        /// Its reason.
        source: io::Error,
    },
    /// A file, or what is asked of it, does not make a surface.
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

/// Where in a file: lines, rows, columns and values count from 1 in what is shown, offsets from 0.
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

/// What is wrong with the content of a file, or with what is asked of it.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ContentError {
    /// No data at all.
    Empty,
    /// Not a regular file.
    NotAFile,
    /// Longer than allowed.
    TooLarge {
        /// Length in bytes.
        bytes: u64,
        /// Largest length allowed.
        largest: u64,
    },
    /// The file ended before the length that the system gave for it: somebody else writes it.
    Changed {
        /// Length at the beginning, in bytes.
        expected: u64,
        /// Bytes that could be read.
        found: u64,
    },
    /// The memory for its numbers cannot be had.
    Memory {
        /// Bytes asked for.
        bytes: u128,
    },
    /// Another kind of file.
    Foreign {
        /// What it looks like.
        what: &'static str,
        /// What to do about it.
        remedy: &'static str,
    },
    /// Not the format expected.
    NotOfFormat {
        /// The format expected from the request or by the name's ending.
        expected: Format,
        /// The format that it looks like.
        found: Format,
    },
    /// Two columns, the first of equally spaced numbers: x and z along a line.
    Profile {
        /// Lines.
        lines: usize,
    },
    /// Three columns: a matrix of three columns, or points.
    Ambiguous {
        /// Number of lines of three.
        lines: usize,
    },
    /// A byte that does not occur in text.
    Binary {
        /// Offset in bytes.
        offset: usize,
        /// The byte.
        byte: u8,
    },
    /// The header of an NPY file is not one.
    Header {
        /// Offset in bytes.
        offset: usize,
        /// What was expected there.
        expected: &'static str,
    },
    /// Numbers of a type that holds no heights.
    Type {
        /// The type as written.
        found: String,
    },
    /// Not two dimensions.
    Shape {
        /// The lengths of the axes.
        found: Vec<u64>,
    },
    /// An array without rows or without columns.
    NoCells {
        /// Rows.
        rows: u64,
        /// Columns.
        columns: u64,
    },
    /// The length of the file is not that of its shape.
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
    /// What stands where a number should.
    Number {
        /// Where.
        place: Place,
        /// What is written there, shortened.
        text: String,
        /// Why it is no number.
        kind: NumberKind,
    },
    /// An infinite height.
    Infinite {
        /// Where.
        place: Place,
        /// The value.
        value: f64,
    },
    /// An integer that a double does not hold.
    Inexact {
        /// Where.
        place: Place,
        /// The integer.
        value: i128,
    },
    /// A line with another number of values than the first one.
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
    /// Points with coordinates that are not numbers, or lines without three values.
    NotPoints {
        /// Line, from 1.
        line: usize,
        /// Values found.
        found: usize,
    },
    /// A point without a coordinate.
    Coordinate {
        /// `x` or `y`.
        axis: char,
        /// Line, from 1.
        line: usize,
    },
    /// Two points at one place of the grid.
    Duplicate {
        /// Line of the first of them, from 1.
        first: usize,
        /// Line of the second one.
        second: usize,
        /// Their coordinates.
        at: [f64; 2],
    },
    /// A coordinate off the grid.
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
    Sparse {
        /// Points.
        points: usize,
        /// Rows.
        rows: f64,
        /// Columns.
        columns: f64,
    },
    /// Undefined points without an instruction how to treat them.
    Undefined {
        /// Points without a height.
        undefined: usize,
        /// All points.
        points: usize,
        /// The first undefined one.
        first: Place,
    },
    /// No point is defined.
    AllUndefined {
        /// All points.
        points: usize,
    },
    /// Neither the file nor the caller states it.
    Unspecified {
        /// What.
        what: &'static str,
        /// How to say it.
        remedy: &'static str,
    },
    /// The file and the caller, or two statements of one of them, say different things.
    Contradiction {
        /// About what.
        what: &'static str,
        /// One statement.
        first: String,
        /// The other.
        second: String,
    },
    /// An option that the format has no use for.
    Useless {
        /// The option.
        what: &'static str,
        /// Why it is of no use.
        reason: &'static str,
    },
    /// A number out of its range.
    OutOfRange {
        /// What.
        what: &'static str,
        /// The number.
        value: f64,
        /// What was expected.
        expected: &'static str,
    },
    /// The comment of a text says a unit that heights or coordinates do not have.
    Heading {
        /// Line, from 1.
        line: usize,
        /// What it says, such as `value units`.
        key: String,
        /// Why.
        source: QuantityError,
    },
    /// The comment of a text says a side that is not positive.
    Side {
        /// Line, from 1.
        line: usize,
        /// What it says, `width` or `height`.
        key: String,
        /// The length.
        value: Quantity,
    },
    /// A quantity that cannot be read.
    Quantity {
        /// What.
        what: &'static str,
        /// Why.
        source: QuantityError,
    },
    /// The rectangle to be cut out leaves the map.
    Crop {
        /// First row and column of the rectangle.
        from: [usize; 2],
        /// Its rows and columns.
        cells: [usize; 2],
        /// Rows and columns of the map.
        shape: [usize; 2],
    },
    /// More cells than the map has along one axis, or none.
    Resample {
        /// `columns` or `rows`.
        what: &'static str,
        /// The number asked for.
        cells: usize,
        /// That of the map.
        found: usize,
    },
    /// Too few defined points, or all in a line, for a trend.
    Trend {
        /// Defined points.
        present: usize,
        /// Unknowns of the trend.
        unknowns: usize,
    },
    /// Heights that are finite in the file overflow when they are converted or fitted.
    Overflow {
        /// The largest height by amount.
        value: f64,
    },
    /// A name whose ending is none of the formats that are written.
    Ending {
        /// The ending, shortened.
        found: String,
    },
    /// A field with a number that is not finite (nor NaN at an undefined point, where those are written).
    NotFinite {
        /// Name of the field.
        field: String,
        /// Number of the value, from 0, row by row.
        at: usize,
        /// The value.
        value: f64,
    },
    /// The map was refused.
    Map(contact_model::Error),
}

impl std::error::Error for ContentError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Quantity { source, .. } | Self::Heading { source, .. } => Some(source),
            Self::Map(source) => Some(source),
            _ => None,
        }
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

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
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
