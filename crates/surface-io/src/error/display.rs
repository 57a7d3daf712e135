//! Problems in words: where, which value, what to do.

use super::{ContentError, NumberKind};
use std::fmt;

impl fmt::Display for ContentError {
    #[allow(clippy::too_many_lines)] // One arm per problem is the plainest table of them.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "no data in it"),
            Self::NotAFile => write!(f, "not a regular file: its length is needed before it is read"),
            Self::TooLarge { bytes, largest } => {
                write!(f, "{bytes} bytes: at most {largest} are read; raise largest_bytes for more")
            }
            Self::Changed { expected, found } => {
                write!(f, "ended after {found} of {expected} bytes: is it being written? read it again later")
            }
            Self::Memory { bytes } => {
                write!(f, "no memory for its numbers, {bytes} bytes: crop or average it on a larger machine")
            }
            Self::Foreign { what, remedy } => write!(f, "looks like {what}: {remedy}"),
            Self::NotOfFormat { expected, found } => {
                write!(f, "expected {expected}, but the content is {found}: correct the name or the format")
            }
            Self::Profile { lines } => write!(
                f,
                "{lines} lines of two numbers, the first of them equally spaced: a profile x, z along a line, which is no map \
                 (a map of two columns: say format = \"text\")"
            ),
            Self::Ambiguous { lines } => write!(
                f,
                "{lines} lines of three numbers are points or a matrix of three columns: say format = \"xyz\" or format = \"text\""
            ),
            Self::Binary { offset, byte } => write!(
                f,
                "byte 0x{byte:02x} at offset {offset} does not occur in text: expected numbers as text, or an NPY file"
            ),
            Self::Header { offset, expected } => {
                write!(f, "header of an NPY file, offset {offset}: expected {expected}")
            }
            Self::Type { found } => write!(
                f,
                "numbers of type {found}: expected float64, float32, float16 or integers; numpy's astype('f8') converts"
            ),
            Self::Shape { found } => {
                write!(f, "an array of {} dimensions {found:?}: expected two, rows and columns", found.len())
            }
            Self::NoCells { rows, columns } => {
                write!(f, "an array of {rows} rows x {columns} columns: expected at least 1 of each")
            }
            Self::Length { rows, columns, expected, found } => {
                let what = if *expected > u128::from(*found) { "cut short" } else { "more than one array?" };
                write!(
                    f,
                    "{found} bytes after the header: {rows} x {columns} numbers take {expected} ({what})"
                )
            }
            Self::Number { place, text, kind } => {
                let remedy = match kind {
                    NumberKind::None => {
                        "expected a number (comments begin with # or %; skip_lines leaves out a heading)"
                    }
                    NumberKind::DecimalComma => "a decimal comma? say decimal = \"comma\"",
                    NumberKind::Two => {
                        "two numbers between two delimiters: one delimiter per file, and decimal commas need decimal = \"comma\""
                    }
                    NumberKind::TooLarge => "beyond the range of double precision",
                };
                write!(f, "{place}: {text:?}: {remedy}")
            }
            Self::Infinite { place, value } => {
                write!(f, "{place}: {value}: expected a finite height; write nan where nothing was measured")
            }
            Self::Inexact { place, value } => {
                write!(f, "{place}: {value} is not a double: convert to float64 and decide what is rounded")
            }
            Self::Ragged { line, found, expected, first } => {
                write!(f, "line {line} has {found} values: expected {expected} as in line {first}")
            }
            Self::NotPoints { line, found } => {
                write!(f, "line {line} has {found} values: expected x, y and z of one point")
            }
            Self::Coordinate { axis, line } => {
                write!(f, "line {line} has no {axis}: expected x, y and z of a point (z may be missing)")
            }
            Self::Duplicate { first, second, at: [x, y] } => {
                write!(
                    f,
                    "the points of lines {first} and {second} are both at x = {x}, y = {y}: expected one height for each place"
                )
            }
            Self::Irregular { axis, value, origin, spacing } => write!(
                f,
                "{axis} = {value} is off the grid {axis} = {origin} + i * {spacing}: expected points of a regular grid; say cell where noise hides the spacing"
            ),
            Self::Sparse { points, rows, columns } => write!(
                f,
                "{points} points on a grid of {rows} x {columns}: expected heights at half of the places at least; say cell where noise hides the spacing"
            ),
            Self::Undefined { undefined, points, first } => write!(
                f,
                "{undefined} of {points} points are undefined, the first in {first}: say undefined = \"no_contact\" (they cannot touch), or fill = \"neighbours\", \"plane\" or a height"
            ),
            Self::AllUndefined { points } => {
                write!(f, "{points} of {points} points are undefined: expected one height at least")
            }
            Self::Unspecified { what, remedy } => {
                write!(f, "{what} is neither in the file nor given: {remedy}")
            }
            Self::Contradiction { what, first, second } => write!(f, "{what}: {first}, but {second}"),
            Self::Useless { what, reason } => write!(f, "{what} was given: {reason}"),
            Self::OutOfRange { what, value, expected } => write!(f, "{what} = {value}: expected {expected}"),
            Self::Heading { line, key, source } => {
                write!(f, "line {line}, {key}: {source}; skip_lines leaves out a header")
            }
            Self::Side { line, key, value } => {
                write!(
                    f,
                    "line {line}, {key} = {value}: expected a length > 0; skip_lines leaves out a header"
                )
            }
            Self::Quantity { what, source } => write!(f, "{what}: {source}"),
            Self::Crop { from: [row, column], cells: [high, wide], shape: [rows, columns] } => write!(
                f,
                "crop of {high} x {wide} cells from row {row}, column {column}: the map has {rows} rows of {columns}"
            ),
            Self::Resample { what, cells, found } => write!(
                f,
                "{cells} {what}: expected 1 to {found}, as many as the map has; finer cells would be invented"
            ),
            Self::Trend { present, unknowns } => {
                write!(f, "a trend of {unknowns} unknowns is not determined by the {present} defined points")
            }
            Self::Overflow { value } => {
                write!(f, "height {value}: beyond the range of double precision after conversion")
            }
            Self::Ending { found } => {
                write!(f, "the name ends in {found:?}: expected npy, txt, xyz or vti")
            }
            Self::NotFinite { field, at, value } => {
                write!(f, "{field}: value {at} (counted from 0) is {value}: expected finite numbers")
            }
            Self::Map(source) => write!(f, "{source}"),
        }
    }
}
