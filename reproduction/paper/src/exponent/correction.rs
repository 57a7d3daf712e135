//! A power law with a correction to scaling, k = zeta F^alpha (1 + c F^omega), by weighted least squares of
//! logarithms.
//!
//! For given omega and c the rest is a straight line. For given omega, c is found by the Gauss-Newton method
//! on the residuals of the line (variable projection, G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10,
//! 413 (1973)); omega is found by a scan of its range and golden sections about the best value.

/// The range of omega, the free exponent of the correction: below it, the correction is itself a power law
/// over the whole window; above it, a cut-off.
pub const OMEGA: [f64; 2] = [0.25, 2.0];
/// Values of omega in the scan, evenly spaced in its logarithm.
const SCAN: usize = 9;
/// Golden sections: omega to a thousandth of the spacing of the scan.
const SECTIONS: usize = 14;
/// Relative distance from an end of the range within which omega counts as lying there: golden sections stop
/// that far from it.
const AT_END: f64 = 1e-3;
/// Steps of Gauss and Newton, which converge within five or so.
const STEPS: usize = 40;
/// A step below this ends the iteration; it is far below every error of c.
const SMALL: f64 = 1e-9;

/// The fitted law.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Correction {
    /// Exponent alpha in the limit of zero force.
    pub alpha: f64,
    /// Factor zeta of the power law.
    pub zeta: f64,
    /// Factor of the correction.
    pub c: f64,
    /// Power of the correction.
    pub omega: f64,
    /// Weighted sum of the squared residuals of ln k.
    pub misfit: f64,
}

impl Correction {
    /// ln k of the law at ln F.
    pub fn ln_stiffness(&self, ln_force: f64) -> f64 {
        self.zeta.ln() + self.alpha * ln_force + (self.c * (self.omega * ln_force).exp()).ln_1p()
    }

    /// Whether omega lies at an end of its range, so that the fit asks for a law that it may not have.
    pub fn is_at_end(&self) -> bool {
        OMEGA.iter().any(|end| (self.omega / end - 1.0).abs() < AT_END)
    }
}

/// Points (ln F, ln k) with their weights, F increasing.
#[derive(Debug, Clone)]
pub struct Points {
    x: Vec<f64>,
    y: Vec<f64>,
    weights: Vec<f64>,
}

impl Points {
    /// `None` for unlike lengths, fewer points than five or a number that is not finite.
    pub fn new(x: Vec<f64>, y: Vec<f64>, weights: Vec<f64>) -> Option<Self> {
        let whole = x.len() == y.len() && x.len() == weights.len() && x.len() >= 5;
        let finite = [&x, &y, &weights].into_iter().flatten().all(|v| v.is_finite());
        (whole && finite).then_some(Self { x, y, weights })
    }

    /// The law that fits best, with this omega or, without one, with any omega in [`OMEGA`].
    pub fn fit(&self, omega: Option<f64>) -> Option<Correction> {
        if let Some(omega) = omega {
            return self.with(omega);
        }
        let [low, high] = OMEGA.map(f64::ln);
        let spacing = (high - low) / (SCAN - 1) as f64;
        let at = |ln_omega: f64| self.with(ln_omega.clamp(low, high).exp());
        let scan = (0..SCAN).filter_map(|i| Some((i, at(low + i as f64 * spacing)?)));
        let (best, mut found) = scan.min_by(|a, b| a.1.misfit.total_cmp(&b.1.misfit))?;
        let middle = low + best as f64 * spacing;
        let (mut a, mut b) = ((middle - spacing).max(low), (middle + spacing).min(high));
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let misfit = |law: &Option<Correction>| law.map_or(f64::INFINITY, |law| law.misfit);
        let (mut left, mut right) = (b - golden * (b - a), a + golden * (b - a));
        let (mut of_left, mut of_right) = (at(left), at(right));
        for _ in 0..SECTIONS {
            if misfit(&of_left) <= misfit(&of_right) {
                (b, right, of_right) = (right, left, of_left);
                left = b - golden * (b - a);
                of_left = at(left);
            } else {
                (a, left, of_left) = (left, right, of_right);
                right = a + golden * (b - a);
                of_right = at(right);
            }
        }
        for law in [of_left, of_right].into_iter().flatten() {
            if law.misfit < found.misfit {
                found = law;
            }
        }
        Some(found)
    }

    /// The law of one omega that fits best.
    fn with(&self, omega: f64) -> Option<Correction> {
        // Counted from the largest force, F^omega is at most 1 and c above -1.
        let top = *self.x.last()?;
        let powers: Vec<f64> = self.x.iter().map(|x| (omega * (x - top)).exp()).collect();
        let left = |c: f64| -> Vec<f64> {
            let terms = self.y.iter().zip(&powers).map(|(y, u)| y - (c * u).ln_1p());
            self.without_line(&terms.collect::<Vec<_>>()).0
        };
        let square = |r: &[f64]| self.product(r, r);
        let mut c = -0.3;
        let mut rest = left(c);
        for _ in 0..STEPS {
            let slopes: Vec<f64> = powers.iter().map(|u| u / (1.0 + c * u)).collect();
            let slopes = self.without_line(&slopes).0;
            let step = self.product(&slopes, &rest) / square(&slopes);
            if !step.is_finite() {
                return None;
            }
            let before = square(&rest);
            // Towards the edge of what c may be, and no farther than the misfit falls.
            let mut share = 1.0;
            let next = loop {
                let next = c + share * step;
                if next > -1.0 {
                    let there = left(next);
                    if square(&there) <= before {
                        rest = there;
                        break next;
                    }
                }
                share *= 0.5;
                if share < 1e-8 {
                    break c;
                }
            };
            let moved = (next - c).abs();
            c = next;
            if moved <= SMALL * (1.0 + c.abs()) {
                break;
            }
        }
        let terms: Vec<f64> = self.y.iter().zip(&powers).map(|(y, u)| y - (c * u).ln_1p()).collect();
        let (rest, [intercept, alpha]) = self.without_line(&terms);
        let law = Correction {
            alpha,
            zeta: intercept.exp(),
            c: c * (-omega * top).exp(),
            omega,
            misfit: square(&rest),
        };
        [law.alpha, law.zeta, law.c, law.misfit].iter().all(|v| v.is_finite()).then_some(law)
    }

    /// The residuals of a straight line over ln F, and its intercept and slope.
    fn without_line(&self, of: &[f64]) -> (Vec<f64>, [f64; 2]) {
        let all: f64 = self.weights.iter().sum();
        let mean = |v: &[f64]| v.iter().zip(&self.weights).map(|(v, w)| v * w).sum::<f64>() / all;
        let (x0, y0) = (mean(&self.x), mean(of));
        let (mut xx, mut xy) = (0.0, 0.0);
        for ((x, y), w) in self.x.iter().zip(of).zip(&self.weights) {
            xx += w * (x - x0) * (x - x0);
            xy += w * (x - x0) * (y - y0);
        }
        let slope = xy / xx;
        let rest = self.x.iter().zip(of).map(|(x, y)| y - y0 - slope * (x - x0)).collect();
        (rest, [y0 - slope * x0, slope])
    }

    fn product(&self, a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).zip(&self.weights).map(|((a, b), w)| a * b * w).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of an exact law, six per decade over five decades, with different weights.
    fn points([alpha, zeta, c, omega]: [f64; 4]) -> Points {
        let x: Vec<f64> = (0..31).map(|i| (1e-6_f64).ln() + f64::from(i) * 10_f64.ln() / 6.0).collect();
        let y = x.iter().map(|x| zeta.ln() + alpha * x + (c * (omega * x).exp()).ln_1p()).collect();
        let weights = (0..31).map(|i| 1.0 + f64::from(i % 3)).collect();
        Points::new(x, y, weights).unwrap()
    }

    #[test]
    fn the_law_behind_exact_points_is_found() {
        for law in
            [[0.6, 0.8, -0.4, 0.5], [0.714, 1.1, -1.5, 1.2], [0.5, 0.7, 0.6, 0.3], [0.9, 1.0, -0.6, 0.28]]
        {
            let [alpha, zeta, c, omega] = law;
            let free = points(law).fit(None).unwrap();
            let close = |a: f64, b: f64, by: f64| (a - b).abs() < by;
            assert!(close(free.alpha, alpha, 2e-4) && close(free.omega, omega, 2e-3), "{law:?}: {free:?}");
            assert!(!free.is_at_end() && close(free.ln_stiffness(points(law).x[7]), points(law).y[7], 1e-4));
            let fixed = points(law).fit(Some(omega)).unwrap();
            assert!(close(fixed.alpha, alpha, 1e-9) && close(fixed.c, c, 1e-7), "{law:?}: {fixed:?}");
            assert!(close(fixed.zeta, zeta, 1e-8) && fixed.misfit < 1e-18, "{law:?}: {fixed:?}");
        }
    }

    #[test]
    fn no_other_law_fits_better() {
        let exact = points([0.65, 0.9, -0.5, 0.45]);
        let bent: Vec<f64> = exact.y.iter().enumerate().map(|(i, y)| y + 0.01 * (i as f64).sin()).collect();
        let points = Points::new(exact.x.clone(), bent, exact.weights.clone()).unwrap();
        let found = points.fit(None).unwrap();
        let misfit = |alpha: f64, zeta: f64, c: f64, omega: f64| -> f64 {
            let law = |x: f64| zeta.ln() + alpha * x + (c * (omega * x).exp()).ln_1p();
            let rest = points.x.iter().zip(&points.y).map(|(x, y)| y - law(*x));
            rest.zip(&points.weights).map(|(r, w)| w * r * r).sum()
        };
        let Correction { alpha, zeta, c, omega, .. } = found;
        let least = misfit(alpha, zeta, c, omega);
        assert!((least - found.misfit).abs() < 1e-12);
        for by in [1e-3, -1e-3] {
            for other in [
                misfit(alpha + by, zeta, c, omega),
                misfit(alpha, zeta * (1.0 + by), c, omega),
                misfit(alpha, zeta, c * (1.0 + by), omega),
                misfit(alpha, zeta, c, omega * (1.0 + 10.0 * by)),
            ] {
                assert!(other > least - 1e-12, "{other} {least}");
            }
        }
    }

    #[test]
    fn few_points_and_bad_numbers_have_no_law() {
        assert!(Points::new(vec![0.0; 4], vec![0.0; 4], vec![1.0; 4]).is_none());
        assert!(Points::new(vec![0.0; 5], vec![f64::NAN; 5], vec![1.0; 5]).is_none());
        // All at one force.
        let same = Points::new(vec![0.0; 6], vec![1.0; 6], vec![1.0; 6]).unwrap();
        assert_eq!(same.fit(None), None);
    }
}
