//! How well a pressure satisfies the contact conditions, from the exact gap.

/// The numbers of [`contact_model::Certificate`] that do not concern the load or the stiffness.
#[derive(Debug, Clone, Copy, Default)]
pub struct Evidence {
    /// `sum p (g - min g) / (F s)`.
    pub duality_gap: f64,
    /// `max(0, -min g) / s`.
    pub penetration: f64,
    /// `sum p |g| / (F s)`.
    pub complementarity: f64,
    /// `max(0, -min g)`, a length.
    pub deepest: f64,
}

impl Evidence {
    /// The largest of the relative numbers.
    pub fn worst(&self) -> f64 {
        self.duality_gap.max(self.penetration).max(self.complementarity)
    }
}

/// Measures a pressure and its gap on the candidates against the length `s`.
///
/// The gap is positive on all other cells of the grid, so that its minimum over the candidates is the minimum of all.
pub fn measure(p: &[f64], gap: &[f64], s: f64) -> Evidence {
    let lowest = gap.iter().copied().fold(f64::INFINITY, f64::min);
    let force: f64 = p.iter().sum();
    let deepest = (-lowest).max(0.0);
    if force <= 0.0 {
        // Nothing presses yet: only the penetration says anything.
        return Evidence { penetration: deepest / s, deepest, ..Evidence::default() };
    }
    let (mut weighted, mut duality) = (0.0, 0.0);
    for (&p, &g) in p.iter().zip(gap) {
        // Shares of the force, so that no product of two tiny or two huge numbers is ever formed.
        let share = p / force;
        weighted += share * g.abs();
        duality += share * (g - lowest);
    }
    Evidence { duality_gap: duality / s, penetration: deepest / s, complementarity: weighted / s, deepest }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn by_hand() {
        // p = (2, 1, 0), gap (0.1, -0.2, 0.5), s = 2: force 3, lowest -0.2.
        let e = measure(&[2.0, 1.0, 0.0], &[0.1, -0.2, 0.5], 2.0);
        assert_relative_eq!(e.duality_gap, (2.0 * 0.3) / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.complementarity, 0.4 / 6.0, max_relative = 1e-14);
        assert_relative_eq!(e.penetration, 0.1, max_relative = 1e-14);
        assert_relative_eq!(e.worst(), 0.1, max_relative = 1e-14);
    }

    #[test]
    fn nothing_pressed_is_only_penetration() {
        let e = measure(&[0.0, 0.0], &[-1.0, 2.0], 4.0);
        assert_relative_eq!(e.worst(), 0.25, max_relative = 1e-14);
        assert_relative_eq!(e.deepest, 1.0, max_relative = 1e-14);
    }
}
