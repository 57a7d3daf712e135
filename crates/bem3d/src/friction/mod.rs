//! Coulomb's friction in three dimensions.

mod disks;
mod increment;
mod linearised;
mod state;
mod stiffness;
#[cfg(test)]
mod tests;

pub use increment::{FrictionLimits, Sliding, TangentialControl};
pub use state::{ForceTooLarge, Friction, FrictionState, PressedCells, SlipMemory, StiffnessOf};
pub use stiffness::TangentialStiffness;
