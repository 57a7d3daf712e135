//! Linear systems on one set of cells.

mod cholesky;
mod extension;
mod minres;
mod pcg;
mod preconditioner;

pub use cholesky::Factor;
pub use extension::Extension;
pub use minres::{MinresLimits, minres};
pub use pcg::{Energy, Fixed, LinearSystem, PcgOutcome, StoppingCriteria, Vectors, Workspace};
pub use preconditioner::{Preconditioned, Preconditioner, TORUS_ENERGY, TorusInverse};
