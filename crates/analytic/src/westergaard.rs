//! Westergaard: a sinusoidal wave, periodic; and the limits of the product of two waves (Johnson, Greenwood,
//! Higginson).

use crate::closed::{self, ROUNDED_UP};
use crate::periodic::{self, Periodic, PeriodicLaw};
use contact_model::{
    Abilities, ContactModel, Error, PreparedContact, Result, Scaling, Scene, Size, Source, Surface,
};
use numerics::root;
use std::f64::consts::{PI, SQRT_2};

const NAME: &str = "westergaard";

/// Largest deviation of the side along x from a whole number of waves: both may have been rounded on their
/// way through a file.
const WHOLE_WAVES: f64 = 1e-9;

/// The periodic contact of a wave `h = D cos(2 pi x/w)` with a flat: closes at the mean pressure `p* = pi E*
/// D/w`.
///
/// With `r = p/p*`: contact width over wavelength `(2/pi) asin sqrt(r)`, mean gap `D (1 - r + r ln r)`,
/// stiffness per area `pi E*/(w ln(1/r))`. From `p*` on the contact is full: the area is that of the
/// rectangle, the mean gap is 0, and the stiffness, which has no bound there, is absent. For a mean gap above
/// D there is no contact.
///
/// Takes [`Surface::Sine`] with [`contact_model::Boundary::Periodic`] and a whole number of waves along x.
/// The rms height of its normalisation is D/sqrt(2).
///
/// ```
/// use analytic::Westergaard;
/// use contact_model::{Boundary, ContactModel, Load, Scene, Surface};
/// let surface = Surface::Sine { amplitude: 0.01, wavelength: 1.0, size: 1.0.into() };
/// let mut scene = Scene::new(surface, 1.0);
/// scene.effects.boundary = Boundary::Periodic;
/// (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
/// let mut contact = Westergaard.prepare(&scene, 0)?;
/// // Half of p* = 0.01 pi: half the square, as asin sqrt(1/2) = pi/4; mean gap 0.01 (1 - 1/2 - ln(2)/2).
/// let load = Load::force(0.005 * std::f64::consts::PI);
/// assert!((contact.solve(load)?.area.unwrap_or(0.0) - 0.5).abs() < 1e-15);
/// assert!((contact.solve(load)?.mean_gap.unwrap() - 0.005 * (1.0 - 2.0_f64.ln())).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Westergaard;

impl ContactModel for Westergaard {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source {
            citation: "H. M. Westergaard, J. Appl. Mech. 6, A49 (1939); K. L. Johnson, Contact Mechanics, Cambridge (1985)",
            what: "periodic contact of a sinusoidal wave (Johnson Sec. 13.2); mean gap by integration",
        }]
    }

    fn abilities(&self) -> Abilities {
        periodic::WAVE
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let (height, whole, size) = whole_waves(scene, NAME)?;
        let law = UnitWave { full: PI * whole * (size.length() / size.x) };
        let scaling = Scaling::new(scene, height, Some(height / SQRT_2))?;
        Ok(closed::prepared(scaling, Periodic { model: NAME, law, strategy: "closed form (Westergaard)" }))
    }
}

/// Amplitude, number of waves and sides of a periodic sine.
///
/// # Errors
/// [`Error::Unsupported`] for another surface, [`Error::Domain`] where the side along x is no whole number of
/// waves.
pub(crate) fn whole_waves(scene: &Scene, model: &'static str) -> Result<(f64, f64, Size)> {
    let Surface::Sine { amplitude, wavelength, size } = scene.surface else {
        return Err(Error::unsupported(model, scene.surface.kind()));
    };
    let waves = size.x / wavelength;
    let whole = waves.round();
    if !(whole >= 1.0 && (waves - whole).abs() <= WHOLE_WAVES * whole) {
        return Err(Error::domain(
            "side along x over wavelength",
            waves,
            "a whole number of waves with periodic boundaries",
        ));
    }
    // A wave of negative amplitude is the same wave, shifted.
    Ok((amplitude.abs(), whole, size))
}

/// Heights in D, pressures in E* D/L.
struct UnitWave {
    /// p*.
    full: f64,
}

impl UnitWave {
    fn ratio(&self, pressure: f64) -> f64 {
        pressure / self.full
    }
}

/// `1 - r + r ln r` for r in [0, 1], without cancellation near r = 1.
fn gap_over_amplitude(r: f64) -> f64 {
    gap_of_fractions(r, 1.0 - r)
}

/// `e + r ln r` for r in [0, 1] and `e = 1 - r`, which near r = 1 has digits that r has not.
pub(crate) fn gap_of_fractions(r: f64, e: f64) -> f64 {
    if r <= 0.0 {
        return 1.0;
    }
    if e > 0.1 {
        return e + r * r.ln();
    }
    // (1 - e) ln(1 - e) + e = sum of e^k / (k (k - 1)) from k = 2.
    let mut sum = 0.0;
    let mut power = e;
    for k in 2..32 {
        power *= e;
        sum += power / f64::from(k * (k - 1));
    }
    sum
}

impl PeriodicLaw for UnitWave {
    fn admit(&self, _pressure: f64) -> Result<()> {
        Ok(())
    }

    fn fraction(&self, pressure: f64) -> Result<f64> {
        Ok(self.ratio(pressure).min(1.0).sqrt().asin() * (2.0 / PI))
    }

    fn stiffness(&self, pressure: f64) -> Result<Option<f64>> {
        let r = self.ratio(pressure);
        Ok((r < 1.0).then(|| -self.full / r.ln()))
    }

    fn gap(&self, pressure: f64) -> Result<f64> {
        Ok(gap_over_amplitude(self.ratio(pressure).min(1.0)))
    }

    fn pressure(&self, gap: f64) -> Result<f64> {
        if gap >= 1.0 {
            return Ok(0.0);
        }
        // In e = 1 - r near full contact, where r would lose digits; below, r ~ (1 - gap)/ln: any bracket
        // does.
        let r = if gap < gap_over_amplitude(0.5) {
            1.0 - root::between(0.0, 0.5, |e| gap_over_amplitude(1.0 - e) - gap)
        } else {
            root::between(0.0, 0.5, |r| gap_over_amplitude(r) - gap)
        };
        Ok(r * self.full)
    }
}

/// `p* = sqrt(2) pi E* D/w`: the mean pressure that closes `h = D cos(2 pi x/w) cos(2 pi y/w)` (Johnson,
/// Greenwood, Higginson, Int. J. Mech. Sci. 27, 383 (1985)).
///
/// # Errors
/// [`Error::Domain`] for a number that is not finite and positive.
///
/// ```
/// use std::f64::consts::{PI, SQRT_2};
/// assert!((analytic::westergaard::product_full_pressure(2.0, 0.1, 0.5)? - 0.4 * SQRT_2 * PI).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn product_full_pressure(contact_modulus: f64, amplitude: f64, wavelength: f64) -> Result<f64> {
    for (name, value) in
        [("contact_modulus", contact_modulus), ("amplitude", amplitude), ("wavelength", wavelength)]
    {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::domain(name, value, "a finite number > 0"));
        }
    }
    let pressure = SQRT_2 * PI * contact_modulus * (amplitude / wavelength);
    if pressure.is_finite() && pressure > 0.0 {
        Ok(pressure)
    } else {
        Err(Error::not_representable("mean pressure", pressure))
    }
}

/// `A/A0 = pi (3 r/(8 pi))^(2/3)` of that product of waves, asymptotic for small `r = p/p*`: Hertz's contact
/// at each of the two crests a square.
///
/// The crests' mutual displacement is neglected: a relative error of order `r^(1/3)`.
///
/// # Errors
/// [`Error::Domain`] for a ratio outside [0, 1].
///
/// ```
/// // r = 8 pi/3 x 1e-6: pi x 1e-4.
/// let r = 8e-6 * std::f64::consts::PI / 3.0;
/// assert!((analytic::westergaard::product_small_fraction(r)? - 1e-4 * std::f64::consts::PI).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn product_small_fraction(ratio: f64) -> Result<f64> {
    Ok(PI * (3.0 / 8.0 / PI * share(ratio)?).cbrt().powi(2))
}

/// `K w/E* = 2 sqrt(2) (3 r/(8 pi))^(1/3)` of that product of waves, its stiffness per area for small r: `2
/// E* a` at each of the two crests a square.
///
/// Hertz's contact as in [`product_small_fraction`], with the same neglect.
///
/// # Errors
/// As [`product_small_fraction`].
///
/// ```
/// // r = 8 pi/3 x 1e-6: 2 sqrt(2) x 1e-2.
/// let r = 8e-6 * std::f64::consts::PI / 3.0;
/// assert!((analytic::westergaard::product_small_stiffness(r)? - 0.02828427125).abs() < 1e-11);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn product_small_stiffness(ratio: f64) -> Result<f64> {
    // A/A0 = 2 pi (a/w)^2.
    Ok(4.0 * (product_small_fraction(ratio)? / (2.0 * PI)).sqrt())
}

/// `1 - A/A0 = 3/(2 pi) (1 - r)` of that product of waves, asymptotic for r near 1: the fraction that is not
/// in contact.
///
/// The gaps that remain act as pressurised cracks at the troughs (Johnson, Greenwood, Higginson, Int. J.
/// Mech. Sci. 27, 383 (1985)).
///
/// # Errors
/// As [`product_small_fraction`].
///
/// ```
/// assert!((analytic::westergaard::product_open_fraction(0.9)? - 0.15 / std::f64::consts::PI).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn product_open_fraction(ratio: f64) -> Result<f64> {
    Ok(1.5 / PI * (1.0 - share(ratio)?))
}

fn share(ratio: f64) -> Result<f64> {
    if (0.0..=ROUNDED_UP).contains(&ratio) {
        Ok(ratio.min(1.0))
    } else {
        Err(Error::domain("mean pressure over that of full contact", ratio, "a number in [0, 1]"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{ROUNDING, check_periodic};
    use approx::assert_relative_eq;
    use contact_model::{Boundary, Load};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn scene(amplitude: f64, wavelength: f64, side: f64, contact_modulus: f64) -> Scene {
        let mut scene =
            Scene::new(Surface::Sine { amplitude, wavelength, size: side.into() }, contact_modulus);
        scene.effects.boundary = Boundary::Periodic;
        (scene.outputs.area, scene.outputs.mean_gap) = (true, true);
        scene
    }

    #[test]
    fn the_gap_near_full_contact_keeps_its_digits() {
        // Both branches at their meeting point, and (1 - r)^2 / 2 close to 1.
        let (below, above) = (0.9 - 1e-12, 0.9 + 1e-12);
        assert_relative_eq!(gap_over_amplitude(below), gap_over_amplitude(above), max_relative = 1e-10);
        assert_relative_eq!(gap_over_amplitude(1.0 - 1e-6), 0.5e-12, max_relative = 1e-6);
        assert_relative_eq!(gap_over_amplitude(0.25), 0.75 - 0.25 * 4.0_f64.ln(), max_relative = ROUNDING);
    }

    #[test]
    fn full_contact_and_no_contact() {
        let scene = scene(0.01, 0.5, 1.0, 2.0);
        let mut contact = Westergaard.prepare(&scene, 0).unwrap();
        let full = PI * 2.0 * 0.01 / 0.5;
        let state = contact.solve(Load::force(1.1 * full)).unwrap();
        assert_relative_eq!(state.area.unwrap(), 1.0, max_relative = ROUNDING);
        assert_eq!((state.mean_gap, state.stiffness), (Some(0.0), None));
        assert_eq!(state.report.certificate.stiffness_error, None);
        let apart = contact.solve(Load::mean_gap(0.02)).unwrap();
        assert!(apart.force <= 0.0 && apart.area.unwrap() <= 0.0 && apart.stiffness.unwrap() <= 0.0);
        assert_relative_eq!(
            contact.solve(Load::force(0.0)).unwrap().mean_gap.unwrap(),
            0.01,
            max_relative = ROUNDING
        );
        assert!(
            contact.solve(Load::approach(0.001)).is_err() && contact.solve(Load::mean_gap(-1.0)).is_err()
        );
    }

    #[test]
    fn what_is_not_a_periodic_wave_is_refused() {
        let free = Scene::new(Surface::Sine { amplitude: 0.01, wavelength: 0.5, size: 1.0.into() }, 1.0);
        assert!(matches!(Westergaard.prepare(&free, 0), Err(Error::Unsupported { .. })));
        assert!(matches!(Westergaard.prepare(&scene(0.01, 0.4, 1.0, 1.0), 0), Err(Error::Domain { .. })));
        let mut sphere = scene(0.01, 0.5, 1.0, 1.0);
        sphere.surface = Surface::Sphere { radius: 1.0, size: 1.0.into() };
        assert!(matches!(Westergaard.prepare(&sphere, 0), Err(Error::Unsupported { .. })));
    }

    #[test]
    fn few_lines_are_hertz_line_contacts() {
        // Line contact (Johnson Eq. 4.43): a^2 = 4 P R/(pi E*) with P = p w and 1/R = D (2 pi/w)^2; half
        // width a of w.
        let (d, w, p) = (0.01, 1.0, 1e-9);
        let state = Westergaard.prepare(&scene(d, w, 1.0, 1.0), 0).unwrap().solve(Load::force(p)).unwrap();
        let half = (4.0 * p * w * w * w / (PI * 4.0 * PI * PI * d)).sqrt();
        assert_relative_eq!(state.area.unwrap(), 2.0 * half / w, max_relative = 1e-7);
    }

    #[test]
    fn the_limits_of_the_product() {
        // Hertz at one crest: radius w^2/(4 pi^2 D), force p w^2/2, two crests a square.
        let (d, w, r) = (0.02, 0.7, 1e-4);
        let p = r * product_full_pressure(3.0, d, w).unwrap();
        let a = (0.75 * (p * w * w / 2.0) * (w * w / (4.0 * PI * PI * d)) / 3.0).cbrt();
        assert_relative_eq!(
            product_small_fraction(r).unwrap(),
            2.0 * PI * a * a / (w * w),
            max_relative = ROUNDING
        );
        assert_relative_eq!(
            product_small_stiffness(r).unwrap(),
            2.0 / (w * w) * 2.0 * a * w,
            max_relative = ROUNDING
        );
        assert!(product_open_fraction(1.1).is_err() && product_small_fraction(f64::NAN).is_err());
        assert!(product_full_pressure(1.0, 0.0, 1.0).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(32) })]

        #[test]
        fn curve(d in 1e-4_f64..1e-2, waves in 1..9_i32, contact_modulus in 0.1_f64..10.0, r in 1e-6_f64..0.99) {
            let scene = scene(d, 1.0 / f64::from(waves), 1.0, contact_modulus);
            let p = r * PI * contact_modulus * d * f64::from(waves);
            check_periodic(&Westergaard, &scene, p, 1e-13);
            // In other units the same contact.
            for length in [1e-150, 1e150] {
                let scene = self::scene(d * length, length / f64::from(waves), length, contact_modulus / length);
                let one = Westergaard.prepare(&scene, 0).unwrap().solve(Load::force(p * length)).unwrap();
                assert_relative_eq!(one.area.unwrap() / length / length, (2.0 / PI) * r.sqrt().asin(), max_relative = 1e-12);
            }
        }
    }
}
