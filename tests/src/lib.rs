//! Common parts of the physical tests: problems with their exact solutions, one checker for every model, and
//! orders of convergence; [`stability`], the registry of hard cases, with maps made by hand and reference
//! implementations, one of which tries every contact set.
//!
//! The tests themselves are in the `tests/` folder beside this file, one topic a file. They follow four
//! rules.
//!
//! * A [`ExactProblem`] knows its exact solution; [`deviation`] compares any model that accepts the scene, and
//!   returns `None` where the model refuses it.
//! * Errors of a discretisation are stated as an [`order`] over several grids and as a bound on the finest,
//!   not as one loose tolerance.
//! * A number that cannot be derived by hand is compared with one from an independent source
//!   ([`every_contact_set`], published values, the stored results of other programs in `data/peers`).
//! * Every tolerance is a named constant with its reason.
//!
//! ```
//! use tests::{PrescribedQuantity, deviation, problems};
//! for problem in problems()? {
//!     // The method of reduction of dimensionality is exact for every round body and refuses the square.
//!     match deviation(&mdr1d::Mdr1d::default(), &problem, PrescribedQuantity::Force)? {
//!         Some(found) => assert!(found.response < 1e-10),
//!         None => assert_eq!(problem.name, "flat square"),
//!     }
//! }
//! # Ok::<(), contact_model::Error>(())
//! ```

mod deviation;
mod order;
mod problem;
pub mod stability;

pub use deviation::{Deviation, PrescribedQuantity, deviation};
pub use order::order;
pub use problem::{ExactCase, ExactProblem, problems};
pub use stability::{SmallContact, embedded, every_contact_set, hard_map, map, rough, rough_map, scene};

/// The examples of README.md and of the book are tests too.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../README.md")]
    mod readme {}
    #[doc = include_str!("../../book/src/solve.md")]
    mod solve {}
    #[doc = include_str!("../../book/src/theories.md")]
    mod theories {}
    #[doc = include_str!("../../book/src/theories-rough.md")]
    mod theories_rough {}
    #[doc = include_str!("../../book/src/rust.md")]
    mod rust {}
    #[doc = include_str!("../../book/src/add-a-model.md")]
    mod add_a_model {}
}
