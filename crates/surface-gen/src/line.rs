//! Self-affine lines (Eqs. 14-18).

use crate::measure::rms_by_wave;
use crate::phases::{Stream, Turns};
use crate::spectrum::{checked_elements, line_amplitudes};
use crate::turn::Circle;
use contact_model::{Error, HeightMap, Line, Result, SelfAffine, line_length};
use numerics::fourier::Complex64;
use numerics::plan::Precision as _;
use realfft::ComplexToReal;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};
use std::fmt;
use std::sync::{Arc, Mutex};

/// A generator of self-affine lines of one size, with its amplitudes and the plan of its transform.
///
/// Cheap to clone and shared between threads; [`LineGenerator::line`] draws as many lines as are wanted.
#[derive(Clone)]
pub struct LineGenerator {
    elements: usize,
    length: f64,
    /// `B_1D` of the waves m = 1, 2, ...
    amplitudes: Arc<[f64]>,
    transform: Arc<dyn ComplexToReal<f64>>,
    /// Work space of lines drawn before, because fresh memory costs twice as much time as the transform
    /// itself.
    spare: Arc<Mutex<Vec<LineWorkspace>>>,
}

#[derive(Debug)]
struct LineWorkspace {
    spectrum: Vec<Complex64>,
    scratch: Vec<Complex64>,
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
    /// Plans lines of `elements` elements that stand for the square or rectangle of the given surface.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] for parameters that make no sense, for `elements` of 0 or above 2^31,
    /// and where no wave remains: lines of 1 and 2 elements, and a `short_cutoff` below the wavenumber of the
    /// longest wave.
    pub fn new(surface: &SelfAffine, elements: usize) -> Result<Self> {
        Ok(Self {
            elements,
            length: line_length(surface.size.length()),
            amplitudes: line_amplitudes(surface, elements)?.into(),
            transform: f64::real_inverse(elements),
            spare: Arc::default(),
        })
    }

    /// Plans lines of `elements` elements that stand for a given map: the wave m of the line has the height
    /// variance `2 B_1D^2` of all waves of the map with |q| nearest to `m 2 pi / L_1D`, the rule `C_1D = pi q
    /// C_2D` (Eq. 17) of the map's own spectrum, whatever its shape. Waves longer than the line go to m = 1,
    /// and waves too short for the line are left out. With as many elements as the map has cells along its
    /// diagonal, the line has the rms height of a periodic map. For a map that is not periodic the spectrum
    /// is that under Hann's window ([`crate::windowed`]).
    ///
    /// # Errors
    /// Those of [`crate::MapStatistics::new`], and as [`LineGenerator::new`]. Cost O(N log N) for N cells.
    pub fn of_map(map: &HeightMap, elements: usize) -> Result<Self> {
        checked_elements(elements)?;
        let length = line_length(map.length());
        let mut amplitudes = rms_by_wave(map, TAU / length)?;
        let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
        let rounding = 1e-12 * largest(&amplitudes);
        amplitudes.truncate((elements - 1) / 2);
        if largest(&amplitudes) <= rounding {
            let expected = "more: the line carries no wave of the map";
            return Err(Error::domain("elements", elements as f64, expected));
        }
        // The waves q and -q share the variance.
        for b in &mut amplitudes {
            *b *= FRAC_1_SQRT_2;
        }
        let transform = f64::real_inverse(elements);
        Ok(Self { elements, length, amplitudes: amplitudes.into(), transform, spare: Arc::default() })
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

    /// Draws the line with this seed.
    ///
    /// Cost O(n log n). The generator keeps its work space, twice the memory of a line for every thread that
    /// draws at the same time.
    ///
    /// # Errors
    /// [`contact_model::Error::Domain`] when the heights overflow.
    pub fn line(&self, seed: u64) -> Result<Line> {
        let n = self.elements;
        let spare = self.spare.lock().ok().and_then(|mut spare| spare.pop());
        let mut space = spare.unwrap_or_else(|| LineWorkspace {
            spectrum: self.transform.make_input_vec(),
            scratch: self.transform.make_scratch_vec(),
        });
        self.fill(seed, &mut space.spectrum);
        let mut heights = self.transform.make_output_vec();
        let done = self.transform.process_with_scratch(&mut space.spectrum, &mut heights, &mut space.scratch);
        debug_assert!(done.is_ok() && heights.len() == n, "buffers come from the plan, the ends are zero");
        if let Ok(mut spare) = self.spare.lock() {
            spare.push(space);
        }
        Line::new(self.length, heights)
    }

    /// Writes `B exp(i phi)` of the waves and 0 elsewhere, moved by half an element so that samples sit at
    /// the elements' centres.
    fn fill(&self, seed: u64, spectrum: &mut [Complex64]) {
        let (mean, waves) = spectrum.split_at_mut(1);
        let (waves, beyond) = waves.split_at_mut(self.amplitudes.len());
        mean.fill(Complex64::new(0.0, 0.0));
        beyond.fill(Complex64::new(0.0, 0.0));
        let circle = Circle::shared();
        let mut turns = Turns::new(seed, Stream::Line, 0);
        let _mean = turns.next();
        // m / (2 n) turns in units of 2^-64, exactly rounded down without a division per wave.
        let n = self.elements as u64;
        let (step, remainder) = ((1 << 63) / n, (1 << 63) % n);
        let (mut shift, mut rest) = (0_u64, 0);
        for (value, &amplitude) in waves.iter_mut().zip(self.amplitudes.iter()) {
            shift += step;
            rest += remainder;
            if rest >= n {
                rest -= n;
                shift += 1;
            }
            let [cos, sin] = circle.cos_sin(turns.next().wrapping_add(shift));
            *value = Complex64::new(amplitude * cos, amplitude * sin);
        }
    }
}

/// A self-affine line of `elements` elements that stands for the rectangle: `h(x) = sum over all q of B_1D(q)
/// cos(q x + phi(q))`.
///
/// `B_1D = sqrt((2 pi / L_1D) C_1D)`, `C_1D = pi |q| C_2D(|q|)` (two-sided: the sum runs over both signs of
/// q), `L_1D = (2 / sqrt(pi)) L`, `L = sqrt(Lx Ly)`, q from `2 pi / L_1D` to `pi / dx` (or the shorter
/// `short_cutoff`), the Nyquist wave left out. Sampled at the elements' centres. With
/// `Amplitude::RmsHeight(h)` the rms of the samples is h for every seed; with `Amplitude::Spectrum(c)` the
/// constant is `C_2D(2 pi / L)` of the rectangle. The mean is 0.
///
/// # Errors
/// As [`LineGenerator::new`] and [`LineGenerator::line`]. Cost O(n log n).
///
/// Source: Pohrt, Popov, Filippov 2012, Eqs. 14-18. Differs from the printed form by the root over both
/// factors of Eq. 15 (dimensions) and by being a sum over the line's waves.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MapGenerator, hurst_from_line_spectrum, line_phase, line_spectrum, rms_height};
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::Amplitude;
    use std::f64::consts::PI;

    /// Rounding of a transform and of sums over up to 1e6 waves, relative to the rms.
    const ROUNDING: f64 = 1e-12;

    fn unit(fractal_dimension: f64) -> SelfAffine {
        SelfAffine::new(fractal_dimension, 1.0, 1.0).unwrap()
    }

    /// The reference implementation: Eq. 14 wave by wave, both signs of q,
    /// `B_1D = sqrt((2 pi / L_1D) pi q C_2D)`.
    fn direct(surface: &SelfAffine, constant: f64, n: usize, seed: u64) -> Vec<f64> {
        let length = line_length(surface.size.length());
        let (q0, floor) = (TAU / surface.size.length(), surface.roll_off.unwrap_or(0.0));
        let element = length / n as f64;
        let cutoff = surface.short_cutoff.unwrap_or(f64::INFINITY).min(PI / element) * (1.0 + 1e-12);
        let order = i32::try_from((n - 1) / 2).unwrap();
        let mut heights = vec![0.0; n];
        for m in (-order..=order).filter(|&m| m != 0) {
            let q = TAU / length * f64::from(m);
            if q.abs() > cutoff {
                continue;
            }
            let c2 = constant * (q.abs().max(floor) / q0.max(floor)).powf(-2.0 * (surface.hurst + 1.0));
            let amplitude = (TAU / length * PI * q.abs() * c2).sqrt();
            let phase = line_phase(seed, m);
            for (i, h) in heights.iter_mut().enumerate() {
                *h += amplitude * (q * (i as f64 + 0.5) * element + phase).cos();
            }
        }
        heights
    }

    #[test]
    fn transform_is_the_sum_over_waves() {
        let base = SelfAffine { size: 2.0.into(), amplitude: Amplitude::Spectrum(0.3), ..unit(2.4) };
        for (n, roll_off, short_cutoff) in [
            (3, None, None),
            (4, None, None),
            (37, Some(9.0), None),
            (600, None, Some(200.0)),
            (601, Some(3.0), None),
        ] {
            let surface = SelfAffine { roll_off, short_cutoff, ..base };
            let line = self_affine_line(&surface, n, 8).unwrap();
            let expected = direct(&surface, 0.3, n, 8);
            let rms = rms_height(&expected);
            for (h, e) in line.heights().iter().zip(&expected) {
                assert_abs_diff_eq!(h, e, epsilon = ROUNDING * rms);
            }
            assert_relative_eq!(line.length(), 2.0 * line_length(1.0));
        }
    }

    #[test]
    fn rms_is_exact_mean_is_zero_exponent_comes_back() {
        for n in [3, 4, 5, 97, 1000, 4096] {
            let line = self_affine_line(&SelfAffine::new(2.6, 5.0, 0.1).unwrap(), n, 1).unwrap();
            assert_relative_eq!(rms_height(line.heights()), 0.1, max_relative = ROUNDING);
            assert_abs_diff_eq!(line.heights().iter().sum::<f64>() / n as f64, 0.0, epsilon = ROUNDING);
        }
        for hurst in [0.0, 0.5, 1.0] {
            let line = self_affine_line(&unit(3.0 - hurst), 4096, 1).unwrap();
            let fitted = hurst_from_line_spectrum(&line_spectrum(&line), 1.0, 5000.0).unwrap();
            assert_abs_diff_eq!(fitted, hurst, epsilon = 1e-9); // no rings, no scatter: rounding of small waves
        }
    }

    /// Independent values for 2^20 elements and N = 2048, printed with four digits.
    #[test]
    fn ratio_of_line_to_map_at_the_same_constant() {
        let expected = [(2.0, 1.263), (2.2, 1.213), (2.4, 1.162), (2.6, 1.112), (2.8, 1.083), (3.0, 1.368)];
        for (fractal_dimension, ratio) in expected {
            let surface = SelfAffine { amplitude: Amplitude::Spectrum(1.0), ..unit(fractal_dimension) };
            let line = LineGenerator::new(&surface, 1 << 20).unwrap().rms_height();
            let map = MapGenerator::new(&surface, 2048).unwrap().rms_height();
            assert_relative_eq!(line / map, ratio, max_relative = 5e-4);
        }
    }

    #[test]
    fn long_waves_are_the_same_at_every_resolution() {
        let surface =
            SelfAffine { amplitude: Amplitude::Spectrum(1.0), short_cutoff: Some(100.0), ..unit(2.0) };
        let coarse = self_affine_line(&surface, 50, 2).unwrap();
        let fine = self_affine_line(&surface, 150, 2).unwrap();
        // Element i of 50 has the centre of element 3 i + 1 of 150.
        for (i, h) in coarse.heights().iter().enumerate() {
            assert_abs_diff_eq!(*h, fine.heights()[3 * i + 1], epsilon = ROUNDING);
        }
    }

    #[test]
    fn lines_are_neither_even_nor_alike() {
        let generator = LineGenerator::new(&unit(2.4), 256).unwrap();
        let [a, b] = [1, 2].map(|seed| generator.line(seed).unwrap());
        let against = |other: &mut dyn Iterator<Item = &f64>| {
            rms_height(&a.heights().iter().zip(other).map(|(x, y)| x - y).collect::<Vec<_>>())
        };
        assert!(against(&mut a.heights().iter().rev()) > 0.3);
        assert!(against(&mut b.heights().iter()) > 0.3);
    }

    #[test]
    fn used_work_space_changes_no_byte() {
        let surface = SelfAffine { short_cutoff: Some(100.0), ..unit(2.4) };
        let generator = LineGenerator::new(&surface, 1001).unwrap();
        let fresh: Vec<Line> = (0..8).map(|seed| self_affine_line(&surface, 1001, seed).unwrap()).collect();
        std::thread::scope(|scope| {
            for _ in 0..3 {
                scope.spawn(|| {
                    for (seed, line) in (0..).zip(&fresh) {
                        assert_eq!(generator.line(seed).unwrap(), *line);
                    }
                });
            }
        });
    }

    #[test]
    fn what_cannot_be_made_is_named() {
        for n in [0, 1, 2, usize::MAX] {
            let e = self_affine_line(&unit(2.4), n, 0).unwrap_err();
            assert!(matches!(e, Error::Domain { ref name, .. } if name == "elements"), "{e}");
        }
        let blunt = SelfAffine { short_cutoff: Some(1.0), ..unit(2.4) };
        assert!(self_affine_line(&blunt, 64, 0).is_err());
    }
}
