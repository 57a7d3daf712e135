//! The Hurst exponent of a measured spectrum.

use contact_model::{Error, Result};
use numerics::regression::least_squares;

/// Fewest points that a straight line is fitted through.
const FEWEST: usize = 3;

/// Hurst exponent from a radial spectrum: least squares of `ln C_2D = const - 2 (H + 1) ln q` over `q_min <=
/// q <= q_max`.
///
/// All points have the same weight; points with C = 0 are left out. The first rings bias the fit (see
/// [`crate::radial_spectrum`]), so start at about ring 8.
///
/// # Errors
/// [`Error::Domain`] where fewer than 3 points with C > 0 lie in the window.
///
/// ```
/// let spectrum: Vec<_> = (1..20).map(|k| (f64::from(k), f64::from(k).powf(-3.6))).collect();
/// let h = surface_gen::hurst_from_spectrum(&spectrum, 1.0, 20.0)?;
/// assert!((h - 0.8).abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn hurst_from_spectrum(spectrum: &[(f64, f64)], q_min: f64, q_max: f64) -> Result<f64> {
    Ok(-0.5 * slope(spectrum, q_min, q_max)? - 1.0)
}

/// Hurst exponent from the spectrum of a line: least squares of `ln C_1D = const - (2 H + 1) ln q` over
/// `q_min <= q <= q_max`.
///
/// # Errors
/// As [`hurst_from_spectrum`].
///
/// ```
/// let spectrum: Vec<_> = (1..20).map(|m| (f64::from(m), f64::from(m).powf(-2.6))).collect();
/// let h = surface_gen::hurst_from_line_spectrum(&spectrum, 1.0, 20.0)?;
/// assert!((h - 0.8).abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn hurst_from_line_spectrum(spectrum: &[(f64, f64)], q_min: f64, q_max: f64) -> Result<f64> {
    Ok(-0.5 * (slope(spectrum, q_min, q_max)? + 1.0))
}

fn slope(spectrum: &[(f64, f64)], q_min: f64, q_max: f64) -> Result<f64> {
    let inside = |&&(q, c): &&(f64, f64)| q > 0.0 && q >= q_min && q <= q_max && c.is_normal() && c > 0.0;
    let points: Vec<(f64, f64)> = spectrum.iter().filter(inside).map(|&(q, c)| (q.ln(), c.ln())).collect();
    let n = points.len();
    let too_few = || {
        let expected = format!("at least {FEWEST} different wavenumbers with C > 0 in [{q_min}, {q_max}]");
        Error::domain("points of the spectrum", n as f64, expected)
    };
    if n < FEWEST {
        return Err(too_few());
    }
    least_squares(&points).map(|line| line.0).ok_or_else(too_few)
}
