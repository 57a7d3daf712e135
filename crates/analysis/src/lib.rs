//! Ensembles, power-law fits, collapse and conductance: from contact states to the numbers of the paper.
//!
//! How does one get from many contact states to one number with an error? This crate has the functions for
//! it. Each of them is a pure function of numbers: it reads no file and no clock, and a seed is the only
//! source of chance.
//!
//! All functions use the two dimensionless quantities of Pohrt, Popov and Filippov (Phys. Rev. E 86, 026710
//! (2012)): the force `F_bar = F/(E* h L)` (Eq. 10) and the stiffness `k_bar = k/(1.1419 E* L)` (Eq. 8). Here
//! F is the normal force, k the stiffness, E* the contact modulus, h the rms height and L the side of the
//! square.
//!
//! | item | what it gives |
//! |---|---|
//! | [`Curves`], [`ensemble`] | k_bar of many surfaces at common forces; their means and errors |
//! | [`fit_power_law`] | the law `k_bar = zeta F_bar^alpha` over a stated [`FitWindow`], with errors by a [`Bootstrap`] over surfaces |
//! | [`crossing`], [`least_spread`] | the point at which the laws, or the curves, of several fractal dimensions come closest to each other |
//! | [`collapse`] | the master curve of Fig. 4, and the residuals about it |
//! | [`conductance`] | the conductance by Eq. 13 |
//! | [`kappa`] | the factor kappa of `A = kappa F/(E* h')`, with the contact area A and the rms gradient h' |
//! | [`grid_error`], [`mean_grid_error`] | discretisation errors, estimated from coarser grids |
//! | [`first_grid`] | the grid for a requested accuracy |
//! | [`Multilevel`] | means on the finest of several grids, from differences between grids, with bands |
//! | [`binomial_test`] | whether intervals contain the true value as often as they should |
//!
//! ```
//! use analysis::{Bootstrap, Curves, FitWindow, StiffnessSample, fit_power_law};
//! // A body z ~ r has k ~ F^(1/2): F_bar = 1e-6, 1e-4, 1e-2 give k_bar = 1e-3, 1e-2, 1e-1.
//! let row = [1e-3, 1e-2, 1e-1].map(|k| Some(StiffnessSample { stiffness_bar: k, contact_cells: None }));
//! let curves = Curves::new(vec![1e-6, 1e-4, 1e-2], vec![row.to_vec()])?;
//! let law = fit_power_law(&curves, &FitWindow::PAPER, &Bootstrap::default()).expect("three points");
//! assert!((law.alpha - 0.5).abs() < 1e-12 && (law.zeta - 1.0).abs() < 1e-12);
//! assert_eq!(law.alpha_se, None); // one surface has no scatter to resample
//! # Ok::<(), contact_model::Error>(())
//! ```
//!
//! # Conventions and accuracy
//!
//! Sums are compensated ([`sum`]), so that a mean of 1e7 terms keeps its digits. A number that does not exist
//! is `None` with a reason, and never NaN.
//!
//! Errors come from resampling whole surfaces. Curves of different fractal dimension share their random
//! phases, so that [`Bootstrap::draws`] gives every curve of a run the same surfaces. The cost is linear in
//! the number of samples, and for an error also in the number of resamples.
//!
//! # What it does not do
//!
//! It solves no contacts. The caller must leave out samples that did not converge, as a `None` in [`Curves`].
//! A fit leaves out each force at which a sample is missing.

mod binomial;
mod bootstrap;
mod collapse;
mod conductance;
mod crossing;
mod curves;
mod ensemble;
mod fit;
mod grid_error;
mod grid_search;
mod kappa;
mod multilevel;

pub use binomial::binomial_test;
pub use bootstrap::Bootstrap;
pub use collapse::{CollapsePoint, Residual, collapse, decades_within};
pub use conductance::conductance;
pub use crossing::{Crossing, crossing, least_spread};
pub use curves::{Curves, StiffnessSample, interpolate};
pub use ensemble::{EnsemblePoint, Statistics, ensemble, half_width_of_mean, mean_and_deviation, statistics};
pub use fit::{FitWindow, FittedPowerLaw, NoFit, fit_power_law};
pub use grid_error::{
    GridError, KnownPart, error_from_moments, grid_error, mean_grid_error, relative_differences,
};
pub use grid_search::{AccuracyTarget, ChosenGrid, FoundGrid, GridTrial, NoGrid, first_grid};
pub use kappa::kappa;
pub use multilevel::{Multilevel, Uncertain, slope_weights};
pub use numerics::quantile::{student, student_at, student_beyond};
pub use numerics::regression::{least_squares, observed_power};
pub use numerics::sum::sum;
