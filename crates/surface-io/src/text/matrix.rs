//! A text matrix: one row per line.

use super::TextTable;
use super::statement::Side;
use crate::channel::{StoredChannel, StoredHeights};
use crate::error::ContentError;
use crate::extent::Extent;
use crate::format::Format;
use crate::options::{Border, ReadOptions};
use crate::quantity::{Quantity, Unit};

/// Part of a step by which printed coordinates may be off equal steps.
const EVEN: f64 = 0.02;

/// Rounding of a quotient of two lengths.
const EXACT: f64 = 4.0 * f64::EPSILON;

/// One column of more lines than this is refused where nothing says that it is a map. Fewer get a note.
const ONE_COLUMN: usize = 8;

/// The rows of a table as a map; the first line is row 0.
pub(crate) fn matrix(mut table: TextTable, declared: &ReadOptions) -> Result<StoredChannel, ContentError> {
    if declared.lateral_unit.is_some() && declared.border.is_none() {
        let reason = "a matrix has no coordinates; give size or cell with a unit";
        return Err(ContentError::Useless { what: "lateral_unit", reason });
    }
    note_one_column(&mut table, declared)?;
    let steps = border(&mut table, declared)?;
    let (rows, columns) = (table.rows(), table.columns);
    let mut extent = extents(&table, columns, rows)?;
    if extent == [None; 2] {
        extent = steps;
    }
    let details = table.details();
    if let Some(scale) = table.scale {
        table.values.iter_mut().for_each(|h| *h *= scale);
    }
    let (heights, unit) = (StoredHeights::Read(table.values), table.heading.stored_unit());
    let channel = StoredChannel::of(heights, details, [rows, columns], unit);
    let mut notes = table.heading.notes(extent);
    notes.append(&mut table.notes);
    notes.extend(table.heading.named().map(|names| format!("{names}, which are all taken for heights")));
    Ok(StoredChannel { name: table.heading.name, extent, notes, ..channel })
}

/// Tells that a table has one column only, unless its heading states both sides of the map.
///
/// # Errors
/// [`ContentError::OneColumn`] for many lines where text is not the requested format: they are rather the
/// heights of a profile, or a map whose separators are not read as such.
fn note_one_column(table: &mut TextTable, declared: &ReadOptions) -> Result<(), ContentError> {
    let rows = table.rows();
    if table.columns > 1 || rows == 1 || table.heading.sides().iter().all(Option::is_some) {
        return Ok(());
    }
    if rows > ONE_COLUMN && declared.format != Some(Format::Text) {
        return Err(ContentError::OneColumn { rows });
    }
    table.notes.push(format!(
        "the {rows} lines have one number each, and are taken for a map of one column: a profile needs two columns, x and z"
    ));
    Ok(())
}

/// Takes coordinates in the first line and the first value of each line out of a table that has them, and
/// gives the sides of its cells.
///
/// # Errors
/// [`ContentError::Border`] where numbers may be such coordinates and nobody says whether they are.
fn border(table: &mut TextTable, declared: &ReadOptions) -> Result<[Option<Extent>; 2], ContentError> {
    // Where the heading says both sides, they are those of all columns and rows.
    let stated = table.heading.sides().iter().all(Option::is_some);
    if table.rows() < 3 || table.columns < 3 || stated || declared.border == Some(Border::Heights) {
        return Ok([None; 2]);
    }
    let numbers = BorderNumbers::of(table);
    match declared.border {
        None => {
            return match numbers.suspected(table) {
                Some(what) => Err(ContentError::Border { what }),
                None => Ok([None; 2]),
            };
        }
        Some(_) if numbers.both() || numbers.counts != [false; 2] => {}
        Some(_) => {
            let reason = "the first line and the first column are no coordinates in equal steps";
            return Err(ContentError::Useless { what: "border", reason });
        }
    }
    numbers.remove(table);
    if !numbers.both() {
        return Ok([None; 2]);
    }
    let unit = table.heading.lateral_unit.clone().or_else(|| declared.lateral_unit.clone());
    let unit = unit.unwrap_or_else(Unit::none);
    Ok(numbers.steps.map(|step| Quantity::of(step?.abs(), &unit).ok().map(Extent::Cell)))
}

/// What the numbers in the first line and the first column of a table may be besides heights.
struct BorderNumbers {
    /// Whether there is no number in the corner.
    corner: bool,
    /// Steps of the first line and of the first column behind the corner, where they are equal ones.
    steps: [Option<f64>; 2],
    /// Whether they count columns, rows from 0 or 1 on, beside heights that are no whole numbers, as the index
    /// of a data frame does.
    counts: [bool; 2],
}

impl BorderNumbers {
    fn of(table: &TextTable) -> Self {
        let corner = table.values[0].is_nan();
        // Two numbers always ascend in equal steps; without a number in the corner they are no heights.
        let least = if corner { 2 } else { 3 };
        let whole = table.values.iter().all(|v| v.is_nan() || v.fract().abs() <= 0.0);
        let index = !whole && table.columns > 3;
        Self {
            corner,
            steps: [
                equal_steps(first_line(table).skip(1), least),
                equal_steps(first_column(table).skip(1), least),
            ],
            counts: [index && counts(first_line(table)), index && counts(first_column(table))],
        }
    }

    /// Whether the line and the column may be coordinates.
    fn both(&self) -> bool {
        self.steps.iter().all(Option::is_some)
    }

    /// What looks like coordinates or an index, in words.
    fn suspected(&self, table: &TextTable) -> Option<&'static str> {
        let [line_counts, column_counts] = self.counts;
        if self.both() && self.corner {
            Some("first line and the first column have no corner, but")
        } else if self.both() && !self.is_plane(table) {
            Some("first line and the first column have, behind their corner,")
        } else if line_counts {
            Some("first line has")
        } else if column_counts {
            Some("first column has")
        } else {
            None
        }
    }

    /// Whether the table is a plane of heights, which is in equal steps too, those of all its lines.
    fn is_plane(&self, table: &TextTable) -> bool {
        let (line, column): (Vec<f64>, Vec<f64>) =
            (first_line(table).collect(), first_column(table).collect());
        let allowed = EVEN * self.steps.iter().flatten().map(|step| step.abs()).sum::<f64>();
        table.values.iter().enumerate().all(|(i, value)| {
            let expected = line[i % table.columns] + column[i / table.columns] - line[0];
            value.is_nan() || (value - expected).abs() <= allowed
        })
    }

    /// Leaves the heights in the table, with x and y ascending. An index may stand along one side only.
    fn remove(&self, table: &mut TextTable) {
        let [lines, places] = self.counts.map(|counts| usize::from(self.both() || counts));
        let heights = table.values.chunks_exact(table.columns).skip(lines).flat_map(|row| &row[places..]);
        table.values = heights.copied().collect();
        table.lines.drain(..lines);
        table.columns -= places;
        if !self.both() {
            return;
        }
        let [descends_along_x, descends_along_y] = self.steps.map(|step| step.is_some_and(|step| step < 0.0));
        if descends_along_x {
            table.values.chunks_exact_mut(table.columns).for_each(<[f64]>::reverse);
        }
        if descends_along_y {
            table.values = table.values.rchunks(table.columns).flatten().copied().collect();
            table.lines.reverse();
        }
    }
}

fn first_line(table: &TextTable) -> impl Iterator<Item = f64> {
    table.values[..table.columns].iter().copied()
}

fn first_column(table: &TextTable) -> impl Iterator<Item = f64> {
    table.values.iter().step_by(table.columns).copied()
}

/// Whether the numbers count from 0 or 1 on.
fn counts(mut values: impl Iterator<Item = f64>) -> bool {
    let first = values.next().unwrap_or(f64::NAN);
    matches!(first, 0.0 | 1.0) && values.enumerate().all(|(i, v)| (v - first - 1.0 - i as f64).abs() <= 0.0)
}

/// The step of `least` numbers or more in equal steps up or down, within the digits that are printed.
fn equal_steps(mut values: impl Iterator<Item = f64>, least: usize) -> Option<f64> {
    let first = values.next()?;
    let all: Vec<f64> = values.collect();
    let step = (all.last()? - first) / all.len() as f64;
    let equal =
        all.iter().enumerate().all(|(i, v)| (v - first - (i + 1) as f64 * step).abs() <= EVEN * step.abs());
    (step.abs() > 0.0 && equal && all.len() + 1 >= least).then_some(step)
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
        let side = |own: Option<Side>, other: Option<Side>, count: usize| match (own, other) {
            (None, Some(other)) => cell(Extent::Side(other.quantity), count).map(Some),
            (own, _) => Ok(own.map(|own| Extent::Side(own.quantity))),
        };
        return Ok([side(width, height, rows)?, side(height, width, columns)?]);
    };
    let (a, b) = (across.quantity, down.quantity);
    if a.dimension() != b.dimension() {
        let (first, second) = (format!("{a} is the width"), format!("{b} is the height"));
        return Err(ContentError::Contradiction { what: "size", first, second });
    }
    let (dx, dy) = (Extent::Side(a).cell(columns)?, Extent::Side(b).cell(rows)?);
    let off = (dx.value() / dy.value() - 1.0).abs();
    // A height that is square to the last digits of a double is kept as it stands: what is written is read as
    // the same map.
    let square = off > EXACT && off <= across.rounding + down.rounding;
    Ok([Some(Extent::Side(a)), Some(if square { Extent::Cell(dx) } else { Extent::Side(b) })])
}
