//! Quantiles of the normal law.

use statrs::distribution::{ContinuousCDF as _, Normal};

/// The standard normal quantile; probabilities inside (0, 1).
pub(crate) fn quantile(probability: f64) -> f64 {
    Normal::standard().inverse_cdf(probability)
}
