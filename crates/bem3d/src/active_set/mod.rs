//! The complementarity problem at one load.

mod candidates;
mod descent;
mod hardness;
mod initial_guess;
mod progress;
mod residuals;
mod solver;
mod state;
mod undecided;

pub use candidates::Candidates;
pub use hardness::is_saturated;
pub use initial_guess::{LastState, cold_start, predicted_cells};
pub use residuals::Residuals;
pub use solver::{resume, solve};
pub use state::{Continuation, Guess, Limits, Problem, Solved, Target};
