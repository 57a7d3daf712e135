//! Options and outcome of the run of a scene.

use crate::scenes::plan::Cost;
use contact_model::Table;
use std::path::PathBuf;

/// Where and how a scene is run; these options do not change the results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Directory of the results.
    pub out: PathBuf,
    /// Number of threads: each takes one model on one surface; idle threads help the others.
    pub threads: usize,
    /// Whether stored results are computed again.
    pub fresh: bool,
}

/// The outcome of a run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneOutcome {
    /// Files, in the order written.
    pub files: Vec<PathBuf>,
    /// Number of requested states: loads or steps, times surfaces, times models.
    pub requested: usize,
    /// Number of states in `results.csv`.
    pub states: usize,
    /// How many of these were refused or did not reach their tolerance.
    pub failed: usize,
    /// How many of these are the last stable state of a path that was pulled off.
    pub pulled_off: usize,
    /// How many of these an earlier run had kept.
    pub kept: usize,
    /// The reasons given, each once.
    pub notes: Vec<String>,
    /// The quantities of all states, as in `results.csv`.
    pub results: Option<Table>,
    /// The states as a short table for a terminal: means where there are several surfaces.
    pub summary: String,
    /// Whether it was stopped before all loads were answered.
    pub stopped: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Peak resident memory of the process in bytes, where the system reports it.
    pub peak_memory: Option<u64>,
    /// For each model its name, its cost and the bytes of its field files. Seconds are summed over threads
    /// and include stored results.
    pub actual: Vec<(&'static str, Cost, u64)>,
}

impl SceneOutcome {
    /// Number of requested states that were not attempted: those after a stop, and those after the step at
    /// which a path failed.
    pub fn not_attempted(&self) -> usize {
        self.requested - self.states
    }
}
