//! Friction in three dimensions, one increment of a path at a time.
//!
//! **Signs.** delta is the tangential displacement of one body, far away, relative to the other; q is the traction
//! that this body exerts on the other, and T, the sum of q, is the force that moves it. The surfaces give way by
//! `u = K q`, so that the slip of an increment is `w = (delta - u) - (delta - u)_before`, and friction holds
//! `|q| <= b` and `q . w = b |w|` in every cell, with the largest traction b that the law of friction gives for the
//! pressure of the cell (`mu p` by Coulomb's law): the traction on the other body has the direction of the slip,
//! and what friction dissipates, `sum(q . w)`, is never negative. Dundurs' beta is that with the other body, on
//! which q acts, as the first one.
//!
//! **Slip references.** The term that is subtracted, `(delta - u)_before`, is known on every cell of the
//! surface, in contact or not: a cell that comes into contact takes its reference from there, one that leaves
//! forgets its slip. The moment within the increment at which a cell touches changes no traction
//! (`FrictionSolver::advance`), unless pressures cause tangential displacements: then the steps of a growing
//! contact have to be small.
//!
//! **Certificate.** The duality gap `sum(b |w| - q . w)` of admissible tractions bounds the square of their
//! error in the norm of K. It is given relative to the sum B of b times a length, the larger of |delta| and of the largest
//! reference: a force-weighted mean of the slip that stick cells still have. The length vanishes only where delta
//! and all references do, and the tractions with them; it does not at `delta = 0` after a reversal. The
//! displacement and the energy are accurate to about the gap times `B/T`.
//!
//! **Laws.** The law enters through b alone, one number for each cell and increment. A law that allows a traction
//! without any pressure makes B depend on which cells touch: a cell that touches with a vanishing pressure adds its
//! shear strength at once.
//!
//! Vectors hold the components along x of all cells, then those along y. Lengths and tractions are nondimensional as
//! in the normal problem: cells of area 1, tractions so that `u = sum K q`.
//!
//! | part | contents | reference implementation in the tests |
//! |---|---|---|
//! | `linearised` | the linear system of stick and slip cells, and its preconditioner | `increment` |
//! | `increment` | Newton's method with line searches, the descent of `law` where it fails, certificate | dense matrices and accelerated gradients along paths; differences of two pressures without Poisson's ratio |
//! | `state` | the memory of a path, and its increments | energy balance over loops |
//! | `coupled` | normal and tangential contact in turn where beta is not 0 | sums over pairs |

mod coupled;
mod increment;
mod linearised;
mod state;
#[cfg(test)]
mod tests;

pub use coupled::{CoupledGuess, CoupledLoad, CoupledState, CoupledSurface, advance as advance_coupled};
pub use increment::{FrictionLimits, TangentialControl, exact};
pub use linearised::{FrictionRoom, SlipBranch, inverse_of};
pub use state::{
    FrictionLoad, FrictionSolver, FrictionState, NotAdvanced, PressedCells, SlipMemory, SlipStep,
};
