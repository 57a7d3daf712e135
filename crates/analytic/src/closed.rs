//! What all closed forms share: a law in units of its own becomes a [`PreparedContact`].

use contact_model::{
    ContactState, Error, Load, Nondimensionalisation, Normalisation, Output, Outputs, PreparedContact,
    Result, Scene, Size, SolveReport, Stop, Surface,
};
use std::f64::consts::PI;

/// A closed form between force, approach and stiffness, in the [`Nondimensionalisation`] of its [`Closed`];
/// loads are positive.
pub(crate) trait ClosedLaw: Send {
    /// State at a force.
    fn at_force(&self, force: f64) -> Result<ClosedState>;
    /// State at an approach.
    fn at_approach(&self, approach: f64) -> Result<ClosedState>;
}

/// One state of a [`ClosedLaw`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ClosedState {
    pub force: f64,
    pub approach: f64,
    pub stiffness: f64,
    /// `None` where the theory has no area; its model then refuses to be asked.
    pub area: Option<f64>,
}

/// A law with its normalisation and what is asked of it.
pub(crate) struct Closed<L> {
    pub model: &'static str,
    pub law: L,
    pub nondimensional: Nondimensionalisation,
    pub normalisation: Normalisation,
    pub outputs: Outputs,
    /// For [`SolveReport::strategy`].
    pub strategy: &'static str,
    /// Relative uncertainty of the stiffness that the theory itself states.
    pub stiffness_error: f64,
}

impl ClosedState {
    /// A round contact inside a face of this size.
    pub fn round(force: f64, approach: f64, radius: f64, size: Size) -> Result<Self> {
        within(radius, size)?;
        Ok(Self { force, approach, stiffness: 2.0 * radius, area: Some(PI * radius * radius) })
    }
}

/// A law of a body in units of its side, made ready for its scene.
pub(crate) fn prepared<L: ClosedLaw + 'static>(
    scene: &Scene,
    model: &'static str,
    (strategy, stiffness_error): (&'static str, f64),
    law: L,
) -> Result<Box<dyn PreparedContact>> {
    let (nondimensional, normalisation) = of_body(scene)?;
    let outputs = scene.outputs;
    Ok(Box::new(Closed { model, law, nondimensional, normalisation, outputs, strategy, stiffness_error }))
}

impl<L: ClosedLaw> PreparedContact for Closed<L> {
    fn normalisation(&self) -> Normalisation {
        self.normalisation
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let nondimensional = self.nondimensional;
        let (asked, value) = match load.validated()? {
            Load::Force(force) => (force, nondimensional.force_in(force)),
            Load::Approach(approach) => (approach, nondimensional.approach_in(approach)),
            _ => return Err(Error::unsupported(self.model, format!("the load {load:?}"))),
        };
        let point = if asked <= 0.0 {
            ClosedState { force: 0.0, approach: 0.0, stiffness: 0.0, area: Some(0.0) }
        } else if value.is_finite() && value > 0.0 {
            match load {
                Load::Force(_) => self.law.at_force(value)?,
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
        let (force, approach) = match load {
            Load::Force(force) => (force, nondimensional.approach(point.approach)?),
            _ => (nondimensional.force(point.force)?, asked),
        };
        let stiffness =
            self.outputs.needs_stiffness().then(|| nondimensional.stiffness(point.stiffness)).transpose()?;
        let area =
            point.area.filter(|_| self.outputs.area).map(|area| nondimensional.area(area)).transpose()?;
        let mut report = SolveReport::exact(self.strategy);
        report.certificate.stiffness_error = stiffness.map(|_| self.stiffness_error);
        report.certificate.force_error = force_error(load);
        ContactState::new(force, report)
            .with_approach(approach)
            .with_elastic_stiffness(stiffness)
            .with_area(area)
            .completed(&self.outputs, self.normalisation.modulus)
    }
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

/// Outputs of closed forms that have an area.
pub(crate) const WITH_AREA: &[Output] =
    &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area];
/// Those of periodic ones.
pub(crate) const PERIODIC: &[Output] =
    &[Output::Stiffness, Output::StiffnessFixedArea, Output::Conductance, Output::Area, Output::MeanGap];

/// Units and normalisation of a body without rms height: everything is counted in `L = sqrt(Lx Ly)`.
///
/// # Errors
/// [`Error::Domain`] for a modulus or length that no unit can be.
pub(crate) fn of_body(scene: &Scene) -> Result<(Nondimensionalisation, Normalisation)> {
    let (modulus, length) = (scene.modulus, scene.surface.size().length());
    Ok((
        Nondimensionalisation::new(modulus, length, length)?,
        Normalisation { modulus, length, height: None },
    ))
}

/// Errors where a round contact (radius in units of L) has left the rectangle, beyond which the half-space is
/// free.
pub(crate) fn within(radius: f64, size: Size) -> Result<()> {
    let (length, shorter) = (size.length(), size.shorter());
    if radius <= 0.5 * (shorter / length) * ROUNDED_UP {
        Ok(())
    } else {
        let value = radius * length;
        Err(Error::OutOfRange { name: "contact radius".into(), value, min: 0.0, max: 0.5 * shorter })
    }
}

/// A load exactly at the end of a range may come out a few roundings beyond it.
pub(crate) const ROUNDED_UP: f64 = 1.0 + 8.0 * f64::EPSILON;

/// Relative error of the force of a closed form, where it is a result.
pub(crate) fn force_error(load: Load) -> Option<f64> {
    matches!(load, Load::Approach(_)).then_some(0.0)
}

/// Slope `dd/da` over that far from it, below which a state is the pull-off under prescribed approach: a radius
/// that is found from an approach has half its digits there, and its `dF/dd` none.
pub(crate) const AT_FOLD: f64 = 1e-7;

fn out_of_f64(value: f64) -> Error {
    Error::domain("state in units of side and modulus", value, "numbers within the range of f64")
}
