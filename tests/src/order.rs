//! Orders of convergence.

/// Order p of errors that fall like `N^-p`: least squares of ln error over ln N; `None` for fewer than two
/// grids or an error of 0.
///
/// ```
/// // Errors 1/N^2 on three grids.
/// let p = tests::order(&[(10, 1e-2), (20, 2.5e-3), (40, 6.25e-4)]);
/// assert!(p.is_some_and(|p| (p - 2.0).abs() < 1e-12));
/// ```
pub fn order(errors: &[(usize, f64)]) -> Option<f64> {
    let points: Vec<(f64, f64)> = errors.iter().map(|&(n, e)| ((n as f64).ln(), e.abs().ln())).collect();
    analysis::least_squares(&points).map(|(slope, _)| -slope)
}
