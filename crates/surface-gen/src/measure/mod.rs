//! Measures of samples.

mod defined;
mod hurst;
mod moments;
mod patches;
mod plane;
mod self_affine_fit;
mod spectra;
mod statistics;
mod window;

pub use defined::defined_everywhere;
pub use hurst::{hurst_from_line_spectrum, hurst_from_spectrum};
pub use moments::{HeightMoments, rms_height, rms_slope_differences};
pub use patches::{boundary_edges, patches};
pub use plane::MapPlane;
pub use self_affine_fit::SelfAffineFit;
pub use spectra::{Wave, full_contact_energy, line_spectrum, periodogram, radial_spectrum, rms_slope};
pub use statistics::{Band, MapEdges, MapStatistics};
pub(crate) use statistics::{homogeneous, rms_by_wave};
pub use window::{fit_range, hann_window, windowed};
