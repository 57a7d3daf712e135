//! [`Equivalent`]: friction and rheology of any contact that another model can press, through its equivalent
//! profile.

mod normal;

use self::normal::{NAME, Normal};
use crate::axisymmetric::RoundContact;
use crate::material::ViscoelasticMaterial;
use crate::relaxation::Relaxation;
use crate::slip::Springs;
use crate::tabulated::{Node, Tabulated};
use contact_model::{
    Abilities, Adhesion, ContactModel, ContactState, Effect, Effects, Error, FrictionLaw, Hardness, Load,
    NormalLoad, Normalisation, NotCombined, Output, Outputs, Paths, PreparedContact, RequiredMemory, Result,
    Scene, Source, Step, Stop, Surface, SurfaceKind, Tangential, never,
};
use std::sync::Arc;

/// Friction or rheology of any surface that a model M can press, rough ones too, through the equivalent
/// profile of M's own k(d).
///
/// M solves the normal problem of the scene's surface with every effect off, once per node of a table and
/// once under the load of each step. Its states give a [`Tabulated`] profile, on which act the springs of
/// [`crate::PartialSlip`] (Coulomb's friction, any path of both loads, with [`contact_model::Pair`]) or the
/// relaxing ones of [`crate::Viscoelastic`] (any [`contact_model::Rheology`] while the contact grows). Only
/// one effect is possible at a time, and M itself is solved without it. The area, fields, patches and
/// conductance of M are passed on, each for the contact of the step.
///
/// **The normal part is a state that M has solved for exactly this load**, for an elastic material.
/// Tangential results are those of the Cattaneo-Mindlin and Ciavarella-Jaeger approximation: exact for round
/// contacts as far as its assumptions hold (tractions do not change pressures, and slip is along the load),
/// with errors of a few per cent for others. They need a contact that grows with the load, so that
/// k(d) never falls; this is checked at every state, and [`Error::OutOfRange`] otherwise. Viscoelastic
/// results are exact for any shape while the contact grows in time, which is checked as in
/// [`crate::Viscoelastic`]. `contact_radius` and `stick_radius` are those of the round contact of the same
/// stiffness, `k/(2 E*)`.
///
/// The nodes lie on one logarithmic lattice of approaches (in units of the rms height, or of the side for
/// bodies without one), so that histories share them. The table begins [`Equivalent::decades`] below the
/// first load after a [`PreparedContact::restart`] and is extended upwards with the loads. Where k(d) is
/// smooth, its error is of third order in the spacing for x and of fourth order for F;
/// [`Tabulated::uncertainty`] at the step's approach is in the report's strategy. A pressure field is refused
/// with rheology (M's is that of an elastic body), and so is a stiffness.
///
/// Cost: one solve of M per node (about 49 at the defaults) at the first step, in ascending order, one per
/// further step and per node that it adds. Fields and patches are computed by a second contact of M, so that
/// the nodes do not cost more. With `bem3d` on 257 x 257 cells at F_bar = 1 the first step takes 0.3 s, each
/// further one 10 ms (tolerance 1e-4).
///
/// ```
/// use contact_model::{Body, Friction, ContactModel, Load, Pair, Scene, Step, Surface, Tangential};
/// use mdr1d::{Equivalent, Mdr1d};
/// let body = Body::Elastic { young: 2.0, poisson: 0.3 };
/// let pair = Pair { first: body, second: body };
/// let mut scene = Scene::of_pair(Surface::Sphere { radius: 1.0, size: 2.0.into() }, pair)?;
/// scene.effects.friction = Friction::coulomb(0.5);
/// let mut contact = Equivalent::new(Mdr1d::default()).prepare(&scene, 0)?;
/// // Half of mu F: c/a = 0.5^(1/3) = 0.7937005260 (Cattaneo, Mindlin).
/// contact.advance(Step::new(0.0, Load::force(0.01)))?;
/// let state = contact.advance(Step::new(0.0, Load::force(0.01).with_tangential(Tangential::force_along_x(0.0025))))?;
/// let (Some(a), Some(tangential)) = (state.contact_radius, state.tangential) else { panic!("a contact with friction") };
/// assert!((tangential.stick_radius.unwrap_or(0.0) / a - 0.7937005260).abs() < 1e-4);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Equivalent<M> {
    /// The model of the normal contact.
    pub model: M,
    /// Nodes per decade of the approach, 1 to 1000.
    pub per_decade: u32,
    /// Decades of the approach below the first load that are resolved, 1 to 12.
    pub decades: u32,
}

impl<M: ContactModel> Equivalent<M> {
    /// Sixteen nodes per decade over three decades: four to six digits of the force for smooth bodies.
    pub fn new(model: M) -> Self {
        Self { model, per_decade: 16, decades: 3 }
    }

    /// The equivalent profile of a scene's elastic contact up to an approach > 0 (a length); effects of the
    /// scene are ignored.
    ///
    /// # Errors
    /// Those of M, for the surface, the loads and the solves; [`Error::Domain`] for an approach that is not
    /// positive or options out of range; [`Error::OutOfRange`] where k falls with d.
    pub fn profile(&self, scene: &Scene, seed: u64, approach: f64) -> Result<Tabulated> {
        let bare = Scene { outputs: Outputs::default(), ..scene.clone() };
        let mut normal = self.normal(&bare, seed)?;
        if !(approach.is_finite() && approach > 0.0) {
            return Err(Error::domain("approach", approach, "a finite number > 0"));
        }
        let (_, node) = normal.solve(NormalLoad::Approach(approach), &never)?;
        normal.reach(node, true, &never)?;
        Ok(Tabulated::clone(&normal.table))
    }

    fn normal(&self, scene: &Scene, seed: u64) -> Result<Normal> {
        if matches!(scene.surface, Surface::Profile(_)) {
            let what = "a profile (a body uniform along y): friction and rheology go through an equivalent body in three dimensions";
            return Err(Error::unsupported(NAME, what));
        }
        for (name, value, most) in [("per_decade", self.per_decade, 1000), ("decades", self.decades, 12)] {
            if !(1..=most).contains(&value) {
                return Err(Error::domain(name, f64::from(value), format!("1 to {most}")));
            }
        }
        let outputs = scene.outputs;
        let lean = Outputs {
            stiffness: true,
            stiffness_fixed_area: outputs.stiffness_fixed_area,
            area: outputs.area,
            conductance: outputs.conductance,
            ..Outputs::default()
        };
        let prepare = |outputs| {
            let elastic = Scene { effects: Effects::default(), outputs, ..scene.clone() };
            self.model.prepare(&elastic, seed)
        };
        let contact = prepare(lean)?;
        let rich = outputs.any_field() || outputs.contact_patches;
        let full = rich.then(|| prepare(Outputs { stiffness: true, ..outputs })).transpose()?;
        Normal::new(
            contact,
            full,
            outputs,
            f64::from(self.per_decade),
            (self.decades * self.per_decade).cast_signed(),
        )
    }
}

impl<M: ContactModel> ContactModel for Equivalent<M> {
    fn name(&self) -> &'static str {
        NAME
    }

    /// Those of the profile; the model of the normal contact has its own.
    fn sources(&self) -> &'static [Source] {
        &[
            Source {
                citation: "V. L. Popov, M. Hess, Method of Dimensionality Reduction in Contact Mechanics and Friction, Springer (2015)",
                what: "springs with Coulomb's limit (Ch. 5), springs that relax (Ch. 7), profiles of contacts of any shape from their k(d)",
            },
            Source {
                citation: "J. Jaeger, Arch. Appl. Mech. 65, 478 (1995); M. Ciavarella, J. Appl. Mech. 65, 998 (1998)",
                what: "partial slip as a difference of normal contacts, for any shape",
            },
            Source {
                citation: "E. H. Lee, J. R. M. Radok, J. Appl. Mech. 27, 438 (1960)",
                what: "viscoelastic contact while the contact grows",
            },
        ]
    }

    /// That of the model of the normal contact.
    fn least_memory(&self, scene: &Scene) -> Option<RequiredMemory> {
        self.model.least_memory(scene)
    }

    fn abilities(&self) -> Abilities {
        const EFFECTS: &[Effect] = &[
            Effect::Friction,
            Effect::KelvinVoigt,
            Effect::Maxwell,
            Effect::StandardSolid,
            Effect::PronySeries,
        ];
        // Those of an elastic contact with free boundaries; M refuses what it lacks of them itself.
        const OUTPUTS: &[Output] = &[
            Output::Stiffness,
            Output::StiffnessFixedArea,
            Output::Area,
            Output::Pressure,
            Output::Displacement,
            Output::Gap,
            Output::ContactPatches,
            Output::Conductance,
        ];
        // A profile has no approach, and a body is no line. M refuses what it lacks of the others itself.
        const SURFACES: &[SurfaceKind] = &[
            SurfaceKind::Line,
            SurfaceKind::SelfAffine,
            SurfaceKind::Heights,
            SurfaceKind::Sphere,
            SurfaceKind::Cone,
            SurfaceKind::PowerLaw,
            SurfaceKind::FlatCircle,
            SurfaceKind::Flat,
            SurfaceKind::Sine,
        ];
        const NOT_COMBINED: &[NotCombined] = &[NotCombined {
            effects: [
                &[Effect::Friction],
                &[Effect::KelvinVoigt, Effect::Maxwell, Effect::StandardSolid, Effect::PronySeries],
            ],
            reason: "not solved, as springs that relax and slip have two memories that act on each other",
        }];
        let of_a_line = self.model.abilities().surfaces.contains(&SurfaceKind::Line);
        let surfaces = &SURFACES[usize::from(!of_a_line)..];
        Abilities {
            surfaces,
            outputs: OUTPUTS,
            effects: EFFECTS,
            not_combined: NOT_COMBINED,
            needs_effect: true,
            paths: Paths::Remembered,
            ..Abilities::ELASTIC
        }
    }

    fn prepare(&self, scene: &Scene, seed: u64) -> Result<Box<dyn PreparedContact>> {
        let Effects { friction, rheology, .. } = scene.effects;
        if scene.effects.hardness != Hardness::Off || scene.effects.adhesion != Adhesion::Off {
            let what = "hardness or adhesion: an equivalent profile has one k(d), and with them k depends on the path";
            return Err(Error::unsupported(NAME, what));
        }
        self.abilities().refuse(NAME, scene)?;
        let memory = match (friction.law(), rheology.spectrum(scene.contact_modulus)?) {
            (Some(FrictionLaw { coefficient, .. }), _) => {
                let Some(pair) = scene.pair else {
                    let what = "a scene without both bodies: friction needs their shear moduli";
                    return Err(Error::unsupported(NAME, what));
                };
                let shear = pair.shear_modulus()? / scene.contact_modulus;
                let table = Arc::new(Tabulated::new(&[])?);
                EquivalentMemory::Slip {
                    springs: Springs::new(table, coefficient, shear),
                    coefficient,
                    time: 0.0,
                }
            }
            (None, Some(spectrum)) => {
                if let Some(pair) = &scene.pair {
                    rheology.check_pair(pair, NAME)?;
                }
                if scene.outputs.pressure {
                    return Err(Error::unsupported(NAME, "a pressure field with rheology (M's is elastic)"));
                }
                if scene.outputs.stiffness || scene.outputs.stiffness_fixed_area {
                    let what = "the stiffness with rheology (it depends on how fast one pushes)";
                    return Err(Error::unsupported(NAME, what));
                }
                EquivalentMemory::Relax(Relaxation::new(ViscoelasticMaterial::new(spectrum), NAME))
            }
            (None, None) => {
                return Err(Error::unsupported(
                    NAME,
                    "an elastic contact without friction (nothing to remember)",
                ));
            }
        };
        Ok(Box::new(PreparedEquivalent { normal: self.normal(scene, seed)?, memory }))
    }
}

enum EquivalentMemory {
    Slip { springs: Springs<Arc<Tabulated>>, coefficient: f64, time: f64 },
    Relax(Relaxation),
}

struct PreparedEquivalent {
    normal: Normal,
    memory: EquivalentMemory,
}

impl PreparedContact for PreparedEquivalent {
    fn normalisation(&self) -> Normalisation {
        self.normal.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.solve_as_step(load, stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
        let normal = &mut self.normal;
        match &mut self.memory {
            EquivalentMemory::Slip { springs, coefficient, time } => {
                let step = step.validated(*time)?;
                step.load.tangential.refuse_y(NAME)?;
                let (next, state) = slip(normal, springs, *coefficient, step, stop)?;
                (*springs, *time) = (next, step.time);
                Ok(state)
            }
            EquivalentMemory::Relax(relaxation) => {
                let step = relaxation.validated(step)?;
                relax(normal, relaxation, step, stop)
            }
        }
    }

    fn restart(&mut self) {
        match &mut self.memory {
            EquivalentMemory::Slip { springs, time, .. } => (*springs, *time) = (springs.unloaded(), 0.0),
            EquivalentMemory::Relax(relaxation) => relaxation.restart(),
        }
    }
}

/// The springs at the end of a step, and the state.
fn slip(
    normal: &mut Normal,
    springs: &Springs<Arc<Tabulated>>,
    coefficient: f64,
    step: Step,
    stop: Stop<'_>,
) -> Result<(Springs<Arc<Tabulated>>, ContactState)> {
    let (state, node) = normal.solve(step.load.normal, stop)?;
    normal.reach(node, springs.approach() <= 0.0, stop)?;
    let springs = springs.on(Arc::clone(&normal.table));
    let nondimensional = normal.nondimensional;
    // What the table makes of M's force: 1 at a node, and where it is not, forces follow M.
    let own = springs.normal_force(node.approach);
    let ratio = if own > 0.0 { node.force / own } else { 1.0 };
    let next = match step.load.tangential {
        Tangential::Force([force, _]) => {
            let scaled = nondimensional.force_in(force);
            let held = springs.held(node.approach, coefficient * own, scaled / ratio);
            held.ok_or_else(|| Error::gross_slip(force, coefficient * state.force))?
        }
        Tangential::Displacement([u, _]) => springs.moved(node.approach, nondimensional.length_in(u)),
        other => return Err(Error::unsupported_load(NAME, other)),
    };
    let tangential = next
        .state(step.load.tangential, ratio, nondimensional)?
        .with_sliding_force(coefficient * state.force);
    let state = normal
        .reported(state, node.approach)
        .with_time(step.time)
        .with_contact_radius(nondimensional.approach(node.radius)?)
        .with_tangential(tangential);
    Ok((next, state))
}

/// Follows a step of a growing viscoelastic contact.
fn relax(
    normal: &mut Normal,
    relaxation: &mut Relaxation,
    step: Step,
    stop: Stop<'_>,
) -> Result<ContactState> {
    let fresh = relaxation.at.contact.approach <= 0.0;
    let nondimensional = normal.nondimensional;
    let mut solved = None;
    let mut press = |load: NormalLoad| {
        let (state, node) = normal.solve(load, stop)?;
        solved = Some(state);
        normal.reach(node, fresh, stop)?;
        let Node { approach, force, radius, .. } = node;
        Ok((RoundContact { force, approach, radius }, Arc::clone(&normal.table)))
    };
    let at = match step.load.normal {
        NormalLoad::Force(force) => {
            relaxation.by_force(step.time, nondimensional.force_in(force), |load| {
                Ok(press(NormalLoad::Force(nondimensional.force(load)?))?.0)
            })?
        }
        NormalLoad::Approach(approach) => {
            relaxation.by_approach(step.time, nondimensional.approach_in(approach), |approach| {
                press(NormalLoad::Approach(nondimensional.approach(approach)?))
            })?
        }
        other => return Err(Error::unsupported_load(NAME, other)),
    };
    let Some(mut state) = solved else {
        return Err(Error::unsupported(NAME, "a step without a contact"));
    };
    at.check()?;
    state.force = match step.load.normal {
        NormalLoad::Force(force) => force,
        _ => nondimensional.force(at.memory.force)?,
    };
    state.approach = Some(match step.load.normal {
        NormalLoad::Approach(approach) => approach,
        _ => nondimensional.approach(at.contact.approach)?,
    });
    // The contact area is that of the elastic contact; the pressures have another history.
    if let Some(resolution) = &mut state.resolution {
        resolution.largest_pressure = None;
    }
    let certificate = &mut state.report.certificate;
    certificate.load_error = certificate.load_error.max(at.residual);
    let radius = nondimensional.approach(at.contact.radius)?;
    let state = normal.reported(state, at.contact.approach).with_time(step.time).with_contact_radius(radius);
    relaxation.at = at;
    Ok(state)
}

#[cfg(test)]
mod tests;
