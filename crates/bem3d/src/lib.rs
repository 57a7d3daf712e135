//! Exact normal contact of an elastic half-space with a rough square, by boundary elements.
mod active_set;
mod candidates;
mod cells;
mod certificate;
mod cg;
pub mod love;
mod model;
mod operator;
mod seed;
mod stiffness;
mod strategy;

pub use model::{Bem3d, Method};
/// Number of the solver's format: stored results of another number are not comparable to the last digits.
pub const FORMAT: u32 = 1;
