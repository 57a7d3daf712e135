//! Roots of functions of one variable.

/// The root between two points where `function` has opposite signs, to the last place that the function's own
/// rounding allows.
///
/// The method is bisection, with inverse quadratic interpolation where that is safe (Chandrupatla, Adv. Eng.
/// Softw. 28, 145 (1997)). It needs about ten evaluations for smooth functions and never more than bisection.
/// A point where the function is exactly 0 is returned; without a change of sign the result is the end with
/// the smaller absolute value. Values at the ends may be infinite.
pub fn between(low: f64, high: f64, mut function: impl FnMut(f64) -> f64) -> f64 {
    /// More than the bits of any two numbers of one sign; never reached by functions with numbers for values.
    const MOST_STEPS: usize = 2_200;
    let (mut b, mut a) = (low, high);
    let (mut fb, mut fa) = (function(b), function(a));
    if fb.abs() <= 0.0 {
        return b;
    }
    if fa.abs() <= 0.0 {
        return a;
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

/// The largest root of a convex function by Newton's method from a point above it. The steps only descend,
/// and rounding ends them.
///
/// `function` returns value and slope. A start where the slope is not positive is returned unchanged.
///
/// ```
/// let root = numerics::root::newton_from_above(3.0, |x| (x * x - 2.0, 2.0 * x));
/// assert!((root - 2.0_f64.sqrt()).abs() < 1e-15);
/// ```
pub fn newton_from_above(start: f64, mut function: impl FnMut(f64) -> (f64, f64)) -> f64 {
    /// Of `x^m` a step far above the root shortens x by 1/m at least, near it the error is squared; never
    /// reached for exponents below 1e3.
    const MOST_STEPS: usize = 10_000;
    let mut x = start;
    for _ in 0..MOST_STEPS {
        let (value, slope) = function(x);
        let next = x - value / slope;
        if !(next < x && slope > 0.0) {
            break;
        }
        x = next;
    }
    x
}

/// The bracket `[low, high]` after `halvings` halvings, each of which keeps the half in which `below` changes
/// from true to false.
///
/// For functions of which the sign alone is known, or whose values an interpolation cannot use; [`between`]
/// needs fewer evaluations.
///
/// ```
/// let [low, high] = numerics::root::bisect(0.0, 1.0, 4, |x| x < 0.3);
/// assert_eq!([low, high], [0.25, 0.3125]);
/// ```
pub fn bisect(mut low: f64, mut high: f64, halvings: usize, mut below: impl FnMut(f64) -> bool) -> [f64; 2] {
    for _ in 0..halvings {
        let middle = f64::midpoint(low, high);
        *(if below(middle) { &mut low } else { &mut high }) = middle;
    }
    [low, high]
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
        assert_relative_eq!(between(0.0, 1.0, |x| x + 1.0), 0.0);
        assert_relative_eq!(between(0.0, 1.0, |x| x - 2.0), 1.0);
        // The value at the upper end is 0: no other is nearer.
        let mut calls = 0;
        assert_relative_eq!(
            between(0.0, 1.0, |x| {
                calls += 1;
                1.0 - x
            }),
            1.0
        );
        assert_eq!(calls, 2);
    }

    #[test]
    fn poles_at_both_ends() {
        let (low, high) = (1.0, 2.0);
        let root = between(low, high, |x| {
            if x <= low {
                f64::NEG_INFINITY
            } else if x >= high {
                f64::INFINITY
            } else {
                (high - x).recip() - 3.0 * (x - low).recip()
            }
        });
        assert_relative_eq!(root, 1.75, max_relative = 4.0 * f64::EPSILON);
    }

    #[test]
    fn a_start_without_slope_stays() {
        assert_relative_eq!(newton_from_above(2.0, |_| (1.0, 0.0)), 2.0);
        assert_relative_eq!(
            newton_from_above(1e3, |x| (x.powi(9) - 1.0, 9.0 * x.powi(8))),
            1.0,
            max_relative = 1e-15
        );
    }
}
