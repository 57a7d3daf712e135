//! The exact binomial test.

/// Probability of a number of successes as far from `share * trials` as this one or farther on its side, twice (at most 1): the two-sided
/// p-value of "each trial succeeds with the probability `share`".
///
/// All terms are summed; their rounding grows with the number of trials. Cost: linear in the trials.
///
/// ```
/// use analysis::binomial_test;
/// // All of 20 inside a 95 % interval is nothing strange, all of 200 is.
/// assert!((binomial_test(20, 20, 0.95) - 2.0 * 0.95_f64.powi(20)).abs() < 1e-12);
/// assert!(binomial_test(200, 200, 0.95) < 0.01 && binomial_test(190, 200, 0.95) > 0.9);
/// ```
pub fn binomial_test(successes: usize, trials: usize, share: f64) -> f64 {
    // Logarithms: the terms of many trials underflow.
    let (mut logarithm, odds) = (trials as f64 * (1.0 - share).ln(), (share / (1.0 - share)).ln());
    let (mut below, mut above) = (0.0, 0.0);
    for k in 0..=trials {
        let term = logarithm.exp();
        below += if k <= successes { term } else { 0.0 };
        above += if k >= successes { term } else { 0.0 };
        logarithm += ((trials - k) as f64 / (k + 1) as f64).ln() + odds;
    }
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
