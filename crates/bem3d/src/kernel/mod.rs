//! Kernels: how tractions on rectangular cells displace the surfaces of the bodies, and tables of them.
//!
//! A kernel is a file of this folder ([`Kernel`] says what it has to state) and a line of `table.rs`, where
//! kernels are listed. [`KernelTable`] keeps its coefficients and the symbols made from it for all surfaces of a
//! grid.

mod along_a_line;
mod alternating;
mod cerruti;
mod coupling;
mod definition;
mod half_plane;
mod half_space;
mod inverse;
mod layer;
mod layer_flux;
mod layer_symbol;
pub mod love;
mod period;
mod periodic;
mod symbol;
mod table;
mod tangential;
mod tensor;
mod waves;

pub use definition::{Evidence, Kernel};
pub use inverse::Inverse;
pub use layer::LayerOnGrid;
pub use layer_symbol::LayerSymbol;
pub use periodic::PeriodicKernel;
pub use symbol::Symbol;
pub use table::{CouplingTable, KernelTable, Medium, NormalTable, TangentialTable};
pub use tensor::{Invertible, Symmetric, Tensor};
