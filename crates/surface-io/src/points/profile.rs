//! Points x, z along a line.

use super::axis::GridAxis;
use super::{lateral_unit, spacing_of};
use crate::channel::check_unit;
use crate::error::{ContentError, Error, Result};
use crate::format::Format;
use crate::options::ReadOptions;
use crate::provenance::{contradiction, sourced};
use crate::quantity::{Dimension, Quantity, Unit};
use crate::source::Input;
use crate::surface_file::{opened, told};
use crate::text::TextTable;
use contact_model::Line;
use std::io::Cursor;
use std::path::Path;

/// Reads a measured profile: text of two columns, x and z, in any order of the points.
///
/// The rules are those of points of a map along one axis: x has equal steps within a tenth of one ([`ReadOptions::cell`] for noisier ones),
/// the line is one step longer than from its first to its last point. Every place needs a height. Both units are in the file or are
/// given ([`ReadOptions::unit`] or [`ReadOptions::height_scale`], and [`ReadOptions::lateral_unit`]); `none` for both are plain numbers.
///
/// # Errors
/// [`Error::System`] where the system refuses; [`Error::Content`] for everything else.
///
/// ```
/// use surface_io::{ReadOptions, profile_from_bytes};
/// let declared = ReadOptions { unit: Some("nm".parse()?), lateral_unit: Some("um".parse()?), ..ReadOptions::default() };
/// let line = profile_from_bytes("a.txt", b"0.0 5\n0.5 6\n1.0 4\n", &declared)?;
/// assert_eq!((line.elements(), line.length(), line.heights()[1]), (3, 1.5e-6, 6e-9));
/// // The unit of the heights is not guessed.
/// assert!(profile_from_bytes("a.txt", b"0.0 5\n0.5 6\n1.0 4\n", &ReadOptions::default()).is_err());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn profile(path: &Path, declared: &ReadOptions) -> Result<Line> {
    let (input, length) = opened(path)?;
    read(path, input, length, declared)
}

/// Reads the bytes of a profile as [`profile`] does; `name` stands in the messages.
///
/// # Errors
/// As [`profile`].
pub fn profile_from_bytes(name: impl AsRef<Path>, bytes: &[u8], declared: &ReadOptions) -> Result<Line> {
    read(name.as_ref(), Cursor::new(bytes), bytes.len() as u64, declared)
}

fn read(path: &Path, input: impl Input, length: u64, declared: &ReadOptions) -> Result<Line> {
    let (mut source, format) = told(path, input, length, declared)?;
    if let Some(found) = format.filter(|format| !matches!(format, Format::Text | Format::Xyz)) {
        return Err(source.content(ContentError::NotOfFormat { expected: Format::Text, found }));
    }
    let bytes = source.start(length)?;
    line(&bytes, declared).map_err(Error::content(path))
}

fn line(bytes: &[u8], declared: &ReadOptions) -> Result<Line, ContentError> {
    if declared.size.is_some() || declared.width.is_some() {
        let reason = "x says how long a profile is; cell says its steps";
        return Err(ContentError::Useless { what: "size", reason });
    }
    let [table] = &TextTable::read(bytes, declared)?[..] else {
        let reason = "the text has several blocks of numbers, a profile is one";
        return Err(ContentError::Useless { what: "a profile", reason });
    };
    if table.columns != 2 {
        return Err(ContentError::NotProfile { line: table.first_line(), found: table.columns });
    }
    let (unit, scale) = heights_in(table, declared)?;
    let lateral = lateral_unit(declared, table, true)?.unwrap_or_else(Unit::none);
    if lateral.dimension() != unit.dimension() {
        let (first, second) = (format!("x has {lateral}"), format!("the heights have {unit}"));
        return Err(ContentError::Contradiction { what: "units", first, second });
    }
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
    let places = axis.count as usize;
    let mut heights = vec![f64::NAN; places];
    // Lines that are taken; 0 is none.
    let mut taken = vec![0_u32; places];
    for (i, point) in table.values.chunks_exact(2).enumerate() {
        let at = axis.index(point[0])?;
        if taken[at] > 0 {
            let [first, second] = [taken[at], table.lines[i]].map(|line| line as usize);
            return Err(ContentError::Duplicate { first, second, at: [point[0], 0.0] });
        }
        taken[at] = table.lines[i];
        let undefined = declared.missing.is_some_and(|mark| (point[1] - mark).abs() <= 0.0);
        heights[at] = if undefined { f64::NAN } else { unit.to_si(scale * point[1]) };
    }
    let undefined = heights.iter().filter(|h| h.is_nan()).count();
    if undefined > 0 {
        return Err(ContentError::Gaps { undefined, points: places });
    }
    if let Some(&value) = heights.iter().find(|h| h.is_infinite()) {
        return Err(ContentError::Overflow { value });
    }
    let length = Quantity::of(spacing * axis.count, &lateral)
        .map_err(|source| ContentError::Quantity { what: "length", source })?;
    Line::new(length.value(), heights).map_err(ContentError::Map)
}

/// Unit of the heights, and the factor before it.
fn heights_in(table: &TextTable, declared: &ReadOptions) -> Result<(Unit, f64), ContentError> {
    check_unit("unit", declared.unit.as_ref())?;
    let unit = sourced(table.heading.unit.clone(), declared.unit.clone(), |a, b| {
        a.same(b).then_some(()).ok_or_else(|| contradiction("unit of the heights", a, b))
    })?;
    let scale = table.scale.unwrap_or(1.0);
    match (unit, declared.height_scale) {
        (Some(unit), None) => Ok((unit.value, scale)),
        (Some(unit), Some(given)) => Err(ContentError::Contradiction {
            what: "unit of the heights",
            first: format!("{} {}", unit.value, unit.origin),
            second: format!("height_scale = {given}"),
        }),
        (None, Some(given)) => {
            let of = |source| ContentError::Quantity { what: "height_scale", source };
            Ok(("m".parse().map_err(of)?, given.expect(Dimension::LENGTH).map_err(of)?))
        }
        (None, None) => Err(ContentError::Unspecified {
            what: "the unit of the heights",
            seen: table.heading.notes([None; 2]),
            remedy: "say unit = \"nm\" or another unit of length",
        }),
    }
}
