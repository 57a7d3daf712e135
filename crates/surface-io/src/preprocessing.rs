//! From a scan to a map: crop, trend, undefined points, resampling, units.

mod fill;
mod resample;
mod trend;

pub use trend::Detrend;

use crate::error::{ContentError, Error, Place, Result};
use crate::quantity::{Dimension, Quantity};
use crate::scan::Scan;
use contact_model::{Cells, HeightMap, Size};

/// What is done to a scan, in this order; nothing unless named.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Preprocessing {
    /// Which part is taken.
    pub crop: Option<Crop>,
    /// What becomes of undefined points. Without it and without [`Preprocessing::fill`] they are an error.
    pub undefined: Option<Undefined>,
    /// Which heights undefined points get; it contradicts [`Preprocessing::undefined`].
    pub fill: Option<Fill>,
    /// What is subtracted: fitted to the points that are defined in the file, after the crop.
    pub detrend: Detrend,
    /// Columns after averaging over larger cells; as many as the map has where only `rows` is given.
    pub cells: Option<usize>,
    /// Rows after averaging over larger cells; as much fewer as the columns where only `cells` is given.
    pub rows: Option<usize>,
}

/// A part of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crop {
    /// The largest square in the middle, as nearly as oblong cells make one; where the margins are odd, the
    /// upper and the left one are the smaller.
    Centre,
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

/// What becomes of undefined points that are not filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Undefined {
    /// They stay undefined and cannot touch ([`HeightMap::with_undefined`]).
    NoContact,
}

/// Heights for undefined points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fill {
    /// The discrete harmonic function with the measured rim: each filled height is the mean of those of its
    /// neighbours (four inside, fewer at an edge), filled ones included, with the weights dy/dx along x and
    /// dx/dy along y. Unique, between the lowest and the highest height of the rim, and a plane stays a plane
    /// inside.
    Neighbours,
    /// The least-squares plane through all measured heights.
    Plane,
    /// One height, of the dimension of the scan's unit.
    Value(Quantity),
}

impl Scan {
    /// A map: crop, fill, subtract the trend, average over larger cells; in metres where the scan has units,
    /// else in its own numbers.
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
        self.preprocessed(preprocessing).map_err(Error::content(self.path()))
    }

    fn preprocessed(&self, preprocessing: &Preprocessing) -> Result<HeightMap, ContentError> {
        if let (Some(_), Some(Undefined::NoContact)) = (preprocessing.fill, preprocessing.undefined) {
            let (first, second) = ("fill is given".into(), "undefined = \"no_contact\" too".into());
            return Err(ContentError::Contradiction { what: "undefined points", first, second });
        }
        if let Some(unit) = &self.metadata().no_heights {
            let name = self.metadata().name.as_deref().unwrap_or_default();
            let what = format!("{} {name} {unit}", self.metadata().number).trim().to_owned();
            return Err(ContentError::NoHeights { what });
        }
        let (size, cell) = self.sides()?;
        // Cells that no map may have are refused before anything is fitted to them.
        Cells::from(1).validate(Size::from(cell)).map_err(ContentError::Map)?;
        let (cells, mut heights) = self.part(preprocessing.crop, cell)?;
        let undefined = heights.iter().filter(|h| h.is_nan()).count();
        if undefined == heights.len() {
            return Err(ContentError::AllUndefined { points: heights.len() });
        }
        if let Some(unit) = &self.metadata().unit {
            for h in &mut heights {
                *h = unit.value.to_si(*h);
            }
        }
        if let Some(value) = heights.iter().copied().find(|h| h.is_infinite()) {
            return Err(ContentError::Overflow { value });
        }
        let trend = preprocessing.detrend.fit(cells, &heights)?;
        if undefined > 0 {
            let first = heights.iter().position(|h| h.is_nan()).unwrap_or(0);
            let first = Place::Cell { row: first / cells.columns, column: first % cells.columns };
            match (preprocessing.fill, preprocessing.undefined) {
                (Some(fill), _) => self.fill(fill, cells, cell, &mut heights)?,
                (None, Some(Undefined::NoContact)) => {}
                (None, None) => {
                    return Err(ContentError::Undefined { undefined, points: heights.len(), first });
                }
            }
        }
        if let Some(trend) = trend {
            trend.subtract(cells, &mut heights);
        }
        let whole = cells == Cells { columns: self.metadata().columns, rows: self.metadata().rows };
        let part = [cell[0] * cells.columns as f64, cell[1] * cells.rows as f64];
        let size = if whole { size } else { part };
        let coarse = coarse(preprocessing, cells)?;
        let heights = resample::coarsen(heights, cells, coarse);
        let kept = undefined > 0 && preprocessing.fill.is_none();
        let map = if kept {
            HeightMap::with_undefined(coarse, size, heights)
        } else {
            HeightMap::new(coarse, size, heights)
        };
        map.map_err(ContentError::Map)
    }

    /// Sides of the map and of a cell in metres, or in the numbers of the file.
    fn sides(&self) -> Result<([f64; 2], [f64; 2]), ContentError> {
        let metadata = self.metadata();
        let unit = metadata.unit.as_ref().map(|u| u.value.dimension());
        let (Some(size), Some(cell)) = (metadata.size, &metadata.cell) else {
            let remedy = "say size = [\"1 mm\", \"2 mm\"] or cell = \"0.5 um\", or numbers where the heights have no unit";
            return Err(ContentError::Unspecified { what: "the size of the map", remedy });
        };
        let dx = cell.value[0];
        match unit {
            None if dx.dimension() == Dimension::LENGTH => Err(ContentError::Unspecified {
                what: "the unit of the heights",
                remedy: "say unit = \"nm\" or another unit of length",
            }),
            unit if dx.dimension() == unit.unwrap_or(Dimension::NONE) => {
                Ok((size.map(Quantity::value), cell.value.map(Quantity::value)))
            }
            _ => Err(ContentError::Contradiction {
                what: "units",
                first: format!("the side of a cell is {dx}"),
                second: format!(
                    "the heights have {}",
                    metadata.unit.as_ref().map_or_else(|| "no unit".into(), |u| u.value.to_string())
                ),
            }),
        }
    }

    /// The heights that are left by a crop.
    fn part(&self, crop: Option<Crop>, cell: [f64; 2]) -> Result<(Cells, Vec<f64>), ContentError> {
        let (all_rows, all_columns) = (self.metadata().rows, self.metadata().columns);
        let (row, column, rows, columns) = match crop {
            None => {
                let cells = Cells { columns: all_columns, rows: all_rows };
                return Ok((cells, self.heights().to_vec()));
            }
            Some(Crop::Centre) => {
                let side = (all_columns as f64 * cell[0]).min(all_rows as f64 * cell[1]);
                let across = |cell: f64, all: usize| ((side / cell).round() as usize).clamp(1, all);
                let (rows, columns) = (across(cell[1], all_rows), across(cell[0], all_columns));
                ((all_rows - rows) / 2, (all_columns - columns) / 2, rows, columns)
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
        let part = |row: &[f64]| row[column..column + columns].to_vec();
        let rows_taken = self.heights().chunks_exact(all_columns).skip(row).take(rows);
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
                    plane.fill(cells, heights);
                }
            }
            Fill::Value(value) => {
                let unit = self.metadata().unit.as_ref().map_or(Dimension::NONE, |u| u.value.dimension());
                let value =
                    value.expect(unit).map_err(|source| ContentError::Quantity { what: "fill", source })?;
                heights.iter_mut().filter(|h| h.is_nan()).for_each(|h| *h = value);
            }
        }
        Ok(())
    }
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
