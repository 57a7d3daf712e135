//! Cattaneo and Mindlin: a sphere under a constant normal and a changing tangential load, with the memory of
//! Mindlin and Deresiewicz.

use crate::closed::{self, ROUNDED_UP};
use crate::hertz::Hertz;
use crate::memory::{SlipCurve, SlipLoad, held, lost, reached};
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Effects, Error, FrictionLaw, Load, NormalLoad,
    Normalisation, Outputs, Paths, PreparedContact, Result, Scene, Source, Step, Stop, Tangential,
    TangentialState, check_stop,
};

const NAME: &str = "cattaneo_mindlin";

/// A sphere with Coulomb's friction that is pressed first and then loaded tangentially, to and fro.
///
/// First loading: stick radius `c = a (1 - T/(mu F))^(1/3)`, displacement `u = 3 mu F/(4 G* a) (1 - (1 -
/// T/(mu F))^(2/3))`. After a reversal at `(T_r, u_r)` the curve is the first one, doubled: `u_r - u = 2
/// u_1((T_r - T)/2)`. When it closes the loop with an earlier reversal, it continues along the branch that
/// was left there (Mindlin and Deresiewicz 1953). The memory is the list of reversals whose loops are not
/// closed.
///
/// Takes [`contact_model::Surface::Sphere`] with friction by Coulomb's law ([`FrictionLaw::coulomb`]) and both
/// bodies ([`Scene::of_pair`]).
/// The normal load may change only before the first tangential one; a tangential force beyond mu F is
/// [`Error::OutOfRange`], a displacement beyond is gross slip. The theory neglects the influence of
/// tangential tractions on the normal ones. This is exact where [`contact_model::Pair::coupling`] is 0, and
/// otherwise an approximation with an error of that order.
///
/// ```
/// use analytic::CattaneoMindlin;
/// use contact_model::{Body, ContactModel, Friction, Load, Pair, Scene, Step, Surface, Tangential};
/// let body = Body::Elastic { young: 2.0, poisson: 0.3 };
/// let pair = Pair { first: body, second: body };
/// let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 2.0.into() }, pair)?;
/// scene.effects.friction = Friction::coulomb(0.5);
/// let mut contact = CattaneoMindlin.prepare(&scene, 0)?;
/// // Half of mu F: c/a = 0.5^(1/3) = 0.7937005260.
/// let state = contact.advance(Step::new(0.0, Load::force(0.01).with_tangential(Tangential::force_along_x(0.0025))))?;
/// let (Some(a), Some(tangential)) = (state.contact_radius, state.tangential) else { panic!("a round contact with friction") };
/// assert!((tangential.stick_radius.unwrap_or(0.0) / a - 0.7937005260).abs() < 1e-10);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CattaneoMindlin;

impl ContactModel for CattaneoMindlin {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "C. Cattaneo, Rend. Accad. Naz. Lincei 27, 342 (1938); R. D. Mindlin, J. Appl. Mech. 16, 259 (1949)",
                what: "stick radius and displacement of first loading",
            },
            Source {
                citation: "R. D. Mindlin, H. Deresiewicz, J. Appl. Mech. 20, 327 (1953)",
                what: "turns of the tangential load, energy of a cycle",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            effects: &[Effect::Friction],
            needs_effect: true,
            paths: Paths::Remembered,
            ..closed::SPHERE
        }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        closed::sphere(self, scene)?;
        let Some(FrictionLaw { coefficient, .. }) = scene.effects.friction.law() else {
            return Err(Error::unsupported(NAME, "a contact without friction"));
        };
        if coefficient <= 0.0 {
            return Err(Error::domain("coefficient of friction", coefficient, "a finite number > 0"));
        }
        let Some(pair) = scene.pair else {
            return Err(Error::unsupported(
                NAME,
                "a scene without both bodies: friction needs their shear moduli",
            ));
        };
        let elastic = Scene {
            effects: Effects::default(),
            outputs: Outputs { stiffness_fixed_area: true, ..scene.outputs },
            ..scene.clone()
        };
        Ok(Box::new(PreparedCattaneoMindlin {
            normal: ContactModel::prepare(&Hertz, &elastic, seed)?,
            shear_modulus: pair.shear_modulus()?,
            coefficient,
            outputs: scene.outputs,
            at: SlipPathEnd::default(),
        }))
    }
}

/// A sphere under a constant normal load, first loading: everything in the caller's units.
///
/// ```
/// use analytic::cattaneo_mindlin::SlidingSphere;
/// // mu F = 1, a = 1, G* = 3/4: u = 1 - (1 - T)^(2/3), c = (1 - T)^(1/3).
/// let sphere = SlidingSphere::new(2.0, 0.5, 1.0, 0.75)?;
/// assert!((sphere.displacement(0.875)? - 0.75).abs() < 1e-15);
/// assert!((sphere.stick_radius(0.875)? - 0.5).abs() < 1e-15);
/// assert!((sphere.force(0.75)? - 0.875).abs() < 1e-15);
/// // Full slip: 4 x 3/10 of mu F u.
/// assert!((sphere.energy_per_cycle(1.0)? - 0.8).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SlidingSphere {
    /// mu F.
    limit: f64,
    /// `3 mu F/(4 G* a)`: the displacement at which gross slip begins.
    reach: f64,
    contact_radius: f64,
}

impl SlidingSphere {
    /// Normal force F > 0, coefficient mu > 0, contact radius a > 0, shear modulus G* > 0 of the pair
    /// ([`contact_model::Pair::shear_modulus`]).
    ///
    /// # Errors
    /// [`Error::Domain`] for a number that is not finite and positive, or a `mu F` or `mu F/(G* a)` that no
    /// `f64` holds.
    pub fn new(force: f64, coefficient: f64, contact_radius: f64, shear_modulus: f64) -> Result<Self> {
        let limit = coefficient * force;
        let reach = 0.75 * limit / contact_radius / shear_modulus;
        for (name, value) in [
            ("force", force),
            ("coefficient of friction", coefficient),
            ("contact radius", contact_radius),
            ("shear_modulus", shear_modulus),
            ("mu F", limit),
            ("mu F/(G* a)", reach),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::domain(name, value, "a finite number > 0"));
            }
        }
        Ok(Self { limit, reach, contact_radius })
    }

    /// `c = a (1 - |T|/(mu F))^(1/3)`.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a tangential force beyond mu F, [`Error::Domain`] for one that is not finite.
    pub fn stick_radius(&self, tangential_force: f64) -> Result<f64> {
        Ok(self.contact_radius * (1.0 - self.share(tangential_force)?.abs()).cbrt())
    }

    /// `u = 3 mu F/(4 G* a) (1 - (1 - T/(mu F))^(2/3))`, odd in T.
    ///
    /// # Errors
    /// As [`SlidingSphere::stick_radius`].
    pub fn displacement(&self, tangential_force: f64) -> Result<f64> {
        let t = self.share(tangential_force)?;
        Ok(self.reach * reached(t.abs()).copysign(t))
    }

    /// The inverse: `T = mu F (1 - (1 - u/u_slip)^(3/2))`, mu F beyond `u_slip = 3 mu F/(4 G* a)`.
    ///
    /// # Errors
    /// [`Error::Domain`] for a displacement that is not finite.
    pub fn force(&self, tangential_displacement: f64) -> Result<f64> {
        if !tangential_displacement.is_finite() {
            return Err(Error::domain("tangential displacement", tangential_displacement, "a finite number"));
        }
        let u = tangential_displacement / self.reach;
        Ok(self.limit * held(u.abs().min(1.0)).copysign(u))
    }

    /// Energy that a cycle between -T and T dissipates:
    /// `(24/5) mu F u_slip (1 - (1 - t)^(5/3) - (5 t/6) (1 + (1 - t)^(2/3)))` with `t = T/(mu F)`.
    ///
    /// For small t it is `(4/27) mu F u_slip t^3`; the closed form cancels there and a series is taken. First
    /// loading dissipates a quarter of it.
    ///
    /// # Errors
    /// As [`SlidingSphere::stick_radius`].
    pub fn energy_per_cycle(&self, tangential_force: f64) -> Result<f64> {
        let t = self.share(tangential_force)?.abs();
        Ok(4.0 * self.limit * self.reach * lost(t))
    }

    fn share(&self, tangential_force: f64) -> Result<f64> {
        if !tangential_force.is_finite() {
            return Err(Error::domain("tangential force", tangential_force, "a finite number"));
        }
        let share = tangential_force / self.limit;
        if share.abs() <= ROUNDED_UP {
            return Ok(share.clamp(-1.0, 1.0));
        }
        Err(Error::gross_slip(tangential_force, self.limit))
    }
}

/// Current state of the history.
#[derive(Debug, Clone, Default)]
struct SlipPathEnd {
    time: f64,
    /// Normal state and the sphere under it, once there is one.
    pressed: Option<(ContactState, Option<SlidingSphere>)>,
    curve: SlipCurve,
}

struct PreparedCattaneoMindlin {
    normal: Box<dyn PreparedContact>,
    shear_modulus: f64,
    coefficient: f64,
    outputs: Outputs,
    at: SlipPathEnd,
}

impl PreparedCattaneoMindlin {
    /// The state under the normal load, with its contact radius.
    fn press(&mut self, load: NormalLoad) -> Result<(ContactState, Option<SlidingSphere>)> {
        let mut state = self.normal.solve(load.into())?;
        // k = 2 E* a of the round area.
        let radius =
            0.5 * state.stiffness_fixed_area.unwrap_or(0.0) / self.normal.normalisation().contact_modulus;
        state.stiffness_fixed_area = state.stiffness_fixed_area.filter(|_| self.outputs.stiffness_fixed_area);
        if !self.outputs.needs_stiffness() {
            state.report.certificate.stiffness_error = None;
        }
        let sphere = if state.force > 0.0 {
            Some(SlidingSphere::new(state.force, self.coefficient, radius, self.shear_modulus)?)
        } else {
            None
        };
        Ok((state, sphere))
    }
}

/// A normal load that comes back through a conversion is the same one.
const SAME: f64 = 1e-12;

impl PreparedContact for PreparedCattaneoMindlin {
    fn normalisation(&self) -> Normalisation {
        self.normal.normalisation()
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        check_stop(stop)?;
        let Step { time, load: Load { normal, tangential: tangential_load } } =
            step.validated(self.at.time)?;
        tangential_load.refuse_y(NAME)?;
        let (state, sphere) = self.press(normal)?;
        let unloaded = self.at.curve == SlipCurve::default();
        if let (Some((last, _)), false) = (&self.at.pressed, unloaded)
            && (state.force - last.force).abs() > SAME * last.force
        {
            let what = "a change of the normal load after a tangential one (the theory holds it constant)";
            return Err(Error::unsupported(NAME, what));
        }
        // After a tangential load the first normal state stays, to the last digit.
        let (state, sphere) = match &self.at.pressed {
            Some(pressed) if !unloaded => pressed.clone(),
            _ => (state, sphere),
        };
        let mut curve = self.at.curve.clone();
        let tangential = if let Some(sphere) = sphere {
            curve.go(match tangential_load {
                Tangential::Force([force, _]) => SlipLoad::Force(sphere.share(force)?),
                Tangential::Displacement([u, _]) => SlipLoad::Displacement(u / sphere.reach),
                other => return Err(Error::unsupported_load(NAME, other)),
            });
            let (force, displacement) = match tangential_load {
                Tangential::Force([force, _]) => (force, curve.now.u * sphere.reach),
                Tangential::Displacement([u, _]) => (curve.now.t * sphere.limit, u),
                other => return Err(Error::unsupported_load(NAME, other)),
            };
            TangentialState::new([force, 0.0], [displacement, 0.0])
                .with_sliding_force(sphere.limit)
                .with_stick_radius(curve.stick() * sphere.contact_radius)
                .with_dissipated(curve.dissipated * sphere.limit * sphere.reach)
        } else {
            if !tangential_load.is_zero() {
                let what = "a tangential load without a normal one";
                return Err(Error::unsupported(NAME, what));
            }
            TangentialState::new([0.0; 2], [0.0; 2]).with_sliding_force(0.0).with_stick_radius(0.0)
        };
        self.at = SlipPathEnd { time, pressed: Some((state.clone(), sphere)), curve };
        let radius = sphere.map_or(0.0, |sphere| sphere.contact_radius);
        Ok(state.with_time(time).with_contact_radius(radius).with_tangential(tangential))
    }

    fn restart(&mut self) {
        self.at = SlipPathEnd::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{PRINTED, ROUNDING};
    use approx::{assert_abs_diff_eq, assert_relative_eq};
    use contact_model::{Body, Friction, Load, Pair, Surface};
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    const MU: f64 = 0.4;
    const FORCE: f64 = 0.01;

    fn scene(mu: f64) -> Scene {
        let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 0.75, poisson: 0.5 } };
        let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 2.0.into() }, pair).unwrap();
        scene.effects.friction = Friction::coulomb(mu);
        scene
    }

    fn at(tangential: Tangential) -> Step {
        Step::new(0.0, Load::force(FORCE).with_tangential(tangential))
    }

    fn tangential(contact: &mut dyn PreparedContact, load: Tangential) -> TangentialState {
        contact.advance(at(load)).unwrap().tangential.unwrap()
    }

    #[test]
    fn reference_numbers() {
        // data/paper/VALUES.md.
        for (share, ratio) in [(0.25, 0.908_560_296_4), (0.5, 0.793_700_526_0), (0.9, 0.464_158_883_4)] {
            let mut contact = CattaneoMindlin.prepare(&scene(MU), 0).unwrap();
            let state = contact.advance(at(Tangential::force_along_x(share * MU * FORCE))).unwrap();
            let stick = state.tangential.unwrap().stick_radius.unwrap();
            assert_relative_eq!(stick / state.contact_radius.unwrap(), ratio, max_relative = 2.0 * PRINTED);
            assert!(state.stiffness.is_some() && state.area.is_none());
        }
    }

    #[test]
    fn a_light_load_does_not_slip() {
        // k_x = 2 G* a, G* = (2/3) E* for nu = 1/2. Friction without end is the same limit.
        for (mu, force) in [(MU, 1e-9), (1e9, 1e-3)] {
            let mut contact = CattaneoMindlin.prepare(&scene(mu), 0).unwrap();
            let state = contact.advance(at(Tangential::force_along_x(force))).unwrap();
            let (a, tangential) = (state.contact_radius.unwrap(), state.tangential.unwrap());
            let stiffness = tangential.force[0] / tangential.displacement[0];
            assert_relative_eq!(stiffness, 2.0 * 2.0 / 3.0 * a, max_relative = 1e-6);
            assert_relative_eq!(tangential.stick_radius.unwrap(), a, max_relative = 1e-6);
        }
    }

    #[test]
    fn the_energy_and_its_series() {
        // Both forms where they meet, t^3/27 for small loads, 1/5 in full slip.
        assert_relative_eq!(lost(0.3 - 1e-12), lost(0.3 + 1e-12), max_relative = 1e-9);
        assert_relative_eq!(lost(1e-6), 1e-18 / 27.0, max_relative = 1e-5);
        assert_relative_eq!(lost(1.0), 0.2, max_relative = ROUNDING);
        assert!(lost(0.0) <= 0.0);
    }

    #[test]
    fn a_cycle_closes_and_dissipates_what_mindlin_and_deresiewicz_say() {
        let mut contact = CattaneoMindlin.prepare(&scene(MU), 0).unwrap();
        let top = 0.7 * MU * FORCE;
        let first = tangential(&mut *contact, Tangential::force_along_x(top));
        let mut points = vec![(first.force[0], first.displacement[0])];
        // To -T and back in small steps; the area of the loop by trapezoids.
        let steps = 2000;
        for i in 1..=2 * steps {
            let phase = f64::from(i) / f64::from(steps);
            let force = if phase <= 1.0 { top * (1.0 - 2.0 * phase) } else { top * (2.0 * phase - 3.0) };
            let state = tangential(&mut *contact, Tangential::force_along_x(force));
            points.push((state.force[0], state.displacement[0]));
        }
        let area: f64 = points.windows(2).map(|w| 0.5 * (w[0].0 + w[1].0) * (w[1].1 - w[0].1)).sum();
        let last = tangential(&mut *contact, Tangential::force_along_x(top));
        assert_relative_eq!(last.displacement[0], first.displacement[0], max_relative = 1e-12);
        let state = contact.advance(at(Tangential::force_along_x(top))).unwrap();
        let sphere = SlidingSphere::new(FORCE, MU, state.contact_radius.unwrap(), 2.0 / 3.0).unwrap();
        let energy = sphere.energy_per_cycle(top).unwrap();
        assert_relative_eq!(area, energy, max_relative = 1e-5);
        assert_relative_eq!(last.dissipated - first.dissipated, energy, max_relative = 1e-10);
        assert_relative_eq!(first.dissipated, energy / 4.0, max_relative = 1e-12);
    }

    #[test]
    fn gross_slip_and_the_way_back() {
        let mut contact = CattaneoMindlin.prepare(&scene(MU), 0).unwrap();
        assert!(matches!(
            contact.advance(at(Tangential::force_along_x(1.01 * MU * FORCE))),
            Err(Error::OutOfRange { .. })
        ));
        // A failed step leaves no trace.
        let reach = tangential(&mut *contact, Tangential::force_along_x(MU * FORCE)).displacement[0];
        let slid = tangential(&mut *contact, Tangential::displacement_along_x(3.0 * reach));
        assert_relative_eq!(slid.force[0], MU * FORCE, max_relative = ROUNDING);
        assert!(slid.stick_radius.unwrap() <= 0.0);
        // 1/5 of mu F u_slip before, mu F times the way after.
        assert_relative_eq!(slid.dissipated, MU * FORCE * reach * 2.2, max_relative = 1e-12);
        // Back by twice the reach: full slip the other way.
        let back = tangential(&mut *contact, Tangential::displacement_along_x(reach));
        assert_relative_eq!(back.force[0], -MU * FORCE, max_relative = 1e-12);
        let on = tangential(&mut *contact, Tangential::displacement_along_x(-reach));
        assert_relative_eq!(on.dissipated, slid.dissipated + MU * FORCE * reach * 2.4, max_relative = 1e-12);
        contact.restart();
        let again = tangential(&mut *contact, Tangential::displacement_along_x(reach));
        assert_relative_eq!(again.force[0], MU * FORCE, max_relative = 1e-12);
    }

    #[test]
    fn what_the_theory_does_not_cover_is_refused() {
        let mut contact = CattaneoMindlin.prepare(&scene(MU), 0).unwrap();
        let alone = Step::new(0.0, Load::force(0.0).with_tangential(Tangential::force_along_x(1.0)));
        assert!(matches!(contact.advance(alone), Err(Error::Unsupported { .. })));
        // The normal load may change while there is nothing tangential.
        for force in [0.0, 0.02, FORCE] {
            contact.advance(Step::new(0.0, Load::force(force))).unwrap();
        }
        tangential(&mut *contact, Tangential::force_along_x(1e-4));
        let heavier = Step::new(0.0, Load::force(0.02).with_tangential(Tangential::force_along_x(1e-4)));
        assert!(matches!(contact.advance(heavier), Err(Error::Unsupported { .. })));
        let early = Step { time: -1.0, ..at(Tangential::force_along_x(0.0)) };
        assert!(matches!(contact.advance(early), Err(Error::Domain { .. })));

        let refused = |scene: &Scene| CattaneoMindlin.prepare(scene, 0).map(|_| ()).unwrap_err();
        assert!(refused(&Scene { pair: None, ..scene(MU) }).to_string().contains("both bodies"));
        let mut smooth = scene(MU);
        smooth.effects.friction = Friction::Off;
        assert!(matches!(refused(&smooth), Error::Unsupported { .. }));
        let mut sticky = scene(MU);
        sticky.effects.adhesion = contact_model::Adhesion::ShortRange { work: 0.1 };
        assert!(matches!(refused(&sticky), Error::Unsupported { .. }));
        let cone = Scene { surface: Surface::Cone { slope: 0.1, size: 1.0.into() }, ..scene(MU) };
        assert!(matches!(refused(&cone), Error::Unsupported { .. }));
        assert!(matches!(refused(&scene(0.0)), Error::Domain { .. }));
        assert!(SlidingSphere::new(1.0, 0.5, 0.0, 1.0).is_err());
    }

    proptest! {
        #![proptest_config(ProptestConfig { rng_seed: RngSeed::Fixed(1), ..ProptestConfig::with_cases(64) })]

        /// Springs with Coulomb's limit, the picture behind the theory: `f = clamp(f + du, limit (1 - x^2))`.
        #[test]
        fn any_path_is_that_of_springs(path in proptest::collection::vec(-1.6_f64..1.6, 1..12)) {
            const SPRINGS: usize = 4000;
            let mut springs = vec![0.0; SPRINGS];
            let x = |i: usize| (i as f64 + 0.5) / SPRINGS as f64;
            let mut curve = SlipCurve::default();
            let (mut last, mut lost) = (0.0, 0.0);
            for u in path {
                curve.go(SlipLoad::Displacement(u));
                for (i, spring) in springs.iter_mut().enumerate() {
                    let limit = 1.0 - x(i) * x(i);
                    let free = *spring + u - last;
                    *spring = free.clamp(-limit, limit);
                    // mu F = (2/3) of limits of length 1.
                    lost += limit * (free - *spring).abs() * 1.5 / SPRINGS as f64;
                }
                last = u;
                let force = springs.iter().sum::<f64>() * 1.5 / SPRINGS as f64;
                // Midpoints over kinks: second order in 1/4000.
                assert_abs_diff_eq!(curve.now.t, force, epsilon = 1e-6);
                assert_abs_diff_eq!(curve.dissipated, lost, epsilon = 1e-6);
                prop_assert!(curve.now.t.abs() <= 1.0 && curve.turns.len() <= 12);
            }
        }

        /// Force and displacement drive the same curve.
        #[test]
        fn both_controls_agree(path in proptest::collection::vec(-0.99_f64..0.99, 1..12)) {
            let (mut by_force, mut by_displacement) = (SlipCurve::default(), SlipCurve::default());
            for t in path {
                by_force.go(SlipLoad::Force(t));
                by_displacement.go(SlipLoad::Displacement(by_force.now.u));
                assert_abs_diff_eq!(by_displacement.now.t, t, epsilon = 1e-12);
                assert_abs_diff_eq!(by_displacement.dissipated, by_force.dissipated, epsilon = 1e-12);
                assert_abs_diff_eq!(by_displacement.stick(), by_force.stick(), epsilon = 1e-4);
            }
        }
    }
}
