//! Hurst exponent, roll-off and cut-off of a map, with intervals.

mod likelihood;
mod minimise;
mod profile;
mod rings;

use crate::filled::FilledPoints;
use crate::relative::Relative;
use crate::taper::Taper;
use contact_model::{Boundary, Error, HeightMap, Result};
use likelihood::{CUT_OFF, HURST, Likelihood, NOISE, Parameters, ROLL_OFF};
use profile::{End, ProfileWalk};
use rings::Rings;
use statrs::distribution::{ChiSquared, ContinuousCDF as _};
use std::f64::consts::TAU;
use surface_gen::{MapPlane, defined_everywhere, rms_height};

/// Probability of a worse fit below which a fit beside filled points is repeated with longer waves.
const DOUBTFUL: f64 = 0.01;
/// Ratio of the shortest waves of two such fits.
const LONGER: f64 = 1.5;
/// Fewest rings of a fit.
const FEWEST: usize = 8;
/// Half the 95 % quantile of chi-square with one degree of freedom: rise of the profile at the ends of an
/// interval.
const INTERVAL: f64 = 0.5 * 3.841_458_820_694_124;
/// Half the 90 % quantile: rise at a bound, which leaves 5 % on its one side.
const BOUND: f64 = 0.5 * 2.705_543_454_095_404;
/// Gain of the logarithm of the likelihood above which a cut-off is accepted. The limit is high because a
/// cut-off may be anywhere among the rings, and with a noise it fits any step in a spectrum. A true cut-off
/// inside the fit gains hundreds.
const EDGE: f64 = 6.0;
/// A cut-off is known to half of a wave of the map at best, in rings.
const RESOLUTION: f64 = 0.5;
/// Largest number of restarts, each from a better minimum that was found along a profile.
const RESTARTS: usize = 8;
/// What a plane leaves of heights within 1 is rounding up to this.
const ROUNDING: f64 = 1e-13;
/// Ratio of wavenumbers of the bins in which the fit is tested.
const TEST_BIN: f64 = 1.25;

/// A number and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The value of the largest likelihood.
    pub value: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Whether x lies inside.
    pub fn contains(&self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }
}

/// A wavelength with its interval where the map contains it, else a bound.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Wavelength {
    /// The wavelength with a 95 % interval.
    Interval(Interval),
    /// At least this, with 95 % confidence: the map ends before it (or there is none).
    AtLeast(f64),
    /// At most this, with 95 % confidence: the cells are too coarse for it (or there is none).
    AtMost(f64),
}

impl Wavelength {
    /// Whether x lies in the interval or on the side of the bound.
    pub fn contains(&self, x: f64) -> bool {
        match self {
            Self::Interval(interval) => interval.contains(x),
            Self::AtLeast(bound) => x >= *bound,
            Self::AtMost(bound) => x <= *bound,
        }
    }
}

/// The range of wavelengths of a fit, and the boundary of the map.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FitOptions {
    /// [`Boundary::Periodic`] takes the map as it is; [`Boundary::Free`] removes its plane and lays Hann's
    /// window over it.
    pub boundary: Boundary,
    /// Shortest wavelength of the fit, such as that down to which the instrument is reliable; `None`: that of
    /// the cells.
    pub shortest: Option<f64>,
    /// Longest wavelength of the fit; `None`: that of the map.
    pub longest: Option<f64>,
}

/// A self-affine spectrum fitted to a map: `C_2D(q)` is constant below the roll-off, falls as `q^(-2 (H +
/// 1))` from there to the cut-off and is 0 beyond it, besides a white noise of the instrument everywhere.
///
/// The fit maximises the likelihood of the periodogram averaged over rings one wave wide (Whittle): for
/// Gaussian heights the squared amplitudes of the waves are independent and exponentially distributed, with
/// the spectrum as their mean, so that the mean of n of them has a gamma law. Under Hann's window the
/// expectation of each ring is that of the spectrum smeared by the window's transform (the leakage of long
/// waves into short ones is part of it; Sykulski et al., Biometrika 106, 251 (2019)), and its neighbours are
/// correlated: the logarithm of the likelihood is divided by (35/18)^2, the number of waves that count as
/// one. The rings then begin at four waves along the shorter side, because removing the plane affects longer
/// waves, and end two waves before the limit of the grid. Intervals are those of the profile likelihood
/// (twice its logarithm has fallen by 3.84); a bound is one-sided (2.71). The interval of a cut-off is no
/// narrower than one wave of the map.
///
/// * A cut-off is accepted where it raises the logarithm of the likelihood by more than 6, because it may be
///   anywhere among the rings and, with a noise beyond it, fits any step. The window spreads its edge over
///   several rings; each of them then has a weight of one fifth. Rings farther beyond it are left out where
///   their power is less than ten times the leakage of long waves.
/// * Where the likelihood does not favour a roll-off, a cut-off or a noise over none, the exponent is that of
///   the fit without it, and its interval covers both fits: each of these parameters can only make the
///   exponent larger.
///
/// The fit assumes an isotropic Gaussian surface without waves beyond the limit of the grid (no aliasing).
/// Surfaces with prescribed amplitudes, such as those of [`surface_gen::self_affine_map`], scatter less on
/// their own period than the law predicts, so their intervals are too wide; a part cut out of such a surface
/// is practically Gaussian.
///
/// Statistics of a map report this fit. [`surface_gen::SelfAffineFit`] is another one, a straight line
/// through the logarithms of the rings over fixed wavelengths, for theories that need H alone. It has no
/// interval, no roll-off and no correction for the window, and it refuses maps whose spectrum is no power law
/// down to the longest wave. On the maps that it accepts, the two differ by its larger scatter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumFit {
    /// Hurst exponent H; outside of 0 to 1 the surface is not self-affine.
    pub hurst: Interval,
    /// Roll-off, a length.
    pub roll_off: Wavelength,
    /// Cut-off, a length.
    pub cut_off: Wavelength,
    /// Density `C_2D` of the power law at the wavenumber `sqrt(q_1 q_2)` of `fitted`, without noise, in
    /// length^4. Where the spectrum has rolled off, the power law is extrapolated to there.
    pub density: f64,
    /// Density of the white noise, in length^4, where the likelihood favours it over none (95 %). Beyond a
    /// cut-off it is the whole remaining density, including rounding and leakage of the window.
    pub noise: Option<f64>,
    /// Smallest and largest wavenumber of the fitted rings, in 1/length.
    pub fitted: [f64; 2],
    /// Probability that a Gaussian surface of the fitted spectrum deviates at least as much from it. Below
    /// about 0.01 the surface is not of this kind and the intervals are meaningless. It follows from the
    /// deviance in bins of a quarter of an octave up to the cut-off.
    pub goodness: f64,
}

impl SpectrumFit {
    /// Fits a map.
    ///
    /// The cost is O(N log N), under a window 600 N more, and about 1e4 evaluations of the rings: about 0.2 s
    /// for 128 cells a side.
    ///
    /// # Errors
    /// [`Error::Domain`] for undefined points, heights that are all equal or lie in a plane, limits that are
    /// no positive numbers, fewer than 8 rings between the limits, and a spectrum without a power law, where
    /// the likelihood favours no exponent between -0.95 and 4.
    ///
    /// ```
    /// use contact_model::{Boundary, SelfAffine};
    /// use surface_statistics::{FitOptions, SpectrumFit};
    /// // Roll-off at an eighth of the side.
    /// let roll_off = Some(8.0 * std::f64::consts::TAU);
    /// let surface = SelfAffine { roll_off, ..SelfAffine::new(2.2, 1.0, 0.01)? };
    /// let map = surface_gen::self_affine_map(&surface, 128, 1)?;
    /// let periodic = FitOptions { boundary: Boundary::Periodic, ..FitOptions::default() };
    /// let fit = SpectrumFit::new(&map, &periodic)?;
    /// assert!((fit.hurst.value - 0.8).abs() < 0.02 && fit.roll_off.contains(1.0 / 8.0));
    /// // The spectrum goes on to the limit of the grid.
    /// assert!(matches!(fit.cut_off, surface_statistics::Wavelength::AtMost(_)));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap, options: &FitOptions) -> Result<Self> {
        Self::with(map, None, options)
    }

    /// Fits a map whose undefined points were filled between their neighbours: the power of each ring is
    /// divided by the share that such a map has of it, and the fit ends where this is not known well enough
    /// ([`FilledPoints::shortest`]).
    ///
    /// Beyond a cut-off of the surface there is nothing that could be missing, but the rims of the holes make
    /// waves of their own there. Where the fit finds no exponent, or has a [`SpectrumFit::goodness`] below 0.01,
    /// it is repeated with waves of 1.5 times the length at least, up to twice the width of the largest hole.
    /// [`SpectrumFit::fitted`] shows where it ended.
    ///
    /// # Errors
    /// As [`SpectrumFit::new`].
    pub fn of_filled(map: &HeightMap, filled: &FilledPoints, options: &FitOptions) -> Result<Self> {
        let first = options.shortest.unwrap_or(0.0).max(filled.shortest());
        let fit = |shortest: f64| {
            let shortest = Some(shortest).filter(|shortest| *shortest > 0.0);
            Self::with(map, Some(filled), &FitOptions { shortest, ..*options })
        };
        let good = |found: &Result<Self>| found.as_ref().is_ok_and(|fit| fit.goodness >= DOUBTFUL);
        let (mut best, mut shortest) = (fit(first), first);
        while !good(&best) && shortest > 0.0 && shortest * LONGER <= filled.twice_the_widest() {
            shortest *= LONGER;
            let next = fit(shortest);
            if good(&next) || best.is_err() {
                best = next;
            }
        }
        best
    }

    fn with(map: &HeightMap, filled: Option<&FilledPoints>, options: &FitOptions) -> Result<Self> {
        defined_everywhere(map, "a fit of the spectrum")?;
        let limits = limits(options)?;
        let windowed = options.boundary != Boundary::Periodic;
        let prepared = if windowed { Taper::Hann.over(&without_plane(map)?)? } else { map.clone() };
        let mut rings = Rings::new(&prepared, windowed, limits)?;
        if let Some(filled) = filled {
            for ring in &mut rings.all {
                ring.power /= filled.kept(TAU / (ring.wavenumber * rings.width));
            }
        }
        if rings.all.len() < FEWEST {
            let expected = format!("at least {FEWEST} between the longest and the shortest wave of the fit");
            return Err(Error::domain("rings of the spectrum", rings.all.len() as f64, expected));
        }
        if rings.all.iter().all(|ring| ring.power <= 0.0) {
            return Err(Error::domain("rms height of the map", 0.0, "a rough surface: a finite number > 0"));
        }
        if !rings.density.is_normal() {
            return Err(Error::not_representable("power spectral density", rings.density));
        }
        let mut likelihood = Likelihood::new(rings);
        let mut best = likelihood.best();
        for _ in 0..RESTARTS {
            match Ends::new(&mut likelihood, best) {
                Ok((ends, best)) => {
                    let simple = ends.simpler(&mut likelihood, best);
                    return ends.fit(&mut likelihood, best, simple);
                }
                Err(better) => best = likelihood.minimum(better, &[]),
            }
        }
        Err(Error::domain("better minima of the likelihood", RESTARTS as f64, "a spectrum with one minimum"))
    }
}

fn limits(options: &FitOptions) -> Result<[f64; 2]> {
    for (name, length) in [
        ("shortest wavelength of the fit", options.shortest),
        ("longest wavelength of the fit", options.longest),
    ] {
        if let Some(length) = length.filter(|length| !(length.is_finite() && *length > 0.0)) {
            return Err(Error::domain(name, length, "a finite number > 0"));
        }
    }
    Ok([options.longest.map_or(0.0, |l| TAU / l), options.shortest.map_or(f64::INFINITY, |l| TAU / l)])
}

/// The map without the plane of least squares.
fn without_plane(map: &HeightMap) -> Result<HeightMap> {
    let Relative { heights, unit } = Relative::new(map);
    let plane = MapPlane::fit(map.cells(), heights.iter().copied());
    let flat: Vec<f64> = heights.iter().enumerate().map(|(i, h)| h - plane.height(i)).collect();
    let rms = rms_height(&flat);
    // Half of the range of the heights is 1.
    if rms < ROUNDING {
        let expected = "a rough surface: a number > 0, its plane removed";
        return Err(Error::domain("rms height of the map", rms * unit, expected));
    }
    HeightMap::new(map.cells(), map.size(), flat.into_iter().map(|h| h * unit).collect())
}

/// The end of a profile.
///
/// # Errors
/// A better minimum than `best`.
fn walk(likelihood: &mut Likelihood, best: (Parameters, f64), walk: ProfileWalk) -> Result<End, Parameters> {
    match profile::end(likelihood, best, &[], walk) {
        End::Better(parameters) => Err(parameters),
        end => Ok(end),
    }
}

/// Ends of the profiles.
struct Ends {
    hurst: [End; 2],
    /// Lower end, unless there may be no roll-off, and upper end or bound.
    roll_off: (Option<f64>, End),
    cut_off: CutOff,
    noisy: bool,
}

/// What the likelihood says about the cut-off, wavenumbers in rings.
enum CutOff {
    At {
        value: f64,
        low: End,
        high: End,
    },
    /// It may be missing; the lower end of where it may be.
    Above(End),
}

impl Ends {
    /// # Errors
    /// A better minimum than `best`.
    fn new(
        likelihood: &mut Likelihood,
        mut best: (Parameters, f64),
    ) -> Result<(Self, (Parameters, f64)), Parameters> {
        likelihood.count_all();
        let mut without = best.0;
        without.values[CUT_OFF] = likelihood.limits[CUT_OFF][1];
        let without = likelihood.minimum(without, &[CUT_OFF]).1;
        let cut_off = if without - best.1 > EDGE {
            let ends = [false, true].map(|upwards| {
                walk(likelihood, best, ProfileWalk { index: CUT_OFF, upwards, rise: INTERVAL })
            });
            let [low, high] = ends;
            let edge = best.0.values[CUT_OFF];
            likelihood.share_edge(edge);
            best = likelihood.minimum(best.0, &[]);
            CutOff::At { value: edge, low: low?, high: high? }
        } else {
            let down = ProfileWalk { index: CUT_OFF, upwards: false, rise: BOUND };
            CutOff::Above(walk(likelihood, best, down)?)
        };
        let mut walk = |index, upwards, rise| walk(likelihood, best, ProfileWalk { index, upwards, rise });
        let hurst = [walk(HURST, false, INTERVAL)?, walk(HURST, true, INTERVAL)?];
        let roll_off = match walk(ROLL_OFF, false, INTERVAL)? {
            End::At(low) => (Some(low), walk(ROLL_OFF, true, INTERVAL)?),
            _ => (None, walk(ROLL_OFF, true, BOUND)?),
        };
        let noisy = matches!(walk(NOISE, false, INTERVAL)?, End::At(_));
        Ok((Self { hurst, roll_off, cut_off, noisy }, best))
    }

    /// The minimum without what the likelihood does not tell from none, and the ends of the exponent there;
    /// `None` where there is nothing to leave out.
    fn simpler(
        &self,
        likelihood: &mut Likelihood,
        best: (Parameters, f64),
    ) -> Option<(Parameters, [End; 2])> {
        let left_out = [
            (ROLL_OFF, self.roll_off.0.is_none(), 0),
            (CUT_OFF, matches!(self.cut_off, CutOff::Above(_)), 1),
            (NOISE, !self.noisy, 0),
        ];
        let fixed: Vec<usize> =
            left_out.iter().filter(|(_, out, _)| *out).map(|(index, ..)| *index).collect();
        if fixed.is_empty() {
            return None;
        }
        let mut start = best.0;
        for (index, _, end) in left_out.iter().filter(|(_, out, _)| *out) {
            start.values[*index] = likelihood.limits[*index][*end];
        }
        let minimum = likelihood.minimum(start, &fixed);
        let ends = [false, true].map(|upwards| {
            let walk = ProfileWalk { index: HURST, upwards, rise: INTERVAL };
            profile::end(likelihood, minimum, &fixed, walk)
        });
        Some((minimum.0, ends))
    }

    fn fit(
        self,
        likelihood: &mut Likelihood,
        best: (Parameters, f64),
        simple: Option<(Parameters, [End; 2])>,
    ) -> Result<SpectrumFit> {
        let [hurst, roll_off, ..] = best.0.values;
        let [End::At(low), End::At(high)] = self.hurst else {
            let expected = "an exponent that the spectrum determines: a power law over more waves";
            return Err(Error::domain("Hurst exponent of the spectrum", hurst, expected));
        };
        let (hurst, low, high) = match &simple {
            Some((parameters, [End::At(l), End::At(h)])) => {
                (parameters.values[HURST], low.min(*l), high.max(*h))
            }
            _ => (hurst, low, high),
        };
        let chosen = simple.map_or(best.0, |(parameters, _)| parameters);
        let rings = likelihood.rings();
        let (width, density, range) = (rings.width, rings.density, rings.range);
        let wavelength = |q: f64| TAU / (q * width);
        let at = |end: &End, limit: f64| if let End::At(q) = end { *q } else { limit };
        let shortest_roll_off = wavelength(at(&self.roll_off.1, likelihood.limits[ROLL_OFF][1]).exp());
        let roll_off = match self.roll_off.0 {
            Some(q) => Wavelength::Interval(Interval {
                value: wavelength(roll_off.exp()),
                low: shortest_roll_off,
                high: wavelength(q.exp()),
            }),
            None => Wavelength::AtLeast(shortest_roll_off),
        };
        let [first_cut_off, last_cut_off] = likelihood.limits[CUT_OFF];
        let cut_off = match &self.cut_off {
            CutOff::At { value, low, high } => Wavelength::Interval(Interval {
                value: wavelength(*value),
                low: wavelength(at(high, last_cut_off).max(value + RESOLUTION)),
                high: wavelength(at(low, first_cut_off).min(value - RESOLUTION)),
            }),
            CutOff::Above(low) => Wavelength::AtMost(wavelength(at(low, first_cut_off).min(range[1]))),
        };
        let factor = likelihood.factor(chosen);
        Ok(SpectrumFit {
            hurst: Interval { value: hurst, low, high },
            roll_off,
            cut_off,
            density: density * factor,
            noise: self.noisy.then_some(density * factor * chosen.values[NOISE].exp()),
            fitted: range.map(|q| q * width),
            goodness: goodness(likelihood, chosen, chosen.values[CUT_OFF]),
        })
    }
}

/// Tail probability of the deviance in wide bins.
fn goodness(likelihood: &mut Likelihood, best: Parameters, cut_off: f64) -> f64 {
    let factor = likelihood.factor(best);
    let expected = likelihood.expect(best).to_vec();
    let (mut deviance, mut bins) = (0.0, 0);
    let (mut start, mut sums) = (0.0, [0.0; 3]);
    let last = cut_off - 2.0;
    let rings: Vec<_> =
        likelihood.rings().all.iter().zip(&expected).filter(|(r, _)| r.wavenumber < last).collect();
    for (k, (ring, m)) in rings.iter().enumerate() {
        if sums[0] <= 0.0 {
            start = ring.wavenumber;
        }
        let n = ring.independent;
        sums = [sums[0] + n, sums[1] + n * (ring.power / (*m * factor)), sums[2] + 1.0];
        // Four waves, so that those at both sides of an edge are few.
        if (ring.wavenumber >= start * TEST_BIN && sums[2] >= 4.0) || k + 1 == rings.len() {
            let ratio = sums[1] / sums[0];
            if ratio > 0.0 {
                deviance += 2.0 * sums[0] * (ratio - 1.0 - ratio.ln());
                bins += 1;
            }
            sums = [0.0; 3];
        }
    }
    let freedom = (f64::from(bins) - 4.0).max(1.0);
    ChiSquared::new(freedom).map_or(0.0, |law| law.sf(deviance).clamp(0.0, 1.0))
}
