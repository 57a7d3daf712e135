//! From a scan to a square map: crop, trend, holes, resampling, units.

mod fill;
mod resample;
mod trend;

pub use trend::Detrend;

use crate::error::{Error, Place, Problem, Result};
use crate::quantity::{Dimension, Quantity};
use crate::scan::Scan;
use contact_model::HeightMap;

/// What is done to a scan, in this order; nothing unless named.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Treatment {
    /// Which square is taken.
    pub crop: Option<Crop>,
    /// What stands in the holes. Without it holes are an error.
    pub fill: Option<Fill>,
    /// What is subtracted: fitted to the cells that have a height in the file, after the crop.
    pub detrend: Detrend,
    /// Cells a side after averaging over larger cells.
    pub cells: Option<usize>,
}

/// A square part of a scan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Crop {
    /// The largest square in the middle; where the margins are odd, the upper and the left one are the smaller.
    Centre,
    /// The square of `cells` x `cells` whose first cell is (row, column), counted from 0.
    Window {
        /// First row.
        row: usize,
        /// First column.
        column: usize,
        /// Cells a side.
        cells: usize,
    },
}

/// Heights for cells that have none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fill {
    /// Each missing height is the mean of those of its neighbours (four inside, fewer at an edge), filled ones included: the discrete harmonic
    /// function with the measured rim. Unique, between the lowest and the highest height of the rim, and a plane stays a plane inside.
    Neighbours,
    /// The least-squares plane through all measured heights.
    Plane,
    /// One height, of the dimension of the scan's unit.
    Value(Quantity),
}

impl Scan {
    /// A square map: crop, fill, subtract the trend, average over larger cells; in metres where the scan has units, else in its own numbers.
    ///
    /// The trend is fitted to measured heights only and subtracted from all. Cost O(N^2), with [`Fill::Neighbours`] times the width of the holes.
    ///
    /// # Errors
    /// [`Error::Content`]: not square, holes without a fill, side of a cell or unit of the heights not said (one of them with a unit and the
    /// other without), a crop that leaves the map, finer cells, heights that overflow, a trend that the heights do not determine.
    ///
    /// ```
    /// use surface_io::{Declared, Detrend, Scan, Treatment};
    /// let declared = Declared { cell: Some("1 um".parse()?), unit: Some("nm".parse()?), ..Declared::default() };
    /// let scan = Scan::from_bytes("a.txt", b"1 2\n3 6\n", &declared)?;
    /// let map = scan.map(&Treatment { detrend: Detrend::Mean, ..Treatment::default() })?;
    /// assert_eq!((map.columns(), map.length()), (2, 2e-6));
    /// assert_eq!(map.heights()[0], -2e-9);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn map(&self, treatment: &Treatment) -> Result<HeightMap> {
        self.treated(treatment).map_err(Error::content(self.path()))
    }

    fn treated(&self, treatment: &Treatment) -> Result<HeightMap, Problem> {
        let cell = self.cell()?;
        let (cells, mut heights) = self.square(treatment.crop)?;
        let missing = heights.iter().filter(|h| h.is_nan()).count();
        if missing == heights.len() {
            return Err(Problem::AllMissing { cells: heights.len() });
        }
        if let Some(unit) = &self.understood().unit {
            for h in &mut heights {
                *h = unit.value.to_si(*h);
            }
        }
        if let Some(value) = heights.iter().copied().find(|h| h.is_infinite()) {
            return Err(Problem::Overflow { value });
        }
        let trend = treatment.detrend.fit(cells, &heights)?;
        if missing > 0 {
            let first = heights.iter().position(|h| h.is_nan()).unwrap_or(0);
            let first = Place::Cell { row: first / cells, column: first % cells };
            let fill = treatment.fill.ok_or(Problem::Holes { missing, cells: heights.len(), first })?;
            self.fill(fill, cells, &mut heights)?;
        }
        if let Some(trend) = trend {
            trend.subtract(cells, &mut heights);
        }
        let (coarse, heights) = match treatment.cells {
            None => (cells, heights),
            Some(coarse) if coarse == 0 || coarse > cells => {
                return Err(Problem::Resample { cells: coarse, found: cells });
            }
            Some(coarse) => (coarse, resample::coarsen(&heights, cells, coarse)),
        };
        HeightMap::new(coarse, cell * cells as f64, heights).map_err(Problem::Map)
    }

    /// Side of a cell in metres, or in the numbers of the file.
    fn cell(&self) -> Result<f64, Problem> {
        let understood = self.understood();
        let unit = understood.unit.as_ref().map(|u| u.value.dimension());
        match (understood.cell.as_ref().map(|c| c.value), unit) {
            (None, _) => {
                let remedy =
                    "say cell = \"0.5 um\" or width = \"1 mm\", or a number where the heights have no unit";
                Err(Problem::Unsaid { what: "the side of a cell", remedy })
            }
            (Some(cell), None) if cell.dimension() == Dimension::LENGTH => Err(Problem::Unsaid {
                what: "the unit of the heights",
                remedy: "say unit = \"nm\" or another unit of length",
            }),
            (Some(cell), unit) if cell.dimension() == unit.unwrap_or(Dimension::NONE) => Ok(cell.value()),
            (Some(cell), _) => Err(Problem::Contradiction {
                what: "units",
                first: format!("the side of a cell is {cell}"),
                second: format!(
                    "the heights have {}",
                    understood.unit.as_ref().map_or_else(|| "no unit".into(), |u| u.value.to_string())
                ),
            }),
        }
    }

    fn square(&self, crop: Option<Crop>) -> Result<(usize, Vec<f64>), Problem> {
        let (rows, columns) = (self.understood().rows, self.understood().columns);
        let (row, column, cells) = match crop {
            None if rows != columns => return Err(Problem::NotSquare { rows, columns }),
            None => return Ok((rows, self.heights().to_vec())),
            Some(Crop::Centre) => {
                let cells = rows.min(columns);
                ((rows - cells) / 2, (columns - cells) / 2, cells)
            }
            Some(Crop::Window { row, column, cells }) => (row, column, cells),
        };
        let inside = |from: usize, all: usize| from.checked_add(cells).is_some_and(|end| end <= all);
        if cells == 0 || !inside(row, rows) || !inside(column, columns) {
            return Err(Problem::Crop { from: [row, column], cells, shape: [rows, columns] });
        }
        let part = |row: &[f64]| row[column..column + cells].to_vec();
        Ok((cells, self.heights().chunks_exact(columns).skip(row).take(cells).flat_map(part).collect()))
    }

    fn fill(&self, fill: Fill, cells: usize, heights: &mut [f64]) -> Result<(), Problem> {
        match fill {
            Fill::Neighbours => fill::harmonic(cells, heights),
            Fill::Plane => {
                if let Some(plane) = Detrend::Plane.fit(cells, heights)? {
                    plane.fill(cells, heights);
                }
            }
            Fill::Value(value) => {
                let unit = self.understood().unit.as_ref().map_or(Dimension::NONE, |u| u.value.dimension());
                let value =
                    value.expect(unit).map_err(|source| Problem::Quantity { what: "fill", source })?;
                heights.iter_mut().filter(|h| h.is_nan()).for_each(|h| *h = value);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests;
