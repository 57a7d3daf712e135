//! The Hurst exponent of a profile from its own spectrum.

use crate::fit::Interval;
use crate::spectrum::PowerSpectrum;
use crate::taper::Taper;
use contact_model::units::five;
use contact_model::{Boundary, Error, HeightMap, Result};
use std::f64::consts::{PI, TAU};
use surface_gen::hurst_from_line_spectrum;

/// Steps of the shortest wave of the fit: shorter ones are those of the instrument and of aliasing.
const STEPS: f64 = 4.0;
/// Waves along a free profile of the longest wave of the fit: the trend takes part in longer ones.
const WAVES: f64 = 4.0;
/// Fewest waves of a fit.
const FEWEST: usize = 8;
/// Of the normal law.
const QUANTILE: f64 = 1.96;
/// How many times the variance of a sum of logarithms of neighbouring waves is that of independent ones under
/// Hann's window: their amplitudes are correlated by 2/3 and 1/6, logarithms of their squares by about the
/// squares of that.
const HANN: f64 = 1.95;

/// A power law `C_1D ~ q^-(1 + 2 H)` fitted to the waves of one row.
///
/// A profile is one line through a surface: H is the Hurst exponent of an isotropic surface with such lines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProfileFit {
    /// Hurst exponent with its 95 % interval.
    pub hurst: Interval,
    /// Shortest and longest wavelength of the fit.
    pub wavelengths: [f64; 2],
}

impl ProfileFit {
    /// Fits `ln C_1D` over `ln q` by least squares, each wave with the same weight. The interval follows from
    /// the variance `pi^2/6` that `ln` of a periodogram of a Gaussian profile has at every wave. The fit uses
    /// waves longer than four steps (and than twice the distance `instrument` where it is known); of a free
    /// profile, which is taken under Hann's window, only waves shorter than a quarter of it.
    ///
    /// # Errors
    /// [`Error::Domain`] for more than one row, fewer than 8 waves in the range, and what
    /// [`PowerSpectrum::along_x`] refuses.
    ///
    /// ```
    /// use contact_model::{Boundary, HeightMap};
    /// use surface_statistics::ProfileFit;
    /// // Waves of amplitudes k^-1.3: C_1D ~ q^-2.6, H = 0.8.
    /// let height = |x: f64| (1..=100).map(|k| f64::from(k).powf(-1.3) * (f64::from(k) * x + f64::from(k * k)).cos()).sum();
    /// let profile = HeightMap::from_fn([400, 1], [1.0, 0.0025], |i, _| height(std::f64::consts::TAU * i as f64 / 400.0))?;
    /// assert!((ProfileFit::new(&profile, Boundary::Periodic, None)?.hurst.value - 0.8).abs() < 1e-6);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(profile: &HeightMap, boundary: Boundary, instrument: Option<f64>) -> Result<Self> {
        if profile.rows() != 1 {
            return Err(Error::domain("rows of a profile", profile.rows() as f64, "1"));
        }
        let periodic = boundary == Boundary::Periodic;
        let spectrum = PowerSpectrum::along_x(profile, if periodic { Taper::None } else { Taper::Hann })?;
        let length = profile.size().x;
        let shortest = (STEPS * profile.dx()).max(instrument.unwrap_or(0.0));
        let longest = if periodic { length } else { length / WAVES };
        let inside = |q: f64| (shortest * (1.0 - 1e-9)..=longest * (1.0 + 1e-9)).contains(&(TAU / q));
        let pairs = spectrum.wavenumber.iter().zip(&spectrum.density);
        let waves: Vec<(f64, f64)> =
            pairs.filter(|(q, c)| inside(**q) && c.is_normal()).map(|(q, c)| (*q, *c)).collect();
        if waves.len() < FEWEST {
            let expected =
                format!("at least {FEWEST} from {} to {} long", five(shortest, ""), five(longest, ""));
            return Err(Error::domain("waves of a fit", waves.len() as f64, expected));
        }
        let value = hurst_from_line_spectrum(&waves, 0.0, f64::INFINITY)?;
        let points: Vec<f64> = waves.iter().map(|wave| wave.0.ln()).collect();
        let middle = points.iter().sum::<f64>() / points.len() as f64;
        let spread: f64 = points.iter().map(|x| (x - middle).powi(2)).sum();
        let inflation = if periodic { 1.0 } else { HANN };
        let error = QUANTILE * 0.5 * (inflation * PI * PI / 6.0 / spread).sqrt();
        let hurst = Interval { value, low: value - error, high: value + error };
        Ok(Self { hurst, wavelengths: [shortest, longest] })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::SelfAffine;

    #[test]
    fn intervals_of_lines_cut_out_of_longer_ones_hold_the_exponent() {
        // 100 pieces, an eighth of a random line each.
        for hurst in [0.3, 0.8] {
            let surface = SelfAffine::new(3.0 - hurst, 1.0, 0.01).unwrap();
            let mut held = 0;
            let mut sum = 0.0;
            for seed in 0..100 {
                let line = surface_gen::self_affine_line(&surface, 8 * 512, seed).unwrap();
                let piece = line.heights()[700..1212].to_vec();
                let map = HeightMap::new([512, 1], [512.0 * line.element(), line.element()], piece).unwrap();
                let fit = ProfileFit::new(&map, Boundary::Free, None).unwrap();
                held += usize::from(fit.hurst.contains(hurst));
                sum += fit.hurst.value;
            }
            assert!((85..=100).contains(&held), "H = {hurst}: {held} of 100");
            assert!((sum / 100.0 - hurst).abs() < 0.03, "H = {hurst}: mean {}", sum / 100.0);
        }
    }

    #[test]
    fn maps_and_short_profiles_are_refused() {
        let map = HeightMap::from_fn([64, 2], [64.0, 2.0], |x, y| (x * x + y) as f64).unwrap();
        assert!(ProfileFit::new(&map, Boundary::Free, None).unwrap_err().to_string().contains("rows"));
        let short = HeightMap::from_fn([20, 1], [20.0, 1.0], |x, _| (x * x % 7) as f64).unwrap();
        let error = ProfileFit::new(&short, Boundary::Free, None).unwrap_err().to_string();
        assert!(error.contains("waves of a fit"), "{error}");
        let long = HeightMap::from_fn([200, 1], [200.0, 1.0], |x, _| (x * x % 7) as f64).unwrap();
        assert!(ProfileFit::new(&long, Boundary::Free, Some(100.0)).is_err());
    }
}
