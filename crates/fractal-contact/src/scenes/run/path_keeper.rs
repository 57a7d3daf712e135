//! Stores a run that may be interrupted: the states so far of a model on a surface, and a checkpoint from which
//! the next load is solved to the same bits.

use crate::scenes::read::Result;
use crate::scenes::run::ModelResult;
use contact_model::{PathMemory, PreparedContact};
use runs::{Checkpoint, Progress, StatesInHand};
use std::time::Duration;
use web_time::Instant;

/// Shortest time between two writes of the results: a kill loses the states since the last one, and the state
/// that is being solved.
const KEEP_EVERY: Duration = Duration::from_secs(1);
/// Smallest ratio of the time between two checkpoints to the time of writing one.
const SHARE: u32 = 20;

/// Keeps a result in the store.
pub(crate) type KeepResult<'a> = dyn Fn(&ModelResult) -> runs::Result<()> + 'a;

/// Keeps the states of one model on one surface.
pub(crate) struct Keeper<'a> {
    /// Keeps a result in the store; `None` where it is not worth storing.
    pub store: Option<&'a KeepResult<'a>>,
    /// `None` in memory, where nothing outlives the run.
    pub checkpoint: Option<Checkpoint>,
    pub progress: &'a dyn Progress,
    /// Name of the model and its surface in notes.
    pub name: String,
    /// Receives the number of its states that are solved.
    told_states: &'a StatesInHand<'a>,
    last: Instant,
    /// Time that the last checkpoint took.
    took: Duration,
    /// Steps of the path that the checkpoint has.
    kept: usize,
    told: bool,
}

impl<'a> Keeper<'a> {
    pub fn new(
        store: Option<&'a KeepResult<'a>>,
        checkpoint: Option<Checkpoint>,
        progress: &'a dyn Progress,
        name: String,
        told_states: &'a StatesInHand<'a>,
    ) -> Self {
        let (last, took) = (Instant::now(), Duration::ZERO);
        Self { store, checkpoint, progress, name, told_states, last, took, kept: 0, told: false }
    }

    /// From now on the loads are solved on coarser grids, or on the grid itself: the progress says so.
    pub fn on_coarser_grids(&self, are: bool) {
        self.told_states.on_coarser_grids(are);
    }

    /// Restores a contact to the point at which it was interrupted, and leaves the states before that in the
    /// result. A checkpoint that cannot be used is reported: a path then begins anew, and loads that do not
    /// depend on each other keep their states.
    pub fn resume(&mut self, result: &mut ModelResult, contact: &mut dyn PreparedContact, is_path: bool) {
        if self.store.is_none() {
            result.states.clear();
        } else {
            match self.recalled(result, contact) {
                Ok(done) => result.states.truncate(done),
                Err(unused) => {
                    contact.restart();
                    let then = if is_path {
                        result.states.clear();
                        format!("the path of {} begins anew", self.name)
                    } else {
                        format!("the loads of {} that are left begin anew", self.name)
                    };
                    self.tell(result, format!("{unused}. It is not used: {then}"));
                }
            }
        }
        let done = result.states.len();
        (result.kept, self.kept) = (done, done);
        self.told_states.solved(done);
    }

    /// The number of states before the checkpoint, to which the contact is restored; 0 where there is none.
    fn recalled(
        &self,
        result: &ModelResult,
        contact: &mut dyn PreparedContact,
    ) -> std::result::Result<usize, runs::Unused> {
        let Some(checkpoint) = &self.checkpoint else { return Ok(0) };
        let Some((done, memory)) = checkpoint.read()? else { return Ok(0) };
        let done = usize::try_from(done).unwrap_or(usize::MAX);
        let states = result.states.get(..done).unwrap_or_default();
        if states.is_empty() || states.iter().enumerate().any(|(i, state)| state.index != i) {
            let reason = "states before it, or their files, are missing or were changed";
            return Err(checkpoint.unused(reason));
        }
        match contact.recall(&PathMemory::from_bytes(memory)) {
            Ok(()) => Ok(done),
            Err(error) => Err(checkpoint.unused(&error.to_string())),
        }
    }

    /// Stores the states and the memory of the contact, where the last time was long ago or it is interrupted
    /// now. A failure to store them is reported once, and the next load is solved.
    pub fn keep(&mut self, result: &mut ModelResult, contact: &dyn PreparedContact, interrupted: bool) {
        self.told_states.solved(result.states.len());
        let done = result.states.len();
        // In memory, the receiver shows each state.
        let long = self.checkpoint.as_ref().map_or(Duration::ZERO, |_| KEEP_EVERY.max(SHARE * self.took));
        if done == self.kept || !interrupted && self.last.elapsed() < long {
            return;
        }
        let Some(store) = self.store else { return };
        let start = Instant::now();
        let kept = match self.checkpoint.as_ref().map(|checkpoint| (checkpoint, contact.memory())) {
            None | Some((_, Ok(None))) => store(result),
            // The states first: a checkpoint is of no use without those before it.
            Some((checkpoint, Ok(Some(memory)))) => {
                store(result).and_then(|()| checkpoint.write(done as u64, memory.bytes()))
            }
            Some((_, Err(error))) => Err(runs::Error::model("memory of the loads")(error)),
        };
        match kept {
            Ok(()) => self.kept = done,
            Err(error) if !self.told => {
                self.told = true;
                let name = &self.name;
                let text = format!(
                    "{error}. {name} goes on; an interruption would lose what follows its last checkpoint"
                );
                self.tell(result, text);
            }
            Err(_) => {}
        }
        (self.last, self.took) = (Instant::now(), start.elapsed());
    }

    /// A complete result needs no checkpoint. It is stored where what was stored of it before needs the
    /// checkpoint, or `files` that are now to be removed.
    ///
    /// # Errors
    /// Where the result cannot be stored.
    pub fn finish(&self, result: &ModelResult, files: bool) -> Result<()> {
        let Some(store) = self.store.filter(|_| result.complete) else { return Ok(()) };
        if self.kept > 0 || files {
            store(result)?;
        }
        if let Some(checkpoint) = &self.checkpoint {
            checkpoint.remove();
        }
        Ok(())
    }

    fn tell(&self, result: &mut ModelResult, text: String) {
        self.progress.note(&text);
        result.notes.push(text);
    }
}
