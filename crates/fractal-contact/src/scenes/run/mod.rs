//! Solves and stores the states of a scene, for each model on each surface.

pub(crate) mod ensemble;
pub(crate) mod field_pictures;
pub(crate) mod field_view;
pub(crate) mod folder;
pub(crate) mod outcome;
pub(crate) mod path_keeper;
pub(crate) mod pilot;
pub(crate) mod scene_job;
pub(crate) mod shared_lines;
pub(crate) mod solve;
pub(crate) mod state_result;
pub(crate) mod thresholds;
pub(crate) mod warnings;

pub(crate) use field_pictures::is_hidden;
pub(crate) use field_view::FieldView;
pub(crate) use folder::{Folder, StoredFile};
pub(crate) use outcome::{Options, SceneOutcome};
pub(crate) use path_keeper::{KeepResult, Keeper};
pub(crate) use pilot::{SharedStop, remove_trials, take_trial};
pub(crate) use scene_job::{SceneJob, scene_jobs, units};
pub(crate) use shared_lines::SharedLines;
pub(crate) use state_result::{
    Answer, AnsweredState, FieldFile, ModelResult, SolvedUnit, StateRecord, field_of_file,
};
pub(crate) use thresholds::{Refinement, bracket};
pub(crate) use warnings::{Concerned, Warning, rests_on_few_cells};
