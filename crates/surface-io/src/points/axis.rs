//! One axis of a regular grid from the coordinates of its points.

use crate::error::ContentError;

/// Coordinates nearer to each other than this share of their range are one: digits that a program rounded in
/// double precision.
const SAME: f64 = 1e-9;

/// How far a coordinate may be off its place, in spacings that were found: coordinates printed with few
/// digits.
const OFF_FOUND: f64 = 0.1;

/// The same for spacings that were given: a quarter leaves no uncertainty which place is meant.
const OFF_GIVEN: f64 = 0.25;

/// Places `origin + i * spacing`, i = 0 .. count.
#[derive(Debug)]
pub(super) struct GridAxis {
    name: char,
    origin: f64,
    /// `None` where all coordinates are one and nothing was given.
    pub(super) spacing: Option<f64>,
    /// A whole number, but perhaps one that no `usize` holds.
    pub(super) count: f64,
    /// How far a coordinate may be off its place, in spacings.
    allowed: f64,
    /// How far one is.
    pub(super) off: f64,
}

impl GridAxis {
    /// The grid of these coordinates: with the given spacing, else with the smallest step between two of
    /// them, refined over their whole range.
    pub(super) fn find(name: char, mut values: Vec<f64>, given: Option<f64>) -> Result<Self, ContentError> {
        values.sort_unstable_by(f64::total_cmp);
        let (Some(&origin), Some(&last)) = (values.first(), values.last()) else {
            return Err(ContentError::Empty);
        };
        let span = last - origin;
        if !span.is_finite() {
            return Err(ContentError::Overflow { value: origin.abs().max(last.abs()) });
        }
        let spacing = match given {
            Some(spacing) => Some(spacing),
            None if span > 0.0 => Some(spacing(&values, span)),
            None => None,
        };
        let count = spacing.map_or(0.0, |s| (span / s).round()) + 1.0;
        if !count.is_finite() {
            return Err(ContentError::Overflow { value: span });
        }
        let allowed = if given.is_some() { OFF_GIVEN } else { OFF_FOUND };
        let mut axis = Self { name, origin, spacing, count, allowed, off: 0.0 };
        for &value in &values {
            let place = axis.place(value)?;
            axis.off = axis.off.max(spacing.map_or(0.0, |s| ((value - origin) / s - place).abs()));
        }
        Ok(axis)
    }

    /// Number of the place of a coordinate.
    pub(super) fn index(&self, value: f64) -> Result<usize, ContentError> {
        self.place(value).map(|place| place as usize)
    }

    fn place(&self, value: f64) -> Result<f64, ContentError> {
        let Some(spacing) = self.spacing else { return Ok(0.0) };
        let place = (value - self.origin) / spacing;
        if (place - place.round()).abs() <= self.allowed {
            Ok(place.round())
        } else {
            Err(ContentError::Irregular { axis: self.name, value, origin: self.origin, spacing })
        }
    }
}

/// The range over the number of steps in it, each step in units of the smallest one.
fn spacing(sorted: &[f64], span: f64) -> f64 {
    let steps = || {
        let mut last = sorted[0];
        sorted.iter().filter_map(move |&value| {
            let step = value - last;
            (step > SAME * span).then(|| {
                last = value;
                step
            })
        })
    };
    let smallest = steps().fold(span, f64::min);
    span / steps().map(|step| (step / smallest).round()).sum::<f64>()
}
