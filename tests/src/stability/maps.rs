//! Maps made by hand, and the symmetries of the square.

use contact_model::{HeightMap, Result, Scene, SelfAffine, Surface};
use std::sync::Arc;

/// A map of `cells` x `cells` heights `h(ix, iy)`.
///
/// # Errors
/// Those of [`HeightMap::new`].
pub fn map(cells: usize, side: f64, h: impl Fn(usize, usize) -> f64) -> Result<HeightMap> {
    let heights = (0..cells * cells).map(|i| h(i % cells, i / cells)).collect();
    HeightMap::new(cells, side, heights)
}

/// A scene of a map with modulus 1 that requests the stiffness.
pub fn scene(map: HeightMap) -> Scene {
    Scene::new(Surface::Heights(Arc::new(map)), 1.0)
}

/// The paper's surface of side 1 and rms height 1.
///
/// # Errors
/// Those of [`SelfAffine::new`].
pub fn rough(fractal_dimension: f64) -> Result<SelfAffine> {
    SelfAffine::new(fractal_dimension, 1.0, 1.0)
}

/// The paper's surface on a grid.
///
/// # Errors
/// Those of [`surface_gen::self_affine_map`].
pub fn rough_map(fractal_dimension: f64, cells: usize, seed: u64) -> Result<HeightMap> {
    surface_gen::self_affine_map(&rough(fractal_dimension)?, cells, seed)
}

/// Maps of `cells` x `cells` on which solvers have failed, made from random numbers in [0, 1). The kinds are
/// white noise (0), the same in steps (1), stripes (2), a tilted plane (3), a few spikes (4), one sharp
/// summit (5), heights over twenty decades (any other kind).
///
/// # Errors
/// Those of [`HeightMap::new`].
///
/// # Panics
/// For no numbers at all.
pub fn hard_map(kind: u8, cells: usize, noise: &[f64]) -> Result<HeightMap> {
    let at = |x: usize, y: usize| noise[(y * cells + x) % noise.len()];
    map(cells, 1.0, |x, y| match kind {
        0 => at(x, y),
        1 => (4.0 * at(x, y)).floor(),
        2 => ((x / 2 + y / 3) % 2) as f64,
        3 => 0.1 * x as f64 + 0.03 * y as f64,
        4 if at(x, y) < 0.02 => 1.0,
        4 => 0.01 * at(x, y),
        5 => -(x as f64 - 0.5 * cells as f64).hypot(y as f64 - cells as f64 / 3.0),
        _ => at(x, y).powi(20),
    })
}

/// A map with `factor` times as many cells along a side: the given map in the middle, and all other cells at
/// `height`.
///
/// # Errors
/// Those of [`HeightMap::new`].
pub fn embedded(of: &HeightMap, factor: usize, height: f64) -> Result<HeightMap> {
    let (n, h) = (of.columns(), of.heights());
    let first = (factor - 1) * n / 2;
    let inside = first..first + n;
    map(factor * n, of.length() * factor as f64, |x, y| {
        if inside.contains(&x) && inside.contains(&y) { h[(y - first) * n + x - first] } else { height }
    })
}
