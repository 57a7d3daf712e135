//! The exponential integral.

/// Euler's constant.
const EULER: f64 = 0.577_215_664_901_532_9;

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
