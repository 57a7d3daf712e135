//! Points x, y, z on a regular grid, in any order.

mod axis;
mod profile;
mod row;

pub use profile::{profile, profile_from_bytes};
pub(crate) use row::row;

use crate::channel::{StoredChannel, StoredHeights, StoredUnit, check_unit};
use crate::error::ContentError;
use crate::extent::Extent;
use crate::options::ReadOptions;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::sides::Sides;
use crate::text::TextTable;
use axis::GridAxis;

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

/// Share of the places of a grid that must have a height: a wrong spacing leaves most of them empty.
const FULL: f64 = 0.5;

/// Smallest deviation from the grid that is reported, in per cent of a cell; smaller ones are roundings.
const SHOWN: f64 = 0.01;

/// Roundings of coordinates in double precision, relative to a spacing.
const ROUNDED: f64 = 1e-9;

/// The points of these columns of a table as a map: column i at `x_min + i * spacing`, row j at
/// `y_min + j * spacing`.
///
/// Cost O(n log n) for n points.
pub(crate) fn grid(
    table: &TextTable,
    columns: &PointColumns,
    declared: &ReadOptions,
) -> Result<StoredChannel, ContentError> {
    let [along_x, along_y] = &columns.axes[..] else { return Err(ContentError::Empty) };
    check_units(table, columns, declared)?;
    let given = declared.cell.map(Sides::both);
    let x = axis(table, 'x', along_x, given.map(|[x, _]| x))?;
    let y = axis(table, 'y', along_y, given.map(|[_, y]| y))?;
    let heights = placed(table, columns, &[&x, &y])?;
    let extent = if declared.cell.is_some() { [None; 2] } else { extents(table, columns, [&x, &y])? };
    let shape = [y.count as usize, x.count as usize];
    let placed = Placed { words: ["points", "cell"], off: x.off.max(y.off), heights, shape, extent };
    Ok(channel(table, columns, placed))
}

/// The coordinates in a column as an axis, with the side of a cell where it is given.
fn axis(
    table: &TextTable,
    name: char,
    column: &AxisColumn,
    cell: Option<Quantity>,
) -> Result<GridAxis, ContentError> {
    let along = table.values.iter().skip(column.at).step_by(table.columns).copied();
    if let Some(point) = along.clone().position(f64::is_nan) {
        return Err(ContentError::Coordinate { axis: name, line: table.lines[point] as usize });
    }
    let spacing = match cell {
        _ if column.index => Some(1.0),
        Some(cell) => Some(spacing_of(cell, column.unit.as_ref())?),
        None => None,
    };
    GridAxis::find(name, along.collect(), spacing)
}

/// The heights at their places on these axes, the first of which runs fastest; undefined where there is no
/// point.
fn placed(table: &TextTable, columns: &PointColumns, axes: &[&GridAxis]) -> Result<Vec<f64>, ContentError> {
    let counts: f64 = axes.iter().map(|axis| axis.count).product();
    let points = table.rows();
    if counts * FULL > points as f64 {
        let rows = axes.get(1).map_or(1.0, |axis| axis.count);
        return Err(ContentError::Sparse { points, rows, columns: axes[0].count });
    }
    let places = axes.iter().map(|axis| axis.count as usize).product();
    let mut heights = vec![f64::NAN; places];
    // Lines that are taken; 0 is none.
    let mut taken = vec![0_u32; places];
    for (point, &line) in table.values.chunks_exact(table.columns).zip(&table.lines) {
        let coordinates = || columns.axes.iter().map(|column| point[column.at]);
        let mut at = 0;
        for (axis, coordinate) in axes.iter().zip(coordinates()).rev() {
            at = at * axis.count as usize + axis.index(coordinate)?;
        }
        if taken[at] > 0 {
            let [first, second] = [taken[at], line].map(|line| line as usize);
            let mut coordinates = coordinates();
            let at = [coordinates.next().unwrap_or(0.0), coordinates.next().unwrap_or(0.0)];
            return Err(ContentError::Duplicate { first, second, at });
        }
        taken[at] = line;
        heights[at] = table.scale.unwrap_or(1.0) * point[columns.value];
    }
    Ok(heights)
}

/// Points at their places.
struct Placed {
    /// What the points and the steps between them are called.
    words: [&'static str; 2],
    /// How far points are off their places, in cells.
    off: f64,
    heights: Vec<f64>,
    shape: [usize; 2],
    extent: [Option<Extent>; 2],
}

/// The channel of points.
fn channel(table: &TextTable, columns: &PointColumns, placed: Placed) -> StoredChannel {
    let Placed { words: [points, cell], off, heights, shape, extent } = placed;
    let off = 100.0 * off;
    let off =
        if off > SHOWN { format!(", up to {off:.2} % of a {cell} off their places") } else { String::new() };
    let details = format!("{} {points}, {}{off}", table.rows(), table.details());
    let channel = StoredChannel::of(StoredHeights::Read(heights), details, shape, columns.unit.clone());
    let name = columns.name.clone().or_else(|| table.heading.name.clone());
    let mut notes = table.heading.notes(extent);
    notes.extend(table.notes.iter().chain(&columns.notes).cloned());
    if columns.axes.iter().any(|axis| axis.index) {
        notes.push(
            "the heading names numbers of rows or columns, whose step is no length: cell says it".into(),
        );
    }
    StoredChannel { name, extent, notes, ..channel }
}

/// Whether the first two of three columns are all places of a grid of two rows and columns or more, each once
/// and exactly on its place.
pub(crate) fn is_full_grid(table: &TextTable) -> bool {
    let axis = |name, at: usize| {
        let along: Vec<f64> = table.values.iter().skip(at).step_by(3).copied().collect();
        if along.iter().any(|v| v.is_nan()) {
            return None;
        }
        let axis = GridAxis::find(name, along, None).ok()?;
        (axis.count >= 2.0 && axis.off <= ROUNDED.sqrt()).then_some(axis)
    };
    let (Some(x), Some(y)) = (axis('x', 0), axis('y', 1)) else { return false };
    let places = x.count * y.count;
    if (places - table.rows() as f64).abs() > 0.0 {
        return false;
    }
    let mut taken = vec![false; table.rows()];
    let once = |point: &[f64]| {
        let (Ok(row), Ok(column)) = (y.index(point[1]), x.index(point[0])) else { return false };
        !std::mem::replace(&mut taken[row * x.count as usize + column], true)
    };
    table.values.chunks_exact(3).all(once)
}

/// Checks the units of coordinates: heights with a unit beside coordinates without one are not guessed at,
/// and neither is the unit of one coordinate beside that of the other.
fn check_units(
    table: &TextTable,
    columns: &PointColumns,
    declared: &ReadOptions,
) -> Result<(), ContentError> {
    check_unit("lateral_unit", declared.lateral_unit.as_ref())?;
    let of_heights = match (&declared.unit, &columns.unit) {
        (Some(unit), _) | (None, StoredUnit::Heights(unit)) => Some(unit),
        _ => None,
    };
    let heights_have_length =
        declared.height_scale.is_some() || of_heights.is_some_and(|u| u.dimension() == Dimension::LENGTH);
    let mut axes = columns.axes.iter().filter(|axis| !axis.index);
    let some = columns.axes.iter().any(|axis| axis.unit.is_some());
    if axes.any(|axis| axis.unit.is_none()) && (heights_have_length || some) {
        let remedy = "say lateral_unit, such as um";
        let mut seen = table.heading.notes([None; 2]);
        seen.extend(table.heading.named());
        return Err(ContentError::unspecified("the unit of x and y", seen, remedy));
    }
    Ok(())
}

/// The given side of a cell in the numbers of the file.
fn spacing_of(cell: Quantity, lateral: Option<&Unit>) -> Result<f64, ContentError> {
    let unit = lateral.cloned().unwrap_or_else(Unit::none);
    if cell.dimension() != unit.dimension() {
        let (first, second) = (format!("cell = {cell}"), format!("x and y have {unit}"));
        return Err(ContentError::Contradiction { what: "side of a cell", first, second });
    }
    let spacing = cell.value() / unit.to_si(1.0);
    if spacing.is_finite() && spacing > 0.0 {
        Ok(spacing)
    } else {
        Err(ContentError::OutOfRange { what: "cell", value: cell.value(), expected: "a length > 0" })
    }
}

/// Both axes by their spacings, or by the width and height in the comments where an axis has one place only.
/// `None` where neither says it, and for numbers of rows or columns.
///
/// What the comments say replaces what differs from it by roundings of the coordinates only. One spacing
/// serves both axes where they differ by no more than the points are off their places.
fn extents(
    table: &TextTable,
    columns: &PointColumns,
    axes: [&GridAxis; 2],
) -> Result<[Option<Extent>; 2], ContentError> {
    let units = [0, 1].map(|axis| columns.axes[axis].unit.clone().unwrap_or_else(Unit::none));
    let quantity =
        |spacing: f64, unit: &Unit| Quantity::of(spacing, unit).map_err(ContentError::quantity("spacing"));
    let stated = table.heading.sides();
    let mut extents = [None; 2];
    for (i, extent) in extents.iter_mut().enumerate() {
        let (axis, side, unit) = (axes[i], stated[i], &units[i]);
        let spacing = axis.spacing.filter(|_| !columns.axes[i].index);
        let spacing = spacing.map(|spacing| quantity(spacing, unit)).transpose()?;
        let side = side.map(|side| side.quantity).filter(|side| side.dimension() == unit.dimension());
        *extent = match (spacing, side) {
            (Some(spacing), Some(side))
                if (spacing.value() * axis.count / side.value() - 1.0).abs() > ROUNDED =>
            {
                Some(Extent::Cell(spacing))
            }
            (Some(spacing), None) => Some(Extent::Cell(spacing)),
            (_, side) => side.map(Extent::Side),
        };
    }
    if let ([x, y], [Some(Extent::Cell(_)), Some(Extent::Cell(_))]) = (axes, extents)
        && let (Some(dx), Some(dy)) = (x.spacing, y.spacing)
        && units[0].same(&units[1])
    {
        // The ends, on which the spacing rests, may be off their places by twice what is seen between them.
        let uncertainty =
            |axis: &GridAxis, spacing: f64| 4.0 * axis.off * spacing / (axis.count - 1.0).max(1.0);
        if (dx - dy).abs() <= uncertainty(x, dx) + uncertainty(y, dy) + ROUNDED * dx {
            let common = (dx * (x.count - 1.0) + dy * (y.count - 1.0)) / (x.count + y.count - 2.0);
            extents = [Some(Extent::Cell(quantity(common, &units[0])?)); 2];
        }
    }
    Ok(extents)
}

#[cfg(test)]
mod tests;
