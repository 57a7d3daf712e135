//! All physical tests as one program, which is linked once and whose tests share the processors.

#![allow(clippy::unwrap_used)] // Helpers of tests; clippy.toml allows it in the tests themselves.

mod abilities;
mod adhesion;
mod committed;
mod contact_program;
mod documents;
mod ensembles;
mod equivalent;
mod exact_bodies;
mod exponent_hypotheses;
mod exponent_study;
mod exponents;
mod friction;
mod friction_exact;
mod friction_laws;
mod friction_properties;
mod grid_error;
mod hard;
mod mindlin_bound;
mod modules;
mod oracle;
mod partial_slip;
mod partial_slip_study;
mod peers;
mod periodic;
mod properties;
mod quantities;
mod rectangles;
mod refusals;
mod reported;
mod rheology;
mod rough;
mod sequences;
mod short_range;
mod small_sets;
mod stability;
mod symmetry;
mod type_names;
mod work;
