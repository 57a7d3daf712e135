//! The complementarity problem at one load.

mod bounds;
mod candidates;
mod initial_guess;
mod interior_point;
mod line_search;
mod progress;
mod residuals;
mod solver;
mod state;
mod undecided;

pub use bounds::Bounds;
pub use candidates::Candidates;
pub use initial_guess::{LastState, cold_start, predicted_cells};
pub use residuals::{ContactGap, Residuals};
pub use solver::{CERTIFIED_NS, resume, solve};
pub use state::{Continuation, Control, Guess, Limits, Problem, Solved};
