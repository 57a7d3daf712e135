//! A state of contact pressure and attraction at one load.

use super::attraction::Attraction;
use crate::active_set::{Bounds, Problem, Residuals};
use crate::geometry::CellSet;
use crate::linear::Fixed;
use crate::real::{dot, sum};
use serde::{Deserialize, Serialize};

/// Smallest force that the error of a prescribed force is relative to, as a share of the force of the contact
/// pressure. The sums of pressure and attraction, whose difference is the force, have roundings of some 1e-16 of
/// that, which a tolerance of 1e-12 leaves room for.
const SMALLEST: f64 = 1e-3;

/// What is prescribed, nondimensional; of either sign.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum AdhesiveControl {
    /// Sum of the net pressure.
    Force(f64),
    /// Plane: the approach with free boundaries; with periodic ones the approach that a kernel of zero mean
    /// has, which is the mean of the heights less the mean gap.
    Plane(f64),
}

impl AdhesiveControl {
    /// The quantity that is fixed while the contact is corrected; `shift` is the constant in the kernel, 0
    /// with free boundaries.
    pub(super) fn fixed(self, shift: f64) -> Fixed {
        match self {
            Self::Force(_) => Fixed::Force,
            Self::Plane(_) if shift > 0.0 => Fixed::MeanPlane(shift),
            Self::Plane(_) => Fixed::Approach,
        }
    }
}

/// A state: contact pressure, attraction and gap on the cells within reach.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Equilibrium {
    /// Approach.
    pub d: f64,
    /// All cells that can touch or be attracted.
    pub cells: CellSet,
    /// The cells are those whose undeformed gap is below this approach.
    pub(super) reach: f64,
    /// Contact pressure on them, >= 0.
    pub pressure: Vec<f64>,
    /// Attractive traction on them, >= 0.
    pub attraction: Vec<f64>,
    /// Gap on them, with the exact operator.
    pub gap: Vec<f64>,
    /// The attraction of the law at that gap.
    pub(super) lawful: Vec<f64>,
    /// Residuals of the contact conditions.
    pub residuals: Residuals,
    /// Largest mismatch of attraction and gap.
    pub mismatch: f64,
    /// Steps of conjugate gradients.
    pub steps: usize,
    /// Updates.
    pub updates: usize,
}

impl Equilibrium {
    /// The same state with its work counters at zero.
    pub fn again(&self) -> Self {
        Self { steps: 0, updates: 0, ..self.clone() }
    }

    /// Net pressure on the cells.
    pub fn net(&self) -> Vec<f64> {
        self.pressure.iter().zip(&self.attraction).map(|(p, s)| p - s).collect()
    }

    /// The force that the error of a prescribed force is relative to: the prescribed one, or a share of the
    /// force of the contact pressure where that is larger, as near a force of zero pressure and attraction
    /// cancel.
    pub fn force_scale(&self, asked: f64) -> f64 {
        asked.abs().max(SMALLEST * sum(&self.pressure))
    }

    /// The plane of [`AdhesiveControl::Plane`] that a state has, from the constant in the kernel.
    pub fn plane(&self, shift: f64) -> f64 {
        self.d - shift * self.force()
    }

    /// The largest gap left on the contact, or penetration beside it. Cells at the upper bound of the pressure may
    /// penetrate.
    pub fn largest_gap_left(&self, bounds: Bounds) -> f64 {
        let gaps = self.pressure.iter().zip(&self.gap);
        gaps.map(|(&p, &g)| bounds.violation(p, g)).fold(0.0, f64::max)
    }

    /// The cells at the upper bound of the pressure, and how deep they are indented by this state.
    pub fn indented(&self, bounds: Bounds) -> (CellSet, Vec<f64>) {
        if !bounds.is_reached(&self.pressure) {
            return (CellSet::default(), Vec::new());
        }
        let saturated = self.cells.filter(&self.pressure, |p| p >= bounds.upper());
        let depth = saturated.carry(&self.cells, &self.gap).iter().map(|gap| (-gap).max(0.0)).collect();
        (saturated, depth)
    }

    /// Net force.
    pub fn force(&self) -> f64 {
        sum(&self.pressure) - sum(&self.attraction)
    }

    /// The contact set.
    pub fn contact(&self) -> CellSet {
        self.cells.filter(&self.pressure, |p| p > 0.0)
    }

    /// The same state of a body with another modulus, on cells that are looked up anew.
    pub fn scaled(&self, factor: f64) -> Self {
        let scaled = |values: &[f64]| values.iter().map(|value| value * factor).collect();
        Self {
            reach: f64::NEG_INFINITY,
            pressure: scaled(&self.pressure),
            attraction: scaled(&self.attraction),
            lawful: scaled(&self.lawful),
            ..self.clone()
        }
    }

    /// Takes other cells, those below `reach`; values are carried over.
    pub(super) fn take_cells(&mut self, cells: CellSet, reach: f64) {
        for values in [&mut self.pressure, &mut self.attraction, &mut self.gap] {
            *values = cells.carry(&self.cells, values);
        }
        (self.cells, self.reach) = (cells, reach);
    }
}

/// Energy of a state, elastic and of the attraction. `shift` is the constant in the kernel, which stores no
/// energy.
pub fn energy(problem: &Problem, attraction: &Attraction, state: &Equilibrium) -> f64 {
    let z = problem.candidates.gaps(&state.cells);
    let force = state.force();
    let net = state.net();
    let u: Vec<f64> = state.gap.iter().zip(&z).map(|(g, z)| g - z + state.d).collect();
    let elastic = 0.5 * (dot(&net, &u) - problem.operators.table().shift() * force * force);
    elastic + attraction.energy(&state.cells, &state.gap)
}
