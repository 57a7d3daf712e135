//! The memory of a path with a hardness: the indentation remains, and unloading is elastic until the old
//! pressures are reached again.

use crate::geometry::{CellSet, Grid};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The indentation of a surface, and the last state of its path.
///
/// Each step is solved on the surface as the last one left it. As long as loads rise, that is the same as one
/// step from the virgin surface: saturated cells stay so, and their indentation grows. Plastic flow under
/// falling loads is not excluded, and is included where it occurs.
///
/// Where a load is reached again, the old cells are about to flow, and the slope of the force jumps. The
/// state decides: cells of the indentation whose pressure is the hardness, within the tolerance, count as
/// saturated, and the stiffness is that of a load that goes on in the direction of its last change. With
/// growing load they flow, with falling load they do not.
#[derive(Debug, Clone)]
pub(super) struct IndentationMemory {
    /// Undeformed gaps of the virgin surface.
    pub virgin: Arc<Vec<f64>>,
    /// Depth of the plastic indentation, nondimensional, row-major; it is in the gaps of the problem.
    pub indentation: Vec<f64>,
    /// Force of the last state, nondimensional.
    force: f64,
    /// Whether it was reached with a growing load.
    rising: bool,
}

impl IndentationMemory {
    /// The memory of a virgin surface.
    pub fn new(virgin: Arc<Vec<f64>>) -> Self {
        Self { indentation: vec![0.0; virgin.len()], virgin, force: 0.0, rising: true }
    }

    /// Whether the load has grown to this force since the last state; where both are equal within
    /// `tolerance`, the last direction is kept.
    pub fn rises_to(&self, force: f64, tolerance: f64) -> bool {
        let same = (force - self.force).abs() <= tolerance * force.max(self.force);
        if same { self.rising } else { force > self.force }
    }

    /// The undeformed gaps of the indented surface.
    pub fn indented(&self) -> Arc<Vec<f64>> {
        Arc::new(self.virgin.iter().zip(&self.indentation).map(|(z, depth)| z + depth).collect())
    }

    /// Force of the last state, and whether it was reached with a growing load.
    pub fn reached(&self) -> (f64, bool) {
        (self.force, self.rising)
    }

    /// Restores the memory of a path.
    pub fn recall(&mut self, force: f64, rising: bool) {
        (self.force, self.rising) = (force, rising);
    }

    /// Advances to the next state.
    pub fn advance(&mut self, force: f64, tolerance: f64) {
        self.rising = self.rises_to(force, tolerance);
        self.force = force;
    }
}

/// The memory of a hardness, as it is stored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Indented {
    cells: CellSet,
    depth: Vec<f64>,
    force: f64,
    rising: bool,
}

impl Indented {
    pub(super) fn of(grid: Grid, memory: &IndentationMemory) -> Self {
        let cells = CellSet::of_grid(grid, &memory.indentation, |depth| depth > 0.0);
        let depth = cells.index(grid).map(|i| memory.indentation[i]).collect();
        let (force, rising) = memory.reached();
        Self { cells, depth, force, rising }
    }

    /// Restores the memory of a surface without an indentation.
    pub(super) fn restore(&self, grid: Grid, memory: &mut IndentationMemory) {
        for (i, depth) in self.cells.index(grid).zip(&self.depth) {
            memory.indentation[i] = *depth;
        }
        memory.recall(self.force, self.rising);
    }

    pub(super) fn fits(&self, grid: Grid) -> bool {
        self.cells.is_on(grid)
            && self.force.is_finite()
            && self.depth.len() == self.cells.len()
            && self.depth.iter().all(|depth| depth.is_finite())
    }
}
