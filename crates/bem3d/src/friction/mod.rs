//! Coulomb's friction in three dimensions.

mod coupled;
mod disks;
mod increment;
mod linearised;
mod state;
mod stiffness;
#[cfg(test)]
mod tests;

pub use increment::{FrictionLimits, TangentialControl};
pub use state::{Friction, FrictionLoad, PressedCells, SlipMemory, StiffnessOf};
