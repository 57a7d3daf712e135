//! A path with a hardness: the indentation stays, and what is unloaded is elastic until the old pressures are reached again.

use super::prepared::{Memory, PreparedBem3d, without_tangential};
use crate::active_set::Candidates;
use contact_model::{
    ContactState, Error, Load, Normalisation, PreparedContact, RequiredMemory, Result, Step, Stop,
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
    contact: PreparedBem3d,
    virgin: Arc<Vec<f64>>,
    time: f64,
}

impl PlasticPath {
    /// The path begins with the virgin surface, at time 0.
    pub fn new(mut contact: PreparedBem3d) -> Self {
        let virgin = contact.problem.candidates.shared();
        contact.memory = Some(Memory::new(virgin.len()));
        Self { contact, virgin, time: 0.0 }
    }
}

impl PreparedContact for PlasticPath {
    fn normalisation(&self) -> Normalisation {
        self.contact.normalisation()
    }

    fn required_memory(&self, load: Load) -> Option<RequiredMemory> {
        self.contact.required_memory(load)
    }

    fn solve_until(&mut self, load: Load, stop: Stop<'_>) -> Result<ContactState> {
        self.restart();
        self.advance_until(Step::normal(0.0, load), stop)
    }

    fn advance_until(&mut self, step: Step, stop: Stop<'_>) -> Result<ContactState> {
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
        Ok(state.with_time(step.time))
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
