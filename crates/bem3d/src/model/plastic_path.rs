//! A path with a hardness: the indentation stays, and what is unloaded is elastic until the old pressures are reached again.

use super::prepared::{Memory, PreparedSurface, without_tangential};
use crate::active_set::Candidates;
use contact_model::{
    Error, History, HistoryState, Load, Normalisation, PreparedContact, RequiredMemory, Result, Step, Stop,
    never,
};
use std::sync::Arc;

/// A surface that keeps its indentation from step to step.
///
/// Each step is solved on the surface as the last one left it. As long as loads rise, that is the same as one step from the virgin surface:
/// saturated cells stay so, and their indentation grows. Plastic flow under falling loads is not excluded, and counted where it happens.
///
/// Where a load is reached again, the old cells are about to flow, and the slope of the force jumps. The state decides: cells of the
/// indentation whose pressure is the hardness, within what the tolerance leaves open, count as saturated, and the stiffness is that of a
/// load that goes on in the direction of its last change. On the way up they flow, on the way down they do not.
#[derive(Debug)]
pub struct PlasticPath {
    contact: PreparedSurface,
    virgin: Arc<Vec<f64>>,
    time: f64,
}

impl PlasticPath {
    /// The path begins with the virgin surface, at time 0.
    pub fn new(mut contact: PreparedSurface) -> Self {
        let virgin = contact.problem.candidates.shared();
        contact.memory = Some(Memory::new(virgin.len()));
        Self { contact, virgin, time: 0.0 }
    }
}

impl History for PlasticPath {
    fn normalisation(&self) -> Normalisation {
        self.contact.normalisation()
    }

    fn required_memory(&self, load: Load) -> Option<RequiredMemory> {
        self.contact.required_memory(load)
    }

    fn advance(&mut self, step: Step) -> Result<HistoryState> {
        self.advance_until(step, &never)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<HistoryState> {
        let step = step.validated(self.time)?;
        without_tangential(step)?;
        if stop() {
            return Err(Error::Stopped { best: None });
        }
        let state = self.contact.solve_until(step.normal, stop)?;
        if let Some(memory) = self.contact.memory.as_mut().filter(|_| state.force <= 0.0) {
            memory.advance(0.0, 0.0);
        }
        self.time = step.time;
        Ok(HistoryState::new(step.time, state))
    }

    fn restart(&mut self) {
        let grid = self.contact.problem.grid();
        self.contact.problem.candidates = Candidates::new(grid, Arc::clone(&self.virgin));
        self.contact.problem.coarser = None;
        self.contact.memory = Some(Memory::new(self.virgin.len()));
        self.contact.last = None;
        self.time = 0.0;
    }
}
