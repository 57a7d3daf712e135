//! Common code of all closed forms: a law in units of its own becomes a [`PreparedContact`].

use contact_model::{
    Abilities, Adhesion, ContactModel, ContactState, Error, Load, NormalLoad, Normalisation, Output,
    PreparedContact, Result, ScaledState, Scaling, Scene, Size, SolveReport, Stop, Surface, SurfaceKind,
    check_stop,
};
use std::f64::consts::PI;

/// A theory that relates a load to a state.
pub(crate) trait LoadLaw: Send {
    /// The state under a load, with the requested outputs.
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState>;
}

/// A law made ready for its scene.
struct Prepared<L> {
    law: L,
    scaling: Scaling,
}

impl<L: LoadLaw> PreparedContact for Prepared<L> {
    fn normalisation(&self) -> Normalisation {
        self.scaling.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        check_stop(stop)?;
        self.law.state(load.without_tangential("of frictionless contact")?, &self.scaling)
    }
}

/// A contact that a law answers.
pub(crate) fn prepared<L: LoadLaw + 'static>(scaling: Scaling, law: L) -> Box<dyn PreparedContact> {
    Box::new(Prepared { law, scaling })
}

/// A closed form between force, approach and stiffness; loads are positive.
pub(crate) trait ClosedLaw: Send {
    /// State at a force.
    fn at_force(&self, force: f64) -> Result<ClosedState>;
    /// State at an approach.
    fn at_approach(&self, approach: f64) -> Result<ClosedState>;
    /// State without a load.
    fn unloaded(&self) -> ClosedState {
        ClosedState { area: Some(0.0), ..ClosedState::default() }
    }
}

/// One state of a [`ClosedLaw`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct ClosedState {
    pub force: f64,
    pub approach: f64,
    pub stiffness: f64,
    /// `None` where the theory has no area; its model then refuses the output.
    pub area: Option<f64>,
    /// Of a round contact.
    pub radius: Option<f64>,
    /// `None` where the theory does not state one, or where it is infinite.
    pub largest_pressure: Option<f64>,
}

/// A closed form of an elastic contact without adhesion.
pub(crate) struct Closed<L> {
    pub model: &'static str,
    pub law: L,
    /// For [`SolveReport::strategy`].
    pub strategy: &'static str,
    /// Relative uncertainty of the stiffness that the theory itself states.
    pub stiffness_error: f64,
}

/// The quantities of a round contact that follow from its radius alone.
pub(crate) fn round(radius: f64) -> ScaledState {
    let area = PI * radius * radius;
    ScaledState {
        stiffness_fixed_area: Some(2.0 * radius),
        area: Some(area),
        contact_radius: Some(radius),
        ..ScaledState::default()
    }
}

impl ClosedState {
    /// A round body without a load, which touches in a point.
    pub fn round_unloaded() -> Self {
        Self { area: Some(0.0), radius: Some(0.0), ..Self::default() }
    }

    /// A round contact inside a face of this size.
    pub fn round(force: f64, approach: f64, radius: f64, size: Size) -> Result<Self> {
        within(radius, size)?;
        let area = Some(PI * radius * radius);
        let stiffness = 2.0 * radius;
        Ok(Self { force, approach, stiffness, area, radius: Some(radius), ..Self::default() })
    }
}

impl<L: ClosedLaw> LoadLaw for Closed<L> {
    fn state(&self, load: NormalLoad, scaling: &Scaling) -> Result<ContactState> {
        let nondimensional = scaling.nondimensional;
        let (asked, value) = match load.validated()? {
            NormalLoad::Force(force) => (force, nondimensional.force_in(force)),
            NormalLoad::Approach(approach) => (approach, nondimensional.approach_in(approach)),
            _ => return Err(Error::unsupported_load(self.model, load)),
        };
        let point = if asked <= 0.0 {
            self.law.unloaded()
        } else if value.is_finite() && value > 0.0 {
            match load {
                NormalLoad::Force(_) => self.law.at_force(value)?,
                _ => self.law.at_approach(value)?,
            }
        } else {
            return Err(out_of_f64(value));
        };
        // A loaded contact of which nothing is left in f64 is no state.
        if asked > 0.0 {
            for value in [point.force, point.approach, point.stiffness] {
                if !(value.is_finite() && value > 0.0) {
                    return Err(out_of_f64(value));
                }
            }
        }
        let scaled = ScaledState {
            force: point.force,
            approach: Some(point.approach),
            area: point.area,
            contact_radius: point.radius,
            largest_pressure: point.largest_pressure,
            stiffness_error: self.stiffness_error,
            ..ScaledState::default()
        };
        let report = SolveReport::formula(self.strategy, load);
        scaling.state(scaled.with_elastic_stiffness(point.stiffness), load, report)
    }
}

/// A law of a body in units of its side, made ready for its scene.
pub(crate) fn of_body<L: ClosedLaw + 'static>(
    scene: &Scene,
    model: &'static str,
    (strategy, stiffness_error): (&'static str, f64),
    law: L,
) -> Result<Box<dyn PreparedContact>> {
    Ok(prepared(Scaling::of_body(scene)?, Closed { model, law, strategy, stiffness_error }))
}

/// Refuses a profile, with the reason of theories of rough surfaces.
///
/// # Errors
/// [`Error::Unsupported`].
pub(crate) fn refuse_profile(scene: &Scene, model: &'static str) -> Result<()> {
    if matches!(scene.surface, Surface::Profile(_)) {
        let what = "a profile (a body uniform along y): the theory is one of isotropic surfaces, and a profile is none";
        return Err(Error::unsupported(model, what));
    }
    Ok(())
}

/// The radius of a sphere and the size of its rectangle, of a scene of which a model can do everything.
///
/// # Errors
/// [`Error::Unsupported`] for what the model lacks, and for another surface.
pub(crate) fn sphere(model: &dyn ContactModel, scene: &Scene) -> Result<(f64, Size)> {
    model.abilities().refuse(model.name(), scene)?;
    match scene.surface {
        Surface::Sphere { radius, size } => Ok((radius, size)),
        ref other => Err(Error::unsupported(model.name(), other.kind())),
    }
}

/// The work of short-range adhesion, 0 where it is off.
///
/// # Errors
/// [`Error::Unsupported`] for another adhesion.
pub(crate) fn short_range_work(scene: &Scene, model: &'static str) -> Result<f64> {
    match scene.effects.adhesion {
        Adhesion::Off => Ok(0.0),
        Adhesion::ShortRange { work } => Ok(work),
        other => Err(Error::unsupported(model, format!("adhesion ({other:?})"))),
    }
}

/// Outputs of closed forms that have an area.
pub(crate) const WITH_AREA: &[Output] =
    &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area];

/// A sphere, elastic and without friction.
pub(crate) const SPHERE: Abilities =
    Abilities { surfaces: &[SurfaceKind::Sphere], outputs: WITH_AREA, ..Abilities::ELASTIC };

/// Errors where a round contact (radius in units of L) has left the rectangle, beyond which the half-space is
/// free.
pub(crate) fn within(radius: f64, size: Size) -> Result<()> {
    size.admit_radius("contact radius", radius * size.length())
}

/// A load exactly at the end of a range may come out a few roundings beyond it.
pub(crate) const ROUNDED_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Slope `dd/da` over that far from it, below which a state is the pull-off under prescribed approach: a
/// radius that is found from an approach has half its digits there, and its `dF/dd` none.
pub(crate) const AT_FOLD: f64 = 1e-7;

fn out_of_f64(value: f64) -> Error {
    Error::not_representable("state in units of side and modulus", value)
}
