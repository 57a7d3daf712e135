//! Moments of a self-affine spectrum between its cut-offs, in closed form: the statistics of a surface that
//! theories use.
//!
//! The spectrum of [`SelfAffine`]: constant from `q_0 = 2 pi/L` to the roll-off, then `q^(-2 (H + 1))` to the
//! short cut-off. Integrals run over the whole plane of wavenumbers; a surface drawn on a grid has the sum
//! over the grid's waves instead. The few longest waves carry most of the height, and there the two differ:
//! at equal rms height and without roll-off, 2048 cells a side, the slope here is 35/31/24/16/9/3 % larger
//! than that of the grid for D_f = 2.0/2.2/2.4/2.6/2.8/3.0. At an equal constant ([`Amplitude::Spectrum`]),
//! or with a roll-off some octaves from the longest wave, they agree closely: compare theories with drawn
//! surfaces in that way.

use contact_model::{Amplitude, Error, Result, SelfAffine};
use std::f64::consts::{PI, TAU};

/// The isotropic spectrum `C(q)` of a self-affine surface as a continuous function.
///
/// ```
/// use analytic::spectrum::Spectrum;
/// use contact_model::SelfAffine;
/// // H = 1 and a band from 2 pi to 4 pi: h^2 = 2 pi int q C = pi c (1/q_0^2 - 1/q_1^2), slope^2 = 2 pi int q^3 C = 2 pi c ln 2, so
/// // slope^2/h^2 = 2 ln 2 q_0^2/(1 - 1/4).
/// let mut surface = SelfAffine::new(2.0, 1.0, 0.5)?;
/// surface.short_cutoff = Some(4.0 * std::f64::consts::PI);
/// let spectrum = Spectrum::new(&surface)?;
/// let ratio = (spectrum.rms_slope()? / spectrum.rms_height()).powi(2);
/// let exact = 2.0 * 2.0_f64.ln() * (2.0 * std::f64::consts::PI).powi(2) / 0.75;
/// assert!((ratio / exact - 1.0).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spectrum {
    side: f64,
    /// The rms height.
    height: f64,
    // From here on wavenumbers in 1/L and heights in the rms height.
    hurst: f64,
    low: f64,
    roll: f64,
    high: f64,
    /// C on the plateau.
    plateau: f64,
}

impl Spectrum {
    /// The spectrum of a surface with a short cut-off.
    ///
    /// # Errors
    /// Those of [`SelfAffine::validate`]; [`Error::Domain`] without a short cut-off (slope and curvature then
    /// belong to a grid, not to the surface), for one that is not beyond the longest wave `2 pi/L`, and for
    /// an amplitude that no `f64` holds.
    pub fn new(surface: &SelfAffine) -> Result<Self> {
        surface.validate()?;
        let Some(cutoff) = surface.short_cutoff else {
            let expected = "a given one: without it slope and curvature belong to a grid";
            return Err(Error::domain("short_cutoff", f64::INFINITY, expected));
        };
        let side = surface.size.length();
        let high = cutoff * side;
        if !(high.is_finite() && high > TAU) {
            return Err(Error::domain("short_cutoff times side", high, "a finite number > 2 pi"));
        }
        let roll = surface.roll_off.map_or(TAU, |q| (q * side).clamp(TAU, high));
        let mut spectrum =
            Self { side, height: 1.0, hurst: surface.hurst, low: TAU, roll, high, plateau: 1.0 };
        let variance = spectrum.moment(0);
        spectrum.plateau = variance.recip();
        spectrum.height = match surface.amplitude {
            Amplitude::RmsHeight(height) => height,
            // h^2 = c L^-2 variance, as C counts h^2 L^2.
            Amplitude::Spectrum(c) => c.sqrt() / side * variance.sqrt(),
        };
        if spectrum.height.is_normal() && spectrum.plateau.is_normal() {
            Ok(spectrum)
        } else {
            Err(Error::not_representable("rms_height", spectrum.height))
        }
    }

    /// Rms height h of the continuous spectrum, a length.
    pub fn rms_height(&self) -> f64 {
        self.height
    }

    /// `L = sqrt(Lx Ly)`, the side of a square: a length.
    pub fn side(&self) -> f64 {
        self.side
    }

    /// Rms slope `g = sqrt(2 pi int q^3 C dq)`, dimensionless.
    ///
    /// # Errors
    /// [`Error::Domain`] for a result that no `f64` holds.
    pub fn rms_slope(&self) -> Result<f64> {
        let slope = self.moment(2).sqrt() * (self.height / self.side);
        if slope.is_normal() { Ok(slope) } else { Err(Error::not_representable("rms_slope", slope)) }
    }

    /// Nayak's bandwidth parameter `alpha = m0 m4/m2^2` (J. Lubr. Technol. 93, 398 (1971)), dimensionless, at
    /// least 3/2.
    pub fn bandwidth(&self) -> f64 {
        let [m0, m2, m4] = self.profile_moments();
        m0 * (m4 / m2) / m2
    }

    /// Moments m0, m2, m4 of a profile of the surface: variances of height, slope and curvature along a line,
    /// in `h^2`, `(h/L)^2` and `(h/L^2)^2`.
    ///
    /// `m0 = h^2`, `m2 = g^2/2`, `m4 = (3/8) 2 pi int q^5 C dq`: the angular means of `cos^2` and `cos^4`.
    pub(crate) fn profile_moments(&self) -> [f64; 3] {
        [self.moment(0), 0.5 * self.moment(2), 0.375 * self.moment(4)]
    }

    /// `2 pi int q^(k + 1) C dq`, in units of the rms height and the side.
    pub(crate) fn moment(&self, k: i32) -> f64 {
        let k = f64::from(k);
        let decay = 2.0 * self.hurst + 2.0;
        let flat = power_integral(self.low, self.roll, k + 1.0);
        // C = plateau (q/roll)^-decay.
        let steep = self.roll.powf(k + 2.0) * power_integral(1.0, self.high / self.roll, k + 1.0 - decay);
        TAU * self.plateau * (flat + steep)
    }

    /// The inverse of [`Spectrum::running_slope`].
    pub(crate) fn wavenumber_at(&self, y: f64) -> f64 {
        let integral = y * y / (PI * self.plateau);
        let flat = power_integral(self.low, self.roll, 3.0);
        if integral <= flat {
            return (self.low.powi(4) + 4.0 * integral).sqrt().sqrt();
        }
        // roll^4 (t^p - 1)/p with t = q/roll and p = 2 - 2 H.
        let p = 2.0 - 2.0 * self.hurst;
        let rest = (integral - flat) / self.roll.powi(4);
        let z = p * rest;
        let logarithm = if z > 0.0 { z.ln_1p() / z * rest } else { rest };
        (self.roll * logarithm.exp()).min(self.high)
    }

    /// `y(q) = sqrt(pi int_(q_0)^q q'^3 C dq')`: the running rms slope over sqrt(2), in h/L.
    pub(crate) fn running_slope(&self, q: f64) -> f64 {
        let flat = power_integral(self.low, q.min(self.roll), 3.0);
        let steep = if q > self.roll {
            self.roll.powi(4) * power_integral(1.0, q / self.roll, 1.0 - 2.0 * self.hurst)
        } else {
            0.0
        };
        (PI * self.plateau * (flat + steep)).sqrt()
    }

    /// Wavenumbers from the longest wave to the cut-off, at most a factor sqrt(2) apart, the roll-off among
    /// them.
    pub(crate) fn ladder(&self) -> Vec<f64> {
        let mut ladder = vec![self.low];
        for (from, to) in [(self.low, self.roll), (self.roll, self.high)] {
            let steps = (2.0 * (to / from).log2()).ceil() as usize;
            for i in 1..=steps {
                ladder.push(from * (to / from).powf(i as f64 / steps as f64));
            }
        }
        ladder
    }
}

/// `int_a^b q^s dq` for 0 < a <= b, without loss where `s` is near -1.
fn power_integral(a: f64, b: f64, s: f64) -> f64 {
    let logarithm = (b / a).ln();
    let e = (s + 1.0) * logarithm;
    let mean = if e.abs() > 0.0 { e.exp_m1() / e } else { 1.0 };
    a.powf(s + 1.0) * logarithm * mean
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use numerics::gauss::Gauss;

    /// Powers with exponents up to six.
    const ROUNDING: f64 = 1e-13;

    /// A surface of side 1 and rms height 1 with q_1/q_0 = `range`.
    pub(crate) fn surface(hurst: f64, roll_off: Option<f64>, range: f64) -> SelfAffine {
        SelfAffine {
            size: 1.0.into(),
            hurst,
            amplitude: Amplitude::RmsHeight(1.0),
            roll_off: roll_off.map(|ratio| ratio * TAU),
            short_cutoff: Some(range * TAU),
        }
    }

    #[test]
    fn moments_are_their_integrals() {
        let gauss = Gauss::<16>::new();
        for hurst in [0.0, 0.3, 0.5, 0.8, 1.0] {
            for roll_off in [None, Some(1.0), Some(4.0), Some(64.0)] {
                let spectrum = Spectrum::new(&surface(hurst, roll_off, 64.0)).unwrap();
                let ladder = spectrum.ladder();
                for k in [0, 2, 4] {
                    let density = |q: f64| {
                        spectrum.plateau * (q.max(spectrum.roll) / spectrum.roll).powf(-2.0 * hurst - 2.0)
                    };
                    let sum: f64 = ladder
                        .windows(2)
                        .map(|w| gauss.integrate(w[0], w[1], |q| TAU * q.powi(k + 1) * density(q)))
                        .sum();
                    assert_relative_eq!(spectrum.moment(k), sum, max_relative = ROUNDING);
                }
                assert_relative_eq!(spectrum.moment(0), 1.0, max_relative = ROUNDING);
                assert!(spectrum.bandwidth() >= 1.5);
                // The running slope ends at g/sqrt(2), and its inverse is one.
                let end = spectrum.running_slope(spectrum.high);
                assert_relative_eq!(end, (0.5 * spectrum.moment(2)).sqrt(), max_relative = ROUNDING);
                for q in ladder {
                    let back = spectrum.wavenumber_at(spectrum.running_slope(q));
                    assert_relative_eq!(back, q, max_relative = ROUNDING);
                }
            }
        }
    }

    #[test]
    fn the_amplitude_by_its_constant() {
        // Without roll-off the constant is C(q_0); the same with a roll-off at or below the longest wave.
        let mut by_constant = surface(0.8, None, 32.0);
        let by_height = Spectrum::new(&by_constant).unwrap();
        by_constant.amplitude = Amplitude::Spectrum(by_height.plateau);
        let spectrum = Spectrum::new(&by_constant).unwrap();
        assert_relative_eq!(spectrum.rms_height(), 1.0, max_relative = ROUNDING);
        assert_relative_eq!(
            spectrum.rms_slope().unwrap(),
            by_height.rms_slope().unwrap(),
            max_relative = ROUNDING
        );
    }

    #[test]
    fn slopes_of_a_grid_with_equal_height() {
        // rms slope of 2048 x 2048 cells (data/paper/VALUES.md), and what the front page says of the
        // difference.
        for (hurst, grid, more) in [
            (1.0, 17.38, 1.35),
            (0.8, 37.29, 1.31),
            (0.6, 99.39, 1.24),
            (0.4, 283.4, 1.16),
            (0.2, 764.5, 1.09),
            (0.0, 1679.0, 1.03),
        ] {
            let slope = Spectrum::new(&surface(hurst, None, 1024.0)).unwrap().rms_slope().unwrap();
            assert_relative_eq!(slope / grid, more, epsilon = 6e-3);
        }
    }

    #[test]
    fn in_other_units() {
        let one = Spectrum::new(&surface(0.7, Some(3.0), 50.0)).unwrap();
        for length in [1e-150, 1e150] {
            let mut scaled = surface(0.7, Some(3.0), 50.0);
            scaled.size = length.into();
            scaled.amplitude = Amplitude::RmsHeight(length);
            scaled.roll_off = scaled.roll_off.map(|q| q / length);
            scaled.short_cutoff = scaled.short_cutoff.map(|q| q / length);
            let other = Spectrum::new(&scaled).unwrap();
            assert_relative_eq!(
                other.rms_slope().unwrap(),
                one.rms_slope().unwrap(),
                max_relative = ROUNDING
            );
        }
    }

    #[test]
    fn what_has_no_moments_is_an_error() {
        let mut bad = surface(0.5, None, 8.0);
        bad.short_cutoff = None;
        assert!(Spectrum::new(&bad).unwrap_err().to_string().contains("short_cutoff"));
        bad.short_cutoff = Some(TAU);
        assert!(Spectrum::new(&bad).is_err());
        bad.short_cutoff = Some(TAU * 8.0);
        bad.amplitude = Amplitude::RmsHeight(f64::NAN);
        assert!(Spectrum::new(&bad).is_err());
    }
}
