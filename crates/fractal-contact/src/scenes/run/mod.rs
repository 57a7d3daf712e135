//! The states of a scene: each model on each surface, solved and kept.

pub(crate) mod field_pictures;
pub(crate) mod field_view;
pub(crate) mod outcome;
pub(crate) mod scene_job;
pub(crate) mod solve;
pub(crate) mod state_result;
pub(crate) mod warnings;
