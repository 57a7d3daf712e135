//! One axis of a regular grid from the coordinates of its points.

use crate::error::Problem;

/// Coordinates nearer to each other than this share of their range are one: digits that a program rounded in double precision.
const SAME: f64 = 1e-9;

/// How far a coordinate may be off its place, in spacings: a quarter leaves no doubt which place is meant.
const OFF: f64 = 0.25;

/// Places `origin + i * spacing`, i = 0 .. count.
#[derive(Debug)]
pub(super) struct Axis {
    name: char,
    origin: f64,
    /// `None` where all coordinates are one and nothing was given.
    pub(super) spacing: Option<f64>,
    /// A whole number, but perhaps one that no `usize` holds.
    pub(super) count: f64,
}

impl Axis {
    /// The grid of these coordinates: with the given spacing, else with the smallest step between two of them, refined over their whole range.
    pub(super) fn find(name: char, mut values: Vec<f64>, given: Option<f64>) -> Result<Self, Problem> {
        values.sort_unstable_by(f64::total_cmp);
        let (Some(&origin), Some(&last)) = (values.first(), values.last()) else {
            return Err(Problem::Empty);
        };
        let span = last - origin;
        if !span.is_finite() {
            return Err(Problem::Overflow { value: origin.abs().max(last.abs()) });
        }
        let spacing = match given {
            Some(spacing) => Some(spacing),
            None if span > 0.0 => Some(spacing(&values, span)),
            None => None,
        };
        let count = spacing.map_or(0.0, |s| (span / s).round()) + 1.0;
        if !count.is_finite() {
            return Err(Problem::Overflow { value: span });
        }
        let axis = Self { name, origin, spacing, count };
        for &value in &values {
            axis.place(value)?;
        }
        Ok(axis)
    }

    /// Number of the place of a coordinate.
    pub(super) fn index(&self, value: f64) -> Result<usize, Problem> {
        self.place(value).map(|place| place as usize)
    }

    fn place(&self, value: f64) -> Result<f64, Problem> {
        let Some(spacing) = self.spacing else { return Ok(0.0) };
        let place = (value - self.origin) / spacing;
        if (place - place.round()).abs() <= OFF {
            Ok(place.round())
        } else {
            Err(Problem::Irregular { axis: self.name, value, origin: self.origin, spacing })
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
