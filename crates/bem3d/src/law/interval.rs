//! The law of a pressure: between zero and an upper bound.

use super::definition::ConvexLaw;
use crate::real::{each, sum, update};

/// Largest number of passes over the cells in a projection; about a dozen are usual.
const PASSES: usize = 200;
/// A sum is accepted where its relative error is less than this: the rounding of a sum.
const ROUNDING: f64 = 1e-15;

/// `0 <= p <= upper`, the same on every cell; without a hardness `upper` is infinite.
#[derive(Debug, Clone, Copy)]
pub struct PressureRange {
    /// The upper bound.
    pub upper: f64,
}

impl ConvexLaw<1> for PressureRange {
    fn nearest(&self, _: usize, [p]: [f64; 1]) -> [f64; 1] {
        [p.clamp(0.0, self.upper)]
    }

    /// `min(max(p + mu, 0), upper)`, with the mu that brings the sum to the force.
    ///
    /// The sum rises with mu and is piecewise linear. Newton's method solves for mu within a bracket, which is
    /// halved where Newton's step leaves it.
    fn project(&self, y: &mut [f64], force: Option<[f64; 1]>) {
        let upper = self.upper;
        let Some([force]) = force else {
            return each(y, |y| *y = y.clamp(0.0, upper));
        };
        // The sum is 0 at the lower end. At the upper end each cell carries its share of the force, or p_s
        // where that is less.
        let (smallest, largest) =
            y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &y| (a.min(y), b.max(y)));
        let share = force / y.len() as f64;
        let (mut low, mut high) = (-largest, share - smallest);
        let mut shift = 0.0_f64.clamp(low, high.max(low));
        for _ in 0..PASSES {
            let (mut total, mut between) = (0.0, 0.0);
            for y in y.iter() {
                let p = y + shift;
                if p >= upper {
                    total += upper;
                } else if p > 0.0 {
                    total += p;
                    between += 1.0;
                }
            }
            let missing = force - total;
            if missing.abs() <= ROUNDING * force {
                break;
            }
            if missing > 0.0 {
                low = shift;
            } else {
                high = shift;
            }
            let next = shift + missing / between;
            let next = if next > low && next < high { next } else { f64::midpoint(low, high) };
            if next <= low || next >= high {
                break;
            }
            shift = next;
        }
        each(y, |y| *y = (*y + shift).clamp(0.0, upper));
        // Where y is large and p_s small, the shift has fewer digits than the pressures.
        let between = |y: f64| y > 0.0 && y < upper;
        let count = y.iter().filter(|&&y| between(y)).count();
        let missing = (force - sum(y)) / count as f64;
        if count > 0 {
            each(y, |y| {
                if between(*y) {
                    *y = (*y + missing).clamp(0.0, upper);
                }
            });
        }
    }

    fn held(&self, _: usize, [p]: [f64; 1], [v]: [f64; 1]) -> Option<f64> {
        if p <= 0.0 {
            Some(v.max(0.0).powi(2))
        } else if p >= self.upper {
            Some(v.min(0.0).powi(2))
        } else {
            None
        }
    }

    fn room(&self, _: usize, [p]: [f64; 1], [change]: [f64; 1]) -> f64 {
        if change < 0.0 {
            -p / change
        } else if change > 0.0 {
            (self.upper - p) / change
        } else {
            f64::INFINITY
        }
    }

    fn meet(&self, p: &mut [f64], change: &[f64]) {
        let largest = p.iter().copied().fold(0.0, f64::max);
        let near = 1e-14 * largest;
        update(p, change, |p, &change| {
            if change < 0.0 && *p <= near {
                *p = 0.0;
            } else if change > 0.0 && *p >= self.upper - near {
                *p = self.upper;
            }
        });
    }

    fn excess(&self, _: usize, [p]: [f64; 1], [v]: [f64; 1]) -> f64 {
        // Without an upper bound no cell has v > 0: the level from which gaps are measured is the lowest one.
        if v > 0.0 { (self.upper - p) * v } else { p * -v }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Rounding of a few additions.
    const ROUNDING_OF_SUMS: f64 = 1e-14;

    #[test]
    fn a_pressure_is_projected_by_hand() {
        let projected = |y: &[f64], hardness: f64, force: Option<f64>| {
            let mut y = y.to_vec();
            PressureRange { upper: hardness }.project(&mut y, force.map(|force| [force]));
            y
        };
        let close = |found: Vec<f64>, expected: &[f64]| {
            for (found, expected) in found.iter().zip(expected) {
                assert_relative_eq!(*found, *expected, epsilon = ROUNDING_OF_SUMS);
            }
        };
        // An approach: each by itself.
        assert_eq!(projected(&[-1.0, 0.5, 3.0], 2.0, None), [0.0, 0.5, 2.0]);
        // A force: all are shifted, those that leave the bounds stay there.
        close(projected(&[1.0, 2.0, 3.0], f64::INFINITY, Some(3.0)), &[0.0, 1.0, 2.0]);
        close(projected(&[1.0, 2.0, 3.0], f64::INFINITY, Some(9.0)), &[2.0, 3.0, 4.0]);
        close(projected(&[0.0, 2.0, 9.0], 3.0, Some(4.5)), &[0.0, 1.5, 3.0]);
        close(projected(&[0.0, 2.0, 9.0], 3.0, Some(7.0)), &[1.0, 3.0, 3.0]);
        // All of them, nearly none, far apart, and equal ones.
        close(projected(&[0.0, 2.0, 9.0], 3.0, Some(9.0)), &[3.0, 3.0, 3.0]);
        close(projected(&[0.0, 2.0, 9.0], 3.0, Some(1e-12)), &[0.0, 0.0, 1e-12]);
        close(projected(&[-1e12, 0.0, 1e12], 3.0, Some(4.0)), &[0.0, 1.0, 3.0]);
        close(projected(&[0.7; 4], 3.0, Some(2.0)), &[0.5; 4]);
        close(projected(&[5.0], 3.0, Some(2.0)), &[2.0]);
    }
}
