//! How well a pressure satisfies the contact conditions (KKT), from its gap.

use crate::real::{sum, sum_of_pairs};

/// The numbers of [`contact_model::Certificate`] that do not concern the load or the stiffness.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Residuals {
    /// `sum p (g - min g) / (F s)`.
    pub duality_gap: f64,
    /// `max(0, -min g) / s`.
    pub penetration: f64,
    /// `sum p |g| / (F s)`.
    pub complementarity: f64,
    /// `max(0, -min g)`, a length.
    pub deepest: f64,
}

impl Residuals {
    /// The largest of the relative numbers.
    pub fn worst(&self) -> f64 {
        self.duality_gap.max(self.penetration).max(self.complementarity)
    }

    /// Residuals of a pressure `p` with the gap `gap` on the cells in contact, the lowest gap anywhere, and the length `s` that gaps are
    /// compared with.
    ///
    /// Outside the candidates the gap is positive, so that their minimum is the minimum of all.
    pub fn measure(p: &[f64], gap: &[f64], lowest: f64, s: f64) -> Self {
        let deepest = (-lowest).max(0.0);
        let force = sum(p);
        if force <= 0.0 {
            // No pressure yet: only the penetration has a meaning.
            return Self { penetration: deepest / s, deepest, ..Self::default() };
        }
        // Shares of the force, so that no product of two tiny or two huge numbers is ever formed.
        let weighted = sum_of_pairs(p, gap, |p, g| p / force * g.abs());
        let duality = sum_of_pairs(p, gap, |p, g| p / force * (g - lowest));
        Self { duality_gap: duality / s, penetration: deepest / s, complementarity: weighted / s, deepest }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn by_hand() {
        // p = (2, 1), gap (0.1, -0.2) on them and 0.5 beside, s = 2: force 3, lowest -0.2.
        let e = Residuals::measure(&[2.0, 1.0], &[0.1, -0.2], -0.2, 2.0);
        assert_relative_eq!(e.duality_gap, (2.0 * 0.3) / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.complementarity, 0.4 / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.penetration, 0.1, max_relative = 1e-14);
        assert_relative_eq!(e.worst(), 0.1, max_relative = 1e-14);
    }

    #[test]
    fn without_pressure_there_is_only_penetration() {
        let e = Residuals::measure(&[0.0], &[-1.0], -1.0, 4.0);
        assert_relative_eq!(e.worst(), 0.25, max_relative = 1e-14);
        assert_relative_eq!(e.deepest, 1.0, max_relative = 1e-14);
    }
}
