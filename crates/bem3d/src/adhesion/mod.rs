//! Adhesion: an attractive traction across open gaps, beside the contact conditions. A short range is one
//! below the size of a cell.

mod attraction;
mod bottleneck;
mod equilibrium;
mod law;
mod linearised;
mod near;
mod neighbours;
mod newton;
mod pairs;
mod relaxation;
mod search;
mod update;

pub use attraction::Attraction;
pub use equilibrium::{AdhesiveControl, Equilibrium, energy};
pub use law::Law;
pub use linearised::{Response, fixed_area, respond};
pub use search::{Ended, Search};

#[cfg(test)]
mod fronts;
#[cfg(test)]
mod tests;
