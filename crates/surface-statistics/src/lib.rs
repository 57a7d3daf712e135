//! Statistics of rough surfaces.

mod areal;
mod bins;
mod derivatives;
mod difference;
mod fit;
mod fourier;
mod normal;
mod relative;
mod reliable;
mod spectrum;
mod taper;

pub use areal::{
    FeatureParameters, HeightParameters, HybridParameters, SpatialParameters, texture_direction,
};
pub use bins::Bins;
pub use derivatives::{Derivatives, ScaleDependence, nayak_parameter};
pub use difference::{DifferenceMap, HeightDifference};
pub use fit::{FitOptions, Interval, SpectrumFit, Wavelength};
pub use reliable::ReliableWavelengths;
pub use spectrum::PowerSpectrum;
pub use taper::Taper;
