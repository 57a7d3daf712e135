//! Stress below the surface of an elastic body, under the pressure and the tractions of a contact.
//!
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

use contact_model::{Result, Stop};

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
