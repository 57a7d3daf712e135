//! [`Viscoelastic`]: indentation histories of axisymmetric bodies while the contact grows.

use crate::axisymmetric::Profile;
use crate::body::RoundBody;
use crate::material::ViscoelasticMaterial;
use crate::relaxation::Relaxation;
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Error, Load, NormalLoad, Normalisation, Output, Paths,
    PreparedContact, Result, ScaledState, Scene, SolveReport, Source, Step, Stop, check_stop,
};

const NAME: &str = "mdr1d_viscoelastic";

/// A linear viscoelastic half-space under a rigid axisymmetric body, through its profile: every spring
/// relaxes independently.
///
/// While the contact grows, a spring that has come into contact stays there, and the sum over springs is
/// Boltzmann's integral of the elastic law: `F(t) = int E*(t - t') dPhi(d(t'))` with `Phi = F_elastic/E*`
/// (Lee and Radok 1960; Popov and Hess 2015, Ch. 7).
///
/// The model takes the bodies of [`Profile`] with a [`contact_model::Rheology`], and histories of the
/// approach, of the force, or of both in turn, that are linear between the times of the steps. Equal times
/// are a jump; a dashpot in parallel (Kelvin-Voigt) does not allow a jump of the approach. The force of a
/// step is that at its end, just before a change of speed.
///
/// **Growth is checked, not assumed**: a step in which the contact radius would shrink is
/// [`Error::OutOfRange`] in the time, whose largest admissible value is the instant from which it would.
/// Under a falling force this instant may be well after the force began to fall.
///
/// Under a prescribed force the state is in closed form (exponentials of the material's own creep rates);
/// under a prescribed approach it is a quadrature to 1e-12 per arm. Force and approach at one time cost well
/// below a millisecond with up to 16 arms. The model claims no stiffness, because it depends on the speed.
///
/// ```
/// use contact_model::{ContactModel, Load, Rheology, Scene, Step, Surface};
/// use mdr1d::Viscoelastic;
/// // Kelvin-Voigt under a flat-ended cylinder: d = F/(8 G a) (1 - exp(-G t/eta)), with G = 1 (E* = 4), eta = 2, a = 0.5, F = 1.
/// let mut scene = Scene::new(Surface::FlatCircle { radius: 0.5, size: 2.0.into() }, 4.0);
/// scene.effects.rheology = Rheology::KelvinVoigt { viscosity: 2.0 };
/// scene.outputs.stiffness = false;
/// let mut contact = Viscoelastic.prepare(&scene, 0)?;
/// contact.advance(Step::new(0.0, Load::force(1.0)))?;
/// let state = contact.advance(Step::new(3.0, Load::force(1.0)))?;
/// let exact = 0.25 * (1.0 - (-1.5_f64).exp());
/// assert!((state.approach.unwrap_or(0.0) - exact).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Viscoelastic;

/// The rheologies that the model accepts.
pub(crate) const RHEOLOGIES: &[Effect] =
    &[Effect::KelvinVoigt, Effect::Maxwell, Effect::StandardSolid, Effect::PronySeries];

impl ContactModel for Viscoelastic {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960)",
                what: "viscoelastic contact while the contact grows",
            },
            Source {
                citation: "V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction, Springer (2015)",
                what: "the same by springs that relax (Ch. 7)",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: Profile::SURFACES,
            effects: RHEOLOGIES,
            needs_effect: true,
            paths: Paths::Needed,
            outputs: &[Output::Area, Output::Conductance],
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn PreparedContact>> {
        if scene.outputs.stiffness || scene.outputs.stiffness_fixed_area {
            return Err(Error::unsupported(NAME, "the stiffness (it depends on how fast one pushes)"));
        }
        self.abilities().refuse(NAME, scene)?;
        let rheology = scene.effects.rheology;
        let Some(spectrum) = rheology.spectrum(scene.contact_modulus)? else {
            return Err(Error::unsupported(NAME, "an elastic material (there is nothing to remember)"));
        };
        if let Some(pair) = &scene.pair {
            rheology.check_pair(pair, NAME)?;
        }
        let body = RoundBody::required(scene, NAME, "relaxing springs need a round contact")?;
        Ok(Box::new(PreparedViscoelastic {
            body,
            relaxation: Relaxation::new(ViscoelasticMaterial::new(spectrum), NAME),
        }))
    }
}

struct PreparedViscoelastic {
    body: RoundBody,
    relaxation: Relaxation,
}

impl PreparedContact for PreparedViscoelastic {
    fn normalisation(&self) -> Normalisation {
        self.body.scaling.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        check_stop(stop)?;
        let step = self.relaxation.validated(step)?;
        let RoundBody { profile, scaling, .. } = self.body;
        let at = match step.load.normal {
            NormalLoad::Force(force) => {
                let press = |force| Ok(profile.at_force(force));
                self.relaxation.by_force(step.time, scaling.nondimensional.force_in(force), press)?
            }
            NormalLoad::Approach(approach) => {
                let approach = scaling.nondimensional.approach_in(approach);
                let press = |approach| Ok((profile.at_approach(approach), profile));
                self.relaxation.by_approach(step.time, approach, press)?
            }
            other => return Err(Error::unsupported_load(NAME, other)),
        };
        self.body.admit(at.contact)?;
        at.check()?;
        let radius = scaling.nondimensional.approach(at.contact.radius)?;
        let mut report = SolveReport::exact("Boltzmann's integral over the profile g(x)");
        report.certificate.load_error = at.residual;
        let scaled = ScaledState { force: at.memory.force, ..at.contact.scaled() };
        let mut state = scaling.state(scaled, step.load.normal, report)?;
        // The conductance follows from a stiffness that is not claimed.
        state.report.certificate.stiffness_error = None;
        self.relaxation.at = at;
        Ok(state.with_time(step.time).with_contact_radius(radius))
    }

    fn restart(&mut self) {
        self.relaxation.restart();
    }
}

#[cfg(test)]
mod tests;
