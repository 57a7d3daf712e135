//! Exact normal contact of an elastic half-space with a rough surface, by boundary elements.
//!
//! # What it computes
//!
//! A rigid flat presses on an elastic half-space of contact modulus E* whose surface carries heights on a
//! rectangle of columns x rows cells of sides dx and dy (any number of cells, square or oblong). Pressure
//! acts inside the rectangle only; the half-space outside is unloaded. Undefined points of a map cannot
//! touch. With `z = h_max - h` and the approach d from first touch, the model finds the pressure p and the
//! gap g of
//!
//! `g = u + z - d >= 0,   p >= 0,   p g = 0,   u = G p`
//!
//! and the incremental stiffness `k = dF/dd = 1' G_CC^-1 1` on the contact set C, which is exact: F(d) is
//! piecewise linear. G are Love's influence coefficients for uniform pressure on rectangular cells
//! ([`love`]); there is no other approximation. `L = sqrt(Lx Ly)` in `F_bar` and `k_bar`.
//!
//! ```
//! use bem3d::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
//!
//! let surface = Surface::SelfAffine(SelfAffine::new(2.4, [2.0, 1.0], 1.0)?); // D_f, sides, rms height
//! let model = Bem3d { cells: 90, tolerance: 1e-6, ..Bem3d::default() }; // 90 x 45 cells
//! let mut contact = model.prepare(&Scene::new(surface, 1.0), 7)?;
//! let normalisation = contact.normalisation();
//! let state = contact.solve(Load::Force(normalisation.force(1.0)?))?;
//! let k_bar = normalisation.stiffness_bar(state.stiffness.unwrap());
//! assert!(k_bar > 0.4 && k_bar < 1.0);
//! assert!(state.report.certificate.meets(1e-6));
//! # Ok::<(), bem3d::Error>(())
//! ```
//!
//! With [`contact_model::Boundary::Periodic`] the rectangle repeats itself. G is then the exact periodic
//! kernel of zero mean (the same pressure on the same cells, summed over all images); states have no approach
//! but a mean gap ([`contact_model::ContactState::mean_gap`]), which can also be prescribed, and
//! `k = -dF/d(mean gap)`. Full contact has no finite stiffness: it stays `None` there. Every number of cells
//! is solved on its own period.
//!
//! A [`Surface::Profile`] is a body that is uniform along y, in plane strain, as a map of one row; a force is
//! that on the side of the row along y. With periodic boundaries the kernel of one row is that of plane
//! strain by itself. With free ones G is that of a half-plane, `u = -(2/(pi E*)) int p ln(|x - s|/D) ds` over
//! strips: pressure, contact and gap do not depend on the distance D, from which displacements are counted,
//! and states have neither an approach nor a stiffness, which do. Hardness works as for maps; adhesion is
//! refused, and of a half-plane a displacement field and a conductance too.
//!
//! With [`Adhesion::ShortRange`], JKR's limit, the work of adhesion is put into the last cells of a contact,
//! by a law of the cell's own gap whose range is a share of the cell and by a factor of its neighbours that
//! takes the line tension of fronts out (`adhesion`): pull-off forces of smooth bodies have an error of
//! second order in the cell over the radius of the contact, and one of 0.2 % (round contacts) to 0.9 %
//! (straight fronts) because fronts are trapped between cells; a contact that ends at a vertical edge is
//! pulled off at a force of first order. The area is that of the attached shares of all cells, the stiffness
//! that of the cells that hold more than half of their work, where fronts stay (`2 E* a` of a round contact).
//! A cell that touches nothing attracts over `g0 = 3.2 sqrt(w a/E*)`, a the longer side of a cell, which is
//! how far from touch a contact snaps in.
//!
//! With [`Adhesion::FiniteRange`] an attractive traction s(g) acts across open gaps: the net pressure is
//! `p - s(g)`, p >= 0 still with p g = 0. Approach and withdrawal differ, so that such a scene is a path
//! ([`PreparedContact::advance`]); a single load is the path from no contact to it, and continues from the
//! last one where that lies on this path. Each state says on which branch it lies, its energy, and how stable
//! it is ([`AdhesiveState::stability`]: `1 - r` for the exponential law, see `adhesion`; for Dugdale's law,
//! whose states are stable between the jumps of single cells, the smallest distance of the gap of a cell from
//! the range, in ranges). Forces that nothing holds end the path with an error that has the last stable
//! state. Cells too large for the range are refused with the side that would do; results with Dugdale's law
//! are of first order in the cell.
//!
//! # How
//!
//! One load is an outer iteration over contact sets (`active_set`): from an initial guess (the tangent of the
//! last state, or nested iteration from coarser grids), solve on a superset of the contact set, remove cells
//! in tension, evaluate the exact gap, add penetrating cells. Each linear system is solved as its `Recipe`
//! says (`operator`), which is a pure function of sizes:
//!
//! | part | choices |
//! |---|---|
//! | small sets | a Cholesky factor: pressure and stiffness from one factorisation |
//! | larger sets | preconditioned conjugate gradients (`linear`), the same code in single and in double precision |
//! | influence matrix | direct sum; two levels (smooth far field on a lattice, close pairs exactly); two transforms (the same split, what is near by a single-precision FFT of little more than the bounding box); single-precision FFT of the bounding box, for corrections of the pressure a shorter one that is inexact at long lags |
//! | preconditioner | none; the inverse of G on a torus around the contact, with the residual extended by zeros or through the gaps between contacts: `E' B E >= (G_CC)^-1` for every extension E |
//! | certificate | exact sums or double-precision transforms, always |
//!
//! The energy `r' G^-1 r` that the preconditioner bounds also bounds the error of k (`stiffness`). The tuned
//! constants of a solve are in `tuning`, with meaning and unit; those of adhesion stand beside their
//! iterations.
//!
//! # The way of one load
//!
//! From [`PreparedContact::solve`] to the transform a load crosses five files:
//!
//! | file | functions | what they do |
//! |---|---|---|
//! | `model/contact.rs` | `solve_until`, `at`, `at_target`, `settle` | with adhesion or without; the pressure, then the stiffness; the state |
//! | `active_set/solver.rs` | `solve`, `iterate`, `evaluate`, `improve` | the outer iteration over contact sets |
//! | `linear/pcg.rs` | `Workspace::solve`, `pcg` | the linear system on one set |
//! | `operator/operators.rs` | `Operators::exact`, `Planned::apply` | the operator that is planned for the set |
//! | `operator/fft.rs` | `FftConvolution::apply` | the convolution |
//!
//! Beside it `model/load.rs` brings a load into the units of the surface, `model/state.rs` assembles every
//! state, and `active_set/bounds.rs` says what an upper bound of the pressure changes. With adhesion, `at`
//! leads to `model/adhesive.rs` and `adhesion/equilibrium.rs`, and from there to the same systems.
//!
//! # How accurate
//!
//! Every state carries its certificate, evaluated with the exact operator in double precision: penetration,
//! complementarity, duality gap, load error and an estimate of the relative error of k that counts both the
//! linear solve and the undecided cells of the contact set. A state that misses the tolerance is an error
//! ([`contact_model::Error::NotConverged`]), never a quiet value. Tolerances down to 1e-12 are met; the
//! discretisation itself is of first order in the cell for bodies with edges.
//!
//! # How fast
//!
//! Work follows the contact: a few hundred cells take milliseconds on any grid. A dense load takes 30 to 60
//! applications of G for three digits and 60 to 110 for eight, k included, nearly independent of the number
//! of cells and of the load; one application cost about 2 ms at N = 512 and 45 ms at N = 2049 (single
//! precision, one thread of an AMD EPYC of 2024, first engine; sweeps with this one are 3 to 10 % faster on
//! the machine on which both were run). `cargo xtask bench` prints the work of each load on any surface; the
//! book has tables. The two-level operator is for square cells with free boundaries; oblong cells and
//! periodic maps take transforms instead.
//!
//! # Threads and bits
//!
//! A solve shares transforms, vectors, sums and factors among the threads of the `rayon` pool in which it is
//! called (without one, the global pool: all cores), where they are large enough. Work is cut into tasks by
//! sizes alone: no bit of a state depends on the number of threads. Each thread needs room for a few rows and
//! columns. Ensembles run one surface a thread in one pool; threads that have run out of surfaces help inside
//! the last ones. In a parallel iterator over surfaces, a thread that waits for its helpers may begin another
//! surface, which then runs on it alone.
//!
//! Transforms and factors choose the widest vector instructions that the processor has, so that results are
//! the same bits on processors with the same instructions, and the same to rounding elsewhere. Without the
//! features `simd` and `faer` they take none beyond those of the architecture.
//!
//! # What it does not do
//!
//! Two of hardness, adhesion and friction together, and rheology, are refused at `prepare`; adhesion and friction
//! of profiles are refused too, and of profiles with free boundaries displacement fields, conductances and loads
//! by approach.

mod active_set;
mod adhesion;
mod friction;
mod geometry;
mod kernel;
mod linear;
mod model;
mod operator;
mod parts;
mod real;
mod stiffness;
mod tuning;

// All that a first program needs beside the model itself: scenes, loads, states, height maps, the traits.
#[doc(no_inline)]
pub use contact_model::*;
pub use kernel::love;
pub use model::{BYTES_PER_CELL, Bem3d, Method, UNRESOLVED_RANGE, bytes_per_cell};

#[doc(hidden)]
pub mod benchmarks;

/// Number of the solver's format. It changes with anything that can change a result beyond its tolerance, so
/// that stored results of other versions are not mixed with new ones.
pub const FORMAT: u32 = 4;
