//! Deterministic bodies, sampled at the cells' centres; the apex is at the centre of the rectangle, at height 0.

use contact_model::{Cells, Error, HeightMap, Result, Size};
use std::f64::consts::TAU;

/// Depth of the surface outside of the face of a flat circular punch, in units of the longer side of the
/// rectangle.
///
/// The linear theory holds up to approaches of a fraction of the side. A thousand sides is deeper than any
/// sensible load, and still small enough that heights of neighbouring cells can be subtracted without
/// overflow.
pub(crate) const RECESS: f64 = 1e3;

/// Distances from the middle of the rectangle in units of half the longer side of a cell: exact integers
/// where cells are squares, so that maps have all symmetries of the grid.
#[derive(Debug, Clone, Copy)]
struct Distances {
    cells: Cells,
    /// Sides of a cell over the longer of them.
    aspect: [f64; 2],
    /// Half the longer side of a cell.
    unit: f64,
    /// Side of the rectangle, and number of cells, along the longer side of a cell.
    along: (f64, usize),
}

impl Distances {
    fn new(cells: Cells, size: Size) -> Result<Self> {
        cells.validate(size)?;
        let (dx, dy) = (size.x / cells.columns as f64, size.y / cells.rows as f64);
        let longer = dx.max(dy);
        let along = if dx < dy { (size.y, cells.rows) } else { (size.x, cells.columns) };
        Ok(Self { cells, aspect: [dx / longer, dy / longer], unit: 0.5 * longer, along })
    }

    /// Squared distance of the centre of a cell.
    fn square(&self, ix: usize, iy: usize) -> f64 {
        let [x, y] =
            [(ix, self.cells.columns), (iy, self.cells.rows)].map(|(i, n)| 2.0 * i as f64 + 1.0 - n as f64);
        let [x, y] = [x * self.aspect[0], y * self.aspect[1]];
        x * x + y * y
    }
}

/// `-depth(r)` at every cell centre, r from the middle of the rectangle.
pub(crate) fn axisymmetric(cells: Cells, size: Size, depth: impl Fn(f64) -> f64) -> Result<HeightMap> {
    let distances = Distances::new(cells, size)?;
    HeightMap::from_fn(cells, size, |ix, iy| 0.0 - depth(distances.unit * distances.square(ix, iy).sqrt()))
}

/// A flat circular face at height 0; `RECESS` longer sides lower outside it.
pub(crate) fn flat_circle(cells: Cells, size: Size, radius: f64) -> Result<HeightMap> {
    let distances = Distances::new(cells, size)?;
    let (side, count) = distances.along;
    let twice = 2.0 * radius / side * count as f64;
    let nearest = distances.square(cells.columns / 2, cells.rows / 2);
    if twice * twice < nearest || radius > 0.5 * size.shorter() {
        let place = if size.is_square() {
            format!("square of side {}", size.x)
        } else {
            format!("rectangle of sides {} and {}", size.x, size.y)
        };
        let expected = format!("a face that fits in the {place} and covers a cell's centre");
        return Err(Error::domain("radius", radius, expected));
    }
    let recess = -RECESS * size.x.max(size.y);
    HeightMap::from_fn(
        cells,
        size,
        |ix, iy| if distances.square(ix, iy) <= twice * twice { 0.0 } else { recess },
    )
}

/// `amplitude cos(2 pi x / wavelength)`, x from the edge of the rectangle.
pub(crate) fn sine(cells: Cells, size: Size, amplitude: f64, wavelength: f64) -> Result<HeightMap> {
    cells.validate(size)?;
    let (columns, periods) = (cells.columns as f64, size.x / wavelength);
    if 2.0 * periods > columns {
        let shortest = 2.0 * size.x / columns;
        let expected = format!("at least two cells, {shortest}");
        return Err(Error::domain("wavelength", wavelength, expected));
    }
    let mut row = Vec::new();
    HeightMap::from_fn(cells, size, |ix, iy| {
        if iy == 0 {
            let turns = periods * ((ix as f64 + 0.5) / columns);
            row.push(amplitude * (TAU * turns.fract()).cos());
        }
        row[ix]
    })
}

/// All heights 0.
pub(crate) fn flat(cells: Cells, size: Size) -> Result<HeightMap> {
    HeightMap::from_fn(cells, size, |_, _| 0.0)
}
