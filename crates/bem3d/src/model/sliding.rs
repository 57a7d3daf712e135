//! The friction of a surface, and the tangential part of a state.

use super::options::NAME;
use crate::active_set::Problem;
use crate::friction::{FrictionSolver, FrictionState, SlipMemory};
use crate::geometry::CellSet;
use crate::parts::Recorder;
use crate::response::TangentialStiffness;
use crate::tuning::Tuning;
use contact_model::{
    Certificate, Coupling, Error, FrictionLaw, Nondimensionalisation, Result, Scene, Tangential,
};
use std::f64::consts::PI;
use std::sync::Arc;

/// The friction of a surface.
#[derive(Debug)]
pub(super) struct SurfaceFriction {
    pub(super) friction: FrictionSolver,
    /// The law, for nondimensional pressures and tractions.
    pub(super) law: FrictionLaw,
    /// Whether it acts on the attached share of each cell in place of its pressure.
    pub(super) on_shares: bool,
    /// Whether tractions change while nothing slips, as those of a body with a history do.
    pub(super) relaxes: bool,
    /// The undeformed gaps, without displacements under tractions.
    pub(super) undeformed: Arc<Vec<f64>>,
    /// The start of the next increment.
    pub(super) before: SlipMemory,
    /// Nondimensional energy that friction dissipated since the first step.
    pub(super) dissipated: f64,
}

/// The tangential part of a state, nondimensional.
#[derive(Debug)]
pub(super) struct Slid {
    /// The tangential load, as it was prescribed.
    pub(super) prescribed: Tangential,
    pub(super) state: FrictionState,
    /// The stiffness along the branch, and that of the whole contact in full stick.
    pub(super) stiffness: [Option<TangentialStiffness>; 2],
    /// Where both problems are coupled, dF/dd of both with the tangential load held, over pi, and its relative error.
    pub(super) normal_stiffness: Option<(f64, f64)>,
    /// The convergence of the alternation of normal and tangential contact, where these are coupled.
    pub(super) rounds: Option<(usize, Option<f64>)>,
}

impl Slid {
    /// How it was found, in one short phrase.
    pub(super) fn strategy(&self) -> String {
        let [newton, steps] = self.state.iterations;
        let coupled = match self.rounds {
            None => String::new(),
            Some((rounds, None)) => format!(", {rounds} rounds of coupling"),
            Some((rounds, Some(by))) => {
                format!(", {rounds} rounds of coupling, the last {by:.1e} of the one before")
            }
        };
        format!("friction {newton} x {steps}{coupled}")
    }

    /// Steps of conjugate gradients.
    pub(super) fn steps(&self) -> usize {
        self.state.iterations[1] + self.stiffness.iter().flatten().map(|k| k.steps).sum::<usize>()
    }

    /// Adds its residuals to a certificate.
    pub(super) fn certify(&self, certificate: &mut Certificate) {
        certificate.tangential_duality_gap = Some(self.state.duality_gap);
        certificate.tangential_load_error = Some(self.state.load_error);
        let errors = self.stiffness.iter().flatten().map(|k| k.solve_error + k.set_error);
        certificate.tangential_stiffness_error = errors.reduce(f64::max);
        if let Some((_, error)) = self.normal_stiffness {
            certificate.quotient_error = Some(error);
        }
    }
}

impl SurfaceFriction {
    /// The friction of a scene on the cells of a problem; `None` without.
    ///
    /// # Errors
    /// As [`Scene::coupling`]; [`contact_model::Error::Domain`] for a strength that is no number in the units of the
    /// surface.
    pub(super) fn new(
        scene: &Scene,
        problem: &Problem,
        units: Nondimensionalisation,
        (tuning, recorder): (&Tuning, &Recorder),
    ) -> Result<Option<Self>> {
        let coupling = scene.coupling(NAME)?;
        let (Some(law), Some(pair)) = (scene.effects.friction.law(), scene.pair) else {
            return Ok(None);
        };
        // E* sum nu/(2 G), from 1/G* = 1/E* + sum nu/(4 G).
        let compliance = (2.0 * (pair.contact_modulus()? / pair.shear_modulus()? - 1.0)).max(0.0);
        let beta = if coupling == Some(Coupling::Full) { pair.coupling()? } else { 0.0 };
        let boundary = problem.operators.table().boundary();
        Ok(Some(Self {
            friction: FrictionSolver::new(problem.grid(), boundary, [compliance, beta], tuning, recorder),
            law: nondimensional(law, units)?,
            on_shares: false,
            relaxes: false,
            undeformed: problem.candidates.shared(),
            before: SlipMemory::default(),
            dissipated: 0.0,
        }))
    }

    /// Resets the surface to its state before any load.
    pub(super) fn begin(&mut self) {
        (self.before, self.dissipated) = (SlipMemory::default(), 0.0);
    }

    /// From here on a shear strength acts on the attached share of each cell: what holds a cell is in proportion to
    /// it, as it is to the pressure by Coulomb's law.
    pub(super) fn act_on_shares(&mut self) {
        self.law = FrictionLaw::coulomb(self.law.largest_traction(0.0));
        self.on_shares = true;
    }

    /// Area of some cells of the last contact that friction acted on, in cells.
    pub(super) fn area(&self, cells: &CellSet, state: &SlipMemory) -> f64 {
        if self.on_shares {
            cells.carry(&state.cells, &state.pressure).iter().sum()
        } else {
            cells.len() as f64
        }
    }

    /// Whether the normal and the tangential problem are coupled.
    pub(super) fn is_coupled(&self) -> bool {
        self.friction.is_coupled()
    }
}

/// A law for pressures in the units of the surface, which are over pi.
fn nondimensional(law: FrictionLaw, units: Nondimensionalisation) -> Result<FrictionLaw> {
    let pressure = |name: &'static str, pressure: f64| {
        let scaled = units.pressure_in(pressure) / PI;
        if scaled.is_finite() && (scaled > 0.0) == (pressure > 0.0) {
            Ok(scaled)
        } else {
            Err(Error::domain(name, pressure, "a pressure nearer to E* times the slope of the surface"))
        }
    };
    Ok(FrictionLaw {
        coefficient: law.coefficient,
        shear_strength: pressure("shear strength of friction", law.shear_strength)?,
        limit: law.limit.map(|limit| pressure("limit of friction", limit)).transpose()?,
    })
}

/// The same law in the units of a body whose modulus is this many times as large.
pub(super) fn over(law: FrictionLaw, modulus: f64) -> FrictionLaw {
    FrictionLaw {
        coefficient: law.coefficient,
        shear_strength: law.shear_strength / modulus,
        limit: law.limit.map(|limit| limit / modulus),
    }
}
