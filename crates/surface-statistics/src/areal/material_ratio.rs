//! Functional parameters: the areal material ratio curve and its straight line.

use crate::relative::{Relative, finite};
use contact_model::{Error, HeightMap, Result};
use numerics::sum::pairwise;

/// Width of the secant, as a share of all points.
const SECANT: f64 = 0.4;
/// Fewest defined points: of fewer, two fifths are no line.
const FEWEST: usize = 10;

/// Functional parameters (ISO 25178-2, functional parameters of the areal material ratio curve). Maps may have
/// undefined points.
///
/// How much of a surface carries load after running-in, how much is worn before, and how much holds a
/// lubricant? The areal material ratio curve c(mr) is the height above which there is the share mr of the
/// points: it falls from the highest point at 0 to the lowest at 1. The middle of the curve, the core, is
/// replaced by a straight line. It lies where the secant over a width of 0.4 has the smallest slope, in the first
/// such place of several, and is the line of least squares of the heights there. The line goes on to the shares
/// 0 and 1; between its ends there is the core, above them are the peaks, and below them the valleys. The
/// construction is that of ISO 13565-2:1996, 4, for profiles.
///
/// Between the sorted heights z_i, at the shares `(i + 1/2)/n`, the curve is interpolated linearly.
///
/// ```
/// use contact_model::HeightMap;
/// use surface_statistics::FunctionalParameters;
/// // Heights that are uniform in [0, 1]: the curve is a line, and all of the surface is its core.
/// let map = HeightMap::from_fn(32, 1.0, |ix, iy| (32.0 * iy as f64 + ix as f64 + 0.5) / 1024.0)?;
/// let found = FunctionalParameters::new(&map)?;
/// assert!((found.sk - 1.0).abs() < 1e-12 && found.spk.abs() < 1e-12 && found.svk.abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FunctionalParameters {
    /// Core height Sk, a length: the difference of the ends of the line.
    pub sk: f64,
    /// Reduced peak height Spk, a length: the height of a triangle over the width Smr1 with the cross-section of
    /// the peaks above the core; 0 where there are none.
    pub spk: f64,
    /// Reduced valley depth Svk, a length: likewise, over the width 1 - Smr2.
    pub svk: f64,
    /// Share of the points that are peaks above the core.
    pub smr1: f64,
    /// Share of the points that are no valleys below it.
    pub smr2: f64,
}

impl FunctionalParameters {
    /// Measures a map. Cost O(N log N).
    ///
    /// # Errors
    /// [`Error::Domain`] for fewer than 10 defined points, for heights that are all equal, and for numbers beyond
    /// the range of f64.
    pub fn new(map: &HeightMap) -> Result<Self> {
        let Relative { heights, unit } = Relative::new(map);
        let mut falling: Vec<f64> = heights.into_iter().filter(|h| !h.is_nan()).collect();
        let count = falling.len();
        if count < FEWEST {
            let expected = format!("at least {FEWEST}: a material ratio curve needs some");
            return Err(Error::domain("defined points", count as f64, expected));
        }
        falling.sort_unstable_by(|a, b| b.total_cmp(a));
        if falling[count - 1] >= falling[0] {
            return Err(Error::domain("rms height of the map", 0.0, "a rough surface: a finite number > 0"));
        }
        let [high, low] = line_of_core(&falling);
        let peaks = falling.partition_point(|&h| h > high);
        let last = falling.partition_point(|&h| h >= low);
        // Twice the area over its base is twice the mean.
        let twice_mean = |heights: &[f64], from: f64| {
            if heights.is_empty() {
                return 0.0;
            }
            2.0 * heights.iter().map(|h| (h - from).abs()).sum::<f64>() / heights.len() as f64
        };
        Ok(Self {
            sk: finite("Sk", (high - low) * unit)?,
            spk: finite("Spk", twice_mean(&falling[..peaks], high) * unit)?,
            svk: finite("Svk", twice_mean(&falling[last..], low) * unit)?,
            smr1: peaks as f64 / count as f64,
            smr2: last as f64 / count as f64,
        })
    }
}

/// Heights of the line through the core at the shares 0 and 1.
fn line_of_core(falling: &[f64]) -> [f64; 2] {
    let count = falling.len();
    let width = SECANT * count as f64;
    let (steps, rest) = (width as usize, width.fract());
    let end = |i: usize| {
        let next = falling.get(i + steps + 1).copied().unwrap_or(falling[i + steps]);
        falling[i + steps] + rest * (next - falling[i + steps])
    };
    let mut best = (f64::INFINITY, 0);
    let starts = count - steps - usize::from(rest > 0.0);
    for (i, height) in falling.iter().enumerate().take(starts) {
        let fall = height - end(i);
        if fall < best.0 {
            best = (fall, i);
        }
    }
    let first = best.1;
    // Least squares over the points of the secant, about its middle.
    let inside = &falling[first..=first + steps];
    let middle = 0.5 * steps as f64;
    let about = |k: usize| k as f64 - middle;
    let mean = pairwise(inside, |h| h) / inside.len() as f64;
    let product: f64 = inside.iter().enumerate().map(|(k, h)| about(k) * (h - mean)).sum();
    let square: f64 = (0..inside.len()).map(|k| about(k).powi(2)).sum();
    let slope = -product / square * count as f64;
    let high = mean + slope * (first as f64 + middle + 0.5) / count as f64;
    [high, high - slope]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// A map of a column whose heights are those of a curve at the shares (i + 1/2)/n.
    fn of(curve: impl Fn(f64) -> f64, count: usize) -> FunctionalParameters {
        let heights = (0..count).map(|i| curve((i as f64 + 0.5) / count as f64)).collect();
        FunctionalParameters::new(&HeightMap::new([1, count], [1.0, count as f64], heights).unwrap()).unwrap()
    }

    #[test]
    fn a_line_is_all_core() {
        for count in [10, 11, 57, 4096] {
            let found = of(|mr| 3.0 - 2.0 * mr, count);
            assert_relative_eq!(found.sk, 2.0, max_relative = 1e-12);
            assert!(found.spk < 1e-12 && found.svk < 1e-12, "{found:?}");
        }
    }

    /// A plateau whose heights are uniform in [0, a], in a share 1 - s of the points, and valleys uniform in
    /// [-d, 0]. The line of the plateau ends at `-a s/(1 - s)`, and what is below it is a triangle.
    #[test]
    fn a_plateau_with_valleys() {
        let (a, d, s) = (0.5, 4.0, 0.2);
        let curve = |mr: f64| {
            if mr < 1.0 - s { a * (1.0 - mr / (1.0 - s)) } else { -d * (mr - (1.0 - s)) / s }
        };
        let found = of(curve, 100_000);
        let end = a * s / (1.0 - s);
        assert_relative_eq!(found.sk, a / (1.0 - s), max_relative = 1e-9);
        assert_relative_eq!(found.svk, d - end, max_relative = 1e-4);
        assert_relative_eq!(found.smr2, 1.0 - s + s * end / d, max_relative = 1e-4);
        assert!(found.spk < 1e-9 && found.smr1 < 1e-4, "{found:?}");
        // Upside down valleys are peaks.
        let turned = of(|mr| -curve(1.0 - mr), 100_000);
        assert_relative_eq!(turned.spk, found.svk, max_relative = 1e-9);
        assert_relative_eq!(turned.sk, found.sk, max_relative = 1e-9);
        assert_relative_eq!(turned.smr1, 1.0 - found.smr2, max_relative = 1e-4);
    }

    /// Gaussian heights: the secant lies in the middle, from 0.3 to 0.7, where the line of least squares through
    /// the quantiles has the slope Sk = 2.5740 sigma, by numerical integration. Above half of it,
    /// z_1 = 1.2870 sigma, there is the share 0.09905, with the mean excess `phi(z_1)/0.09905 - z_1 = 0.47252` sigma.
    #[test]
    fn gaussian_heights() {
        // By inversion of the distribution, summed in small steps.
        let count = 200_000;
        let (mut z, mut share, step) = (8.0_f64, 0.0, 1e-5);
        let mut heights = Vec::with_capacity(count);
        while heights.len() < count {
            share += step * (-0.5 * (z - 0.5 * step).powi(2)).exp() / std::f64::consts::TAU.sqrt();
            z -= step;
            while heights.len() < count && share >= (heights.len() as f64 + 0.5) / count as f64 {
                heights.push(z);
            }
            if z < -9.0 {
                break;
            }
        }
        let count = heights.len();
        let map = HeightMap::new([count, 1], [count as f64, 1.0], heights).unwrap();
        let found = FunctionalParameters::new(&map).unwrap();
        assert_relative_eq!(found.sk, 2.5740, max_relative = 1e-3);
        assert_relative_eq!(found.smr1, 0.09905, max_relative = 5e-3);
        assert_relative_eq!(found.spk, 0.9450, max_relative = 5e-3);
        assert_relative_eq!(found.svk, 0.9450, max_relative = 5e-3);
    }

    #[test]
    fn undefined_points_and_units() {
        let heights = |i: usize| if i % 7 == 3 { f64::NAN } else { 1e-6 * ((i * 37 % 101) as f64) };
        let map = HeightMap::with_undefined(30, 1.0, (0..900).map(heights).collect()).unwrap();
        let found = FunctionalParameters::new(&map).unwrap();
        assert_relative_eq!(found.sk, 101e-6, max_relative = 0.02);
        assert!(FunctionalParameters::new(&HeightMap::new(3, 1.0, vec![0.0; 9]).unwrap()).is_err());
        assert!(FunctionalParameters::new(&HeightMap::new(4, 1.0, vec![2.0; 16]).unwrap()).is_err());
    }
}
