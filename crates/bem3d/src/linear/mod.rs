//! Linear systems on one set of cells.

mod cholesky;
mod extension;
mod minres;
mod pcg;
mod preconditioner;

pub use cholesky::Factor;
pub use extension::Extension;
pub use minres::minres;
pub use pcg::{Energy, Fixed, PcgOutcome, StoppingCriteria, Vectors, Workspace, pcg};
pub use preconditioner::{Preconditioned, Preconditioner, TORUS_ENERGY, TorusInverse};
