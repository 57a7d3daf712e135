//! Johnson, Kendall, Roberts: a sphere with short-range adhesion.

use crate::closed::{self, LoadLaw};
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Error, Nondimensionalisation, NormalLoad, PreparedContact,
    Result, ScaledState, Scaling, Scene, Size, SolveReport, Source,
};
use numerics::root;
use std::f64::consts::PI;

const NAME: &str = "jkr";

/// The JKR contact of a sphere with [`contact_model::Adhesion::ShortRange`]:
/// `F = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3)`, `d = a^2/R - sqrt(2 pi w a/E*)`.
///
/// The bodies are in contact and are pressed further or pulled apart. Loads may therefore be negative, and
/// the state without load is the adhered contact, not separation. (Bodies that approach each other jump into
/// this contact at d = 0.) A force below `-3/2 pi w R` or an approach below that of `F = -5/6 pi w R` is
/// [`Error::OutOfRange`], which names the pull-off and the smallest admissible load. So is a contact radius
/// beyond half the shorter side.
///
/// The stiffness is the slope of the equilibrium curve, on which the edge moves ([`AdhesiveSphere::slope`]):
/// 0 at the pull-off under prescribed force, negative beyond it, and absent at the pull-off under prescribed
/// approach, where it has no bound. The stiffness at fixed contact area, from which the conductance follows,
/// is `2 E* a`. The model takes [`contact_model::Surface::Sphere`]; adhesion that is off is w = 0, which is
/// Hertz's contact.
///
/// ```
/// use analytic::Jkr;
/// use contact_model::{Adhesion, ContactModel, Load, Scene, Surface};
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 4.0.into() }, 1.0);
/// scene.effects.adhesion = Adhesion::ShortRange { work: 0.01 };
/// let mut contact = Jkr.prepare(&scene, 0)?;
/// // At no load a^3 = 9 pi w R^2 / (2 E*): a = 0.5209397, d = a^2/(3 R).
/// let state = contact.solve(Load::force(0.0))?;
/// assert!((state.approach.unwrap_or(0.0) - 0.5209397_f64.powi(2) / 3.0).abs() < 1e-7);
/// // The stiffness is 3/5 of 2 E* a, that at fixed contact area.
/// assert!((state.stiffness.unwrap_or(0.0) - 1.2 * 0.5209397).abs() < 1e-7);
/// // 3/2 pi w R = 0.0471239.
/// assert!(contact.solve(Load::force(-0.0471)).is_ok() && contact.solve(Load::force(-0.0472)).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Jkr;

impl ContactModel for Jkr {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source {
            citation: "K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324, 301 (1971)",
            what: "sphere with short-range adhesion: a of F, pull-off",
        }]
    }

    fn abilities(&self) -> Abilities {
        Abilities { effects: &[Effect::ShortRangeAdhesion], ..closed::SPHERE }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        let (radius, size) = closed::sphere(self, scene)?;
        let work = closed::short_range_work(scene, NAME)?;
        let scaling = Scaling::of_body(scene)?;
        let sphere = AdhesiveSphere::new(radius, scene.contact_modulus, work)?;
        Ok(closed::prepared(scaling.in_units(sphere.nondimensional), JkrLaw { sphere, size }))
    }
}

/// The equilibrium curve of a sphere with adhesion as functions of its contact radius, and the ends of the
/// curve.
///
/// ```
/// use analytic::jkr::AdhesiveSphere;
/// let sphere = AdhesiveSphere::new(1.0, 1.0, 0.01)?;
/// let pulled = sphere.pull_off_at_force()?;
/// assert!((pulled.force + 1.5 * std::f64::consts::PI * 0.01).abs() < 1e-15);
/// assert!(sphere.slope(pulled.radius)?.abs() < 1e-12);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdhesiveSphere {
    /// Lengths in R, moduli in E*.
    nondimensional: Nondimensionalisation,
    /// `w / (E* R)`.
    work: f64,
}

/// The last stable state of a contact that is pulled.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JkrPullOff {
    /// Force, negative.
    pub force: f64,
    /// Approach.
    pub approach: f64,
    /// Contact radius.
    pub radius: f64,
}

impl AdhesiveSphere {
    /// Radius of curvature R > 0, modulus E* > 0, work of adhesion w >= 0 (energy per area).
    ///
    /// # Errors
    /// [`Error::Domain`] for a number that makes no sense, or a `w / (E* R)` that no `f64` holds.
    pub fn new(radius: f64, contact_modulus: f64, work: f64) -> Result<Self> {
        let nondimensional = Nondimensionalisation::new(contact_modulus, radius, radius)?;
        let scaled = work / contact_modulus / radius;
        if scaled.is_finite() && (scaled > 0.0 || (scaled >= 0.0 && work <= 0.0)) {
            Ok(Self { nondimensional, work: scaled })
        } else {
            Err(Error::of_non_negative("work of adhesion", work))
        }
    }

    /// `F = 4 E* a^3/(3 R) - sqrt(8 pi w E* a^3)` at a contact radius a.
    ///
    /// # Errors
    /// [`Error::Domain`] for a radius that is negative or not finite, or a force that no `f64` holds.
    pub fn force(&self, contact_radius: f64) -> Result<f64> {
        let a = self.radius_in(contact_radius)?;
        self.nondimensional.force(self.force_of(a))
    }

    /// `d = a^2/R - sqrt(2 pi w a/E*)` at a contact radius a.
    ///
    /// # Errors
    /// As [`AdhesiveSphere::force`].
    pub fn approach(&self, contact_radius: f64) -> Result<f64> {
        let a = self.radius_in(contact_radius)?;
        self.nondimensional.approach(self.approach_of(a))
    }

    /// `dF/dd` along the equilibrium curve: positive where the contact is stable under a prescribed force,
    /// negative where it is stable only under a prescribed approach.
    ///
    /// `2 E* a (1 - b) / (1 - b/3)` with `b = (3/4) sqrt(2 pi w R^2/(E* a^3))`; without adhesion 2 E* a.
    ///
    /// # Errors
    /// [`Error::Domain`] for a radius that is not finite or at or below that of the pull-off under prescribed
    /// approach, where the slope has no bound.
    pub fn slope(&self, contact_radius: f64) -> Result<f64> {
        let a = self.radius_in(contact_radius)?;
        let b = self.b(a);
        if !(a > 0.0 && b < 3.0) {
            let expected = "beyond that of the pull-off under prescribed approach";
            return Err(Error::domain("contact radius", contact_radius, expected));
        }
        self.nondimensional.stiffness(slope_of(a, b))
    }

    /// Contact radius at a force: `a^3 = 3 R/(4 E*) (sqrt(F + F_a) + sqrt(F_a))^2` with `F_a = 3/2 pi w R`.
    ///
    /// The printed `F + 3 pi w R + sqrt(6 pi w R F + (3 pi w R)^2)` is the same square, and cancels near the
    /// pull-off.
    ///
    /// # Errors
    /// [`Error::Domain`] for a force that is not finite, [`Error::OutOfRange`] below the pull-off force.
    pub fn radius_at_force(&self, force: f64) -> Result<f64> {
        if !force.is_finite() {
            return Err(Error::domain("force", force, "a finite number"));
        }
        self.nondimensional.approach(self.at_force(force)?)
    }

    /// Contact radius at an approach: the larger root of `d = a^2/R - sqrt(2 pi w a/E*)`.
    ///
    /// # Errors
    /// [`Error::Domain`] for an approach that is not finite, [`Error::OutOfRange`] below that of the
    /// pull-off.
    pub fn radius_at_approach(&self, approach: f64) -> Result<f64> {
        if !approach.is_finite() {
            return Err(Error::domain("approach", approach, "a finite number"));
        }
        self.nondimensional.approach(self.at_approach(approach)?)
    }

    /// Pull-off under a prescribed force: `F = -3/2 pi w R` at `a^3 = 9 pi w R^2/(8 E*)`.
    ///
    /// # Errors
    /// [`Error::Domain`] for numbers that no `f64` holds.
    pub fn pull_off_at_force(&self) -> Result<JkrPullOff> {
        self.pull_off((9.0 / 8.0 * PI * self.work).cbrt(), -1.5 * PI * self.work)
    }

    /// Pull-off under a prescribed approach: `F = -5/6 pi w R` at `a^3 = pi w R^2/(8 E*)`.
    ///
    /// # Errors
    /// As [`AdhesiveSphere::pull_off_at_force`].
    pub fn pull_off_at_approach(&self) -> Result<JkrPullOff> {
        self.pull_off(self.smallest_radius(), -5.0 / 6.0 * PI * self.work)
    }

    fn pull_off(&self, radius: f64, force: f64) -> Result<JkrPullOff> {
        Ok(JkrPullOff {
            force: self.nondimensional.force(force)?,
            approach: self.nondimensional.approach(self.approach_of(radius))?,
            radius: self.nondimensional.approach(radius)?,
        })
    }

    fn radius_in(&self, contact_radius: f64) -> Result<f64> {
        if contact_radius.is_finite() && contact_radius >= 0.0 {
            Ok(self.nondimensional.length_in(contact_radius))
        } else {
            Err(Error::domain("contact radius", contact_radius, "a finite number >= 0"))
        }
    }

    // From here on radii in R, forces in E* R^2.

    /// `(3/4) sqrt(2 pi w/(E* a^3))`: 1 at the pull-off under prescribed force, 3 at that under prescribed
    /// approach.
    fn b(&self, a: f64) -> f64 {
        0.75 * (2.0 * PI * self.work / a).sqrt() / a
    }

    /// The slope of a state; `None` at the pull-off under prescribed approach.
    fn slope_of_state(&self, a: f64) -> Option<f64> {
        if self.work <= 0.0 {
            return Some(2.0 * a);
        }
        let b = self.b(a);
        (1.0 - b / 3.0 > closed::AT_FOLD).then(|| slope_of(a, b))
    }

    fn force_of(&self, a: f64) -> f64 {
        a * (4.0 / 3.0 * a * a - (8.0 * PI * self.work * a).sqrt())
    }

    fn approach_of(&self, a: f64) -> f64 {
        a * a - (2.0 * PI * self.work * a).sqrt()
    }

    /// Contact radius at the pull-off under prescribed approach.
    fn smallest_radius(&self) -> f64 {
        (PI / 8.0 * self.work).cbrt()
    }

    /// Contact radius in R at a force.
    fn at_force(&self, force: f64) -> Result<f64> {
        let pull_off = 1.5 * PI * self.work;
        let scaled = self.nondimensional.force_in(force);
        if scaled < -pull_off * closed::ROUNDED_UP {
            return Err(NormalLoad::Force(force).pull_off(self.pull_off_at_force()?.force));
        }
        let root = (scaled + pull_off).max(0.0).sqrt() + pull_off.sqrt();
        Ok((0.75 * root * root).cbrt())
    }

    /// Contact radius in R at an approach.
    ///
    /// With `a = s^2` the equation `s^4 - c s - d = 0` is convex in s; Newton's steps from above its largest
    /// root only descend.
    fn at_approach(&self, approach: f64) -> Result<f64> {
        let d = self.nondimensional.approach_in(approach);
        let c = (2.0 * PI * self.work).sqrt();
        let fold = self.smallest_radius();
        let least = -0.75 * c * fold.sqrt();
        if d < least * closed::ROUNDED_UP {
            return Err(NormalLoad::Approach(approach).pull_off(self.pull_off_at_approach()?.approach));
        }
        if d <= least {
            return Ok(fold);
        }
        // Either c s or d is the larger of the two that make up s^4.
        let mut s = c.cbrt();
        if d > 0.0 {
            s = ((2.0 * d).sqrt().sqrt()).max((2.0 * c).cbrt());
        }
        let s = root::newton_from_above(s, |s| (s * (s * s * s - c) - d, 4.0 * s * s * s - c));
        Ok((s * s).max(fold))
    }
}

/// `dF/dd` along the curve, radii in R.
fn slope_of(a: f64, b: f64) -> f64 {
    2.0 * a * (1.0 - b) / (1.0 - b / 3.0)
}

/// A sphere on a rectangle.
struct JkrLaw {
    sphere: AdhesiveSphere,
    size: Size,
}

impl LoadLaw for JkrLaw {
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState> {
        let sphere = &self.sphere;
        let (a, asked) = match load.validated_with_adhesion()? {
            NormalLoad::Force(force) => (sphere.at_force(force)?, force),
            NormalLoad::Approach(approach) => (sphere.at_approach(approach)?, approach),
            _ => return Err(Error::unsupported_load(NAME, load)),
        };
        if !a.is_finite() || (a <= 0.0 && (asked.abs() > 0.0 || sphere.work > 0.0)) {
            return Err(Error::not_representable("contact radius over R", a));
        }
        self.size.admit_radius("contact radius", scaling.nondimensional.approach(a)?)?;
        let scaled = ScaledState {
            force: sphere.force_of(a),
            approach: Some(sphere.approach_of(a)),
            stiffness: sphere.slope_of_state(a),
            ..closed::round(a)
        };
        scaling.state(scaled, load, SolveReport::formula("closed form (JKR)", load))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PRINTED, ROUNDING, check_slope, pressed};
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::{Adhesion, Load, Surface};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    fn scene(side: f64, contact_modulus: f64, radius: f64, work: f64) -> Scene {
        let mut scene = Scene::new(Surface::Sphere { radius, size: side.into() }, contact_modulus);
        scene.effects.adhesion = Adhesion::ShortRange { work };
        scene
    }

    #[test]
    fn reference_numbers() {
        let sphere = AdhesiveSphere::new(1.0, 1.0, 0.01).unwrap();
        let by_force = sphere.pull_off_at_force().unwrap();
        assert_relative_eq!(by_force.force, -0.047_123_889_8, max_relative = 1e-9);
        assert_relative_eq!(sphere.radius_at_force(0.0).unwrap(), 0.520_939_707_9, max_relative = PRINTED);
        let by_approach = sphere.pull_off_at_approach().unwrap();
        assert_relative_eq!(by_approach.force, -0.026_179_938_8, max_relative = 2e-9);
        // Both are points of the curve itself.
        for point in [by_force, by_approach] {
            assert_relative_eq!(sphere.force(point.radius).unwrap(), point.force, max_relative = ROUNDING);
            assert_relative_eq!(
                sphere.approach(point.radius).unwrap(),
                point.approach,
                max_relative = ROUNDING
            );
        }
        // Pull-off under force: d = -(1/3) a^2/R there; under approach: -3 a^2/R.
        assert_relative_eq!(by_force.approach, -by_force.radius.powi(2) / 3.0, max_relative = ROUNDING);
        assert_relative_eq!(by_approach.approach, -3.0 * by_approach.radius.powi(2), max_relative = ROUNDING);
    }

    #[test]
    fn beyond_the_pull_off_is_an_error_that_names_it() {
        let scene = scene(4.0, 1.0, 1.0, 0.01);
        let sphere = AdhesiveSphere::new(1.0, 1.0, 0.01).unwrap();
        let (force, approach) =
            (sphere.pull_off_at_force().unwrap().force, sphere.pull_off_at_approach().unwrap().approach);
        assert!(pressed(&Jkr, &scene, Load::force(force)).is_ok());
        assert!(pressed(&Jkr, &scene, Load::approach(approach)).is_ok());
        for load in [Load::force(1.001 * force), Load::approach(1.001 * approach)] {
            let error = pressed(&Jkr, &scene, load).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("pulls off"));
        }
        assert!(matches!(pressed(&Jkr, &scene, Load::approach(4.0)), Err(Error::OutOfRange { .. })));
        assert!(pressed(&Jkr, &scene, Load::force(f64::NAN)).is_err());
        assert!(
            AdhesiveSphere::new(1.0, 1.0, -1.0).is_err() && AdhesiveSphere::new(1.0, 1.0, f64::NAN).is_err()
        );
        assert!(sphere.slope(0.0).is_err() && sphere.force(-1.0).is_err());
    }

    #[test]
    fn the_other_effects_are_refused() {
        let mut scene = scene(4.0, 1.0, 1.0, 0.01);
        scene.effects.boundary = contact_model::Boundary::Periodic;
        assert!(matches!(Jkr.prepare(&scene, 0), Err(Error::Unsupported { .. })));
        let cone = Scene::new(Surface::Cone { slope: 1.0, size: 1.0.into() }, 1.0);
        assert!(matches!(Jkr.prepare(&cone, 0), Err(Error::Unsupported { .. })));
    }

    #[test]
    fn without_adhesion_it_is_hertz() {
        let bare = Scene::new(Surface::Sphere { radius: 1.3, size: 1.0.into() }, 2.0);
        for load in [Load::force(1e-3), Load::approach(0.01), Load::force(0.0), Load::approach(0.0)] {
            let hertz = pressed(&crate::Hertz, &bare, load).unwrap();
            let here = pressed(&Jkr, &scene(1.0, 2.0, 1.3, 0.0), load).unwrap();
            assert_relative_eq!(here.force, hertz.force, max_relative = ROUNDING);
            assert_relative_eq!(here.approach.unwrap(), hertz.approach.unwrap(), max_relative = ROUNDING);
            assert_relative_eq!(here.stiffness.unwrap(), hertz.stiffness.unwrap(), max_relative = ROUNDING);
        }
        // And towards it as the root of the work: a^(3/2) = a_H^(3/2) + sqrt(9 pi w R^2/(8 E*)) + O(w).
        let gap = |work: f64| {
            let a = pressed(&Jkr, &scene(1.0, 1.0, 1.0, work), Load::force(1e-3)).unwrap();
            a.stiffness_fixed_area.unwrap() / (2.0 * 0.090_856_029_642) - 1.0
        };
        assert_relative_eq!(gap(1e-10) / gap(1e-12), 10.0, max_relative = 1e-2);
    }

    #[test]
    fn the_stiffness_is_the_slope_of_the_branch() {
        for work in [1e-6, 1e-3, 0.01] {
            let (scene, sphere) =
                (scene(4.0, 2.0, 1.0, 2.0 * work), AdhesiveSphere::new(1.0, 2.0, 2.0 * work).unwrap());
            let [by_force, by_approach] =
                [sphere.pull_off_at_force(), sphere.pull_off_at_approach()].map(Result::unwrap);
            for share in [-0.9, -0.5, -0.1, 0.1, 1.0, 30.0] {
                check_slope(&Jkr, &scene, Load::force(share * by_force.force.abs()));
            }
            for share in [-0.9, -0.5, -0.1, 0.3, 5.0] {
                check_slope(&Jkr, &scene, Load::approach(share * by_approach.approach.abs()));
            }
            // Where an approach alone holds the contact, the force rises as the bodies are drawn apart.
            let state = pressed(&Jkr, &scene, Load::approach(0.9 * by_approach.approach)).unwrap();
            assert!(state.stiffness.unwrap() < 0.0);
            // Without load a^3 = 9 pi w R^2/(2 E*), b = 1/2 and the slope 3/5 of 2 E* a.
            let state = pressed(&Jkr, &scene, Load::force(0.0)).unwrap();
            let ratio = state.stiffness.unwrap() / state.stiffness_fixed_area.unwrap();
            assert_relative_eq!(ratio, 0.6, max_relative = 1e-13);
            // The folds: no slope, and one without bound.
            let state = pressed(&Jkr, &scene, Load::force(by_force.force)).unwrap();
            assert_abs_diff_eq!(
                state.stiffness.unwrap() / state.stiffness_fixed_area.unwrap(),
                0.0,
                epsilon = ROUNDING
            );
            for approach in
                [by_approach.approach, by_approach.approach.next_down(), by_approach.approach.next_up()]
            {
                let state = pressed(&Jkr, &scene, Load::approach(approach)).unwrap();
                assert_eq!((state.stiffness, state.report.certificate.stiffness_error), (None, Some(0.0)));
                assert!(state.stiffness_fixed_area.unwrap() > 0.0);
            }
        }
    }

    #[test]
    fn one_contact_in_any_units() {
        let one = pressed(&Jkr, &scene(4.0, 1.0, 1.0, 0.01), Load::force(-0.04)).unwrap();
        for (contact_modulus, length) in [(1e150, 1e-150), (1e-150, 1e150), (1e11, 1e-3)] {
            let nondimensional = Nondimensionalisation::new(contact_modulus, length, length).unwrap();
            let scene = scene(4.0 * length, contact_modulus, length, 0.01 * (contact_modulus * length));
            let here = pressed(&Jkr, &scene, Load::force(-nondimensional.force(0.04).unwrap())).unwrap();
            assert_relative_eq!(
                here.approach.unwrap() / length,
                one.approach.unwrap(),
                max_relative = ROUNDING
            );
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(32) })]

        #[test]
        fn both_loads_go_back_to_the_contact_radius(a in 1e-3_f64..0.5, work in 1e-9_f64..1e-2) {
            let sphere = AdhesiveSphere::new(1.0, 1.0, work).unwrap();
            let (by_force, by_approach) = (sphere.pull_off_at_force().unwrap(), sphere.pull_off_at_approach().unwrap());
            // At a fold a root loses half its digits; a tenth away from it the loss is one digit.
            if a > 1.1 * by_force.radius {
                let back = sphere.radius_at_force(sphere.force(a).unwrap()).unwrap();
                assert_relative_eq!(back, a, max_relative = 1e-13);
                prop_assert!(sphere.slope(a).unwrap() > 0.0);
            }
            if a > 1.1 * by_approach.radius {
                let back = sphere.radius_at_approach(sphere.approach(a).unwrap()).unwrap();
                assert_relative_eq!(back, a, max_relative = 1e-13);
                // dF/dd by central differences in a, whose error is e^2 times moderate numbers.
                let e = 1e-5;
                let (low, high) = (a * (1.0 - e), a * (1.0 + e));
                let force = sphere.force(high).unwrap() - sphere.force(low).unwrap();
                let approach = sphere.approach(high).unwrap() - sphere.approach(low).unwrap();
                assert_relative_eq!(force / approach, sphere.slope(a).unwrap(), max_relative = 1e-6, epsilon = 1e-7 * a);
            }
        }

        /// The work done from the pull-off under approach to a state is what the elastic body and the
        /// surfaces have gained.
        #[test]
        fn energy(a in 0.3_f64..0.5, work in 1e-4_f64..1e-2) {
            let sphere = AdhesiveSphere::new(1.0, 1.0, work).unwrap();
            let start = sphere.pull_off_at_approach().unwrap().radius;
            // U(a) = int over springs E* (d - g)^2 dx - pi w a^2, with g = x^2: exact polynomials of a and d.
            let energy = |a: f64| {
                let d = sphere.approach(a).unwrap();
                2.0 * (d * d * a - 2.0 / 3.0 * d * a.powi(3) + a.powi(5) / 5.0) / 2.0 - PI * work * a * a
            };
            // Simpson in a, 400 pieces: error below 1e-10 of smooth functions.
            let steps = 400;
            let step = (a - start) / f64::from(steps);
            let integrand = |a: f64| {
                let slope = 2.0 * a - 0.5 * (2.0 * PI * work / a).sqrt();
                sphere.force(a).unwrap() * slope
            };
            let sum: f64 = (0..=steps)
                .map(|i| {
                    let weight = if i == 0 || i == steps { 1.0 } else if i % 2 == 1 { 4.0 } else { 2.0 };
                    weight * integrand(start + f64::from(i) * step)
                })
                .sum();
            assert_abs_diff_eq!(sum * step / 3.0, energy(a) - energy(start), epsilon = 1e-9);
        }
    }
}
