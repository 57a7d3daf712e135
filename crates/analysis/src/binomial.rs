//! The exact binomial test.

use statrs::distribution::{Binomial, DiscreteCDF as _};

/// Two-sided p-value of the hypothesis that each trial succeeds with the probability `share`: twice the
/// probability (at most 1) of a number of successes at least as far from `share * trials`, on the same side.
/// It is 0 for a share outside 0 to 1.
///
/// ```
/// use analysis::binomial_test;
/// // That all of 20 lie inside a 95 % interval is not significant; that all of 200 do is.
/// assert!((binomial_test(20, 20, 0.95) - 2.0 * 0.95_f64.powi(20)).abs() < 1e-12);
/// assert!(binomial_test(200, 200, 0.95) < 0.01 && binomial_test(190, 200, 0.95) > 0.9);
/// ```
pub fn binomial_test(successes: usize, trials: usize, share: f64) -> f64 {
    let Ok(distribution) = Binomial::new(share, trials as u64) else { return 0.0 };
    let below = distribution.cdf(successes as u64);
    let above = successes.checked_sub(1).map_or(1.0, |fewer| distribution.sf(fewer as u64));
    (2.0 * f64::min(below, above)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn tails_by_hand() {
        // Of 4 throws of a coin: none 1/16, one 4/16, two 6/16.
        assert_relative_eq!(binomial_test(0, 4, 0.5), 2.0 / 16.0, max_relative = 1e-14);
        assert_relative_eq!(binomial_test(3, 4, 0.5), 10.0 / 16.0, max_relative = 1e-14);
        assert_relative_eq!(binomial_test(2, 4, 0.5), 1.0);
        assert_relative_eq!(binomial_test(0, 0, 0.5), 1.0);
        // 95 % of 5000 underflows as a product; the tail is that of the normal law within its correction.
        let tail = binomial_test(4750 - 31, 5000, 0.95);
        assert!((0.03..0.06).contains(&tail), "{tail}");
    }
}
