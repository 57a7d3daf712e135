//! From a scan to a map: crop, trend, undefined points, resampling, units.

mod defects;
mod fill;
mod form;
mod normal_equations;
mod resample;
mod scan_lines;
mod tip;
mod trend;

pub use fill::filled;
pub use scan_lines::AlignLines;
pub use trend::Detrend;

use crate::error::{ContentError, Error, Place, Result};
use crate::keyword::{KeywordError, keywords};
use crate::quantity::{Dimension, Quantity, Unit};
use crate::scan::Scan;
use contact_model::units::five;
use contact_model::{Cells, HeightMap, Size};
use std::str::FromStr;
use surface_gen::{hann_window, rms_height};
use trend::FittedTrend;

/// Steps that turn a scan into a map, in this order. A step is done only if it is named.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Preprocessing {
    /// The part of the scan that is used.
    pub crop: Option<Crop>,
    /// How scan lines, the rows, are shifted to a common height.
    pub align_lines: Option<AlignLines>,
    /// Scars become undefined: runs of at least 16 points along x, at most four rows tall, that are higher or
    /// lower than the row before and the row after them by more than this number of robust standard
    /// deviations of the differences between neighbouring rows. A ridge or a groove of the surface that is as
    /// narrow and lies along x is removed too.
    pub scars: Option<f64>,
    /// Heights farther from the median of their neighbours than this number of robust standard deviations of
    /// all such distances become undefined.
    pub outliers: Option<f64>,
    /// Radius of the tip that measured the heights. The distance from which on they are reliable is reported;
    /// the map does not change.
    pub tip_radius: Option<Quantity>,
    /// Treatment of undefined points. Without it and without [`Preprocessing::fill`] they are an error.
    pub undefined: Option<Undefined>,
    /// Heights for undefined points; it contradicts [`Preprocessing::undefined`].
    pub fill: Option<Fill>,
    /// Trend that is subtracted; it is fitted to the points that are defined in the file, after the crop.
    pub detrend: Detrend,
    /// Cut-off wavelength of a Gaussian low-pass filter across the scan lines, along y (ISO 16610-21: half of
    /// a wave of this wavelength is transmitted), from four cells to the side of the map. At edges and
    /// undefined points the weights are those of the defined points, their sum one; undefined points that are
    /// kept stay undefined. It removes noise from line to line, and waves of the surface of the same length
    /// with it.
    pub filter_across: Option<Quantity>,
    /// Number of columns after averaging over larger cells; that of the map where only `rows` is given.
    pub cells: Option<usize>,
    /// Number of rows after averaging over larger cells; reduced in proportion to the columns where only
    /// `cells` is given.
    pub rows: Option<usize>,
    /// Whether x or y is reversed.
    pub mirror: Option<Mirror>,
    /// Number of quarter turns; each turns x to y and y to -x.
    pub quarter_turns: u8,
    /// Window by which the deviations from the mean height are multiplied.
    pub window: Option<Window>,
}

keywords! {
    /// The axis that is reversed.
    Mirror: "mirror";
    /// x: the last column becomes the first, as a body is seen that is laid on its face.
    X = "x",
    /// y: the last row becomes the first.
    Y = "y",
}

impl Mirror {
    /// The map with this axis reversed.
    pub fn of(self, map: &HeightMap) -> HeightMap {
        match self {
            Self::X => map.mirrored(),
            Self::Y => map.transposed().mirrored().transposed(),
        }
    }
}

keywords! {
    /// A taper towards the edges.
    #[non_exhaustive]
    Window: "window";
    /// `sin^2(pi x/Lx) sin^2(pi y/Ly)` at the middles of the cells, divided by its rms, 3/8: a map without a
    /// step at its edges, for periodic boundaries. A homogeneous surface keeps its spectrum, and with it rms
    /// height and slope; in the middle of the map it is 8/3 as rough as before, at the edges smooth. It is
    /// meant for theories and artificial twins; a solver finds another contact than without it.
    Hann = "hann",
}

/// A map, with a record of its preprocessing.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Preprocessed {
    /// The map.
    pub map: HeightMap,
    /// One line for each step, with what it found; empty where nothing was done.
    pub steps: Vec<String>,
    /// Lateral distance from which on the heights are reliable, given the tip, in the unit of the map's
    /// sides. It is infinite where no distance is reliable, and `None` where all are or no tip is given.
    pub reliable_from: Option<f64>,
    /// Rms height before and after a window; `None` without one.
    pub tapered: Option<[f64; 2]>,
    /// The same map with the points undefined that were filled; `None` where none was. Statistics need it: filled
    /// points lack short waves. A larger cell of which less than half was measured counts as filled.
    pub holes: Option<HeightMap>,
}

/// A part of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crop {
    /// The largest square in the middle, as nearly square as oblong cells allow; an odd cell goes to the
    /// lower and the right margin.
    Centre,
    /// The largest rectangle without undefined points, by its number of cells.
    Defined,
    /// The rectangle of `rows` x `columns` cells whose first cell is (row, column), counted from 0.
    Window {
        /// First row.
        row: usize,
        /// First column.
        column: usize,
        /// Number of rows.
        rows: usize,
        /// Number of columns.
        columns: usize,
    },
}

impl FromStr for Fill {
    type Err = KeywordError;

    /// Reads `neighbours`, `plane` or a height such as `-2 um`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        match text {
            "neighbours" => Ok(Self::Neighbours),
            "plane" => Ok(Self::Plane),
            other => other.parse().map(Self::Value).map_err(|quantity| {
                let error =
                    KeywordError::new("fill", other, "neighbours, plane or a height such as \"-2 um\"");
                KeywordError { quantity: Some(quantity), ..error }
            }),
        }
    }
}

impl FromStr for Crop {
    type Err = KeywordError;

    /// Reads `centre`, `defined`, or row, column, rows and columns as in `10,20,256,512`; with three numbers
    /// there are as many columns as rows.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        match text {
            "centre" => return Ok(Self::Centre),
            "defined" => return Ok(Self::Defined),
            _ => {}
        }
        let numbers: Result<Vec<usize>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[row, column, cells]) => Ok(Self::Window { row, column, rows: cells, columns: cells }),
            Ok(&[row, column, rows, columns]) => Ok(Self::Window { row, column, rows, columns }),
            _ => Err(KeywordError::new(
                "crop",
                text,
                "centre, defined, or row, column, rows and columns such as \"10,20,256,512\"",
            )),
        }
    }
}

keywords! {
    /// Treatment of undefined points that are not filled.
    #[non_exhaustive]
    Undefined: "undefined", " (fill gives undefined points a height)";
    /// They stay undefined and cannot touch ([`HeightMap::with_undefined`]).
    NoContact = "no_contact",
}

/// Heights for undefined points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fill {
    /// The discrete harmonic function with the measured heights around the patch as its boundary values: each
    /// filled height is the mean of its neighbours (four inside, fewer at an edge), filled ones included,
    /// with the weights dy/dx along x and dx/dy along y. It is unique, stays between the lowest and the
    /// highest of the heights around the patch, and continues a plane as a plane.
    Neighbours,
    /// The least-squares plane through all measured heights.
    Plane,
    /// One height, of the dimension of the scan's unit.
    Value(Quantity),
}

impl Scan {
    /// The map of the scan after these steps: crop, align scan lines, remove scars and outliers, fill,
    /// subtract the trend, filter across the lines, average over larger cells, mirror, turn, taper. It is in
    /// metres where the scan has units, else in its own numbers.
    ///
    /// The trend is fitted to measured heights only and subtracted from all. Where undefined points are kept,
    /// the mean over a larger cell is that of its defined part, and the cell is undefined where this is less
    /// than half of it. Cost O(N) for N points, with [`Fill::Neighbours`] times the width of the undefined
    /// patches.
    ///
    /// # Errors
    /// [`Error::Content`]: undefined points that are neither filled nor kept, or both; sides or unit of the
    /// heights unknown (one of them with a unit and the other without), cells whose sides differ by more
    /// than 1e4, a crop that leaves the map, finer cells, heights that overflow, a trend that the heights do
    /// not determine.
    ///
    /// ```
    /// use surface_io::{ReadOptions, Detrend, Scan, Preprocessing};
    /// let declared = ReadOptions { cell: Some("1 um".parse()?), unit: Some("nm".parse()?), ..ReadOptions::default() };
    /// let scan = Scan::from_bytes("a.txt", b"1 2\n3 6\n", &declared)?;
    /// let map = scan.map(&Preprocessing { detrend: Detrend::Mean, ..Preprocessing::default() })?;
    /// assert_eq!((map.columns(), map.length()), (2, 2e-6));
    /// assert_eq!(map.heights()[0], -2e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map(&self, preprocessing: &Preprocessing) -> Result<HeightMap> {
        self.preprocessed(preprocessing).map(|preprocessed| preprocessed.map)
    }

    /// The map of [`Scan::map`] with a line on each step, for records.
    ///
    /// # Errors
    /// As [`Scan::map`].
    pub fn preprocessed(&self, preprocessing: &Preprocessing) -> Result<Preprocessed> {
        self.by_steps(self.heights().to_vec(), preprocessing).map_err(Error::content(self.path()))
    }

    /// [`Scan::preprocessed`] for a scan that is no longer needed: its heights become those of the map, so
    /// that memory holds them once.
    ///
    /// # Errors
    /// As [`Scan::map`].
    pub fn into_preprocessed(mut self, preprocessing: &Preprocessing) -> Result<Preprocessed> {
        let heights = self.take_heights();
        self.by_steps(heights, preprocessing).map_err(Error::content(self.path()))
    }

    /// The steps on the heights of the whole scan.
    fn by_steps(
        &self,
        heights: Vec<f64>,
        preprocessing: &Preprocessing,
    ) -> Result<Preprocessed, ContentError> {
        self.check(preprocessing)?;
        let (size, cell) = self.sides()?;
        // Cells that no map may have are refused before anything is fitted to them.
        Cells::from(1).validate(Size::from(cell)).map_err(ContentError::Map)?;
        let mut steps = Vec::new();
        let (cells, mut heights) = self.part(heights, preprocessing.crop, cell, &mut steps)?;
        self.convert_to_metres(&mut heights)?;
        repair(preprocessing, cells, &mut heights, (&mut steps, self.unit()))?;
        let undefined = count_undefined(&heights)?;
        let mut reliable_from = None;
        if let Some(radius) = preprocessing.tip_radius {
            let (step, distance) = self.tip(radius, cells, cell, &heights)?;
            steps.push(step);
            reliable_from = distance;
        }
        // Before undefined points are filled: the trend is that of the measured heights.
        let trend = FittedTrend::new(preprocessing.detrend, cells, cell, &heights)?;
        let measured = (undefined > 0 && preprocessing.fill.is_some())
            .then(|| (cells, heights.iter().map(|h| if h.is_nan() { f64::NAN } else { 0.0 }).collect()));
        if undefined > 0 {
            steps.extend(self.treat_undefined(preprocessing, undefined, cells, cell, &mut heights)?);
        }
        if let Some(trend) = trend {
            trend.subtract(&mut heights);
            steps.push(trend.words(preprocessing.detrend));
        }
        if let Some(cut_off) = preprocessing.filter_across {
            steps.push(self.filter(cut_off, cells, cell[1], &mut heights)?);
        }
        let size = self.size_of_part(size, cells, cell);
        let (cells, heights) = averaged(preprocessing, cells, heights, &mut steps)?;
        let kept = undefined > 0 && preprocessing.fill.is_none();
        let map = if kept {
            HeightMap::with_undefined(cells, size, heights)
        } else {
            HeightMap::new(cells, size, heights)
        };
        let map = turned(map.map_err(ContentError::Map)?, preprocessing, &mut steps);
        let (map, tapered) = windowed(map, preprocessing, (&mut steps, self.unit()))?;
        let holes = measured.and_then(|(cells, marks)| without_filled(&map, preprocessing, cells, marks));
        Ok(Preprocessed { map, steps, reliable_from, tapered, holes })
    }

    /// Refuses values that are no heights, and steps that contradict each other or the shape of the scan.
    fn check(&self, preprocessing: &Preprocessing) -> Result<(), ContentError> {
        if let (Some(_), Some(Undefined::NoContact)) = (preprocessing.fill, preprocessing.undefined) {
            let second = "undefined = \"no_contact\" too";
            return Err(ContentError::contradiction("undefined points", "fill is given", second));
        }
        if let Some(unit) = &self.metadata().no_heights {
            let name = self.metadata().name.as_deref().unwrap_or_default();
            let what = format!("{} {name} {unit}", self.metadata().number).trim().to_owned();
            return Err(ContentError::no_heights(what, &self.metadata().notes));
        }
        if self.metadata().profile {
            of_profile(preprocessing)?;
        }
        Ok(())
    }

    /// Converts heights to metres where the scan has a unit.
    fn convert_to_metres(&self, heights: &mut [f64]) -> Result<(), ContentError> {
        if let Some(unit) = &self.metadata().unit {
            for h in heights.iter_mut() {
                *h = unit.value.to_si(*h);
            }
        }
        check_overflow(heights)
    }

    /// Fills the undefined points or keeps them, as requested; returns a line for records where it fills them.
    ///
    /// # Errors
    /// [`ContentError::Undefined`] where neither is requested.
    fn treat_undefined(
        &self,
        preprocessing: &Preprocessing,
        undefined: usize,
        cells: Cells,
        cell: [f64; 2],
        heights: &mut [f64],
    ) -> Result<Option<String>, ContentError> {
        match (preprocessing.fill, preprocessing.undefined) {
            (Some(fill), _) => {
                self.fill(fill, cells, cell, heights)?;
                Ok(Some(format!("{undefined} undefined points filled")))
            }
            (None, Some(Undefined::NoContact)) => Ok(None),
            (None, None) => {
                let first = heights.iter().position(|h| h.is_nan()).unwrap_or(0);
                let first = Place::Cell { row: first / cells.columns, column: first % cells.columns };
                Err(ContentError::Undefined { undefined, points: heights.len(), first })
            }
        }
    }

    /// Sides of the map after a crop; without one they are those that the file or the caller states, to the
    /// last digit.
    fn size_of_part(&self, whole: [f64; 2], cells: Cells, cell: [f64; 2]) -> [f64; 2] {
        if cells == (Cells { columns: self.metadata().columns, rows: self.metadata().rows }) {
            return whole;
        }
        [cell[0] * cells.columns as f64, cell[1] * cells.rows as f64]
    }

    /// From which distance on a tip lets the surface be seen.
    fn tip(
        &self,
        radius: Quantity,
        cells: Cells,
        cell: [f64; 2],
        heights: &[f64],
    ) -> Result<(String, Option<f64>), ContentError> {
        let what = "tip_radius";
        let value = self.length(what, radius)?;
        if value <= 0.0 {
            return Err(ContentError::OutOfRange { what, value, expected: "a length > 0" });
        }
        let found = tip::reliable_from(cells, cell, heights, value);
        let step = match found {
            Some(distance) if distance > 0.0 => {
                format!(
                    "with a tip of radius {radius}, heights are reliable from {} on",
                    five(distance, self.unit())
                )
            }
            Some(_) => format!("with a tip of radius {radius}, heights are reliable at all distances"),
            None => format!("with a tip of radius {radius}, heights are reliable at no distance"),
        };
        Ok((step, Some(found.unwrap_or(f64::INFINITY)).filter(|distance| *distance > 0.0)))
    }

    /// Filters across the lines; a line for records.
    fn filter(
        &self,
        cut_off: Quantity,
        cells: Cells,
        dy: f64,
        heights: &mut [f64],
    ) -> Result<String, ContentError> {
        let value = self.length("filter_across", cut_off)?;
        let (least, side) = (scan_lines::LEAST_CUT_OFF * dy, cells.rows as f64 * dy);
        // Decimals of lengths are rounded.
        if !(value >= least * (1.0 - 1e-9) && value <= side * (1.0 + 1e-9)) {
            return Err(ContentError::CutOff { value, least, side });
        }
        let rms = |heights: &[f64]| {
            rms_height(&heights.iter().copied().filter(|h| !h.is_nan()).collect::<Vec<_>>())
        };
        let before = rms(heights);
        scan_lines::filter_across(cells, value / dy, heights);
        let after = rms(heights);
        Ok(format!(
            "filtered across the scan lines, cut-off {cut_off}: rms height {} before, {} after",
            five(before, self.unit()),
            five(after, self.unit())
        ))
    }

    /// The value of a length in the unit of the map's sides.
    fn length(&self, what: &'static str, length: Quantity) -> Result<f64, ContentError> {
        let unit = self.metadata().unit.as_ref().map_or(Dimension::NONE, |u| u.value.dimension());
        length.expect(unit).map_err(ContentError::quantity(what))
    }

    /// The unit of the map: metres, or none where the heights have none.
    fn unit(&self) -> &'static str {
        if self.metadata().unit.is_some() { "m" } else { "" }
    }

    /// Sides of the map and of a cell in metres, or in the numbers of the file.
    fn sides(&self) -> Result<([f64; 2], [f64; 2]), ContentError> {
        let metadata = self.metadata();
        let unit = metadata.unit.as_ref().map(|u| u.value.dimension());
        let (Some(size), Some(cell)) = (metadata.size, &metadata.cell) else {
            let remedy = "say size, such as 2 mm x 1 mm, or cell, such as 0.5 um; numbers where the heights have no unit";
            return Err(ContentError::unspecified("the size of the map", metadata.notes.clone(), remedy));
        };
        let dx = cell.value[0];
        match unit {
            None if dx.dimension() == Dimension::LENGTH => Err(ContentError::no_unit(&metadata.notes)),
            unit if dx.dimension() == unit.unwrap_or(Dimension::NONE) => {
                Ok((size.map(Quantity::value), cell.value.map(Quantity::value)))
            }
            _ => {
                let of_heights = metadata.unit.as_ref().map_or_else(Unit::none, |unit| unit.value.clone());
                let (first, second) =
                    (format!("the side of a cell is {dx}"), format!("the heights have {of_heights}"));
                Err(ContentError::contradiction("units", first, second))
            }
        }
    }

    /// The heights that are left by a crop.
    fn part(
        &self,
        heights: Vec<f64>,
        crop: Option<Crop>,
        cell: [f64; 2],
        steps: &mut Vec<String>,
    ) -> Result<(Cells, Vec<f64>), ContentError> {
        let (all_rows, all_columns) = (self.metadata().rows, self.metadata().columns);
        let (row, column, rows, columns) = match crop {
            None => {
                let cells = Cells { columns: all_columns, rows: all_rows };
                return Ok((cells, heights));
            }
            Some(Crop::Centre) => {
                let side = (all_columns as f64 * cell[0]).min(all_rows as f64 * cell[1]);
                let across = |cell: f64, all: usize| ((side / cell).round() as usize).clamp(1, all);
                let (rows, columns) = (across(cell[1], all_rows), across(cell[0], all_columns));
                ((all_rows - rows) / 2, (all_columns - columns) / 2, rows, columns)
            }
            Some(Crop::Defined) => {
                let cells = Cells { columns: all_columns, rows: all_rows };
                let (rows, columns) = defects::largest_defined(cells, &heights);
                if rows.is_empty() {
                    return Err(ContentError::AllUndefined { points: heights.len() });
                }
                (rows.start, columns.start, rows.len(), columns.len())
            }
            Some(Crop::Window { row, column, rows, columns }) => (row, column, rows, columns),
        };
        let inside = |from: usize, count: usize, all: usize| {
            count > 0 && from.checked_add(count).is_some_and(|end| end <= all)
        };
        if !inside(row, rows, all_rows) || !inside(column, columns, all_columns) {
            let (cells, shape) = ([rows, columns], [all_rows, all_columns]);
            return Err(ContentError::Crop { from: [row, column], cells, shape });
        }
        steps.push(format!("cropped to {columns} x {rows} points from row {row}, column {column} (from 0)"));
        let part = |row: &[f64]| row[column..column + columns].to_vec();
        let rows_taken = heights.chunks_exact(all_columns).skip(row).take(rows);
        Ok((Cells { columns, rows }, rows_taken.flat_map(part).collect()))
    }

    fn fill(
        &self,
        fill: Fill,
        cells: Cells,
        cell: [f64; 2],
        heights: &mut [f64],
    ) -> Result<(), ContentError> {
        match fill {
            Fill::Neighbours => fill::harmonic(cells, cell[1] / cell[0], heights),
            Fill::Plane => {
                if let Some(plane) = Detrend::Plane.fit(cells, heights)? {
                    plane.fill(heights);
                }
            }
            Fill::Value(value) => {
                let value = self.length("fill", value)?;
                heights.iter_mut().filter(|h| h.is_nan()).for_each(|h| *h = value);
            }
        }
        Ok(())
    }
}

/// Errors where a step made a height infinite.
fn check_overflow(heights: &[f64]) -> Result<(), ContentError> {
    match heights.iter().copied().find(|h| h.is_infinite()) {
        Some(value) => Err(ContentError::Overflow { value }),
        None => Ok(()),
    }
}

/// Counts the undefined points; an error where there are no others.
fn count_undefined(heights: &[f64]) -> Result<usize, ContentError> {
    let undefined = heights.iter().filter(|h| h.is_nan()).count();
    if undefined == heights.len() {
        return Err(ContentError::AllUndefined { points: heights.len() });
    }
    Ok(undefined)
}

/// Scan lines aligned, then scars and outliers made undefined.
fn repair(
    preprocessing: &Preprocessing,
    cells: Cells,
    heights: &mut [f64],
    (steps, unit): (&mut Vec<String>, &str),
) -> Result<(), ContentError> {
    if let Some(align) = preprocessing.align_lines {
        steps.push(align.apply(cells, heights, unit).map_err(|value| ContentError::Overflow { value })?);
        check_overflow(heights)?;
    }
    let positive = |what, value: f64, expected| {
        let valid = value > 0.0 && value.is_finite();
        if valid { Ok(value) } else { Err(ContentError::OutOfRange { what, value, expected }) }
    };
    if let Some(times) = preprocessing.scars {
        let times = positive("scars", times, "a number > 0 of robust standard deviations, such as 3")?;
        steps.push(scan_lines::remove_scars(cells, times, heights, unit));
    }
    if let Some(times) = preprocessing.outliers {
        let times = positive("outliers", times, "a number > 0 of robust standard deviations, such as 8")?;
        let found = defects::remove_outliers(cells, times, heights);
        steps.push(format!("{found} outliers beyond {times} robust standard deviations made undefined"));
    }
    Ok(())
}

/// Refuses steps that have no meaning for a profile.
fn of_profile(preprocessing: &Preprocessing) -> Result<(), ContentError> {
    let reason = "a profile has one row";
    let refused = |what| Err(ContentError::Useless { what, reason });
    match preprocessing {
        Preprocessing { crop: Some(Crop::Centre), .. } => refused("crop = \"centre\""),
        Preprocessing { align_lines: Some(_), .. } => refused("align_lines"),
        Preprocessing { scars: Some(_), .. } => refused("scars"),
        Preprocessing { filter_across: Some(_), .. } => refused("filter_across"),
        Preprocessing { quarter_turns: 1 | 3, .. } => refused("a rotation by 90 degrees"),
        Preprocessing { detrend: Detrend::Sphere, .. } => refused("detrend = \"sphere\""),
        Preprocessing { detrend: Detrend::Cylinder, .. } => refused("detrend = \"cylinder\""),
        _ => Ok(()),
    }
}

/// The map mirrored and turned.
fn turned(mut map: HeightMap, preprocessing: &Preprocessing, steps: &mut Vec<String>) -> HeightMap {
    if let Some(mirror) = preprocessing.mirror {
        map = mirror.of(&map);
        steps.push(format!("{} reversed", mirror.word()));
    }
    let turns = preprocessing.quarter_turns % 4;
    if turns > 0 {
        map = (0..turns).fold(map, |map, _| map.rotated());
        steps.push(format!("turned by {} degrees", 90 * u32::from(turns)));
    }
    map
}

/// The map with the points undefined that were filled; `marks` are NaN there, on the cells before they were averaged.
/// `None` where averaging has left none.
fn without_filled(
    map: &HeightMap,
    preprocessing: &Preprocessing,
    cells: Cells,
    marks: Vec<f64>,
) -> Option<HeightMap> {
    // The same steps move the marks to where the heights are. They are no steps of their own for records.
    let mut untold = Vec::new();
    let (cells, marks) = averaged(preprocessing, cells, marks, &mut untold).ok()?;
    let square = [cells.columns as f64, cells.rows as f64];
    let marks = HeightMap::with_undefined(cells, square, marks).ok()?;
    let marks = turned(marks, preprocessing, &mut untold);
    let height = |(h, mark): (&f64, &f64)| if mark.is_finite() { *h } else { f64::NAN };
    let heights = map.heights().iter().zip(marks.heights()).map(height).collect();
    HeightMap::with_undefined(map.cells(), map.size(), heights).ok().filter(|holes| holes.undefined() > 0)
}

/// The map under its window, with the rms heights before and after.
fn windowed(
    map: HeightMap,
    preprocessing: &Preprocessing,
    (steps, unit): (&mut Vec<String>, &str),
) -> Result<(HeightMap, Option<[f64; 2]>), ContentError> {
    let tapered = match preprocessing.window {
        None => return Ok((map, None)),
        Some(Window::Hann) => hann(&map).map_err(ContentError::Map)?,
    };
    let [before, after] = [&map, &tapered].map(|map| rms_height(map.heights()));
    steps.push(format!(
        "deviations from the mean tapered by Hann's window over its rms: rms height {} before, {} after",
        five(before, unit),
        five(after, unit)
    ));
    Ok((tapered, Some([before, after])))
}

/// Deviations from the mean height tapered to the edges, over the rms of the taper at the defined points.
fn hann(map: &HeightMap) -> contact_model::Result<HeightMap> {
    let (across, down) = (hann_window(map.columns()), hann_window(map.rows()));
    let weight = |i: usize| across[i % map.columns()] * down[i / map.columns()];
    let defined = map.heights().iter().enumerate().filter(|(_, h)| h.is_finite());
    let (count, squares) = defined.fold((0.0, 0.0), |(n, sum), (i, _)| (n + 1.0, sum + weight(i).powi(2)));
    let scale = (squares / count).sqrt().recip();
    let mean = map.defined().map(|h| h / count).sum::<f64>();
    let tapered = |(i, &h): (usize, &f64)| {
        if h.is_finite() { mean + scale * weight(i) * (h - mean) } else { f64::NAN }
    };
    let heights = map.heights().iter().enumerate().map(tapered).collect();
    HeightMap::with_undefined(map.cells(), map.size(), heights)
}

/// Heights averaged over the larger cells that are requested, and the numbers of these.
fn averaged(
    preprocessing: &Preprocessing,
    cells: Cells,
    heights: Vec<f64>,
    steps: &mut Vec<String>,
) -> Result<(Cells, Vec<f64>), ContentError> {
    let coarse = coarse(preprocessing, cells)?;
    let heights = resample::coarsen(heights, cells, coarse);
    if coarse != cells {
        steps.push(format!("averaged over {} x {} cells", coarse.columns, coarse.rows));
    }
    Ok((coarse, heights))
}

/// Columns and rows after averaging.
fn coarse(preprocessing: &Preprocessing, cells: Cells) -> Result<Cells, ContentError> {
    let Cells { columns, rows } = cells;
    let coarse = match (preprocessing.cells, preprocessing.rows) {
        (None, None) => return Ok(cells),
        (None, Some(rows)) => Cells { columns, rows },
        (Some(columns), Some(rows)) => Cells { columns, rows },
        (Some(fewer), None) => {
            // Cells keep their shape as nearly as whole numbers let them.
            let share = fewer.min(columns) as f64 / columns as f64;
            Cells { columns: fewer, rows: ((rows as f64 * share).round() as usize).max(1) }
        }
    };
    for (what, asked, found) in [("columns", coarse.columns, columns), ("rows", coarse.rows, rows)] {
        if asked == 0 || asked > found {
            return Err(ContentError::Resample { what, cells: asked, found });
        }
    }
    Ok(coarse)
}

#[cfg(test)]
mod tests;
