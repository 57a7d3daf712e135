//! The straight line of least squares.

use crate::sum::sum;

/// Slope and intercept of the straight line through `points` by least squares; `None` for fewer than two
/// different x or a number that is not finite.
///
/// ```
/// assert_eq!(numerics::regression::least_squares(&[(0.0, 1.0), (1.0, 3.0)]), Some((2.0, 1.0)));
/// ```
pub fn least_squares(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = points.len() as f64;
    let x0 = sum(points.iter().map(|p| p.0)) / n;
    let y0 = sum(points.iter().map(|p| p.1)) / n;
    let xx = sum(points.iter().map(|p| (p.0 - x0) * (p.0 - x0)));
    let xy = sum(points.iter().map(|p| (p.0 - x0) * (p.1 - y0)));
    let slope = xy / xx;
    let intercept = y0 - slope * x0;
    (xx > 0.0 && slope.is_finite() && intercept.is_finite()).then_some((slope, intercept))
}

/// Exponent p of `y ~ x^p`: the slope of ln y over ln x by least squares, without points that are not
/// positive. `None` as in [`least_squares`].
///
/// ```
/// let squares = [1.0, 2.0, 3.0, -1.0].map(|x: f64| (x, 5.0 * x * x));
/// assert!((numerics::regression::observed_power(squares).unwrap() - 2.0).abs() < 1e-14);
/// ```
pub fn observed_power(points: impl IntoIterator<Item = (f64, f64)>) -> Option<f64> {
    let logs: Vec<(f64, f64)> =
        points.into_iter().filter(|p| p.0 > 0.0 && p.1 > 0.0).map(|p| (p.0.ln(), p.1.ln())).collect();
    least_squares(&logs).map(|(slope, _)| slope)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_line_through_less_than_two_points() {
        assert_eq!(least_squares(&[]), None);
        assert_eq!(least_squares(&[(1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(least_squares(&[(0.0, f64::NAN), (1.0, 3.0)]), None);
    }
}
