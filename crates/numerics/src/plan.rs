//! Plans of fast Fourier transforms in one dimension (`rustfft`, `realfft`).
//!
//! A planner is generic over the precision, so that each crate that calls it compiles all of its algorithms.
//! The functions here are compiled once.

use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::{Fft, FftNum, FftPlanner};
use std::sync::Arc;

/// Single and double precision; no factor stands before any transform. Cost O(n log n) for a plan of length
/// n, as of one transform.
pub trait Precision: FftNum {
    /// Real values to waves: of `length` values the first `length / 2 + 1`.
    fn real_forward(length: usize) -> Arc<dyn RealToComplex<Self>>;
    /// Waves to real values.
    fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<Self>>;
    /// Complex values to waves.
    fn forward(length: usize) -> Arc<dyn Fft<Self>>;
    /// Waves to complex values.
    fn inverse(length: usize) -> Arc<dyn Fft<Self>>;
}

/// Methods of a type, and not functions over both: those would be compiled where they are called.
macro_rules! planned {
    ($($precision:ty),*) => { $(impl Precision for $precision {
        #[inline(never)]
        fn real_forward(length: usize) -> Arc<dyn RealToComplex<Self>> {
            RealFftPlanner::new().plan_fft_forward(length)
        }

        #[inline(never)]
        fn real_inverse(length: usize) -> Arc<dyn ComplexToReal<Self>> {
            RealFftPlanner::new().plan_fft_inverse(length)
        }

        #[inline(never)]
        fn forward(length: usize) -> Arc<dyn Fft<Self>> {
            FftPlanner::new().plan_fft_forward(length)
        }

        #[inline(never)]
        fn inverse(length: usize) -> Arc<dyn Fft<Self>> {
            FftPlanner::new().plan_fft_inverse(length)
        }
    })* };
}

planned!(f32, f64);
