//! Greenwood and Williamson: independent summits, their statistics from the spectrum (Nayak, McCool).

use crate::closed;
use crate::periodic::{self, Periodic, PeriodicLaw};
use crate::spectrum::Spectrum;
use contact_model::{
    Abilities, ContactModel, Error, PreparedContact, Result, Scaling, Scene, Source, Surface,
};
use numerics::gauss::Gauss;
use numerics::root;
use std::f64::consts::PI;
use surface_gen::MapStatistics;

const NAME: &str = "greenwood_williamson";

/// `1 - s^2/m0 = 0.8968/alpha`: the reduced scatter of summits compared with heights (Bush, Gibson, Thomas
/// 1975, as used by McCool).
const SUMMIT_SCATTER: f64 = 0.8968;

/// Greenwood and Williamson's contact of spherical summits without mutual influence, in McCool's variant.
///
/// From the profile moments m0, m2, m4 of the spectrum, `alpha = m0 m4/m2^2`: all summits have the radius
/// `R = (3/8) sqrt(pi/m4)`, there are `n = m4/(6 sqrt(3) pi m2)` per area, and their heights scatter by
/// `s = sqrt((1 - 0.8968/alpha) m0)` around a plane that lies `4 sqrt(m0/(pi alpha))` above the mean of the
/// surface. At a flat t s above that plane, per area: `p = (4/3) n E* sqrt(R) s^(3/2) F_(3/2)(t)`,
/// `A/A0 = pi n R s F_1(t)`, `K = 2 n E* sqrt(R s) F_(1/2)(t)`, with
/// `F_j(t) = int_t^inf (x - t)^j phi(x) dx`.
///
/// The mean gap is the distance of the flat from the mean plane of the undeformed surface, because the
/// surface of the theory does not move between summits. Loads beyond t = 0, where half of the summits would
/// be in contact, are [`Error::OutOfRange`].
///
/// Takes a [`Surface::SelfAffine`] with a short cut-off or [`Surface::Heights`], and
/// [`contact_model::Boundary::Periodic`] (the theory has no edges); the seed has no influence. The moments of
/// a map are measured ([`surface_gen::MapStatistics`]); its m4 depends on its shortest waves.
///
/// ```
/// use analytic::GreenwoodWilliamson;
/// use analytic::greenwood_williamson::{SummitHeights, Summits};
/// use contact_model::{Boundary, ContactModel, Load, Scene, SelfAffine, Surface};
/// let mut surface = SelfAffine::new(2.2, 1.0, 0.01)?;
/// surface.short_cutoff = Some(100.0 * std::f64::consts::TAU);
/// let summits = Summits::new(&analytic::spectrum::Spectrum::new(&surface)?);
/// let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
/// scene.effects.boundary = Boundary::Periodic;
/// // With exponential heights k = F/s exactly.
/// let model = GreenwoodWilliamson { heights: SummitHeights::Exponential };
/// let state = model.prepare(&scene, 0)?.solve(Load::force(1e-5))?;
/// assert!((state.stiffness.unwrap_or(0.0) * summits.scatter / 1e-5 - 1.0).abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct GreenwoodWilliamson {
    /// Distribution of the heights of the summits.
    pub heights: SummitHeights,
}

/// Distribution of the heights of summits around their mean plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[non_exhaustive]
pub enum SummitHeights {
    /// `phi(x) = exp(-x^2/2)/sqrt(2 pi)`.
    #[default]
    Gaussian,
    /// `phi(x) = exp(-x)` for x > 0: Greenwood and Williamson's simple case.
    Exponential,
}

/// The statistics of summits that the theory uses, in the surface's own units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Summits {
    /// Number of summits per area.
    pub density: f64,
    /// Radius of curvature of every summit.
    pub radius: f64,
    /// Standard deviation s of their heights.
    pub scatter: f64,
    /// Height of their mean plane above that of the surface.
    pub elevation: f64,
}

impl Summits {
    /// Summits of an isotropic Gaussian surface with this spectrum (McCool's variant, see
    /// [`GreenwoodWilliamson`]).
    pub fn new(spectrum: &Spectrum) -> Self {
        Self::unscaled(spectrum.profile_moments(), spectrum.side(), spectrum.rms_height())
    }

    /// The summits of a map, from its measured moments.
    pub fn of_map(map: &MapStatistics) -> Self {
        Self::unscaled(map.profile_moments(), map.length, map.rms_height)
    }

    fn unscaled(moments: [f64; 3], side: f64, height: f64) -> Self {
        let own = Self::scaled(moments);
        Self {
            density: own.density / side / side,
            radius: own.radius * side * (side / height),
            scatter: own.scatter * height,
            elevation: own.elevation * height,
        }
    }

    /// In units of the rms height and the side: the radius in L^2/h.
    fn scaled([m0, m2, m4]: [f64; 3]) -> Self {
        let alpha = m0 * (m4 / m2) / m2;
        Self {
            density: m4 / m2 / (6.0 * 3.0_f64.sqrt() * PI),
            radius: 0.375 * (PI / m4).sqrt(),
            scatter: ((1.0 - SUMMIT_SCATTER / alpha) * m0).sqrt(),
            elevation: 4.0 * (m0 / (PI * alpha)).sqrt(),
        }
    }
}

impl ContactModel for GreenwoodWilliamson {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "J. A. Greenwood, J. B. P. Williamson, Proc. R. Soc. Lond. A 295, 300 (1966)",
                what: "force, area and stiffness of independent summits",
            },
            Source {
                citation: "P. R. Nayak, J. Lubr. Technol. 93, 398 (1971); J. I. McCool, Wear 107, 37 (1986)",
                what: "density, curvature, scatter and elevation of summits from m0, m2, m4",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        periodic::RANDOM
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        closed::refuse_profile(scene, NAME)?;
        self.abilities().refuse(NAME, scene)?;
        let (moments, height) = match &scene.surface {
            Surface::SelfAffine(surface) => {
                let spectrum = Spectrum::new(surface)?;
                (spectrum.profile_moments(), spectrum.rms_height())
            }
            Surface::Heights(map) => {
                let measured = MapStatistics::new(map)?;
                (measured.profile_moments(), measured.rms_height)
            }
            other => return Err(Error::unsupported(NAME, other.kind())),
        };
        let summits = Summits::scaled(moments);
        let law = AsperityModel { summits, heights: self.heights, gauss: Gauss::<16>::new() };
        let strategy = "integral over independent summits (Greenwood, Williamson; McCool)";
        Ok(closed::prepared(Scaling::of_rough(scene, height)?, Periodic { model: NAME, law, strategy }))
    }
}

/// `F_j(t) = int_t^inf (x - t)^j phi(x) dx` for a Gaussian phi, j > -1/2 and t >= 0: 0.43001999 for j = 3/2,
/// t = 0.
///
/// # Errors
/// [`Error::Domain`] for a j or t outside this range.
///
/// ```
/// assert!((analytic::greenwood_williamson::gaussian_integral(1.5, 1.0)? - 0.07566818).abs() < 1e-8);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn gaussian_integral(j: f64, t: f64) -> Result<f64> {
    if !(j.is_finite() && j > -0.5) {
        return Err(Error::domain("j", j, "a finite number > -1/2"));
    }
    if !(t.is_finite() && t >= 0.0) {
        return Err(Error::domain("t", t, "a finite number >= 0"));
    }
    Ok(gaussian(&Gauss::<16>::new(), j, t) * (-0.5 * t * t).exp())
}

/// `exp(t^2/2) F_j(t)`, without underflow: with `x = t + v^2`,
/// `2/sqrt(2 pi) int v^(2 j + 1) exp(-t v^2 - v^4/2) dv`.
fn gaussian(gauss: &Gauss<16>, j: f64, t: f64) -> f64 {
    /// exp(-45) is beyond the last place.
    const SMALL: f64 = 45.0;
    const PANELS: u32 = 8;
    // t v^2 + v^4/2 = SMALL.
    let end = (2.0 * SMALL / (t + (t * t + 2.0 * SMALL).sqrt())).sqrt();
    let step = end / f64::from(PANELS);
    let sum: f64 = (0..PANELS)
        .map(|i| {
            let low = f64::from(i) * step;
            gauss.integrate(low, low + step, |v| {
                let y = v * v;
                v.powf(2.0 * j + 1.0) * (-y * (t + 0.5 * y)).exp()
            })
        })
        .sum();
    sum * 2.0 / (2.0 * PI).sqrt()
}

/// In units of the rms height and the side.
struct AsperityModel {
    summits: Summits,
    heights: SummitHeights,
    gauss: Gauss<16>,
}

/// The flat is never further from the mean plane of the summits than this many s: there F is below the
/// smallest f64.
const FARTHEST: f64 = 37.0;

impl AsperityModel {
    /// `ln F_j(t)` with 2 j = `twice`.
    fn logarithm(&self, twice: u32, t: f64) -> f64 {
        match self.heights {
            SummitHeights::Gaussian => gaussian(&self.gauss, 0.5 * f64::from(twice), t).ln() - 0.5 * t * t,
            SummitHeights::Exponential => {
                // Gamma(j + 1) for j = 1/2, 1, 3/2.
                let gamma: f64 = match twice {
                    1 => PI.sqrt() / 2.0,
                    2 => 1.0,
                    _ => 0.75 * PI.sqrt(),
                };
                gamma.ln() - t
            }
        }
    }

    /// `(4/3) n sqrt(R) s^(3/2)`.
    fn pressure_factor(&self) -> f64 {
        let Summits { density, radius, scatter, .. } = self.summits;
        4.0 / 3.0 * density * (radius * scatter).sqrt() * scatter
    }

    fn pressure_at(&self, t: f64) -> f64 {
        self.pressure_factor() * self.logarithm(3, t).exp()
    }

    /// Separation over s.
    fn separation(&self, pressure: f64) -> Result<f64> {
        let asked = (pressure / self.pressure_factor()).ln();
        if let SummitHeights::Exponential = self.heights {
            return Ok((self.logarithm(3, 0.0) - asked).max(0.0));
        }
        if asked < self.logarithm(3, FARTHEST) {
            let min = self.pressure_at(FARTHEST);
            let name = "mean pressure over E* h/L".into();
            return Err(Error::OutOfRange { name, value: pressure, min, max: self.pressure_at(0.0) });
        }
        Ok(root::between(0.0, FARTHEST, |t| self.logarithm(3, t) - asked))
    }
}

impl PeriodicLaw for AsperityModel {
    fn admit(&self, pressure: f64) -> Result<()> {
        let max = self.pressure_at(0.0);
        if pressure <= max * crate::closed::ROUNDED_UP {
            Ok(())
        } else {
            let name = "mean pressure over E* h/L (half of the summits are in contact at the largest)".into();
            Err(Error::OutOfRange { name, value: pressure, min: 0.0, max })
        }
    }

    fn fraction(&self, pressure: f64) -> Result<f64> {
        let Summits { density, radius, scatter, .. } = self.summits;
        Ok(PI * density * radius * scatter * self.logarithm(2, self.separation(pressure)?).exp())
    }

    fn stiffness(&self, pressure: f64) -> Result<Option<f64>> {
        let Summits { density, radius, scatter, .. } = self.summits;
        let t = self.separation(pressure)?;
        Ok(Some(2.0 * density * (radius * scatter).sqrt() * self.logarithm(1, t).exp()))
    }

    fn gap(&self, pressure: f64) -> Result<f64> {
        if pressure <= 0.0 {
            let expected = "> 0: without load the theory's mean gap has no bound";
            return Err(Error::domain("force", 0.0, expected));
        }
        Ok(self.summits.elevation + self.summits.scatter * self.separation(pressure)?)
    }

    fn pressure(&self, gap: f64) -> Result<f64> {
        let Summits { elevation, scatter, .. } = self.summits;
        // The mean plane itself may come out a rounding below.
        let t = (gap - elevation) / scatter;
        if t < -8.0 * f64::EPSILON * elevation / scatter {
            let name = "mean gap over rms height (half of the summits are in contact at the smallest)".into();
            return Err(Error::OutOfRange { name, value: gap, min: elevation, max: f64::INFINITY });
        }
        Ok(self.pressure_at(t.max(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::tests::surface;
    use crate::testing::check_periodic;
    use approx::assert_relative_eq;
    use contact_model::{Boundary, Load, SelfAffine};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn scene(surface: SelfAffine) -> Scene {
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.effects.boundary = Boundary::Periodic;
        (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
        scene
    }

    /// Two waves a cos(q x) + a cos(q y): m0 = a^2, m2 = a^2 q^2/2, m4 = (3/8) a^2 q^4, alpha = 3/2.
    #[test]
    fn summits_of_a_pair_of_waves() {
        let (a, q) = (0.01, 8.0 * PI);
        let wave = |i: usize, n: usize| (8.0 * PI * (i as f64 + 0.5) / n as f64).cos();
        let map = contact_model::HeightMap::from_fn([64, 96], 1.0, |x, y| a * (wave(x, 64) + wave(y, 96)));
        let summits = Summits::of_map(&MapStatistics::new(&map.unwrap()).unwrap());
        let [m0, m2, m4] = [a * a, 0.5 * (a * q).powi(2), 0.375 * (a * q * q).powi(2)];
        assert_relative_eq!(summits.density, m4 / m2 / (6.0 * 3.0_f64.sqrt() * PI), max_relative = 1e-11);
        assert_relative_eq!(summits.radius, 0.375 * (PI / m4).sqrt(), max_relative = 1e-11);
        assert_relative_eq!(
            summits.scatter,
            ((1.0 - SUMMIT_SCATTER / 1.5) * m0).sqrt(),
            max_relative = 1e-11
        );
        assert_relative_eq!(summits.elevation, 4.0 * (m0 / (PI * 1.5)).sqrt(), max_relative = 1e-11);
    }

    /// The map of a surface with many waves everywhere has the summits of the surface, but for the lattice of
    /// waves.
    #[test]
    fn a_map_is_the_surface_that_it_was_drawn_from() {
        const LATTICE: f64 = 0.01;
        let drawn = surface(0.7, Some(8.0), 64.0);
        let map = surface_gen::self_affine_map(&drawn, 256, 3).unwrap();
        let states = [Surface::SelfAffine(drawn), Surface::Heights(map.into())].map(|surface| {
            let mut scene = Scene::new(surface, 1.0);
            scene.effects.boundary = Boundary::Periodic;
            (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
            let state =
                GreenwoodWilliamson::default().prepare(&scene, 0).unwrap().solve(Load::force(0.5)).unwrap();
            [state.area, state.stiffness, state.mean_gap].map(Option::unwrap)
        });
        for (of_surface, of_map) in states[0].into_iter().zip(states[1]) {
            assert_relative_eq!(of_surface, of_map, max_relative = LATTICE);
        }
    }

    #[test]
    fn integrals_of_the_table() {
        // data/paper/VALUES.md.
        for (t, three_halves, half) in [
            (0.0, 0.430_019_99, 0.411_089_48),
            (1.0, 0.075_668_18, 0.104_153_68),
            (2.0, 0.006_648_18, 0.012_480_04),
        ] {
            assert_relative_eq!(gaussian_integral(1.5, t).unwrap(), three_halves, epsilon = 6e-9);
            assert_relative_eq!(gaussian_integral(0.5, t).unwrap(), half, epsilon = 6e-9);
        }
        // F_1(t) = phi(t) - t Q(t); at 0 it is 1/sqrt(2 pi). F_3(0) = 2/sqrt(2 pi).
        let root = (2.0 * PI).sqrt();
        assert_relative_eq!(gaussian_integral(1.0, 0.0).unwrap(), 1.0 / root, max_relative = 1e-14);
        assert_relative_eq!(gaussian_integral(3.0, 0.0).unwrap(), 2.0 / root, max_relative = 1e-14);
        let q = 0.5 * (1.0 - libm::erf(1.0 / 2.0_f64.sqrt()));
        assert_relative_eq!(
            gaussian_integral(1.0, 1.0).unwrap(),
            (-0.5_f64).exp() / root - q,
            max_relative = 1e-13
        );
        // Far out F_j -> Gamma(j + 1) phi(t)/t^(j + 1).
        let far = gaussian_integral(1.0, 30.0).unwrap() * 900.0 * root * 450.0_f64.exp();
        assert_relative_eq!(far, 1.0, max_relative = 4e-3);
        assert!(gaussian_integral(-1.0, 0.0).is_err() && gaussian_integral(1.0, -1.0).is_err());
    }

    #[test]
    fn summits_in_the_surfaces_own_units() {
        let one = surface(0.8, Some(2.0), 64.0);
        let spectrum = Spectrum::new(&one).unwrap();
        let here = Summits::new(&spectrum);
        let mut scaled = one;
        scaled.size = 1e3.into();
        scaled.amplitude = contact_model::Amplitude::RmsHeight(10.0);
        scaled.roll_off = scaled.roll_off.map(|q| q * 1e-3);
        scaled.short_cutoff = scaled.short_cutoff.map(|q| q * 1e-3);
        let there = Summits::new(&Spectrum::new(&scaled).unwrap());
        assert_relative_eq!(there.density, here.density * 1e-6, max_relative = 1e-12);
        assert_relative_eq!(there.radius, here.radius * 1e5, max_relative = 1e-12);
        assert_relative_eq!(there.scatter, here.scatter * 10.0, max_relative = 1e-12);
        // alpha >= 3/2: the summits scatter less than the surface and lie above it.
        assert!(here.scatter > 0.63 && here.scatter < 1.0 && here.elevation > 0.0 && here.elevation < 1.85);
    }

    #[test]
    fn ends_of_the_range() {
        let scene = scene(surface(0.8, None, 100.0));
        let mut contact = GreenwoodWilliamson::default().prepare(&scene, 0).unwrap();
        let elevation = Summits::new(&Spectrum::new(&surface(0.8, None, 100.0)).unwrap()).elevation;
        let heaviest = contact.solve(Load::mean_gap(elevation)).unwrap().force;
        assert!(contact.solve(Load::force(heaviest)).is_ok());
        assert!(matches!(contact.solve(Load::force(1.01 * heaviest)), Err(Error::OutOfRange { .. })));
        assert!(matches!(contact.solve(Load::mean_gap(0.5 * elevation)), Err(Error::OutOfRange { .. })));
        assert_eq!(contact.solve(Load::force(0.0)).unwrap().mean_gap, None);
        let free = Scene::new(Surface::SelfAffine(surface(0.8, None, 100.0)), 1.0);
        assert!(matches!(GreenwoodWilliamson::default().prepare(&free, 0), Err(Error::Unsupported { .. })));
    }

    #[test]
    fn exponential_heights_give_proportional_laws() {
        let surface = surface(0.7, Some(4.0), 64.0);
        let summits = Summits::new(&Spectrum::new(&surface).unwrap());
        let model = GreenwoodWilliamson { heights: SummitHeights::Exponential };
        let mut contact = model.prepare(&scene(surface), 0).unwrap();
        for force in [1e-30, 1e-8, 1e-3] {
            let s = contact.solve(Load::force(force)).unwrap();
            assert_relative_eq!(s.stiffness.unwrap(), force / summits.scatter, max_relative = 1e-12);
            // A = F sqrt(pi R/s)/E*.
            let area = force * (PI * summits.radius / summits.scatter).sqrt();
            assert_relative_eq!(s.area.unwrap(), area, max_relative = 1e-12);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(8) })]

        #[test]
        fn curve(hurst in 0.0_f64..1.0, roll_off in 1.0_f64..10.0, range in 10.0_f64..1e3, t in 0.01_f64..8.0) {
            let surface = surface(hurst, Some(roll_off), range);
            let summits = Summits::new(&Spectrum::new(&surface).unwrap());
            for heights in [SummitHeights::Gaussian, SummitHeights::Exponential] {
                let model = GreenwoodWilliamson { heights };
                let mut contact = model.prepare(&scene(surface), 0).unwrap();
                let gap = Load::mean_gap(summits.elevation + t * summits.scatter);
                let force = contact.solve(gap).unwrap().force;
                check_periodic(&model, &scene(surface), force, 1e-10);
            }
        }
    }
}
