//! [`Viscoelastic`]: indentation histories of axisymmetric bodies while the contact grows.

use crate::axisymmetric::{Profile, check_radius};
use crate::material::Material;
use crate::relaxation::{Relaxation, check_pair};
use contact_model::{
    Abilities, ContactModel, ContactState, Effect, Error, Load, Nondimensionalisation, Normalisation, Output,
    Outputs, Paths, PreparedContact, Result, Scene, Size, SolveReport, Source, Step, Stop, SurfaceKind,
    Tangential,
};

const NAME: &str = "mdr1d_viscoelastic";

/// A linear viscoelastic half-space under a rigid axisymmetric body, through its profile: every spring relaxes by itself.
///
/// While the contact grows, a spring that has come into contact stays there, and the sum over springs is Boltzmann's integral of the
/// elastic law: `F(t) = int E*(t - t') dPhi(d(t'))` with `Phi = F_elastic/E*` (Lee and Radok 1960; Popov and Hess 2015, Ch. 7).
///
/// Takes the bodies of [`Profile`] with a [`contact_model::Rheology`], and histories that are straight between the steps' times: of the approach,
/// of the force, or one after the other. Equal times are a jump; a dashpot alone in parallel (Kelvin-Voigt) does not allow one of
/// the approach. The force of a step is that at its end, with its own speed.
///
/// **Growth is checked, not assumed**: a step in which the contact radius would shrink is [`Error::OutOfRange`] in the time, whose
/// largest admissible value is the instant from which it would. Under a falling force that may lie well after the force began to
/// fall.
///
/// Under a prescribed force the state is in closed form (exponentials of the material's own creep rates); under a prescribed
/// approach it is a quadrature to 1e-12 per arm. Force and approach at a time of up to 16 arms cost well below a millisecond. No
/// stiffness is claimed: it depends on how fast one pushes.
///
/// ```
/// use contact_model::{ContactModel, Load, Rheology, Scene, Step, Surface};
/// use mdr1d::Viscoelastic;
/// // Kelvin-Voigt under a flat-ended cylinder: d = F/(8 G a) (1 - exp(-G t/eta)), with G = 1 (E* = 4), eta = 2, a = 0.5, F = 1.
/// let mut scene = Scene::new(Surface::FlatCircle { radius: 0.5, size: 2.0.into() }, 4.0);
/// scene.effects.rheology = Rheology::KelvinVoigt { viscosity: 2.0 };
/// scene.outputs.stiffness = false;
/// let mut contact = Viscoelastic.prepare(&scene, 0)?;
/// contact.advance(Step::normal(0.0, Load::Force(1.0)))?;
/// let state = contact.advance(Step::normal(3.0, Load::Force(1.0)))?;
/// let exact = 0.25 * (1.0 - (-1.5_f64).exp());
/// assert!((state.approach.unwrap_or(0.0) - exact).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Viscoelastic;

/// What relaxes.
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
            surfaces: &[
                SurfaceKind::Sphere,
                SurfaceKind::Cone,
                SurfaceKind::PowerLaw,
                SurfaceKind::FlatCircle,
            ],
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
        let Some(material) = Material::new(&rheology, scene.modulus, NAME)? else {
            return Err(Error::unsupported(NAME, "an elastic material (there is nothing to remember)"));
        };
        if let Some(pair) = &scene.pair {
            check_pair(pair, &rheology, NAME)?;
        }
        let Some(profile) = Profile::new(&scene.surface)? else {
            let what = format!("{}: relaxing springs need a round contact", scene.surface.kind());
            return Err(Error::unsupported(NAME, what));
        };
        let (length, modulus) = (scene.surface.size().length(), scene.modulus);
        Ok(Box::new(PreparedViscoelastic {
            profile,
            size: scene.surface.size(),
            nondimensional: Nondimensionalisation::new(modulus, length, length)?,
            normalisation: Normalisation { modulus, length, height: None },
            outputs: scene.outputs,
            relaxation: Relaxation::new(material, NAME),
        }))
    }
}

struct PreparedViscoelastic {
    profile: Profile,
    size: Size,
    nondimensional: Nondimensionalisation,
    normalisation: Normalisation,
    outputs: Outputs,
    relaxation: Relaxation,
}

impl PreparedContact for PreparedViscoelastic {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let step = step.validated(self.relaxation.at.time)?;
        if step.tangential != Tangential::Force(0.0) {
            return Err(Error::unsupported(NAME, format!("the tangential load {:?}", step.tangential)));
        }
        let (nondimensional, profile) = (self.nondimensional, self.profile);
        let at = match step.normal {
            Load::Force(force) => {
                let press = |force| Ok(profile.at_force(force));
                self.relaxation.by_force(step.time, nondimensional.force_in(force), press)?
            }
            Load::Approach(approach) => {
                let press = |approach| Ok((profile.at_approach(approach), profile));
                self.relaxation.by_approach(step.time, nondimensional.approach_in(approach), press)?
            }
            other => return Err(Error::unsupported(NAME, format!("the load {other:?}"))),
        };
        check_radius(at.contact.radius, self.size)?;
        for value in [at.memory.force, at.memory.load, at.contact.approach] {
            if !value.is_finite() {
                return Err(Error::domain("state in units of side and modulus", value, "a finite number"));
            }
        }
        let radius = nondimensional.approach(at.contact.radius)?;
        let mut report = SolveReport::exact("Boltzmann's integral over the profile g(x)");
        report.certificate.load_error = at.residual;
        let mut normal = ContactState::new(
            match step.normal {
                Load::Force(force) => force,
                _ => nondimensional.force(at.memory.force)?,
            },
            report,
        )
        .with_approach(match step.normal {
            Load::Approach(approach) => approach,
            _ => nondimensional.approach(at.contact.approach)?,
        })
        .with_area(self.outputs.area.then(|| nondimensional.area(at.contact.area())).transpose()?);
        let stiffness = nondimensional.stiffness(at.contact.stiffness())?;
        normal.conductance = self.outputs.conductance.of(stiffness, self.normalisation.modulus)?;
        self.relaxation.at = at;
        Ok(normal.with_time(step.time).with_contact_radius(radius))
    }

    fn restart(&mut self) {
        self.relaxation.restart();
    }
}

#[cfg(test)]
mod tests;
