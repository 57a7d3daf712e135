//! A quantity between two bounds.

use contact_model::{Error, Result};

/// Two numbers between which a conductance or a flow lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FlowBounds {
    /// It is not smaller than this.
    pub lower: f64,
    /// It is not larger than this.
    pub upper: f64,
}

impl FlowBounds {
    /// Exactly zero.
    pub const ZERO: Self = Self { lower: 0.0, upper: 0.0 };

    /// The number in the middle.
    pub fn middle(self) -> f64 {
        self.lower + 0.5 * (self.upper - self.lower)
    }

    /// The difference of the bounds over the upper one; 0 where both are the same.
    pub fn relative_width(self) -> f64 {
        if self.upper > self.lower { (self.upper - self.lower) / self.upper } else { 0.0 }
    }

    /// The same, or no lower bound where the two contradict each other: the contrast is then beyond what potentials of
    /// twice the working precision hold.
    pub(super) fn consistent(self) -> Self {
        if self.lower <= self.upper { self } else { Self { lower: 0.0, upper: self.lower } }
    }

    /// Whether a number lies between them.
    pub fn contains(self, value: f64) -> bool {
        (self.lower..=self.upper).contains(&value)
    }

    /// Both bounds times a positive number, rounded outwards.
    pub(super) fn scaled(self, factor: f64) -> Self {
        let Self { lower, upper } = self;
        Self {
            lower: if lower > 0.0 { (lower * factor).next_down().max(0.0) } else { 0.0 },
            upper: if upper > 0.0 { (upper * factor).next_up() } else { 0.0 },
        }
    }

    /// # Errors
    /// [`Error::Domain`] where a bound has overflown.
    pub(super) fn finite(self, name: &'static str) -> Result<Self> {
        if self.upper.is_finite() { Ok(self) } else { Err(Error::not_representable(name, self.upper)) }
    }
}
