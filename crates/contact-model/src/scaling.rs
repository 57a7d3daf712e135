//! From the dimensionless numbers of a formula to a state: its units and its requested outputs.

use crate::error::Result;
use crate::load::NormalLoad;
use crate::nondimensionalisation::Nondimensionalisation;
use crate::normalisation::Normalisation;
use crate::quantities::Outputs;
use crate::scene::Scene;
use crate::state::{ContactResolution, ContactState, SolveReport};

/// The units in which a model computes, the normalisation of what it reports, and the requested outputs.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Scaling {
    /// Units that turn the model's numbers into those of the caller.
    pub nondimensional: Nondimensionalisation,
    /// Normalisation that turns those into `F_bar` and `k_bar`.
    pub normalisation: Normalisation,
    /// Requested outputs.
    pub outputs: Outputs,
}

/// A state in the units of a [`Scaling`]. A quantity that a theory does not claim is `None`.
///
/// ```
/// use contact_model::{NormalLoad, ScaledState, Scaling, Scene, SolveReport, Surface};
/// let mut scene = Scene::new(Surface::Flat { size: 2.0.into() }, 3.0);
/// scene.outputs.area = true;
/// // A flat of stiffness 1.15 E* L that is pressed by 0.01 L.
/// let scaled = ScaledState { force: 0.0115, approach: Some(0.01), area: Some(1.0), ..ScaledState::default() };
/// let load = NormalLoad::Approach(0.02);
/// let report = SolveReport::formula("a constant", load);
/// let state = Scaling::of_body(&scene)?.state(scaled.with_elastic_stiffness(1.15), load, report)?;
/// assert!((state.force - 0.0115 * 12.0).abs() < 1e-15);
/// assert_eq!((state.approach, state.stiffness, state.area), (Some(0.02), Some(1.15 * 6.0), Some(4.0)));
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[allow(clippy::exhaustive_structs)] // A model writes it, as it does its abilities.
pub struct ScaledState {
    /// Normal force.
    pub force: f64,
    /// Approach.
    pub approach: Option<f64>,
    /// Stiffness along the branch.
    pub stiffness: Option<f64>,
    /// Stiffness at fixed contact area.
    pub stiffness_fixed_area: Option<f64>,
    /// Relative uncertainty of the stiffnesses.
    pub stiffness_error: f64,
    /// Real contact area.
    pub area: Option<f64>,
    /// Radius of a round contact, in the unit of heights.
    pub contact_radius: Option<f64>,
    /// Largest pressure, where the formula has a finite one.
    pub largest_pressure: Option<f64>,
}

impl ScaledState {
    /// With the stiffness of an elastic contact, which is the same along the branch and at fixed contact
    /// area.
    #[must_use]
    pub fn with_elastic_stiffness(self, stiffness: impl Into<Option<f64>>) -> Self {
        let stiffness = stiffness.into();
        Self { stiffness, stiffness_fixed_area: stiffness, ..self }
    }
}

impl Scaling {
    /// A scene whose solver uses `height` as its unit of heights, and whose surface has the measured rms
    /// height `rms`.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] for a modulus or length that no unit can be.
    pub fn new(scene: &Scene, height: f64, rms: Option<f64>) -> Result<Self> {
        let (contact_modulus, length) = (scene.contact_modulus, scene.surface.size().length());
        Ok(Self {
            nondimensional: Nondimensionalisation::new(contact_modulus, length, height)?,
            normalisation: Normalisation { contact_modulus, length, height: rms },
            outputs: scene.outputs,
        })
    }

    /// A body without rms height, with `L = sqrt(Lx Ly)` as the unit of all lengths.
    ///
    /// # Errors
    /// As [`Scaling::new`].
    pub fn of_body(scene: &Scene) -> Result<Self> {
        Self::new(scene, scene.surface.size().length(), None)
    }

    /// A rough surface of this rms height, which is also the unit of heights.
    ///
    /// # Errors
    /// As [`Scaling::new`].
    pub fn of_rough(scene: &Scene, rms: f64) -> Result<Self> {
        Self::new(scene, rms, Some(rms))
    }

    /// The same in other units.
    #[must_use]
    pub fn in_units(self, nondimensional: Nondimensionalisation) -> Self {
        Self { nondimensional, ..self }
    }

    /// The state under a load: it holds the prescribed number exactly, and of the other quantities those that
    /// are requested.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] for a number that no `f64` holds.
    pub fn state(
        &self,
        scaled: ScaledState,
        load: NormalLoad,
        mut report: SolveReport,
    ) -> Result<ContactState> {
        let Self { nondimensional, normalisation, outputs } = self;
        let force = match load {
            NormalLoad::Force(force) => force,
            _ => nondimensional.force(scaled.force)?,
        };
        let approach = match load {
            NormalLoad::Approach(approach) => Some(approach),
            _ => scaled.approach.map(|approach| nondimensional.approach(approach)).transpose()?,
        };
        let asked = |value: Option<f64>, asked: bool, convert: &dyn Fn(f64) -> Result<f64>| {
            value.filter(|_| asked).map(convert).transpose()
        };
        let of_stiffness = |stiffness| nondimensional.stiffness(stiffness);
        let slope = asked(scaled.stiffness, outputs.needs_stiffness(), &of_stiffness)?;
        let held = asked(scaled.stiffness_fixed_area, outputs.needs_fixed_area(), &of_stiffness)?;
        let area = asked(scaled.area, outputs.area, &|area| nondimensional.area(area))?;
        let radius = scaled.contact_radius.map(|radius| nondimensional.approach(radius)).transpose()?;
        let pressure =
            scaled.largest_pressure.map(|pressure| nondimensional.pressure(pressure)).transpose()?;
        report.certificate.stiffness_error = slope.or(held).map(|_| scaled.stiffness_error);
        ContactState::new(force, report)
            .with_approach(approach)
            .with_stiffness(slope)
            .with_stiffness_fixed_area(held)
            .with_area(area)
            .with_contact_radius(radius)
            .with_resolution(pressure.map(ContactResolution::of_formula))
            .completed(outputs, normalisation.contact_modulus)
    }
}

impl SolveReport {
    /// [`SolveReport::exact`] of a formula that also accepts an approach: the force that follows from it is
    /// exact.
    pub fn formula(strategy: impl Into<String>, load: NormalLoad) -> Self {
        let mut report = Self::exact(strategy);
        report.certificate.force_error = matches!(load, NormalLoad::Approach(_)).then_some(0.0);
        report
    }
}
