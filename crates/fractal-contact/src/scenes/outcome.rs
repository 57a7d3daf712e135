//! Where a scene is run, and what came of it.

use crate::scenes::cost::Cost;
use std::path::PathBuf;

/// Where and how a scene is run; nothing here changes a number.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Directory of the results.
    pub out: PathBuf,
    /// Threads; each takes one model on one surface.
    pub threads: usize,
    /// Whether stored results are computed again.
    pub fresh: bool,
}

/// What a run gave.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SceneOutcome {
    /// Files, in the order written.
    pub files: Vec<PathBuf>,
    /// States in `results.csv`.
    pub states: usize,
    /// Loads that were refused or did not reach their tolerance.
    pub failed: usize,
    /// The reasons given, each once.
    pub notes: Vec<String>,
    /// Whether it was stopped before all loads were answered.
    pub stopped: bool,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// Largest resident memory of the process while it ran, bytes, where the system tells.
    pub peak_memory: Option<u64>,
    /// What each model did: name, cost, bytes of field files. Seconds are of threads, stored ones included.
    pub actual: Vec<(&'static str, Cost, u64)>,
}
