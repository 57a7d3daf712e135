//! Intervals of means of squares of Gaussian numbers.

use contact_model::{Error, Result};
use statrs::distribution::{ChiSquared, ContinuousCDF as _};

/// Beyond so many degrees of freedom the normal law stands for the chi-square law.
const MANY: f64 = 1e4;
/// Least quantile of the chi-square law that is looked for, and halvings of the logarithm of a range of 1e30
/// down to rounding.
const LEAST: f64 = 1e-25;
const HALVINGS: usize = 56;

/// What a mean of squares with so many degrees of freedom is multiplied by for the limits between which the expected value lies with the
/// probability `level`.
///
/// # Errors
/// [`Error::Domain`] for a level outside (0, 1) and degrees of freedom that are no positive number.
pub(crate) fn factors(freedom: f64, level: f64) -> Result<[f64; 2]> {
    if !(level > 0.0 && level < 1.0) {
        return Err(Error::domain("confidence level", level, "a number between 0 and 1"));
    }
    let tail = 0.5 * (1.0 - level);
    Ok([freedom / quantile(freedom, 1.0 - tail)?, freedom / quantile(freedom, tail)?])
}

/// Quantile of the chi-square law.
fn quantile(freedom: f64, probability: f64) -> Result<f64> {
    if freedom > MANY {
        // Wilson and Hilferty (1931); its relative error is below 1e-6 here.
        let z = crate::normal::quantile(probability);
        let c = 2.0 / (9.0 * freedom);
        return Ok(freedom * (1.0 - c + z * c.sqrt()).powi(3));
    }
    let law = ChiSquared::new(freedom)
        .map_err(|_| Error::domain("degrees of freedom", freedom, "a finite number > 0"))?;
    // By halving in ln x: the library's own search gives NaN below two degrees of freedom.
    let (mut low, mut high) = (LEAST.ln(), (freedom + 10.0).ln() + 3.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if law.cdf(middle.exp()) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok((0.5 * (low + high)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn quantiles_of_few_degrees_of_freedom() {
        // Squares of the normal quantiles 0.5125 and 0.9875; -2 ln(1 - p).
        assert_relative_eq!(quantile(1.0, 0.025).unwrap(), 9.820_691_171_752_58e-4, max_relative = 1e-6);
        assert_relative_eq!(quantile(1.0, 0.975).unwrap(), 5.023_886_187_314_888, max_relative = 1e-6);
        assert_relative_eq!(quantile(2.0, 0.025).unwrap(), -2.0 * 0.975_f64.ln(), max_relative = 1e-6);
    }

    #[test]
    fn quantiles_join() {
        for probability in [0.025, 0.5, 0.975] {
            let exact = quantile(MANY, probability).unwrap();
            assert_relative_eq!(quantile(MANY * 1.000_001, probability).unwrap(), exact, max_relative = 1e-5);
        }
    }
}
