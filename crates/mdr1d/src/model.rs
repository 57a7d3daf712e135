//! [`Mdr1d`]: the method behind the common trait.

use crate::adhesion::{Adhesive, Failure};
use crate::axisymmetric::{Profile, RoundContact, check_radius};
use crate::bearing::Bearing;
use contact_model::{
    Abilities, Adhesion, ContactModel, ContactState, Effect, Error, Line, Load, Nondimensionalisation,
    Normalisation, Output, Outputs, PreparedContact, RequiredMemory, Result, Scene, SelfAffine, Size,
    SolveReport, Source, Stop, Surface, SurfaceKind,
};
use std::sync::{Arc, Mutex};
use surface_gen::LineGenerator;

const NAME: &str = "mdr1d";

/// Memory of drawing a line, bytes for each element.
pub const BYTES_PER_ELEMENT: f64 = 40.0;

/// Why a measured profile is refused.
const PROFILE: &str = "a measured profile: the method replaces a surface by a line of another spectrum, C_1D = pi q C_2D, and a measured profile \
    is not that line";

/// The method of reduction of dimensionality.
///
/// Takes a [`Surface::SelfAffine`] (the line is drawn from the seed), a [`Surface::Heights`] (phases are drawn, the spectrum of the
/// line is `pi q C_2D` of the map's own: [`LineGenerator::of_map`]; `sqrt(Lx Ly)` stands for the side, and the map has to be
/// isotropic), a [`Surface::Line`], and the bodies of [`Profile`]. For rough lines it claims force, approach and stiffness; for axisymmetric bodies also the area, `pi a^2`, which is exact there.
///
/// The bodies of [`Profile`] may adhere ([`Adhesion::ShortRange`]): their loads may then be negative, down to the pull-off, which is
/// [`Error::OutOfRange`] with the smallest admissible load; no load means the adhered contact. The stiffness is then the slope along
/// the branch, on which the edge moves: 0 at the pull-off under prescribed force, negative beyond it, absent at the pull-off under
/// prescribed approach, where it has no bound. That of the held contact area, which the conductance follows from, is `2 E* a`. Power-law
/// bodies with exponents up to 1/2 have no such contact and are refused. So is adhesion of rough lines: the rule that tears a spring
/// needs the radius of a round contact.
///
/// An ensemble over one spectrum is faster with one [`surface_gen::LineGenerator`] and its lines as [`Surface::Line`]: the plan
/// and the amplitudes are then made once. The states are the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Mdr1d {
    /// Number of elements of a line that is drawn from a seed; a given line brings its own.
    pub elements: usize,
}

impl Default for Mdr1d {
    /// 2^16 elements: a line in milliseconds, and a power law over five decades of force.
    fn default() -> Self {
        Self { elements: 1 << 16 }
    }
}

impl ContactModel for Mdr1d {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "R. Pohrt, V. L. Popov, A. E. Filippov, Phys. Rev. E 86, 026710 (2012)",
                what: "the equivalent line, Eqs. 14 to 18 (Eq. 15 with the square root over the spectrum)",
            },
            Source {
                citation: "T. Geike, V. L. Popov, Phys. Rev. E 76, 036710 (2007)",
                what: "reduction of rough three-dimensional contacts to one dimension",
            },
            Source {
                citation: "M. Hess, Ueber die exakte Abbildung ausgewaehlter dreidimensionaler Kontakte auf Systeme mit \
                           niedrigerer raeumlicher Dimension, Cuvillier, Goettingen (2011)",
                what: "exact MDR profiles g(x) of axisymmetric bodies, kappa_n; adhesion: the edge tears at sqrt(2 pi a w / E*)",
            },
            Source {
                citation: "I. A. Lyashenko, L. Pastewka, B. N. J. Persson, Tribol. Lett. 52, 223 (2013)",
                what: "why no contact area is claimed for rough lines",
            },
        ]
    }

    fn abilities(&self) -> Abilities {
        Abilities {
            surfaces: &[
                SurfaceKind::SelfAffine,
                SurfaceKind::Heights,
                SurfaceKind::Line,
                SurfaceKind::Sphere,
                SurfaceKind::Cone,
                SurfaceKind::PowerLaw,
                SurfaceKind::FlatCircle,
            ],
            effects: &[Effect::ShortRangeAdhesion],
            outputs: &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area],
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        if let Surface::Profile(_) = scene.surface {
            return Err(Error::unsupported(NAME, PROFILE));
        }
        self.abilities().refuse(NAME, scene)?;
        let outputs = scene.outputs;
        let (length, modulus) = (scene.surface.size().length(), scene.modulus);
        if let Some(profile) = Profile::new(&scene.surface)? {
            let nondimensional = Nondimensionalisation::new(modulus, length, length)?;
            let normalisation = Normalisation { modulus, length, height: None };
            let (adhesive, size) = (adhesive(profile, scene)?, scene.surface.size());
            return Ok(Box::new(RoundBody {
                profile,
                size,
                adhesive,
                nondimensional,
                normalisation,
                outputs,
            }));
        }
        if scene.effects.adhesion != Adhesion::Off {
            let what = format!(
                "adhesion ({:?}) of {}: the rule needs the radius of a round contact",
                scene.effects.adhesion,
                scene.surface.kind()
            );
            return Err(Error::unsupported(NAME, what));
        }
        if outputs.area
            && matches!(scene.surface, Surface::SelfAffine(_) | Surface::Heights(_) | Surface::Line { .. })
        {
            return Err(Error::unsupported(
                NAME,
                "the area of a rough surface (a line has a length in contact only)",
            ));
        }
        match &scene.surface {
            Surface::SelfAffine(surface) => {
                let line = surface_gen::self_affine_line(surface, self.elements, seed)?;
                Ok(Box::new(RoughLine::new(Bearing::new(&line), &line, length, modulus, outputs)))
            }
            Surface::Line { line, .. } => {
                Ok(Box::new(RoughLine::new(Bearing::new(line), line, length, modulus, outputs)))
            }
            Surface::Heights(map) => {
                let line = LineGenerator::of_map(map, self.elements)?.line(seed)?;
                Ok(Box::new(RoughLine::new(Bearing::new(&line), &line, length, modulus, outputs)))
            }
            other => Err(Error::unsupported(NAME, other.kind())),
        }
    }

    /// That of a line that is drawn; a given line and a round body need less than they are.
    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        let elements = self.elements;
        matches!(scene.surface, Surface::SelfAffine(_) | Surface::Heights(_)).then(|| RequiredMemory {
            what: format!("a line of {elements} elements").into(),
            bytes: BYTES_PER_ELEMENT * elements as f64,
        })
    }
}

/// [`Mdr1d`] for many lines of one surface: plans, amplitudes and memory are kept from line to line.
///
/// The states are those of [`Mdr1d`], bit for bit; a line of 2^20 elements takes about half the time. Cheap to share between
/// threads.
///
/// ```
/// use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
/// let surface = SelfAffine::new(2.4, 1.0, 1.0)?;
/// let ensemble = mdr1d::Ensemble::new(&surface, 1024)?;
/// let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
/// let one = ensemble.prepare(&scene, 7)?.solve(Load::Force(0.1))?;
/// let other = mdr1d::Mdr1d { elements: 1024 }.prepare(&scene, 7)?.solve(Load::Force(0.1))?;
/// assert_eq!(one.stiffness, other.stiffness);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug)]
pub struct Ensemble {
    surface: SelfAffine,
    model: Mdr1d,
    generator: LineGenerator,
    /// Memory of contacts that are done.
    spare: Arc<Mutex<Vec<Bearing>>>,
}

impl Ensemble {
    /// Plans lines of `elements` elements for one surface.
    ///
    /// # Errors
    /// As [`LineGenerator::new`].
    pub fn new(surface: &SelfAffine, elements: usize) -> Result<Self> {
        let generator = LineGenerator::new(surface, elements)?;
        Ok(Self { surface: *surface, model: Mdr1d { elements }, generator, spare: Arc::default() })
    }
}

impl ContactModel for Ensemble {
    fn name(&self) -> &'static str {
        NAME
    }

    fn sources(&self) -> &'static [Source] {
        self.model.sources()
    }

    fn abilities(&self) -> Abilities {
        self.model.abilities()
    }

    /// As [`Mdr1d`]; scenes of other surfaces are solved too, without anything kept.
    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        let outputs = scene.outputs;
        if scene.surface != Surface::SelfAffine(self.surface)
            || outputs.any_field()
            || outputs.area
            || outputs.contact_patches
        {
            return self.model.prepare(scene, seed);
        }
        self.abilities().refuse(NAME, scene)?;
        if scene.effects.named().next().is_some() {
            return self.model.prepare(scene, seed);
        }
        let line = self.generator.line(seed)?;
        let spare = self.spare.lock().ok().and_then(|mut spare| spare.pop());
        let mut bearing = spare.unwrap_or_else(Bearing::empty);
        bearing.rebuild(&line);
        let mut rough = RoughLine::new(bearing, &line, self.surface.size.length(), scene.modulus, outputs);
        rough.home = Some(Arc::clone(&self.spare));
        Ok(Box::new(rough))
    }

    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        self.model.least_memory(scene)
    }
}

/// A rough line.
struct RoughLine {
    bearing: Bearing,
    normalisation: Normalisation,
    outputs: Outputs,
    /// Where its memory goes in the end.
    home: Option<Arc<Mutex<Vec<Bearing>>>>,
}

impl RoughLine {
    fn new(bearing: Bearing, line: &Line, length: f64, modulus: f64, outputs: Outputs) -> Self {
        let height = surface_gen::rms_height(line.heights());
        let normalisation = Normalisation { modulus, length, height: Some(height) };
        Self { bearing, normalisation, outputs, home: None }
    }
}

impl Drop for RoughLine {
    fn drop(&mut self) {
        if let Some(mut spare) = self.home.as_ref().and_then(|home| home.lock().ok()) {
            spare.push(std::mem::replace(&mut self.bearing, Bearing::empty()));
        }
    }
}

impl PreparedContact for RoughLine {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let support = self.bearing.press(load, self.normalisation.modulus)?;
        let mut report =
            SolveReport::exact(format!("order statistics of {} elements", self.bearing.elements()));
        report.contact_cells = Some(support.elements);
        report.certificate.stiffness_error = self.outputs.needs_stiffness().then_some(0.0);
        report.certificate.force_error = matches!(load, Load::Approach(_)).then_some(0.0);
        ContactState::new(support.force, report)
            .with_approach(support.approach)
            .with_elastic_stiffness(self.outputs.needs_stiffness().then_some(support.stiffness))
            .completed(&self.outputs, self.normalisation.modulus)
    }
}

/// The profile with its adhesion, where that is on.
fn adhesive(profile: Profile, scene: &Scene) -> Result<Option<Adhesive>> {
    match scene.effects.adhesion {
        Adhesion::Off => Ok(None),
        Adhesion::ShortRange { work } => {
            let scaled = work / scene.modulus / scene.surface.size().length();
            if scaled.is_finite() && (scaled > 0.0 || work <= 0.0) {
                Adhesive::new(profile, scaled).map(Some)
            } else {
                let expected = "a number within the range of f64 over E* L";
                Err(Error::domain("work of adhesion", work, expected))
            }
        }
        other => Err(Error::unsupported(NAME, format!("adhesion ({other:?})"))),
    }
}

/// An axisymmetric body.
struct RoundBody {
    profile: Profile,
    size: Size,
    adhesive: Option<Adhesive>,
    nondimensional: Nondimensionalisation,
    normalisation: Normalisation,
    outputs: Outputs,
}

impl RoundBody {
    /// The state under a load >= 0, and whether it has to be a contact.
    fn press(&self, load: Load) -> Result<(RoundContact, bool)> {
        match load.validated()? {
            Load::Force(force) => {
                Ok((self.profile.at_force(self.nondimensional.force_in(force)), force > 0.0))
            }
            Load::Approach(approach) => {
                Ok((self.profile.at_approach(self.nondimensional.approach_in(approach)), approach > 0.0))
            }
            _ => Err(Error::unsupported(NAME, format!("the load {load:?}"))),
        }
    }

    /// The adhered state under a load of either sign, and whether it has to be a contact.
    fn adhere(&self, adhesive: Adhesive, load: Load) -> Result<(RoundContact, bool)> {
        let nondimensional = self.nondimensional;
        let (found, name, value, smallest): (_, _, _, &dyn Fn(f64) -> Result<f64>) =
            match load.validated_with_adhesion()? {
                Load::Force(force) => (
                    adhesive.at_force(nondimensional.force_in(force.abs()).copysign(force)),
                    "force (the contact pulls off under a prescribed force)",
                    force,
                    &|least| nondimensional.force(least),
                ),
                Load::Approach(approach) => (
                    adhesive.at_approach(nondimensional.approach_in(approach)),
                    "approach (the contact pulls off under a prescribed approach)",
                    approach,
                    &|least| nondimensional.approach(least),
                ),
                _ => return Err(Error::unsupported(NAME, format!("the load {load:?}"))),
            };
        match found {
            Ok(contact) => Ok((contact, adhesive.attracts() || value.abs() > 0.0)),
            Err(Failure::PullsOff { smallest: least }) => Err(Error::OutOfRange {
                name: name.into(),
                value,
                min: -smallest(-least)?,
                max: f64::INFINITY,
            }),
            Err(Failure::Range(radius)) => Err(out_of_f64(radius)),
        }
    }
}

impl PreparedContact for RoundBody {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let nondimensional = self.nondimensional;
        let (contact, touches) = match self.adhesive {
            Some(adhesive) => self.adhere(adhesive, load)?,
            None => self.press(load)?,
        };
        check_radius(contact.radius, self.size)?;
        if touches && contact.radius <= 0.0 {
            return Err(out_of_f64(contact.radius));
        }
        // A loaded contact without adhesion has all three positive.
        if touches && self.adhesive.is_none() && (contact.approach <= 0.0 || contact.force <= 0.0) {
            return Err(out_of_f64(contact.radius));
        }
        let approach = nondimensional.approach(contact.approach.abs())?.copysign(contact.approach);
        let force = match load {
            Load::Force(force) => force,
            _ => nondimensional.force(contact.force.abs())?.copysign(contact.force),
        };
        let outputs = &self.outputs;
        // Along the branch the edge of an adhesive contact moves.
        let slope = match self.adhesive {
            Some(adhesive) => adhesive.slope(contact.radius),
            None => Some(contact.stiffness()),
        };
        let stiffness = slope
            .filter(|_| outputs.needs_stiffness())
            .map(|slope| Ok::<_, Error>(nondimensional.stiffness(slope.abs())?.copysign(slope)))
            .transpose()?;
        let held =
            outputs.needs_fixed_area().then(|| nondimensional.stiffness(contact.stiffness())).transpose()?;
        let area = outputs.area.then(|| nondimensional.area(contact.area())).transpose()?;
        let mut report = SolveReport::exact("closed form of the profile g(x)");
        report.certificate.stiffness_error = stiffness.or(held).map(|_| 0.0);
        report.certificate.force_error = matches!(load, Load::Approach(_)).then_some(0.0);
        ContactState::new(force, report)
            .with_approach(approach)
            .with_stiffness(stiffness)
            .with_stiffness_fixed_area(held)
            .with_area(area)
            .completed(&self.outputs, self.normalisation.modulus)
    }
}

fn out_of_f64(radius: f64) -> Error {
    Error::domain("contact radius over side", radius, "a number within the range of f64")
}

#[cfg(test)]
mod tests;
