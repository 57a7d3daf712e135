//! The influence matrix in the forms that a solve uses.

mod coupling;
mod direct;
mod fft;
mod influence;
mod operators;
mod recipe;
mod tangential;
mod transform;
mod two_level;
mod two_transforms;
mod vector;

pub use coupling::CouplingOperator;
pub use direct::DirectSum;
pub use fft::FftConvolution;
pub use influence::InfluenceOperator;
pub use operators::Operators;
#[cfg(test)]
pub use recipe::Application;
pub use recipe::{Conditioning, Recipe};
pub use tangential::{PlannedVector, TangentialOperators};
#[doc(hidden)]
pub use two_level::{Split, TwoLevel};
#[doc(hidden)]
pub use two_transforms::TwoTransforms;
pub use vector::VectorConvolution;
