//! What is measured on samples.

mod hurst;
mod moments;
mod patches;
mod spectra;

pub use hurst::{hurst_from_line_spectrum, hurst_from_spectrum};
pub use moments::{rms_height, rms_slope_differences};
pub use patches::{boundary_edges, patches};
pub use spectra::{line_spectrum, radial_spectrum, rms_slope};
