//! The kernel of a surface in the forms that a solve uses.

mod convolution;
mod coupling;
mod direct;
mod influence;
mod operators;
mod plans;
mod recipe;
mod transform;
mod two_level;
mod two_transforms;

pub use convolution::{Convolution, FftConvolution, VectorConvolution};
pub use coupling::CouplingOperator;
pub use direct::DirectSum;
pub use influence::InfluenceOperator;
pub use operators::{Operators, PlannedPressure};
pub use plans::{Planned, TangentialOperators};
#[cfg(test)]
pub use recipe::Application;
pub use recipe::{Conditioning, Recipe};
#[doc(hidden)]
pub use two_level::{Split, TwoLevel};
#[doc(hidden)]
pub use two_transforms::TwoTransforms;
