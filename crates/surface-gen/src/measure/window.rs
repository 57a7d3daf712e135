//! The spectrum of a map that is not periodic, and where an exponent is fitted to it.

use super::defined::defined_everywhere;
use contact_model::{Cells, HeightMap, Result};
use numerics::range::{middle_and_half_width, range};
use std::f64::consts::{PI, TAU};

/// First ring of the fit: the first ones bend it (see [`crate::radial_spectrum`]), and a window smears
/// each over its neighbours.
const FIRST_RING: f64 = 8.0;

/// The fit ends at this share of the shortest wave's wavenumber: instruments damp what is next to it.
const LAST_SHARE: f64 = 0.5;

/// Hann's window along one axis, `sin^2(pi (i + 1/2)/count)` at the centres of the cells; the mean of its
/// squares is 3/8 for 3 cells or more.
///
/// ```
/// let window = surface_gen::hann_window(4);
/// assert!((window.iter().map(|w| w * w).sum::<f64>() / 4.0 - 0.375).abs() < 1e-15);
/// ```
pub fn hann_window(count: usize) -> Vec<f64> {
    (0..count).map(|i| (PI * (i as f64 + 0.5) / count as f64).sin().powi(2)).collect()
}

/// Mean of the squares of [`hann_window`].
fn mean_square(count: usize) -> f64 {
    match count {
        1 => 1.0,
        2 => 0.25,
        _ => 0.375,
    }
}

/// The heights about their mean, multiplied by Hann's window along x and along y and divided by the rms of
/// the window, so that a homogeneous surface keeps its spectrum.
///
/// The window keeps the jump between opposite edges out of the short waves, but it spreads each ring of the
/// spectrum over its neighbours. Cost O(N).
///
/// # Errors
/// [`contact_model::Error::Domain`] for undefined points, and those of [`HeightMap::new`] where a height
/// leaves the range of f64.
pub fn windowed(map: &HeightMap) -> Result<HeightMap> {
    defined_everywhere(map, "a window")?;
    let Cells { columns, rows } = map.cells();
    let (middle, _) = middle_and_half_width(range(map.heights()));
    let (across, down) = (hann_window(columns), hann_window(rows));
    let rms = (mean_square(columns) * mean_square(rows)).sqrt();
    let about: Vec<f64> = map.heights().iter().map(|h| h - middle).collect();
    let count = about.len() as f64;
    let mean: f64 = about.chunks_exact(columns).map(|row| row.iter().map(|h| h / count).sum::<f64>()).sum();
    let heights = about
        .iter()
        .enumerate()
        .map(|(i, h)| (h - mean) * across[i % columns] * down[i / columns] / rms)
        .collect();
    HeightMap::new(map.cells(), map.size(), heights)
}

/// Range of wavenumbers in which a Hurst exponent is fitted: from the wavelength of an eighth of the shorter
/// side to that of four times the longer cell side.
pub fn fit_range(map: &HeightMap) -> [f64; 2] {
    [TAU / map.size().shorter() * FIRST_RING, LAST_SHARE * PI / map.dx().max(map.dy())]
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn squares_of_the_window_have_the_mean_1_over_profiles_too() {
        for [columns, rows] in [[7, 5], [9, 1], [2, 6], [1, 4]] {
            // A spike of height 1 at every cell in turn: what is left of all of them, squared, is the
            // window's mean square.
            let cells = columns * rows;
            let square = |at: usize| {
                let heights = (0..cells).map(|i| f64::from(u8::from(i == at))).collect();
                let map = HeightMap::new([columns, rows], [columns as f64, rows as f64], heights).unwrap();
                (windowed(&map).unwrap().heights()[at] / (1.0 - (cells as f64).recip())).powi(2)
            };
            let mean = (0..cells).map(square).sum::<f64>() / cells as f64;
            assert_relative_eq!(mean, 1.0, max_relative = 1e-12);
        }
    }
}
