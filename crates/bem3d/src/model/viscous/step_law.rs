//! How a viscoelastic material answers a step of time, and what its history leaves in each cell.

use crate::geometry::{CellSet, Grid};
use contact_model::RelaxationSpectrum;
use serde::{Deserialize, Serialize};

/// How the material answers a step of time in which P goes straight.
pub(super) struct StepLaw {
    /// M.
    pub modulus: f64,
    /// The share of `M H` that is `P` at the beginning, without arms.
    pub kept: f64,
    pub arms: Vec<ArmStep>,
}

/// `q = decay q_0 + rise (P - P_0)`.
pub(super) struct ArmStep {
    pub weight: f64,
    pub decay: f64,
    pub rise: f64,
}

impl StepLaw {
    /// That of a step of this duration; 0 is a jump.
    ///
    /// The arms are exact for a P that goes straight. A dashpot beside them takes the end of the step as if the
    /// pressure had been constant, which is of first order in the duration, but never alternates.
    pub fn new(spectrum: &RelaxationSpectrum, duration: f64) -> Self {
        let arms: Vec<_> = (spectrum.arms.iter())
            .map(|arm| {
                let angle = arm.rate * duration;
                let rise = if angle > 0.0 { -(-angle).exp_m1() / angle } else { 1.0 };
                ArmStep { weight: arm.weight, decay: (-angle).exp(), rise }
            })
            .collect();
        let (mut modulus, mut kept) = (spectrum.equilibrium, 0.0);
        if spectrum.is_stiff() {
            let angle = spectrum.equilibrium * duration / spectrum.viscous;
            modulus /= -(-angle).exp_m1();
            kept = modulus * (-angle).exp();
        }
        modulus += arms.iter().map(|arm| arm.weight * arm.rise).sum::<f64>();
        Self { modulus, kept, arms }
    }
}

/// The tractions with which an elastic body of the modulus E* would be displaced as the viscoelastic one is, on the
/// cells that ever bore one, and the memory of the arms: components one after the other.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TractionHistory {
    pub cells: CellSet,
    /// P.
    pub elastic: Vec<f64>,
    /// q of each arm: the true traction is `e P + sum w q` in units of E*.
    pub arms: Vec<Vec<f64>>,
}

impl TractionHistory {
    /// Before any load, of a material with this number of arms.
    pub fn new(arms: usize) -> Self {
        Self { arms: vec![Vec::new(); arms], ..Self::default() }
    }

    /// H: what the history leaves at the end of a step, on its cells.
    pub fn left(&self, law: &StepLaw) -> Vec<f64> {
        let mut left: Vec<f64> = self.elastic.iter().map(|p| law.kept * p).collect();
        for (arm, step) in self.arms.iter().zip(&law.arms) {
            for ((left, p), q) in left.iter_mut().zip(&self.elastic).zip(arm) {
                *left += step.weight * (step.rise * p - step.decay * q);
            }
        }
        for value in &mut left {
            *value /= law.modulus;
        }
        left
    }

    /// The history after a step that left H and solved for `P - H` on these cells.
    pub fn advanced(&self, law: &StepLaw, left: &[f64], loaded: &CellSet, solved: &[f64]) -> Self {
        let cells = self.cells.union(loaded);
        let before = carried(&cells, &self.cells, &self.elastic);
        let mut elastic = carried(&cells, &self.cells, left);
        if elastic.is_empty() {
            elastic.resize(cells.len() * (solved.len() / loaded.len().max(1)), 0.0);
        }
        let each = elastic.chunks_exact_mut(cells.len().max(1));
        for (sums, solved) in each.zip(solved.chunks_exact(loaded.len().max(1))) {
            cells.add_carried(loaded, solved, sums);
        }
        let arms = (self.arms.iter().zip(&law.arms))
            .map(|(arm, step)| {
                let mut arm = carried(&cells, &self.cells, arm);
                arm.resize(elastic.len(), 0.0);
                let before = before.iter().copied().chain(std::iter::repeat(0.0));
                for ((q, p), before) in arm.iter_mut().zip(&elastic).zip(before) {
                    *q = step.decay * *q + step.rise * (p - before);
                }
                arm
            })
            .collect();
        Self { cells, elastic, arms }
    }

    /// Whether its cells and numbers are those of a grid and a material, with this number of components.
    pub fn fits(&self, grid: Grid, arms: usize, components: usize) -> bool {
        let sound = |values: &Vec<f64>| {
            values.len() == components * self.cells.len() && values.iter().all(|value| value.is_finite())
        };
        self.cells.is_on(grid)
            && self.arms.len() == arms
            && sound(&self.elastic)
            && self.arms.iter().all(sound)
    }
}

/// Components on one set carried to another, one after the other; empty where there are none.
pub(super) fn carried(cells: &CellSet, from: &CellSet, values: &[f64]) -> Vec<f64> {
    values.chunks_exact(from.len().max(1)).flat_map(|values| cells.carry(from, values)).collect()
}
