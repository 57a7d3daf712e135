//! Self-affine rough surfaces and lines, deterministic indenters, and what is measured on them.

mod hash;
mod indenter;
mod line;
mod map;
mod measure;
mod phases;
mod spectrum;
mod surface;
mod turn;

pub use hash::surface_seed;
pub use line::{LineGenerator, self_affine_line};
pub use map::{MapGenerator, self_affine_map};
pub use measure::rms_height;
pub use phases::{line_phase, map_phase};
pub use surface::{height_map, line};
