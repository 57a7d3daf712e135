//! Linear systems on one set of cells.

mod cholesky;
mod extension;
mod pcg;
mod preconditioner;

pub use cholesky::Factor;
pub use pcg::{Energy, Fixed, StoppingCriteria, Workspace};
