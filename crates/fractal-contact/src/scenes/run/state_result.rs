//! The stored results of a model, and the names of their files.

use crate::scenes::plan::{GridErrors, RefinedThreshold};
use crate::scenes::read::{Bin, Distributed, SceneFile, all_fields, amount, words};
use crate::scenes::run::{Folder, StoredFile, Warning};
use contact_model::quantities::StateQuantity;
use contact_model::{ContactState, Normalisation, Status};
use serde::{Deserialize, Serialize};
use std::fmt;

/// The states of one model on one surface, as the store holds them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(from = "StoredResult")]
pub struct ModelResult {
    /// Seconds of all runs that contributed to it.
    pub(crate) seconds: f64,
    /// Whether all states are solved.
    pub(crate) complete: bool,
    /// States in the order of the loads.
    pub(crate) states: Vec<StateRecord>,
    /// Thresholds between loads that are closer together than those of the scene; `None` before they are refined.
    pub(crate) thresholds: Option<Vec<RefinedThreshold>>,
    /// How many states an earlier run had kept: all of a result that is read back.
    #[serde(skip_serializing)]
    pub(crate) kept: usize,
    /// Notes for the user on this run.
    #[serde(skip_serializing)]
    pub(crate) notes: Vec<String>,
}

/// The part of a [`ModelResult`] that is read back.
#[derive(Deserialize)]
#[serde(rename = "ModelResult")]
struct StoredResult {
    seconds: f64,
    complete: bool,
    states: Vec<StateRecord>,
    thresholds: Option<Vec<RefinedThreshold>>,
}

impl From<StoredResult> for ModelResult {
    fn from(StoredResult { seconds, complete, states, thresholds }: StoredResult) -> Self {
        Self { seconds, complete, kept: states.len(), states, thresholds, notes: Vec::new() }
    }
}

/// Quantities that describe a state of a path in words.
const REACHED: [&str; 5] =
    ["force", "approach", "mean_gap", "tangential_displacement", "tangential_displacement_y"];

/// One state as it is stored. All tables and pictures are made from these records.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct StateRecord {
    /// Number of the load or step.
    pub index: usize,
    pub answer: Answer,
    /// The requested distributions.
    pub distributions: Vec<(Distributed, Vec<Bin>)>,
    /// Files of fields.
    pub files: Vec<StoredFile>,
}

/// The answer of a model to a load.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) enum Answer {
    /// A state, including the best one of a solve that missed its tolerance (see its status).
    State(Box<AnsweredState>),
    /// The reason why there is no state.
    Refused(String),
}

/// A state with its warnings and its grid errors.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct AnsweredState {
    /// The state without its fields, which are in files.
    pub state: ContactState,
    /// Normalisation of its surface.
    pub normalisation: Normalisation,
    /// Warnings on a state that may be wrong although it is solved.
    pub warnings: Vec<Warning>,
    /// Its errors, where it was compared with coarser grids.
    pub grid: Option<GridErrors>,
}

impl StateRecord {
    /// A record without files.
    pub fn new(index: usize, answer: Answer) -> Self {
        Self { index, answer, distributions: Vec::new(), files: Vec::new() }
    }

    /// The state, where there is one.
    pub fn solved(&self) -> Option<&AnsweredState> {
        match &self.answer {
            Answer::State(solved) => Some(solved),
            Answer::Refused(_) => None,
        }
    }

    /// The state, where it reached its tolerance.
    pub fn converged(&self) -> Option<&AnsweredState> {
        self.solved().filter(|solved| solved.state.report.status == Status::Converged)
    }

    /// Whether it is the last stable state before pull-off.
    pub fn is_pulled_off(&self) -> bool {
        self.solved().is_some_and(|solved| solved.state.report.status == Status::PulledOff)
    }

    /// How it ended, as in tables.
    pub fn status(&self) -> &'static str {
        self.solved().map_or("refused", |solved| solved.state.report.status.as_str())
    }

    /// Why a model refused the load, or the warnings on the state.
    pub fn note(&self) -> Option<String> {
        match &self.answer {
            Answer::Refused(reason) => Some(reason.clone()),
            Answer::State(_) if self.is_pulled_off() => {
                self.solved().map(|solved| solved.state.report.strategy.clone())
            }
            Answer::State(solved) => Warning::note(&solved.warnings),
        }
    }

    /// The load in words; for a path the number of the step with the forces and distances reached there.
    pub fn words(&self, scene: &SceneFile) -> String {
        let mut text = words::load(scene, self.index);
        let Some(solved) = self.solved().filter(|_| scene.is_history()) else { return text };
        for quantity in REACHED.into_iter().filter_map(StateQuantity::named) {
            let Some(value) = quantity.number(&solved.state, &solved.normalisation) else { continue };
            // Components along y are shown only where they are not zero.
            if quantity.name.ends_with("_y") && value == 0.0 {
                continue;
            }
            let unit = scene.system.shown(quantity.unit.si(&scene.requested.outputs));
            text += &format!(", {} {}", quantity.words, amount(value, unit));
        }
        text
    }

    /// Whether all its files are unchanged.
    pub fn is_whole(&self, folder: &Folder) -> bool {
        self.files.iter().all(|file| folder.holds(file))
    }
}

/// One model on one surface with its states.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SolvedUnit<'a> {
    /// Name of the model.
    pub model: &'static str,
    pub surface: usize,
    pub states: &'a [StateRecord],
    pub thresholds: &'a [RefinedThreshold],
}

/// The parts of the name of a field's file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FieldFile<'a> {
    pub field: &'a str,
    pub model: &'a str,
    pub surface: usize,
    pub state: usize,
    pub extension: &'a str,
}

impl fmt::Display for FieldFile<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-{}-{:03}.{}", self.field, self.model, self.surface, self.state, self.extension)
    }
}

/// Reads the name of a field's file; `None` for other names.
pub(crate) fn field_of_file(name: &str) -> Option<FieldFile<'_>> {
    let (field, rest) = name.split_once('-')?;
    let (rest, last) = rest.rsplit_once('-')?;
    let (state, extension) = last.split_once('.')?;
    let (model, surface) = rest.rsplit_once('-')?;
    let file =
        FieldFile { field, model, surface: surface.parse().ok()?, state: state.parse().ok()?, extension };
    let known = all_fields().any(|known| known.name == field);
    (known && file.to_string() == name).then_some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_say_what_they_hold() {
        let file = FieldFile { field: "gap", model: "bem3d", surface: 3, state: 1234, extension: "npy" };
        assert_eq!(file.to_string(), "gap-bem3d-3-1234.npy");
        assert_eq!(field_of_file("gap-bem3d-3-1234.npy"), Some(file));
        assert_eq!(field_of_file("gap-bem3d-3-1234.pixels.png").map(|f| f.extension), Some("pixels.png"));
        for other in [
            "gap-bem3d-3-12.npy",
            "height-bem3d-3-012.npy",
            "gap-bem3d-012.npy",
            "gap.npy",
            "results.csv",
            "",
        ] {
            assert_eq!(field_of_file(other), None, "{other}");
        }
    }
}
