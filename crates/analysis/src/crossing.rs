//! The point where curves of different fractal dimension come closest.

use numerics::regression::least_squares;
use numerics::sum::sum;

/// A point of the (F_bar, k_bar) plane, with the spread of the curves there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// `F_bar` of least spread.
    pub force_bar: f64,
    /// Mean `k_bar` of the curves there (geometric for [`crossing`], arithmetic for [`least_spread`]).
    pub stiffness_bar: f64,
    /// Relative spread: standard deviation of ln k_bar, or of k_bar over its mean.
    pub spread: f64,
}

/// The point in which the laws `k_bar = zeta F_bar^alpha` come closest: the F_bar that makes the standard
/// deviation of `ln zeta + alpha ln F_bar` over the laws least, `ln F_bar = -cov(alpha, ln zeta)/var(alpha)`.
///
/// `laws` holds (alpha, zeta). `None` for fewer than two different exponents. Source: the intersection that
/// fixes zeta in Eq. 11.
///
/// ```
/// let law = |a: f64| (a, 0.18 / 0.086_f64.powf(a));
/// let c = analysis::crossing(&[law(0.5), law(0.6), law(0.8)]).unwrap();
/// assert!((c.force_bar - 0.086).abs() < 1e-12 && (c.stiffness_bar - 0.18).abs() < 1e-12 && c.spread < 1e-12);
/// ```
pub fn crossing(laws: &[(f64, f64)]) -> Option<Crossing> {
    let points: Vec<(f64, f64)> = laws.iter().map(|&(alpha, zeta)| (alpha, zeta.ln())).collect();
    // ln zeta = ln k* - alpha ln F*: a straight line over alpha.
    let (slope, intercept) = least_squares(&points)?;
    let residual = sum(points.iter().map(|&(a, z)| (z - intercept - slope * a).powi(2)));
    let crossing = Crossing {
        force_bar: (-slope).exp(),
        stiffness_bar: intercept.exp(),
        spread: (residual / points.len() as f64).sqrt(),
    };
    [crossing.force_bar, crossing.stiffness_bar, crossing.spread]
        .iter()
        .all(|v| v.is_finite())
        .then_some(crossing)
}

/// The force within `min..=max` at which the relative spread of k_bar over the curves is least (no
/// interpolation).
///
/// Each curve has one entry per force. `None` when no force of the range has two or more curves. Choose the
/// range with care: the curves also meet on the plateau and on the one-cell floor.
pub fn least_spread(force_bar: &[f64], curves: &[Vec<Option<f64>>], min: f64, max: f64) -> Option<Crossing> {
    (force_bar.iter().enumerate())
        .filter(|(_, f)| (min..=max).contains(*f))
        .filter_map(|(j, &force_bar)| {
            let k: Vec<f64> = curves.iter().filter_map(|c| c.get(j).copied().flatten()).collect();
            let mean = sum(k.iter().copied()) / k.len() as f64;
            let variance = sum(k.iter().map(|k| (k - mean) * (k - mean))) / (k.len() as f64 - 1.0);
            let spread = variance.sqrt() / mean;
            (k.len() > 1 && spread.is_finite()).then_some(Crossing { force_bar, stiffness_bar: mean, spread })
        })
        .min_by(|a, b| a.spread.total_cmp(&b.spread))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn one_exponent_has_no_crossing() {
        assert_eq!(crossing(&[]), None);
        assert_eq!(crossing(&[(0.5, 1.0)]), None);
        assert_eq!(crossing(&[(0.5, 1.0), (0.5, 2.0)]), None);
        assert_eq!(crossing(&[(0.5, 0.0), (0.6, 2.0)]), None);
    }

    #[test]
    fn the_curves_meet_where_they_are_made_to() {
        let force: Vec<f64> = (0..9).map(|j| 10f64.powi(j - 6)).collect();
        let curves: Vec<Vec<Option<f64>>> = [0.5, 0.7]
            .iter()
            .map(|a| force.iter().map(|f| Some(0.18 * (f / 1e-2).powf(*a))).collect())
            .collect();
        let c = least_spread(&force, &curves, 0.0, f64::INFINITY).unwrap();
        assert_relative_eq!(c.force_bar, 1e-2);
        assert_relative_eq!(c.stiffness_bar, 0.18);
        assert_eq!(least_spread(&force, &curves[..1], 0.0, 1.0), None);
        assert_eq!(least_spread(&force, &curves, 1e3, 1e4), None);
    }
}
