//! Influence coefficients: those of Love for a half-space that is unloaded outside the map, of a periodic
//! half-space, of a half-plane and of tangential tractions, and tables of them.

mod alternating;
mod coupling_table;
mod half_plane;
mod inverse;
pub mod love;
mod periodic;
mod symbol;
mod table;
mod tangential;
mod tangential_table;

pub use coupling_table::CouplingTable;
pub use inverse::Inverse;
pub use symbol::Symbol;
pub use table::{KernelTable, Medium};
pub use tangential_table::TangentialTable;
