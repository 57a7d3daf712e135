//! Johnson: a sinusoidal wave with short-range adhesion, periodic.

use crate::westergaard::{gap_over_amplitude, whole_waves};
use crate::{periodic, root};
use contact_model::{
    Adhesion, ContactModel, ContactState, Effects, Error, Load, Normalisation, Outputs, PreparedContact,
    Result, Scene, Size, SolveReport, Source, Stop,
};
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

const NAME: &str = "adhesive_wave";

/// The periodic contact of a wave `h = D cos(2 pi x/w)` with a flat under short-range adhesion ([`Adhesion::ShortRange`]), through the
/// half-width a of a contact strip.
///
/// Westergaard's strips carry the mean pressure `p* sin^2 psi`, `psi = pi a/w`, `p* = pi E* D/w`. A uniform mean tension s on bonded strips
/// adds the traction `s cos(pi x/w)/sqrt(sin^2 psi - sin^2(pi x/w))`, whose stress intensity is `K = s sqrt(w cot psi)`. With
/// `K^2/(2 E*)` = the work of adhesion:
///
/// `p/p* = sin^2 psi - alpha sqrt(tan psi)`, `alpha^2 = 2 work E*/(w p*^2)`,
///
/// and a mean gap of `D (1 - r + r ln r) - D alpha sqrt(tan psi) ln r`, `r = sin^2 psi`.
///
/// Stable where p rises with a: from the minimum, where the strips are pulled off, to the maximum, where they snap into full contact. For
/// alpha above [`WavyContact::CRITICAL`] there is neither, and surfaces that touch close at once. Full contact stays under any tension in
/// this limit, because nothing begins to open it.
///
/// ```
/// use analytic::adhesive_wave::WavyContact;
/// let wave = WavyContact::new(0.01, 1.0, 1.0, 1e-5)?;
/// let (psi, pull_off) = wave.pull_off().unwrap();
/// assert!(pull_off < 0.0 && wave.pressure(psi + 0.01) > pull_off && wave.pressure(psi - 0.01) > pull_off);
/// assert!(wave.snap_in().unwrap().1 > 0.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WavyContact {
    amplitude: f64,
    full: f64,
    alpha: f64,
}

impl WavyContact {
    /// Largest alpha with a stable partial contact: twice the largest `2 sin^(3/2) psi cos^(5/2) psi`.
    pub const CRITICAL: f64 = 1.065_205_656_063_280_8;

    /// Amplitude D, wavelength, E*, work of adhesion >= 0.
    ///
    /// # Errors
    /// [`Error::Domain`] for a value that makes no sense, or p* or alpha that no f64 holds.
    pub fn new(amplitude: f64, wavelength: f64, modulus: f64, work: f64) -> Result<Self> {
        for (name, value) in [("amplitude", amplitude), ("wavelength", wavelength), ("modulus", modulus)] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::domain(name, value, "a finite number > 0"));
            }
        }
        if !(work.is_finite() && work >= 0.0) {
            return Err(Error::domain("work of adhesion", work, "a finite number >= 0"));
        }
        let slope = amplitude / wavelength;
        let full = PI * modulus * slope;
        let alpha = (2.0 * (work / modulus / wavelength)).sqrt() / (PI * slope);
        for (name, value) in [("mean pressure", full), ("work of adhesion over E* D^2/w", alpha)] {
            if !(value.is_finite() && (value > 0.0 || work <= 0.0)) {
                return Err(Error::domain(name, value, "a number within the range of f64"));
            }
        }
        Ok(Self { amplitude, full, alpha })
    }

    /// `alpha`, the share of adhesion.
    pub fn alpha(&self) -> f64 {
        self.alpha
    }

    /// Mean pressure at `psi = pi a/w` in [0, pi/2).
    pub fn pressure(&self, psi: f64) -> f64 {
        self.full * (psi.sin().powi(2) - self.alpha * psi.tan().sqrt())
    }

    /// Mean gap at `psi` in (0, pi/2).
    pub fn mean_gap(&self, psi: f64) -> f64 {
        let r = psi.sin().powi(2);
        self.amplitude * (gap_over_amplitude(r) - self.alpha * psi.tan().sqrt() * r.ln())
    }

    /// `-dp/d(mean gap)` of the bonded strips at `psi` in (0, pi/2).
    pub fn stiffness(&self, psi: f64) -> f64 {
        -self.full / self.amplitude / psi.sin().powi(2).ln()
    }

    /// Where the mean pressure has its minimum, and the minimum: the pull-off under a prescribed force. `None` without adhesion and above
    /// the critical alpha.
    pub fn pull_off(&self) -> Option<(f64, f64)> {
        self.turn(0.0)
    }

    /// Where the mean pressure has its maximum, and the maximum: there the surfaces snap into full contact.
    pub fn snap_in(&self) -> Option<(f64, f64)> {
        self.turn(FRAC_PI_2)
    }

    /// The turn between the steepest rise and one end: roots of dp/dpsi, `2 sin^(3/2) cos^(5/2) = alpha/2`.
    fn turn(&self, end: f64) -> Option<(f64, f64)> {
        let rise = |psi: f64| 2.0 * psi.sin().abs().powf(1.5) * psi.cos().abs().powf(2.5) - 0.5 * self.alpha;
        let steepest = 0.6_f64.sqrt().atan();
        if self.alpha <= 0.0 || rise(steepest) <= 0.0 {
            return None;
        }
        let psi = root::between(end, steepest, rise);
        Some((psi, self.pressure(psi)))
    }

    /// `psi` of the stable partial contact under a mean pressure; `None` where the contact is full.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] below the pull-off.
    pub fn stable(&self, pressure: f64) -> Result<Option<f64>> {
        let (first, last) = match (self.pull_off(), self.snap_in()) {
            (Some(first), Some(last)) => (first, last),
            _ if self.alpha > 0.0 => return Ok(None),
            _ => ((0.0, 0.0), (FRAC_PI_2, self.full)),
        };
        if pressure < first.1 {
            let (name, max) = ("mean pressure".into(), f64::INFINITY);
            return Err(Error::OutOfRange { name, value: pressure, min: first.1, max });
        }
        if pressure >= last.1 {
            return Ok(None);
        }
        Ok(Some(if self.alpha <= 0.0 {
            (pressure / self.full).sqrt().asin()
        } else {
            root::between(first.0, last.0, |psi| self.pressure(psi) - pressure)
        }))
    }
}

/// The wave of [`WavyContact`] behind the common trait: forces, of either sign down to the pull-off.
///
/// It takes [`contact_model::Surface::Sine`] with [`contact_model::Boundary::Periodic`] and a whole number of waves along x. Without adhesion it is
/// [`crate::Westergaard`]. A mean gap is not taken: between snap-in and pull-off it has more than one state.
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

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        let work = match scene.effects.adhesion {
            Adhesion::Off => 0.0,
            Adhesion::ShortRange { work } => work,
            other => return Err(Error::unsupported(NAME, format!("adhesion ({other:?})"))),
        };
        let effects = Effects { adhesion: Adhesion::Off, ..scene.effects };
        periodic::check(&Scene { effects, ..scene.clone() }, NAME)?;
        scene.effects.validate()?;
        let (amplitude, waves, size) = whole_waves(scene, NAME)?;
        let wave = WavyContact::new(amplitude, size.x / waves, scene.modulus, work)?;
        let length = size.length();
        let normalisation =
            Normalisation { modulus: scene.modulus, length, height: Some(amplitude / SQRT_2) };
        Ok(Box::new(Prepared { wave, size, normalisation, outputs: scene.outputs }))
    }
}

struct Prepared {
    wave: WavyContact,
    size: Size,
    normalisation: Normalisation,
    outputs: Outputs,
}

impl PreparedContact for Prepared {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let force = match load.validated_with_adhesion()? {
            Load::Force(force) => force,
            other => return Err(Error::unsupported(NAME, format!("the load {other:?} (it takes a force)"))),
        };
        let nominal = self.size.x * self.size.y;
        let pressure = force / nominal;
        if !pressure.is_finite() {
            return Err(Error::domain("mean pressure", pressure, "a number within the range of f64"));
        }
        let psi = self.wave.stable(pressure)?;
        // Without adhesion and load the crests do not touch yet.
        let untouched = psi.is_some_and(|psi| psi <= 0.0);
        let stiffness = match psi {
            _ if !self.outputs.needs_stiffness() => None,
            _ if untouched => Some(0.0),
            Some(psi) => Some(self.wave.stiffness(psi) * nominal),
            None => {
                let name = "mean pressure (full contact has no finite stiffness)".into();
                let max = self.wave.snap_in().map_or(self.wave.full, |turn| turn.1);
                return Err(Error::OutOfRange { name, value: pressure, min: f64::NEG_INFINITY, max });
            }
        };
        let gap = match psi {
            Some(_) if untouched => self.wave.amplitude,
            Some(psi) => self.wave.mean_gap(psi),
            None => 0.0,
        };
        let area = nominal * psi.map_or(1.0, |psi| psi / FRAC_PI_2);
        let mut report = SolveReport::exact("closed form (Johnson)");
        report.certificate.stiffness_error = stiffness.map(|_| 0.0);
        ContactState::new(force, report)
            .with_mean_gap(self.outputs.mean_gap.then_some(gap))
            .with_stiffness(stiffness)
            .with_area(self.outputs.area.then_some(area))
            .completed(&self.outputs, self.normalisation.modulus)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Westergaard;
    use approx::assert_relative_eq;
    use contact_model::{Boundary, Surface};

    /// Step of differences, relative; their error is its square.
    const STEP: f64 = 1e-5;

    fn scene(work: f64) -> Scene {
        let surface = Surface::Sine { amplitude: 0.01, wavelength: 0.5, size: [1.0, 2.0].into() };
        let mut scene = Scene::new(surface, 3.0);
        scene.effects.boundary = Boundary::Periodic;
        scene.effects.adhesion = Adhesion::ShortRange { work };
        (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
        scene
    }

    #[test]
    fn without_work_it_is_westergaard() {
        let mut elastic = scene(0.0);
        elastic.effects.adhesion = Adhesion::Off;
        let mut expected = Westergaard.prepare(&elastic, 0).unwrap();
        let mut found = AdhesiveWave.prepare(&scene(0.0), 0).unwrap();
        for share in [1e-6, 0.1, 0.5, 0.99] {
            let load = Load::Force(share * 2.0 * PI * 3.0 * 0.02);
            let (a, b) = (found.solve(load).unwrap(), expected.solve(load).unwrap());
            for (a, b) in [(a.area, b.area), (a.mean_gap, b.mean_gap), (a.stiffness, b.stiffness)] {
                assert_relative_eq!(a.unwrap(), b.unwrap(), max_relative = 1e-12);
            }
        }
        assert_relative_eq!(found.solve(Load::Force(0.0)).unwrap().mean_gap.unwrap(), 0.01);
    }

    /// The stress intensity of the bonded strips and their compliance release the same energy.
    #[test]
    fn the_compliance_releases_the_work() {
        let wave = WavyContact::new(0.02, 0.7, 2.0, 3e-4).unwrap();
        for psi in [0.2_f64, 0.7, 1.3] {
            let tension = wave.full * wave.alpha * psi.tan().sqrt();
            let compliance = |psi: f64| 1.0 / wave.stiffness(psi);
            let by_psi = (compliance(psi + STEP) - compliance(psi - STEP)) / (2.0 * STEP);
            // Energy per nominal area, over the change of the area fraction 2 psi/pi.
            assert_relative_eq!(-0.5 * tension * tension * by_psi * FRAC_PI_2, 3e-4, max_relative = 1e-8);
        }
    }

    /// Along the curve the work of the mean pressure is the change of the energy: its second derivatives agree (Maxwell).
    #[test]
    fn pressure_and_gap_belong_to_one_energy() {
        // At fixed psi the bonded contact is linear with its stiffness, so that p and the gap follow from the same strips.
        let wave = WavyContact::new(0.02, 0.7, 2.0, 3e-4).unwrap();
        let elastic = WavyContact::new(0.02, 0.7, 2.0, 0.0).unwrap();
        for psi in [0.3, 0.9, 1.4] {
            let (pressure, gap) =
                (wave.pressure(psi) - elastic.pressure(psi), wave.mean_gap(psi) - elastic.mean_gap(psi));
            assert_relative_eq!(-pressure / gap, wave.stiffness(psi), max_relative = 1e-12);
        }
    }

    #[test]
    fn turns_of_the_pressure() {
        // Johnson: zero mean pressure closes the surfaces from alpha = 0.57 on.
        let at = |alpha: f64| WavyContact { amplitude: 1.0, full: 1.0, alpha };
        assert!(at(0.56).snap_in().unwrap().1 > 0.0 && at(0.58).snap_in().unwrap().1 < 0.0);
        let wave = at(0.3);
        for (psi, pressure) in [wave.pull_off().unwrap(), wave.snap_in().unwrap()] {
            let slope = (wave.pressure(psi + STEP) - wave.pressure(psi - STEP)) / (2.0 * STEP);
            assert!(slope.abs() < 1e-8, "{slope}");
            assert_relative_eq!(wave.pressure(psi), pressure);
        }
        let critical = WavyContact::CRITICAL;
        assert!(at(critical * (1.0 - 1e-6)).pull_off().is_some());
        assert!(at(critical * (1.0 + 1e-6)).pull_off().is_none());
        assert_eq!(at(2.0).stable(0.0), Ok(None));
        // Narrow strips are cylinders of radius w^2/(4 pi^2 D): p w = pi E* a^2/(4 R) - sqrt(2 pi a E* work).
        let (amplitude, wavelength, modulus, work) = (1e-3, 1.0, 2.0, 1e-12);
        let narrow = WavyContact::new(amplitude, wavelength, modulus, work).unwrap();
        let a = 1e-3;
        let radius = wavelength * wavelength / (4.0 * PI * PI * amplitude);
        let line = PI * modulus * a * a / (4.0 * radius) - (2.0 * PI * a * modulus * work).sqrt();
        assert_relative_eq!(narrow.pressure(PI * a / wavelength) * wavelength, line, max_relative = 1e-4);
    }

    #[test]
    fn the_stable_branch_and_its_ends() {
        let wave = WavyContact::new(0.01, 0.5, 3.0, 1e-4).unwrap();
        let (first, last) = (wave.pull_off().unwrap(), wave.snap_in().unwrap());
        for share in [0.0, 0.3, 0.9] {
            let pressure = first.1 + share * (last.1 - first.1);
            let psi = wave.stable(pressure).unwrap().unwrap();
            assert!((first.0..=last.0).contains(&psi));
            assert_relative_eq!(wave.pressure(psi), pressure, max_relative = 1e-9, epsilon = 1e-12);
        }
        assert_eq!(wave.stable(last.1), Ok(None));
        assert!(matches!(wave.stable(1.01 * first.1), Err(Error::OutOfRange { .. })));
        let mut contact = AdhesiveWave.prepare(&scene(1e-4), 0).unwrap();
        let pulled = contact.solve(Load::Force(0.9 * 2.0 * first.1)).unwrap();
        assert!(pulled.area.unwrap() > 0.0 && pulled.stiffness.unwrap() > 0.0);
        assert!(contact.solve(Load::Force(2.1 * first.1)).is_err());
        assert!(contact.solve(Load::MeanGap(0.005)).is_err());
    }

    #[test]
    fn what_is_refused() {
        let mut free = scene(1e-4);
        free.effects.boundary = Boundary::Free;
        assert!(AdhesiveWave.prepare(&free, 0).is_err());
        assert!(AdhesiveWave.prepare(&scene(f64::NAN), 0).is_err());
        let flat = Surface::Flat { size: 1.0.into() };
        assert!(AdhesiveWave.prepare(&Scene { surface: flat, ..scene(1e-4) }, 0).is_err());
        for values in
            [[0.0, 1.0, 1.0, 0.0], [1.0, f64::NAN, 1.0, 0.0], [1.0, 1.0, -1.0, 0.0], [1.0, 1.0, 1.0, -1.0]]
        {
            let [amplitude, wavelength, modulus, work] = values;
            assert!(WavyContact::new(amplitude, wavelength, modulus, work).is_err());
        }
    }
}
