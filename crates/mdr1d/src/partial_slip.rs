//! [`PartialSlip`]: Coulomb's friction of axisymmetric bodies along any path.

use crate::axisymmetric::Profile;
use crate::body::RoundBody;
use crate::slip::Springs;
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Error, FrictionLaw, Load, Normalisation, Output, Paths,
    PreparedContact, Result, Scene, SolveReport, Source, Step, Stop, Tangential, check_stop,
};

const NAME: &str = "mdr1d_partial_slip";

/// Coulomb's friction of axisymmetric bodies through their profile, each spring sticking or slipping by
/// itself.
///
/// The model takes the bodies of [`Profile`] with friction by Coulomb's law ([`FrictionLaw::coulomb`]) and both
/// bodies' materials ([`Scene::of_pair`]), and any path of normal and tangential loads. A step goes straight from one pair of
/// approach and tangential displacement to the next; a step by force ends where the force is reached. The
/// state at its end, including the energy, is exact for the springs whatever the length of the step, because
/// nothing is discretised in x or along the path. The cost of a step is O(m) for m corners in the deflection
/// of the springs, at most two more per step; a step by tangential force costs about thirty times that.
/// Energies are results too, so units in which they leave f64 (lengths below 1e-100) are errors.
///
/// For the half-space the springs are exact in the approximation of Cattaneo, Mindlin, Jaeger and Ciavarella.
/// It neglects the influence of tangential tractions on the normal ones ([`contact_model::Pair::coupling`] is
/// 0, or neglected), and it assumes that slip has the direction of the load everywhere, which is not quite
/// true for nu > 0.
///
/// ```
/// use contact_model::{Body, Friction, ContactModel, Load, Pair, Scene, Step, Surface, Tangential};
/// let body = Body::Elastic { young: 2.0, poisson: 0.3 };
/// let pair = Pair { first: body, second: body };
/// let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 2.0.into() }, pair)?;
/// scene.effects.friction = Friction::coulomb(0.5);
/// let mut contact = mdr1d::PartialSlip.prepare(&scene, 0)?;
/// // Half of mu F: c/a = 0.5^(1/3) = 0.7937005260 (Cattaneo, Mindlin).
/// contact.advance(Step::new(0.0, Load::force(0.01)))?;
/// let state = contact.advance(Step::new(0.0, Load::force(0.01).with_tangential(Tangential::force_along_x(0.0025))))?;
/// let (Some(a), Some(tangential)) = (state.contact_radius, state.tangential) else { panic!("a round contact with friction") };
/// assert!((tangential.stick_radius.unwrap_or(0.0) / a - 0.7937005260).abs() < 1e-10);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PartialSlip;

impl ContactModel for PartialSlip {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction, Springer (2015)",
                what: "tangential springs G*, each with Coulomb's limit (Ch. 5)",
            },
            Source {
                citation: "J. Jaeger, Arch. Appl. Mech. 65, 478 (1995); M. Ciavarella, J. Appl. Mech. 65, 998 (1998)",
                what: "partial slip as a difference of normal contacts, the approximation behind the springs",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: Profile::SURFACES,
            effects: &[Effect::Friction],
            needs_effect: true,
            paths: Paths::Remembered,
            outputs: &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area],
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        self.abilities().refuse(NAME, scene)?;
        let Some(FrictionLaw { coefficient, .. }) = scene.effects.friction.law() else {
            return Err(Error::unsupported(NAME, "a contact without friction"));
        };
        let body = RoundBody::required(scene, NAME, "friction by springs needs a round contact")?;
        let Some(pair) = scene.pair else {
            return Err(Error::unsupported(
                NAME,
                "a scene without both bodies: friction needs their shear moduli",
            ));
        };
        let springs = Springs::new(body.profile, coefficient, pair.shear_modulus()? / scene.contact_modulus);
        Ok(Box::new(PreparedPartialSlip { body, coefficient, time: 0.0, springs }))
    }
}

struct PreparedPartialSlip {
    body: RoundBody,
    coefficient: f64,
    time: f64,
    springs: Springs<Profile>,
}

impl PreparedPartialSlip {
    /// The springs under an approach where the tangential force is reached.
    fn reach(&self, approach: f64, normal: f64, force: f64) -> Result<Springs<Profile>> {
        let (nondimensional, limit) = (self.body.scaling.nondimensional, self.coefficient * normal);
        match self.springs.held(approach, limit, force) {
            Some(springs) => Ok(springs),
            None => Err(Error::gross_slip(nondimensional.force(force)?, nondimensional.force(limit)?)),
        }
    }
}

impl PreparedContact for PreparedPartialSlip {
    fn normalisation(&self) -> Normalisation {
        self.body.scaling.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        check_stop(stop)?;
        let Step { time, load } = step.validated(self.time)?;
        load.tangential.refuse_y(NAME)?;
        let scaling = &self.body.scaling;
        let nondimensional = scaling.nondimensional;
        let contact = self.body.press(load.normal, NAME)?;
        let springs = match load.tangential {
            Tangential::Force([force, _]) => {
                self.reach(contact.approach, contact.force, nondimensional.force_in(force))?
            }
            Tangential::Displacement([u, _]) => {
                self.springs.moved(contact.approach, nondimensional.length_in(u))
            }
            other => return Err(Error::unsupported_load(NAME, other)),
        };
        let radius = nondimensional.approach(contact.radius)?;
        let report = SolveReport::exact("springs of the profile g(x), a polygon in g");
        let scaled = contact.scaled().with_elastic_stiffness(contact.stiffness());
        let normal = scaling.state(scaled, load.normal, report)?;
        let tangential = springs.state(load.tangential, 1.0, nondimensional)?;
        (self.time, self.springs) = (time, springs);
        let tangential = tangential.with_sliding_force(self.coefficient * normal.force);
        Ok(normal.with_time(time).with_contact_radius(radius).with_tangential(tangential))
    }

    fn restart(&mut self) {
        self.time = 0.0;
        self.springs = self.springs.unloaded();
    }
}

#[cfg(test)]
mod tests;
