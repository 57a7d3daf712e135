//! The error function and the exponential integral.

use std::f64::consts::{FRAC_2_SQRT_PI, PI};

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

/// `erf x`, relative error below 1e-15 for x >= 0.
///
/// Up to 2.5 the series of positive terms `2/sqrt(pi) exp(-x^2) sum 2^n x^(2n + 1)/(2n + 1)!!` (Abramowitz
/// and Stegun 7.1.6), beyond it `1 - erfc x`.
pub(crate) fn erf(x: f64) -> f64 {
    const LARGE: f64 = 2.5;
    if x < 0.0 {
        return -erf(-x);
    }
    if x > LARGE {
        return 1.0 - erfc_large(x);
    }
    let mut term = x;
    let mut sum = x;
    let mut n = 1.0;
    while term > sum * 1e-17 {
        n += 2.0;
        term *= 2.0 * x * x / n;
        sum += term;
    }
    FRAC_2_SQRT_PI * (-x * x).exp() * sum
}

/// `erfc x` for x > 2: the continued fraction of Abramowitz and Stegun 7.1.14, evaluated from its tail.
fn erfc_large(x: f64) -> f64 {
    const DEPTH: u32 = 60;
    let tail = (1..=DEPTH).rev().fold(x, |tail, k| x + 0.5 * f64::from(k) / tail);
    (-x * x).exp() / (PI.sqrt() * tail)
}

/// `E_1(z) = int_z^inf exp(-t)/t dt` for z > 0, relative error below 1e-14.
///
/// Below 1 the series `-gamma - ln z - sum (-z)^k/(k k!)`, beyond it the continued fraction (Abramowitz and
/// Stegun 5.1.11 and 5.1.22, contracted).
pub(crate) fn exponential_integral(z: f64) -> f64 {
    const DEPTH: u32 = 120;
    if z >= 1.0 {
        // exp(-z)/(z + 1 - 1/(z + 3 - 4/(z + 5 - ...))).
        let tail = (1..=DEPTH).rev().fold(z + f64::from(2 * DEPTH + 1), |tail, k| {
            let k = f64::from(k);
            z + 2.0 * k - 1.0 - k * k / tail
        });
        return (-z).exp() / tail;
    }
    let mut sum = -EULER - z.ln();
    let mut power = -1.0;
    for k in 1..30 {
        let k = f64::from(k);
        power *= -z / k;
        sum += power / k;
    }
    sum
}

/// `E_1(x^2)` for x > 0, also where `x^2` underflows.
pub(crate) fn exponential_integral_of_square(x: f64) -> f64 {
    if x < 1e-9 { -EULER - 2.0 * x.ln() } else { exponential_integral(x * x) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use numerics::gauss::Gauss;

    #[test]
    fn error_function() {
        // Abramowitz and Stegun, Table 7.1, and more digits.
        for (x, expected) in [
            (0.1, 0.112_462_916_018_284_9),
            (0.5, 0.520_499_877_813_046_5),
            (1.0, 0.842_700_792_949_714_9),
            (2.0, 0.995_322_265_018_952_7),
            (3.0, 0.999_977_909_503_001_4),
        ] {
            assert_relative_eq!(erf(x), expected, max_relative = 1e-15);
            assert_relative_eq!(erf(-x), -expected, max_relative = 1e-15);
        }
        assert_relative_eq!(erfc_large(4.0), 1.541_725_790_028_002e-8, max_relative = 1e-13);
        assert!(erf(0.0) <= 0.0 && erf(30.0) >= 1.0);
        // Both branches where they meet.
        assert_relative_eq!(erf(2.5), 1.0 - erfc_large(2.5), max_relative = 1e-15);
    }

    #[test]
    fn exponential_integral_of_the_tables() {
        // Abramowitz and Stegun, Table 5.1, and more digits.
        for (z, expected) in [
            (0.1, 1.822_923_958_419_390_6),
            (0.5, 0.559_773_594_776_160_8),
            (1.0, 0.219_383_934_395_520_28),
            (2.0, 0.048_900_510_708_061_12),
        ] {
            assert_relative_eq!(exponential_integral(z), expected, max_relative = 1e-13);
        }
        let (below, above) =
            (exponential_integral_of_square(0.999e-9), exponential_integral_of_square(1.001e-9));
        assert_relative_eq!(below - above, 2.0 * (1.001_f64 / 0.999).ln(), max_relative = 1e-9);
        // E_1(a) - E_1(b) is an integral of a smooth function; across both branches and in the tail.
        let gauss = Gauss::<16>::new();
        for (low, high) in [(0.7, 0.99), (0.9, 1.1), (1.0, 1.4), (5.0, 6.0), (30.0, 31.0)] {
            let integral = gauss.integrate(low, high, |t| (-t).exp() / t);
            let difference = exponential_integral(low) - exponential_integral(high);
            assert_relative_eq!(difference, integral, max_relative = 1e-12);
        }
    }
}
