//! [`Viscoelastic`]: indentation histories of axisymmetric bodies while the contact grows.

use crate::axisymmetric::{Profile, RoundContact, check_radius};
use crate::material::{Material, Memory};
use contact_model::{
    Body, ContactState, Effects, Error, History, HistoryModel, HistoryState, Load, Outputs, Pair, Result,
    Rheology, Scales, Scene, SolveReport, Source, Step, Tangential, Units,
};

const NAME: &str = "mdr1d_viscoelastic";

/// A linear viscoelastic half-space under a rigid axisymmetric body, through its profile: every spring relaxes by itself.
///
/// While the contact grows, a spring that has come into contact stays there, and the sum over springs is Boltzmann's integral of the
/// elastic law: `F(t) = int E*(t - t') dPhi(d(t'))` with `Phi = F_elastic/E*` (Lee and Radok 1960; Popov and Hess 2015, Ch. 7).
///
/// Takes the bodies of [`Profile`] with a [`Rheology`], and histories that are straight between the steps' times: of the approach,
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
/// use contact_model::{HistoryModel, Load, Rheology, Scene, Step, Surface};
/// use mdr1d::Viscoelastic;
/// // Kelvin-Voigt under a flat-ended cylinder: d = F/(8 G a) (1 - exp(-G t/eta)), with G = 1 (E* = 4), eta = 2, a = 0.5, F = 1.
/// let mut scene = Scene::new(Surface::FlatCircle { radius: 0.5, side: 2.0 }, 4.0);
/// scene.effects.rheology = Rheology::KelvinVoigt { viscosity: 2.0 };
/// scene.outputs.stiffness = false;
/// let mut contact = Viscoelastic.prepare(&scene, 0)?;
/// contact.advance(Step::normal(0.0, Load::Force(1.0)))?;
/// let state = contact.advance(Step::normal(3.0, Load::Force(1.0)))?;
/// let exact = 0.25 * (1.0 - (-1.5_f64).exp());
/// assert!((state.normal.approach.unwrap_or(0.0) - exact).abs() < 1e-14);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Viscoelastic;

impl HistoryModel for Viscoelastic {
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

    fn prepare(&self, scene: &Scene, _seed: u64) -> Result<Box<dyn History>> {
        scene.validate()?;
        let rheology = scene.effects.rheology;
        Effects { rheology: Rheology::Elastic, ..scene.effects }.refuse(NAME)?;
        let Some(material) = Material::new(&rheology, scene.modulus, NAME)? else {
            return Err(Error::unsupported(NAME, "an elastic material (there is nothing to remember)"));
        };
        if let Some(pair) = &scene.pair {
            check_pair(pair, &rheology)?;
        }
        if scene.outputs.any_field() {
            return Err(Error::unsupported(NAME, "pressure, displacement and gap fields"));
        }
        if scene.outputs.contact_patches {
            return Err(Error::unsupported(NAME, "contact patches (a profile has no cells)"));
        }
        if scene.outputs.stiffness {
            return Err(Error::unsupported(NAME, "the stiffness (it depends on how fast one pushes)"));
        }
        let Some(profile) = Profile::new(&scene.surface)? else {
            let what = format!("{}: relaxing springs need a round contact", scene.surface.kind());
            return Err(Error::unsupported(NAME, what));
        };
        let (side, modulus) = (scene.surface.side(), scene.modulus);
        let memory = material.fresh();
        Ok(Box::new(Prepared {
            profile,
            units: Units::new(modulus, side, side)?,
            scales: Scales { modulus, side, height: None },
            outputs: scene.outputs,
            at: At { time: 0.0, contact: profile.at_force(0.0), memory, residual: 0.0 },
            material,
        }))
    }
}

/// One rigid body on a viscoelastic one; viscosities are those of an incompressible one.
fn check_pair(pair: &Pair, rheology: &Rheology) -> Result<()> {
    /// A Poisson's ratio may have been rounded.
    const SAME: f64 = 1e-9;
    let (Pair { first: Body::Rigid, second: body } | Pair { first: body, second: Body::Rigid }) = pair else {
        return Err(Error::unsupported(NAME, "two bodies that deform (one has to be rigid)"));
    };
    match (body, rheology) {
        (Body::Elastic { poisson, .. }, Rheology::KelvinVoigt { .. } | Rheology::Maxwell { .. })
            if (poisson - 0.5).abs() > SAME =>
        {
            let expected = "1/2, for which viscosities are meant (a standard solid or Prony series has none)";
            Err(Error::domain("poisson", *poisson, expected))
        }
        _ => Ok(()),
    }
}

struct Prepared {
    profile: Profile,
    units: Units,
    scales: Scales,
    outputs: Outputs,
    material: Material,
    at: At,
}

/// Where the history stands; lengths in L, forces in E* L^2.
#[derive(Debug, Clone)]
struct At {
    time: f64,
    contact: RoundContact,
    memory: Memory,
    /// How far the force from the arms is from the one that was prescribed, relative.
    residual: f64,
}

impl Prepared {
    /// The history after a step by approach.
    fn by_approach(&self, time: f64, approach: f64) -> Result<At> {
        let (from, duration) = (&self.at, time - self.at.time);
        if approach < from.contact.approach * (1.0 - ROUNDED_DOWN) {
            return Err(shrinks(time, from.time));
        }
        // A conversion may have rounded a constant approach down.
        let approach = approach.max(from.contact.approach);
        let contact = self.profile.at_approach(approach);
        let memory = if duration > 0.0 {
            let speed = (approach - from.contact.approach) / duration;
            let integrals: Vec<f64> = self
                .material
                .rates()
                .map(|rate| remembered(self.profile, from.contact.approach, speed, rate, duration))
                .collect();
            let end = 2.0 * contact.radius * speed;
            self.material.relaxed(&from.memory, duration, contact.force, end, &integrals)
        } else if self.material.is_stiff() && approach > from.contact.approach {
            let what = "a jump of the approach (a dashpot in parallel takes an infinite force)";
            return Err(Error::unsupported(NAME, what));
        } else {
            self.material.jumped(&from.memory, contact.force - from.contact.force)
        };
        Ok(At { time, contact, memory, residual: 0.0 })
    }

    /// The history after a step by force.
    fn by_force(&self, time: f64, force: f64) -> Result<At> {
        let (from, duration) = (&self.at, time - self.at.time);
        let (memory, residual) = if duration > 0.0 {
            let creep = self.material.creep(&from.memory, force, duration);
            if let Some(fall) = creep.first_fall(duration) {
                return Err(shrinks(time, from.time + fall));
            }
            let memory = self.material.crept(&from.memory, &creep, duration, force);
            let residual = self.material.residual(&memory, creep.speed(duration));
            (memory, residual)
        } else {
            (self.material.jumped_to_force(&from.memory, force), 0.0)
        };
        if memory.load < from.memory.load * (1.0 - ROUNDED_DOWN) {
            return Err(shrinks(time, from.time));
        }
        // Rounding never makes the contact shrink.
        let contact = self.profile.at_force(memory.load.max(from.memory.load));
        Ok(At { time, contact, memory, residual })
    }
}

/// Approaches and loads that fall by less are taken for constant: they have been through conversions.
const ROUNDED_DOWN: f64 = 1e-12;

fn shrinks(time: f64, from: f64) -> Error {
    Error::OutOfRange {
        name: "time (after the largest admissible one the contact would shrink)".into(),
        value: time,
        min: 0.0,
        max: from,
    }
}

/// `int_0^D exp(-r (D - s)) 2 a(d_0 + v s) v ds` by Gauss's rule.
///
/// Panels double away from the end of the piece, in units of 1/r, and in d away from 0: the decay and the power of d are smooth on each.
fn remembered(profile: Profile, from: f64, speed: f64, rate: f64, duration: f64) -> f64 {
    /// exp(-64) is nothing beside the rest.
    const DOUBLINGS: i32 = 6;
    /// Halvings of d below which d^(1 + 1/n) is nothing.
    const HALVINGS: i32 = 60;
    if speed <= 0.0 {
        return 0.0;
    }
    let to = from + speed * duration;
    // Distances from the end, as times.
    let longest = duration.min(2.0_f64.powi(DOUBLINGS) / rate);
    let mut edges = vec![0.0, longest];
    edges.extend((0..DOUBLINGS).map(|i| 2.0_f64.powi(i) / rate).filter(|edge| *edge < longest));
    edges.extend(
        (1..=HALVINGS)
            .map(|i| to * 2.0_f64.powi(-i))
            .take_while(|d| *d > from)
            .map(|d| (to - d) / speed)
            .filter(|edge| *edge < longest),
    );
    edges.sort_by(f64::total_cmp);
    let nodes = gauss();
    edges
        .windows(2)
        .map(|w| {
            let (middle, half) = (0.5 * (w[0] + w[1]), 0.5 * (w[1] - w[0]));
            let sum: f64 = nodes
                .iter()
                .map(|(x, weight)| {
                    let back = middle + half * x;
                    weight * (-rate * back).exp() * profile.at_approach((to - speed * back).max(from)).radius
                })
                .sum();
            2.0 * speed * half * sum
        })
        .sum()
}

/// Nodes and weights of Gauss's rule of sixteen points on [-1, 1], by Newton's method on the recurrence of the Legendre polynomials.
fn gauss() -> [(f64, f64); 16] {
    let mut nodes = [(0.0, 0.0); 16];
    for (i, node) in nodes.iter_mut().enumerate() {
        let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / 16.5).cos();
        let mut slope = 1.0;
        for _ in 0..6 {
            let (mut last, mut value) = (1.0, x);
            for k in 2..=16 {
                let k = f64::from(k);
                (last, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * last) / k);
            }
            slope = 16.0 * (x * value - last) / (x * x - 1.0);
            x -= value / slope;
        }
        *node = (x, 2.0 / ((1.0 - x * x) * slope * slope));
    }
    nodes
}

impl History for Prepared {
    fn scales(&self) -> Scales {
        self.scales
    }

    fn advance(&mut self, step: Step) -> Result<HistoryState> {
        let step = step.validated(self.at.time)?;
        if step.tangential != Tangential::Force(0.0) {
            return Err(Error::unsupported(NAME, format!("the tangential load {:?}", step.tangential)));
        }
        let units = self.units;
        let at = match step.normal {
            Load::Force(force) => self.by_force(step.time, units.force_in(force))?,
            Load::Approach(approach) => self.by_approach(step.time, units.approach_in(approach))?,
            other => return Err(Error::unsupported(NAME, format!("the load {other:?}"))),
        };
        check_radius(at.contact.radius, self.scales.side)?;
        for value in [at.memory.force, at.memory.load, at.contact.approach] {
            if !value.is_finite() {
                return Err(Error::domain("state in units of side and modulus", value, "a finite number"));
            }
        }
        let radius = units.approach(at.contact.radius)?;
        let mut report = SolveReport::exact("Boltzmann's integral over the profile g(x)");
        report.certificate.load_error = at.residual;
        let normal = ContactState {
            force: match step.normal {
                Load::Force(force) => force,
                _ => units.force(at.memory.force)?,
            },
            approach: Some(match step.normal {
                Load::Approach(approach) => approach,
                _ => units.approach(at.contact.approach)?,
            }),
            stiffness: None,
            area: self.outputs.area.then(|| units.area(at.contact.area())).transpose()?,
            conductance: self
                .outputs
                .conductance
                .of(units.stiffness(at.contact.stiffness())?, self.scales.modulus)?,
            patches: None,
            fields: None,
            report,
        };
        self.at = at;
        Ok(HistoryState { time: step.time, normal, contact_radius: Some(radius), tangential: None })
    }

    fn restart(&mut self) {
        let memory = self.material.fresh();
        self.at = At { time: 0.0, contact: self.profile.at_force(0.0), memory, residual: 0.0 };
    }
}

#[cfg(test)]
mod tests;
