//! Whether a map is self-affine, and with which Hurst exponent.

use super::hurst::hurst_from_spectrum;
use super::spectra::radial_spectrum;
use super::window::{fit_range, windowed};
use contact_model::{Error, HeightMap, Result};
use std::f64::consts::TAU;

/// Least ratio of the longest to the shortest wave of the fit: rings 8 to 32, a map of 128 cells a side.
const LEAST_RANGE: f64 = 4.0;
/// A fitted exponent is that of a self-affine surface within this error of the fit.
const OUTSIDE: f64 = 0.1;
/// Where the spectrum is no power law, the exponents of the longer and the shorter half of the waves differ
/// by more than this over ln of the ratio of longest to shortest. Of 32 generated surfaces of 128 cells a
/// side, one reaches three quarters of it.
const BEND: f64 = 1.0;
/// The waves longer than those of the fit have less than this share of the power law's height variance where
/// the spectrum rolls off. The few waves of one Gaussian map scatter by half of theirs.
const ROLLED_OFF: f64 = 0.2;

const REMEDY: &str = "of a self-affine surface without roll-off; `crop` or `cells` may select its range, models that solve \
                      the map or take any spectrum need none";

/// A power law `C_2D ~ q^(-2 (H + 1))` fitted to the spectrum of a map: H for theories that need nothing else
/// of the map.
///
/// The fit is a straight line through the logarithms of the rings between fixed wavelengths, without an
/// interval. The statistics of a map report another fit, `SpectrumFit` of the crate `surface-statistics`:
/// that has the largest likelihood, with roll-off, cut-off, noise and intervals, between the reliable
/// wavelengths. Theories use the simpler fit here, because it costs one transform and refuses maps that are
/// not self-affine, and because the crates of models do not depend on the crate of statistics.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfAffineFit {
    /// Hurst exponent H in [0, 1].
    pub hurst: f64,
    /// Wavenumbers from and to which it was fitted ([`fit_range`]).
    pub fitted: [f64; 2],
    /// H of the longer half of these waves minus that of the shorter half, in ln q.
    pub bend: f64,
    /// Height variance of the waves longer than those of the fit, over that of the power law continued to
    /// them.
    pub long_waves: f64,
}

impl SelfAffineFit {
    /// Fits the map's spectrum under Hann's window ([`windowed`]), and checks that it is a power law down to
    /// the longest wave. On generated surfaces of 256 cells a side the fit recovers H within 0.05.
    ///
    /// # Errors
    /// [`Error::Domain`] with the number that contradicts self-affinity: undefined points, too few waves
    /// (about 128 cells along the shorter side are needed), an exponent outside [0, 1] by more than 0.1,
    /// halves whose exponents differ too much (by 0.7 for 128 cells, 0.5 for 256), long waves with less than
    /// a fifth of the power law's variance (a roll-off). Cost O(N log N) for N cells.
    pub fn new(map: &HeightMap) -> Result<Self> {
        let fitted = fit_range(map);
        let [from, to] = fitted;
        if to < from * LEAST_RANGE {
            let name = "longest over shortest wave of the fit of the Hurst exponent";
            let expected = format!("at least {LEAST_RANGE}: about 128 cells along the shorter side");
            return Err(Error::domain(name, to / from, expected));
        }
        let spectrum = radial_spectrum(&windowed(map)?)?;
        let slope = hurst_from_spectrum(&spectrum, from, to)?;
        if !(-OUTSIDE..=1.0 + OUTSIDE).contains(&slope) {
            let expected = format!("between 0 and 1, that {REMEDY}");
            return Err(Error::domain("Hurst exponent of the spectrum", slope, expected));
        }
        let middle = (from * to).sqrt();
        let bend =
            hurst_from_spectrum(&spectrum, from, middle)? - hurst_from_spectrum(&spectrum, middle, to)?;
        let most = BEND / (to / from).ln();
        if bend.abs() > most {
            let name = "Hurst exponent of the longer waves minus that of the shorter ones";
            return Err(Error::domain(name, bend, format!("at most {most:.2} either way, that {REMEDY}")));
        }
        let power = -2.0 * (slope + 1.0);
        let inside = || spectrum.iter().filter(|(q, c)| *q >= from && *q <= to && *c > 0.0);
        let constant = inside().map(|(q, c)| c.ln() - power * q.ln()).sum::<f64>() / inside().count() as f64;
        let (mut found, mut law) = (0.0, 0.0);
        for &(q, c) in spectrum.iter().take_while(|(q, _)| *q < from) {
            // The rings are equally wide.
            found += TAU * q * c;
            law += TAU * q * (constant + power * q.ln()).exp();
        }
        let long_waves = found / law;
        if long_waves.is_nan() || long_waves < ROLLED_OFF {
            let name = "height variance of the longest waves over that of the power law";
            return Err(Error::domain(name, long_waves, format!("at least {ROLLED_OFF}, that {REMEDY}")));
        }
        Ok(Self { hurst: slope.clamp(0.0, 1.0), fitted, bend, long_waves })
    }
}
