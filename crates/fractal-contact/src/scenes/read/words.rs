//! What scenes, loads, units and models are called in titles and labels.

use crate::models::ModelRecord;
use crate::scenes::read::{LoadKind, LoadRequest, SceneFile, amount};
use std::path::Path;

/// The scene's name in a title: that of its file, of `NAME/scene.toml` that of its folder.
pub(crate) fn scene_name(scene: &SceneFile) -> String {
    let folder = scene.path.parent().and_then(Path::file_name).filter(|_| scene.path.ends_with("scene.toml"));
    let name = folder.or_else(|| scene.path.file_stem());
    name.map_or_else(String::new, |n| n.to_string_lossy().replace(['-', '_'], " "))
}

/// A load in words, with its unit; a step by its number.
pub(crate) fn load(scene: &SceneFile, state: usize) -> String {
    match &scene.request {
        LoadRequest::Loads(loads) => {
            let unit =
                if loads.kind == LoadKind::ForceBar { "" } else { scene.system.shown(loads.kind.unit()) };
            format!("{} {}", loads.kind.key().replace('_', " "), amount(loads.values[state], unit))
        }
        LoadRequest::Path(_) => format!("step {state}"),
    }
}

/// A unit with its powers raised: `m^2` and `W/K`.
pub(crate) fn unit_label(unit: &str) -> String {
    format!("$\\rm{{{unit}}}$")
}

/// What a model is called outside code.
pub(crate) fn model_name(name: &str) -> &str {
    ModelRecord::named(name).map_or(name, |record| record.title)
}
