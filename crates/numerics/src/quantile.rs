//! Quantiles of the normal law, of Student's and of the chi-square distribution.
//!
//! The inverse distribution functions of `statrs` 0.18 return NaN (chi-square below two degrees of freedom)
//! or do not terminate (Student's for some degrees of freedom). These two are therefore found by bisection of
//! its distribution functions, which are correct.

use crate::root::bisect;
use statrs::distribution::{ChiSquared, ContinuousCDF as _, Normal, StudentsT};

/// The standard normal quantile; probabilities inside (0, 1).
///
/// ```
/// assert!((numerics::quantile::normal(0.975) - 1.959_964).abs() < 1e-6);
/// ```
pub fn normal(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}

/// 97.5 % quantile of Student's distribution: half-width of a 95 % interval in standard errors. Below one
/// degree of freedom it is the quantile of one.
///
/// ```
/// assert!((numerics::quantile::student(4.0) - 2.776_445).abs() < 1e-6);
/// ```
pub fn student(degrees_of_freedom: f64) -> f64 {
    // Beyond a million, the normal one to seven digits.
    let Ok(distribution) = StudentsT::new(0.0, 1.0, degrees_of_freedom.clamp(1.0, 1e6)) else {
        return f64::INFINITY;
    };
    // Between the normal quantile and that of one degree, down to rounding.
    let [low, high] = bisect(1.9, 12.8, 60, |x| distribution.cdf(x) < 0.975);
    f64::midpoint(low, high)
}

/// Quantile of Student's distribution, for probabilities in [0.5, 1): half-width in standard errors of the
/// two-sided interval of confidence `2 probability - 1`. Below one degree of freedom it is the quantile of
/// one.
///
/// ```
/// assert!((numerics::quantile::student_at(0.995, 4.0) - 4.604_095).abs() < 1e-5);
/// ```
pub fn student_at(probability: f64, degrees_of_freedom: f64) -> f64 {
    let Ok(distribution) = StudentsT::new(0.0, 1.0, degrees_of_freedom.clamp(1.0, 1e6)) else {
        return f64::INFINITY;
    };
    // That of one degree of freedom is the largest.
    let most = (std::f64::consts::PI * (probability - 0.5)).tan() + 1.0;
    let [low, high] = bisect(0.0, most, 60, |x| distribution.cdf(x) < probability);
    f64::midpoint(low, high)
}

/// Two-sided tail probability of Student's distribution: that a variable is farther from 0 than `t`.
///
/// ```
/// assert!((numerics::quantile::student_beyond(2.776_445, 4.0) - 0.05).abs() < 1e-6);
/// ```
pub fn student_beyond(t: f64, degrees_of_freedom: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees_of_freedom.clamp(1.0, 1e6)).map_or(1.0, |law| 2.0 * law.sf(t.abs()))
}

/// Quantile of the chi-square distribution to a relative error of 1e-6; `None` for degrees of freedom that
/// are no positive number.
///
/// ```
/// let (freedom, probability) = (2.0, 0.025_f64);
/// // -2 ln(1 - p) for two degrees of freedom.
/// assert!((numerics::quantile::chi_square(freedom, probability).unwrap() + 2.0 * (-probability).ln_1p()).abs() < 1e-6);
/// ```
pub fn chi_square(degrees_of_freedom: f64, probability: f64) -> Option<f64> {
    /// Above this number of degrees of freedom the quantile is approximated through that of the normal law.
    const MANY: f64 = 1e4;
    /// Smallest quantile that is searched for.
    const LEAST: f64 = 1e-25;
    const HALVINGS: usize = 56;
    if degrees_of_freedom > MANY {
        // Wilson and Hilferty (1931); its relative error is below 1e-6 here.
        let z = normal(probability);
        let c = 2.0 / (9.0 * degrees_of_freedom);
        return Some(degrees_of_freedom * (1.0 - c + z * c.sqrt()).powi(3));
    }
    let law = ChiSquared::new(degrees_of_freedom).ok()?;
    let last = (degrees_of_freedom + 10.0).ln() + 3.0;
    let [low, high] = bisect(LEAST.ln(), last, HALVINGS, |x| law.cdf(x.exp()) < probability);
    Some(f64::midpoint(low, high).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn students_fall_with_the_degrees_of_freedom_for_every_number_of_them() {
        let degrees = (0..2000).map(|i| 10_f64.powf(f64::from(i) * 0.004));
        let all: Vec<f64> = degrees.map(student).collect();
        assert!(all.windows(2).all(|pair| pair[1] <= pair[0] + 1e-9));
        assert_relative_eq!(all[0], 12.706_204_7, max_relative = 1e-7);
        assert_relative_eq!(student(f64::MAX), 1.959_964, max_relative = 1e-5);
        assert!(student(f64::NAN).is_infinite());
    }

    #[test]
    fn chi_squares_of_few_degrees_of_freedom() {
        // Squares of the normal quantiles 0.5125 and 0.9875; -2 ln(1 - p).
        let quantile = |freedom, probability| chi_square(freedom, probability).unwrap();
        assert_relative_eq!(quantile(1.0, 0.025), 9.820_691_171_752_58e-4, max_relative = 1e-6);
        assert_relative_eq!(quantile(1.0, 0.975), 5.023_886_187_314_888, max_relative = 1e-6);
        assert_relative_eq!(quantile(2.0, 0.025), -2.0 * 0.975_f64.ln(), max_relative = 1e-6);
        assert_eq!([0.0, -1.0, f64::NAN].map(|freedom| chi_square(freedom, 0.5)), [None; 3]);
    }

    #[test]
    fn chi_squares_join_the_normal_law() {
        for probability in [0.025, 0.5, 0.975] {
            let exact = chi_square(1e4, probability).unwrap();
            assert_relative_eq!(
                chi_square(1e4 * 1.000_001, probability).unwrap(),
                exact,
                max_relative = 1e-5
            );
        }
    }
}
