//! Where a scene is run, and what came of it.

use crate::scenes::plan::Cost;
use std::path::PathBuf;

/// Where and how a scene is run; nothing here changes a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Directory of the results.
    pub out: PathBuf,
    /// Threads: each takes one model on one surface; those that are left help inside the others.
    pub threads: usize,
    /// Whether stored results are computed again.
    pub fresh: bool,
}

/// What a run gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneOutcome {
    /// Files, in the order written.
    pub files: Vec<PathBuf>,
    /// States asked for: loads or steps, times surfaces, times models.
    pub requested: usize,
    /// States in `results.csv`.
    pub states: usize,
    /// How many of these were refused or did not reach their tolerance.
    pub failed: usize,
    /// How many of these an earlier run had kept.
    pub kept: usize,
    /// The reasons given, each once.
    pub notes: Vec<String>,
    /// The states as a short table for a terminal: means where there are several surfaces.
    pub summary: String,
    /// Whether it was stopped before all loads were answered.
    pub stopped: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Largest resident memory of the process while it ran, bytes, where the system tells.
    pub peak_memory: Option<u64>,
    /// What each model did: name, cost, bytes of field files. Seconds are of threads, stored ones included.
    pub actual: Vec<(&'static str, Cost, u64)>,
}

impl SceneOutcome {
    /// States that were asked for and not attempted: after a stop, and after the step at which a path failed.
    pub fn not_attempted(&self) -> usize {
        self.requested - self.states
    }
}
