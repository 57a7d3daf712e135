//! Exact normal contact of an elastic half-space with a rough square, by boundary elements.
//!
//! # What it computes
//!
//! A rigid flat presses on an elastic half-space of effective modulus E* whose surface carries heights on a square of N x N cells
//! (any N >= 1). Pressure acts inside the square only; the half-space outside is unloaded. With `z = h_max - h` and the
//! approach d from first touch, the model finds the pressure of
//!
//! `g = u + z - d >= 0,   p >= 0,   p g = 0,   u = K p`
//!
//! and the incremental stiffness `k = dF/dd = 1' K_CC^-1 1` on the contact set C, which is exact: F(d) is piecewise linear.
//! K is Love's kernel for uniform pressure on square cells ([`love`]); there is no other approximation.
//!
//! ```
//! use bem3d::Bem3d;
//! use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
//!
//! let surface = Surface::SelfAffine(SelfAffine::new(2.4, 1.0, 1.0)?); // D_f, side, rms height
//! let model = Bem3d { cells: 65, tolerance: 1e-6, ..Bem3d::default() };
//! let mut contact = model.prepare(&Scene::new(surface, 1.0), 7)?;
//! let normalisation = contact.normalisation();
//! let state = contact.solve(Load::Force(normalisation.force(1.0)?))?;
//! let k_bar = normalisation.stiffness_bar(state.stiffness.unwrap());
//! assert!(k_bar > 0.4 && k_bar < 1.0);
//! assert!(state.report.certificate.meets(1e-6));
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! With [`contact_model::Boundary::Periodic`] the square repeats itself for ever. K is then the exact periodic kernel of zero mean (the
//! same pressure on square cells, summed over all images); states have no approach but a mean gap
//! ([`contact_model::PreparedContact::mean_gap`]), which can also be prescribed, and `k = -dF/d(mean gap)`. Full contact has no finite
//! stiffness: it stays `None` there.
//!
//! # How
//!
//! One load is solved by **predict and eliminate** (`active_set`): from a guess (the tangent of the last state, or the same relief on
//! coarser grids), the cells that would penetrate are a superset of the contact set; solving on it and dropping the cells
//! in tension leads to it. Small sets are factored (`operator::dense`), and pressure and stiffness come from one factor. Larger
//! ones take preconditioned conjugate gradients between looks at the exact gap in double precision: on lists of cells (`cg`), or on
//! runs of cells where contact fills the grid (`filled`). The preconditioner there extends the residual into the gaps between contacts
//! and applies the inverse of K on a torus: `E' B E >= (K_CC)^-1` for every extension E, and the better it follows the displacement, the
//! sharper. The same inequality bounds the error of k. Inside the iteration the operator is a sum over pairs, a two-level sum (smooth
//! far field on a lattice, close pairs exactly) or a single-precision FFT on the bounding box, whichever is cheaper (`strategy`), for
//! corrections of the pressure on a torus too short for the farthest lags;
//! looks that certify are exact sums or double-precision transforms.
//!
//! # How accurate
//!
//! Every state carries its certificate, measured with the exact operator in double precision: penetration, complementarity,
//! duality gap, load error and an estimate of the relative error of k that counts both the linear solve and cells that may be on
//! the wrong side of the contact set. A state that misses the tolerance is an error ([`contact_model::Error::NotConverged`]), never a
//! quiet value. Tolerances down to 1e-12 are met; the discretisation itself is of first order in the cell for bodies with edges.
//!
//! # How fast
//!
//! Work follows the contact: a few hundred cells take milliseconds on any grid. A dense load takes 30 to 60 applications of K for
//! three digits and 60 to 110 for eight, k included, nearly independent of N and of the load; one application costs about 2 ms at
//! N = 512 and 45 ms at N = 2049 (single precision, one thread of an AMD EPYC of 2024). `cargo xtask bench` prints the work of each
//! load on any surface; README has tables.
//!
//! # What it does not do
//!
//! Adhesion, friction and rheology are refused at `prepare`. One solve runs on one thread: ensembles are
//! parallel over surfaces.

mod active_set;
mod geometry;
mod kernel;
mod linear;
mod model;
mod operator;
mod real;
mod stiffness;
mod tuning;

pub use kernel::love;
pub use model::{Bem3d, Method};

#[doc(hidden)]
pub mod benchmarks;

/// Number of the solver's format. It changes with anything that can change a result beyond its tolerance, so that stored
/// results of other versions are not mixed with new ones.
pub const FORMAT: u32 = 3;
