//! `manifest.json`: the whole scene, what it was run with, what it cost, what to cite.

use crate::scenes::cost::Cost;
use crate::scenes::error::Result;
use crate::scenes::outcome::{Options, SceneOutcome};
use crate::scenes::plan::Plan;
use crate::scenes::scene_file::SceneFile;
use serde_json::{Value, json};
use std::path::PathBuf;

/// Writes it.
pub(crate) fn write(
    scene: &SceneFile,
    plan: &Plan,
    options: &Options,
    outcome: &SceneOutcome,
) -> Result<PathBuf> {
    let cite: Vec<Value> = scene
        .models
        .iter()
        .flat_map(|m| {
            m.model()
                .sources()
                .iter()
                .map(move |s| json!({ "model": m.name(), "citation": s.citation, "what": s.what }))
        })
        .collect();
    let models: Vec<Value> = plan
        .models
        .iter()
        .zip(&outcome.actual)
        .map(|(planned, (name, actual, bytes))| {
            json!({
                "name": name,
                "grid": planned.grid,
                "predicted": planned.predicted.as_ref().map(cost),
                "actual": cost(actual),
                "field_file_bytes": bytes,
            })
        })
        .collect();
    let effects: serde_json::Map<String, Value> =
        plan.effects.iter().map(|e| (e.name.to_owned(), json!({ "on": e.on, "reason": e.reason }))).collect();
    let outputs: serde_json::Map<String, Value> =
        plan.outputs.iter().map(|(name, requested)| ((*name).to_owned(), json!(requested))).collect();
    let whole = json!({
        "project": "fractal-contact",
        "version": env!("CARGO_PKG_VERSION"),
        "formats": { "scene": crate::scenes::model_on_surface::FORMAT, "bem3d": bem3d::FORMAT },
        "scene": scene.text,
        "seed": scene.sampling.seed,
        "surfaces": scene.sampling.surfaces,
        "effects": effects,
        "outputs": outputs,
        "models": models,
        "cite": cite,
        "complete": !outcome.stopped,
        "states": outcome.states,
        "failed": outcome.failed,
        "notes": outcome.notes,
        "files": runs::file_names(&outcome.files),
        "threads": options.threads,
        "wall_seconds": outcome.seconds,
        "peak_memory_bytes": outcome.peak_memory,
        "machine": runs::machine(),
    });
    Ok(runs::write_manifest(&options.out, &whole)?)
}

fn cost(cost: &Cost) -> Value {
    json!({
        "seconds": cost.seconds,
        "memory_bytes": (cost.memory > 0.0).then_some(cost.memory),
        "applications": cost.applications,
        "linear_solves": cost.linear_solves,
        "fields": cost.fields,
        "field_bytes": cost.field_bytes,
    })
}
