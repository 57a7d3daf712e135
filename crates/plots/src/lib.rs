//! Charts and map pictures of one style, as SVG and PNG.
//!
//! [`Chart`] draws a few named curves; [`Picture`] is what the paper's figures and the benchmarks are drawn with; [`write_grey`] is a
//! map of one value per cell.
//!
//! # Conventions
//!
//! Colours are told apart in grey as well; the same fractal dimension has the same colour in every picture ([`color`]). Maps have row 0
//! at the bottom. Files are written whole or not at all.

#![allow(clippy::format_push_string)] // Text is built once per file: clear beats one allocation less.

mod chart;
mod map;
mod plot;

pub use chart::{Chart, Curve};
pub use map::{Image, base64, encode_grey, grey, write_grey};
pub use plot::{Axis, Key, Mark, Picture, color, extent, logarithmic, pixels_per_unit, raster, save};
pub use runs::{Error, Result};
