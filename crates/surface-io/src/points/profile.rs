//! Points x, z along a line.

use super::axis::GridAxis;
use super::{SHOWN, lateral_unit, spacing_of};
use crate::channel::{StoredChannel, StoredHeights, StoredUnit};
use crate::error::{ContentError, Result};
use crate::extent::Extent;
use crate::format::Format;
use crate::options::ReadOptions;
use crate::preprocessing::Preprocessing;
use crate::quantity::{Dimension, Quantity, Unit};
use crate::scan::Scan;
use crate::source::Input;
use crate::surface_file::{opened, told};
use crate::text::TextTable;
use contact_model::Line;
use std::io::Cursor;
use std::path::Path;

/// Reads a measured profile as a line: text of two columns, x and z, in any order of the points. [`Scan::read`] makes a map of one row
/// of it, the body that is uniform along y.
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
    if let Some(found) = format.filter(|f| !matches!(f, Format::Text | Format::Xyz | Format::Profile)) {
        return Err(source.content(ContentError::NotOfFormat { expected: Format::Profile, found }));
    }
    if declared.size.is_some() || declared.width.is_some() {
        let reason = "x says how long a profile is; cell says its steps";
        return Err(source.content(ContentError::Useless { what: "size", reason }));
    }
    let bytes = source.start(length)?;
    let several =
        ContentError::Useless { what: "a profile", reason: "the text has several blocks of numbers" };
    let channel = TextTable::read(&bytes, declared).and_then(|tables| match &tables[..] {
        [table] => row(table, declared),
        _ => Err(several),
    });
    let mut channel = channel.map_err(|e| source.content(e))?;
    drop(bytes);
    let (heights, points) = (channel.read(&mut source)?, channel.columns);
    let scan = Scan::new(path, Format::Profile, (0, channel), heights, declared);
    let scan = scan.map_err(|e| source.content(e))?;
    let undefined = scan.metadata().undefined;
    if undefined > 0 {
        return Err(source.content(ContentError::Gaps { undefined, points }));
    }
    if scan.metadata().unit.is_none() {
        let (what, seen) = ("the unit of the heights", scan.metadata().notes.clone());
        let remedy = "say unit = \"nm\" or another unit of length";
        return Err(source.content(ContentError::Unspecified { what, seen, remedy }));
    }
    let map = scan.into_preprocessed(&Preprocessing::default())?.map;
    Line::new(map.size().x, map.heights().to_vec()).map_err(|e| source.content(ContentError::Map(e)))
}

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
