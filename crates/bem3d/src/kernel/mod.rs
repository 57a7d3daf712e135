//! Influence coefficients: Love's for a half-space that is unloaded outside the map, the periodic ones, those
//! of a half-plane, and tables of them.

mod alternating;
mod half_plane;
pub mod love;
mod periodic;
mod symbol;
mod table;

pub use symbol::Symbol;
pub use table::{KernelTable, Medium};
