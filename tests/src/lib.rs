//! Physics across crates; see the `tests/` folder beside this file.

/// The examples of README.md are tests too.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
mod readme {}
