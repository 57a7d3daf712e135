//! Moments of samples.

use contact_model::HeightMap;
use numerics::range::{middle_and_half_width, range};
use numerics::sum::pairwise;

/// Mean and central moments of heights, in their unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeightMoments {
    /// Mean height.
    pub mean: f64,
    /// Root mean square about the mean: [`rms_height`].
    pub rms: f64,
    /// Third moment about the mean over the cube of the rms height; 0 for Gaussian heights.
    pub skewness: f64,
    /// Fourth moment over the fourth power; 3 for Gaussian heights.
    pub kurtosis: f64,
}

impl HeightMoments {
    /// The moments of finite heights; `None` where all are equal or there are none. The sums are as accurate
    /// as those of [`rms_height`]. Cost O(n).
    ///
    /// ```
    /// use surface_gen::HeightMoments;
    /// let found = HeightMoments::new(&[0.0, 0.0, 0.0, 4.0]).unwrap();
    /// assert!((found.mean - 1.0).abs() < 1e-15 && (found.rms - 3.0_f64.sqrt()).abs() < 1e-15);
    /// assert_eq!(HeightMoments::new(&[2.0, 2.0]), None);
    /// ```
    pub fn new(heights: &[f64]) -> Option<Self> {
        let (low, high) = range(heights);
        if high <= low || heights.is_empty() {
            return None;
        }
        let (middle, unit) = middle_and_half_width((low, high));
        let n = heights.len() as f64;
        let mean = pairwise(heights, |h| (h - middle) / unit) / n;
        let central = |power: i32| pairwise(heights, |h| ((h - middle) / unit - mean).powi(power)) / n;
        let rms = central(2).sqrt();
        Some(Self {
            mean: middle + unit * mean,
            rms: unit * rms,
            skewness: central(3) / rms.powi(3),
            kurtosis: central(4) / rms.powi(4),
        })
    }
}

/// Root mean square of the heights about their mean, `sqrt(mean (h - mean h)^2)`, in the unit of the heights.
///
/// Undefined points (minus infinity, as in [`HeightMap::heights`]) are left out. Two passes with pairwise
/// sums run over heights divided by their largest deviation from the middle of their range: nothing overflows
/// or underflows for heights of 1e-150 or 1e150, and an offset costs only its own rounding. The result is 0
/// for no heights or equal ones, and not finite if a height is NaN or plus infinity. Cost O(n); with
/// undefined points the others are copied.
///
/// ```
/// // Deviations from the mean 3 are -2, 0, 2: mean square 8/3.
/// let rms = surface_gen::rms_height(&[1.0, 3.0, 5.0]);
/// assert!((rms - (8.0_f64 / 3.0).sqrt()).abs() < 1e-15);
/// assert_eq!(surface_gen::rms_height(&[1.0, f64::NEG_INFINITY, 3.0, 5.0]), rms);
/// ```
pub fn rms_height(heights: &[f64]) -> f64 {
    let (low, high) = range(heights);
    if low == f64::NEG_INFINITY {
        let defined: Vec<f64> = heights.iter().copied().filter(|&h| h != f64::NEG_INFINITY).collect();
        return rms_height(&defined);
    }
    if heights.is_empty() || high <= low {
        return 0.0;
    }
    let (middle, unit) = middle_and_half_width((low, high));
    let n = heights.len() as f64;
    let mean = pairwise(heights, |h| (h - middle) / unit) / n;
    let square = pairwise(heights, |h| ((h - middle) / unit - mean).powi(2)) / n;
    unit * square.sqrt()
}

/// Root mean square slope from differences of neighbours inside the map, dimensionless.
///
/// `sqrt(mean over x-neighbours (Delta h / dx)^2 + mean over y-neighbours (Delta h / dy)^2)`: for bodies that
/// are not periodic. Pairs with an undefined point are left out. The slope falls below [`crate::rms_slope`]
/// on rough surfaces, whose shortest waves it damps (by `sin(q dx / 2) / (q dx / 2)` along x). A direction
/// without pairs adds nothing; 0 for one cell. Cost O(N) for N cells.
///
/// ```
/// use contact_model::HeightMap;
/// // A plane that rises by 3 per cell along x and 4 along y, cells of size 1.
/// let plane = HeightMap::new(2, 2.0, vec![0.0, 3.0, 4.0, 7.0])?;
/// assert!((surface_gen::rms_slope_differences(&plane) - 5.0).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn rms_slope_differences(map: &HeightMap) -> f64 {
    let (columns, heights) = (map.columns(), map.heights());
    let finite = |step: &f64| step.is_finite();
    let along_x =
        || heights.chunks_exact(columns).flat_map(|row| row.windows(2).map(|w| w[1] - w[0])).filter(finite);
    let along_y = || heights.iter().zip(&heights[columns..]).map(|(a, b)| b - a).filter(finite);
    let unit = along_x().chain(along_y()).fold(0.0, |unit: f64, step| unit.max(step.abs()));
    if unit <= 0.0 {
        return 0.0;
    }
    let (pairs_x, pairs_y) = if map.undefined() == 0 {
        (map.rows() * (columns - 1), columns * (map.rows() - 1))
    } else {
        (along_x().count(), along_y().count())
    };
    let square = |step: f64| (step / unit).powi(2);
    if pairs_x == 0 {
        return (along_y().map(square).sum::<f64>() / pairs_y as f64).sqrt() * (unit / map.dy());
    }
    // All pairs are counted as pairs along x.
    let weight =
        if pairs_y == 0 { 0.0 } else { (map.dx() / map.dy()).powi(2) * (pairs_x as f64 / pairs_y as f64) };
    let sum: f64 = along_x().map(square).chain(along_y().map(|step| weight * square(step))).sum();
    (sum / pairs_x as f64).sqrt() * (unit / map.dx())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A few roundings: sums of at most 4 terms.
    const ROUNDING: f64 = 4.0 * f64::EPSILON;

    #[test]
    fn extreme_heights_keep_their_rms() {
        for unit in [1e-150, 1e150, 1e-300, 1e300] {
            assert_relative_eq!(rms_height(&[unit, -unit]), unit, max_relative = ROUNDING);
            assert_relative_eq!(rms_height(&[0.0, unit, 0.0, unit]), 0.5 * unit, max_relative = ROUNDING);
            let map = HeightMap::new(2, 2.0 * unit, [0.0, 3.0, 4.0, 7.0].map(|h| h * unit).to_vec());
            assert_relative_eq!(rms_slope_differences(&map.unwrap()), 5.0, max_relative = ROUNDING);
        }
        assert!(rms_height(&[]) <= 0.0 && rms_height(&[7.0; 9]) <= 0.0);
    }

    #[test]
    fn moments_of_extreme_heights() {
        for unit in [1e-300, 1.0, 1e300] {
            let found = HeightMoments::new(&[unit, 0.0, 0.0, -unit]).unwrap();
            assert_relative_eq!(found.rms, unit * 0.5_f64.sqrt(), max_relative = ROUNDING);
            assert!(found.mean.abs() <= 0.0 && found.skewness.abs() < 1e-15);
            assert_relative_eq!(found.kurtosis, 2.0, max_relative = ROUNDING);
        }
        assert_eq!(HeightMoments::new(&[]), None);
    }

    #[test]
    fn an_offset_costs_its_own_rounding_only() {
        let heights = [0.25, 1.0, -0.5, 2.0];
        let lifted = heights.map(|h| h + 1_048_576.0);
        assert_relative_eq!(rms_height(&lifted), rms_height(&heights), max_relative = ROUNDING);
    }
}
