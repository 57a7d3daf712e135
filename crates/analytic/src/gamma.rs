//! A ratio of gamma functions.

/// `Gamma(x + 1/2) / Gamma(x)` for `x > 0`, relative error below 1e-14.
///
/// The recurrence `R(x) = R(x + 1) x / (x + 1/2)` up to `x >= 16`, there Stirling's series of both
/// logarithms, whose large terms cancel before they are computed:
/// `x ln(1 + 1/(2x)) + ln(x)/2 - 1/2 + s(x + 1/2) - s(x)` (Abramowitz and Stegun 6.1.40).
pub(crate) fn half_step_ratio(x: f64) -> f64 {
    /// Where the series is good to the last place with the terms below.
    const LARGE: f64 = 16.0;
    let (mut x, mut factor) = (x, 1.0);
    while x < LARGE {
        factor *= x / (x + 0.5);
        x += 1.0;
    }
    let logarithm = x * (0.5 / x).ln_1p() - 0.5 + tail(x + 0.5) - tail(x);
    factor * x.sqrt() * logarithm.exp()
}

/// `s(x) = 1/(12 x) - 1/(360 x^3) + 1/(1260 x^5) - 1/(1680 x^7) + 1/(1188 x^9)`.
fn tail(x: f64) -> f64 {
    let y = (x * x).recip();
    let series = 1.0 / 1680.0 - y / 1188.0;
    (1.0 / 12.0 - y * (1.0 / 360.0 - y * (1.0 / 1260.0 - y * series))) / x
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    const ROUNDING: f64 = 1e-14;

    #[test]
    fn integers_and_halves() {
        // Gamma(1/2) = sqrt(pi), Gamma(1) = 1, Gamma(3/2) = sqrt(pi)/2, ...
        for (x, expected) in [
            (0.5, 1.0 / PI.sqrt()),
            (1.0, PI.sqrt() / 2.0),
            (1.5, 2.0 / PI.sqrt()),
            (2.0, 0.75 * PI.sqrt()),
            (3.0, 15.0 / 16.0 * PI.sqrt()),
        ] {
            assert_relative_eq!(half_step_ratio(x), expected, max_relative = ROUNDING);
        }
    }

    #[test]
    fn two_half_steps_are_a_whole_one() {
        for i in 1..300 {
            let x = 0.013 * f64::from(i * i);
            assert_relative_eq!(half_step_ratio(x) * half_step_ratio(x + 0.5), x, max_relative = ROUNDING);
        }
    }
}
