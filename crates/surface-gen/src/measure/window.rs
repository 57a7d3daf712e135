//! The spectrum of a map that is not periodic, and where an exponent is fitted to it.

use contact_model::{Cells, HeightMap};
use std::f64::consts::{PI, TAU};

/// First ring of the fit: the first ones bend it (see [`crate::radial_spectrum`]), and a window smears
/// each over its neighbours.
const FIRST_RING: f64 = 8.0;

/// The fit ends at this share of the shortest wave's wavenumber: instruments damp what is next to it.
const LAST_SHARE: f64 = 0.5;

/// Mean square of Hann's window sin^2 along one axis, 3/8, for both axes: the square root of `(3/8)^2`.
const WINDOW: f64 = 0.375;

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

/// The map about its mean under Hann's window, scaled so that a homogeneous surface keeps its spectrum;
/// `None` where a point is undefined.
///
/// The window keeps the jump between opposite edges out of the short waves and smears each ring of the
/// spectrum over its neighbours. Cost O(N).
pub fn windowed(map: &HeightMap) -> Option<HeightMap> {
    if map.undefined() > 0 {
        return None;
    }
    let Cells { columns, rows } = map.cells();
    let ends = |(low, high): (f64, f64), h: f64| (low.min(h), high.max(h));
    let (low, high) = map.defined().fold((f64::INFINITY, f64::NEG_INFINITY), ends);
    let middle = 0.5 * low + 0.5 * high;
    let (across, down) = (hann_window(columns), hann_window(rows));
    let about: Vec<f64> = map.heights().iter().map(|h| h - middle).collect();
    let count = about.len() as f64;
    let mean: f64 = about.chunks_exact(columns).map(|row| row.iter().map(|h| h / count).sum::<f64>()).sum();
    let heights = about
        .iter()
        .enumerate()
        .map(|(i, h)| (h - mean) * across[i % columns] * down[i / columns] / WINDOW)
        .collect();
    HeightMap::new(map.cells(), map.size(), heights).ok()
}

/// Wavenumbers from and to which a Hurst exponent is fitted: from waves of an eighth of the shorter side to
/// waves of four of the longer cell sides.
pub fn fit_range(map: &HeightMap) -> [f64; 2] {
    [TAU / map.size().shorter() * FIRST_RING, LAST_SHARE * PI / map.dx().max(map.dy())]
}
