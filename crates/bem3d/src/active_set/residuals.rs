//! How well a pressure satisfies the contact conditions (KKT), from its gap.

use super::bounds::{Bounds, Extremes};
use crate::geometry::CellSet;
use crate::law::ConvexLaw;
use crate::real::{sum, sum_of_pairs};
use serde::{Deserialize, Serialize};

/// A gap on all cells that could touch, and what is left of it on the contact.
#[derive(Debug, Clone, Copy)]
pub struct ContactGap<'a> {
    /// The contact set.
    pub contact: &'a CellSet,
    /// Gap left on it.
    pub left: &'a [f64],
    /// The cells that could touch, the contact set among them.
    pub checked: &'a CellSet,
    /// Gap on them.
    pub gap: &'a [f64],
}

/// The residuals of [`contact_model::Certificate`] other than those of the load and of the stiffness.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Residuals {
    /// `(sum p g - min sum q g) / (F s)` over all q between the bounds with the same sum F: without an upper
    /// bound the minimum is `F min g`.
    pub duality_gap: f64,
    /// `max(0, -min g) / s`; a gap of a cell at its upper bound counts as a penetration does elsewhere.
    pub penetration: f64,
    /// `sum p |g| / (F s)`, without the indentation of cells at their upper bound.
    pub complementarity: f64,
    /// The penetration as a length.
    pub deepest: f64,
}

impl Residuals {
    /// The largest of the relative numbers.
    pub fn worst(&self) -> f64 {
        self.duality_gap.max(self.penetration).max(self.complementarity)
    }

    /// Residuals of a pressure `p` on a contact set, from the gap under it. Gaps are compared with the length
    /// `s`.
    ///
    /// Outside the candidates the gap is positive, so that their minimum is the minimum of all.
    pub fn measure(bounds: Bounds, p: &[f64], under: ContactGap<'_>, s: f64) -> Self {
        let ContactGap { contact, left, checked, gap } = under;
        let force = sum(p);
        let Extremes { deepest, level, unfilled } = bounds.extremes(force, (contact, p), (checked, gap));
        if force <= 0.0 {
            // No pressure yet: only the penetration has a meaning.
            return Self { penetration: deepest / s, deepest, ..Self::default() };
        }
        // Shares of the force, so that no product of two tiny or two huge numbers is ever formed.
        let weighted = sum_of_pairs(p, left, |p, g| p / force * bounds.violation(p, g));
        let law = bounds.scaled(force.recip()).law();
        let duality = sum_of_pairs(p, left, |p, g| law.excess(0, [p / force], [level - g])) + unfilled;
        Self { duality_gap: duality / s, penetration: deepest / s, complementarity: weighted / s, deepest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{CellSet, Grid};
    use approx::assert_relative_eq;

    /// Residuals on a row of cells.
    fn measured(bounds: Bounds, p: &[f64], gap: &[f64], s: f64) -> Residuals {
        let everywhere = CellSet::all(Grid::square(p.len(), 1));
        let contact = everywhere.filter(p, |p| p > 0.0);
        let pressed: Vec<f64> = p.iter().copied().filter(|p| *p > 0.0).collect();
        let left = contact.carry(&everywhere, gap);
        let under = ContactGap { contact: &contact, left: &left, checked: &everywhere, gap };
        Residuals::measure(bounds, &pressed, under, s)
    }

    #[test]
    fn by_hand() {
        // p = (2, 1), gap (0.1, -0.2) on them and 0.5 beside, s = 2: force 3, lowest -0.2.
        let e = measured(Bounds::Unlimited, &[2.0, 1.0, 0.0], &[0.1, -0.2, 0.5], 2.0);
        assert_relative_eq!(e.duality_gap, (2.0 * 0.3) / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.complementarity, 0.4 / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.penetration, 0.1, max_relative = 1e-14);
        assert_relative_eq!(e.worst(), 0.1, max_relative = 1e-14);
    }

    #[test]
    fn without_pressure_there_is_only_penetration() {
        let e = measured(Bounds::Unlimited, &[0.0], &[-1.0], 4.0);
        assert_relative_eq!(e.worst(), 0.25, max_relative = 1e-14);
        assert_relative_eq!(e.deepest, 1.0, max_relative = 1e-14);
    }

    #[test]
    fn with_an_upper_bound_by_hand() {
        // p_s = 1: a cell at its bound indented by 0.2, a free one with a gap of 0.1, one open by 0.4; F =
        // 1.5, s = 2.
        let e = measured(Bounds::UpTo(1.0), &[1.0, 0.5, 0.0], &[-0.2, 0.1, 0.4], 2.0);
        assert_relative_eq!(e.complementarity, 0.5 * 0.1 / 1.5 / 2.0, max_relative = 1e-14);
        assert!(e.penetration == 0.0 && e.duality_gap == 0.0);
        // The open cell penetrates by more than the one at its bound: the best q has it at p_s and half of
        // the one at its bound.
        let e = measured(Bounds::UpTo(1.0), &[1.0, 0.5, 0.0], &[-0.2, 0.1, -0.4], 2.0);
        assert_relative_eq!(e.penetration, 0.2, max_relative = 1e-14);
        assert_relative_eq!(e.duality_gap, (-0.2 + 0.05 - (-0.4 - 0.1)) / 1.5 / 2.0, max_relative = 1e-14);
        // A gap under a cell at its bound counts twice.
        let e = measured(Bounds::UpTo(1.0), &[1.0, 0.5, 0.0], &[0.3, 0.0, 0.4], 2.0);
        assert_relative_eq!(e.penetration, 0.15, max_relative = 1e-14);
        assert_relative_eq!(e.complementarity, 0.3 / 1.5 / 2.0, max_relative = 1e-14);
    }
}
