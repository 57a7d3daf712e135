//! Roots of monotone functions of one variable.

/// The root between two points where `function` has opposite signs, to the last place that the function's own rounding allows.
///
/// Bisection that takes inverse quadratic interpolation where that is safe (Chandrupatla, Adv. Eng. Softw. 28, 145 (1997)): some ten
/// evaluations for smooth functions, never more than bisection needs. A point where the function is 0 is returned as it is; without
/// a change of sign the end with the smaller value is.
pub fn between(low: f64, high: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    /// More than the bits of any two numbers of one sign; never reached by functions with numbers for values.
    const MOST_STEPS: usize = 2_200;
    let (mut b, mut a) = (low, high);
    let (mut fb, mut fa) = (function(b), function(a));
    if fb.abs() <= 0.0 {
        return b;
    }
    if (fa > 0.0) == (fb > 0.0) {
        return if fa.abs() < fb.abs() { a } else { b };
    }
    let mut t = 0.5;
    for _ in 0..MOST_STEPS {
        let x = a + t * (b - a);
        let fx = function(x);
        let (c, fc);
        if (fx > 0.0) == (fa > 0.0) {
            (c, fc) = (a, fa);
        } else {
            (c, fc) = (b, fb);
            (b, fb) = (a, fa);
        }
        (a, fa) = (x, fx);
        let best = if fa.abs() < fb.abs() { a } else { b };
        let closest = 0.5 * f64::EPSILON * best.abs() / (b - a).abs();
        if fa.abs() <= 0.0 || closest >= 0.5 || closest.is_nan() {
            return best;
        }
        let xi = (a - b) / (c - b);
        let phi = (fa - fb) / (fc - fb);
        t = if phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi {
            fa / (fb - fa) * fc / (fb - fc) + (c - a) / (b - a) * fa / (fc - fa) * fb / (fc - fb)
        } else {
            0.5
        };
        t = t.clamp(closest, 1.0 - closest);
    }
    if fa.abs() < fb.abs() { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn smooth_steep_and_flat_functions() {
        for power in [1, 2, 3, 9, 31] {
            let mut calls = 0;
            let root = between(0.0, 10.0, |x| {
                calls += 1;
                x.powi(power) - 2.0
            });
            assert_relative_eq!(
                root,
                2.0_f64.powf(1.0 / f64::from(power)),
                max_relative = 4.0 * f64::EPSILON
            );
            assert!(calls < 100, "{power}: {calls}");
        }
        assert_relative_eq!(between(1.0, 0.0, |x| 0.3 - x), 0.3, max_relative = f64::EPSILON);
        assert_relative_eq!(
            between(-700.0, 0.0, |x| x.exp() - 1e-200),
            -200.0 * 10.0_f64.ln(),
            max_relative = 1e-15
        );
    }

    #[test]
    fn ends_and_no_change_of_sign() {
        assert!(between(0.0, 1.0, |x| x) <= 0.0 && between(-1.0, 0.0, |x| x) >= 0.0);
        assert_relative_eq!(between(1.0, 2.0, |x| x), 1.0);
    }
}
