//! Points x, z along a line as a map of one row.

use super::axis::GridAxis;
use super::{SHOWN, lateral_unit, spacing_of};
use crate::channel::{StoredChannel, StoredHeights, StoredUnit};
use crate::error::ContentError;
use crate::extent::Extent;
use crate::options::ReadOptions;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::text::TextTable;

/// The points of a table of two columns as a map of one row: column i at `x_min + i * spacing`; places without a point are undefined.
/// The extent along y stays open: the file says nothing of it.
///
/// Cost O(n log n) for n points.
pub(crate) fn row(table: &TextTable, declared: &ReadOptions) -> Result<StoredChannel, ContentError> {
    if table.columns != 2 {
        return Err(ContentError::NotProfile { line: table.first_line(), found: table.columns });
    }
    let unit = table.heading.unit.clone();
    let heights_unit = declared.unit.as_ref().or(unit.as_ref());
    let has_length =
        declared.height_scale.is_some() || heights_unit.is_some_and(|u| u.dimension() == Dimension::LENGTH);
    let lateral = lateral_unit(declared, table, has_length)?.unwrap_or_else(Unit::none);
    let given = declared.cell.map(|cell| spacing_of(cell.both()[0], Some(&lateral))).transpose()?;
    let along: Vec<f64> = table.values.iter().step_by(2).copied().collect();
    if let Some(point) = along.iter().position(|x| x.is_nan()) {
        return Err(ContentError::Coordinate { axis: 'x', line: table.lines[point] as usize });
    }
    let points = table.rows();
    let axis = GridAxis::find('x', along, given)?;
    let Some(spacing) = axis.spacing else {
        let remedy = "say cell = \"0.5 um\"; one point has no step";
        return Err(ContentError::Unspecified { what: "the step of the profile", seen: Vec::new(), remedy });
    };
    if axis.count > 2.0 * points as f64 {
        return Err(ContentError::Sparse { points, rows: 1.0, columns: axis.count });
    }
    let columns = axis.count as usize;
    let mut heights = vec![f64::NAN; columns];
    // Lines that are taken; 0 is none.
    let mut taken = vec![0_u32; columns];
    for (i, point) in table.values.chunks_exact(2).enumerate() {
        let at = axis.index(point[0])?;
        if taken[at] > 0 {
            let [first, second] = [taken[at], table.lines[i]].map(|line| line as usize);
            return Err(ContentError::Duplicate { first, second, at: [point[0], 0.0] });
        }
        taken[at] = table.lines[i];
        heights[at] = table.scale.unwrap_or(1.0) * point[1];
    }
    let step = Quantity::of(spacing, &lateral)
        .map_err(|source| ContentError::Quantity { what: "spacing", source })?;
    let off = 100.0 * axis.off;
    let off =
        if off > SHOWN { format!(", up to {off:.2} % of a step off their places") } else { String::new() };
    let details = format!("{points} points x, z, {}{off}", table.details());
    let (heights, unit) = (StoredHeights::Read(heights), StoredUnit::heights(unit));
    let extent = [Some(Extent::Cell(step)), None];
    let notes = table.heading.notes(extent);
    let channel = StoredChannel::of(heights, details, [1, columns], unit);
    Ok(StoredChannel { name: table.heading.name.clone(), extent, notes, ..channel })
}
