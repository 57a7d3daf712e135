//! Stores a path that may be interrupted: its states so far, and a checkpoint from which the next load is
//! solved to the same bits.

use crate::scenes::read::Result;
use crate::scenes::run::ModelResult;
use contact_model::{PathMemory, PreparedContact};
use runs::{Checkpoint, Progress, StatesInHand};
use std::time::{Duration, Instant};

/// Shortest time between two writes of the results: a kill loses the states since the last one, and the state
/// that is being solved.
const KEEP_EVERY: Duration = Duration::from_secs(1);
/// Smallest ratio of the time between two checkpoints to the time of writing one.
const SHARE: u32 = 20;

/// Keeps a result in the store.
type KeepResult<'a> = dyn Fn(&ModelResult) -> runs::Result<()> + 'a;

/// Keeps the states of one model on one surface.
pub(crate) struct Keeper<'a> {
    /// Keeps a result in the store; `None` where it is not worth storing.
    pub store: Option<&'a KeepResult<'a>>,
    pub checkpoint: Checkpoint,
    pub progress: &'a dyn Progress,
    /// Name of the path in notes.
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
        checkpoint: Checkpoint,
        progress: &'a dyn Progress,
        name: String,
        told_states: &'a StatesInHand<'a>,
    ) -> Self {
        let (last, took) = (Instant::now(), Duration::ZERO);
        Self { store, checkpoint, progress, name, told_states, last, took, kept: 0, told: false }
    }

    /// Keeps states that do not depend on each other.
    ///
    /// # Errors
    /// What cannot be written.
    pub fn keep(&mut self, result: &ModelResult) -> Result<()> {
        self.told_states.solved(result.states.len());
        if let Some(store) = self.store.filter(|_| self.last.elapsed() >= KEEP_EVERY) {
            store(result)?;
            self.last = Instant::now();
        }
        Ok(())
    }

    /// Restores a contact to the point at which a path was interrupted, and leaves the states before that in
    /// the result (none where the path begins anew). A checkpoint that cannot be used is reported.
    pub fn resume(&mut self, result: &mut ModelResult, contact: &mut dyn PreparedContact) {
        let (done, unused) = self.resumed(result, contact);
        (result.kept, self.kept) = (done, done);
        result.states.truncate(done);
        self.told_states.solved(done);
        if let Some(unused) = unused {
            contact.restart();
            self.tell(result, format!("{unused}. It is not used: the path of {} begins anew", self.name));
        }
    }

    /// The number of steps that are done, or why a checkpoint cannot be used.
    fn resumed(
        &self,
        result: &ModelResult,
        contact: &mut dyn PreparedContact,
    ) -> (usize, Option<runs::Unused>) {
        if self.store.is_none() {
            return (0, None);
        }
        let unused = |reason: &str| (0, Some(self.checkpoint.unused(reason)));
        match self.checkpoint.read() {
            Ok(None) => (0, None),
            Err(why) => (0, Some(why)),
            Ok(Some((done, memory))) => {
                let done = usize::try_from(done).unwrap_or(usize::MAX);
                let states = result.states.get(..done).unwrap_or_default();
                let whole = states.iter().enumerate().all(|(i, s)| s.index == i && s.converged().is_some());
                if states.is_empty() || !whole {
                    return unused("states or files of the path before it are missing or were changed");
                }
                match contact.recall(&PathMemory::from_bytes(memory)) {
                    Ok(()) => (done, None),
                    Err(error) => unused(&error.to_string()),
                }
            }
        }
    }

    /// Stores the states of a path and its memory, where the last time was long ago or the path is
    /// interrupted now. A failure to store them is reported once, and the path goes on.
    pub fn keep_path(&mut self, result: &mut ModelResult, contact: &dyn PreparedContact, interrupted: bool) {
        self.told_states.solved(result.states.len());
        let done = result.states.len();
        let long = KEEP_EVERY.max(SHARE * self.took);
        if done == self.kept || !interrupted && self.last.elapsed() < long {
            return;
        }
        let Some(store) = self.store else { return };
        let start = Instant::now();
        let kept = match contact.memory() {
            Ok(None) => return,
            // The states first: a checkpoint is of no use without those before it.
            Ok(Some(memory)) => {
                store(result).and_then(|()| self.checkpoint.write(done as u64, memory.bytes()))
            }
            Err(error) => Err(runs::Error::model("memory of the path")(error)),
        };
        match kept {
            Ok(()) => self.kept = done,
            Err(error) if !self.told => {
                self.told = true;
                let name = &self.name;
                let text = format!(
                    "{error}. The path of {name} goes on; an interruption would lose what follows its last checkpoint"
                );
                self.tell(result, text);
            }
            Err(_) => {}
        }
        (self.last, self.took) = (Instant::now(), start.elapsed());
    }

    /// A complete result needs no checkpoint.
    ///
    /// # Errors
    /// Where the result cannot be stored.
    pub fn finish(&self, result: &ModelResult) -> Result<()> {
        if let Some(store) = self.store.filter(|_| self.kept > 0 && result.complete) {
            store(result)?;
            self.checkpoint.remove();
        }
        Ok(())
    }

    fn tell(&self, result: &mut ModelResult, text: String) {
        self.progress.note(&text);
        result.notes.push(text);
    }
}
