//! [`Mdr1d`]: the method behind the common trait.

use crate::adhesion::{Adhesive, NoEquilibrium};
use crate::axisymmetric::{Profile, RoundContact};
use crate::bearing::Bearing;
use crate::body::{RoundBody, out_of_f64};
use contact_model::{
    Abilities, Adhesion, ContactModel, ContactState, Effect, Error, Line, Load, NormalLoad, Normalisation,
    Output, Outputs, PreparedContact, RequiredMemory, Result, ScaledState, Scene, SelfAffine, SolveReport,
    Source, Stop, Surface, SurfaceKind, check_stop,
};
use std::sync::{Arc, Mutex};
use surface_gen::LineGenerator;

const NAME: &str = "mdr1d";

/// Memory for drawing a line, in bytes per element.
pub const BYTES_PER_ELEMENT: f64 = 40.0;

/// Why a measured profile is refused.
const PROFILE: &str = "a measured profile: the method replaces a surface by a line of another spectrum, C_1D = pi q C_2D, and a measured profile \
    is not that line";

/// The method of reduction of dimensionality.
///
/// Takes a [`Surface::SelfAffine`] (the line is drawn from the seed), a [`Surface::Heights`] (phases are
/// drawn, the spectrum of the line is `pi q C_2D` of the map's own: [`LineGenerator::of_map`]; `sqrt(Lx Ly)`
/// stands for the side, and the map has to be isotropic), a [`Surface::Line`], and the bodies of [`Profile`].
/// For rough lines it claims force, approach and stiffness; for axisymmetric bodies also the area, `pi a^2`,
/// which is exact there.
///
/// The bodies of [`Profile`] may adhere ([`Adhesion::ShortRange`]): their loads may then be negative, down to
/// the pull-off, which is [`Error::OutOfRange`] with the smallest admissible load; the state without load is
/// the adhered contact. The stiffness is then the slope along the branch, on which the edge moves: 0 at the
/// pull-off under prescribed force, negative beyond it, and absent at the pull-off under prescribed approach,
/// where it has no bound. The stiffness at fixed contact area, from which the conductance follows, is `2 E*
/// a`. Power-law bodies with exponents up to 1/2 have no such contact and are refused. So is adhesion of
/// rough lines: the rule by which a spring detaches needs the radius of a round contact.
///
/// An ensemble over one spectrum is faster with [`Ensemble`], or with the lines of one
/// [`surface_gen::LineGenerator`] as [`Surface::Line`], because the plan and the amplitudes are then computed
/// once. The states are the same.
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
        let (length, contact_modulus) = (scene.surface.size().length(), scene.contact_modulus);
        if let Some(body) = RoundBody::new(scene)? {
            return Ok(Box::new(RoundIndenter { body, adhesive: adhesive(body.profile, scene)? }));
        }
        if scene.effects.adhesion != Adhesion::Off {
            let what =
                format!("adhesion of {}: the rule needs the radius of a round contact", scene.surface.kind());
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
                Ok(Box::new(RoughLine::new(Bearing::new(&line), &line, length, contact_modulus, outputs)))
            }
            Surface::Line { line, .. } => {
                Ok(Box::new(RoughLine::new(Bearing::new(line), line, length, contact_modulus, outputs)))
            }
            Surface::Heights(map) => {
                let line = LineGenerator::of_map(map, self.elements)?.line(seed)?;
                Ok(Box::new(RoughLine::new(Bearing::new(&line), &line, length, contact_modulus, outputs)))
            }
            other => Err(Error::unsupported(NAME, other.kind())),
        }
    }

    /// The memory for a line that is drawn; a given line and a round body need less than this.
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
/// The states are those of [`Mdr1d`], bit for bit; a line of 2^20 elements takes about half the time. Cheap
/// to share between threads.
///
/// ```
/// use contact_model::{ContactModel, Load, Scene, SelfAffine, Surface};
/// let surface = SelfAffine::new(2.4, 1.0, 1.0)?;
/// let ensemble = mdr1d::Ensemble::new(&surface, 1024)?;
/// let scene = Scene::new(Surface::SelfAffine(surface), 1.0);
/// let one = ensemble.prepare(&scene, 7)?.solve(Load::force(0.1))?;
/// let other = mdr1d::Mdr1d { elements: 1024 }.prepare(&scene, 7)?.solve(Load::force(0.1))?;
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

    /// As [`Mdr1d`]; scenes of other surfaces are solved too, without saved plans.
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
        let mut rough =
            RoughLine::new(bearing, &line, self.surface.size.length(), scene.contact_modulus, outputs);
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
    fn new(bearing: Bearing, line: &Line, length: f64, contact_modulus: f64, outputs: Outputs) -> Self {
        let height = surface_gen::rms_height(line.heights());
        let normalisation = Normalisation { contact_modulus, length, height: Some(height) };
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
        check_stop(stop)?;
        let load = load.without_tangential(NAME)?;
        let support = self.bearing.press(load, self.normalisation.contact_modulus)?;
        let strategy = format!("order statistics of {} elements", self.bearing.elements());
        let mut report = SolveReport::formula(strategy, load);
        report.contact_cells = Some(support.elements);
        report.certificate.stiffness_error = self.outputs.needs_stiffness().then_some(0.0);
        ContactState::new(support.force, report)
            .with_approach(support.approach)
            .with_elastic_stiffness(self.outputs.needs_stiffness().then_some(support.stiffness))
            .completed(&self.outputs, self.normalisation.contact_modulus)
    }
}

/// The profile with its adhesion, where that is on.
fn adhesive(profile: Profile, scene: &Scene) -> Result<Option<Adhesive>> {
    match scene.effects.adhesion {
        Adhesion::Off => Ok(None),
        Adhesion::ShortRange { work } => {
            let scaled = work / scene.contact_modulus / scene.surface.size().length();
            if scaled.is_finite() && (scaled > 0.0 || work <= 0.0) {
                Adhesive::new(profile, scaled).map(Some)
            } else {
                Err(Error::not_representable("work of adhesion", work))
            }
        }
        other => Err(Error::unsupported(NAME, format!("adhesion ({other:?})"))),
    }
}

/// An axisymmetric body, which may adhere.
struct RoundIndenter {
    body: RoundBody,
    adhesive: Option<Adhesive>,
}

impl RoundIndenter {
    /// The adhered contact under a load of either sign.
    fn adhere(&self, adhesive: Adhesive, load: NormalLoad) -> Result<RoundContact> {
        let nondimensional = self.body.scaling.nondimensional;
        let (found, value) = match load.validated_with_adhesion()? {
            NormalLoad::Force(force) => (adhesive.at_force(nondimensional.force_in(force)), force),
            NormalLoad::Approach(approach) => {
                (adhesive.at_approach(nondimensional.approach_in(approach)), approach)
            }
            _ => return Err(Error::unsupported_load(NAME, load)),
        };
        match found {
            Ok(contact) => {
                self.body.admit(contact)?;
                let touches = adhesive.attracts() || value.abs() > 0.0;
                if touches && contact.radius <= 0.0 { Err(out_of_f64(contact.radius)) } else { Ok(contact) }
            }
            Err(NoEquilibrium::PullsOff { smallest }) => {
                let smallest = match load {
                    NormalLoad::Force(_) => nondimensional.force(smallest)?,
                    _ => nondimensional.approach(smallest)?,
                };
                Err(load.pull_off(smallest))
            }
            Err(NoEquilibrium::Range(radius)) => Err(out_of_f64(radius)),
        }
    }
}

impl PreparedContact for RoundIndenter {
    fn normalisation(&self) -> Normalisation {
        self.body.scaling.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        check_stop(stop)?;
        let load = load.without_tangential(NAME)?;
        // Along the branch the edge of an adhesive contact moves.
        let (contact, slope) = if let Some(adhesive) = self.adhesive {
            let contact = self.adhere(adhesive, load)?;
            (contact, adhesive.slope(contact.radius))
        } else {
            let contact = self.body.press(load, NAME)?;
            (contact, Some(contact.stiffness()))
        };
        let scaled = ScaledState { stiffness: slope, ..contact.scaled() };
        self.body.scaling.state(scaled, load, SolveReport::formula("closed form of the profile g(x)", load))
    }
}

#[cfg(test)]
mod tests;
