//! Points x, z along a line as a map of one row.

use super::{Placed, PointColumns, axis, channel, check_units, placed};
use crate::channel::StoredChannel;
use crate::error::ContentError;
use crate::extent::Extent;
use crate::options::ReadOptions;
use crate::quantity::{Quantity, Unit};
use crate::text::TextTable;

/// The points of these columns of a table as a map of one row: column i at `x_min + i * spacing`; places
/// without a point are undefined. The extent along y stays open: the file says nothing of it.
///
/// Cost O(n log n) for n points.
pub(crate) fn row(
    table: &TextTable,
    columns: &PointColumns,
    declared: &ReadOptions,
) -> Result<StoredChannel, ContentError> {
    let [along] = &columns.axes[..] else { return Err(ContentError::Empty) };
    check_units(table, columns, declared)?;
    let given = declared.cell.map(|cell| cell.both()[0]);
    let axis = axis(table, 'x', along, given)?;
    let Some(spacing) = axis.spacing else {
        let remedy = "say cell, such as 0.5 um; one point has no step";
        return Err(ContentError::Unspecified { what: "the step of the profile", seen: Vec::new(), remedy });
    };
    let heights = placed(table, columns, &[&axis])?;
    let unit = along.unit.clone().unwrap_or_else(Unit::none);
    let step = Quantity::of(spacing, &unit).map_err(ContentError::quantity("spacing"))?;
    // Numbers of points have no length.
    let step = if along.index { given } else { Some(step) };
    let (shape, extent) = ([1, axis.count as usize], [step.map(Extent::Cell), None]);
    let placed = Placed { words: ["points x, z", "step"], off: axis.off, heights, shape, extent };
    Ok(channel(table, columns, placed))
}
