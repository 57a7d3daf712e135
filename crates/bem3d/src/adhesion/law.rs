//! How the attraction falls with the gap.

use contact_model::AdhesionLaw;

/// Gaps beyond so many ranges feel no exponential attraction: below the rounding of the largest traction, `exp(-36.7) = 2^-53`.
const FARTHEST: f64 = 36.7;

/// The attractive traction of a gap, nondimensional.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Law {
    /// Traction in contact, work over range.
    pub peak: f64,
    /// Range.
    pub range: f64,
    /// How it falls.
    pub kind: AdhesionLaw,
}

impl Law {
    /// Traction of a gap; penetrations count as contact.
    pub fn traction(self, gap: f64) -> f64 {
        match self.kind {
            AdhesionLaw::Dugdale => {
                if gap < self.range {
                    self.peak
                } else {
                    0.0
                }
            }
            _ => self.peak * (-gap.max(0.0) / self.range).exp(),
        }
    }

    /// Magnitude of the derivative of the traction; 0 for Dugdale's law away from its jump.
    pub fn slope(self, gap: f64) -> f64 {
        match self.kind {
            AdhesionLaw::Dugdale => 0.0,
            _ => self.traction(gap) / self.range,
        }
    }

    /// Energy per area, which is the work of adhesion below zero in contact and 0 far apart.
    pub fn energy(self, gap: f64) -> f64 {
        match self.kind {
            AdhesionLaw::Dugdale => self.peak * (gap.max(0.0) - self.range).min(0.0),
            _ => -self.range * self.traction(gap),
        }
    }

    /// Distance of a traction and a gap from the graph of the law: the difference of the tractions over the peak. At the jump of Dugdale's
    /// law every traction between both values is on the graph: there it is how far the gap lies beyond the range, in ranges, where that is
    /// less.
    pub fn mismatch(self, traction: f64, gap: f64) -> f64 {
        let difference = (traction - self.traction(gap)).abs() / self.peak;
        match self.kind {
            AdhesionLaw::Dugdale => difference.min((gap / self.range - 1.0).abs()),
            _ => difference,
        }
    }

    /// The gap from which on there is no attraction.
    pub fn reach(self) -> f64 {
        match self.kind {
            AdhesionLaw::Dugdale => self.range,
            _ => FARTHEST * self.range,
        }
    }
}
