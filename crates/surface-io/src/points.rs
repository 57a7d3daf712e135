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
use crate::provenance::contradiction;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::text::TextTable;
use axis::GridAxis;

/// Share of the places of a grid that must have a height: a wrong spacing leaves most of them empty.
const FULL: f64 = 0.5;

/// Smallest deviation from the grid that is reported, in per cent of a cell; smaller ones are roundings.
const SHOWN: f64 = 0.01;

/// Roundings of coordinates in double precision, relative to a spacing.
const ROUNDED: f64 = 1e-9;

/// The points of a table as a map: column i at `x_min + i * spacing`, row j at `y_min + j * spacing`.
///
/// Cost O(n log n) for n points.
pub(crate) fn grid(table: &TextTable, declared: &ReadOptions) -> Result<StoredChannel, ContentError> {
    if table.columns != 3 {
        let (line, found) = (table.first_line(), table.columns);
        return Err(ContentError::NoPoint { line, found, expected: "x, y and z of one point" });
    }
    let lateral = lateral_unit(declared, table)?;
    let spacing = match declared.cell {
        Some(cell) => {
            let [x, y] = cell.both();
            [Some(spacing_of(x, lateral.as_ref())?), Some(spacing_of(y, lateral.as_ref())?)]
        }
        None => [None, None],
    };
    let (x, y) = (axis(table, 'x', 0, spacing[0])?, axis(table, 'y', 1, spacing[1])?);
    let heights = placed(table, &[&x, &y])?;
    let extent = if declared.cell.is_some() {
        [None; 2]
    } else {
        extents(table, [&x, &y], &lateral.unwrap_or_else(Unit::none))?
    };
    let shape = [y.count as usize, x.count as usize];
    Ok(channel(table, ["points", "cell"], x.off.max(y.off), heights, shape, extent))
}

/// The coordinates in a column as an axis.
fn axis(table: &TextTable, name: char, at: usize, spacing: Option<f64>) -> Result<GridAxis, ContentError> {
    let along = table.values.iter().skip(at).step_by(table.columns).copied();
    if let Some(point) = along.clone().position(f64::is_nan) {
        return Err(ContentError::Coordinate { axis: name, line: table.lines[point] as usize });
    }
    GridAxis::find(name, along.collect(), spacing)
}

/// The heights, in the last column, at their places on these axes, the first of which runs fastest; undefined
/// where there is no point.
fn placed(table: &TextTable, axes: &[&GridAxis]) -> Result<Vec<f64>, ContentError> {
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
        let (coordinates, height) = (&point[..axes.len()], point[axes.len()]);
        let mut at = 0;
        for (axis, &coordinate) in axes.iter().zip(coordinates).rev() {
            at = at * axis.count as usize + axis.index(coordinate)?;
        }
        if taken[at] > 0 {
            let [first, second] = [taken[at], line].map(|line| line as usize);
            let at = [coordinates[0], coordinates.get(1).copied().unwrap_or(0.0)];
            return Err(ContentError::Duplicate { first, second, at });
        }
        taken[at] = line;
        heights[at] = table.scale.unwrap_or(1.0) * height;
    }
    Ok(heights)
}

/// The channel of points, and how far they are off their places, in cells.
fn channel(
    table: &TextTable,
    [points, cell]: [&str; 2],
    off: f64,
    heights: Vec<f64>,
    shape: [usize; 2],
    extent: [Option<Extent>; 2],
) -> StoredChannel {
    let off = 100.0 * off;
    let off =
        if off > SHOWN { format!(", up to {off:.2} % of a {cell} off their places") } else { String::new() };
    let details = format!("{} {points}, {}{off}", table.rows(), table.details());
    let (heights, unit) = (StoredHeights::Read(heights), StoredUnit::heights(table.heading.unit.clone()));
    let channel = StoredChannel::of(heights, details, shape, unit);
    StoredChannel { name: table.heading.name.clone(), extent, notes: table.heading.notes(extent), ..channel }
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

/// Unit of x and y: as given or as the file says. Heights with a unit beside coordinates without one are not
/// guessed at.
fn lateral_unit(declared: &ReadOptions, table: &TextTable) -> Result<Option<Unit>, ContentError> {
    let of_heights = declared.unit.as_ref().or(table.heading.unit.as_ref());
    let heights_have_length =
        declared.height_scale.is_some() || of_heights.is_some_and(|u| u.dimension() == Dimension::LENGTH);
    let (file, given) = (&table.heading.lateral_unit, &declared.lateral_unit);
    if let (Some(a), Some(b)) = (file, given)
        && !a.same(b)
    {
        return Err(contradiction("unit of x and y", a, b));
    }
    let unit = given.clone().or_else(|| file.clone());
    check_unit("lateral_unit", unit.as_ref())?;
    if unit.is_none() && heights_have_length {
        let remedy = "say lateral_unit, such as um";
        let seen = table.heading.notes([None; 2]);
        return Err(ContentError::unspecified("the unit of x and y", seen, remedy));
    }
    Ok(unit)
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
/// `None` where neither says it.
///
/// What the comments say replaces what differs from it by roundings of the coordinates only. One spacing
/// serves both axes where they differ by no more than the points are off their places.
fn extents(
    table: &TextTable,
    axes: [&GridAxis; 2],
    unit: &Unit,
) -> Result<[Option<Extent>; 2], ContentError> {
    let quantity = |spacing: f64| Quantity::of(spacing, unit).map_err(ContentError::quantity("spacing"));
    let stated = table.heading.sides();
    let mut extents = [None; 2];
    for ((extent, axis), side) in extents.iter_mut().zip(axes).zip(stated) {
        let spacing = axis.spacing.map(quantity).transpose()?;
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
    {
        // The ends, on which the spacing rests, may be off their places by twice what is seen between them.
        let uncertainty =
            |axis: &GridAxis, spacing: f64| 4.0 * axis.off * spacing / (axis.count - 1.0).max(1.0);
        if (dx - dy).abs() <= uncertainty(x, dx) + uncertainty(y, dy) + ROUNDED * dx {
            let common = (dx * (x.count - 1.0) + dy * (y.count - 1.0)) / (x.count + y.count - 2.0);
            extents = [Some(Extent::Cell(quantity(common)?)); 2];
        }
    }
    Ok(extents)
}

#[cfg(test)]
mod tests;
