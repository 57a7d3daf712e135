//! Checks that maps and lines share.

use crate::error::{Error, Result};

pub(crate) fn highest(heights: &[f64]) -> f64 {
    heights.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

pub(crate) fn check_heights(heights: &[f64], place: impl Fn(usize) -> String) -> Result<()> {
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, &h) in heights.iter().enumerate() {
        if !h.is_finite() {
            return Err(Error::domain(place(i), h, "a finite height"));
        }
        low = low.min(h);
        high = high.max(h);
    }
    check_relief(low, high)
}

pub(crate) fn check_relief(low: f64, high: f64) -> Result<()> {
    if (high - low).is_finite() {
        Ok(())
    } else {
        Err(Error::domain("relief (highest minus lowest height)", high - low, "a finite number"))
    }
}
