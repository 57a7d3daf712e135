//! Heights about the middle of their range, in units of half of it.

use contact_model::{Error, HeightMap, Result};
use numerics::range::middle_and_half_width;

/// Heights of a map whose squares stay within the range of f64.
#[derive(Debug)]
pub(crate) struct Relative {
    /// About the middle of their range, in `unit`; NaN at undefined points.
    pub(crate) heights: Vec<f64>,
    /// Half the range; 1 where all heights are one.
    pub(crate) unit: f64,
}

impl Relative {
    pub(crate) fn new(map: &HeightMap) -> Self {
        let ends = |(low, high): (f64, f64), h: f64| (low.min(h), high.max(h));
        let (low, high) = map.defined().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
        let (middle, unit) = middle_and_half_width((low, high));
        let relative = |h: &f64| if h.is_finite() { (h - middle) / unit } else { f64::NAN };
        Self { heights: map.heights().iter().map(relative).collect(), unit }
    }
}

/// The value, where it is finite.
///
/// # Errors
/// [`Error::Domain`] otherwise.
pub(crate) fn finite(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() { Ok(value) } else { Err(Error::not_representable(name, value)) }
}
