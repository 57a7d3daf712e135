//! The extent of a map along each axis, from the statements of a file and its reader about sides and cells.

use crate::error::ContentError;
use crate::options::ReadOptions;
use crate::provenance::{PRINTED, contradiction};
use crate::quantity::{Dimension, Quantity, Unit};
use crate::sides::Sides;

/// The extent along one axis as it was stated: by the side of a cell or by the whole side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Extent {
    Cell(Quantity),
    Side(Quantity),
}

impl Extent {
    /// The side of a cell in a unit as a file writes it; `None` where that is no length above 0.
    pub(crate) fn of_cell(cell: f64, unit: &str) -> Option<Self> {
        length(cell, unit).map(Self::Cell)
    }

    /// The side of the map, likewise.
    pub(crate) fn of_side(side: f64, unit: &str) -> Option<Self> {
        length(side, unit).map(Self::Side)
    }

    /// Side of one of `count` cells.
    pub(crate) fn cell(self, count: usize) -> Result<Quantity, ContentError> {
        match self {
            Self::Cell(cell) => Ok(cell),
            Self::Side(side) => scaled("cell", side, 1.0 / count as f64, side.value() / count as f64),
        }
    }

    /// Side of all of `count` cells.
    pub(crate) fn side(self, count: usize) -> Result<Quantity, ContentError> {
        match self {
            Self::Cell(cell) => scaled("size", cell, count as f64, cell.value() * count as f64),
            Self::Side(side) => Ok(side),
        }
    }

    /// The same length, cell or side, of another extent of as many cells.
    fn like(self, other: Self, count: usize) -> Result<Quantity, ContentError> {
        match self {
            Self::Cell(_) => other.cell(count),
            Self::Side(_) => other.side(count),
        }
    }

    fn length(self) -> Quantity {
        match self {
            Self::Cell(length) | Self::Side(length) => length,
        }
    }
}

fn length(value: f64, unit: &str) -> Option<Quantity> {
    let unit = Unit::of_file(unit).ok().filter(|unit| unit.dimension() == Dimension::LENGTH)?;
    Quantity::of(value, &unit).ok().filter(|length| length.value() > 0.0)
}

fn scaled(what: &'static str, from: Quantity, by: f64, value: f64) -> Result<Quantity, ContentError> {
    if value <= 0.0 {
        // The product of positive numbers is below the range of doubles.
        return Err(ContentError::OutOfRange { what, value: from.value() * by, expected: "a length > 0" });
    }
    Quantity::new(value, from.dimension()).map_err(ContentError::quantity(what))
}

/// Whether two lengths are one within the digits that headers print.
pub(crate) fn agree(a: Quantity, b: Quantity) -> bool {
    a.dimension() == b.dimension() && (a.value() / b.value() - 1.0).abs() <= PRINTED
}

/// What the caller says about the size of a map of `count` columns and rows, directly or by its cells.
///
/// Everything that is given is checked; of several statements the cell counts first, then the size.
pub(crate) fn given(declared: &ReadOptions, count: [usize; 2]) -> Result<Option<[Extent; 2]>, ContentError> {
    let cell =
        declared.cell.map(|cell| positive("cell", ["cell along x", "cell along y"], cell)).transpose()?;
    let size =
        declared.size.map(|size| positive("size", ["size along x", "size along y"], size)).transpose()?;
    let width = declared.width.map(|w| positive("width", ["width"; 2], w.into())).transpose()?;
    let [columns, rows] = count;
    if let (Some(Sides::One(side)), true) = (declared.size, columns != rows) {
        let first = format!("one value, {side}, is that of a square map");
        let second = format!("there are {rows} rows of {columns}: say both sides, such as 2 mm x 1 mm");
        return Err(ContentError::contradiction("size", first, second));
    }
    let mut statements: Vec<(&str, [Extent; 2])> = Vec::new();
    statements.extend(cell.map(|cell| ("cell", cell.map(Extent::Cell))));
    statements.extend(size.map(|size| ("size", size.map(Extent::Side))));
    if let Some([width, _]) = width {
        // Cells were square when it was the only way to say a size.
        let side = Extent::Side(width);
        let height = if rows == columns { side } else { Extent::Cell(side.cell(columns)?) };
        statements.push(("width", [side, height]));
    }
    for k in 1..statements.len() {
        let ((first, a), (second, b)) = (statements[0], statements[k]);
        for axis in 0..2 {
            let (x, y) = (a[axis].cell(count[axis])?, b[axis].cell(count[axis])?);
            if !agree(x, y) {
                let cells = format!("{} {}", count[axis], ["columns", "rows"][axis]);
                let shown = |name: &str, extent: Extent, cell: Quantity| match extent {
                    Extent::Cell(_) => format!("{name} = {cell}"),
                    Extent::Side(_) => format!("{name} over {cells} = {cell}"),
                };
                let (first, second) = (shown(first, a[axis], x), shown(second, b[axis], y));
                return Err(ContentError::Contradiction { what: CELL[axis], first, second });
            }
        }
    }
    Ok(statements.first().map(|(_, extents)| *extents))
}

/// Names of one side of a cell in messages.
const CELL: [&str; 2] = ["side of a cell along x", "side of a cell along y"];

/// Checks that what the caller says about an axis is what the file says, within the digits of a header.
pub(crate) fn check_axis(
    axis: usize,
    file: Extent,
    caller: Extent,
    count: usize,
) -> Result<(), ContentError> {
    let (stated, given) = (caller.like(file, count)?, caller.length());
    // What the file says without a unit, the caller says with one.
    let plain = stated.dimension() == Dimension::NONE && given.dimension() == Dimension::LENGTH;
    if plain || agree(stated, given) {
        return Ok(());
    }
    let what = if matches!(caller, Extent::Cell(_)) { CELL } else { ["size along x", "size along y"] };
    Err(contradiction(what[axis], &stated, &given))
}

/// Both values, where each is a length > 0, or a number > 0, and both are of one kind.
fn positive(one: &'static str, each: [&'static str; 2], sides: Sides) -> Result<[Quantity; 2], ContentError> {
    let names = if matches!(sides, Sides::One(_)) { [one; 2] } else { each };
    let both = sides.both();
    for (what, side) in names.into_iter().zip(both) {
        if side.dimension() != Dimension::NONE {
            side.expect(Dimension::LENGTH).map_err(ContentError::quantity(what))?;
        }
        if side.value() <= 0.0 {
            return Err(ContentError::OutOfRange { what, value: side.value(), expected: "a length > 0" });
        }
    }
    let [x, y] = both;
    if x.dimension() != y.dimension() {
        let (first, second) = (format!("{x} along x"), format!("{y} along y"));
        return Err(ContentError::Contradiction { what: one, first, second });
    }
    Ok(both)
}
