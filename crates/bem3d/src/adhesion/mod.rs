//! Adhesion: an attractive traction across open gaps, beside the contact conditions. A short range is one
//! below the size of a cell.
//!
//! # Kinds of update, and what each one saves
//!
//! `search` holds the attraction, corrects the contact, and updates the attraction from the gaps, until both
//! agree. `update` chooses the kind of update. Each kind was switched off once, on 2026-11-29, on paths of
//! rough maps of 129 cells a side and of spheres: free and periodic, under forces, approaches and mean gaps,
//! there and back, with a tolerance of 1e-5. The first two rows also have maps of 257 and spheres of 104 and
//! 192 cells a side. The table has the applications of the kernel without the kind of update over those with
//! it, and the same ratio of user times (one thread of a shared machine, one run each, so to about 5 %). The
//! switches are not in the code.
//!
//! | switched off | short range | exponential | Dugdale | so it |
//! |---|---|---|---|---|
//! | Newton steps (`newton`) | 1.02, time 1.36 | 1.17, time 1.14 | not used | stays |
//! | the same at a tolerance of 1e-8 | 1.09, time 1.21 | 1.41, time 1.21 | not used | |
//! | following fronts (`relaxation`) | 1.95, time 1.28 | not used | not used | stays |
//! | the same at a tolerance of 1e-8 | 2.50, time 2.00 | not used | not used | |
//! | waiting until the contact is settled | 0.88 | 0.82 | 0.40 | stays: without it some states are others |
//! | passing bottlenecks (`bottleneck`) | 1.00 | 1.00 | not used | stays for folds, see below |
//! | shorter falling steps of Newton | 1.01 | 1.00 | not used | stays for folds, see below |
//! | plain updates after a refused step | 1.01 | 0.99 | not used | stays for folds, see below |
//! | linear systems solved by the last decrease | 0.97 | 1.00 | not used | was removed |
//! | first states from an elastic contact | 1.01 | 1.02 | 1.01 | stays: without it some states are others |
//! | a contact anew after a far step | 1.03 | 1.01 | 1.02 | was removed |
//! | a contact anew for a single load (`continued`) | 1.00 | 1.00 | 1.01 | stays, see below |
//! | displacement of open cells estimated from nearby contact, in two preconditioners | 1.00 to 1.13 | not used | not used | was removed |
//! | damping after 100 updates at a mean gap | 1.00 | 1.00 | 1.00 | stays, see below |
//!
//! Applications alone are misleading for Newton steps with a short range: a sphere of 104 cells takes as
//! many without them, but 2797 updates instead of 1669 and twice the time, because each update follows the
//! fronts and evaluates the exact gap.
//!
//! The rows from the bottlenecks on were measured on up to 34 paths of rough maps and of spheres, with 65 and
//! 129 cells a side and tolerances of 1e-5 and 1e-8. With 65 cells the work of adhesion was also 0.3 and 3 times
//! as large. Damping was switched off alone on three of these sets, falling steps and `continued` on four.
//! In addition the force, and the approach, at which smooth and rough spheres of 65 cells leave or enter the
//! contact were found by bisection with a tolerance of 1e-6 (the folds). The nine hard
//! cases of adhesion of `cargo xtask stability` pass without any one of them.
//!
//! The numbers at the folds and in the scene `rough-sticky-ball` are those without the removed kinds and without
//! the damping.
//!
//! - **Bottlenecks.** A load just beyond the snap-in of a sphere with the exponential law takes 1109
//!   applications instead of 266 without them. All bisections of a snap-in together take 1.22 times as many. At
//!   the pull-off force the ratios lie between 0.50 and 1.27.
//! - **Shorter falling steps.** The bisection of the pull-off force of a sphere with Tabor's parameter 1.3 takes
//!   3.17 times as many applications without them, and that of a rough one 1.27 times as many.
//! - **Plain updates after a refused step.** One load next to the pull-off force of that sphere takes 112 000
//!   applications without them, and the bisection 13 times as many. The scene `rough-sticky-ball` takes 1.02
//!   times as many, and 1.50 times as many where there are no shorter falling steps either.
//! - **First states.** Without them some paths with Dugdale's law have other equilibria, and the test
//!   `increasing_loads_continue_from_the_last_state` fails for that law.
//! - **`continued`.** Without it the same test fails, because loads of a short range that continue take more
//!   applications than loads that begin anew, 374 against 354. Single loads with Dugdale's law take up to 1.32
//!   times as many applications without it.
//! - **Damping.** It changed nothing on these paths, and 32 earlier ones (352 mean gaps) reached the same forces
//!   in 17 % fewer applications without it. But some mean gaps of a sine wave with an attraction of finite range
//!   have no state without it (`every_mean_gap_of_a_periodic_contact_with_adhesion_has_a_state`).
//! - **What was removed.** A Newton step adapted its reduction to the decrease of the step before, and a force
//!   that changed by more than a factor of two began with a contact from coarse grids. No state of a path
//!   changes. Without both of them and the damping the paths with 65 cells take 1.015 times as many
//!   applications, `rough-sticky-ball` as many as before, and the folds 0.63 times as many. The largest ratio
//!   of one path is 1.26 (Dugdale, forces).
//!
//! # When it looks for a stop
//!
//! In each application of an operator, and in each round over the fronts. A stopped update leaves the state as its
//! last evaluation found it. A stopped evaluation leaves none.

mod attraction;
mod bottleneck;
mod equilibrium;
mod law;
mod neighbours;
mod newton;
mod pairs;
mod relaxation;
mod search;
mod update;

pub use attraction::Attraction;
pub use equilibrium::{AdhesiveControl, Equilibrium, energy};
pub use law::{AttractionLaw, LawShape};
pub use pairs::Pairs;
pub use search::{Ended, Search};

#[cfg(test)]
mod fronts;
#[cfg(test)]
mod tests;
