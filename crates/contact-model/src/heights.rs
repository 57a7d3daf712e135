//! Checks that maps and lines share.

use crate::error::{Error, Result};

/// Number of values side by side in a loop over heights, so that the compiler vectorises it.
const LANES: usize = 16;

pub(crate) fn highest(heights: &[f64]) -> f64 {
    lanes(heights, f64::NEG_INFINITY, |a, b| if b > a { b } else { a })
}

/// Folds values in an order that a vector loop can take; `start` changes nothing.
fn lanes(values: &[f64], start: f64, take: impl Fn(f64, f64) -> f64) -> f64 {
    let (groups, rest) = values.as_chunks::<LANES>();
    let mut lanes = [start; LANES];
    for group in groups {
        for (lane, &value) in lanes.iter_mut().zip(group) {
            *lane = take(*lane, value);
        }
    }
    lanes.iter().chain(rest).fold(start, |a, &b| take(a, b))
}

pub(crate) fn check_heights(heights: &[f64], place: impl Fn(usize) -> String) -> Result<()> {
    // 0 times a finite number is 0, times an infinite one or NaN it is NaN.
    if lanes(heights, 0.0, |sum, h| sum + 0.0 * h).is_nan()
        && let Some((i, &h)) = heights.iter().enumerate().find(|(_, h)| !h.is_finite())
    {
        return Err(Error::domain(place(i), h, "a finite height"));
    }
    check_relief(lanes(heights, f64::INFINITY, |a, b| if b < a { b } else { a }), highest(heights))
}

pub(crate) fn check_relief(low: f64, high: f64) -> Result<()> {
    if (high - low).is_finite() {
        Ok(())
    } else {
        Err(Error::domain("range of heights (highest minus lowest)", high - low, "a finite number"))
    }
}
