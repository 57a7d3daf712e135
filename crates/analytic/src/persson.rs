//! Persson: contact area, mean gap and stiffness of a random surface from its spectrum.

use crate::closed;
use crate::periodic::{self, Periodic, PeriodicLaw};
use crate::special::{exponential_integral, exponential_integral_of_square};
use crate::spectrum::Spectrum;
use contact_model::{
    Abilities, ContactModel, Error, PreparedContact, Result, Scaling, Scene, Source, Surface,
};
use libm::erf;
use numerics::gauss::Gauss;
use numerics::root;
use std::f64::consts::{FRAC_2_SQRT_PI, SQRT_2};
use surface_gen::MapStatistics;

const NAME: &str = "persson";

/// Persson's theory of a statistically homogeneous, periodic surface.
///
/// * Area: `A/A0 = erf(sqrt(2) p/(E* g))` with the rms slope g; `kappa = sqrt(8/pi)` for small p.
/// * Mean gap:
///   `u(p) = sqrt(pi) int dq q^2 C w int_p^inf dp'/p' (gamma + 3 (1 - gamma) P^2) exp(-(w p'/E*)^2)`, where
///   `P = erf(w p'/E*)` and `w(q) = (pi int_(q_0)^q q'^3 C dq')^(-1/2)` (Yang and Persson 2008, Eq. 19).
///   Stiffness per area: `-dp/du`.
/// * At small p this is `p = beta E* exp(-u/u_0)`, so the stiffness is p/u_0 ([`Persson::decay_length`]).
///
/// Takes a [`Surface::SelfAffine`] with a short cut-off or [`Surface::Heights`], and
/// [`contact_model::Boundary::Periodic`]; the seed has no influence. Moments of the spectrum are those of
/// [`crate::spectrum`]; those of a map are measured ([`surface_gen::MapStatistics`]): g is exactly its rms
/// slope, and `C q^3` is constant within each band. The mean gap has no bound as p -> 0, because a Gaussian
/// surface has no highest point. Without load it is therefore an error, and real, finite surfaces deviate
/// from the exponential law where few summits touch.
///
/// The integrals over q use the running slope `y(q) = 1/w` as their variable, in which they have no
/// singularity; their relative error is below 1e-11. A state needs about a thousand nodes, which takes tens
/// of microseconds; its mean gap takes a few hundred, and the state at a given gap a few milliseconds.
///
/// ```
/// use analytic::Persson;
/// use contact_model::{Boundary, ContactModel, Load, Scene, SelfAffine, Surface};
/// let mut surface = SelfAffine::new(2.2, 1.0, 0.01)?;
/// surface.short_cutoff = Some(100.0 * std::f64::consts::TAU);
/// let slope = analytic::spectrum::Spectrum::new(&surface)?.rms_slope()?;
/// let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
/// scene.effects.boundary = Boundary::Periodic;
/// scene.outputs.area = true;
/// let mut contact = Persson::default().prepare(&scene, 0)?;
/// // sqrt(2) p/(E* g) = 1: erf(1).
/// let state = contact.solve(Load::force(slope / 2.0_f64.sqrt()))?;
/// assert!((state.area.unwrap_or(0.0) - 0.8427007929).abs() < 1e-10);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Persson {
    /// Ratio of the elastic energy of partial contact to that of full contact of the same waves, in (0, 1];
    /// 0.42 to 0.48 in simulations.
    pub gamma: f64,
}

impl Default for Persson {
    /// gamma = 0.45.
    fn default() -> Self {
        Self { gamma: 0.45 }
    }
}

impl ContactModel for Persson {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "B. N. J. Persson, J. Chem. Phys. 115, 3840 (2001)",
                what: "contact area A(p) of a random surface",
            },
            Source {
                citation: "C. Yang, B. N. J. Persson, J. Phys.: Condens. Matter 20, 215214 (2008)",
                what: "mean gap u(p), with the factor gamma; stiffness by differentiation",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        periodic::RANDOM
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        closed::refuse_profile(scene, NAME)?;
        self.abilities().refuse(NAME, scene)?;
        let gamma = self.checked()?;
        let (law, height) = match &scene.surface {
            Surface::SelfAffine(surface) => {
                let spectrum = Spectrum::new(surface)?;
                (PressureDiffusion::new(&spectrum, gamma), spectrum.rms_height())
            }
            Surface::Heights(map) => {
                let measured = MapStatistics::new(map)?;
                (PressureDiffusion::measured(&measured, gamma), measured.rms_height)
            }
            other => return Err(Error::unsupported(NAME, other.kind())),
        };
        let strategy = "integral over the spectrum (Persson)";
        Ok(closed::prepared(Scaling::of_rough(scene, height)?, Periodic { model: NAME, law, strategy }))
    }
}

impl Persson {
    /// `u_0 = gamma sqrt(pi) int q^2 C w dq`, a length: p decays as `exp(-u/u_0)` where the contact is light.
    ///
    /// # Errors
    /// [`Error::Domain`] for a gamma outside (0, 1].
    ///
    /// ```
    /// use contact_model::SelfAffine;
    /// // H = 0.8, two decades of waves: 1.054 gamma h.
    /// let mut surface = SelfAffine::new(2.2, 1.0, 1.0)?;
    /// surface.short_cutoff = Some(100.0 * std::f64::consts::TAU);
    /// let spectrum = analytic::spectrum::Spectrum::new(&surface)?;
    /// assert!((analytic::Persson { gamma: 1.0 }.decay_length(&spectrum)? - 1.054).abs() < 5e-4);
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn decay_length(&self, spectrum: &Spectrum) -> Result<f64> {
        let gamma = self.checked()?;
        // Over all waves at p = 0, where P = 0 and the exponential is 1.
        Ok(PressureDiffusion::new(spectrum, gamma).light() * spectrum.rms_height())
    }

    fn checked(self) -> Result<f64> {
        if self.gamma > 0.0 && self.gamma <= 1.0 {
            Ok(self.gamma)
        } else {
            Err(Error::domain("gamma", self.gamma, "a number in (0, 1]"))
        }
    }
}

/// In units of h, L and E*: slopes in h/L, pressures in E* h/L.
///
/// With `y = 1/w`, `dG = 2 y dy = pi q^3 C dq`: `sqrt(pi) q^2 C w dq = (2/sqrt(pi)) dy/q`, and `w p = p/y`.
/// The integrand is smooth: geometric panels from the longest wave and from y = 0 resolve any p.
struct PressureDiffusion {
    gamma: f64,
    /// `g/sqrt(2)`.
    slope: f64,
    /// `(y, weight)` with the weight `(2/sqrt(pi)) dy/q`.
    nodes: Vec<(f64, f64)>,
    gauss: Gauss<16>,
    /// [`PressureDiffusion::tail`] at multiples of [`PANEL`].
    tails: Vec<f64>,
}

/// Beyond it `erf = 1` in f64.
const FAR: f64 = 6.0;
/// Width of the panels of `int erf^2(t) exp(-t^2)/t dt`.
const PANEL: f64 = 0.25;
/// Halvings of y below its first panel: what lies further down is less than rounding.
const HALVINGS: i32 = 52;
/// Largest pressure over `g/sqrt(2)`: beyond it `exp(-x^2)` leaves f64 and there is no gap any more.
const CLOSED: f64 = 26.0;
/// Logarithm of the pressure over `g/sqrt(2)` at which a bracket for the mean gap is given up.
const LIGHTEST: f64 = -600.0;
/// Relative error of the quadratures, from twice as many panels.
const QUADRATURE: f64 = 1e-11;

impl PressureDiffusion {
    fn new(spectrum: &Spectrum, gamma: f64) -> Self {
        let edges = spectrum.ladder().into_iter().skip(1).map(|q| spectrum.running_slope(q)).collect();
        Self::over(edges, |y| spectrum.wavenumber_at(y), gamma)
    }

    /// Of a map: y^2, half of the variance of the gradient up to q, rises linearly in q through each of its
    /// bands.
    fn measured(map: &MapStatistics, gamma: f64) -> Self {
        let (mut edges, mut limits, mut square) = (vec![0.0_f64], Vec::new(), 0.0);
        for band in &map.bands {
            square += 0.5 * band.variances[1];
            // Bands without waves have no panel.
            if square.sqrt() > edges[edges.len() - 1] {
                edges.push(square.sqrt());
                limits.push(band.limits);
            }
        }
        let wavenumber_at = |y: f64| {
            let i = edges.partition_point(|&edge| edge < y).clamp(1, limits.len());
            let ([low, high], [from, to]) = (limits[i - 1], [edges[i - 1], edges[i]]);
            low + (high - low) * ((y - from) * (y + from) / ((to - from) * (to + from))).clamp(0.0, 1.0)
        };
        Self::over(edges[1..].to_vec(), wavenumber_at, gamma)
    }

    /// Panels up to each of these rising y, with q as a function of y.
    fn over(mut edges: Vec<f64>, wavenumber_at: impl Fn(f64) -> f64, gamma: f64) -> Self {
        let gauss = Gauss::<16>::new();
        let first = edges.first().copied().unwrap_or(0.0);
        let slope = edges.last().copied().unwrap_or(0.0);
        edges.extend((1..=HALVINGS).map(|i| first * 2.0_f64.powi(-i)));
        edges.push(0.0);
        edges.sort_by(f64::total_cmp);
        let nodes = edges
            .windows(2)
            .flat_map(|w| gauss.on(w[0], w[1]))
            .map(|(y, weight)| (y, FRAC_2_SQRT_PI * weight / wavenumber_at(y)))
            .collect();
        let count = (FAR / PANEL) as usize;
        let mut tails = vec![0.5 * exponential_integral(FAR * FAR); count + 1];
        for i in (0..count).rev() {
            let low = i as f64 * PANEL;
            tails[i] = tails[i + 1] + gauss.integrate(low, low + PANEL, partial);
        }
        Self { gamma, slope, nodes, gauss, tails }
    }

    /// u_0.
    fn light(&self) -> f64 {
        self.gamma * self.nodes.iter().map(|(_, weight)| weight).sum::<f64>()
    }

    /// `-p du/dp`.
    fn decay(&self, pressure: f64) -> f64 {
        self.sum(pressure, |x| {
            let p = erf(x);
            (self.gamma + 3.0 * (1.0 - self.gamma) * p * p) * (-x * x).exp()
        })
    }

    /// `int_x^inf erf^2(t) exp(-t^2)/t dt`.
    fn tail(&self, x: f64) -> f64 {
        if x >= FAR {
            return 0.5 * exponential_integral(x * x);
        }
        let next = (x / PANEL) as usize + 1;
        self.tails[next] + self.gauss.integrate(x, next as f64 * PANEL, partial)
    }

    /// Sum over the waves of a function of `w p/E*`.
    fn sum(&self, pressure: f64, function: impl Fn(f64) -> f64) -> f64 {
        // Waves that are flattened contribute nothing that f64 holds.
        let open = self.nodes.iter().filter(|(y, _)| *y * (CLOSED + 1.0) > pressure);
        open.map(|(y, weight)| weight * function(pressure / y)).sum()
    }
}

/// `erf^2(t) exp(-t^2)/t`.
fn partial(t: f64) -> f64 {
    let p = erf(t);
    p * (p / t) * (-t * t).exp()
}

impl PeriodicLaw for PressureDiffusion {
    fn admit(&self, pressure: f64) -> Result<()> {
        if pressure <= CLOSED * self.slope {
            Ok(())
        } else {
            let name = "mean pressure over E* g/sqrt(2) (the gaps have vanished)".into();
            Err(Error::OutOfRange { name, value: pressure / self.slope, min: 0.0, max: CLOSED })
        }
    }

    fn fraction(&self, pressure: f64) -> Result<f64> {
        Ok(erf(pressure / self.slope))
    }

    fn stiffness(&self, pressure: f64) -> Result<Option<f64>> {
        Ok(Some(pressure / self.decay(pressure)))
    }

    fn gap(&self, pressure: f64) -> Result<f64> {
        if pressure <= 0.0 {
            let expected = "> 0: without load the theory's mean gap has no bound";
            return Err(Error::domain("force", 0.0, expected));
        }
        Ok(self.sum(pressure, |x| {
            0.5 * self.gamma * exponential_integral_of_square(x) + 3.0 * (1.0 - self.gamma) * self.tail(x)
        }))
    }

    fn pressure(&self, gap: f64) -> Result<f64> {
        if gap <= 0.0 {
            let expected = "a positive number: in this theory no finite pressure closes all gaps";
            return Err(Error::domain("mean gap", gap, expected));
        }
        let value = |log: f64| self.gap(log.exp() * self.slope).map_or(f64::NAN, |u| u - gap);
        let high = CLOSED.ln();
        if value(high) >= 0.0 {
            let min = self.gap(CLOSED * self.slope)?;
            let name = "mean gap over rms height".into();
            return Err(Error::OutOfRange { name, value: gap, min, max: f64::INFINITY });
        }
        let mut low = -2.0;
        while value(low) < 0.0 {
            low *= 2.0;
            if low < LIGHTEST {
                let name = "mean gap over rms height".into();
                let max = self.gap(LIGHTEST.exp() * self.slope)?;
                return Err(Error::OutOfRange { name, value: gap, min: 0.0, max });
            }
        }
        Ok(root::between(low, high, value).exp() * self.slope)
    }

    fn stiffness_error(&self) -> f64 {
        QUADRATURE
    }
}

/// `kappa = sqrt(8/pi)` of `A/A0 = kappa p/(E* g)` for small p.
pub const SMALL_AREA_FACTOR: f64 = FRAC_2_SQRT_PI * SQRT_2;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::tests::surface;
    use crate::testing::check_periodic;
    use approx::assert_relative_eq;
    use contact_model::{Boundary, Load, SelfAffine};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use std::f64::consts::{PI, TAU};

    fn scene(surface: SelfAffine) -> Scene {
        let mut scene = Scene::new(Surface::SelfAffine(surface), 1.0);
        scene.effects.boundary = Boundary::Periodic;
        (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
        scene
    }

    fn law(hurst: f64, roll_off: Option<f64>, range: f64, gamma: f64) -> PressureDiffusion {
        PressureDiffusion::new(&Spectrum::new(&surface(hurst, roll_off, range)).unwrap(), gamma)
    }

    #[test]
    fn reference_numbers() {
        // data/paper/VALUES.md: u_0/h = 1.054 gamma at H = 0.8 and two decades.
        assert_relative_eq!(law(0.8, None, 100.0, 1.0).light(), 1.054, max_relative = 5e-4);
        assert_relative_eq!(SMALL_AREA_FACTOR, (8.0 / std::f64::consts::PI).sqrt(), max_relative = 1e-15);
        let spectrum = Spectrum::new(&surface(0.8, None, 100.0)).unwrap();
        let (slope, p) = (spectrum.rms_slope().unwrap(), 1e-6);
        let state = Persson::default()
            .prepare(&scene(surface(0.8, None, 100.0)), 0)
            .unwrap()
            .solve(Load::force(p * slope))
            .unwrap();
        assert_relative_eq!(state.area.unwrap(), SMALL_AREA_FACTOR * p, max_relative = 1e-10);
    }

    #[test]
    fn the_stiffness_is_proportional_to_a_light_load() {
        for (roll_off, range) in [(None, 64.0), (Some(8.0), 128.0)] {
            let law = law(0.7, roll_off, range, 0.45);
            let p = 1e-9 * law.slope;
            assert_relative_eq!(
                law.stiffness(p).unwrap().unwrap() / p,
                law.light().recip(),
                max_relative = 1e-5
            );
            // The exponential law, one decade of load: u falls by u_0 ln 10.
            let fall = law.gap(p).unwrap() - law.gap(10.0 * p).unwrap();
            assert_relative_eq!(fall, law.light() * 10.0_f64.ln(), max_relative = 1e-5);
        }
    }

    /// A surface whose waves are many everywhere: a roll-off at an eighth of the side, waves down to 64th
    /// parts of it.
    fn many_waves() -> SelfAffine {
        let surface = surface(0.8, Some(8.0), 64.0);
        SelfAffine {
            size: [2.0, 2.0].into(),
            roll_off: Some(8.0 * PI),
            short_cutoff: Some(64.0 * PI),
            ..surface
        }
    }

    /// The map of a surface in the theory is the surface itself: what is left is the lattice of its waves,
    /// whose longest stand for a continuum that begins at them.
    #[test]
    fn a_map_is_the_surface_that_it_was_drawn_from() {
        const LATTICE: f64 = 0.04;
        let drawn = many_waves();
        let map = surface_gen::self_affine_map(&drawn, 256, 3).unwrap();
        let slope = surface_gen::rms_slope(&map).unwrap();
        let mut on_map = scene(drawn);
        on_map.surface = Surface::Heights(map.into());
        let model = Persson::default();
        let (mut one, mut other) =
            (model.prepare(&scene(drawn), 0).unwrap(), model.prepare(&on_map, 0).unwrap());
        assert_relative_eq!(other.normalisation().height.unwrap(), 1.0, max_relative = 1e-12);
        for pressure in [1e-9, 1e-4, 1e-2, 0.1, 1.0] {
            let load = Load::force(4.0 * pressure * slope);
            let (of_surface, of_map) = (one.solve(load).unwrap(), other.solve(load).unwrap());
            let values =
                |s: &contact_model::ContactState| [s.area, s.stiffness, s.mean_gap].map(Option::unwrap);
            for (a, b) in values(&of_surface).into_iter().zip(values(&of_map)) {
                assert_relative_eq!(a, b, max_relative = LATTICE);
            }
            // The area is that of the map's own rms slope, exactly.
            let exact = 4.0 * erf(SQRT_2 * pressure);
            assert_relative_eq!(of_map.area.unwrap(), exact, max_relative = 1e-11);
        }
        // A load and its mean gap belong together.
        let state = other.solve(Load::force(0.01 * slope)).unwrap();
        let back = other.solve(Load::mean_gap(state.mean_gap.unwrap())).unwrap();
        assert_relative_eq!(back.force, state.force, max_relative = 1e-9);
    }

    /// Bands without waves between others, and a single one: finite numbers, the gap by hand.
    #[test]
    fn spectra_with_holes() {
        let wave = |k: f64, i: usize| (TAU * k * (i as f64 + 0.5) / 64.0).cos();
        for (low, high) in [(3.0, 20.0), (5.0, 5.0)] {
            let map = contact_model::HeightMap::from_fn(64, 1.0, |x, y| {
                0.5 * (wave(low, x) + wave(low, y)) + 0.01 * (wave(high, x) + wave(high, y))
            });
            let mut on_map = scene(many_waves());
            on_map.surface = Surface::Heights(map.unwrap().into());
            let mut contact = Persson { gamma: 1.0 }.prepare(&on_map, 0).unwrap();
            let normal = contact.normalisation();
            for pressure in [1e-8, 1e-3, 1.0, 10.0] {
                let state = contact.solve(Load::force(pressure)).unwrap();
                let [area, k, gap] = [state.area, state.stiffness, state.mean_gap].map(Option::unwrap);
                assert!(area > 0.0 && area <= 1.0 && k > 0.0 && gap.is_finite() && gap >= 0.0);
            }
            if low.total_cmp(&high).is_eq() {
                // u_0 = gamma (2/sqrt(pi)) y/q for one wavenumber, and its ring from 4.5 to 5.5 of the
                // longest.
                let light = contact.solve(Load::force(1e-9)).unwrap();
                let (u_0, q) = (1e-9 / light.stiffness.unwrap(), TAU * low);
                let y = 0.51 * q / SQRT_2;
                assert_relative_eq!(u_0, FRAC_2_SQRT_PI * y / q, max_relative = 0.04);
                assert_relative_eq!(normal.height.unwrap(), 0.51, max_relative = 1e-12);
            }
        }
    }

    #[test]
    fn maps_without_statistics_are_refused() {
        let refused = |map: contact_model::Result<contact_model::HeightMap>| {
            let mut on_map = scene(many_waves());
            on_map.surface = Surface::Heights(map.unwrap().into());
            Persson::default().prepare(&on_map, 0).map(|_| ()).unwrap_err().to_string()
        };
        let height = |x: usize, y: usize| ((x * 37 + y * 101) % 17) as f64;
        let flat = refused(contact_model::HeightMap::from_fn(8, 1.0, |_, _| 1.0));
        assert!(flat.starts_with("rms height of the map = 0"), "{flat}");
        let tilted =
            refused(contact_model::HeightMap::from_fn(32, 1.0, |x, y| height(x, y) + 9.0 * x as f64));
        assert!(tilted.contains("`detrend = \"plane\"`"), "{tilted}");
        let holes = (0..64).map(|i| if i == 3 { f64::NAN } else { height(i, i / 8) }).collect();
        let holes = refused(contact_model::HeightMap::with_undefined(8, 1.0, holes));
        assert!(holes.starts_with("undefined points = 1"), "{holes}");
    }

    /// A reference implementation: rectangles in ln q over a regularised integrand, and trapezoids in ln p.
    #[test]
    fn direct_integration() {
        let (hurst, gamma) = (0.6, 0.45);
        let law = law(hurst, None, 16.0, gamma);
        let spectrum = Spectrum::new(&surface(hurst, None, 16.0)).unwrap();
        let (low, high) = (std::f64::consts::TAU, 16.0 * std::f64::consts::TAU);
        let pressure = 0.3 * law.slope;
        // q = low + (high - low) s^2 takes the root at the longest wave away.
        let direct = |steps: i32| -> f64 {
            (0..steps)
                .map(|i| {
                    let s = (f64::from(i) + 0.5) / f64::from(steps);
                    let q = low + (high - low) * s * s;
                    let dq = 2.0 * (high - low) * s / f64::from(steps);
                    let w = spectrum.running_slope(q).recip();
                    // C = plateau (q/q_0)^-2 (H + 1), with variance 1 on the band.
                    let plateau =
                        hurst / std::f64::consts::PI / (low * low * (1.0 - 16.0_f64.powf(-2.0 * hurst)));
                    let c = plateau * (q / low).powf(-2.0 * hurst - 2.0);
                    let x = w * pressure;
                    let p = erf(x);
                    std::f64::consts::PI.sqrt()
                        * q
                        * q
                        * c
                        * w
                        * dq
                        * (gamma + 3.0 * (1.0 - gamma) * p * p)
                        * (-x * x).exp()
                })
                .sum()
        };
        // Midpoints: second order.
        let (coarse, fine) = (direct(1000) - law.decay(pressure), direct(4000) - law.decay(pressure));
        assert_relative_eq!(coarse / fine, 16.0, max_relative = 0.05);
        assert!(fine.abs() < 1e-6 * law.decay(pressure));
    }

    #[test]
    fn the_energy_of_full_contact_does_not_depend_on_gamma() {
        // int u dp from 0 to inf is the elastic energy per area of the flattened surface, (1/4) E* 2 pi int
        // q^2 C dq.
        let energy = |gamma: f64| {
            let law = law(0.8, None, 32.0, gamma);
            // int u dp = int (-p du/dp) dp.
            let gauss = Gauss::<16>::new();
            (0..120)
                .map(|i| {
                    let (low, high) = (f64::from(i) * 0.1, f64::from(i + 1) * 0.1);
                    gauss.integrate(low, high, |x| law.decay(x * law.slope) * law.slope)
                })
                .sum::<f64>()
        };
        let spectrum = Spectrum::new(&surface(0.8, None, 32.0)).unwrap();
        let gauss = Gauss::<16>::new();
        let tau = std::f64::consts::TAU;
        let plateau = 0.8 / std::f64::consts::PI / (tau * tau * (1.0 - 32.0_f64.powf(-1.6)));
        let full: f64 = spectrum
            .ladder()
            .windows(2)
            .map(|w| gauss.integrate(w[0], w[1], |q| tau * q * q * plateau * (q / tau).powf(-3.6)))
            .sum::<f64>()
            / 4.0;
        for gamma in [0.45, 1.0] {
            assert_relative_eq!(energy(gamma), full, max_relative = 1e-8);
        }
    }

    #[test]
    fn ends_of_the_range() {
        let mut contact = Persson::default().prepare(&scene(surface(0.8, None, 100.0)), 0).unwrap();
        assert_eq!(contact.solve(Load::force(0.0)).unwrap().mean_gap, None);
        let slope = Spectrum::new(&surface(0.8, None, 100.0)).unwrap().rms_slope().unwrap();
        assert!(contact.solve(Load::force(15.0 * slope)).is_ok());
        assert!(matches!(contact.solve(Load::force(50.0 * slope)), Err(Error::OutOfRange { .. })));
        assert!(matches!(contact.solve(Load::mean_gap(0.0)), Err(Error::Domain { .. })));
        assert!(matches!(contact.solve(Load::mean_gap(1e4)), Err(Error::OutOfRange { .. })));
        for gamma in [0.0, 1.1, f64::NAN] {
            assert!(Persson { gamma }.prepare(&scene(surface(0.8, None, 100.0)), 0).is_err());
        }
        let mut without = surface(0.8, None, 100.0);
        without.short_cutoff = None;
        assert!(matches!(Persson::default().prepare(&scene(without), 0), Err(Error::Domain { .. })));
        let free = Scene::new(Surface::SelfAffine(surface(0.8, None, 100.0)), 1.0);
        assert!(matches!(Persson::default().prepare(&free, 0), Err(Error::Unsupported { .. })));
    }

    #[test]
    fn more_panels_change_nothing() {
        // Halve every panel of the slopes.
        let spectrum = Spectrum::new(&surface(1.0, Some(2.0), 1e4)).unwrap();
        let mut fine = PressureDiffusion::new(&spectrum, 0.45);
        let coarse = PressureDiffusion::new(&spectrum, 0.45);
        let mut edges: Vec<f64> =
            spectrum.ladder().into_iter().skip(1).map(|q| spectrum.running_slope(q)).collect();
        let first = edges[0];
        edges.extend((1..=HALVINGS).map(|i| first * 2.0_f64.powi(-i)));
        edges.push(0.0);
        edges.sort_by(f64::total_cmp);
        let gauss = Gauss::<16>::new();
        fine.nodes = edges
            .windows(2)
            .flat_map(|w| {
                let middle = 0.5 * (w[0] + w[1]);
                gauss.on(w[0], middle).chain(gauss.on(middle, w[1])).collect::<Vec<_>>()
            })
            .map(|(y, weight)| (y, FRAC_2_SQRT_PI * weight / spectrum.wavenumber_at(y)))
            .collect();
        for x in [1e-12, 1e-6, 1e-3, 0.1, 1.0, 3.0, 10.0] {
            let p = x * coarse.slope;
            assert_relative_eq!(coarse.decay(p), fine.decay(p), max_relative = QUADRATURE);
            assert_relative_eq!(coarse.gap(p).unwrap(), fine.gap(p).unwrap(), max_relative = QUADRATURE);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(8) })]

        #[test]
        fn curve(hurst in 0.0_f64..1.0, roll_off in 1.0_f64..10.0, range in 10.0_f64..1e3, x in -12.0_f64..1.0) {
            let surface = surface(hurst, Some(roll_off), range);
            let slope = Spectrum::new(&surface).unwrap().rms_slope().unwrap();
            check_periodic(&Persson::default(), &scene(surface), x.exp() * slope, 1e-9);
        }
    }
}
