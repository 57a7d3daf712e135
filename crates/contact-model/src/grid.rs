//! Sampled surfaces: a square map of cells and a line of elements.

use crate::error::{Error, Result, positive};

/// Heights on a square of `cells` x `cells` square cells, row-major (`heights[iy * cells + ix]`), finite by construction.
///
/// Cell (ix, iy) covers `[ix, ix + 1] x [iy, iy + 1]` in units of the cell size `side / cells`.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightMap {
    cells: usize,
    side: f64,
    heights: Vec<f64>,
}

impl HeightMap {
    /// Takes `cells * cells` heights on a square of the given side (same length unit).
    ///
    /// # Errors
    /// [`Error::Domain`] for `cells = 0`, a side that is not positive, a height that is NaN or infinite or a relief
    /// (highest minus lowest) that overflows; [`Error::Shape`] when the number of heights is not `cells^2`.
    pub fn new(cells: usize, side: f64, heights: Vec<f64>) -> Result<Self> {
        if cells == 0 {
            return Err(Error::domain("cells", 0.0, "at least 1 cell a side"));
        }
        positive("side", side)?;
        if cells.checked_mul(cells) != Some(heights.len()) {
            return Err(Error::Shape {
                name: "heights".into(),
                found: heights.len(),
                expected: format!("{cells} x {cells} (a square map)").into(),
            });
        }
        check_heights(&heights, |i| format!("heights[{}, {}]", i / cells, i % cells))?;
        Ok(Self { cells, side, heights })
    }

    /// Number of cells a side, N.
    pub fn cells(&self) -> usize {
        self.cells
    }

    /// Side of the square, L.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Side of one cell, `h_c = L / N`.
    pub fn cell(&self) -> f64 {
        self.side / self.cells as f64
    }

    /// The heights, row-major.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Highest value.
    pub fn highest(&self) -> f64 {
        highest(&self.heights)
    }
}

/// Heights of `n` equal elements along a line of the given length, finite by construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    length: f64,
    heights: Vec<f64>,
}

impl Line {
    /// Takes the heights of the elements of a line of the given length (same length unit).
    ///
    /// # Errors
    /// [`Error::Domain`] for a length that is not positive, a height that is NaN or infinite or a relief that overflows;
    /// [`Error::Shape`] for no heights at all.
    pub fn new(length: f64, heights: Vec<f64>) -> Result<Self> {
        positive("length", length)?;
        if heights.is_empty() {
            return Err(Error::Shape { name: "heights".into(), found: 0, expected: "at least 1".into() });
        }
        check_heights(&heights, |i| format!("heights[{i}]"))?;
        Ok(Self { length, heights })
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.heights.len()
    }

    /// Length of the line, `L_1D`.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Length of one element, `dx = L_1D / n`.
    pub fn element(&self) -> f64 {
        self.length / self.heights.len() as f64
    }

    /// The heights along the line.
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Highest value.
    pub fn highest(&self) -> f64 {
        highest(&self.heights)
    }
}

fn highest(heights: &[f64]) -> f64 {
    heights.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn check_heights(heights: &[f64], place: impl Fn(usize) -> String) -> Result<()> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, &h) in heights.iter().enumerate() {
        if !h.is_finite() {
            return Err(Error::domain(place(i), h, "a finite height"));
        }
        low = low.min(h);
        high = high.max(h);
    }
    if !(high - low).is_finite() {
        return Err(Error::domain("relief (highest minus lowest height)", high - low, "a finite number"));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_maps_are_named() {
        let e = HeightMap::new(2, 1.0, vec![0.0, 1.0, f64::NAN, 0.0]).unwrap_err();
        assert_eq!(e.to_string(), "heights[1, 0] = NaN: expected a finite height");
        let e = HeightMap::new(2, 1.0, vec![0.0; 3]).unwrap_err();
        assert_eq!(e.to_string(), "heights has 3 values: expected 2 x 2 (a square map)");
        assert!(HeightMap::new(0, 1.0, vec![]).is_err());
        assert!(HeightMap::new(1, 0.0, vec![0.0]).is_err());
        assert!(HeightMap::new(1, f64::INFINITY, vec![0.0]).is_err());
        assert!(HeightMap::new(usize::MAX, 1.0, vec![]).is_err());
        assert!(Line::new(1.0, vec![1e308, -1e308]).is_err());
        assert!(Line::new(1.0, vec![]).is_err());
    }
}
