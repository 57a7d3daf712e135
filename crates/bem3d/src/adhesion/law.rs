//! The law of the attraction as a function of the gap.

use contact_model::AdhesionLaw;
use std::f64::consts::PI;

/// Beyond this many ranges the exponential attraction is taken as zero: it is below the rounding of the
/// largest traction, `exp(-36.7) = 2^-53`.
const FARTHEST: f64 = 36.7;

/// Traction in contact of a short range, in `sqrt(E* w/a)` with the longer side a of a cell; see
/// [`super::attraction`]. Larger values trap fronts between the rows of cells, smaller ones widen them.
const FRONT_TRACTION: f64 = 0.59;
/// Work of a short range over its peak times its range, `int_0^1 y (0.4 + 2.2 y - 1.6 y^2) dy`.
const FRONT_WORK: f64 = 8.0 / 15.0;

/// The shape of the law.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LawShape {
    /// `peak exp(-g/range)`.
    Exponential,
    /// `peak` below the range.
    Uniform,
    /// `peak y (0.4 + 2.2 y - 1.6 y^2)` below the range, with `y = 1 - g/range`: level in contact, with 0.4 of
    /// the slope of a line at the range.
    Smooth,
}

impl From<AdhesionLaw> for LawShape {
    fn from(law: AdhesionLaw) -> Self {
        if law == AdhesionLaw::Dugdale { Self::Uniform } else { Self::Exponential }
    }
}

/// The attractive traction of a gap, nondimensional.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AttractionLaw {
    /// Traction in contact.
    pub peak: f64,
    /// Range.
    pub range: f64,
    /// The shape of the law.
    pub shape: LawShape,
}

impl AttractionLaw {
    /// The law of a short range, of this work of adhesion over `pi E*` times the height on cells with this
    /// longer side.
    pub fn short(work: f64, side: f64) -> Self {
        let peak = FRONT_TRACTION * (work / (PI * side)).sqrt();
        Self { peak, range: work / (FRONT_WORK * peak), shape: LawShape::Smooth }
    }

    /// 1 in contact, 0 from the range on.
    fn nearness(self, gap: f64) -> f64 {
        (1.0 - gap / self.range).clamp(0.0, 1.0)
    }

    /// Traction of a gap; penetrations count as contact.
    pub fn traction(self, gap: f64) -> f64 {
        match self.shape {
            LawShape::Uniform if gap < self.range => self.peak,
            LawShape::Uniform => 0.0,
            LawShape::Smooth => {
                let y = self.nearness(gap);
                self.peak * y * (0.4 + y * (2.2 - 1.6 * y))
            }
            LawShape::Exponential => self.peak * (-gap.max(0.0) / self.range).exp(),
        }
    }

    /// Magnitude of the derivative of the traction; 0 for Dugdale's law away from its jump.
    pub fn slope(self, gap: f64) -> f64 {
        match self.shape {
            LawShape::Smooth if gap < self.range => {
                let y = self.nearness(gap);
                self.peak / self.range * (0.4 + y * (4.4 - 4.8 * y))
            }
            LawShape::Uniform | LawShape::Smooth => 0.0,
            LawShape::Exponential => self.traction(gap) / self.range,
        }
    }

    /// Energy per area, which is the work of adhesion below zero in contact and 0 far apart.
    pub fn energy(self, gap: f64) -> f64 {
        match self.shape {
            LawShape::Uniform => self.peak * (gap.max(0.0) - self.range).min(0.0),
            LawShape::Smooth => {
                let y = self.nearness(gap);
                -self.peak * self.range * y * y * (0.2 + y * (2.2 / 3.0 - 0.4 * y))
            }
            LawShape::Exponential => -self.range * self.traction(gap),
        }
    }

    /// Distance of a traction and a gap from the graph of the law: the difference of the tractions over the
    /// peak. At the jump of Dugdale's law every traction between both values is on the graph: there it is how
    /// far the gap lies beyond the range, in ranges, where that is less.
    pub fn mismatch(self, traction: f64, gap: f64) -> f64 {
        let difference = (traction - self.traction(gap)).abs() / self.peak;
        match self.shape {
            LawShape::Uniform => difference.min((gap / self.range - 1.0).abs()),
            _ => difference,
        }
    }

    /// The share of its work that a cell with this gap still holds: 1 in contact.
    pub fn attached(self, gap: f64) -> f64 {
        self.energy(gap) / self.energy(0.0)
    }

    /// The gap from which on there is no attraction.
    pub fn reach(self) -> f64 {
        match self.shape {
            LawShape::Uniform | LawShape::Smooth => self.range,
            LawShape::Exponential => FARTHEST * self.range,
        }
    }
}
