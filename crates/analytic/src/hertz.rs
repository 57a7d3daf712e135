//! Hertz: a sphere (paraboloid `z = r^2 / (2 R)`).

use crate::closed::{self, ClosedLaw, ClosedState};
use contact_model::{Abilities, ContactModel, PreparedContact, Result, Scene, Size, Source};

const NAME: &str = "hertz";

/// Hertz's contact of a sphere: `a^3 = 3 F R / (4 E*)`, `d = a^2 / R`, `k = 2 E* a`, `A = pi a^2` and the largest
/// pressure `p_0 = 2 E* a / (pi R)`.
///
/// Takes [`contact_model::Surface::Sphere`]; a contact radius beyond half the shorter side is
/// [`contact_model::Error::OutOfRange`].
///
/// ```
/// use analytic::Hertz;
/// use contact_model::{ContactModel, Load, Scene, Surface};
/// let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 3.0);
/// // d = 0.01: a = 0.1, F = (4/3) E* a^3 = 0.004.
/// let state = Hertz.prepare(&scene, 0)?.solve(Load::approach(0.01))?;
/// assert!((state.force - 0.004).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Hertz;

impl ContactModel for Hertz {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source {
            citation: "H. Hertz, J. reine angew. Math. 92, 156 (1882); K. L. Johnson, Contact Mechanics, Cambridge (1985)",
            what: "sphere: a, d, F, p (Johnson Eqs. 4.22 to 4.24)",
        }]
    }

    fn abilities(&self) -> Abilities {
        closed::SPHERE
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        let (radius, size) = closed::sphere(self, scene)?;
        let law = HertzSphere { radius: radius / size.length(), size };
        closed::of_body(scene, NAME, ("closed form (Hertz)", 0.0), law)
    }
}

/// `radius` in units of `L = size.length()`.
struct HertzSphere {
    radius: f64,
    size: Size,
}

impl ClosedLaw for HertzSphere {
    fn at_force(&self, force: f64) -> Result<ClosedState> {
        let contact = (0.75 * force * self.radius).cbrt();
        self.state(force, 0.75 * force / contact, contact)
    }

    fn at_approach(&self, approach: f64) -> Result<ClosedState> {
        let contact = (approach * self.radius).sqrt();
        self.state(4.0 / 3.0 * approach * contact, approach, contact)
    }

    fn unloaded(&self) -> ClosedState {
        ClosedState { largest_pressure: Some(0.0), ..ClosedState::round_unloaded() }
    }
}

impl HertzSphere {
    fn state(&self, force: f64, approach: f64, contact: f64) -> Result<ClosedState> {
        let largest_pressure = Some(std::f64::consts::FRAC_2_PI * contact / self.radius);
        Ok(ClosedState { largest_pressure, ..ClosedState::round(force, approach, contact, self.size)? })
    }
}

/// `p(r) = p_0 sqrt(1 - r^2 / a^2)` with `p_0 = 3 F / (2 pi a^2)`, in the unit of F/a^2; 0 outside (Hertz;
/// Johnson Eq. 4.24).
///
/// # Errors
/// [`contact_model::Error::Domain`] for a force that is negative or a contact radius that is not positive, or
/// not finite numbers.
///
/// ```
/// // F = 2 pi, a = 1: p_0 = 3, and at r = 0.6 it is 3 x 0.8.
/// assert!((analytic::hertz::pressure(std::f64::consts::TAU, 1.0, 0.6)? - 2.4).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn pressure(force: f64, contact_radius: f64, r: f64) -> Result<f64> {
    let x = crate::round::position(force, contact_radius, r)?;
    Ok(if x < 1.0 {
        1.5 * crate::round::mean_pressure(force, contact_radius) * (1.0 - x * x).sqrt()
    } else {
        0.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PRINTED, ROUNDING, check_curve, pressed, scale_invariant};
    use approx::assert_relative_eq;
    use contact_model::{Error, Load, Surface};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;
    use std::f64::consts::PI;

    #[test]
    fn reference_numbers() {
        let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 4.0.into() }, 1.0);
        let one = pressed(&Hertz, &scene, Load::force(1.0)).unwrap();
        let a = one.stiffness.unwrap() / 2.0;
        assert_relative_eq!(a, 0.908_560_296_416, max_relative = PRINTED);
        assert_relative_eq!(one.approach.unwrap(), 0.825_481_812_224, max_relative = PRINTED);
        assert_relative_eq!(pressure(1.0, a, 0.0).unwrap(), 0.578_407_449_087, max_relative = PRINTED);
        assert_relative_eq!(one.contact_radius.unwrap(), a, max_relative = ROUNDING);
        let largest = one.resolution.and_then(|resolution| resolution.largest_pressure).unwrap();
        assert_relative_eq!(largest, 0.578_407_449_087, max_relative = PRINTED);
        let none = pressed(&Hertz, &scene, Load::force(0.0)).unwrap();
        assert_eq!(none.contact_radius, Some(0.0));
        assert_eq!(none.resolution.and_then(|resolution| resolution.largest_pressure), Some(0.0));
        let small = pressed(&Hertz, &scene, Load::force(1e-3)).unwrap();
        assert_relative_eq!(small.stiffness.unwrap(), 2.0 * 0.090_856_029_642, max_relative = PRINTED);
        assert_relative_eq!(small.approach.unwrap(), 0.008_254_818_122, max_relative = PRINTED);
    }

    #[test]
    fn the_pressure_carries_the_force() {
        // int p 2 pi r dr by midpoints; the root at the edge makes it converge like h^1.5.
        let steps = 20_000;
        let sum: f64 = (0..steps)
            .map(|i| {
                let r = 0.3 * (f64::from(i) + 0.5) / f64::from(steps);
                pressure(2.0, 0.3, r).unwrap() * 2.0 * PI * r * 0.3 / f64::from(steps)
            })
            .sum();
        assert_relative_eq!(sum, 2.0, max_relative = 1e-5);
        assert!(pressure(1.0, 0.3, 0.31).unwrap() <= 0.0);
        assert!(pressure(1.0, 0.0, 0.0).is_err() && pressure(-1.0, 1.0, 0.0).is_err());
    }

    #[test]
    fn the_square_is_the_limit() {
        let scene = Scene::new(Surface::Sphere { radius: 1.0, size: 1.0.into() }, 1.0);
        assert!(pressed(&Hertz, &scene, Load::approach(0.25)).is_ok());
        assert!(matches!(pressed(&Hertz, &scene, Load::approach(0.26)), Err(Error::OutOfRange { .. })));
        let cone = Scene::new(Surface::Cone { slope: 1.0, size: 1.0.into() }, 1.0);
        assert!(matches!(Hertz.prepare(&cone, 0), Err(Error::Unsupported { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(32) })]

        #[test]
        fn curve(radius in 0.1_f64..10.0, d in 1e-8_f64..1e-2, contact_modulus in 0.1_f64..10.0) {
            let surface = |length: f64| Surface::Sphere { radius: radius * length, size: length.into() };
            check_curve(&Hertz, &Scene::new(surface(1.0), contact_modulus), d);
            scale_invariant(&Hertz, surface, d, ROUNDING);
        }
    }
}
