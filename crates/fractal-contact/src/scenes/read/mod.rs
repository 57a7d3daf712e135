//! A scene as it was written: from TOML to typed values, with the place of each mistake.

pub(crate) mod accuracy_target;
pub(crate) mod diagnostic;
pub(crate) mod distributed;
pub(crate) mod effects;
pub(crate) mod entries;
pub(crate) mod error;
pub(crate) mod generated_surface;
pub(crate) mod human_readable;
pub(crate) mod loads;
pub(crate) mod numerics;
pub(crate) mod outputs;
pub(crate) mod random_surface;
pub(crate) mod registered_model;
pub(crate) mod registry;
pub(crate) mod sampled;
pub(crate) mod scan;
pub(crate) mod scene_file;
pub(crate) mod scene_surface;
pub(crate) mod words;
