//! Hard cases of contact mechanics: each is solved, and its result is compared with a physical or exact one.
//!
//! # What it computes
//!
//! On which problems do solvers of this field fail? [`cases`] is a registry of such problems: one cell, ties,
//! full contact, loads over sixteen decades, units at the ends of f64, misleading warm starts, limits.
//!
//! A [`HardCase`] says why it is hard and what is asserted. [`HardCase::run`] solves it and returns a [`CaseResult`].
//! This has the largest deviation found ([`CaseResult::figure`]), the bound of this deviation, and the
//! assertions that do not hold. It is not enough that a solver returns a result. Each case compares this
//! result with a closed form, a symmetry, a bound of mechanics or a reference implementation.
//!
//! ```
//! use tests::stability::{Effort, cases};
//! let one_cell = cases().into_iter().find(|c| c.name == "one cell").unwrap();
//! let verdict = one_cell.run(Effort::Quick);
//! assert!(verdict.passed() && verdict.figure.unwrap() <= one_cell.bound);
//! ```
//!
//! # Conventions
//!
//! * Figures are relative deviations. Where bits are compared, the figure is the number of values that
//!   differ, and its bound is 0.
//! * In addition to its certificate a state is checked by a reference implementation that shares only Love's
//!   kernel with the solver. The contact conditions and the force come from plain sums over pairs (free
//!   boundaries, modulus 1, up to 129 cells a side). The stiffness comes from Gauss's elimination (up to 220
//!   cells).
//! * A step of friction is checked by a reference implementation that shares nothing with the solver. It
//!   computes Coulomb's conditions, forces, slip and dissipated energy from plain sums of a tangential kernel
//!   that is integrated by Gauss's rule.
//! * A case that fails, with an error or a panic, also has a line in the table, and the other cases still
//!   run.
//!
//! # How accurate
//!
//! The reference implementations are [`every_contact_set`] (all sets of up to 16 cells), [`relaxed`]
//! (projected Gauss-Seidel, to rounding), [`Dragged`] (the same for friction), [`DensePath`] (hardness and any law of
//! friction, by projected gradients), [`PlainSum`] and [`PlainShear`]. Bounds are stated beside each case with their reason.
//!
//! # How fast
//!
//! All cases together take well under a minute of processor time ([`Effort::Quick`]). [`Effort::Thorough`]
//! has larger grids and takes minutes.
//!
//! # What it does not do
//!
//! It neither prints nor writes files (`xtask` does), and it measures no time.

mod case;
mod cases;
mod dense;
mod enumerate;
mod ledger;
mod maps;
mod plain;
mod press;
mod shear;
mod slide;

pub use case::{CaseResult, Effort, HardCase, run};
pub use cases::cases;
pub use dense::{DensePath, DenseSurface, Prescribed};
pub use enumerate::{SmallContact, every_contact_set};
pub use maps::{embedded, hard_map, map, rough, rough_map, scene};
pub use plain::{PlainSum, Relaxed, relaxed, relaxed_by};
pub use shear::{Dragged, PlainShear, compliance};
