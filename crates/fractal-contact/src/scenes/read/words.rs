//! What scenes, loads, units and models are called in titles and labels.

use crate::models::ModelRecord;
use crate::scenes::read::{LoadKind, LoadRequest, SceneFile, short};

/// The scene's name in a title.
pub(crate) fn scene_name(scene: &SceneFile) -> String {
    let file = scene.path.file_stem().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
    file.replace(['-', '_'], " ")
}

/// A load in words, with its unit.
pub(crate) fn load(scene: &SceneFile, state: usize) -> String {
    match &scene.request {
        LoadRequest::Loads(loads) => {
            let unit =
                if loads.kind == LoadKind::ForceBar { "" } else { scene.system.shown(loads.kind.unit()) };
            let words = loads.kind.key().replace('_', " ");
            let (unit, factor) = plots::prefixed(unit, loads.values[state]);
            let value = short(factor * loads.values[state]);
            format!("{words} {value} {unit}").trim_end().to_owned()
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
