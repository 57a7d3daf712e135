//! Transforms of complex fields on a rectangle.

use rustfft::{Fft, FftPlanner, num_complex::Complex64};
use std::sync::Arc;

/// Forward and inverse transforms of `columns` x `rows` values, row-major, without factors.
pub(crate) struct Plane {
    columns: usize,
    rows: usize,
    forward: [Arc<dyn Fft<f64>>; 2],
    inverse: [Arc<dyn Fft<f64>>; 2],
}

impl Plane {
    pub(crate) fn new(columns: usize, rows: usize) -> Self {
        let mut planner = FftPlanner::new();
        Self {
            columns,
            rows,
            forward: [columns, rows].map(|n| planner.plan_fft_forward(n)),
            inverse: [columns, rows].map(|n| planner.plan_fft_inverse(n)),
        }
    }

    /// `H = sum h exp(-2 pi i (mx ix / columns + my iy / rows))`, in place.
    pub(crate) fn forward(&self, values: &mut [Complex64]) {
        self.process(&self.forward, values);
    }

    /// `h = sum H exp(2 pi i (mx ix / columns + my iy / rows))`, in place.
    pub(crate) fn inverse(&self, values: &mut [Complex64]) {
        self.process(&self.inverse, values);
    }

    fn process(&self, plans: &[Arc<dyn Fft<f64>>; 2], values: &mut [Complex64]) {
        // `process` of rustfft transforms each of the rows that follow one another.
        plans[0].process(values);
        let mut column = vec![Complex64::new(0.0, 0.0); self.rows];
        let mut scratch = vec![Complex64::new(0.0, 0.0); plans[1].get_inplace_scratch_len()];
        for ix in 0..self.columns {
            for (value, from) in column.iter_mut().zip(values[ix..].iter().step_by(self.columns)) {
                *value = *from;
            }
            plans[1].process_with_scratch(&mut column, &mut scratch);
            for (value, to) in column.iter().zip(values[ix..].iter_mut().step_by(self.columns)) {
                *to = *value;
            }
        }
    }
}

/// The smallest length of at least `least` whose only prime factors are 2, 3 and 5.
pub(crate) fn fast_length(least: usize) -> usize {
    let smooth = |n: &usize| {
        let mut rest = *n;
        for prime in [2, 3, 5] {
            while rest.is_multiple_of(prime) {
                rest /= prime;
            }
        }
        rest == 1
    };
    let least = least.max(1);
    // A power of two lies below twice as much.
    (least..2 * least).find(smooth).unwrap_or(least)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_products_of_small_primes() {
        assert_eq!([1, 7, 11, 31, 257].map(fast_length), [1, 8, 12, 32, 270]);
    }

    #[test]
    fn there_and_back() {
        let plane = Plane::new(5, 3);
        let values: Vec<_> =
            (0..15).map(|i| Complex64::new(f64::from(i * i % 7), f64::from(i % 4))).collect();
        let mut back = values.clone();
        plane.forward(&mut back);
        let sum: Complex64 = values.iter().sum();
        assert!((back[0] - sum).norm() < 1e-13);
        plane.inverse(&mut back);
        assert!(back.iter().zip(&values).all(|(b, v)| (b / 15.0 - v).norm() < 1e-14));
    }
}
