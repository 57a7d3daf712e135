//! Stress below the surface of an elastic body, under the pressure and the tractions of a contact.
//!
//! Where does a contact yield first, and at which load? Not at its surface: below a round contact the
//! equivalent stress is largest at about half of its radius. This module takes the pressure and, with
//! friction, the tangential tractions of a state, and gives all six components of the stress in the body.
//!
//! ```
//! use contact_model::{Field, never};
//! use interface::stress::{StressedBody, SurfaceLoad, largest_von_mises, stress_at_points};
//! // Hertz's pressure with the radius 1 and the largest pressure 1, in the middle of a square of side 3.
//! let cells = 45;
//! let place = |i: usize| 3.0 * (i as f64 + 0.5) / cells as f64 - 1.5;
//! let pressure = |i: usize| (1.0 - place(i % cells).powi(2) - place(i / cells).powi(2)).max(0.0).sqrt();
//! let pressure = Field::new(cells, 3.0, (0..cells * cells).map(pressure).collect())?;
//! let (load, steel) = (SurfaceLoad::new(pressure)?, StressedBody::new(0.3));
//!
//! let largest = largest_von_mises(&load, steel, &[0.1, 0.2, 0.4, 0.8], &never)?;
//! // 0.620 at the depth 0.481 on the axis.
//! assert!((largest.value - 0.620).abs() < 2e-3 && (largest.depth - 0.481).abs() < 2e-3);
//! // The pressure may grow by this factor until the steel, of a yield stress of 2, yields.
//! let factor = largest.factor_until_yield(2.0)?;
//! assert!((factor.unwrap() - 2.0 * 1.613).abs() < 0.01);
//! // sigma_zz on the axis is -1/(1 + z^2).
//! let stress = stress_at_points(&load, steel, &[[1.5, 1.5, 2.0]], &never)?;
//! assert!((stress[0][2] + 0.2).abs() < 1e-3);
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! | function | what it gives |
//! |---|---|
//! | [`stress_at_depths`] | the stress at the centres of all cells, at a list of depths |
//! | [`SubsurfaceStress`] | the same, one depth after the other, so that none has to be kept |
//! | [`stress_section`] | the stress below a row or a column of the map |
//! | [`stress_at_points`] | the stress at single points |
//! | [`largest_von_mises`] | the largest equivalent stress, its place, and the factor until yield |
//! | [`von_mises`], [`tresca`], [`principal_stresses`] | numbers of one stress |
//!
//! # Conventions
//!
//! * **Axes.** x and y are those of the map, and z points **into the body** whose stress is wanted, from z =
//!   0 at its surface. The stress of the second body of a contact is therefore in axes of its own, with z
//!   into this body. In the axes of the first body its yz and xz have the opposite sign, and all other
//!   components are the same.
//! * **Components** are xx, yy, zz, yz, xz, xy, in this order. Tension is positive.
//! * **Load.** A pressure p > 0 pushes the body in. The tractions (q_x, q_y) are forces on the body per area
//!   along x and y. At the surface the stress is therefore `sigma_zz = -p`, `sigma_xz = -q_x` and `sigma_yz =
//!   -q_y`.
//! * **Bodies.** The traction of a state ([`contact_model::Fields::traction`]) acts on the first body, and
//!   the opposite one on the second. [`SurfaceLoad::of_state`] takes the body and chooses the sign. A
//!   positive tangential force along x pulls the first body along x.
//! * **Material.** The stress depends on Poisson's ratio alone. A body may have any ratio in [0, 1/2].
//!
//! # Method
//!
//! The load is constant in each cell. The stress under such a cell has a closed form (Love 1929 for a
//! pressure; the potentials of Boussinesq and Cerruti for a traction, as in Ahmadi, Keer, Mura 1983, Kalker
//! 1990, Liu and Wang 2002). Beyond eight sides of a cell, where a closed form loses digits, a rule of Gauss
//! integrates point forces. In a plane the sum over cells is a convolution, done by fast Fourier transforms
//! of twice the side of the map. It agrees with the sum over cells to 2e-14 of the largest stress at this
//! depth. The exception is a depth of many map sides: there the stress of a load whose parts cancel each
//! other is small, and the error is 1e-14 of the stress of its parts.
//!
//! # Maps that repeat themselves
//!
//! With [`contact_model::Boundary::Periodic`] a wave `p cos(q x)` causes `sigma_zz = -p (1 + q z) exp(-q z)
//! cos(q x)`, and similar stresses along x and y. Of a load that is constant in each cell, all waves are
//! summed up, also those shorter than two cells, so that values at the centres of cells are exact at any
//! depth. [`PeriodicLoad::Waves`] takes the waves of the grid alone.
//!
//! The **mean load** needs a decision, because its lateral stress depends on what holds the body far away.
//! Here a body cannot expand laterally: `sigma_xx = sigma_yy = -nu/(1 - nu) p`, as in a wide body between
//! neighbours that are loaded in the same way. A mean traction causes the shear stress that balances it, at
//! any depth, and no other stress. If the body can expand, add `nu/(1 - nu)` times the mean pressure to xx
//! and yy. A finite square of many copies on a free half-space has neither of these values: under its middle
//! the mean load causes `-(1 + 2 nu)/2` times the mean pressure, and under that of a long rectangle another
//! stress. Only stresses without those of the mean load have a limit for many copies that does not depend on
//! the shape of the array.
//!
//! With [`contact_model::Boundary::PeriodicAlongX`] or `PeriodicAlongY`, the mean along the line is in plane
//! strain, so that the body cannot expand along the line; a mean traction along the line causes antiplane
//! shear. These stresses have a limit for many copies along the line, so that there is nothing to decide.
//!
//! # Accuracy, speed and limits
//!
//! Errors of stresses are about 1e-14 of the largest one. Sixteen depths of a map of 512 x 512 cells took the
//! times below, on two cores of an AMD EPYC (`examples/subsurface_stress.rs`).
//!
//! | boundaries | a pressure | with tractions |
//! |---|---|---|
//! | free | 3.1 s, 67 MB | 5.0 s, 126 MB |
//! | periodic | 0.7 s, 26 MB | 0.8 s, 39 MB |
//! | periodic along x alone | 2.5 s, 80 MB | 6.4 s, 145 MB |
//!
//! What differs from a contact is the load, which is constant in cells. This shows at depths of a side of a
//! cell or less.
//!
//! * At the surface, where a traction jumps between two cells, the lateral stress on the edge is infinite.
//!   Centres of cells have finite values, but these grow with the logarithm of the number of cells if the
//!   traction itself jumps, as it does at the edge of a sliding contact of uniform traction. A pressure has
//!   such a logarithm in xy at the corners.
//! * A rough contact has its largest stress below one of its smallest patches, and finer grids have smaller
//!   patches.
//! * Plastic strain, residual stress, layers and the shape of the surface are not taken into account.

mod cell;
mod invariants;
mod largest;
mod load;
mod plan;
mod plane;
mod points;
mod potentials;
mod section;
mod wave;

pub use invariants::{principal_stresses, tresca, von_mises};
pub use largest::{LargestVonMises, largest_von_mises};
pub use load::{LoadedBody, PeriodicLoad, StressedBody, SurfaceLoad};
pub use plan::SubsurfaceStress;
pub use plane::StressField;
pub use points::stress_at_points;
pub use section::{SectionLine, StressSection, stress_section};

use contact_model::{Boundary, Cells, Result, Stop};

/// Maps of transforms and influence functions below a map that ends, and below one that repeats itself along both
/// axes: of a pressure, and with tractions.
const MAPS: [[f64; 2]; 2] = [[30.0, 60.0], [14.0, 26.0]];

/// Bytes that the stress at one depth below a map of these cells needs at its peak, approximately, the load included.
/// [`SubsurfaceStress::memory`] knows it more closely for a load.
pub fn stress_memory(cells: impl Into<Cells>, boundary: Boundary, has_tractions: bool) -> f64 {
    let maps = MAPS[usize::from(boundary == Boundary::Periodic)][usize::from(has_tractions)];
    let of_load = if has_tractions { 3.0 } else { 1.0 };
    (maps + of_load) * cells.into().map_bytes()
}

/// The stress at the centres of all cells, at each of the depths.
///
/// # Errors
/// Those of [`SubsurfaceStress::new`] and [`SubsurfaceStress::at_depth`], for the first depth that has one.
///
/// Cost: that of [`SubsurfaceStress::at_depth`] for each depth; all depths are kept, 48 bytes for each cell.
pub fn stress_at_depths(
    load: &SurfaceLoad,
    body: StressedBody,
    depths: &[f64],
    stop: Stop<'_>,
) -> Result<Vec<StressField>> {
    load::scaled_depths(load, depths)?;
    load::check_memory(load.cells(), 6.0 * load.cells().map_bytes() * depths.len() as f64)?;
    let plan = SubsurfaceStress::new(load, body)?;
    depths.iter().map(|&depth| plan.at_depth(depth, stop)).collect()
}

#[cfg(test)]
mod tests;
