//! Contact of elastic bodies with rough surfaces: this crate re-exports the solvers, the theories and the
//! tools around them.
//!
//! How large is the contact of two rough bodies under a load, and how stiff is it? A program that depends on
//! this crate has everything to answer that. The example presses your own heights against a flat:
//!
//! ```
//! use fractal_contact::{Bem3d, ContactModel, HeightMap, Load, Scene, Surface};
//!
//! // Two waves on a rectangle of 2 x 1, heights in the same unit; E* = 1.
//! let wave = |k: usize, n: usize| (std::f64::consts::TAU * (k as f64 + 0.5) / n as f64).cos();
//! let map = HeightMap::from_fn([64, 32], [2.0, 1.0], |ix, iy| 0.01 * (wave(ix, 64) + wave(iy, 32)))?;
//! let scene = Scene::new(Surface::Heights(map.into()), 1.0);
//! let mut contact = Bem3d::default().prepare(&scene, 0)?;
//! let state = contact.solve(Load::force(0.01))?;
//! println!("k = {:?}, certificate: {}", state.stiffness, state.report.certificate);
//! # Ok::<(), fractal_contact::Error>(())
//! ```
//!
//! # Modules
//!
//! | module | contents |
//! |---|---|
//! | the root | scenes, loads, states, height maps and the traits of all models (`contact-model`), and the two solvers |
//! | [`bem3d`] | exact contact in three dimensions by boundary elements, free or periodic |
//! | [`mdr1d`] | the one-dimensional reduction; friction and rheology on top of any model ([`Equivalent`]) |
//! | [`analytic`] | closed forms and theories: Hertz, JKR, Westergaard, Persson, Greenwood and Williamson, ... |
//! | [`surface_gen`] | self-affine surfaces from a seed, and measurements on surfaces |
//! | [`interface`] | what the interface of a state lets through and what the bodies bear: paths, leakage, stress below the surface |
//! | [`analysis`] | means, fits with errors, tables |
//! | [`surface_statistics`] | parameters of ISO 25178, spectra with bands, fits with intervals |
//! | [`surface_io`] | measured surfaces from files, and fields into files |
//! | `scenes` | scene files, which describe a contact problem and the requested results, and the program `fractal-contact` |
//! | `runs`, `plots` | jobs with a result store, CSV and manifest; charts and pictures of maps (feature `scenes`) |
//!
//! # Features
//!
//! All features are on by default. Without them the solvers, the theories and the other formats of files
//! remain.
//!
//! | feature | what it brings |
//! |---|---|
//! | `scenes` | scenes and their files, pictures and result store |
//! | `program` | the program `fractal-contact` |
//! | `rayon` | threads of the current pool, on which surfaces are generated and large systems solved |
//! | `faer` | a Cholesky factor for small contact sets |
//! | `simd` | the widest vector instructions of the processor, for transforms |
//! | `hdf5`, `tiff`, `x3p` | these formats of maps, with the crates that they need |
//!
//! Without `simd` and `faer` the results have the same bytes on every processor of one architecture, provided
//! that its mathematical functions are the same.

#![allow(clippy::format_push_string, clippy::format_collect)] // Text is built once per file: clear beats one allocation less.

pub use contact_model::*;

pub use bem3d::Bem3d;
pub use mdr1d::{Equivalent, Mdr1d};
pub use {analysis, analytic, bem3d, interface, mdr1d, surface_gen, surface_io, surface_statistics};

pub mod models;
#[cfg(feature = "scenes")]
pub mod scenes;
#[cfg(feature = "scenes")]
pub use {plots, runs};
