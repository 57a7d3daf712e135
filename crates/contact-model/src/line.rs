//! Heights along a line of elements.

use crate::error::{Error, Result, positive};
use crate::heights::{check_heights, highest};

/// Heights of `n` equal elements along a line of the given length, finite by construction.
#[derive(Debug, Clone, PartialEq)]
pub struct Line {
    length: f64,
    heights: Vec<f64>,
}

impl Line {
    /// A line of the given length with these heights of its elements (same length unit).
    ///
    /// # Errors
    /// [`Error::Domain`] for a length that is not positive, a height that is NaN or infinite or a range that
    /// overflows; [`Error::Shape`] for no heights at all.
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

    /// Highest value. Cost: one pass over the heights.
    pub fn highest(&self) -> f64 {
        highest(&self.heights)
    }
}
