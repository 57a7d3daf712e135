//! Deterministic bodies, sampled at the cells' centres; the apex sits in the middle of the square at height 0.

use contact_model::{Error, HeightMap, Result};
use std::f64::consts::TAU;

/// How far outside its face a flat circular punch lies back, in sides of the square.
///
/// The linear theory ends at approaches of a fraction of the side; a thousand sides is beyond any load that it can be asked for,
/// and still small enough that heights of neighbouring cells can be subtracted without overflow.
pub(crate) const RECESS: f64 = 1e3;

/// `-depth(r)` at every cell centre, r from the middle of the square.
pub(crate) fn axisymmetric(cells: usize, side: f64, depth: impl Fn(f64) -> f64) -> Result<HeightMap> {
    let half_cell = 0.5 * side / cells as f64;
    from_distances(cells, side, |twice2| 0.0 - depth(half_cell * twice2.sqrt()))
}

/// A flat circular face at height 0; `RECESS` sides lower outside it.
pub(crate) fn flat_circle(cells: usize, side: f64, radius: f64) -> Result<HeightMap> {
    let twice = 2.0 * radius / side * cells as f64;
    let nearest = if cells.is_multiple_of(2) { 2.0 } else { 0.0 };
    if twice * twice < nearest || radius > 0.5 * side {
        let expected = format!("a face that fits in the square of side {side} and covers a cell's centre");
        return Err(Error::domain("radius", radius, expected));
    }
    from_distances(cells, side, |twice2| if twice2 <= twice * twice { 0.0 } else { -RECESS * side })
}

/// `height(s)` with s the squared distance from the middle in half cells: an exact integer, so that maps have all symmetries of the square.
fn from_distances(cells: usize, side: f64, height: impl Fn(f64) -> f64) -> Result<HeightMap> {
    let twice = |i: usize| 2.0 * i as f64 + 1.0 - cells as f64;
    sampled(cells, side, |ix, iy| height(twice(ix) * twice(ix) + twice(iy) * twice(iy)))
}

/// `amplitude cos(2 pi x / wavelength)`, x from the edge of the square.
pub(crate) fn sine(cells: usize, side: f64, amplitude: f64, wavelength: f64) -> Result<HeightMap> {
    let periods = side / wavelength;
    if 2.0 * periods > cells as f64 {
        let shortest = 2.0 * side / cells as f64;
        let expected = format!("at least two cells, {shortest}");
        return Err(Error::domain("wavelength", wavelength, expected));
    }
    let row: Vec<f64> = (0..cells)
        .map(|ix| {
            let turns = periods * ((ix as f64 + 0.5) / cells as f64);
            amplitude * (TAU * turns.fract()).cos()
        })
        .collect();
    sampled(cells, side, |ix, _| row[ix])
}

/// All heights 0.
pub(crate) fn flat_square(cells: usize, side: f64) -> Result<HeightMap> {
    sampled(cells, side, |_, _| 0.0)
}

fn sampled(cells: usize, side: f64, height: impl Fn(usize, usize) -> f64) -> Result<HeightMap> {
    let mut heights = Vec::new();
    match cells.checked_mul(cells) {
        Some(len) if heights.try_reserve_exact(len).is_ok() => {}
        _ => return Err(Error::domain("cells", cells as f64, "a map that fits in memory")),
    }
    for iy in 0..cells {
        heights.extend((0..cells).map(|ix| height(ix, iy)));
    }
    HeightMap::new(cells, side, heights)
}
