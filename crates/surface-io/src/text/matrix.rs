//! A text matrix: one row per line.

use super::Table;
use crate::error::Problem;
use crate::format::Format;
use crate::quantity::Quantity;
use crate::scan::{Declared, Found, PRINTED};

/// The rows of a table as a map; the first line is row 0.
pub(crate) fn matrix(table: Table, declared: &Declared) -> Result<Found, Problem> {
    if declared.lateral_unit.is_some() {
        let reason = "a matrix has no coordinates; give cell or width with a unit";
        return Err(Problem::Useless { what: "lateral_unit", reason });
    }
    let (rows, columns) = (table.rows(), table.columns);
    let heading = &table.heading;
    let side = |said: Option<Quantity>, cells: usize| {
        let said = heading.side(said)?;
        Quantity::new(said.value() / cells as f64, said.dimension()).ok()
    };
    let (across, down) = (side(heading.width, columns), side(heading.height, rows));
    if let (Some(a), Some(b)) = (across, down) {
        if a.dimension() != b.dimension() {
            let (first, second) = (format!("{a} by its width"), format!("{b} by its height"));
            return Err(Problem::Contradiction { what: "side of a cell", first, second });
        }
        if (a.value() / b.value() - 1.0).abs() > PRINTED {
            return Err(Problem::Oblong { dx: a.value(), dy: b.value() });
        }
    }
    let details = table.delimiter.to_string();
    let (unit, cell) = (heading.unit.clone(), across.or(down));
    Ok(Found { format: Format::Text, details, rows, columns, heights: table.values, unit, cell })
}
