//! Johnson: a sinusoidal wave with short-range adhesion, periodic.

mod strips;

use crate::closed::{self, LoadLaw};
use crate::periodic;
use crate::westergaard::whole_waves;
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Error, LoadKind, Nondimensionalisation, NormalLoad,
    PreparedContact, Result, ScaledState, Scaling, Scene, SolveReport, Source,
};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};
use strips::{Strips, between, limits};

const NAME: &str = "adhesive_wave";

/// The periodic contact of a wave `h = D cos(2 pi x/w)` with a flat under short-range adhesion
/// ([`contact_model::Adhesion::ShortRange`]), through the half-width a of a contact strip.
///
/// Westergaard's strips carry the mean pressure `p* sin^2 psi`, `psi = pi a/w`, `p* = pi E* D/w`. A uniform
/// mean tension s on bonded strips adds the traction `s cos(pi x/w)/sqrt(sin^2 psi - sin^2(pi x/w))`, whose
/// stress intensity is `K = s sqrt(w cot psi)`. With `K^2/(2 E*)` = the work of adhesion:
///
/// `p/p* = sin^2 psi - alpha sqrt(tan psi)`, `alpha^2 = 2 work E*/(w p*^2)`,
///
/// and a mean gap of `D (1 - r + r ln r) - D alpha sqrt(tan psi) ln r`, `r = sin^2 psi`.
///
/// The contact is stable where p rises with a: from the minimum, where the strips pull off, to the maximum,
/// where they snap into full contact; both limits belong to the stable branch. From the alpha of
/// [`WavyContact::CRITICAL`] on there is neither, and surfaces that touch close at once. Full contact remains
/// under any tension in this limit, because there is no edge from which it could open.
///
/// `psi` is a number in [0, pi/2]. An `f64` near pi/2 has few digits of `pi/2 - psi`: values at a given psi
/// are exact to rounding, but a psi that is returned there is rounded. [`AdhesiveWave`] works with tan psi
/// instead.
///
/// ```
/// use analytic::adhesive_wave::WavyContact;
/// let wave = WavyContact::new(0.01, 1.0, 1.0, 1e-5)?;
/// let (psi, pull_off) = wave.pull_off()?.unwrap();
/// assert!(pull_off < 0.0 && wave.pressure(psi + 0.01)? > pull_off && wave.pressure(psi - 0.01)? > pull_off);
/// assert!(wave.snap_in()?.unwrap().1 > 0.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavyContact {
    /// Moduli in E*, horizontal lengths in w, vertical ones in D: p* is pi.
    nondimensional: Nondimensionalisation,
    /// The same with heights in the caller's unit: pressures of it are stiffnesses per area.
    per_height: Nondimensionalisation,
    alpha: f64,
    /// Where p has its minimum and its maximum; `None` without adhesion and from the critical alpha on.
    limits: Option<[Strips; 2]>,
}

/// State under a mean pressure of surfaces that are in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
enum WaveState {
    /// The mean pressure is below the pull-off.
    PulledOff,
    Partial(Strips),
    Full,
}

impl WavyContact {
    /// Smallest alpha without a stable partial contact: twice the largest `2 sin^(3/2) psi cos^(5/2) psi`.
    pub const CRITICAL: f64 = strips::CRITICAL;

    /// Amplitude D > 0 and wavelength w > 0 (lengths), E* > 0 (a pressure), work of adhesion >= 0 (energy per
    /// area).
    ///
    /// # Errors
    /// [`Error::Domain`] for a value that makes no sense, and for a D/w, a p* or a work over `E* D^2/w` that
    /// no `f64` holds.
    pub fn new(amplitude: f64, wavelength: f64, contact_modulus: f64, work: f64) -> Result<Self> {
        let slope = amplitude / wavelength;
        for (name, value) in [
            ("amplitude", amplitude),
            ("wavelength", wavelength),
            ("contact_modulus", contact_modulus),
            ("amplitude over wavelength", slope),
        ] {
            if !(value.is_finite() && value > 0.0 && value.recip().is_finite()) {
                return Err(Error::domain(name, value, "a finite number > 0 with a finite reciprocal"));
            }
        }
        if !(work.is_finite() && work >= 0.0) {
            return Err(Error::domain("work of adhesion", work, "a finite number >= 0"));
        }
        let nondimensional = Nondimensionalisation::new(contact_modulus, wavelength, amplitude)?;
        nondimensional.pressure(PI)?;
        let per_height = Nondimensionalisation::new(contact_modulus, wavelength, 1.0)?;
        // Balanced products, so that no part of them leaves the range of f64: E* D^2/w = E* D (D/w).
        let share = Nondimensionalisation::new(contact_modulus, amplitude, slope)?.force_in(work);
        if !(share.is_normal() || work <= 0.0) {
            return Err(Error::not_representable("work of adhesion over E* D^2/w", share));
        }
        let alpha = (2.0 * share).sqrt() / PI;
        Ok(Self { nondimensional, per_height, alpha, limits: limits(alpha) })
    }

    /// Johnson's parameter `alpha`, a dimensionless measure of adhesion.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Mean pressure at `psi = pi a/w` in [0, pi/2].
    ///
    /// # Errors
    /// [`Error::Domain`] for another psi, or a pressure that no `f64` holds.
    pub fn pressure(&self, psi: f64) -> Result<f64> {
        self.pressure_of(strips_at(psi)?)
    }

    /// Mean gap, a length, at `psi` in [0, pi/2]: D without contact, and larger where strips are pulled.
    ///
    /// # Errors
    /// [`Error::Domain`] for another psi, or a gap that no `f64` holds.
    pub fn mean_gap(&self, psi: f64) -> Result<f64> {
        gap_in(self.nondimensional, strips_at(psi)?.gap(self.alpha))
    }

    /// `-dp/d(mean gap)` of the bonded strips at fixed width (a pressure over a length), at `psi` in [0,
    /// pi/2]: 0 without contact.
    ///
    /// # Errors
    /// [`Error::Domain`] for another psi, or a stiffness that no `f64` holds.
    pub fn stiffness_fixed_area(&self, psi: f64) -> Result<f64> {
        // p* over D is pi E*/w.
        self.stiffness_in(PI / strips_at(psi)?.less_log())
    }

    /// `-dp/d(mean gap)` along the equilibrium curve, on which the strips grow with the pressure (a pressure
    /// over a length), at `psi` in [0, pi/2]: 0 at the pull-off and at the snap-in. Without adhesion it
    /// equals [`WavyContact::stiffness_fixed_area`].
    ///
    /// With `L = -ln r` and `q = d(p/p*)/d tan psi` it is `p*/D` times
    /// `q/(q L + 2 alpha cos^2 psi/sqrt(tan psi))`.
    ///
    /// # Errors
    /// [`Error::Domain`] for another psi, or a slope that no `f64` holds: the unstable part has a psi at which
    /// the mean gap turns.
    pub fn slope(&self, psi: f64) -> Result<f64> {
        self.stiffness_in(PI * strips_at(psi)?.slope(self.alpha))
    }

    fn stiffness_in(&self, value: f64) -> Result<f64> {
        self.per_height.pressure(value).map_err(|_| {
            let name = "stiffness per area in units of E* over the wavelength";
            Error::not_representable(name, value)
        })
    }

    /// `(psi, p)` where the mean pressure p has its minimum: the pull-off under a prescribed force. `None`
    /// without adhesion and from the critical alpha on.
    ///
    /// # Errors
    /// [`Error::Domain`] for a pressure that no `f64` holds.
    pub fn pull_off(&self) -> Result<Option<(f64, f64)>> {
        self.limits.map(|[first, _]| self.limit(first)).transpose()
    }

    /// `(psi, p)` where the mean pressure p has its maximum: beyond it the surfaces snap into full contact.
    /// `None` without adhesion and from the critical alpha on.
    ///
    /// # Errors
    /// As [`WavyContact::pull_off`].
    pub fn snap_in(&self) -> Result<Option<(f64, f64)>> {
        self.limits.map(|[_, last]| self.limit(last)).transpose()
    }

    /// `psi` of the stable partial contact under a mean pressure; `None` where the contact is full.
    ///
    /// At the pull-off and at the snap-in, each within rounding, it is the psi of that limit.
    ///
    /// # Errors
    /// [`Error::Domain`] for a pressure that is not finite, [`Error::OutOfRange`] below the pull-off.
    pub fn stable(&self, pressure: f64) -> Result<Option<f64>> {
        if !pressure.is_finite() {
            return Err(Error::domain("mean pressure", pressure, "a finite number"));
        }
        match self.branch(self.nondimensional.pressure_in(pressure) / PI) {
            WaveState::PulledOff => Err(Error::OutOfRange {
                name: "mean pressure (the contact pulls off under a prescribed force)".into(),
                value: pressure,
                min: self.pull_off()?.map_or(0.0, |limit| limit.1),
                max: f64::INFINITY,
            }),
            WaveState::Partial(strips) => Ok(Some(strips.tangent.atan())),
            WaveState::Full => Ok(None),
        }
    }

    fn pressure_of(&self, strips: Strips) -> Result<f64> {
        self.nondimensional.pressure(PI * strips.pressure(self.alpha))
    }

    fn limit(&self, strips: Strips) -> Result<(f64, f64)> {
        Ok((strips.tangent.atan(), self.pressure_of(strips)?))
    }

    /// The contact under a mean pressure over p*, which may be infinite.
    fn branch(&self, ratio: f64) -> WaveState {
        let alpha = self.alpha;
        let Some([first, last]) = self.limits else {
            return match ratio {
                _ if alpha > 0.0 => WaveState::Full,
                _ if ratio < 0.0 => WaveState::PulledOff,
                _ if ratio * closed::ROUNDED_UP >= 1.0 => WaveState::Full,
                _ => WaveState::Partial(Strips { tangent: (ratio / (1.0 - ratio)).sqrt() }),
            };
        };
        let [least, largest] = [first, last].map(|strips| strips.pressure(alpha));
        let rounding = closed::ROUNDED_UP - 1.0;
        if ratio < least - rounding * least.abs() {
            WaveState::PulledOff
        } else if ratio > largest + rounding * largest.abs() {
            WaveState::Full
        } else if ratio <= least {
            WaveState::Partial(first)
        } else if ratio >= largest {
            WaveState::Partial(last)
        } else {
            WaveState::Partial(between(first, last, alpha, ratio))
        }
    }
}

/// The strips at an angle.
fn strips_at(psi: f64) -> Result<Strips> {
    if (0.0..=FRAC_PI_2).contains(&psi) {
        Ok(Strips { tangent: psi.tan() })
    } else {
        Err(Error::domain("psi", psi, "a number in [0, pi/2]"))
    }
}

/// Mean gap in the units of heights.
fn gap_in(nondimensional: Nondimensionalisation, gap: f64) -> Result<f64> {
    nondimensional.approach(gap).map_err(|_| Error::not_representable("mean gap over the amplitude", gap))
}

/// The wave of [`WavyContact`] behind the common trait: forces, of either sign down to the pull-off.
///
/// It takes [`contact_model::Surface::Sine`] with [`contact_model::Boundary::Periodic`] and a whole number of
/// waves along x. Without adhesion it is [`crate::Westergaard`]. A force at the pull-off or at the snap-in,
/// each within rounding, gives the contact at that limit. A force beyond the pull-off is
/// [`Error::OutOfRange`]. A mean gap cannot be prescribed: above D it belongs to a pulled contact and to
/// separated surfaces alike.
///
/// The stiffness is the slope of the equilibrium curve ([`WavyContact::slope`]), 0 at both limits. The
/// stiffness at fixed contact area, from which the conductance follows, is that of the bonded strips
/// ([`WavyContact::stiffness_fixed_area`]). A full contact has neither, because its mean gap stays 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct AdhesiveWave;

impl ContactModel for AdhesiveWave {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source {
            citation: "K. L. Johnson, Int. J. Solids Struct. 32, 423 (1995)",
            what: "sinusoidal wave with short-range adhesion: pressure of a; mean gap by superposition",
        }]
    }

    fn abilities(&self) -> Abilities {
        Abilities { loads: &[LoadKind::Force], effects: &[Effect::ShortRangeAdhesion], ..periodic::WAVE }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let work = closed::short_range_work(scene, NAME)?;
        let (amplitude, waves, size) = whole_waves(scene, NAME)?;
        let wave = WavyContact::new(amplitude, size.x / waves, scene.contact_modulus, work)?;
        let full = PI * waves * (size.length() / size.x);
        if !full.is_normal() {
            let name = "number of waves times the root of side along y over side along x";
            return Err(Error::not_representable(name, full / PI));
        }
        let scaling = Scaling::new(scene, amplitude, Some(amplitude / SQRT_2))?;
        Ok(closed::prepared(scaling, WaveLaw { wave, full }))
    }
}

/// The wave on its rectangle.
struct WaveLaw {
    wave: WavyContact,
    /// p* in `E* D/L`.
    full: f64,
}

impl WaveLaw {
    /// The error for a force below the pull-off.
    fn pulled_off(&self, force: f64, nondimensional: Nondimensionalisation) -> Error {
        let least = self.wave.limits.map_or(0.0, |[first, _]| first.pressure(self.wave.alpha));
        let smallest = nondimensional.force(least * self.full);
        smallest.map_or_else(|error| error, |smallest| NormalLoad::Force(force).pull_off(smallest))
    }
}

impl LoadLaw for WaveLaw {
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState> {
        let force = match load.validated_with_adhesion()? {
            NormalLoad::Force(force) => force,
            other => return Err(Error::unsupported(NAME, format!("{other}: it takes a force"))),
        };
        let Scaling { nondimensional, outputs, .. } = *scaling;
        // Mean pressure over p*; infinite where no `f64` holds it.
        let ratio = nondimensional.force_in(force) / self.full;
        if self.wave.alpha <= 0.0 && ratio <= 0.0 && force > 0.0 {
            return Err(Error::not_representable("force over E* D L", ratio));
        }
        let strips = match self.wave.branch(ratio) {
            WaveState::PulledOff => return Err(self.pulled_off(force, nondimensional)),
            WaveState::Partial(strips) => Some(strips),
            WaveState::Full => None,
        };
        let alpha = self.wave.alpha;
        let gap = strips.map_or(0.0, |strips| strips.gap(alpha));
        let gap = outputs.mean_gap.then(|| gap_in(nondimensional, gap)).transpose()?;
        let scaled = ScaledState {
            force: ratio * self.full,
            // At a limit the slope is 0 within rounding.
            stiffness: strips.map(|strips| self.full * strips.slope(alpha).max(0.0)),
            stiffness_fixed_area: strips.map(|strips| self.full / strips.less_log()),
            area: Some(strips.map_or(1.0, Strips::fraction)),
            ..ScaledState::default()
        };
        let state = scaling.state(scaled, load, SolveReport::formula("closed form (Johnson)", load))?;
        Ok(state.with_mean_gap(gap))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Westergaard;
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::{Adhesion, Boundary, Conductance, Load, Size, Surface};

    /// Step of differences.
    const STEP: f64 = 1e-5;
    /// Square of that step, times derivatives of up to a hundred.
    const DIFFERENCES: f64 = 1e-8;
    /// A root and a handful of products.
    const ROUNDING: f64 = 1e-13;
    /// Rounding of a force over its distance from full contact, at most a fiftieth of p*, or from a limit.
    const CONDITIONED: f64 = 1e-12;
    /// Far more than the rounding at which a load still counts as that of a limit.
    const BEYOND: f64 = 1e-9;
    /// Half the digits: what is left of psi at an extremum of the pressure.
    const AT_EXTREMUM: f64 = 1e-6;

    fn scene(work: f64) -> Scene {
        wave_scene(0.01, 0.5, [1.0, 2.0].into(), (3.0, work))
    }

    fn wave_scene(amplitude: f64, wavelength: f64, size: Size, (contact_modulus, work): (f64, f64)) -> Scene {
        let mut scene = Scene::new(Surface::Sine { amplitude, wavelength, size }, contact_modulus);
        scene.effects.boundary = Boundary::Periodic;
        scene.effects.adhesion = Adhesion::ShortRange { work };
        (scene.outputs.area, scene.outputs.mean_gap, scene.outputs.stiffness_fixed_area) = (true, true, true);
        scene
    }

    /// D = w = E* = 1 and the work of this alpha: p* is pi.
    fn with_alpha(alpha: f64) -> WavyContact {
        WavyContact::new(1.0, 1.0, 1.0, 0.5 * (PI * alpha).powi(2)).unwrap()
    }

    #[test]
    fn without_work_it_is_westergaard() {
        let mut elastic = scene(0.0);
        elastic.effects.adhesion = Adhesion::Off;
        let mut expected = Westergaard.prepare(&elastic, 0).unwrap();
        let mut found = AdhesiveWave.prepare(&scene(0.0), 0).unwrap();
        let full = 2.0 * PI * 3.0 * 0.02;
        for share in [1e-300, 1e-6, 0.1, 0.5, 0.99] {
            let load = Load::force(share * full);
            let (a, b) = (found.solve(load).unwrap(), expected.solve(load).unwrap());
            assert_relative_eq!(
                a.stiffness.unwrap(),
                a.stiffness_fixed_area.unwrap(),
                max_relative = ROUNDING
            );
            for (a, b) in [(a.area, b.area), (a.mean_gap, b.mean_gap), (a.stiffness, b.stiffness)] {
                assert_relative_eq!(a.unwrap(), b.unwrap(), max_relative = ROUNDING, epsilon = 0.0);
            }
        }
        let apart = found.solve(Load::force(0.0)).unwrap();
        assert_eq!((apart.area, apart.mean_gap, apart.stiffness), (Some(0.0), Some(0.01), Some(0.0)));
        // p* itself is full contact, whose gap stays 0.
        for contact in [&mut found, &mut expected] {
            let state = contact.solve(Load::force(full)).unwrap();
            assert_relative_eq!(state.area.unwrap(), 2.0, max_relative = ROUNDING);
            assert_eq!(state.mean_gap, Some(0.0));
            assert_eq!((state.stiffness, state.stiffness_fixed_area), (None, None));
        }
        // Nothing holds the surfaces.
        let error = found.solve(Load::force(-1e-300)).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { min: 0.0, .. }), "{error}");
    }

    /// The stress intensity of the bonded strips and their compliance release the same energy.
    #[test]
    fn the_compliance_releases_the_work() {
        let wave = WavyContact::new(0.02, 0.7, 2.0, 3e-4).unwrap();
        for psi in [0.2_f64, 0.7, 1.3] {
            let tension = PI * 2.0 * 0.02 / 0.7 * wave.alpha() * psi.tan().sqrt();
            let compliance = |psi: f64| 1.0 / wave.stiffness_fixed_area(psi).unwrap();
            let by_psi = (compliance(psi + STEP) - compliance(psi - STEP)) / (2.0 * STEP);
            // Energy per nominal area, over the change of the area fraction 2 psi/pi.
            assert_relative_eq!(
                -0.5 * tension * tension * by_psi * FRAC_PI_2,
                3e-4,
                max_relative = DIFFERENCES
            );
        }
    }

    /// At fixed psi the bonded contact is linear with its stiffness, so that p and the gap follow from the
    /// same strips.
    #[test]
    fn pressure_and_gap_belong_to_one_energy() {
        let wave = WavyContact::new(0.02, 0.7, 2.0, 3e-4).unwrap();
        let elastic = WavyContact::new(0.02, 0.7, 2.0, 0.0).unwrap();
        for psi in [0.3, 0.9, 1.4] {
            let pressure = wave.pressure(psi).unwrap() - elastic.pressure(psi).unwrap();
            let gap = wave.mean_gap(psi).unwrap() - elastic.mean_gap(psi).unwrap();
            assert_relative_eq!(
                -pressure / gap,
                wave.stiffness_fixed_area(psi).unwrap(),
                max_relative = ROUNDING
            );
        }
    }

    #[test]
    fn johnsons_numbers() {
        /// Ten times the square of the pi a/w of a strip, 1e-3.
        const NARROW: f64 = 1e-4;
        // Zero mean pressure closes the surfaces from alpha = 0.57 on.
        let snap_in = |alpha: f64| with_alpha(alpha).snap_in().unwrap().unwrap().1;
        assert!(snap_in(0.56) > 0.0 && snap_in(0.58) < 0.0);
        assert_relative_eq!(with_alpha(0.3).alpha(), 0.3, max_relative = ROUNDING);
        assert!(with_alpha(WavyContact::CRITICAL * (1.0 - AT_EXTREMUM)).pull_off().unwrap().is_some());
        assert!(with_alpha(WavyContact::CRITICAL * (1.0 + AT_EXTREMUM)).pull_off().unwrap().is_none());
        assert_eq!(with_alpha(2.0).stable(0.0), Ok(None));
        // Narrow strips are cylinders of radius w^2/(4 pi^2 D): p w = pi E* a^2/(4 R) - sqrt(2 pi a E* work).
        let (amplitude, wavelength, contact_modulus, work) = (1e-3, 1.0, 2.0, 1e-12);
        let narrow = WavyContact::new(amplitude, wavelength, contact_modulus, work).unwrap();
        let a = 1e-3;
        let radius = wavelength * wavelength / (4.0 * PI * PI * amplitude);
        let line =
            PI * contact_modulus * a * a / (4.0 * radius) - (2.0 * PI * a * contact_modulus * work).sqrt();
        assert_relative_eq!(
            narrow.pressure(PI * a / wavelength).unwrap() * wavelength,
            line,
            max_relative = NARROW
        );
    }

    /// `(work, force, [area, mean gap, stiffness])` of the scene above in 60-digit arithmetic.
    const STATES: [(f64, f64, [f64; 3]); 7] = [
        (1e-4, -0.018, [0.213_616_796_913_213_2, 0.011_430_312_680_253_597, 10.531_467_840_359_56]),
        (1e-4, 0.0, [0.427_509_719_016_673_95, 0.008_914_351_035_199_496, 16.978_467_964_163_21]),
        (1e-4, 0.2, [1.385_006_507_387_766_3, 0.000_868_085_767_159_878_2, 155.151_462_787_479_9]),
        (1e-6, -1e-4, [0.085_475_106_933_934_8, 0.009_969_334_354_250_855, 6.976_547_638_641_496]),
        (1e-6, 0.3, [1.446_701_269_826_199_3, 0.000_219_920_653_759_357_5, 193.226_343_161_815_3]),
        (1e-8, 0.35, [1.663_942_636_582_675, 2.619_747_415_918_501e-5, 534.830_977_925_329_3]),
        (1e-12, 0.37, [1.826_306_257_122_849, 1.730_211_869_638_499_6e-6, 2_019.441_835_514_922]),
    ];

    #[test]
    fn states_are_those_of_long_arithmetic() {
        for (work, force, [area, gap, stiffness]) in STATES {
            let state = AdhesiveWave.prepare(&scene(work), 0).unwrap().solve(Load::force(force)).unwrap();
            assert_relative_eq!(state.area.unwrap(), area, max_relative = CONDITIONED);
            assert_relative_eq!(state.mean_gap.unwrap(), gap, max_relative = CONDITIONED);
            assert_relative_eq!(state.stiffness_fixed_area.unwrap(), stiffness, max_relative = CONDITIONED);
        }
    }

    #[test]
    fn states_at_the_snap_in_keep_their_digits() {
        // Mean gap over D and stiffness times w/E* at the snap-in of alpha = 1e-6, in 60-digit arithmetic.
        let (gap, stiffness) = (1.230_037_430_271_653_4e-10, 600_890.541_755_351_2);
        let work = 0.5 * (PI * 1e-6_f64).powi(2);
        let mut contact = AdhesiveWave.prepare(&wave_scene(1.0, 1.0, 1.0.into(), (1.0, work)), 0).unwrap();
        let snap_in = with_alpha(1e-6).snap_in().unwrap().unwrap().1;
        let state = contact.solve(Load::force(snap_in)).unwrap();
        assert_relative_eq!(state.mean_gap.unwrap(), gap, max_relative = ROUNDING, epsilon = 0.0);
        let held = state.stiffness_fixed_area.unwrap();
        assert_relative_eq!(held, stiffness, max_relative = ROUNDING, epsilon = 0.0);
    }

    #[test]
    fn the_stable_branch_between_its_limits() {
        let wave = WavyContact::new(0.01, 0.5, 3.0, 1e-4).unwrap();
        let [first, last] = [wave.pull_off(), wave.snap_in()].map(|limit| limit.unwrap().unwrap());
        for share in [0.0, 0.3, 0.9, 1.0] {
            let pressure = first.1 + share * (last.1 - first.1);
            let psi = wave.stable(pressure).unwrap().unwrap();
            assert!((first.0..=last.0).contains(&psi));
            assert_abs_diff_eq!(wave.pressure(psi).unwrap(), pressure, epsilon = ROUNDING * last.1);
        }
        assert_eq!(wave.stable(1.01 * last.1), Ok(None));
        assert!(matches!(wave.stable(1.01 * first.1), Err(Error::OutOfRange { min, .. })
            if min.to_bits() == first.1.to_bits()));
        let mut contact = AdhesiveWave.prepare(&scene(1e-4), 0).unwrap();
        let pulled = contact.solve(Load::force(0.9 * 2.0 * first.1)).unwrap();
        assert!(pulled.area.unwrap() > 0.0 && pulled.stiffness.unwrap() > 0.0);
        assert!(contact.solve(Load::mean_gap(0.005)).is_err());
    }

    /// Waves of all kinds of roundings, of alpha from 0.02 to 0.7.
    fn waves() -> impl Iterator<Item = (WavyContact, Size, Scene)> {
        (0..200).map(|i| {
            let i = f64::from(i);
            let (amplitude, wavelength, contact_modulus) =
                (0.011 + 1e-4 * i, 0.31 + 0.0013 * i, 1.7 + 0.03 * i);
            let size = Size { x: 3.0 * wavelength, y: 0.73 + 0.01 * i };
            let work = 1e-6 * (1.0 + 0.2 * i * i);
            let wave = WavyContact::new(amplitude, wavelength, contact_modulus, work).unwrap();
            (wave, size, wave_scene(amplitude, wavelength, size, (contact_modulus, work)))
        })
    }

    /// The number itself, its neighbours, and itself after a multiplication and a division that are rounded.
    fn around(limit: f64) -> [f64; 4] {
        [limit, limit.next_down(), limit.next_up(), limit / 3.0 * 3.0]
    }

    #[test]
    fn a_load_at_a_limit_is_the_state_there() {
        for (wave, size, scene) in waves() {
            let mut contact = AdhesiveWave.prepare(&scene, 0).unwrap();
            for (psi, pressure) in [wave.pull_off(), wave.snap_in()].map(|limit| limit.unwrap().unwrap()) {
                for pressure in around(pressure) {
                    let found = wave.stable(pressure).unwrap().unwrap();
                    assert_relative_eq!(found, psi, max_relative = AT_EXTREMUM);
                }
                for force in around(pressure * (size.x * size.y)) {
                    let state = contact.solve(Load::force(force)).unwrap();
                    let fraction = state.area.unwrap() / (size.x * size.y);
                    assert_relative_eq!(fraction * FRAC_PI_2, psi, max_relative = AT_EXTREMUM);
                    assert_eq!(state.force.to_bits(), force.to_bits());
                }
            }
        }
    }

    #[test]
    fn the_load_of_full_contact_closes_the_gap() {
        for (_, size, mut scene) in waves() {
            scene.effects.adhesion = Adhesion::ShortRange { work: 0.0 };
            let Surface::Sine { amplitude, wavelength, .. } = scene.surface else { panic!("no wave") };
            let mut contact = AdhesiveWave.prepare(&scene, 0).unwrap();
            for force in around(PI * scene.contact_modulus * amplitude / wavelength * (size.x * size.y)) {
                let state = contact.solve(Load::force(force)).unwrap();
                assert_eq!((state.mean_gap, state.stiffness), (Some(0.0), None));
            }
        }
    }

    #[test]
    fn errors_are_in_what_was_asked() {
        for (wave, size, scene) in waves() {
            let mut contact = AdhesiveWave.prepare(&scene, 0).unwrap();
            let [first, last] =
                [wave.pull_off(), wave.snap_in()].map(|limit| limit.unwrap().unwrap().1 * (size.x * size.y));
            let beyond = first * (1.0 + BEYOND);
            let error = contact.solve(Load::force(beyond)).unwrap_err();
            assert!(error.to_string().starts_with("force (the contact pulls off"), "{error}");
            let Error::OutOfRange { value, min, max, .. } = error else { panic!("{error}") };
            assert_eq!((value.to_bits(), max), (beyond.to_bits(), f64::INFINITY));
            assert_relative_eq!(min, first, max_relative = ROUNDING);
            // The smallest force that the error names is one.
            assert!(contact.solve(Load::force(min)).is_ok());
            // Beyond the snap-in the contact is full.
            let beyond = last + BEYOND * last.abs();
            let state = contact.solve(Load::force(beyond)).unwrap();
            assert_eq!(
                (state.mean_gap, state.stiffness, state.stiffness_fixed_area),
                (Some(0.0), None, None)
            );
            assert_relative_eq!(state.area.unwrap(), size.x * size.y, max_relative = ROUNDING);
        }
    }

    #[test]
    fn the_stiffness_is_the_slope_of_the_branch() {
        let size: Size = [1.0, 2.0].into();
        for alpha in [1e-4, 0.02, 0.3, 0.9, 1.05] {
            let work = 0.5 * (PI * alpha).powi(2);
            let mut scene = wave_scene(1.0, 1.0, size, (1.0, work));
            scene.outputs.conductance = Conductance::Electrical { first: 1.0, second: 2.0 };
            let mut contact = AdhesiveWave.prepare(&scene, 0).unwrap();
            let wave = with_alpha(alpha);
            let [first, last] = [wave.pull_off(), wave.snap_in()].map(|limit| limit.unwrap().unwrap());
            for share in [0.1, 0.4, 0.8, 0.97] {
                let pressure = first.1 + share * (last.1 - first.1);
                let step = STEP * (last.1 - first.1);
                let mut at = |pressure: f64| contact.solve(Load::force(pressure * size.x * size.y)).unwrap();
                let (low, here, high) = (at(pressure - step), at(pressure), at(pressure + step));
                let slope = (high.force - low.force) / (low.mean_gap.unwrap() - high.mean_gap.unwrap());
                // The curve bends most near the snap-in.
                assert_relative_eq!(here.stiffness.unwrap(), slope, max_relative = 1e3 * DIFFERENCES);
                let psi = wave.stable(pressure).unwrap().unwrap();
                let [along, held] =
                    [wave.slope(psi), wave.stiffness_fixed_area(psi)].map(|k| k.unwrap() * 2.0);
                assert_relative_eq!(here.stiffness.unwrap(), along, max_relative = AT_EXTREMUM);
                assert_relative_eq!(here.stiffness_fixed_area.unwrap(), held, max_relative = AT_EXTREMUM);
                assert!(along < held);
                // Through both bodies, of modulus 1 and resistivities 1 and 2.
                let through = 2.0 / 3.0 * here.stiffness_fixed_area.unwrap();
                assert_relative_eq!(here.conductance.unwrap(), through, max_relative = ROUNDING);
            }
            for (_, pressure) in [first, last] {
                let state = contact.solve(Load::force(pressure * size.x * size.y)).unwrap();
                let ratio = state.stiffness.unwrap() / state.stiffness_fixed_area.unwrap();
                assert_abs_diff_eq!(ratio, 0.0, epsilon = AT_EXTREMUM);
            }
        }
        // On the unstable part too, up to the psi where the mean gap turns.
        let wave = with_alpha(0.3);
        for psi in [0.05, 0.1, 0.15, 1.3, 1.45] {
            let [low, high] = [psi - STEP, psi + STEP];
            let pressure = wave.pressure(high).unwrap() - wave.pressure(low).unwrap();
            let gap = wave.mean_gap(high).unwrap() - wave.mean_gap(low).unwrap();
            assert_relative_eq!(wave.slope(psi).unwrap(), -pressure / gap, max_relative = 1e2 * DIFFERENCES);
        }
    }

    #[test]
    fn numbers_that_make_no_sense() {
        let wave = WavyContact::new(0.01, 0.5, 3.0, 1e-4).unwrap();
        for psi in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -5e-324, FRAC_PI_2.next_up(), 2.0] {
            for outcome in [wave.pressure(psi), wave.mean_gap(psi), wave.stiffness_fixed_area(psi)] {
                assert!(matches!(outcome, Err(Error::Domain { name, .. }) if name == "psi"));
            }
        }
        for psi in [0.0, -0.0] {
            let state = [wave.pressure(psi), wave.mean_gap(psi), wave.stiffness_fixed_area(psi)];
            assert_eq!(state, [Ok(0.0), Ok(0.01), Ok(0.0)]);
        }
        for psi in [5e-324, 1e-310, 1e-200, 1e-100, FRAC_PI_2.next_down(), FRAC_PI_2] {
            let state =
                [wave.pressure(psi), wave.mean_gap(psi), wave.stiffness_fixed_area(psi)].map(Result::unwrap);
            assert!(state.iter().all(|value| value.is_finite()) && state[0] < 0.0 && state[1] > 0.0);
            assert!(state[2] > 0.0, "{psi:e}");
        }
        for pressure in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(wave.stable(pressure), Err(Error::Domain { .. })));
        }
        for pressure in [0.0, -0.0, 5e-324, -5e-324] {
            assert_eq!(wave.stable(pressure).unwrap(), wave.stable(0.0).unwrap());
        }
        assert_eq!(wave.stable(f64::MAX), Ok(None));
        assert!(matches!(wave.stable(f64::MIN), Err(Error::OutOfRange { .. })));
        let mut contact = AdhesiveWave.prepare(&scene(1e-4), 0).unwrap();
        for force in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(matches!(contact.solve(Load::force(force)), Err(Error::Domain { .. })));
        }
        assert!(matches!(contact.solve(Load::force(f64::MIN)), Err(Error::OutOfRange { .. })));
    }

    /// In units of any length the same contact, where an `f64` holds what is asked.
    #[test]
    fn one_contact_in_any_units() {
        let solved = |length: f64, (contact_modulus, area): (f64, bool), force: f64| {
            let size = Size { x: length, y: 2.0 * length };
            let work = 1e-4 * (contact_modulus * length);
            let mut scene = wave_scene(0.01 * length, 0.5 * length, size, (contact_modulus, work));
            scene.outputs.area = area;
            AdhesiveWave.prepare(&scene, 0).unwrap().solve(Load::force(force))
        };
        let one = solved(1.0, (1.0, true), 0.0).unwrap();
        let pulled = solved(1.0, (1.0, true), -0.01).unwrap();
        for length in [1e-200_f64, 1e160, 1e200] {
            let contact_modulus = length.recip();
            let state = solved(length, (contact_modulus, false), 0.0).unwrap();
            assert_relative_eq!(
                state.mean_gap.unwrap() / length,
                one.mean_gap.unwrap(),
                max_relative = ROUNDING
            );
            assert_relative_eq!(state.stiffness.unwrap(), one.stiffness.unwrap(), max_relative = ROUNDING);
            // E* L^2 is L.
            let state = solved(length, (contact_modulus, false), -0.01 * length).unwrap();
            assert_relative_eq!(state.stiffness.unwrap(), pulled.stiffness.unwrap(), max_relative = ROUNDING);
            // An area of 1e-400 or 1e320 is no number.
            let error = solved(length, (contact_modulus, true), 0.0).unwrap_err();
            assert!(error.to_string().starts_with("area ="), "{error}");
        }
        // Sides whose product is a number, though not their ratio's square.
        let size = Size { x: 1e-160, y: 1e160 };
        let mut thin = AdhesiveWave.prepare(&wave_scene(1e-162, 0.5e-160, size, (1.0, 1e-164)), 0).unwrap();
        let state = thin.solve(Load::force(0.0)).unwrap();
        assert_relative_eq!(state.area.unwrap(), 0.5 * one.area.unwrap(), max_relative = ROUNDING);
        // Parts of alpha that are no numbers: work over E* is 1e-400, and E* D is 1e350.
        let wave = WavyContact::new(1e-150, 1e-150, 1e200, 1e-200).unwrap();
        assert_relative_eq!(wave.alpha(), SQRT_2 / PI * 1e-125, max_relative = ROUNDING, epsilon = 0.0);
        let wave = WavyContact::new(1e150, 1e152, 1e200, 1e300).unwrap();
        assert_relative_eq!(wave.alpha(), SQRT_2 / PI * 1e-24, max_relative = ROUNDING, epsilon = 0.0);
    }

    /// Any outcome at any mixture of magnitudes is a finite state or an error about a number.
    #[test]
    fn extreme_magnitudes() {
        const MAGNITUDES: [f64; 9] = [5e-324, 1e-300, 1e-200, 1e-160, 1.0, 1e160, 1e200, 1e300, f64::MAX];
        let mut solved = 0;
        for (i, length) in MAGNITUDES.into_iter().enumerate() {
            for y in MAGNITUDES {
                for contact_modulus in MAGNITUDES {
                    for work in MAGNITUDES.into_iter().chain([0.0]) {
                        let amplitude = if i % 2 == 0 { 0.01 * length } else { 1e-9 * length };
                        let size = Size { x: length, y };
                        let mut scene = wave_scene(amplitude, 0.5 * length, size, (contact_modulus, work));
                        for (area, stiffness) in [(true, true), (false, true), (true, false)] {
                            (scene.outputs.area, scene.outputs.stiffness) = (area, stiffness);
                            let Ok(mut contact) = AdhesiveWave.prepare(&scene, 0) else { continue };
                            for force in [0.0, -1e-300, 1e-300, 1e-20, 1.0, -1.0, 1e300] {
                                match contact.solve(Load::force(force)) {
                                    Ok(state) => {
                                        let values = [
                                            state.area,
                                            state.mean_gap,
                                            state.stiffness,
                                            state.stiffness_fixed_area,
                                        ];
                                        let sensible = |value: &f64| value.is_finite() && *value >= 0.0;
                                        assert!(values.iter().flatten().all(sensible), "{scene:?} {state:?}");
                                        solved += 1;
                                    }
                                    Err(Error::Domain { value, .. } | Error::OutOfRange { value, .. }) => {
                                        assert!(!value.is_nan());
                                    }
                                    Err(other) => panic!("{other}"),
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(solved > 1000, "{solved}");
    }

    #[test]
    fn what_is_refused() {
        let mut free = scene(1e-4);
        free.effects.boundary = Boundary::Free;
        assert!(AdhesiveWave.prepare(&free, 0).is_err());
        assert!(AdhesiveWave.prepare(&scene(f64::NAN), 0).is_err());
        let flat = Surface::Flat { size: 1.0.into() };
        assert!(AdhesiveWave.prepare(&Scene { surface: flat, ..scene(1e-4) }, 0).is_err());
        for values in [
            [0.0, 1.0, 1.0, 0.0],
            [1e-310, 1.0, 1.0, 0.0],
            [1.0, f64::NAN, 1.0, 0.0],
            [1.0, 1.0, -1.0, 0.0],
            [1.0, 1.0, f64::INFINITY, 0.0],
            [1.0, 1.0, 1.0, -1.0],
            [1.0, 1.0, 1.0, f64::INFINITY],
            // D/w, p* and alpha^2 that no f64 holds.
            [1e-200, 1e200, 1.0, 0.0],
            [1e200, 1.0, 1e200, 0.0],
            [1e100, 1.0, 1e100, 1e-200],
        ] {
            let [amplitude, wavelength, contact_modulus, work] = values;
            let outcome = WavyContact::new(amplitude, wavelength, contact_modulus, work);
            assert!(matches!(outcome, Err(Error::Domain { .. })), "{values:?}");
        }
    }
}
