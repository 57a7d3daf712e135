//! Points x, z along a line as a map of one row.

use super::{axis, channel, lateral_unit, placed, spacing_of};
use crate::channel::StoredChannel;
use crate::error::ContentError;
use crate::extent::Extent;
use crate::options::ReadOptions;
use crate::quantity::{Quantity, Unit};
use crate::text::TextTable;

/// The points of a table of two columns as a map of one row: column i at `x_min + i * spacing`; places
/// without a point are undefined. The extent along y stays open: the file says nothing of it.
///
/// Cost O(n log n) for n points.
pub(crate) fn row(table: &TextTable, declared: &ReadOptions) -> Result<StoredChannel, ContentError> {
    if table.columns != 2 {
        let (line, found) = (table.first_line(), table.columns);
        return Err(ContentError::NoPoint { line, found, expected: "x and z of one point of a profile" });
    }
    let lateral = lateral_unit(declared, table)?.unwrap_or_else(Unit::none);
    let given = declared.cell.map(|cell| spacing_of(cell.both()[0], Some(&lateral))).transpose()?;
    let axis = axis(table, 'x', 0, given)?;
    let Some(spacing) = axis.spacing else {
        let remedy = "say cell, such as 0.5 um; one point has no step";
        return Err(ContentError::Unspecified { what: "the step of the profile", seen: Vec::new(), remedy });
    };
    let heights = placed(table, &[&axis])?;
    let step = Quantity::of(spacing, &lateral).map_err(ContentError::quantity("spacing"))?;
    let (shape, extent) = ([1, axis.count as usize], [Some(Extent::Cell(step)), None]);
    Ok(channel(table, ["points x, z", "step"], axis.off, heights, shape, extent))
}
