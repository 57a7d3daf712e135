//! How a file is read.

use crate::choice::ChannelChoice;
use crate::format::Format;
use crate::keyword::keywords;
use crate::quantity::{Quantity, Unit};
use crate::sides::Sides;

/// How to read a file, and what the file itself does not state; a contradiction with the file is an error.
#[derive(Debug, Clone, PartialEq)]
pub struct ReadOptions {
    /// The format, where it shall not be detected from the content and the name's ending.
    pub format: Option<Format>,
    /// The channel, where the file has several that can be heights.
    pub channel: Option<ChannelChoice>,
    /// Unit of the heights.
    pub unit: Option<Unit>,
    /// Height of one count: of one grey level or of one unit of a number that has none, such as `0.25 nm`.
    pub height_scale: Option<Quantity>,
    /// Unit of x and y of points.
    pub lateral_unit: Option<Unit>,
    /// Axis of the first index of an array, where the file does not state it (HDF5, MATLAB, NetCDF).
    pub axes: Option<Axes>,
    /// Sides of the map, Lx along the rows and Ly along the columns: lengths, or numbers where the heights
    /// have no unit. One value is that of a square map.
    pub size: Option<Sides>,
    /// Sides of one cell, dx and dy, instead of the size. One value is that of square cells.
    pub cell: Option<Sides>,
    /// Older name of a size of square cells: the length of a row, `columns * cell`.
    pub width: Option<Quantity>,
    /// What the first line and the first column of a text matrix are, where they may be coordinates.
    pub border: Option<Border>,
    /// How decimals are written in text.
    pub decimal: Decimal,
    /// A number of the file that stands for an undefined point, such as -9999.
    pub missing: Option<f64>,
    /// Lines of text to leave out at the beginning.
    pub skip_lines: usize,
    /// Longest file that is read, in bytes.
    pub largest_bytes: u64,
}

impl Default for ReadOptions {
    /// Nothing is stated, decimals have points, and files have up to 8 GiB (a square of 32768 doubles a
    /// side).
    fn default() -> Self {
        Self {
            format: None,
            channel: None,
            unit: None,
            height_scale: None,
            lateral_unit: None,
            axes: None,
            size: None,
            cell: None,
            width: None,
            border: None,
            decimal: Decimal::Point,
            missing: None,
            skip_lines: 0,
            // The header of such a map goes on top.
            largest_bytes: (8 << 30) + 65536,
        }
    }
}

keywords! {
    /// What the first line and the first column of a text matrix are.
    Border: "border";
    /// Coordinates of the columns, of the rows, or of both, whichever are in equal steps.
    Axes = "axes",
    /// Heights like all others.
    Heights = "heights",
}

keywords! {
    /// How decimals are written.
    #[derive(Default)]
    Decimal: "decimal";
    /// 1.5
    #[default]
    Point = "point",
    /// 1,5
    Comma = "comma",
}

keywords! {
    /// What the first index of an array counts along, and what the second.
    Axes: "axes", ", what the first and the second index count along";
    /// The first index is x, the second y.
    Xy = "xy",
    /// The first index is y: rows, as those of a picture.
    Yx = "yx",
}
