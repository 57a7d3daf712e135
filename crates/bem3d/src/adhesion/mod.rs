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
//! | passing bottlenecks (`bottleneck`) | 1.00 | 1.01 | not used | not decided: folds not done |
//! | shorter falling steps of Newton | 1.01 | 1.02 | not used | not decided: not all paths were run |
//! | plain updates after a refused step | 1.03 | 0.96 | not used | not decided: see below |
//! | linear systems solved by the last decrease | 1.00 | 1.00 | not used | not decided: see below |
//! | first states from an elastic contact | 1.00 | 1.00 | 1.00 | not decided: see below |
//! | a contact anew after a far step (`is_far`) | 1.00 | 1.00 | 1.00 | not decided: see below |
//! | a contact anew for a single load (`continued`) | 1.00 | 1.00 | 1.00 | not decided: see below |
//! | `near` in `newton` | 1.05, time 0.96 | not used | not used | not decided: see below |
//! | `near` in `response::adhesive` | 1.04, time 0.95 | not used | not used | not decided: see below |
//! | damping after 100 updates at a mean gap | 1.00 | 1.00 | 0.90 | not decided: see below |
//!
//! Applications alone are misleading for Newton steps with a short range: a sphere of 104 cells takes as
//! many without them, but 2797 updates instead of 1669 and twice the time, because each update follows the
//! fronts and evaluates the exact gap. Without `near` in both places the test
//! `increasing_loads_continue_from_the_last_state` fails, as loads that continue take as many applications
//! as loads that begin anew. Without the damping 32 more paths of 65 cells (352 mean gaps, short range,
//! exponential and Dugdale) reach the same sum of forces to 2e-9 in 17 % fewer applications. The rows that
//! are not decided change hardly any work and no state at this size; grids of more than 257 cells, tighter
//! tolerances and the hard cases were not run without them.
//!
//! # When it looks for a stop
//!
//! In each step of the linear systems, in each round over the fronts, and between the parts of an update. A
//! stopped update leaves the state as its last evaluation found it.

mod attraction;
mod bottleneck;
mod equilibrium;
mod law;
mod near;
mod neighbours;
mod newton;
mod pairs;
mod relaxation;
mod search;
mod update;

pub use attraction::Attraction;
pub use equilibrium::{AdhesiveControl, Equilibrium, energy};
pub use law::{AttractionLaw, LawShape};
pub use near::Near;
pub use pairs::Pairs;
pub use search::{Ended, Search};

#[cfg(test)]
mod fronts;
#[cfg(test)]
mod tests;
