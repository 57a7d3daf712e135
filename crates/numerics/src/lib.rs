//! Numerical tools that several crates share, and that know nothing of contact.
//!
//! | module | what it has |
//! |---|---|
//! | [`parallel`] | work in tasks on the threads of the caller's pool, with the same bits for any number of them |
//! | [`root`] | the root of a function between two points |
//! | [`gauss`] | integrals of smooth functions by the rule of Gauss and Legendre |
//!
//! ```
//! use numerics::gauss::Gauss;
//! // The point at which the integral of x^2 from 0 is 1.
//! let integral = |to: f64| Gauss::<16>::new().integrate(0.0, to, |x| x * x);
//! let x = numerics::root::between(0.0, 2.0, |x| integral(x) - 1.0);
//! assert!((x - 3.0_f64.cbrt()).abs() < 1e-14);
//! ```
//!
//! # What it does not do
//!
//! No transforms, no linear algebra, no statistics: `rustfft`, `faer` and `statrs` have them.

pub mod gauss;
pub mod parallel;
pub mod root;
