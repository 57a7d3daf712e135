//! A text matrix: one row per line.

use super::TextTable;
use crate::channel::{StoredChannel, StoredHeights, StoredUnit};
use crate::error::ContentError;
use crate::extent::Extent;
use crate::options::ReadOptions;

/// Rounding of a quotient of two lengths.
const EXACT: f64 = 4.0 * f64::EPSILON;

/// The rows of a table as a map; the first line is row 0.
pub(crate) fn matrix(mut table: TextTable, declared: &ReadOptions) -> Result<StoredChannel, ContentError> {
    if declared.lateral_unit.is_some() {
        let reason = "a matrix has no coordinates; give size or cell with a unit";
        return Err(ContentError::Useless { what: "lateral_unit", reason });
    }
    let (rows, columns) = (table.rows(), table.columns);
    let extent = extents(&table, columns, rows)?;
    let details = table.details();
    if let Some(scale) = table.scale {
        table.values.iter_mut().for_each(|h| *h *= scale);
    }
    let (heights, unit) = (StoredHeights::Read(table.values), StoredUnit::heights(table.heading.unit));
    let channel = StoredChannel::of(heights, details, [rows, columns], unit);
    Ok(StoredChannel { name: table.heading.name, extent, ..channel })
}

/// Both sides by the comments. A file that says one of them only has square cells, and so has one whose cells
/// are square within the digits that it prints.
fn extents(table: &TextTable, columns: usize, rows: usize) -> Result<[Option<Extent>; 2], ContentError> {
    let ([width, height], cells) = table.heading.of_matrix([columns, rows])?;
    if let [Some(_), Some(_)] = cells {
        return Ok(cells);
    }
    let cell = |side: Extent, count: usize| side.cell(count).map(Extent::Cell);
    let (Some(across), Some(down)) = (width, height) else {
        return Ok([
            match (width, height) {
                (None, Some(down)) => Some(cell(Extent::Side(down.quantity), rows)?),
                (across, _) => across.map(|across| Extent::Side(across.quantity)),
            },
            match (width, height) {
                (Some(across), None) => Some(cell(Extent::Side(across.quantity), columns)?),
                (_, down) => down.map(|down| Extent::Side(down.quantity)),
            },
        ]);
    };
    let (a, b) = (across.quantity, down.quantity);
    if a.dimension() != b.dimension() {
        let (first, second) = (format!("{a} is the width"), format!("{b} is the height"));
        return Err(ContentError::Contradiction { what: "size", first, second });
    }
    let (dx, dy) = (Extent::Side(a).cell(columns)?, Extent::Side(b).cell(rows)?);
    let off = (dx.value() / dy.value() - 1.0).abs();
    // A height that is square to the last digits of a double is kept as it stands: what is written is read as the same map.
    let square = off > EXACT && off <= across.rounding + down.rounding;
    Ok([Some(Extent::Side(a)), Some(if square { Extent::Cell(dx) } else { Extent::Side(b) })])
}
