//! Integrals of smooth functions: the rule of Gauss and Legendre.

/// The rule with `POINTS` points, which is exact for polynomials up to degree `2 POINTS - 1`.
#[derive(Debug, Clone, Copy)]
pub struct Gauss<const POINTS: usize> {
    nodes: [(f64, f64); POINTS],
}

impl<const POINTS: usize> Default for Gauss<POINTS> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const POINTS: usize> Gauss<POINTS> {
    /// Computes the nodes as roots of the Legendre polynomial, by Newton's method on its recurrence.
    pub fn new() -> Self {
        let mut nodes = [(0.0, 0.0); POINTS];
        let n = POINTS as f64;
        for (i, node) in nodes.iter_mut().enumerate() {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n + 0.5)).cos();
            let mut slope = 1.0;
            // Quadratic from a start good to three digits.
            for _ in 0..6 {
                let (mut last, mut value) = (1.0, x);
                for k in 2..=POINTS {
                    let k = k as f64;
                    (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
                }
                slope = n * (x * value - last) / (x * x - 1.0);
                x -= value / slope;
            }
            *node = (x, 2.0 / ((1.0 - x * x) * slope * slope));
        }
        Self { nodes }
    }

    /// Points and weights on [-1, 1], from the largest point.
    pub fn nodes(&self) -> &[(f64, f64); POINTS] {
        &self.nodes
    }

    /// Points and weights on an interval.
    pub fn on(&self, low: f64, high: f64) -> impl Iterator<Item = (f64, f64)> + '_ {
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        self.nodes.iter().map(move |(x, weight)| (middle + half * x, half * weight))
    }

    /// Integral over an interval.
    pub fn integrate(&self, low: f64, high: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
        self.on(low, high).map(|(x, weight)| weight * function(x)).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn polynomials_and_a_root() {
        let gauss = Gauss::<16>::new();
        for degree in [0, 1, 2, 17, 30, 31] {
            let exact = (2.0_f64.powi(degree + 1) - 1.0) / f64::from(degree + 1);
            assert_relative_eq!(gauss.integrate(1.0, 2.0, |x| x.powi(degree)), exact, max_relative = 1e-14);
        }
        // x^32 is not exact any more, by 1e-10 on [-1, 1].
        let error = gauss.integrate(-1.0, 1.0, |x| x.powi(32)) - 2.0 / 33.0;
        assert!((1e-12..1e-7).contains(&error.abs()), "{error}");
    }
}
