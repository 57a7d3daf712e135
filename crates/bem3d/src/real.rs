//! Single and double precision.

use crate::tuning::{BLOCK, CHUNK, LANES};
use numerics::parallel::{map, widest};
use numerics::plan::Precision;
use std::ops::AddAssign;

/// Floating point of an operator and of the vectors of an iteration: f64, or f32 where the result is
/// certified in f64.
pub trait Real: Precision + Default + AddAssign + PartialOrd {
    /// Name in reports.
    const NAME: &'static str;
    /// Rounds to this precision.
    fn of(value: f64) -> Self;
    /// Widens to f64.
    fn to_f64(self) -> f64;
    /// The larger of this and the magnitude of another, as one instruction of a vector loop.
    fn or_larger(self, other: Self) -> Self;
}

impl Real for f64 {
    fn or_larger(self, other: Self) -> Self {
        self.max(other.abs())
    }
    const NAME: &'static str = "f64";
    fn of(value: f64) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self
    }
}

impl Real for f32 {
    fn or_larger(self, other: Self) -> Self {
        self.max(other.abs())
    }
    const NAME: &'static str = "f32";
    fn of(value: f64) -> Self {
        value as Self
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}

/// A power of two near the largest magnitude, so that values over it lie in the middle of the range of single
/// precision.
pub fn binary_unit(values: &[f64]) -> f64 {
    let largest = largest(values);
    if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
}

/// Largest magnitude.
pub fn largest<T: Real>(values: &[T]) -> T {
    let chunks = map(values.len(), values.chunks(CHUNK), |v| fold(v, T::default(), T::or_larger));
    fold(&chunks, T::default(), T::or_larger)
}

/// Largest magnitude of a difference.
pub fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let pairs = a.chunks(CHUNK).zip(b.chunks(CHUNK));
    let chunks = map(a.len(), pairs, |(a, b)| {
        let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, |largest: f64, d| if d > largest { d } else { largest })
    });
    fold(&chunks, 0.0, f64::or_larger)
}

/// Smallest number; infinite if there is none.
pub fn smallest(values: &[f64]) -> f64 {
    let smaller = |smallest: f64, value: f64| if value < smallest { value } else { smallest };
    let chunks = map(values.len(), values.chunks(CHUNK), |v| fold(v, f64::INFINITY, smaller));
    fold(&chunks, f64::INFINITY, smaller)
}

/// Folds values in an order that suits a vector loop; `start` has to be neutral.
fn fold<T: Copy>(values: &[T], start: T, take: impl Fn(T, T) -> T) -> T {
    let ((chunks, rest), take) = (values.as_chunks::<LANES>(), &take);
    let lanes = widest(
        #[inline(always)]
        move || {
            let mut lanes = [start; LANES];
            for chunk in chunks {
                for (lane, &value) in lanes.iter_mut().zip(chunk) {
                    *lane = take(*lane, value);
                }
            }
            lanes
        },
    );
    lanes.iter().chain(rest).fold(start, |a, &b| take(a, b))
}

/// Scalar product, in double precision over blocks: rounding stays far below that of a transform.
pub fn dot<T: Real>(a: &[T], b: &[T]) -> f64 {
    let chunk = |(a, b): (&[T], &[T])| -> f64 {
        a.chunks(BLOCK).zip(b.chunks(BLOCK)).map(|(a, b)| block(a, b).to_f64()).sum()
    };
    map(a.len(), a.chunks(CHUNK).zip(b.chunks(CHUNK)), chunk).into_iter().sum()
}

fn block<T: Real>(a: &[T], b: &[T]) -> T {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let lanes = widest(
        #[inline(always)]
        move || {
            let mut lanes = [T::default(); LANES];
            for (a, b) in a.iter().zip(b) {
                for ((lane, &a), &b) in lanes.iter_mut().zip(a).zip(b) {
                    *lane += a * b;
                }
            }
            lanes
        },
    );
    let products = rest_a.iter().zip(rest_b).map(|(&a, &b)| a * b);
    lanes.into_iter().chain(products).fold(T::default(), |sum, value| sum + value)
}

/// Sum in double precision.
pub fn sum<T: Real>(values: &[T]) -> f64 {
    let block = |values: &[T]| {
        let (chunks, rest) = values.as_chunks::<LANES>();
        let mut lanes = [T::default(); LANES];
        for chunk in chunks {
            for (lane, &value) in lanes.iter_mut().zip(chunk) {
                *lane += value;
            }
        }
        lanes.iter().chain(rest).map(|value| value.to_f64()).sum::<f64>()
    };
    let chunk = |values: &[T]| -> f64 { values.chunks(BLOCK).map(block).sum() };
    map(values.len(), values.chunks(CHUNK), chunk).into_iter().sum()
}

/// Sum of `value` over the numbers at the same position of two lists.
pub fn sum_of_pairs(a: &[f64], b: &[f64], value: impl Fn(f64, f64) -> f64 + Sync) -> f64 {
    let value = &value;
    let chunk = |(a, b): (&[f64], &[f64])| -> f64 {
        let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
        let lanes = widest(
            #[inline(always)]
            move || {
                let mut lanes = [0.0; LANES];
                for (a, b) in a.iter().zip(b) {
                    for ((lane, &a), &b) in lanes.iter_mut().zip(a).zip(b) {
                        *lane += value(a, b);
                    }
                }
                lanes
            },
        );
        lanes.into_iter().chain(rest_a.iter().zip(rest_b).map(|(&a, &b)| value(a, b))).sum()
    };
    map(a.len(), a.chunks(CHUNK).zip(b.chunks(CHUNK)), chunk).into_iter().sum()
}

/// Changes each number of a list.
pub fn each<A: Send>(values: &mut [A], change: impl Fn(&mut A) + Sync) {
    let change = &change;
    map(values.len(), values.chunks_mut(CHUNK), |values| {
        widest(
            #[inline(always)]
            move || values.iter_mut().for_each(change),
        );
    });
}

/// Changes each number of one list by those of another at its place.
pub fn update<A: Send, B: Sync>(a: &mut [A], b: &[B], change: impl Fn(&mut A, &B) + Sync) {
    let change = &change;
    map(a.len(), a.chunks_mut(CHUNK).zip(b.chunks(CHUNK)), |(a, b)| {
        widest(
            #[inline(always)]
            move || {
                for (a, b) in a.iter_mut().zip(b) {
                    change(a, b);
                }
            },
        );
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn sums_products_and_magnitudes_of_any_length() {
        for n in [0, 1, LANES - 1, LANES, BLOCK + 5] {
            let a: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
            let b: Vec<f64> = (0..n).map(|k| 0.3 - (0.7 * k as f64).cos()).collect();
            assert_relative_eq!(sum(&a), a.iter().sum::<f64>(), epsilon = 1e-12);
            let product: f64 = a.iter().zip(&b).map(|(a, b)| a * b).sum();
            assert_relative_eq!(dot(&a, &b), product, epsilon = 1e-12);
            let single = |v: &[f64]| v.iter().map(|&v| v as f32).collect::<Vec<_>>();
            assert_relative_eq!(dot(&single(&a), &single(&b)), product, epsilon = 1e-3);
            assert_relative_eq!(smallest(&b), b.iter().fold(f64::INFINITY, |m: f64, v| m.min(*v)));
            assert_relative_eq!(largest(&b), b.iter().fold(0.0, |m: f64, v| m.max(v.abs())));
        }
        assert_relative_eq!(binary_unit(&[0.3, -5.0]), 4.0);
        assert_relative_eq!(binary_unit(&[0.0]), 1.0);
    }
}
