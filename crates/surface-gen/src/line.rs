//! Self-affine lines (Eqs. 14-18).

use crate::phases::{Stream, Turns};
use crate::spectrum::line_amplitudes;
use crate::turn::Circle;
use contact_model::{Line, Result, SelfAffine, line_length};
use realfft::{ComplexToReal, RealFftPlanner};
use rustfft::num_complex::Complex;
use std::f64::consts::TAU;
use std::fmt;
use std::sync::Arc;

/// Plans self-affine lines of one size: amplitudes tabulated, transform planned.
///
/// Cheap to clone and shared between threads; [`LineGenerator::line`] draws as many lines as are wanted.
#[derive(Clone)]
pub struct LineGenerator {
    elements: usize,
    length: f64,
    /// `B_1D` of the waves m = 1, 2, ...
    amplitudes: Arc<[f64]>,
    transform: Arc<dyn ComplexToReal<f64>>,
}

impl fmt::Debug for LineGenerator {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LineGenerator")
            .field("elements", &self.elements)
            .field("length", &self.length)
            .field("waves", &self.amplitudes.len())
            .finish_non_exhaustive()
    }
}

impl LineGenerator {
    /// Plans lines of `elements` elements that stand for the square of the given surface.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for parameters that make no sense, for `elements` of 0 or above 2^31, and where no wave is left: lines
    /// of 1 and 2 elements and short cut-offs below the longest wave.
    pub fn new(surface: &SelfAffine, elements: usize) -> Result<Self> {
        Ok(Self {
            elements,
            length: line_length(surface.side),
            amplitudes: line_amplitudes(surface, elements)?.into(),
            transform: RealFftPlanner::new().plan_fft_inverse(elements),
        })
    }

    /// The rms height that every line of this generator has, from the amplitudes alone: `sqrt(sum B^2)`.
    pub fn rms_height(&self) -> f64 {
        self.moment(|_| 1.0)
    }

    /// The rms slope that every line of this generator has, from the amplitudes alone: `sqrt(sum q^2 B^2)`.
    pub fn rms_slope(&self) -> f64 {
        self.moment(|m| (TAU / self.length * m).powi(2))
    }

    fn moment(&self, weight: impl Fn(f64) -> f64) -> f64 {
        let waves = self.amplitudes.iter().enumerate().rev();
        waves.map(|(i, b)| 2.0 * b * b * weight(i as f64 + 1.0)).sum::<f64>().sqrt()
    }

    /// Draws the line with this seed. Cost O(n log n).
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] when the heights overflow.
    pub fn line(&self, seed: u64) -> Result<Line> {
        let n = self.elements;
        let mut spectrum = self.transform.make_input_vec();
        self.fill(seed, &mut spectrum);
        let mut heights = self.transform.make_output_vec();
        let done = self.transform.process(&mut spectrum, &mut heights);
        debug_assert!(done.is_ok() && heights.len() == n, "buffers come from the plan, the ends are zero");
        Line::new(self.length, heights)
    }

    /// Writes `B exp(i phi)` of the waves, moved by half an element so that samples sit at the elements' centres.
    fn fill(&self, seed: u64, spectrum: &mut [Complex<f64>]) {
        let circle = Circle::shared();
        let mut turns = Turns::new(seed, Stream::Line, 0);
        let _mean = turns.next();
        // m / (2 n) turns in units of 2^-64, exactly rounded down without a division per wave.
        let n = self.elements as u64;
        let (step, remainder) = ((1 << 63) / n, (1 << 63) % n);
        let (mut shift, mut rest) = (0_u64, 0);
        for (value, &amplitude) in spectrum[1..].iter_mut().zip(self.amplitudes.iter()) {
            shift += step;
            rest += remainder;
            if rest >= n {
                rest -= n;
                shift += 1;
            }
            let [cos, sin] = circle.cos_sin(turns.next().wrapping_add(shift));
            *value = Complex::new(amplitude * cos, amplitude * sin);
        }
    }
}

/// A self-affine line of `elements` elements that stands for the square: `h(x) = sum over all q of B_1D(q) cos(q x + phi(q))`.
///
/// `B_1D = sqrt((2 pi / L_1D) C_1D)`, `C_1D = pi |q| C_2D(|q|)` (two-sided: the sum runs over both signs of q), `L_1D = (2 / sqrt(pi)) L`,
/// q from `2 pi / L_1D` to `pi / dx` (or the shorter `short_cutoff`), the Nyquist wave left out. Sampled at the elements' centres.
/// With `Amplitude::RmsHeight(h)` the rms of the samples is h for every seed; with `Amplitude::Spectrum(c)` the constant is
/// `C_2D(2 pi / L)` of the square. The mean is 0.
///
/// # Errors
/// As [`LineGenerator::new`] and [`LineGenerator::line`]. Cost O(n log n).
///
/// Source: Pohrt, Popov, Filippov 2012, Eqs. 14-18. Differs from the printed form by the root over both factors of Eq. 15 (dimensions) and by
/// being a sum over the line's waves.
///
/// ```
/// let surface = contact_model::SelfAffine::new(2.4, 1.0, 0.5)?;
/// let line = surface_gen::self_affine_line(&surface, 1000, 1)?;
/// let rms = surface_gen::rms_height(line.heights());
/// assert!((rms - 0.5).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn self_affine_line(surface: &SelfAffine, elements: usize, seed: u64) -> Result<Line> {
    LineGenerator::new(surface, elements)?.line(seed)
}
