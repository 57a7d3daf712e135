//! The maps that a table of numbers is, by its heading or by its numbers.
//!
//! [`layout`] alone decides what columns are that have names:
//!
//! - x, y and others are points of a map; heights where there are columns of heights, else every other column
//!   is a channel of its own.
//! - One coordinate and others are profiles, likewise.
//! - Numbers of rows and columns (`row`, `col`) are places without a length: the side of a cell is asked for.
//! - Degrees are no lengths, and columns without a coordinate are no map: both are refused.
//! - Without a heading the numbers decide, or the format that was requested.

use crate::channel::{MOST_CHANNELS, StoredUnit};
use crate::error::ContentError;
use crate::format::Format;
use crate::options::ReadOptions;
use crate::points::{AxisColumn, PointColumns, is_full_grid};
use crate::provenance::contradiction;
use crate::quantity::Unit;
use crate::text::{ColumnKind, TextColumn, TextTable, symbol};

/// The kind of map that a table of numbers is.
#[derive(Debug)]
pub(crate) enum Layout {
    Matrix,
    Points(Vec<PointColumns>),
    Profiles(Vec<PointColumns>),
}

impl Layout {
    pub(crate) fn format(&self) -> Format {
        match self {
            Self::Matrix => Format::Text,
            Self::Points(_) => Format::Xyz,
            Self::Profiles(_) => Format::Profile,
        }
    }
}

/// What a table is: as its heading names its columns, and as its numbers are where it has no such heading.
///
/// # Errors
/// [`ContentError::Columns`] where the named columns are no map; [`ContentError::Ambiguous`] for three
/// columns without a name that may be points or a matrix; [`ContentError::NoPoint`] where the number of
/// columns is not that of the requested format; contradictions between statements about units.
pub(crate) fn layout(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    if requested == Some(Format::Text) || !table.heading.columns.iter().any(TextColumn::tells) {
        return by_numbers(table, requested, declared);
    }
    by_names(table, requested, declared)
}

/// The columns in the order x, y, z or x, z.
fn by_numbers(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    let format = match requested {
        Some(format) => format,
        None => format_of(table)?,
    };
    let expected = match format {
        Format::Xyz if table.columns != 3 => "x, y and z of one point",
        Format::Profile if table.columns != 2 => "x and z of one point of a profile",
        Format::Xyz | Format::Profile => {
            let (last, unit) = (table.columns - 1, lateral_unit(table, None, declared)?);
            let axes = (0..last).map(|at| AxisColumn { at, unit: unit.clone(), index: false }).collect();
            let names = table.heading.named();
            let notes = names.map(|names| format!("{names}, which are taken in the order of points"));
            let (unit, notes) = (table.heading.stored_unit(), notes.into_iter().collect());
            let points = vec![PointColumns { axes, value: last, name: None, unit, notes }];
            return Ok(if format == Format::Xyz { Layout::Points(points) } else { Layout::Profiles(points) });
        }
        _ => return Ok(Layout::Matrix),
    };
    Err(ContentError::NoPoint { line: table.first_line(), found: table.columns, expected })
}

/// Whether numbers without names are a matrix, points or a profile.
fn format_of(table: &TextTable) -> Result<Format, ContentError> {
    if table.columns == 3 && table.rows() > 3 {
        // Numbers whose first two columns are all places of a grid, each once, are no heights.
        let places = || is_full_grid(table).then_some(Format::Xyz);
        let ambiguous = ContentError::Ambiguous { lines: table.rows() };
        return table.heading.format().or_else(places).ok_or(ambiguous);
    }
    Ok(if table.is_profile() { Format::Profile } else { Format::Text })
}

/// The columns by their names.
fn by_names(
    table: &TextTable,
    requested: Option<Format>,
    declared: &ReadOptions,
) -> Result<Layout, ContentError> {
    let columns = &table.heading.columns;
    let ColumnRoles { axes, values } = ColumnRoles::of(columns, requested)?;
    check_values(columns, &values)?;
    let unused = note_of_unused(columns, &axes, &values);
    let mut maps = Vec::with_capacity(values.len());
    for &value in &values {
        let column = &columns[value];
        let named = values.len() > 1 || column.kind == ColumnKind::Other;
        maps.push(PointColumns {
            axes: axes.iter().map(|&at| axis_column(table, at, declared)).collect::<Result<_, _>>()?,
            value,
            name: named.then(|| column.name.clone()),
            unit: unit_of_values(table, column)?,
            notes: unused.iter().cloned().collect(),
        });
    }
    Ok(if axes.len() == 2 { Layout::Points(maps) } else { Layout::Profiles(maps) })
}

/// Which columns are coordinates, x before y, and which are values.
struct ColumnRoles {
    axes: Vec<usize>,
    values: Vec<usize>,
}

impl ColumnRoles {
    /// Finds the coordinates and the values among named columns.
    fn of(columns: &[TextColumn], requested: Option<Format>) -> Result<Self, ContentError> {
        let (mut x, mut y) = coordinates(columns)?;
        let heights = places(columns, |column| column.kind == ColumnKind::Height);
        let along = places(columns, |column| column.kind == ColumnKind::Along);
        let mut others =
            places(columns, |column| column.kind == ColumnKind::Other && !column.name.is_empty());
        if let (None, None) = (x, y) {
            x = along.first().copied();
        } else {
            others.extend(along);
            others.sort_unstable();
        }
        let mut values = if heights.is_empty() { others } else { heights };
        if let (Some(Format::Profile), Some(_), Some(value), []) = (requested, x, y, &values[..]) {
            // y over x.
            (y, values) = (None, vec![value]);
        }
        let leave = "skip_lines leaves out the heading, and format = \"text\" takes all columns for heights";
        let axes: Vec<usize> = [x, y].into_iter().flatten().collect();
        let wrong = match (requested, axes.len()) {
            (_, 0) => Some("expected coordinates x and y, or x of a profile, among them"),
            (Some(Format::Xyz), 1) => Some("points need x and y"),
            (Some(Format::Profile), 2) => Some("a profile needs x and heights alone"),
            _ => None,
        };
        match wrong {
            Some(wrong) => Err(refused(columns, format!("{wrong}; {leave}"))),
            None => Ok(Self { axes, values }),
        }
    }
}

/// The columns along x and along y, each of them one at most.
fn coordinates(columns: &[TextColumn]) -> Result<(Option<usize>, Option<usize>), ContentError> {
    let [along_x, along_y] = [0, 1].map(|axis| places(columns, |column| column.axis() == Some(axis)));
    for along in [&along_x, &along_y] {
        if let [first, second, ..] = along[..] {
            let (first, second) = (&columns[first], &columns[second]);
            let problem = format!("{first} and {second} are along one axis, expected one of them");
            return Err(refused(columns, problem));
        }
    }
    if let Some(column) = columns.iter().find(|column| matches!(column.kind, ColumnKind::Degrees(_))) {
        let remedy = "project the points to lengths, such as metres of easting and northing";
        return Err(refused(columns, format!("{column} is an angle, and no length: {remedy}")));
    }
    Ok((along_x.first().copied(), along_y.first().copied()))
}

/// Refuses a heading without a column of heights, or with more of them than a file has channels.
fn check_values(columns: &[TextColumn], values: &[usize]) -> Result<(), ContentError> {
    if values.is_empty() {
        let remedy = "expected a column of heights beside the coordinates";
        let profile = "format = \"profile\" takes y for heights over x";
        let problem = if columns.len() == 2 { format!("{remedy}; {profile}") } else { remedy.to_owned() };
        return Err(refused(columns, problem));
    }
    if values.len() > MOST_CHANNELS {
        let found = values.len();
        let problem = format!("expected at most {MOST_CHANNELS} columns of heights, found {found}");
        return Err(refused(columns, problem));
    }
    Ok(())
}

/// A note on the columns that are neither coordinates nor values, where there are any.
fn note_of_unused(columns: &[TextColumn], axes: &[usize], values: &[usize]) -> Option<String> {
    let unused: Vec<String> = (0..columns.len())
        .filter(|at| !axes.contains(at) && !values.contains(at) && !columns[*at].cell.is_empty())
        .map(|at| columns[at].to_string())
        .collect();
    let list = unused.join(", ");
    (!unused.is_empty()).then(|| format!("the heading names further columns, which are not used: {list}"))
}

/// The places of the columns of one kind.
fn places(columns: &[TextColumn], is: impl Fn(&TextColumn) -> bool) -> Vec<usize> {
    (0..columns.len()).filter(|&at| is(&columns[at])).collect()
}

/// The error of a heading whose columns are no map.
fn refused(columns: &[TextColumn], problem: String) -> ContentError {
    let columns: Vec<String> = columns.iter().map(ToString::to_string).collect();
    ContentError::Columns { columns: columns.join(", "), problem }
}

/// The unit of the values of a column: that of its heading, or of a statement about heights.
fn unit_of_values(table: &TextTable, column: &TextColumn) -> Result<StoredUnit, ContentError> {
    match (StoredUnit::written(symbol(&column.unit)), table.heading.stored_unit()) {
        (StoredUnit::Unknown, stated) => Ok(stated),
        (StoredUnit::Heights(own), StoredUnit::Heights(stated)) if !own.same(&stated) => {
            Err(ContentError::contradiction(
                "two lines of the header",
                format!("value units: {stated}"),
                format!("the column {column}"),
            ))
        }
        (own, _) => Ok(own),
    }
}

fn axis_column(table: &TextTable, at: usize, declared: &ReadOptions) -> Result<AxisColumn, ContentError> {
    let column = &table.heading.columns[at];
    if let ColumnKind::Index(_) = column.kind {
        if declared.lateral_unit.is_some() {
            let reason =
                "the heading names numbers of rows or columns, which have no unit; cell says their step";
            return Err(ContentError::Useless { what: "lateral_unit", reason });
        }
        return Ok(AxisColumn { at, unit: None, index: true });
    }
    let own = column.length();
    if own.is_none() && !column.unit.is_empty() {
        let problem = format!("{column}: expected a length as the unit of a coordinate");
        return Err(ContentError::Columns { columns: column.to_string(), problem });
    }
    Ok(AxisColumn { at, unit: lateral_unit(table, own, declared)?, index: false })
}

/// The unit of coordinates: of their column, of a statement of the heading, or as given.
///
/// # Errors
/// [`ContentError::Contradiction`] where two of them differ.
fn lateral_unit(
    table: &TextTable,
    own: Option<Unit>,
    declared: &ReadOptions,
) -> Result<Option<Unit>, ContentError> {
    let file = match (own, table.heading.lateral_unit.clone()) {
        (Some(own), Some(stated)) if !own.same(&stated) => {
            return Err(contradiction("unit of x and y", &own, &stated));
        }
        (own, stated) => own.or(stated),
    };
    let given = &declared.lateral_unit;
    if let (Some(a), Some(b)) = (&file, given)
        && !a.same(b)
    {
        return Err(contradiction("unit of x and y", a, b));
    }
    Ok(given.clone().or(file))
}
