//! The stress at single points, by the sum over all loaded cells.

use super::cell::RectangularCell;
use super::load::{StressedBody, SurfaceLoad, check_memory, near};
use super::potentials::combine;
use contact_model::{Boundary, Error, Interrupted, Result, Stop};
use numerics::parallel::{for_each_until, threads_for};

/// Cells whose stress one task sums.
const CHUNK: usize = 1024;
/// Work of one cell at one point, in elements of a vector loop.
const PAIR: usize = 64;

/// The stress at points (x, y, z) with z >= 0, anywhere in the half-space: components xx, yy, zz, yz, xz, xy.
///
/// The map begins at x = y = 0. Stresses are sums of closed forms over the loaded cells. Tests take this
/// function as the reference of [`super::stress_at_depths`].
///
/// Cost: about 0.3 us for each pair of a point and a loaded cell. The error is about 1e-14 of the largest
/// traction. On the edge of a cell at the surface, where the traction jumps, normal and shear stress in the
/// surface are the means of both sides, and an infinite lateral stress is that at a distance of 1e-12 sides
/// of a cell.
///
/// # Errors
/// [`Error::Domain`] for Poisson's ratio, and for a coordinate that is not finite, beyond 1e60 sides of a
/// cell, or above the surface; [`Error::Unsupported`] for a map that repeats itself; [`Error::OutOfMemory`];
/// [`Error::Stopped`] where `stop` says so.
///
/// ```
/// use contact_model::{Field, never};
/// use interface::stress::{StressedBody, SurfaceLoad, stress_at_points};
/// // A unit force, seen from ten sides below it: sigma_zz = -3/(2 pi z^2) of Boussinesq's point force.
/// let load = SurfaceLoad::new(Field::new(1, 1.0, vec![1.0])?)?;
/// let stress = stress_at_points(&load, StressedBody::new(0.3), &[[0.5, 0.5, 10.0]], &never)?;
/// assert!((stress[0][2] * -200.0 * std::f64::consts::PI / 3.0 - 1.0).abs() < 0.01);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn stress_at_points(
    load: &SurfaceLoad,
    body: StressedBody,
    points: &[[f64; 3]],
    stop: Stop<'_>,
) -> Result<Vec<[f64; 6]>> {
    body.validate()?;
    if body.boundary != Boundary::Free {
        let what = format!("{} (maps at any depth can have them)", body.boundary.words());
        return Err(Error::unsupported("stress at points", what));
    }
    let (c, sides) = load.unit();
    let places = scaled_points(points, c)?;
    let loaded = loaded_cells(load, sides);
    let chunks = loaded.len().div_ceil(CHUNK);
    check_memory(load.cells(), 48.0 * points.len() as f64 * (chunks + 1) as f64)?;
    let cell = RectangularCell::new(sides);
    let mut parts = vec![[0.0; 6]; points.len() * chunks];
    let work = points.len().saturating_mul(loaded.len()).saturating_mul(PAIR);
    let mut threads = vec![(); threads_for(work)];
    let all =
        for_each_until(&mut threads, parts.iter_mut().enumerate(), &|| stop.stops(), |(), (task, sum)| {
            let (place, chunk) = (places[task / chunks], task % chunks);
            let part = loaded.iter().skip(chunk * CHUNK).take(CHUNK);
            for ([x, y], load) in part {
                let potentials = cell.potentials([place[0] - x, place[1] - y, place[2]]);
                let stress = combine(&potentials.kernels(body.poisson), *load);
                for (sum, stress) in sum.iter_mut().zip(stress) {
                    *sum += stress;
                }
            }
        });
    if !all {
        return Err(Interrupted.without_state());
    }
    let scale = load.largest();
    let total = |point: usize| {
        let parts = &parts[point * chunks..][..chunks];
        std::array::from_fn(|component| scale * parts.iter().map(|part| part[component]).sum::<f64>())
    };
    let stresses: Vec<[f64; 6]> = (0..points.len()).map(total).collect();
    match stresses.as_flattened().iter().find(|value| !value.is_finite()) {
        Some(value) => Err(Error::not_representable("stress", *value)),
        None => Ok(stresses),
    }
}

/// The centres of the loaded cells, and their tractions over the largest.
fn loaded_cells(load: &SurfaceLoad, sides: [f64; 2]) -> Vec<([f64; 2], [f64; 3])> {
    let scale = load.largest();
    let (components, columns) = (load.components(), load.cells().columns);
    let cells = (0..load.pressure().values().len()).filter_map(|i| {
        let mut tractions = [0.0; 3];
        for (axis, field) in &components {
            tractions[*axis] = field.values()[i] / scale;
        }
        let centre = [(i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5];
        let is_loaded = tractions.iter().any(|traction| traction.abs() > 0.0);
        is_loaded.then(|| ([centre[0] * sides[0], centre[1] * sides[1]], tractions))
    });
    cells.collect()
}

/// Checks points, and returns them in units of c.
fn scaled_points(points: &[[f64; 3]], c: f64) -> Result<Vec<[f64; 3]>> {
    let mut scaled = Vec::with_capacity(points.len());
    for (i, point) in points.iter().enumerate() {
        let mut place = [0.0; 3];
        for ((axis, to), value) in ["x", "y", "z"].into_iter().zip(&mut place).zip(point) {
            let name = || format!("points[{i}].{axis}");
            if !value.is_finite() {
                return Err(Error::domain(name(), *value, "a finite number"));
            }
            if axis == "z" && *value < 0.0 {
                return Err(Error::of_non_negative(name(), *value));
            }
            *to = near(name, *value, value / c)?;
        }
        scaled.push(place);
    }
    Ok(scaled)
}
