//! Maps with a prescribed spectrum and a prescribed distribution of heights.

use crate::measure::rms_height;
use crate::waves::WaveGenerator;
use contact_model::{Cells, Error, HeightMap, Result};
use numerics::fourier::{ForwardTransform, InverseTransform};
use numerics::quantile::normal;
use std::sync::Arc;

/// Iterations after which the scheme ends in any case.
const MOST: usize = 500;
/// The scheme ends where ten iterations reduce the residual by less than this share.
const SLOW: f64 = 0.01;

/// A distribution of heights. Its mean is 0 and its variance that of the spectrum.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum HeightDistribution {
    /// The normal law.
    Gaussian,
    /// Weibull's law of the shape k > 0, `1 - exp(-x^k)`: skewed upwards below k = 3.6, downwards above.
    Weibull {
        /// Shape k.
        shape: f64,
    },
    /// The heights of the defined points of a map.
    Of(Arc<HeightMap>),
}

/// Which of spectrum and distribution is met exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Exact {
    /// The distribution of the heights.
    #[default]
    Distribution,
    /// The amplitude of each wave.
    Spectrum,
}

/// A map with a prescribed spectrum and a prescribed distribution of heights, and its residuals in both.
#[derive(Debug, Clone, PartialEq)]
pub struct PrescribedMap {
    /// The map; its mean is 0 and its rms height that of the spectrum.
    pub map: HeightMap,
    /// Rms difference of the amplitudes of all waves from those of the spectrum, over the rms height.
    pub spectrum_residual: f64,
    /// Rms difference of the sorted heights from those of the distribution, over the rms height.
    pub distribution_residual: f64,
    /// Number of iterations.
    pub iterations: usize,
}

impl PrescribedMap {
    /// Draws a map with the spectrum of a generator and the given distribution of heights.
    ///
    /// The iteration starts from the generator's map with this seed and alternates two steps. One replaces
    /// the heights by those of the distribution with the same ranks, `F^-1((k + 1/2)/N)` scaled to the
    /// variance of the spectrum. The other replaces the amplitudes of the waves by those of the spectrum and
    /// keeps their phases. The property of the last step is exact. The iteration ends where the residual of
    /// the other property falls by less than 1 % in ten iterations, or after 500 iterations. Where the
    /// heights are far from Gaussian and the spectrum has few long waves, no map has both properties; the
    /// residuals then show the remaining difference. Results are as reproducible as those of
    /// [`WaveGenerator::map`], except for ties of ranks within rounding. Cost O(N log N) for each iteration.
    ///
    /// Source: Schreiber, Schmitz, Phys. Rev. Lett. 77, 635 (1996); for surfaces Perez-Rafols, Almqvist,
    /// Tribol. Int. 131, 591 (2019), whose first step (a translation of the Gaussian field) is the first
    /// iteration here.
    ///
    /// # Errors
    /// [`Error::Domain`] for a shape that is no positive number or whose heights leave the range of f64, a
    /// map whose heights are all equal, and heights that overflow.
    ///
    /// ```
    /// use contact_model::SelfAffine;
    /// use surface_gen::{Anisotropy, Exact, HeightDistribution, PrescribedMap, WaveGenerator};
    /// let surface = SelfAffine { roll_off: Some(50.0), ..SelfAffine::new(2.2, 1.0, 0.01)? };
    /// let waves = WaveGenerator::anisotropic(&surface, Anisotropy { ratio: 1.0, lay: 0.0 }, 64)?;
    /// let found = PrescribedMap::new(&waves, &HeightDistribution::Weibull { shape: 1.5 }, Exact::Distribution, 1)?;
    /// // The skewness of this law is 1.07.
    /// let skewness = found.map.heights().iter().map(|h| (h / 0.01).powi(3)).sum::<f64>() / 4096.0;
    /// assert!((skewness - 1.07).abs() < 0.02);
    /// assert!(found.spectrum_residual < 0.05 && found.distribution_residual < 1e-12);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(
        waves: &WaveGenerator,
        distribution: &HeightDistribution,
        exact: Exact,
        seed: u64,
    ) -> Result<Self> {
        let start = waves.map(seed)?;
        let rms = waves.rms_height();
        let sorted = distribution.sorted(start.heights().len(), rms)?;
        let (forward, inverse) = waves.transforms();
        let mut scheme = Scheme { waves, forward, inverse, sorted, rms, heights: start.heights().to_vec() };
        let (mut before, mut iterations) = (f64::INFINITY, 0);
        let (mut spectrum_residual, mut distribution_residual) = (0.0, 0.0);
        while iterations < MOST {
            iterations += 1;
            match exact {
                Exact::Distribution => {
                    scheme.take_spectrum();
                    distribution_residual = scheme.take_distribution();
                }
                Exact::Spectrum => {
                    scheme.take_distribution();
                    spectrum_residual = scheme.take_spectrum();
                }
            }
            // Of both, the last change is that which is not met.
            let last = if exact == Exact::Distribution { distribution_residual } else { spectrum_residual };
            if iterations % 10 == 0 {
                if last > before * (1.0 - SLOW) {
                    break;
                }
                before = last;
            }
        }
        let map = HeightMap::new(start.cells(), start.size(), scheme.heights.clone())?;
        // Of the map itself: one more half step changes what is not exact, and tells by how much.
        match exact {
            Exact::Distribution => (spectrum_residual, distribution_residual) = (scheme.take_spectrum(), 0.0),
            Exact::Spectrum => (spectrum_residual, distribution_residual) = (0.0, scheme.take_distribution()),
        }
        Ok(Self { map, spectrum_residual, distribution_residual, iterations })
    }
}

impl HeightDistribution {
    /// `count` heights of the law in rising order, with the mean 0 and the given rms.
    fn sorted(&self, count: usize, rms: f64) -> Result<Vec<f64>> {
        let share = |k: usize| (k as f64 + 0.5) / count as f64;
        let mut heights: Vec<f64> = match self {
            Self::Gaussian => (0..count).map(|k| normal(share(k))).collect(),
            Self::Weibull { shape } => {
                if !(shape.is_finite() && *shape > 0.0) {
                    return Err(Error::domain("shape of Weibull's law", *shape, "a finite number > 0"));
                }
                (0..count).map(|k| (-(-share(k)).ln_1p()).powf(shape.recip())).collect()
            }
            Self::Of(map) => {
                let mut given: Vec<f64> = map.defined().collect();
                given.sort_by(f64::total_cmp);
                // Heights of the map stand for the middles of their shares.
                let last = given.len() - 1;
                let at = |share: f64| {
                    let place = (share * given.len() as f64 - 0.5).clamp(0.0, last as f64);
                    let (low, part) = (place as usize, place.fract());
                    given[low] + part * (given[(low + 1).min(last)] - given[low])
                };
                (0..count).map(|k| at(share(k))).collect()
            }
        };
        let mean = heights.iter().map(|h| h / count as f64).sum::<f64>();
        let found = rms_height(&heights);
        let scale = rms / found;
        if !(scale.is_normal() && mean.is_finite()) {
            return Err(Error::of_positive("rms height of the distribution", found));
        }
        for h in &mut heights {
            *h = (*h - mean) * scale;
        }
        Ok(heights)
    }
}

/// The state of the iteration.
struct Scheme<'a> {
    waves: &'a WaveGenerator,
    forward: ForwardTransform,
    inverse: &'a InverseTransform,
    sorted: Vec<f64>,
    rms: f64,
    heights: Vec<f64>,
}

impl Scheme<'_> {
    /// Gives each height that of the distribution with the same rank; returns the rms change over the rms
    /// height.
    fn take_distribution(&mut self) -> f64 {
        let mut order: Vec<usize> = (0..self.heights.len()).collect();
        order.sort_by(|&a, &b| self.heights[a].total_cmp(&self.heights[b]).then(a.cmp(&b)));
        let mut change = 0.0;
        for (&i, h) in order.iter().zip(&self.sorted) {
            change += ((h - self.heights[i]) / self.rms).powi(2);
            self.heights[i] = *h;
        }
        (change / self.heights.len() as f64).sqrt()
    }

    /// Gives each wave the amplitude of the spectrum; returns the rms change over the rms height.
    fn take_spectrum(&mut self) -> f64 {
        let Cells { columns, rows } = self.waves.cells();
        let spectrum = self.forward.of(|iy, row| {
            for (x, h) in row.iter_mut().zip(&self.heights[iy * columns..]) {
                *x = h / self.rms / columns as f64;
            }
        });
        let heights = self.inverse.of(columns / 2 + 1, |mx, column| {
            let waves = spectrum[mx * rows..].iter().zip(&self.waves.amplitudes()[mx * rows..]);
            for (wave, (found, amplitude)) in column.iter_mut().zip(waves) {
                let norm = found.norm();
                // A wave without amplitude has no phase.
                *wave = if norm > 0.0 { *found * (amplitude / norm) } else { (*amplitude).into() };
            }
        });
        let square = |(new, old): (&f64, &f64)| ((new - old) / self.rms).powi(2);
        let change: f64 = heights.iter().zip(&self.heights).map(square).sum();
        self.heights = heights;
        // By Parseval's theorem the change of the heights is that of the amplitudes.
        (change / self.heights.len() as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Anisotropy, TwinSpectrum, radial_spectrum, self_affine_map};
    use approx::assert_relative_eq;
    use contact_model::SelfAffine;
    use proptest::prelude::*;

    /// Rounding of transforms and sums, relative to the rms height.
    const ROUNDING: f64 = 1e-12;

    fn waves(cells: [usize; 2], hurst: f64, ratio: f64) -> WaveGenerator {
        let size = [cells[0] as f64, cells[1] as f64];
        let roll_off = Some(40.0 * std::f64::consts::TAU / (cells[0] as f64 * 8.0));
        let surface = SelfAffine { roll_off, ..SelfAffine::new(3.0 - hurst, size, 0.5).unwrap() };
        WaveGenerator::anisotropic(&surface, Anisotropy { ratio, lay: 20.0 }, cells).unwrap()
    }

    fn sorted(map: &HeightMap) -> Vec<f64> {
        let mut heights = map.heights().to_vec();
        heights.sort_by(f64::total_cmp);
        heights
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(12))]

        #[test]
        fn distribution_spectrum_mean_and_bits(
            cells in prop::array::uniform2(24_usize..40),
            hurst in 0.3..1.0,
            ratio in 0.5..2.0,
            shape in 1.2..5.0,
            seed: u64,
        ) {
            let waves = waves(cells, hurst, ratio);
            for law in [HeightDistribution::Gaussian, HeightDistribution::Weibull { shape }] {
                let target = law.sorted(cells[0] * cells[1], 0.5).unwrap();
                let found = PrescribedMap::new(&waves, &law, Exact::Distribution, seed).unwrap();
                for (a, b) in sorted(&found.map).iter().zip(&target) {
                    prop_assert!((a - b).abs() < ROUNDING);
                }
                prop_assert!(found.spectrum_residual < 0.12, "{} {law:?}", found.spectrum_residual);
                let mean = found.map.heights().iter().sum::<f64>() / target.len() as f64;
                prop_assert!(mean.abs() < ROUNDING);
                let again = PrescribedMap::new(&waves, &law, Exact::Distribution, seed).unwrap();
                prop_assert!(again == found);
                let spectrum = PrescribedMap::new(&waves, &law, Exact::Spectrum, seed).unwrap();
                prop_assert!(spectrum.distribution_residual < 0.12, "{}", spectrum.distribution_residual);
                let plain = radial_spectrum(&waves.map(seed).unwrap()).unwrap();
                for (a, b) in radial_spectrum(&spectrum.map).unwrap().iter().zip(plain) {
                    prop_assert!((a.1 - b.1).abs() <= 1e-9 * b.1.max(1e-9));
                }
            }
        }
    }

    #[test]
    fn the_distribution_of_a_map_is_taken_over() {
        let bumpy = self_affine_map(&SelfAffine::new(2.3, 1.0, 1.0).unwrap(), 40, 1).unwrap();
        let heights: Vec<f64> = bumpy
            .heights()
            .iter()
            .enumerate()
            .map(|(i, h)| if i == 5 { f64::NAN } else { h.exp() })
            .collect();
        let skewed = Arc::new(HeightMap::with_undefined(40, 1.0, heights).unwrap());
        let waves = WaveGenerator::twin(&bumpy, TwinSpectrum::EachWave).unwrap();
        let law = HeightDistribution::Of(Arc::clone(&skewed));
        let found = PrescribedMap::new(&waves, &law, Exact::Distribution, 3).unwrap();
        let skewness = |heights: &[f64]| {
            let (count, rms) = (heights.len() as f64, rms_height(heights));
            let mean = heights.iter().sum::<f64>() / count;
            heights.iter().map(|h| ((h - mean) / rms).powi(3)).sum::<f64>() / count
        };
        let given: Vec<f64> = skewed.defined().collect();
        assert_relative_eq!(skewness(found.map.heights()), skewness(&given), max_relative = 0.01);
        assert_relative_eq!(rms_height(found.map.heights()), 1.0, max_relative = ROUNDING);
    }

    #[test]
    fn bad_parameters_are_named() {
        let waves = waves([24, 24], 0.8, 1.0);
        for shape in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let law = HeightDistribution::Weibull { shape };
            let error = PrescribedMap::new(&waves, &law, Exact::Distribution, 1).unwrap_err().to_string();
            assert!(error.starts_with("shape of Weibull's law = "), "{error}");
        }
        // Extreme units are no errors.
        for unit in [1e-300, 1e300] {
            let map = self_affine_map(&SelfAffine::new(2.3, 1.0, unit).unwrap(), 24, 1).unwrap();
            let waves = WaveGenerator::twin(&map, TwinSpectrum::EachWave).unwrap();
            let weibull = HeightDistribution::Weibull { shape: 2.0 };
            let found = PrescribedMap::new(&waves, &weibull, Exact::Distribution, 1).unwrap();
            assert!(found.spectrum_residual < 0.2, "{}", found.spectrum_residual);
        }
        // Heights of this law overflow.
        let steep = HeightDistribution::Weibull { shape: 1e-3 };
        assert!(PrescribedMap::new(&waves, &steep, Exact::Distribution, 1).is_err());
        let flat = Arc::new(HeightMap::new(4, 1.0, vec![1.0; 16]).unwrap());
        assert!(PrescribedMap::new(&waves, &HeightDistribution::Of(flat), Exact::Spectrum, 1).is_err());
    }
}
