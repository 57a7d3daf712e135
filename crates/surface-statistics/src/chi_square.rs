//! Intervals of means of squares of Gaussian numbers.

use contact_model::{Error, Result};
use numerics::quantile::chi_square;

/// Factors by which a mean of squares with `freedom` degrees of freedom is multiplied to obtain the limits of
/// a confidence interval of its expected value, with the confidence `level`.
///
/// # Errors
/// [`Error::Domain`] for a level outside (0, 1) and degrees of freedom that are no positive number.
pub(crate) fn factors(freedom: f64, level: f64) -> Result<[f64; 2]> {
    if !(level > 0.0 && level < 1.0) {
        return Err(Error::domain("confidence level", level, "a number between 0 and 1"));
    }
    let tail = 0.5 * (1.0 - level);
    let quantile = |probability| {
        chi_square(freedom, probability)
            .ok_or_else(|| Error::domain("degrees of freedom", freedom, "a finite number > 0"))
    };
    Ok([freedom / quantile(1.0 - tail)?, freedom / quantile(tail)?])
}
