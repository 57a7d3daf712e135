//! Exact normal contact of an elastic half-space with a rough surface, by boundary elements.
//!
//! # What it computes
//!
//! A rigid flat presses on a rough elastic body. Where do they touch, and with which pressure? The body is an
//! elastic half-space of contact modulus E*. Its surface carries heights h on a rectangle of columns x rows
//! cells with the sides dx and dy. Any number of cells is possible, square or oblong. Pressure acts inside
//! the rectangle only, and the half-space outside is unloaded. Undefined points of a map are never in
//! contact.
//!
//! With the depth `z = h_max - h` below the highest point and the approach d from first touch, the model
//! finds the pressure p and the gap g of
//!
//! `g = u + z - d >= 0,   p >= 0,   p g = 0,   u = G p`
//!
//! Here u is the elastic displacement. G has Love's influence coefficients for uniform pressure on
//! rectangular cells ([`love`]); there is no other approximation. The incremental stiffness is
//! `k = dF/dd = 1' G_CC^-1 1` on the contact set C. It is exact, because F(d) is piecewise linear. The length
//! in `F_bar` and `k_bar` is `L = sqrt(Lx Ly)`.
//!
//! ```
//! use bem3d::{Bem3d, ContactModel, Load, Scene, SelfAffine, Surface};
//!
//! let surface = Surface::SelfAffine(SelfAffine::new(2.4, [2.0, 1.0], 1.0)?); // D_f, sides, rms height
//! let model = Bem3d { cells: 90, tolerance: 1e-6, ..Bem3d::default() }; // 90 x 45 cells
//! let mut contact = model.prepare(&Scene::new(surface, 1.0), 7)?;
//! let normalisation = contact.normalisation();
//! let state = contact.solve(Load::force(normalisation.force(1.0)?))?;
//! let k_bar = normalisation.stiffness_bar(state.stiffness.unwrap());
//! assert!(k_bar > 0.4 && k_bar < 1.0);
//! assert!(state.report.certificate.meets(1e-6));
//! # Ok::<(), bem3d::Error>(())
//! ```
//!
//! ## Periodic boundaries
//!
//! With [`contact_model::Boundary::Periodic`] the rectangle repeats itself. G is then the exact periodic
//! kernel of zero mean: the same pressure on the same cells, summed over all images. States have no approach
//! but a mean gap ([`contact_model::ContactState::mean_gap`]), which can also be prescribed, and
//! `k = -dF/d(mean gap)`. Full contact has no finite stiffness, so that it is `None` there. Every number of
//! cells is solved on its own period.
//!
//! ## Periodic along one axis
//!
//! With [`contact_model::Boundary::PeriodicAlongX`] or its companion along y the rectangle repeats itself along one
//! axis, and beyond its other edges the half-space is unloaded: a contact that goes on along a line. Waves that vary
//! along the line have the periodic kernel with copies across that are so far away that they are not felt, and the
//! mean along the line has the logarithm of a half-plane. As for profiles, states have neither approach nor
//! stiffness. Adhesion, friction and layers are refused.
//!
//! ## Profiles
//!
//! A [`Surface::Profile`] is a body that is uniform along y, in plane strain. It is a map of one row, and a
//! force is that on the side of the row along y.
//!
//! With periodic boundaries the kernel of one row is that of plane strain by itself. With free boundaries G
//! is that of a half-plane, `u = -(2/(pi E*)) int p ln(|x - s|/D) ds` over strips. Displacements are measured
//! from the distance D. Pressure, contact and gap do not depend on D. Approach and stiffness would depend on
//! it, and states have neither.
//!
//! A hardness works as for maps. Adhesion is refused. A half-plane also refuses a displacement field and a
//! conductance.
//!
//! ## Adhesion of short range
//!
//! [`Adhesion::ShortRange`] is the limit of JKR. The work of adhesion w is put into the last cells of a
//! contact. It follows a law of the gap of each cell, whose range is a share of the cell. A factor from the
//! neighbours of the cell removes the line tension of fronts (`adhesion`).
//!
//! Pull-off forces have these errors:
//!
//! | body | error |
//! |---|---|
//! | smooth bodies | second order in the cell over the radius of the contact |
//! | round contacts, beside this | 0.2 %, because fronts are trapped between cells |
//! | straight fronts, beside this | 0.9 %, for the same reason |
//! | a contact that ends at a vertical edge | first order |
//!
//! The area is that of the attached shares of all cells. The stiffness belongs to the cells that hold more
//! than half of their work, and fronts stay where they are (`2 E* a` of a round contact with the radius a). A
//! cell that is not in contact attracts over `g0 = 3.2 sqrt(w a/E*)`, where a is now the longer side of a
//! cell. This is the distance at which a contact snaps in.
//!
//! ## Adhesion of finite range
//!
//! With [`Adhesion::FiniteRange`] an attractive traction s(g) acts across open gaps. The net pressure is
//! `p - s(g)`; p >= 0 and p g = 0 hold as before. Approach and withdrawal differ, so that such a scene is a
//! path ([`PreparedContact::advance`]). A single load is the path from no contact to it. It continues from
//! the last load where that lies on this path.
//!
//! Each state says on which branch it is, its energy, and how stable it is ([`AdhesiveState::stability`]):
//!
//! * For the exponential law the stability is `1 - r`, where r is a spectral radius (see `adhesion`).
//! * For Dugdale's law states are stable between the jumps of single cells. The stability is the smallest
//!   distance of the gap of a cell from the range, in ranges.
//!
//! If no state holds a force, the path ends with an error, which has the last stable state. Cells that are
//! too large for the range are refused, and the error has the side that would be small enough. Results with
//! Dugdale's law are of first order in the cell.
//!
//! ## Viscoelastic bodies
//!
//! With a [`Rheology`] a scene is a history in time, and each step of time is one elastic contact: the modulus is
//! that of the step, and the heights are displaced by what the history has left (`model::viscous`). A load in no
//! time meets the glassy body. Steps are as long as [`Bem3d::time_tolerance`] allows, and each state has the
//! difference of its force, distance and area from the same history in steps twice as long, and the work of the
//! load ([`ViscoelasticState`]).
//!
//! ```
//! use bem3d::{Bem3d, ContactModel, Load, Relaxing, Rheology, Scene, Step, Surface};
//! // A ball on a rubber, pressed at once and held: the approach creeps.
//! let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
//! scene.effects.rheology = Rheology::StandardSolid { arm: Relaxing { weight: 3.0, time: 2.0 } };
//! scene.outputs.stiffness = false;
//! let mut contact = Bem3d { cells: 32, ..Bem3d::default() }.prepare(&scene, 0)?;
//! let first = contact.advance(Step::new(0.0, Load::force(0.01)))?;
//! let later = contact.advance(Step::new(5.0, Load::force(0.01)))?;
//! assert!(later.approach > first.approach);
//! assert!(later.viscoelastic.unwrap().distance_time_error < 5e-3);
//! # Ok::<(), bem3d::Error>(())
//! ```
//!
//! # How it solves a load
//!
//! On a known contact set the problem is linear. The unknown is the set, and an outer iteration over contact
//! sets finds it (`active_set`):
//!
//! 1. An initial guess gives a superset of the contact set. After another load it is the tangent `p + Dd q`
//!    of the last state, with q = dp/dd and the change Dd of the approach. Without another load, the same
//!    surface is solved on coarser grids first (nested iteration).
//! 2. The linear system is solved on this set, and the cells in tension are removed.
//! 3. The exact gap is evaluated on all candidates, which are the cells with `z < d`; elsewhere the gap is
//!    positive. The cells that penetrate are added.
//! 4. Steps 2 and 3 repeat until the residuals meet the tolerance.
//!
//! Why is it safe to remove the cells in tension? A true contact cell is never removed where G,
//! restricted to the set, is an inverse M-matrix. It was one on every set tried, of the half-space and of
//! the half-plane. The periodic kernel of zero mean needs a constant for this, which changes nothing
//! under a given force. The constant that it has makes every entry positive; only nearly full sets would
//! need up to twice as much. There, and by rounding, an early stop of the linear solve or a hardness, a
//! cell may be removed that belongs to the contact. Step 3 then returns it. If the residuals have not
//! fallen for many iterations, a fall-back takes over that lowers the energy with every step
//! (`law::descent`). On a layer G is no such matrix, and on hard coatings the sets alternate. There the
//! fall-back is an interior-point method (`active_set::interior_point`).
//!
//! Coarse grids give initial guesses. They never restrict the candidates, because the summits of a fractal
//! vanish on them.
//!
//! A cell at its hardness is at the other bound of the pressure. It leaves the linear system as a cell
//! without contact does, so that the same iteration serves both. With adhesion the iteration is another one
//! (`adhesion::equilibrium`), and it solves its linear systems in the same way.
//!
//! **The linear system** is solved as its `Recipe` says (`operator`). A recipe is a pure function of sizes
//! and of the constants in `tuning`, and the report of a state prints it.
//!
//! | part | choices |
//! |---|---|
//! | small sets | a Cholesky factor, from which both pressure and stiffness follow |
//! | larger sets | preconditioned conjugate gradients (`linear`); the same code runs in single and in double precision |
//! | influence matrix, for scattered contact | a direct sum over pairs, or two levels: a smooth far field on a lattice and the close pairs exactly |
//! | influence matrix, for contact that fills its window | a single-precision FFT of the bounding box, or two transforms: the same split with a near field by an FFT of little more than the bounding box; corrections of the pressure take a shorter FFT that is inexact at long lags |
//! | preconditioner | none, or the inverse of G on a torus around the contact; the residual is extended by zeros or through the gaps between contacts, and `E' B E >= (G_CC)^-1` holds for every extension E |
//! | certificate | always the exact sums, or transforms in double precision |
//!
//! The preconditioner bounds the energy `r' G^-1 r` of a residual r, and this bounds the error of k too
//! (`response`). The two-level operator is for square cells with free boundaries. Oblong cells and periodic
//! maps take transforms instead. The tuned constants of a solve are in `tuning`, with meaning and unit. Those
//! of adhesion stand beside their iterations.
//!
//! **From the load to the transform** a solve crosses five files:
//!
//! | file | functions | what they do |
//! |---|---|---|
//! | `model/contact.rs` | `solve_until`, `state_at`, `solved_at`, `at_target`, `settle` | tell adhesion from its absence, find the pressure and then the stiffness, return the state |
//! | `active_set/solver.rs` | `solve`, `iterate`, `evaluate`, `improve` | iterate over contact sets |
//! | `linear/pcg.rs` | `Workspace::solve`, `pcg` | solve the linear system on one set |
//! | `operator/plans.rs` | `Plans::exact`, `Planned::apply_until` | apply the operator that is planned for the set |
//! | `operator/convolution.rs` | `Convolution::apply_until` | convolve |
//!
//! Corrections of the pressure go through `linear/pcg.rs`. Residuals go from the solver straight to
//! `Plans::exact`, in double precision. Three more files belong to this: `model/load.rs` brings a load
//! into the units of the surface, `model/state.rs` assembles every state, and `active_set/bounds.rs` has what
//! an upper bound of the pressure changes. With adhesion, `at` leads to `model/adhesive.rs` and
//! `adhesion/equilibrium.rs`.
//!
//! **A step of friction** comes after the pressure, and crosses these files:
//!
//! | file | functions | what they do |
//! |---|---|---|
//! | `model/increment.rs` | `slide`, `slide_by` | take the contact and its pressures, and solve further where the stiffness asks for it |
//! | `friction/state.rs` | `advance` | give each cell its limit by the law, and the place from which its slip counts |
//! | `friction/increment.rs` | `solve`, `iterate`, `newton`, `go_to` | iterate over the cells that stick and slip, each step downhill |
//! | `linear/pcg.rs` | `pcg` | solve the linearised conditions |
//! | `operator/plans.rs` | `Plans::exact`, `Planned::apply_until` | apply the kernel of two components |
//!
//! **A kernel** is one file of `kernel` and one line of `kernel/table.rs`, where kernels are listed. It says of
//! itself all that operators, planner, preconditioner and stiffness ask.
//!
//! **Between loads** the prepared contact keeps its plans, its buffers and the coarser grids. The next load
//! gets the tangent of the last state (`LastState`). A load that is solved again to a tighter tolerance goes
//! on with the gap of its state (`Continuation`).
//!
//! **Four kinds of state depend on the path.** `model/viscous.rs` steps through the time of a viscoelastic body.
//! `model/memory.rs` adds the indentation of a hardness to the
//! heights, with and without attraction. `model/adhesive.rs` goes from equilibrium to equilibrium.
//! `model/increment.rs` takes one increment of friction a step, under the contact pressures of either.
//! `model/path_memory.rs` holds all that the next step follows from, and an effect that remembers more must add
//! it there. Everything else that a contact keeps between loads is forgotten before each step of a path. A path
//! that was interrupted therefore goes on to the same bits.
//!
//! # Parts
//!
//! Modules use each other in one direction. In the list `model`, `response`, `adhesion`, `friction`,
//! `active_set`, `law`, `linear`, `operator`, `kernel`, `geometry` each module uses only those behind it. Each part
//! that is fast or intricate stands beside a reference implementation that is slow and right, and tests
//! compare the two.
//!
//! | part | what it does | reference implementation in the tests |
//! |---|---|---|
//! | `geometry::CellSet` | the one type of sets: rows of columns, with runs where they are long | plain lists of indices |
//! | `kernel::love` | influence coefficients of rectangular cells; the far field by multipoles | values of 40 digits; a rectangle as three squares |
//! | `kernel::definition`, `table` | what a kernel says of itself; the list of kernels, and a table of each on its grid with the symbols made from it | inverses and eigenvalues of dense matrices |
//! | `kernel::half_space` | Love's coefficients as a kernel | `kernel::love` |
//! | `kernel::half_plane` | strips on a half-plane, for profiles with free boundaries; displacements are counted from twice the side, so that every entry is positive | differences of long rows of Love's squares; quadrature |
//! | `kernel::periodic`, `period`, `waves` | the kernel of a rectangle that repeats itself, from its symbol; a constant on top of the zero mean makes every entry positive | sums of Love's kernel over images |
//! | `kernel::along_a_line` | the kernel of a map that repeats itself along one axis: periodic waves with copies far away across, and the half-plane of their mean | sums of Love's kernel over images |
//! | `kernel::tangential`, `cerruti` | Cerruti's solution on rectangular cells for two bodies, free and periodic | quadrature of point forces; sums over images |
//! | `kernel::coupling` | the coupling of normal and tangential displacements | quadrature of point forces; sums over images |
//! | `kernel::tensor` | how the entries of a kernel act on one, two or three components | sums over pairs |
//! | `operator::direct` | the sum over pairs | it is the reference |
//! | `operator::convolution` | a circular convolution on the bounding box, exact at the length 2(n - 1) for an even kernel, 2n - 1 for one with an odd entry, or at the period itself; in double precision, or in single precision inside an iteration | `direct` |
//! | `operator::transform` | the transforms of one, two or three fields in the same rows and columns | sums over pairs |
//! | `operator::plans` | the exact operators of a kernel, each planned when it is first used | `direct` |
//! | `operator::coupling` | normal and tangential displacements under the tractions of the other | sums over pairs |
//! | `operator::two_level` | a smooth far field on a lattice of 4 to 32 cells' spacing and a near field by close pairs, inside an iteration only | `direct`, with an error that falls with order and reach |
//! | `operator::two_transforms` | the same split for sets that fill their window; the near field is an FFT of n + R - 1 cells in single precision | the whole kernel, with an error that falls with order and reach |
//! | `operator::recipe` | the choice of how a system is solved | its own tests, without a clock |
//! | `linear::pcg` | conjugate gradients; with a fixed sum the force stays and the approach adapts | `cholesky`; a run that is restarted after every step |
//! | `linear::minres` | minimal residuals for symmetric indefinite systems, which Newton steps of adhesion have | small dense systems |
//! | `linear::preconditioner`, `extension` | the inverse of G on a torus, and the extension of residuals; any extension bounds the energy | the transpose by products |
//! | `linear::cholesky` | a factor of a small set, from which p and k follow | `pcg` |
//! | `active_set::progress` | the end of the outer iteration, and the tolerance of the next linear solve | decisions one by one |
//! | `law` | what a cell obeys: an interval of pressures or a disc of tractions, with projections onto the admissible ones of a given sum and their part of the duality gap | by hand |
//! | `law::descent` | the fall-back of contact and of friction: projected gradients and conjugate gradients between the bounds, each step downhill | random states by a dense reference |
//! | `active_set::interior_point` | the fall-back of kernels that bulge: pressures and gaps that stay positive while their product falls | the conditions of contact by sums over pairs |
//! | `active_set::residuals` | the one routine of the certificate | values by hand |
//! | `active_set::undecided` | how far an open gap may still change: the largest gap left near by, and an eighth of the largest anywhere; cells below that are undecided and count in the error of k | true changes of all open gaps by elimination |
//! | `response` | the stiffnesses of pressures, of tractions on a branch of friction, and along a branch of adhesion: one refinement of `A X = B` for any number of directions, with a Ritz value and an upper estimate; the error has a part from the solve and one from undecided cells | full contact of small squares; tighter solves; difference quotients |
//! | `friction` | an increment of friction, by any law of the pressure, with its certificate and tangential stiffness; coupled, normal and tangential contact are solved in turn | a dense convex programme; tractions of Ciavarella and Jaeger |
//!
//! # How accurate
//!
//! Every state carries its certificate, evaluated with the exact operator in double precision. It has
//! penetration, complementarity, duality gap, load error, and an estimate of the relative error of k. This
//! estimate counts both the linear solve and the undecided cells of the contact set. A state that misses the
//! tolerance is an error ([`contact_model::Error::NotConverged`]), and is never returned silently.
//!
//! Tolerances down to 1e-12 are met. The discretisation itself is of first order in the cell for bodies with
//! edges.
//!
//! # How fast
//!
//! Work follows the contact: a few hundred cells take milliseconds on any grid. For contact on most cells, k
//! included, the number of applications of G depends little on the number of cells and on the load:
//!
//! | accuracy | applications of G |
//! |---|---|
//! | three digits | 30 to 60 |
//! | eight digits | 60 to 110 |
//!
//! One application cost about 2 ms at N = 512 and 45 ms at N = 2049. This was measured in single precision
//! with an earlier version, on one thread of an AMD EPYC of 2024. Sweeps with the present version are 3 to 10
//! % faster, on a machine on which both were run. `cargo xtask bench` prints the work of each load on any
//! surface, and the book has tables.
//!
//! # Threads and bits
//!
//! A solve shares transforms, vectors, sums and factors among the threads of the `rayon` pool in which it is
//! called, if they are large enough. Outside of any pool it takes the global one, with all cores. Work is cut
//! into tasks by sizes alone, so that no bit of a state depends on the number of threads. Each thread needs
//! room for a few rows and columns.
//!
//! Ensembles run one surface on each thread of one pool. Threads that have no surface left help inside the
//! last ones. In a parallel iterator over surfaces, a thread that waits for its helpers may begin another
//! surface, which then runs on it alone.
//!
//! Transforms and factors choose the widest vector instructions of the processor. Results have the same bits
//! on processors with the same instructions, and agree to rounding on others. Without the features `simd` and
//! `faer` they use no instructions beyond those of the architecture.
//!
//! # Stops
//!
//! A `Stop` is asked between the tasks of every application and of every table: between 32 rows, or a few
//! columns, of a transform. What an operator leaves unfinished is an `Interrupted` that goes up to the load, so
//! that no state is made from it, and no table is kept. A stopped solve has its last pressure as the best state
//! where the certificate of that is known or takes a few hundredths of a second. The factor of a small set and
//! single passes over the grid are not left.
//!
//! # What it does not do
//!
//! These are refused at `prepare`:
//!
//! * adhesion of short range together with a hardness or with a coefficient of friction, and full coupling of
//!   friction together with a hardness, with adhesion or with a shear strength;
//! * rheology together with adhesion of short range or full coupling, and a stiffness of a viscoelastic body;
//! * adhesion and friction of profiles;
//! * displacement fields, conductances and loads by approach, for profiles with free boundaries.

mod active_set;
mod adhesion;
mod conduction;
mod friction;
mod geometry;
mod kernel;
mod law;
mod linear;
mod model;
mod operator;
mod parts;
mod real;
mod response;
mod tasks;
mod tuning;

// All that a first program needs beside the model itself: scenes, loads, states, height maps, the traits.
pub use conduction::{Film, FilmConductance, film_conductance, film_conductance_until, film_memory};
#[doc(no_inline)]
pub use contact_model::*;
pub use kernel::{PeriodicKernel, love};
pub use model::{BYTES_PER_CELL, Bem3d, Method, UNRESOLVED_RANGE, solve_bytes};

#[doc(hidden)]
pub mod benchmarks;

/// Number of the solver's format. It changes with anything that can change a result beyond its tolerance, so
/// that stored results of other versions are not mixed with new ones.
pub const FORMAT: u32 = 7;
