//! The content of a file before preprocessing.

use crate::channel::{StoredChannel, StoredUnit, check_unit};
use crate::error::{ContentError, Place};
use crate::extent::{self, Extent};
use crate::format::Format;
use crate::options::ReadOptions;
use crate::provenance::{Origin, Sourced, contradiction, sourced};
use crate::quantity::{Dimension, Quantity, Unit};
use contact_model::units::{ascii, five, number, to_digits};
use std::fmt;
use std::path::{Path, PathBuf};

/// Metadata of a file, for the user to check; shown line by line.
#[derive(Debug, Clone, PartialEq)]
pub struct Metadata {
    /// The format.
    pub format: Format,
    /// Number of the channel in its file, from 0.
    pub number: usize,
    /// Name of the channel, where the file gives one.
    pub name: Option<String>,
    /// Details of it: type of the numbers, order, delimiter.
    pub details: String,
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// Whether it is a profile: one row in a file that states only the length along x (and does not have
    /// points x, y, z). It represents a body that is uniform along y. Its cells are squares unless the caller
    /// states otherwise, and forces on it are counted on the side of one cell along y.
    pub profile: bool,
    /// Sides of the map along x and y; `None` where neither they nor the cells are known.
    pub size: Option<[Quantity; 2]>,
    /// Sides of one cell along x and y; `None` where neither they nor the size are known.
    pub cell: Option<Sourced<[Quantity; 2]>>,
    /// Unit of the heights; `None` where it is unknown.
    pub unit: Option<Sourced<Unit>>,
    /// The values are no heights but a phase, a voltage or counts, and make no map: their unit as the file
    /// writes it, empty where it does not.
    pub no_heights: Option<String>,
    /// Number of undefined points: cells without a height.
    pub undefined: usize,
    /// Lowest and highest height in the file's unit; `None` where no point is defined.
    pub range: Option<[f64; 2]>,
    /// Root mean square of the heights about their mean in the file's unit; `None` where no point is defined.
    pub rms_height: Option<f64>,
    /// Notes for people: statements of the file that are not used or are ambiguous, and values far from all
    /// others.
    pub notes: Vec<String>,
}

impl Metadata {
    /// Share of the cells without a height, 0 to 1.
    pub fn undefined_share(&self) -> f64 {
        self.undefined as f64 / (self.rows as f64 * self.columns as f64)
    }
}

impl fmt::Display for Metadata {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "format     {} ({})", self.format, self.details)?;
        if let Some(name) = &self.name {
            writeln!(f, "channel    {} {name}", self.number)?;
        }
        if self.profile {
            writeln!(f, "shape      a profile of {} points", self.columns)?;
        } else {
            writeln!(f, "shape      {} rows of {}", self.rows, self.columns)?;
        }
        let length = |length: Quantity| ascii(&to_digits(length.value(), &length.dimension().symbol(), 7));
        let size = self.size.map(|size| size.map(length));
        let cell = self.cell.as_ref().map(|cell| (cell.value.map(length), cell.origin));
        match (size, cell) {
            (Some([x, _]), Some(([dx, dy], origin))) if self.profile => {
                writeln!(
                    f,
                    "length     {x} ({origin}), steps of {dx}
body       uniform along y: forces are those on {dy} of it"
                )?;
            }
            (Some([x, y]), Some(([dx, dy], origin))) => {
                writeln!(
                    f,
                    "size       {x} x {y} ({origin})
cell       {dx} x {dy}"
                )?;
            }
            _ => writeln!(f, "size       unknown")?,
        }
        match (&self.no_heights, &self.unit) {
            (Some(unit), _) if unit.is_empty() => writeln!(f, "heights    none: values without a unit")?,
            (Some(unit), _) => writeln!(f, "heights    none: values in {unit}")?,
            (None, Some(unit)) => writeln!(f, "heights    in {} ({})", unit.value, unit.origin)?,
            (None, None) => writeln!(f, "heights    unit unknown")?,
        }
        match (self.range, self.rms_height) {
            (Some([low, high]), Some(rms)) => {
                let [low, high, rms] = [low, high, rms].map(|height| five(height, ""));
                writeln!(f, "range      {low} to {high}, rms about the mean {rms}")?;
            }
            _ => writeln!(f, "range      none")?,
        }
        write!(f, "undefined  {} of {} points", self.undefined, self.rows * self.columns)?;
        if self.undefined > 0 {
            write!(f, " ({:.3} %)", 100.0 * self.undefined_share())?;
        }
        self.notes.iter().try_for_each(|note| write!(f, "\nnote       {note}"))
    }
}

/// A rectangle of heights as in the file, with undefined points and in the file's unit.
///
/// [`Scan::map`] makes a [`contact_model::HeightMap`] of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Scan {
    path: PathBuf,
    metadata: Metadata,
    /// Row-major; NaN is an undefined point and never leaves this crate.
    heights: Vec<f64>,
}

/// A channel of a file, with its heights as they are there.
pub(crate) struct DecodedChannel {
    pub(crate) format: Format,
    /// Number of the channel, from 0.
    pub(crate) number: usize,
    pub(crate) channel: StoredChannel,
    /// Row-major; NaN where undefined.
    pub(crate) heights: Vec<f64>,
}

impl Scan {
    /// A channel with its heights, checked against what is declared.
    pub(crate) fn new(
        path: &Path,
        decoded: DecodedChannel,
        declared: &ReadOptions,
    ) -> Result<Self, ContentError> {
        let DecodedChannel { format, number, channel, mut heights } = decoded;
        let StoredChannel { name, details, rows, columns, unit, extent, mut notes, compared, .. } = channel;
        if let Some(mark) = declared.missing {
            heights.iter_mut().filter(|h| compared.same(**h, mark)).for_each(|h| *h = f64::NAN);
        }
        // Before the scale of the caller, as `missing` is: the number that a note names is to be one for it.
        notes.extend(lone_extremes(&heights));
        let (mut unit, no_heights) = unit_of_heights(unit, declared)?;
        if let Some(scale) = declared.height_scale {
            unit = Some(scaled(scale, unit.as_ref(), &mut heights)?);
        }
        let (undefined, range) = undefined_and_range(&heights, columns)?;
        // Points of a map may lie in one row by chance.
        let profile = rows == 1 && format != Format::Xyz && matches!(extent, [Some(_), None]);
        let (size, cell) = match extents(extent, profile, [columns, rows], declared)? {
            Some(Sourced { value: [x, y], origin }) => (
                Some([x.side(columns)?, y.side(rows)?]),
                Some(Sourced { value: [x.cell(columns)?, y.cell(rows)?], origin }),
            ),
            None => (None, None),
        };
        let rms_height = range.map(|range| rms(&heights, columns, undefined, range));
        let metadata = Metadata {
            format,
            number,
            name,
            details,
            rows,
            columns,
            profile,
            size,
            cell,
            unit,
            no_heights,
            undefined,
            range,
            rms_height,
            notes,
        };
        Ok(Self { path: path.to_owned(), metadata, heights })
    }

    /// The metadata.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// The file, or the name that was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Height of a cell in the file's unit; `None` where it is undefined or outside.
    pub fn height(&self, row: usize, column: usize) -> Option<f64> {
        let inside = row < self.metadata.rows && column < self.metadata.columns;
        let height = inside.then(|| self.heights[row * self.metadata.columns + column])?;
        (!height.is_nan()).then_some(height)
    }

    /// The heights, which are no longer here.
    pub(crate) fn take_heights(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.heights)
    }

    pub(crate) fn heights(&self) -> &[f64] {
        &self.heights
    }
}

/// The unit of the heights by the file and the caller, and that of values that are no heights.
fn unit_of_heights(
    stored: StoredUnit,
    declared: &ReadOptions,
) -> Result<(Option<Sourced<Unit>>, Option<String>), ContentError> {
    check_unit("unit", declared.unit.as_ref())?;
    let (unit, no_heights) = match stored {
        StoredUnit::Unknown => (None, None),
        StoredUnit::Heights(unit) => (Some(unit), None),
        StoredUnit::NoHeights(unit) => (None, Some(unit.unwrap_or_default())),
    };
    let unit = sourced(unit, declared.unit.clone(), |a, b| {
        a.same(b).then_some(()).ok_or_else(|| contradiction("unit of the heights", a, b))
    })?;
    Ok((unit, no_heights))
}

/// The number of undefined points, and the lowest and the highest height.
///
/// # Errors
/// [`ContentError::Infinite`] for a height that is not finite.
#[inline(never)] // Inside of its caller its loop runs in memory instead of registers.
fn undefined_and_range(heights: &[f64], columns: usize) -> Result<(usize, Option<[f64; 2]>), ContentError> {
    if let Some(i) = heights.iter().position(|h| h.is_infinite()) {
        let place = Place::Cell { row: i / columns, column: i % columns };
        return Err(ContentError::Infinite { place, value: heights[i] });
    }
    let undefined = heights.iter().filter(|h| h.is_nan()).count();
    // The lower and the higher one of NaN and a number are the number.
    let (low, high) =
        heights.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (h.min(low), h.max(high)));
    let range = (undefined < heights.len()).then_some([low, high]);
    Ok((undefined, range))
}

/// The extents along x and y: what the caller says, checked against the file, else what the file says. The
/// cells of a profile are squares.
fn extents(
    file: [Option<Extent>; 2],
    profile: bool,
    count: [usize; 2],
    declared: &ReadOptions,
) -> Result<Option<Sourced<[Extent; 2]>>, ContentError> {
    if let Some(given) = extent::given(declared, count)? {
        for axis in 0..2 {
            if let Some(file) = file[axis] {
                extent::check_axis(axis, file, given[axis], count[axis])?;
            }
        }
        return Ok(Some(Sourced { value: given, origin: Origin::Caller }));
    }
    let value = match file {
        [Some(x), Some(y)] => [x, y],
        [Some(x), None] if profile => [x, Extent::Cell(x.cell(count[0])?)],
        _ => return Ok(None),
    };
    Ok(Some(Sourced { value, origin: Origin::File }))
}

/// Multiplies numbers without a unit by the height of one of them; they are metres then.
fn scaled(
    scale: Quantity,
    unit: Option<&Sourced<Unit>>,
    heights: &mut [f64],
) -> Result<Sourced<Unit>, ContentError> {
    let what = "height_scale";
    let metres = scale.expect(Dimension::LENGTH).map_err(ContentError::quantity(what))?;
    if let Some(unit) = unit {
        let (first, second) = (format!("{} {}", unit.value, unit.origin), format!("height_scale = {scale}"));
        return Err(ContentError::Contradiction { what: "unit of the heights", first, second });
    }
    if metres <= 0.0 {
        return Err(ContentError::out_of_range(what, metres, "a length > 0"));
    }
    for h in heights {
        *h *= metres;
    }
    let value = "m".parse().map_err(ContentError::quantity(what))?;
    Ok(Sourced { value, origin: Origin::Caller })
}

/// Notes on the lowest and the highest value where it is farther from the next one than twice the range of
/// all others, as is an undeclared mark of undefined points.
fn lone_extremes(heights: &[f64]) -> Vec<String> {
    const ALONE: f64 = 2.0;
    // The lowest value and the next one, the highest and the one before.
    let low = lowest_two(heights.iter().copied());
    let high = lowest_two(heights.iter().map(|h| -h)).map(|h| -h);
    let note = |value: f64, next: f64, [from, to]: [f64; 2]| {
        let alone = to > from && (value - next).abs() > ALONE * (to - from);
        let count = heights.iter().filter(|h| (**h - value).abs() <= 0.0).count();
        alone.then(|| {
            let (from, to) = (five(from, ""), five(to, ""));
            // All its digits: as the note has it, `missing` is to find the same number.
            let plain = (1e-3..1e16).contains(&value.abs());
            let mark = if plain { value.to_string() } else { format!("{value:e}") };
            let points = if count == 1 { "1 point".to_owned() } else { format!("{count} points") };
            format!(
                "{points} of {}, all others are from {from} to {to}: a mark of undefined points? missing = {mark} makes them so",
                number(value)
            )
        })
    };
    let found = [note(low[0], low[1], [low[1], high[0]]), note(high[0], high[1], [low[0], high[1]])];
    found.into_iter().flatten().collect()
}

/// The lowest value and the next one that differs from it.
fn lowest_two(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.filter(|v| !v.is_nan()).fold([f64::INFINITY; 2], |[first, next], v| {
        if v < first {
            [v, first]
        } else if v > first {
            [first, next.min(v)]
        } else {
            [first, next]
        }
    })
}

/// Rms height of the defined points about their mean: about the middle of the range and in units of half of
/// it, so that nothing overflows; summed row by row, so that rounding grows with the side only.
fn rms(heights: &[f64], columns: usize, undefined: usize, [low, high]: [f64; 2]) -> f64 {
    let (middle, unit) = (0.5 * low + 0.5 * high, 0.5 * high - 0.5 * low);
    if unit <= 0.0 {
        return 0.0;
    }
    let present = (heights.len() - undefined) as f64;
    let mean_of = |f: &dyn Fn(f64) -> f64| {
        let row =
            |row: &[f64]| row.iter().filter(|h| !h.is_nan()).map(|h| f((h - middle) / unit)).sum::<f64>();
        heights.chunks_exact(columns).map(row).sum::<f64>() / present
    };
    let mean = mean_of(&|h| h);
    unit * mean_of(&|h| (h - mean).powi(2)).sqrt()
}
