//! The outcome of a command.

use crate::evaluation::measured::Measured;
use std::path::PathBuf;

/// The outcome of a figure or of the verification.
#[derive(Debug, Clone, Default)]
pub struct Outcome {
    /// `fig1` .. `fig7`, `verify`.
    pub name: &'static str,
    /// Files written, in order.
    pub files: Vec<PathBuf>,
    /// Number of solves that did not meet their tolerance; they are in the samples and left out of every
    /// mean.
    pub not_converged: usize,
    /// The accuracy of the results, one line for each ensemble.
    pub reached: Vec<String>,
    /// Wall-clock seconds of this command.
    pub seconds: f64,
    /// Seconds of all 3D jobs together, whenever they were solved.
    pub bem3d_seconds: Option<f64>,
    /// Seconds of all 1D jobs together.
    pub mdr1d_seconds: Option<f64>,
}

impl Outcome {
    /// An outcome without files.
    #[must_use]
    pub fn new(name: &'static str) -> Self {
        Self { name, ..Self::default() }
    }

    /// The outcome of files made from these ensembles.
    #[must_use]
    pub fn of(name: &'static str, files: Vec<PathBuf>, ensembles: &[&Measured]) -> Self {
        let seconds =
            |model| ensembles.iter().find(|m| m.discretisation.name() == model).map(|m| m.seconds());
        Self {
            files,
            not_converged: ensembles.iter().map(|m| m.not_converged()).sum(),
            bem3d_seconds: seconds("bem3d"),
            mdr1d_seconds: seconds("mdr1d"),
            ..Self::new(name)
        }
    }

    /// Adds a file of budgets and its summary in one line.
    pub fn add_budget(&mut self, (path, reached): (PathBuf, String)) {
        self.files.push(path);
        self.reached.push(reached);
    }
}
