//! Galin: power-law bodies `z = c r^n`, among them the cone.

use crate::closed::{self, ClosedLaw, ClosedState};
use crate::gamma::half_step_ratio;
use contact_model::{
    Abilities, ContactModel, Error, PreparedContact, Result, Scene, Size, Source, Surface, SurfaceKind,
};
use std::f64::consts::PI;

const NAME: &str = "power_law_body";

/// A power-law body: `d = kappa_n c a^n`, `F = 2 E* d a n / (n + 1)`, `k = 2 E* a`, `A = pi a^2` ([`kappa`]).
///
/// Then `d ln k / d ln F = 1 / (n + 1)` exactly, at any load. Takes [`Surface::PowerLaw`], [`Surface::Cone`]
/// (n = 1) and [`Surface::Sphere`] (n = 2); a contact radius beyond half the shorter side is
/// [`Error::OutOfRange`].
///
/// ```
/// use analytic::PowerLawBody;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// // A cone of slope 0.1 pressed by d = 0.1: a = 2 / pi, F = d a = 0.0636619772.
/// let scene = Scene::new(Surface::Cone { slope: 0.1, size: 2.0.into() }, 1.0);
/// let state = PowerLawBody.prepare(&scene, 0)?.solve(Load::approach(0.1))?;
/// assert!((state.force - 0.0636619772).abs() < 1e-10);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PowerLawBody;

impl ContactModel for PowerLawBody {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "L. A. Galin, Prikl. Mat. Mekh. 10, 425 (1946)",
                what: "normal contact of bodies z = c r^n",
            },
            Source {
                citation: "I. N. Sneddon, Int. J. Eng. Sci. 3, 47 (1965)",
                what: "d, F and k of axisymmetric bodies of arbitrary profile",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[SurfaceKind::PowerLaw, SurfaceKind::Cone, SurfaceKind::Sphere],
            outputs: closed::WITH_AREA,
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        // c L^(n - 1), the depth at r = L over L.
        let (exponent, depth) = match scene.surface {
            Surface::PowerLaw { coefficient, exponent, size } => {
                // In two halves: the product may be moderate where L^(n - 1) alone overflows.
                let half = size.length().powf(0.5 * (exponent - 1.0));
                (exponent, coefficient * half * half)
            }
            Surface::Cone { slope, .. } => (1.0, slope),
            Surface::Sphere { radius, size } => (2.0, 0.5 * (size.length() / radius)),
            ref other => return Err(Error::unsupported(NAME, other.kind())),
        };
        let depth = kappa(exponent)? * depth;
        if !(depth.is_finite() && depth > 0.0) {
            return Err(Error::not_representable("depth of the body at r = L, over L", depth));
        }
        let law = PowerLawShape { exponent, depth, size: scene.surface.size() };
        closed::of_body(scene, NAME, ("closed form (Galin)", 0.0), law)
    }
}

/// `kappa_n = (sqrt(pi)/2) n Gamma(n/2) / Gamma((n + 1)/2)`, dimensionless: pi/2 for a cone, 2 for a sphere.
///
/// # Errors
/// [`Error::Domain`] for an exponent that is not finite and positive.
///
/// ```
/// assert!((analytic::power_law_body::kappa(4.0)? - 8.0 / 3.0).abs() < 1e-13);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn kappa(exponent: f64) -> Result<f64> {
    if exponent.is_finite() && exponent > 0.0 {
        // n Gamma(n/2) / 2 = Gamma(n/2 + 1).
        Ok(PI.sqrt() * half_step_ratio(0.5 * (exponent + 1.0)))
    } else {
        Err(Error::domain("exponent", exponent, "a finite number > 0"))
    }
}

/// `d = depth a^exponent` in units of `L = size.length()`.
struct PowerLawShape {
    exponent: f64,
    depth: f64,
    size: Size,
}

impl PowerLawShape {
    /// `F / (2 d a)`.
    fn share(&self) -> f64 {
        self.exponent / (self.exponent + 1.0)
    }
}

impl ClosedLaw for PowerLawShape {
    fn at_force(&self, force: f64) -> Result<ClosedState> {
        let contact = (force / (2.0 * self.share()) / self.depth).powf((self.exponent + 1.0).recip());
        ClosedState::round(force, force / (2.0 * self.share()) / contact, contact, self.size)
    }

    fn at_approach(&self, approach: f64) -> Result<ClosedState> {
        let contact = (approach / self.depth).powf(self.exponent.recip());
        ClosedState::round(2.0 * self.share() * approach * contact, approach, contact, self.size)
    }

    fn unloaded(&self) -> ClosedState {
        ClosedState::round_unloaded()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PRINTED, check_curve, pressed, scale_invariant};
    use approx::assert_relative_eq;
    use contact_model::Load;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// A power of an inverse exponent multiplies the rounding of its argument by at most 1/n = 10.
    const POWER_ROUNDING: f64 = 1e-13;

    #[test]
    fn kappa_of_the_table() {
        for (n, expected) in [
            (0.2, 1.132_308_697_5),
            (0.5, 1.311_028_777_1),
            (0.8, 1.471_637_592_2),
            (1.0, PI / 2.0),
            (2.0, 2.0),
            (3.0, 2.356_194_490_2),
            (4.0, 8.0 / 3.0),
        ] {
            assert_relative_eq!(kappa(n).unwrap(), expected, max_relative = PRINTED);
        }
        assert_relative_eq!(kappa(1e4).unwrap(), 125.334_547_056_054_48, max_relative = 1e-14);
        assert!(kappa(0.0).is_err() && kappa(f64::NAN).is_err());
    }

    #[test]
    fn cone_and_sphere() {
        let cone = Scene::new(Surface::Cone { slope: 0.1, size: 2.0.into() }, 1.0);
        let s = pressed(&PowerLawBody, &cone, Load::approach(0.1)).unwrap();
        assert_relative_eq!(s.stiffness.unwrap(), 4.0 / PI, max_relative = POWER_ROUNDING);
        assert_relative_eq!(s.force, 0.063_661_977_2, max_relative = 1e-9);
        let sphere = Scene::new(Surface::Sphere { radius: 1.3, size: 1.0.into() }, 2.0);
        let here = pressed(&PowerLawBody, &sphere, Load::force(0.01)).unwrap();
        let hertz = pressed(&crate::Hertz, &sphere, Load::force(0.01)).unwrap();
        assert_relative_eq!(here.approach.unwrap(), hertz.approach.unwrap(), max_relative = POWER_ROUNDING);
        assert_relative_eq!(here.area.unwrap(), hertz.area.unwrap(), max_relative = POWER_ROUNDING);
    }

    #[test]
    fn a_body_without_a_load_has_a_contact_radius_of_zero() {
        for surface in [
            Surface::Cone { slope: 0.1, size: 2.0.into() },
            Surface::Sphere { radius: 1.3, size: 1.0.into() },
            Surface::PowerLaw { coefficient: 0.5, exponent: 4.0, size: 1.0.into() },
        ] {
            let scene = Scene::new(surface, 2.0);
            for load in [Load::force(0.0), Load::approach(0.0)] {
                let state = pressed(&PowerLawBody, &scene, load).unwrap();
                assert_eq!([state.contact_radius, state.area], [Some(0.0); 2], "{scene:?} {load:?}");
            }
        }
    }

    #[test]
    fn bad_bodies() {
        let steep = Surface::PowerLaw { coefficient: 1e300, exponent: 3.0, size: 1e150.into() };
        assert!(matches!(PowerLawBody.prepare(&Scene::new(steep, 1.0), 0), Err(Error::Domain { .. })));
        let square = Scene::new(Surface::Flat { size: 1.0.into() }, 1.0);
        assert!(matches!(PowerLawBody.prepare(&square, 0), Err(Error::Unsupported { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(32) })]

        #[test]
        fn curve_and_exponent(n in 0.1_f64..6.0, c in 0.05_f64..5.0, a in 1e-2_f64..0.4) {
            let d = kappa(n).unwrap() * c * a.powf(n);
            let surface = |length: f64| Surface::PowerLaw { coefficient: c * length.powf(1.0 - n), exponent: n, size: length.into() };
            let scene = Scene::new(surface(1.0), 1.5);
            check_curve(&PowerLawBody, &scene, d);
            // The coefficient itself, c L^(1 - n), leaves f64 for larger n; at extreme lengths powf rounds
            // it.
            if n < 2.5 {
                scale_invariant(&PowerLawBody, surface, d, 1e-11);
            }
            let force = pressed(&PowerLawBody, &scene, Load::approach(d)).unwrap().force;
            let stiffness = |f| pressed(&PowerLawBody, &scene, Load::force(f)).unwrap().stiffness.unwrap();
            let alpha = (stiffness(force) / stiffness(force / 64.0)).ln() / 64.0_f64.ln();
            assert_relative_eq!(alpha, 1.0 / (n + 1.0), max_relative = 1e-12);
        }
    }
}
