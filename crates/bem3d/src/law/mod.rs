//! Laws of the tractions of a cell that are convex sets, and the fall-back that serves all of them.
//!
//! A pressure lies between zero and the hardness, the traction of friction in a disc. Both are convex sets. With
//! given attraction and given limits, the state under a load is the minimum of a quadratic energy over them, so
//! that one projection, one duality gap and one fall-back serve both ([`ConvexLaw`], [`descend`]). Attraction is no such
//! law: it is held while the convex problem is solved (`adhesion`).

mod definition;
mod descent;
mod disc;
mod interval;

pub use definition::ConvexLaw;
pub use descent::{Descent, descend};
pub use disc::{Discs, excess, length, sums, total};
pub use interval::PressureRange;
