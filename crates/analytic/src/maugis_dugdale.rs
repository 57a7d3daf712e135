//! Maugis: a sphere with a constant attraction up to a range (Dugdale's law), between JKR and DMT.

mod curve;

use crate::Hertz;
use crate::closed::{self, LoadLaw};
use crate::jkr::JkrPullOff;
use contact_model::{
    Abilities, Adhesion, AdhesionLaw, ContactModel, ContactState, Effect, Effects, Error,
    Nondimensionalisation, NormalLoad, PreparedContact, Result, ScaledState, Scaling, Scene, Size,
    SolveReport, Source,
};
use curve::{MaugisCurve, MaugisPoint};
use numerics::root;
use std::f64::consts::PI;

const NAME: &str = "maugis_dugdale";

/// The contact of a sphere with [`Adhesion::FiniteRange`] of [`AdhesionLaw::Dugdale`]: traction
/// `s0 = work/range` wherever the gap is below the range, that is between the contact radius a and the radius
/// c of the cohesive zone.
///
/// The bodies are in contact and are pressed further or pulled apart. Loads may therefore be negative, and
/// the state without load is the adhered contact. A force below that of the pull-off (between `-2 pi w R` of
/// a hard sphere and `-3/2 pi w R` of a soft one) is [`Error::OutOfRange`], and so is an approach below the
/// smallest of a stable contact. For hard spheres (lambda below 0.938) the contact radius decreases to 0
/// there; the attraction without contact beyond this point is not part of the model. A cohesive zone beyond
/// half the shorter side is out of range too.
///
/// The stiffness is the slope of the equilibrium curve, on which a and c both move ([`MaugisSphere::slope`]),
/// and it is absent at the pull-off under prescribed approach, where it has no bound. The stiffness at fixed
/// contact area, from which the conductance follows, is `2 E* a` as in [`crate::Jkr`], because the attraction
/// is constant and carries no current. The model takes [`contact_model::Surface::Sphere`]; adhesion that is
/// off, or without work, is Hertz's contact. A load costs one to two microseconds.
///
/// ```
/// use analytic::MaugisDugdale;
/// use contact_model::{Adhesion, AdhesionLaw, ContactModel, Load, Scene, Surface};
/// let mut scene = Scene::new(Surface::Sphere { radius: 1.0, size: 4.0.into() }, 1.0);
/// // Tabor's parameter work^(2/3)/range is 1.
/// scene.effects.adhesion = Adhesion::FiniteRange { work: 1e-3, range: 0.01, law: AdhesionLaw::Dugdale };
/// let mut contact = MaugisDugdale.prepare(&scene, 0)?;
/// // The pull-off force is 1.5854 pi w R = 0.0049807.
/// assert!(contact.solve(Load::force(-0.00498)).is_ok() && contact.solve(Load::force(-0.00499)).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct MaugisDugdale;

impl ContactModel for MaugisDugdale {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[Source {
            citation: "D. Maugis, J. Colloid Interface Sci. 150, 243 (1992)",
            what: "sphere with Dugdale's law of adhesion: Eqs. 6.15 to 6.17",
        }]
    }

    fn abilities(&self) -> Abilities {
        Abilities { effects: &[Effect::DugdaleAdhesion], ..closed::SPHERE }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        let (radius, size) = closed::sphere(self, scene)?;
        let sphere = match scene.effects.adhesion {
            Adhesion::FiniteRange { work, range, law: AdhesionLaw::Dugdale } if work > 0.0 => {
                MaugisSphere::new(radius, scene.contact_modulus, work, range)?
            }
            Adhesion::Off | Adhesion::FiniteRange { law: AdhesionLaw::Dugdale, .. } => {
                return Hertz.prepare(
                    &Scene { effects: Effects { adhesion: Adhesion::Off, ..scene.effects }, ..scene.clone() },
                    seed,
                );
            }
            other => return Err(Error::unsupported(NAME, format!("adhesion ({other:?})"))),
        };
        let scaling = Scaling::of_body(scene)?;
        Ok(closed::prepared(scaling.in_units(sphere.nondimensional), MaugisLaw { sphere, size }))
    }
}

/// The equilibrium curve of a sphere with Dugdale's law of adhesion as functions of its contact radius, and
/// the ends of the curve.
///
/// ```
/// use analytic::maugis_dugdale::MaugisSphere;
/// let sphere = MaugisSphere::new(1.0, 1.0, 1e-3, 0.01)?;
/// assert!((sphere.lambda() - 1.1272).abs() < 1e-4);
/// let pulled = sphere.pull_off_at_force()?;
/// assert!((pulled.force / (std::f64::consts::PI * 1e-3) + 1.5854).abs() < 1e-4);
/// assert!(sphere.slope(pulled.radius)?.abs() < 1e-9);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaugisSphere {
    /// Lengths in R, moduli in E*.
    nondimensional: Nondimensionalisation,
    curve: MaugisCurve,
    /// `(3 pi w R^2/(4 E*))^(1/3)` over R.
    unit: f64,
    /// `pi w/(E* R)`.
    force_unit: f64,
    /// ln s where the force is smallest.
    force_fold: f64,
    /// ln s where the approach is smallest; `None` where that is the contact of radius 0.
    approach_fold: Option<f64>,
}

impl MaugisSphere {
    /// Range of lambda in which the curve is tested. Far above 1 the curve approaches that of JKR, with
    /// relative differences of `0.3/lambda^2` in forces, radii and approaches. Far below 1 the pull-off force
    /// is `2 - 1.72 lambda^(3/2)` times `pi w R`, which tends to that of DMT at 0.
    pub const LAMBDA: std::ops::RangeInclusive<f64> = 1e-6..=1e6;

    /// Radius of curvature R > 0, modulus E* > 0, work of adhesion w > 0 (energy per area), range > 0 (a
    /// length).
    ///
    /// # Errors
    /// [`Error::Domain`] for a number that makes no sense, numbers that no `f64` holds, or a lambda outside
    /// [`MaugisSphere::LAMBDA`].
    pub fn new(radius: f64, contact_modulus: f64, work: f64, range: f64) -> Result<Self> {
        let nondimensional = Nondimensionalisation::new(contact_modulus, radius, radius)?;
        // A balanced product: work over E* alone may be out of the range of f64.
        let scaled = Nondimensionalisation::new(contact_modulus, radius, 1.0)?.force_in(work.max(0.0));
        if !(work.is_finite() && scaled.is_normal()) {
            return Err(Error::of_positive("work of adhesion", work));
        }
        if !(range > 0.0 && (range / radius).is_normal()) {
            return Err(Error::of_positive("range of adhesion", range));
        }
        let lambda = 2.0 * (9.0 / (16.0 * PI) * scaled).cbrt() * (scaled.cbrt() / (range / radius));
        if !Self::LAMBDA.contains(&lambda) {
            return Err(Error::domain("Maugis's parameter lambda", lambda, "from 1e-6 to 1e6"));
        }
        let curve = MaugisCurve { lambda };
        Ok(Self {
            nondimensional,
            curve,
            unit: (0.75 * PI * scaled).cbrt(),
            force_unit: PI * scaled,
            force_fold: root::between(MaugisCurve::LEAST, MaugisCurve::MOST, |x| curve.at(x).rates(lambda).0),
            approach_fold: (curve.end().rates(lambda).1 < 0.0).then(|| {
                root::between(MaugisCurve::LEAST, MaugisCurve::MOST, |x| curve.at(x).rates(lambda).1)
            }),
        })
    }

    /// Maugis's parameter `lambda = 2 s0 (R/(pi w K^2))^(1/3)` with `s0 = w/range` and `K = 4/3 E*`: 1.1272
    /// times Tabor's parameter `(R w^2/(E*^2 range^3))^(1/3)`.
    pub fn lambda(&self) -> f64 {
        self.curve.lambda
    }

    /// Force at a contact radius a, which may be 0.
    ///
    /// # Errors
    /// [`Error::Domain`] for a radius that is negative or not finite, or numbers that no `f64` holds.
    pub fn force(&self, contact_radius: f64) -> Result<f64> {
        self.nondimensional.force(self.force_of(&self.point(contact_radius)?))
    }

    /// Approach at a contact radius a, which may be 0.
    ///
    /// # Errors
    /// As [`MaugisSphere::force`].
    pub fn approach(&self, contact_radius: f64) -> Result<f64> {
        self.nondimensional.approach(self.approach_of(&self.point(contact_radius)?))
    }

    /// Outer radius c of the cohesive zone, where the gap is the range, at a contact radius a, which may be
    /// 0.
    ///
    /// # Errors
    /// As [`MaugisSphere::force`].
    pub fn cohesive_radius(&self, contact_radius: f64) -> Result<f64> {
        self.nondimensional.approach(self.unit * self.point(contact_radius)?.c)
    }

    /// `dF/dd` along the equilibrium curve, on which a and c both move: positive where the contact is stable
    /// under a prescribed force, negative where it is stable only under a prescribed approach. Without
    /// adhesion it would be `2 E* a`.
    ///
    /// It is `(dF/da)/(dd/da)`, each with the derivative of c that the implicit equation between a and c
    /// gives.
    ///
    /// # Errors
    /// As [`MaugisSphere::force`], and [`Error::Domain`] for a radius at or below that of the pull-off under
    /// prescribed approach where that is not 0: the slope has no bound there.
    pub fn slope(&self, contact_radius: f64) -> Result<f64> {
        let (force, approach) = self.point(contact_radius)?.rates(self.curve.lambda);
        if approach > 0.0 {
            self.nondimensional.stiffness(self.slope_of(force, approach))
        } else {
            let expected = "beyond that of the pull-off under prescribed approach";
            Err(Error::domain("contact radius", contact_radius, expected))
        }
    }

    /// Contact radius at a force, on the branch that is stable under a prescribed force.
    ///
    /// # Errors
    /// [`Error::Domain`] for a force that is not finite or a state that no `f64` holds, [`Error::OutOfRange`]
    /// below the pull-off force.
    pub fn radius_at_force(&self, force: f64) -> Result<f64> {
        self.radius_of(&self.at_force(force)?)
    }

    /// Contact radius at an approach, on the branch that is stable under a prescribed approach.
    ///
    /// # Errors
    /// [`Error::Domain`] for an approach that is not finite or a state that no `f64` holds,
    /// [`Error::OutOfRange`] below that of [`MaugisSphere::pull_off_at_approach`].
    pub fn radius_at_approach(&self, approach: f64) -> Result<f64> {
        self.radius_of(&self.at_approach(approach)?)
    }

    /// Pull-off under a prescribed force: the smallest force of the curve.
    ///
    /// # Errors
    /// [`Error::Domain`] for numbers that no `f64` holds.
    pub fn pull_off_at_force(&self) -> Result<JkrPullOff> {
        self.pull_off(&self.curve.at(self.force_fold))
    }

    /// The smallest approach of the curve. Above `lambda = 0.93795` the contact pulls off there; below it the
    /// contact radius is 0 there, and bodies that are drawn further apart attract each other without contact.
    ///
    /// # Errors
    /// As [`MaugisSphere::pull_off_at_force`].
    pub fn pull_off_at_approach(&self) -> Result<JkrPullOff> {
        self.pull_off(&self.least_approach())
    }

    fn pull_off(&self, point: &MaugisPoint) -> Result<JkrPullOff> {
        Ok(JkrPullOff {
            force: self.nondimensional.force(self.force_of(point))?,
            approach: self.nondimensional.approach(self.approach_of(point))?,
            radius: self.radius_of(point)?,
        })
    }

    fn least_approach(&self) -> MaugisPoint {
        self.approach_fold.map_or_else(|| self.curve.end(), |x| self.curve.at(x))
    }

    /// Force over E* R^2.
    fn force_of(&self, point: &MaugisPoint) -> f64 {
        self.force_unit * point.force(self.curve.lambda)
    }

    /// Approach over R.
    fn approach_of(&self, point: &MaugisPoint) -> f64 {
        self.unit * (self.unit * point.approach(self.curve.lambda))
    }

    /// `dF/dd` over E* R from [`MaugisPoint::rates`].
    fn slope_of(&self, force: f64, approach: f64) -> f64 {
        4.0 / 3.0 * self.unit * force / approach
    }

    /// The slope of a state; `None` at the pull-off under prescribed approach.
    fn slope_of_state(&self, point: &MaugisPoint) -> Option<f64> {
        /// `(dd/da)/a` without adhesion.
        const ELASTIC: f64 = 2.0;
        let (force, approach) = point.rates(self.curve.lambda);
        (approach > ELASTIC * closed::AT_FOLD).then(|| self.slope_of(force, approach))
    }

    fn radius_of(&self, point: &MaugisPoint) -> Result<f64> {
        self.nondimensional.approach(self.unit * point.a)
    }

    fn point(&self, contact_radius: f64) -> Result<MaugisPoint> {
        let a = self.nondimensional.length_in(contact_radius) / self.unit;
        if contact_radius.is_finite() && contact_radius >= 0.0 && a <= self.curve.at(MaugisCurve::LEAST).a {
            Ok(self.curve.at_radius(a))
        } else {
            Err(Error::of_non_negative("contact radius", contact_radius))
        }
    }

    fn at_force(&self, force: f64) -> Result<MaugisPoint> {
        if !force.is_finite() {
            return Err(Error::domain("force", force, "a finite number"));
        }
        let wanted = self.nondimensional.force_in(force) / self.force_unit;
        let lambda = self.curve.lambda;
        let fold = self.curve.at(self.force_fold);
        let least = fold.force(lambda);
        if wanted < least * closed::ROUNDED_UP {
            let smallest = self.nondimensional.force(self.force_of(&fold))?;
            return Err(NormalLoad::Force(force).pull_off(smallest));
        }
        if wanted <= least {
            return Ok(fold);
        }
        self.curve
            .above(self.force_fold, |point| point.force(lambda) - wanted)
            .ok_or_else(|| Error::not_representable("force", force))
    }

    fn at_approach(&self, approach: f64) -> Result<MaugisPoint> {
        if !approach.is_finite() {
            return Err(Error::domain("approach", approach, "a finite number"));
        }
        let wanted = self.nondimensional.approach_in(approach) / self.unit / self.unit;
        let lambda = self.curve.lambda;
        let end = self.least_approach();
        let least = end.approach(lambda);
        if wanted < least * closed::ROUNDED_UP {
            let min = self.nondimensional.approach(self.approach_of(&end))?;
            if self.approach_fold.is_some() {
                return Err(NormalLoad::Approach(approach).pull_off(min));
            }
            let name =
                "approach (the contact radius is 0; attraction without contact is not part of the model)";
            let name = name.into();
            return Err(Error::OutOfRange { name, value: approach, min, max: f64::INFINITY });
        }
        if wanted <= least {
            return Ok(end);
        }
        let from = self.approach_fold.unwrap_or(MaugisCurve::MOST);
        self.curve
            .above(from, |point| point.approach(lambda) - wanted)
            .ok_or_else(|| Error::not_representable("approach", approach))
    }
}

/// A sphere on a rectangle.
struct MaugisLaw {
    sphere: MaugisSphere,
    size: Size,
}

impl LoadLaw for MaugisLaw {
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState> {
        let sphere = &self.sphere;
        let point = match load.validated_with_adhesion()? {
            NormalLoad::Force(force) => sphere.at_force(force)?,
            NormalLoad::Approach(approach) => sphere.at_approach(approach)?,
            _ => return Err(Error::unsupported_load(NAME, load)),
        };
        let outer = scaling.nondimensional.approach(sphere.unit * point.c)?;
        self.size.admit_radius("outer radius of the cohesive zone", outer)?;
        let scaled = ScaledState {
            force: sphere.force_of(&point),
            approach: Some(sphere.approach_of(&point)),
            stiffness: sphere.slope_of_state(&point),
            ..closed::round(sphere.unit * point.a)
        };
        scaling.state(scaled, load, SolveReport::formula("closed form (Maugis-Dugdale)", load))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jkr::AdhesiveSphere;
    use crate::testing::{check_slope, pressed};
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::{Load, Surface};

    /// Roots in ln s, |ln s| < 20, and the cancellation of a^3 with the attraction.
    const ROOTS: f64 = 1e-12;
    const DUGDALE: AdhesionLaw = AdhesionLaw::Dugdale;

    fn scene(side: f64, (contact_modulus, radius): (f64, f64), work: f64, range: f64) -> Scene {
        let mut scene = Scene::new(Surface::Sphere { radius, size: side.into() }, contact_modulus);
        scene.effects.adhesion = Adhesion::FiniteRange { work, range, law: DUGDALE };
        scene
    }

    /// R = E* = 1 and this work, with the range that makes this lambda.
    fn with_lambda(work: f64, lambda: f64) -> MaugisSphere {
        let range = 2.0 * (9.0 / (16.0 * PI)).cbrt() * work.powf(2.0 / 3.0) / lambda;
        MaugisSphere::new(1.0, 1.0, work, range).unwrap()
    }

    fn lambdas() -> impl Iterator<Item = f64> {
        (-24..=24).map(|i| 10.0_f64.powf(0.2499 * f64::from(i)))
    }

    /// The equations as printed, m by bisection: `(m, F, d)`.
    fn printed(lambda: f64, a: f64) -> (f64, f64, f64) {
        let condition = |m: f64| {
            let (s, sec) = ((m * m - 1.0).sqrt(), m.recip().acos());
            0.5 * lambda * a * a * (s + (m * m - 2.0) * sec)
                + 4.0 / 3.0 * lambda * lambda * a * (s * sec - m + 1.0)
                - 1.0
        };
        let (mut low, mut high) = (1.0f64, 1e9f64);
        for _ in 0..200 {
            let middle = (low * high).sqrt();
            if condition(middle) < 0.0 { low = middle } else { high = middle }
        }
        let (m, s) = (low, (low * low - 1.0).sqrt());
        let force = a.powi(3) - lambda * a * a * (s + m * m * m.recip().acos());
        (m, force, a * a - 4.0 / 3.0 * lambda * a * s)
    }

    #[test]
    fn the_curve_is_that_of_the_printed_equations() {
        for lambda in [1e-3, 0.03, 0.3, 1.0, 3.0, 30.0] {
            let curve = MaugisCurve { lambda };
            for a in [0.01, 0.1, 0.5, 1.0, 2.0, 5.0] {
                let (m, force, approach) = printed(lambda, a);
                let point = curve.at_radius(a);
                // The printed terms cancel to 1e-16/(m - 1) in the condition.
                let lost = 1e-12 + 1e-14 / (m - 1.0);
                assert_relative_eq!(point.c / point.a, m, max_relative = lost);
                assert_abs_diff_eq!(point.force(lambda), force, epsilon = 10.0 * lost * (1.0 + a.powi(3)));
                assert_abs_diff_eq!(point.approach(lambda), approach, epsilon = 10.0 * lost * (1.0 + a * a));
            }
        }
    }

    /// Without Maugis's units: the displacement of a round contact from its line of springs (Popov, Hess,
    /// 2015), where the cohesive zone pulls with `2 s0 sqrt(c^2 - x^2)`.
    #[test]
    fn the_gap_at_the_end_of_the_cohesive_zone_is_the_range() {
        let (contact_modulus, radius, work) = (2.0, 3.0, 1e-3);
        for range in [3e-4, 3e-3, 0.03] {
            let sphere = MaugisSphere::new(radius, contact_modulus, work, range).unwrap();
            for a in [0.03, 0.1, 0.3, 0.5] {
                let (c, d) = (sphere.cohesive_radius(a).unwrap(), sphere.approach(a).unwrap());
                let (q, pull) = ((c * c - a * a).sqrt(), 2.0 * work / range / contact_modulus);
                assert_relative_eq!(d, a * a / radius - pull * q, epsilon = 1e-13);
                let asin = (a / c).asin();
                let inside = d * asin - (c * c * asin - a * q) / (2.0 * radius);
                let displacement = 2.0 / PI * (inside - pull * (c - a));
                assert_relative_eq!(c * c / (2.0 * radius) - d + displacement, range, epsilon = 1e-12);
                let springs = 2.0 * (d * a - a.powi(3) / (3.0 * radius));
                let zone = pull * (c * c * (a / c).acos() - a * q);
                assert_relative_eq!(
                    sphere.force(a).unwrap(),
                    contact_modulus * (springs - zone),
                    epsilon = 1e-12
                );
            }
        }
    }

    /// `(lambda, a, [c, F, d])` of the printed equations in Maugis's units, in 60-digit arithmetic.
    const TABLE: [(f64, f64, [f64; 3]); 11] = [
        (1e-3, 0.01, [35.682_000_621_589_1, -1.999_945_001_696_05, -0.047_475_998_960_429_9]),
        (1e-3, 2.0, [35.791_272_967_877_4, 5.987_935_148_755_69, 3.952_352_867_020_4]),
        (0.1, 0.5, [3.586_640_401_544_41, -1.893_333_598_940_18, -0.223_549_046_996_132]),
        (1.0, 0.02, [0.744_104_489_367_624, -0.869_721_391_386_69, -0.991_380_881_800_95]),
        (1.0, 1.0, [1.415_961_783_533_66, -1.579_627_020_601_83, -0.336_627_778_272_424]),
        (10.0, 100.0, [100.006_720_934_29, 997_681.075_686_877, 9_984.541_197_234_49]),
        (30.0, 1.0, [1.000_832_432_023_93, -1.450_033_181_474_23, -0.632_449_443_476_237]),
        (1e3, 1e-3, [0.001_000_750_187_452_17, -7.752_162_860_418_09e-5, -0.051_654_916_052_184_1]),
        (1e3, 0.7, [0.700_000_749_999_499, -1.091_574_037_362_9, -0.876_260_012_065_204]),
        (1e3, 1e3, [1_000.000_000_749_97, 999_922_541.832_94, 999_948.361_221_986]),
        (1e-3, 1e4, [10_003.041_123_583_1, 999_999_995_066.182, 99_999_999.671_145_5]),
    ];

    #[test]
    fn states_are_those_of_long_arithmetic() {
        for (lambda, a, [c, force, approach]) in TABLE {
            let point = MaugisCurve { lambda }.at_radius(a);
            // 15 digits are printed; a root in ln s, |ln s| < 20, leaves a few more roundings.
            let near = 3e-14;
            assert_relative_eq!(point.c, c, max_relative = near);
            assert_relative_eq!(point.force(lambda), force, max_relative = near);
            assert_relative_eq!(point.approach(lambda), approach, max_relative = near);
        }
        for (lambda, force) in [
            (1e-3, -1.999_945_692_184_31),
            (0.1, -1.950_594_892_123_43),
            (1.0, -1.600_734_911_254_09),
            (10.0, -1.501_624_860_426_36),
        ] {
            let pulled = with_lambda(1e-4, lambda).pull_off_at_force().unwrap();
            assert_relative_eq!(pulled.force / (PI * 1e-4), force, max_relative = 3e-14);
        }
    }

    #[test]
    fn reference_numbers() {
        let pull_off = |mu: f64| {
            let sphere = MaugisSphere::new(1.0, 1.0, 1e-6, 1e-4 / mu).unwrap();
            sphere.pull_off_at_force().unwrap().force / (PI * 1e-6)
        };
        // Those of `bem3d`'s test, from a table of a by 1e-3.
        assert_abs_diff_eq!(pull_off(0.1), -1.941_92, epsilon = 1e-5);
        assert_abs_diff_eq!(pull_off(0.3), -1.7936, epsilon = 1e-4);
        assert_abs_diff_eq!(pull_off(1.0), -1.5854, epsilon = 1e-4);
    }

    #[test]
    fn a_soft_sphere_is_jkr_and_a_hard_one_dmt() {
        let work = 1e-4;
        let jkr = AdhesiveSphere::new(1.0, 1.0, work).unwrap();
        let hertz = AdhesiveSphere::new(1.0, 1.0, 0.0).unwrap();
        for lambda in [10.0, 1e2, 1e3, 1e4, 1e5, 9e5] {
            let sphere = with_lambda(work, lambda);
            // Measured: 0.26/lambda^2 at most, ten times that of the slope near its zero; and a fold's
            // rounding.
            let near = 0.3 / (lambda * lambda) + 1e-11;
            let (here, there) = (sphere.pull_off_at_force().unwrap(), jkr.pull_off_at_force().unwrap());
            assert_relative_eq!(here.force, there.force, max_relative = near);
            let (here, there) = (sphere.pull_off_at_approach().unwrap(), jkr.pull_off_at_approach().unwrap());
            assert_relative_eq!(here.approach, there.approach, max_relative = near);
            for force in [-4e-4, 0.0, 1e-3] {
                let (here, there) = (sphere.radius_at_force(force), jkr.radius_at_force(force));
                assert_relative_eq!(here.unwrap(), there.unwrap(), max_relative = near);
            }
            let (here, there) = (sphere.slope(0.08).unwrap(), jkr.slope(0.08).unwrap());
            assert_relative_eq!(here, there, max_relative = 10.0 * near);
        }
        for lambda in [1e-3, 1e-4, 1e-5, 1.1e-6] {
            let sphere = with_lambda(work, lambda);
            let force_unit = PI * work;
            // c^2 = 4/(pi lambda) in the condition's second term leaves F = -2 + 16/3 (pi/2 - 1)
            // lambda^(3/2)/sqrt(pi).
            let pull_off = sphere.pull_off_at_force().unwrap().force / force_unit;
            let first = 16.0 / 3.0 * (0.5 * PI - 1.0) / PI.sqrt() * lambda.powf(1.5);
            assert_relative_eq!(pull_off + 2.0, first, max_relative = 2.0 * lambda + 1e-6);
            assert!(sphere.approach_fold.is_none() && sphere.pull_off_at_approach().unwrap().radius <= 0.0);
            // DMT, and the widening of the cohesive zone, c^2 = 4/(pi lambda) + 2 a^2: a^3 - 2 - pi lambda
            // a^2.
            for a in [0.1, 0.5, 1.0, 5.0] {
                let attraction = (hertz.force(a * sphere.unit).unwrap()
                    - sphere.force(a * sphere.unit).unwrap())
                    / force_unit;
                let next = 2.0 * lambda.powf(1.5) * (1.0 + a.powi(3)) + 1e-12;
                assert_abs_diff_eq!(attraction, 2.0 + PI * lambda * a * a, epsilon = next);
            }
        }
    }

    /// On each branch force and approach have one fold at most: what the brackets of loads rest on.
    #[test]
    fn folds_are_unique() {
        for lambda in lambdas() {
            let sphere = with_lambda(1e-4, lambda);
            let (mut force, mut approach) = (0, 0);
            let mut last = sphere.curve.end().rates(lambda);
            assert!(last.0 < 0.0);
            for i in 0..=20_000 {
                let x =
                    MaugisCurve::MOST + (MaugisCurve::LEAST - MaugisCurve::MOST) * f64::from(i) / 20_000.0;
                let rates = sphere.curve.at(x).rates(lambda);
                force += i32::from((rates.0 > 0.0) != (last.0 > 0.0));
                approach += i32::from((rates.1 > 0.0) != (last.1 > 0.0));
                last = rates;
            }
            assert!(last.0 > 0.0 && last.1 > 0.0);
            assert_eq!((force, approach), (1, i32::from(sphere.approach_fold.is_some())), "{lambda}");
            assert_eq!(lambda > 0.937_95, sphere.approach_fold.is_some(), "{lambda}");
        }
    }

    #[test]
    fn the_slope_is_that_of_differences() {
        for lambda in lambdas() {
            let sphere = with_lambda(1e-4, lambda);
            for scale in [0.3, 0.8, 1.2, 2.0, 5.0, 30.0] {
                let a = scale * sphere.unit;
                let Ok(slope) = sphere.slope(a) else { continue };
                // Central differences in a: their error is e^2 times moderate numbers, and rounding over e.
                let e = 1e-4;
                let (low, high) = (a * (1.0 - e), a * (1.0 + e));
                let force = sphere.force(high).unwrap() - sphere.force(low).unwrap();
                let approach = sphere.approach(high).unwrap() - sphere.approach(low).unwrap();
                assert_relative_eq!(force / approach, slope, max_relative = 1e-5, epsilon = 1e-6 * a);
            }
        }
    }

    #[test]
    fn both_loads_go_back_to_the_contact_radius() {
        for lambda in lambdas() {
            let sphere = with_lambda(1e-4, lambda);
            let [by_force, by_approach] =
                [sphere.pull_off_at_force(), sphere.pull_off_at_approach()].map(|p| p.unwrap().radius);
            for scale in [0.1, 0.5, 0.9, 1.0, 1.5, 3.0, 10.0, 1e3] {
                let a = scale * sphere.unit;
                // At a fold a root loses half its digits; a tenth away from it the loss is one digit. Far
                // from the end of a hard sphere the rounding of the constant attraction counts.
                let lost = |ratio: f64| 1e-12 + 1e-14 * ratio;
                if a > 1.1 * by_force {
                    let back = sphere.radius_at_force(sphere.force(a).unwrap()).unwrap();
                    assert_relative_eq!(back, a, max_relative = lost(scale.powi(-3)));
                    assert!(sphere.slope(a).unwrap() > 0.0);
                }
                if a > 1.1 * by_approach {
                    let back = sphere.radius_at_approach(sphere.approach(a).unwrap()).unwrap();
                    assert_relative_eq!(back, a, max_relative = lost(scale.powi(-2)));
                }
            }
        }
    }

    #[test]
    fn states_are_points_of_the_curve() {
        let scene = scene(4.0, (1.0, 1.0), 1e-3, 0.01);
        let sphere = MaugisSphere::new(1.0, 1.0, 1e-3, 0.01).unwrap();
        for load in [Load::force(-0.004), Load::force(0.0), Load::force(0.1), Load::approach(0.0)] {
            let state = pressed(&MaugisDugdale, &scene, load).unwrap();
            let a = (state.area.unwrap() / PI).sqrt();
            assert_abs_diff_eq!(sphere.force(a).unwrap(), state.force, epsilon = ROOTS);
            assert_abs_diff_eq!(sphere.approach(a).unwrap(), state.approach.unwrap(), epsilon = ROOTS);
            assert_relative_eq!(state.stiffness.unwrap(), sphere.slope(a).unwrap(), max_relative = ROOTS);
            assert_relative_eq!(state.stiffness_fixed_area.unwrap(), 2.0 * a, max_relative = ROOTS);
        }
    }

    #[test]
    fn the_stiffness_is_the_slope_of_the_branch() {
        let work = 1e-4;
        for lambda in [1e-3, 0.1, 0.5, 0.9, 0.95, 1.5, 5.0, 100.0] {
            let sphere = with_lambda(work, lambda);
            let range = 2.0 * (9.0 / (16.0 * PI)).cbrt() * work.powf(2.0 / 3.0) / lambda;
            let scene = scene(200.0, (1.0, 1.0), work, range);
            let [by_force, by_approach] =
                [sphere.pull_off_at_force(), sphere.pull_off_at_approach()].map(Result::unwrap);
            for share in [-0.9, -0.5, 0.1, 1.0, 30.0] {
                check_slope(&MaugisDugdale, &scene, Load::force(share * by_force.force.abs()));
            }
            let start = by_approach.approach;
            for share in [0.05, 0.3, 0.9, 5.0] {
                check_slope(&MaugisDugdale, &scene, Load::approach(start + share * start.abs()));
            }
            let fold = pressed(&MaugisDugdale, &scene, Load::force(by_force.force)).unwrap();
            // Of hard spheres the radius there is a small part of the unit.
            assert_abs_diff_eq!(fold.stiffness.unwrap(), 0.0, epsilon = 1e-5 * sphere.unit);
            // A soft sphere pulls off at a slope without bound, a hard one comes down to its cohesive zone.
            let end = pressed(&MaugisDugdale, &scene, Load::approach(start)).unwrap();
            if sphere.approach_fold.is_some() {
                assert_eq!(end.stiffness, None);
                assert!(end.stiffness_fixed_area.unwrap() > 0.0);
            } else {
                assert_eq!((end.area, end.stiffness_fixed_area), (Some(0.0), Some(0.0)));
                // To the first order in the radius, which grows with the root of the approach.
                let quotient = |by: f64| {
                    let load = Load::approach(start + by * start.abs());
                    let next = pressed(&MaugisDugdale, &scene, load).unwrap();
                    (next.force - end.force) / (by * start.abs())
                };
                let slope = 2.0 * quotient(1e-8) - quotient(4e-8);
                assert_relative_eq!(end.stiffness.unwrap(), slope, max_relative = 1e-3);
            }
        }
    }

    #[test]
    fn beyond_the_ends_is_an_error_that_names_them() {
        // lambda = 1.13 pulls off; 0.011 comes down to a contact of radius 0.
        for (range, said) in [(0.01, "pulls off"), (1.0, "without contact")] {
            let scene = scene(40.0, (1.0, 1.0), 1e-3, range);
            let sphere = MaugisSphere::new(1.0, 1.0, 1e-3, range).unwrap();
            let (by_force, by_approach) =
                (sphere.pull_off_at_force().unwrap(), sphere.pull_off_at_approach().unwrap());
            assert!(pressed(&MaugisDugdale, &scene, Load::force(by_force.force)).is_ok());
            let end = pressed(&MaugisDugdale, &scene, Load::approach(by_approach.approach)).unwrap();
            assert_relative_eq!(end.force, by_approach.force, max_relative = ROOTS);
            let error =
                pressed(&MaugisDugdale, &scene, Load::approach(by_approach.approach * 1.001)).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains(said), "{error}");
            let error = pressed(&MaugisDugdale, &scene, Load::force(by_force.force * 1.001)).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("pulls off"));
            for load in [Load::force(f64::NAN), Load::approach(f64::INFINITY), Load::mean_gap(1.0)] {
                assert!(pressed(&MaugisDugdale, &scene, load).is_err());
            }
        }
        // The cohesive zone leaves the rectangle.
        let narrow = scene(0.4, (1.0, 1.0), 1e-3, 0.01);
        let error = pressed(&MaugisDugdale, &narrow, Load::approach(0.1)).unwrap_err();
        assert!(matches!(error, Error::OutOfRange { .. }) && error.to_string().contains("cohesive"));
        let sphere = with_lambda(1e-3, 3.0);
        assert!(sphere.slope(0.0).is_err() && sphere.force(-1.0).is_err() && sphere.force(f64::NAN).is_err());
        for (work, range) in [(0.0, 1.0), (-1.0, 1.0), (1.0, 0.0), (1.0, f64::NAN), (1.0, 1e9), (1.0, 1e-9)] {
            assert!(matches!(MaugisSphere::new(1.0, 1.0, work, range), Err(Error::Domain { .. })));
        }
    }

    #[test]
    fn other_laws_effects_and_surfaces_are_refused() {
        let good = scene(4.0, (1.0, 1.0), 1e-3, 0.01);
        let mut periodic = good.clone();
        periodic.effects.boundary = contact_model::Boundary::Periodic;
        let mut exponential = good.clone();
        exponential.effects.adhesion =
            Adhesion::FiniteRange { work: 1e-3, range: 0.01, law: AdhesionLaw::Exponential };
        let mut short = good.clone();
        short.effects.adhesion = Adhesion::ShortRange { work: 1e-3 };
        let mut hard = good.clone();
        hard.effects.hardness = contact_model::Hardness::Limit { pressure: 1.0 };
        let cone = Scene { surface: Surface::Cone { slope: 1.0, size: 1.0.into() }, ..good.clone() };
        let mut field = good.clone();
        field.outputs.pressure = true;
        for scene in [periodic, exponential, short, hard, cone, field] {
            assert!(matches!(MaugisDugdale.prepare(&scene, 0), Err(Error::Unsupported { .. })), "{scene:?}");
        }
    }

    #[test]
    fn without_work_it_is_hertz() {
        let bare = Scene::new(Surface::Sphere { radius: 1.3, size: 1.0.into() }, 2.0);
        for load in [Load::force(1e-3), Load::approach(0.01)] {
            let hertz = pressed(&Hertz, &bare, load).unwrap();
            let idle = scene(1.0, (2.0, 1.3), 0.0, 0.01);
            assert_eq!(pressed(&MaugisDugdale, &idle, load).unwrap(), hertz);
            assert_eq!(pressed(&MaugisDugdale, &bare, load).unwrap(), hertz);
        }
    }

    #[test]
    fn one_contact_in_any_units() {
        let at = |contact_modulus: f64, length: f64| {
            let scene = scene(
                4.0 * length,
                (contact_modulus, length),
                1e-3 * (contact_modulus * length),
                0.01 * length,
            );
            let force =
                Nondimensionalisation::new(contact_modulus, length, length).unwrap().force(0.004).unwrap();
            pressed(&MaugisDugdale, &scene, Load::force(-force)).unwrap()
        };
        let one = at(1.0, 1.0);
        for (contact_modulus, length) in [(1e150, 1e-150), (1e-150, 1e150), (1e11, 1e-3)] {
            let here = at(contact_modulus, length);
            let approach = here.approach.unwrap() / length;
            assert_relative_eq!(approach, one.approach.unwrap(), max_relative = ROOTS);
            let stiffness = here.stiffness.unwrap() / (contact_modulus * length);
            assert_relative_eq!(stiffness, one.stiffness.unwrap(), max_relative = ROOTS);
        }
    }

    /// The number itself, its neighbours, and itself after a multiplication and a division that are rounded.
    fn around(limit: f64) -> [f64; 4] {
        [limit, limit.next_down(), limit.next_up(), limit / 3.0 * 3.0]
    }

    #[test]
    fn a_load_at_the_pull_off_is_the_state_there() {
        /// Half the digits: what is left of a radius at an extremum of the load.
        const AT_EXTREMUM: f64 = 1e-6;
        /// Far more than the rounding at which a load still counts as that of the pull-off.
        const BEYOND: f64 = 1e-9;
        for i in 0..200 {
            let i = f64::from(i);
            let (radius, contact_modulus) = (0.31 + 0.0013 * i, 1.7 + 0.01 * i);
            let (work, range) = (1e-3 * (1.0 + 0.1 * i), 0.003 + 0.0026 * i);
            let sphere = MaugisSphere::new(radius, contact_modulus, work, range).unwrap();
            let scene = scene(40.0, (contact_modulus, radius), work, range);
            let [by_force, by_approach] =
                [sphere.pull_off_at_force(), sphere.pull_off_at_approach()].map(Result::unwrap);
            // Hard spheres come down to a radius of 0: what is left of it is a share of the cohesive zone.
            let near = AT_EXTREMUM * sphere.cohesive_radius(by_force.radius).unwrap();
            for force in around(by_force.force) {
                let found = sphere.radius_at_force(force).unwrap();
                assert_abs_diff_eq!(found, by_force.radius, epsilon = near);
                assert!(pressed(&MaugisDugdale, &scene, Load::force(force)).is_ok());
            }
            for approach in around(by_approach.approach) {
                let found = sphere.radius_at_approach(approach).unwrap();
                assert_abs_diff_eq!(found, by_approach.radius, epsilon = near);
                assert!(pressed(&MaugisDugdale, &scene, Load::approach(approach)).is_ok());
            }
            let beyond = by_force.force * (1.0 + BEYOND);
            let error = pressed(&MaugisDugdale, &scene, Load::force(beyond)).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { value, min, .. }
                if value.to_bits() == beyond.to_bits() && min.to_bits() == by_force.force.to_bits()));
            let beyond = by_approach.approach * (1.0 + BEYOND);
            let error = pressed(&MaugisDugdale, &scene, Load::approach(beyond)).unwrap_err();
            assert!(matches!(error, Error::OutOfRange { value, min, .. }
                if value.to_bits() == beyond.to_bits() && min.to_bits() == by_approach.approach.to_bits()));
        }
    }

    #[test]
    fn numbers_that_make_no_sense() {
        for lambda in [1e-3, 1.0, 1e3] {
            let sphere = with_lambda(1e-3, lambda);
            for a in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1.0, -5e-324, f64::MAX] {
                for outcome in
                    [sphere.force(a), sphere.approach(a), sphere.cohesive_radius(a), sphere.slope(a)]
                {
                    assert!(matches!(outcome, Err(Error::Domain { value, .. })
                        if value.to_bits() == a.to_bits()));
                }
            }
            // Radii from 0 to far below all lengths: one state.
            for a in [0.0, -0.0, 5e-324, 1e-310, 1e-200] {
                assert_eq!(sphere.force(a), sphere.force(0.0));
                assert_eq!(sphere.approach(a), sphere.approach(0.0));
                assert_eq!(sphere.cohesive_radius(a), sphere.cohesive_radius(0.0));
                assert_eq!(sphere.slope(a).is_ok(), sphere.approach_fold.is_none());
            }
            for load in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for outcome in [sphere.radius_at_force(load), sphere.radius_at_approach(load)] {
                    assert!(matches!(outcome, Err(Error::Domain { value, .. })
                        if value.to_bits() == load.to_bits()));
                }
            }
            for load in [-0.0, 5e-324, -5e-324] {
                assert_eq!(sphere.radius_at_force(load), sphere.radius_at_force(0.0));
                assert_eq!(sphere.radius_at_approach(load), sphere.radius_at_approach(0.0));
            }
            for outcome in [sphere.radius_at_force(f64::MIN), sphere.radius_at_approach(f64::MIN)] {
                assert!(matches!(outcome, Err(Error::OutOfRange { value: f64::MIN, .. })));
            }
            for outcome in [sphere.radius_at_force(f64::MAX), sphere.radius_at_approach(f64::MAX)] {
                assert!(matches!(outcome, Err(Error::Domain { value: f64::MAX, .. })));
            }
        }
    }

    /// The product counts, not its parts: work over E* is 1e-400 or 1e310 here.
    #[test]
    fn work_over_modulus_may_leave_the_range_of_f64() {
        for (radius, contact_modulus, work, range, share) in
            [(1e-100, 1e200, 1e-200, 1e-299, 0.1), (1e304, 1e-155, 1e155, 1e307, 10.0)]
        {
            let sphere = MaugisSphere::new(radius, contact_modulus, work, range).unwrap();
            let lambda = 2.0 * (9.0 / (16.0 * PI)).cbrt() * share;
            assert_relative_eq!(sphere.lambda(), lambda, max_relative = ROOTS);
        }
        // A work over E* R, or a range over R, of few digits.
        for (work, range) in [(1e-310, 1e-206), (1e-3, 1e-310), (5e-324, 1.0), (f64::INFINITY, 1.0)] {
            assert!(matches!(MaugisSphere::new(1.0, 1.0, work, range), Err(Error::Domain { .. })));
        }
    }

    /// Any outcome at any mixture of magnitudes is a finite state or an error about a number.
    #[test]
    fn extreme_magnitudes() {
        const MAGNITUDES: [f64; 9] = [5e-324, 1e-300, 1e-200, 1e-160, 1.0, 1e160, 1e200, 1e300, f64::MAX];
        let mut solved = 0;
        let check = |outcome: Result<f64>| match outcome {
            Ok(value) => assert!(value.is_finite()),
            Err(Error::Domain { value, .. } | Error::OutOfRange { value, .. }) => assert!(!value.is_nan()),
            Err(other) => panic!("{other}"),
        };
        for radius in MAGNITUDES {
            for contact_modulus in MAGNITUDES {
                for work in MAGNITUDES {
                    // Ranges of lambda = 1e-4, 1 and 1e4, where a number holds them.
                    let scaled = work.log10() - contact_modulus.log10() - radius.log10();
                    for lambda in [-4.0, 0.0, 4.0] {
                        let range = 10.0_f64.powf(scaled / 1.5 - lambda + radius.log10());
                        let Ok(sphere) = MaugisSphere::new(radius, contact_modulus, work, range) else {
                            continue;
                        };
                        for value in MAGNITUDES.into_iter().flat_map(|value| [value, -value]).chain([0.0]) {
                            check(sphere.force(value));
                            check(sphere.approach(value));
                            check(sphere.cohesive_radius(value));
                            check(sphere.slope(value));
                            check(sphere.radius_at_force(value));
                            check(sphere.radius_at_approach(value));
                            let mut scene = scene(20.0 * radius, (contact_modulus, radius), work, range);
                            for area in [true, false] {
                                (scene.outputs.area, scene.outputs.stiffness_fixed_area) = (area, area);
                                let Ok(mut contact) = MaugisDugdale.prepare(&scene, 0) else { continue };
                                for load in [Load::force(value), Load::approach(value)] {
                                    match contact.solve(load) {
                                        Ok(state) => {
                                            solved += 1;
                                            let values = [
                                                state.approach,
                                                state.stiffness,
                                                state.stiffness_fixed_area,
                                                state.area,
                                            ];
                                            assert!(values.iter().flatten().all(|value| value.is_finite()));
                                        }
                                        Err(error) => check(Err(error)),
                                    }
                                }
                            }
                        }
                    }
                }
            }
        }
        assert!(solved > 1000, "{solved}");
    }
}
