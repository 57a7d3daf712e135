//! Heights on a rectangular map of cells.

use crate::cells::{Cells, Size};
use crate::error::{Error, Result};
use crate::heights::{check_heights, check_relief, highest};
use std::ops::Range;

/// Heights on a rectangle of equal cells, row-major (`heights[iy * columns + ix]`: rows along y, as NPY
/// arrays `[row, column]`).
///
/// Cell (ix, iy) covers `[ix, ix + 1] dx x [iy, iy + 1] dy`. Heights are finite, or minus infinity at
/// undefined points, which cannot touch; at least one point is defined.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    cells: Cells,
    size: Size,
    heights: Vec<f64>,
    undefined: usize,
}

impl HeightMap {
    /// A map of `columns * rows` finite heights on a rectangle of the given size (same length unit). A single
    /// number as the cells or the size makes a square.
    ///
    /// # Errors
    /// Those of [`Cells::validate`]; [`Error::Domain`] for a height that is NaN or infinite or a range
    /// (highest minus lowest) that overflows; [`Error::Shape`] when the number of heights is not that of the
    /// cells.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::new([3, 2], [6.0, 1.0], vec![0.0; 6])?;
    /// assert_eq!((map.columns(), map.rows(), map.dx(), map.dy()), (3, 2, 2.0, 0.5));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(cells: impl Into<Cells>, size: impl Into<Size>, heights: Vec<f64>) -> Result<Self> {
        let (cells, size) = checked_grid(cells.into(), size.into(), heights.len())?;
        check_heights(&heights, |i| place(cells, i)).map_err(|error| match error {
            Error::Domain { name, value, expected } if value.is_nan() && name.starts_with("heights[") => {
                Error::domain(
                    name,
                    value,
                    format!("{expected}; `HeightMap::with_undefined` takes undefined points"),
                )
            }
            error => error,
        })?;
        Ok(Self { cells, size, heights, undefined: 0 })
    }

    /// The map of the heights `height(ix, iy)`, in the order of storage. The centre of cell (ix, iy) is at
    /// `((ix + 1/2) dx, (iy + 1/2) dy)`.
    ///
    /// # Errors
    /// As [`HeightMap::new`]; [`Error::OutOfMemory`] when the map does not fit in memory. Heights that are
    /// NaN at undefined points belong to [`HeightMap::with_undefined`], which the error names.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::from_fn([2, 3], [2.0, 3.0], |ix, iy| (10 * iy + ix) as f64)?;
    /// assert_eq!(map.heights(), [0.0, 1.0, 10.0, 11.0, 20.0, 21.0]);
    /// let undefined = HeightMap::from_fn(2, 1.0, |ix, _| if ix == 0 { 0.0 } else { f64::NAN });
    /// assert!(undefined.unwrap_err().to_string().ends_with("`HeightMap::with_undefined` takes undefined points"));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn from_fn(
        cells: impl Into<Cells>,
        size: impl Into<Size>,
        mut height: impl FnMut(usize, usize) -> f64,
    ) -> Result<Self> {
        let (cells, size) = (cells.into(), size.into());
        cells.validate(size)?;
        let mut heights = Vec::new();
        match cells.checked_count() {
            Some(count) if heights.try_reserve_exact(count).is_ok() => {}
            _ => {
                let Cells { columns, rows } = cells;
                let what = format!("a map of {columns} columns x {rows} rows");
                return Err(Error::out_of_memory(what, cells.map_bytes()));
            }
        }
        for iy in 0..cells.rows {
            heights.extend((0..cells.columns).map(|ix| height(ix, iy)));
        }
        Self::new(cells, size, heights)
    }

    /// A map whose heights are NaN at undefined points, which cannot touch.
    ///
    /// # Errors
    /// As [`HeightMap::new`], but for NaN; [`Error::Domain`] when no point is defined.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::with_undefined(2, 1.0, vec![0.5, f64::NAN, 0.25, 0.0])?;
    /// assert_eq!((map.undefined(), map.defined().count(), map.highest()), (1, 3, 0.5));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn with_undefined(
        cells: impl Into<Cells>,
        size: impl Into<Size>,
        mut heights: Vec<f64>,
    ) -> Result<Self> {
        let (cells, size) = checked_grid(cells.into(), size.into(), heights.len())?;
        let mut undefined = 0;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for (i, h) in heights.iter_mut().enumerate() {
            if h.is_nan() {
                (*h, undefined) = (f64::NEG_INFINITY, undefined + 1);
            } else if h.is_finite() {
                (low, high) = (low.min(*h), high.max(*h));
            } else {
                return Err(Error::domain(
                    place(cells, i),
                    *h,
                    "a finite height, or NaN at an undefined point",
                ));
            }
        }
        if undefined == heights.len() {
            return Err(no_point());
        }
        check_relief(low, high)?;
        Ok(Self { cells, size, heights, undefined })
    }

    /// Numbers of columns and rows.
    pub fn cells(&self) -> Cells {
        self.cells
    }

    /// Number of columns, along x.
    pub fn columns(&self) -> usize {
        self.cells.columns
    }

    /// Number of rows, along y.
    pub fn rows(&self) -> usize {
        self.cells.rows
    }

    /// Sides of the rectangle.
    pub fn size(&self) -> Size {
        self.size
    }

    /// `L = sqrt(Lx Ly)`.
    pub fn length(&self) -> f64 {
        self.size.length()
    }

    /// Side of one cell along x, `Lx / columns`.
    pub fn dx(&self) -> f64 {
        self.size.x / self.cells.columns as f64
    }

    /// Side of one cell along y, `Ly / rows`.
    pub fn dy(&self) -> f64 {
        self.size.y / self.cells.rows as f64
    }

    /// The heights, row-major; minus infinity at undefined points.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// The heights of the defined points, in order.
    pub fn defined(&self) -> impl Iterator<Item = f64> + Clone + '_ {
        self.heights.iter().copied().filter(|h| h.is_finite())
    }

    /// Number of undefined points.
    pub fn undefined(&self) -> usize {
        self.undefined
    }

    /// Highest value. Cost: one pass over the heights.
    pub fn highest(&self) -> f64 {
        highest(&self.heights)
    }

    /// The map with x and y exchanged.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::new([3, 2], [6.0, 1.0], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])?.transposed();
    /// assert_eq!((map.columns(), map.dx(), map.dy()), (2, 0.5, 2.0));
    /// assert_eq!(map.heights(), [0.0, 3.0, 1.0, 4.0, 2.0, 5.0]);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    #[must_use]
    pub fn transposed(&self) -> Self {
        let Cells { columns, rows } = self.cells;
        let heights = (0..columns).flat_map(|ix| self.heights[ix..].iter().step_by(columns).copied());
        Self {
            cells: Cells { columns: rows, rows: columns },
            size: Size { x: self.size.y, y: self.size.x },
            heights: heights.collect(),
            undefined: self.undefined,
        }
    }

    /// The map with x reversed: every row from its last column to its first.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::new([3, 1], [3.0, 1.0], vec![0.0, 1.0, 2.0])?;
    /// assert_eq!(map.mirrored().heights(), [2.0, 1.0, 0.0]);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    #[must_use]
    pub fn mirrored(&self) -> Self {
        let rows = self.heights.chunks_exact(self.cells.columns);
        Self { heights: rows.flat_map(|row| row.iter().rev().copied()).collect(), ..*self }
    }

    /// The part of the map in the given ranges of columns and rows, with the same cells.
    ///
    /// # Errors
    /// [`Error::Domain`] for an empty range, a range that leaves the map, and a part without a defined point.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let map = HeightMap::new([3, 2], [6.0, 1.0], vec![0.0, 1.0, 2.0, 3.0, 4.0, 5.0])?;
    /// let part = map.cropped(1..3, 0..2)?;
    /// assert_eq!((part.heights(), part.dx(), part.dy()), (&[1.0, 2.0, 4.0, 5.0][..], 2.0, 0.5));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn cropped(&self, columns: Range<usize>, rows: Range<usize>) -> Result<Self> {
        for (name, range, count) in [("columns", &columns, self.columns()), ("rows", &rows, self.rows())] {
            if range.is_empty() || range.end > count {
                let (name, end) = (format!("end of the range of {name}"), range.end as f64);
                return Err(Error::domain(
                    name,
                    end,
                    format!("more than {} and at most {count}", range.start),
                ));
            }
        }
        let cells = Cells { columns: columns.len(), rows: rows.len() };
        let share = |part: usize, all: usize| part as f64 / all as f64;
        let size = Size {
            x: self.size.x * share(cells.columns, self.columns()),
            y: self.size.y * share(cells.rows, self.rows()),
        };
        let inside = self.heights.chunks_exact(self.columns()).skip(rows.start).take(cells.rows);
        let heights: Vec<f64> = inside.flat_map(|row| row[columns.clone()].iter().copied()).collect();
        let undefined = heights.iter().filter(|h| h.is_infinite()).count();
        if undefined == heights.len() {
            return Err(no_point());
        }
        Ok(Self { cells, size, heights, undefined })
    }

    /// The sum of two maps on the same rectangle and cells; a point is undefined where it is in one of them.
    ///
    /// # Errors
    /// [`Error::Shape`] for other cells, [`Error::Domain`] for another size or where no point is left.
    ///
    /// ```
    /// use contact_model::HeightMap;
    /// let wave = HeightMap::from_fn([2, 1], 1.0, |ix, _| ix as f64)?;
    /// assert_eq!(wave.plus(&wave.scaled(1.0, 10.0)?)?.heights(), [0.0, 11.0]);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn plus(&self, other: &Self) -> Result<Self> {
        self.combined(other, |a, b| a + b)
    }

    /// The difference of two maps, as [`HeightMap::plus`].
    ///
    /// # Errors
    /// As [`HeightMap::plus`].
    pub fn minus(&self, other: &Self) -> Result<Self> {
        self.combined(other, |a, b| a - b)
    }

    fn combined(&self, other: &Self, of: impl Fn(f64, f64) -> f64) -> Result<Self> {
        if other.cells != self.cells {
            let Cells { columns, rows } = self.cells;
            let (name, expected) = ("heights of the other map", format!("{rows} rows x {columns} columns"));
            return Err(Error::Shape {
                name: name.into(),
                found: other.heights.len(),
                expected: expected.into(),
            });
        }
        for (name, mine, found) in [("x", self.size.x, other.size.x), ("y", self.size.y, other.size.y)] {
            if mine.total_cmp(&found).is_ne() {
                let name = format!("side of the other map along {name}");
                return Err(Error::domain(name, found, format!("{mine}")));
            }
        }
        let pairs = self.heights.iter().zip(&other.heights);
        let defined =
            |(&a, &b): (&f64, &f64)| if a.is_finite() && b.is_finite() { of(a, b) } else { f64::NAN };
        Self::with_undefined(self.cells, self.size, pairs.map(defined).collect())
    }

    /// The map with lateral lengths times `lateral` and heights times `vertical`.
    ///
    /// # Errors
    /// [`Error::Domain`] where a lateral factor is not positive or a height overflows.
    pub fn scaled(&self, lateral: f64, vertical: f64) -> Result<Self> {
        let size = Size { x: self.size.x * lateral, y: self.size.y * lateral };
        let heights = self.heights.iter().map(|h| if h.is_finite() { h * vertical } else { f64::NAN });
        Self::with_undefined(self.cells, size, heights.collect())
    }

    /// The map turned by 90 degrees: transposed, then mirrored.
    #[must_use]
    pub fn rotated(&self) -> Self {
        self.transposed().mirrored()
    }
}

fn no_point() -> Error {
    Error::domain("defined points", 0.0, "at least 1 (every height of the map is undefined)")
}

fn place(cells: Cells, i: usize) -> String {
    format!("heights[{}, {}]", i / cells.columns, i % cells.columns)
}

fn checked_grid(cells: Cells, size: Size, heights: usize) -> Result<(Cells, Size)> {
    cells.validate(size)?;
    if cells.checked_count() != Some(heights) {
        let Cells { columns, rows } = cells;
        let expected = format!("{rows} rows x {columns} columns").into();
        return Err(Error::Shape { name: "heights".into(), found: heights, expected });
    }
    Ok((cells, size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line::Line;

    #[test]
    fn bad_maps_are_named() {
        let e = HeightMap::new(2, 1.0, vec![0.0, 1.0, f64::NAN, 0.0]).unwrap_err();
        let expected = "heights[1, 0] = NaN: expected a finite height; `HeightMap::with_undefined` takes undefined points";
        assert_eq!(e.to_string(), expected);
        let e = HeightMap::from_fn(2, 1.0, |ix, iy| if ix < iy { f64::NAN } else { 0.0 }).unwrap_err();
        assert_eq!(e.to_string(), expected);
        let e = HeightMap::new(2, 1.0, vec![0.0, 1.0, f64::INFINITY, 0.0]).unwrap_err();
        assert_eq!(e.to_string(), "heights[1, 0] = inf: expected a finite height");
        let e = HeightMap::new(2, 1.0, vec![0.0; 3]).unwrap_err();
        assert_eq!(e.to_string(), "heights has 3 values: expected 2 rows x 2 columns");
        assert!(HeightMap::new(0, 1.0, vec![]).is_err());
        assert!(HeightMap::new(1, 0.0, vec![0.0]).is_err());
        assert!(HeightMap::new(1, f64::INFINITY, vec![0.0]).is_err());
        assert!(HeightMap::new(usize::MAX, 1.0, vec![]).is_err());
        for (cells, size) in
            [([0, 3], [1.0, 1.0]), ([2, 2], [-1.0, 1.0]), ([2, 2], [1.0, 1e9]), ([2, 2], [1e9, 1.0])]
        {
            let heights = vec![0.0; cells[0] * cells[1]];
            assert!(HeightMap::new(cells, size, heights).is_err(), "{cells:?} {size:?}");
        }
        let e = HeightMap::with_undefined(2, 1.0, vec![f64::NAN; 4]).unwrap_err();
        assert_eq!(
            e.to_string(),
            "defined points = 0: expected at least 1 (every height of the map is undefined)"
        );
        assert!(HeightMap::with_undefined(2, 1.0, vec![0.0, f64::NAN, f64::INFINITY, 0.0]).is_err());
        assert!(HeightMap::from_fn(usize::MAX, 1.0, |_, _| 0.0).is_err());
        assert!(HeightMap::from_fn(2, 1.0, |_, _| f64::NAN).is_err());
        assert!(Line::new(1.0, vec![1e308, -1e308]).is_err());
        assert!(Line::new(1.0, vec![]).is_err());
    }

    #[test]
    fn oblong_cells_are_named() {
        let e = HeightMap::new([1, 10], [2e4, 10.0], vec![0.0; 10]).unwrap_err();
        assert!(e.to_string().starts_with("dx / dy (ratio of the sides of a cell) = 20000: expected"), "{e}");
        assert!(HeightMap::new([1, 10], [1e4, 10.0], vec![0.0; 10]).is_ok());
        let e = Size { x: 1.0, y: -2.0 }.validate().unwrap_err();
        assert_eq!(e.to_string(), "side along y = -2: expected a finite number > 0");
    }

    #[test]
    fn undefined_points_go_with_their_cells() {
        let nan = f64::NAN;
        let map = HeightMap::with_undefined([3, 2], [3.0, 2.0], vec![0.0, nan, 2.0, nan, 4.0, 5.0]).unwrap();
        let turned = map.transposed();
        assert_eq!(turned.heights(), [0.0, f64::NEG_INFINITY, f64::NEG_INFINITY, 4.0, 2.0, 5.0]);
        assert_eq!((turned.undefined(), turned.transposed()), (2, map.clone()));
        assert_eq!(map.mirrored().heights(), [2.0, f64::NEG_INFINITY, 0.0, 5.0, 4.0, f64::NEG_INFINITY]);
        assert_eq!(map.mirrored().mirrored(), map);
        assert_eq!(map.cropped(2..3, 0..2).unwrap().undefined(), 0);
        assert_eq!(map.cropped(0..3, 0..2).unwrap(), map);
        assert!(map.cropped(1..2, 0..1).unwrap_err().to_string().starts_with("defined points = 0"));
        for (columns, rows) in [(1..1, 0..2), (2..4, 0..2), (0..3, 3..4)] {
            assert!(matches!(map.cropped(columns, rows), Err(Error::Domain { .. })));
        }
    }
}
