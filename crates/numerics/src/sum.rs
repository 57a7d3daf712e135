//! Sums whose rounding errors do not grow with the number of terms, or with its logarithm only.

use crate::parallel::{map, threads_for};

/// Below this many values a plain sum is as good as a pairwise one.
const PLAIN: usize = 128;

/// Sums side by side, so that the compiler adds several at once.
const LANES: usize = 8;

/// Halvings of a long sum that threads share.
const HALVINGS: u32 = 6;

/// A sum with its rounding errors carried along (Neumaier, ZAMM 54, 39 (1974)).
#[derive(Debug, Clone, Copy, Default)]
pub struct Sum {
    high: f64,
    low: f64,
}

impl From<f64> for Sum {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Sum {
    /// Adds a term to the sum.
    pub fn add(&mut self, term: f64) {
        let total = self.high + term;
        // The smaller of the two lost its low digits: they are kept.
        self.low += if self.high.abs() >= term.abs() {
            (self.high - total) + term
        } else {
            (term - total) + self.high
        };
        self.high = total;
    }

    /// The sum of what was added.
    pub fn value(self) -> f64 {
        self.high + self.low
    }
}

/// Sum by Neumaier's compensated method ([`Sum`]): the rounding error does not grow with the number of terms.
///
/// ```
/// assert_eq!(numerics::sum::sum([1.0, 1e100, 1.0, -1e100]), 2.0);
/// ```
pub fn sum(values: impl IntoIterator<Item = f64>) -> f64 {
    let mut total = Sum::default();
    for value in values {
        total.add(value);
    }
    total.value()
}

/// Pairwise sum of `term` over the values: the rounding error grows with log n only. Threads share the work,
/// with the same bits for any number of them.
///
/// ```
/// assert_eq!(numerics::sum::pairwise(&[1.0, 2.0, 3.0], |v| v * v), 14.0);
/// ```
pub fn pairwise(values: &[f64], term: impl Fn(f64) -> f64 + Sync) -> f64 {
    if threads_for(values.len()) == 1 {
        return pairwise_alone(values, &term);
    }
    let mut parts = vec![values];
    for _ in 0..HALVINGS {
        parts = parts.into_iter().flat_map(|part| <[_; 2]>::from(part.split_at(part.len() / 2))).collect();
    }
    let mut sums = map(values.len(), parts.into_iter(), |part| pairwise_alone(part, &term));
    while sums.len() > 1 {
        sums = sums.chunks(2).map(|pair| pair.iter().sum()).collect();
    }
    sums[0]
}

fn pairwise_alone(values: &[f64], term: &impl Fn(f64) -> f64) -> f64 {
    if values.len() <= PLAIN {
        let (groups, rest) = values.as_chunks::<LANES>();
        let mut lanes = [0.0; LANES];
        for group in groups {
            for (lane, &v) in lanes.iter_mut().zip(group) {
                *lane += term(v);
            }
        }
        return lanes.iter().sum::<f64>() + rest.iter().map(|&v| term(v)).sum::<f64>();
    }
    let (left, right) = values.split_at(values.len() / 2);
    pairwise_alone(left, term) + pairwise_alone(right, term)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn ten_million_tenths() {
        let s = sum(std::iter::repeat_n(0.1, 10_000_000));
        assert_relative_eq!(s, 1e6, max_relative = 1e-15);
        approx::assert_abs_diff_eq!(sum([]), 0.0);
    }

    #[test]
    fn pairwise_is_the_plain_sum() {
        let values: Vec<f64> = (0..1000).map(f64::from).collect();
        assert_relative_eq!(pairwise(&values, |v| v), 499_500.0, max_relative = 4.0 * f64::EPSILON);
        assert!(pairwise(&[], |v| v).abs() <= 0.0);
    }
}
