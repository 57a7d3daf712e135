//! The root of a monotone function.

/// The root of an increasing function between two points where it is negative and positive, to the last place that its own rounding allows.
///
/// Regula falsi with the stale end halved (the Illinois rule), and a bisection whenever three steps have not halved the interval: some
/// ten evaluations for smooth functions, never more than three times those of bisection. Without a change of sign the nearer end is
/// returned.
pub(crate) fn increasing(mut low: f64, mut high: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    /// Three times the bits between any two numbers; never reached.
    const MOST_STEPS: usize = 6_400;
    let (mut below, mut above) = (function(low), function(high));
    if below >= 0.0 {
        return low;
    }
    if above <= 0.0 {
        return high;
    }
    let mut width = high - low;
    for step in 0..MOST_STEPS {
        let bisect = step % 3 == 2 && high - low > 0.5 * width;
        if step % 3 == 2 {
            width = high - low;
        }
        let middle = 0.5 * (low + high);
        let mut x = if bisect { middle } else { low - below * ((high - low) / (above - below)) };
        if !(x > low && x < high) {
            x = middle;
        }
        if !(x > low && x < high) {
            break;
        }
        let value = function(x);
        if value > 0.0 {
            (high, above) = (x, value);
            below *= 0.5;
        } else if value < 0.0 {
            (low, below) = (x, value);
            above *= 0.5;
        } else {
            return x;
        }
    }
    if -below < above { low } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn smooth_steep_and_flat_functions() {
        for power in [1, 3, 9, 31] {
            let mut calls = 0;
            let root = increasing(0.0, 10.0, |x| {
                calls += 1;
                x.powi(power) - 2.0
            });
            assert_relative_eq!(
                root,
                2.0_f64.powf(1.0 / f64::from(power)),
                max_relative = 8.0 * f64::EPSILON
            );
            assert!(calls < 200, "{power}: {calls}");
        }
        assert_relative_eq!(increasing(0.0, 1.0, |x| x + 1.0), 0.0);
        assert_relative_eq!(increasing(0.0, 1.0, |x| x - 2.0), 1.0);
    }
}
