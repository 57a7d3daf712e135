//! Influence coefficients: Love's for a half-space that is unloaded outside the map, the periodic ones, and tables of both.

mod alternating;
pub mod love;
mod periodic;
mod symbol;
mod table;

pub use symbol::Symbol;
pub use table::KernelTable;
