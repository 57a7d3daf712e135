//! Numerical tools that several crates share, and that know nothing of contact.
//!
//! | module | contents |
//! |---|---|
//! | [`parallel`] | tasks shared by the threads of the caller's pool, with the same bits for any number of them |
//! | [`root`] | roots of functions: between two points, of a convex function from above, and by bisection |
//! | [`gauss`] | integrals of smooth functions by the rule of Gauss and Legendre |
//! | [`plan`] | plans of transforms in one dimension, compiled once |
//! | [`fourier`] | transforms of real fields on a rectangle |
//! | [`sum`](mod@sum) | compensated and pairwise sums |
//! | [`range`](mod@range) | smallest and largest of many values |
//! | [`quantile`] | quantiles of the normal law, of Student's and of the chi-square distribution |
//! | [`regression`] | the straight line of least squares |
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
//! It has no linear algebra, because `faer` has it. Transforms and distribution functions are those of
//! `rustfft`, `realfft` and `statrs`.

pub mod fourier;
pub mod gauss;
pub mod parallel;
pub mod plan;
pub mod quantile;
pub mod range;
pub mod regression;
pub mod root;
pub mod sum;
