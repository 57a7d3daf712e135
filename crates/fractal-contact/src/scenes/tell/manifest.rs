//! `manifest.json`: the whole scene, the versions and options of the run, its cost and the sources to cite.

use crate::scenes::plan::{Cost, FORMAT, Plan, PredictedFrom};
use crate::scenes::read::{Result, SceneFile};
use crate::scenes::run::{Options, SceneOutcome};
use crate::scenes::tell::columns;
use serde_json::{Value, json};
use std::collections::BTreeSet;
use std::path::PathBuf;

/// Writes the part that is known before anything is solved, so that the files of an interrupted run are known
/// as its own.
pub(crate) fn write_begun(scene: &SceneFile, options: &Options, files: &BTreeSet<String>) -> Result<PathBuf> {
    let begun = json!({
        "project": "fractal-contact",
        "version": env!("CARGO_PKG_VERSION"),
        "scene": scene.text,
        "complete": false,
        "files": files,
    });
    Ok(runs::write_manifest(&options.out, &begun)?)
}

/// Writes the manifest.
pub(crate) fn write(
    scene: &SceneFile,
    plan: &Plan,
    options: &Options,
    outcome: &SceneOutcome,
) -> Result<PathBuf> {
    let cite: Vec<Value> = columns::sources(scene)
        .into_iter()
        .map(|(kind, by, s)| json!({ kind: by, "citation": s.citation, "what": s.what }))
        .collect();
    let models: Vec<Value> = plan
        .models
        .iter()
        .zip(&outcome.actual)
        .map(|(planned, (name, actual, bytes))| {
            json!({
                "name": name,
                "grid": planned.grid,
                "predicted": planned.predicted.as_ref().map(|cost| predicted(cost, plan.predicted_from)),
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
        "formats": { "scene": FORMAT, "bem3d": bem3d::FORMAT },
        "scene": scene.text,
        "seed": scene.sampling.seed,
        "surfaces": scene.sampling.surfaces,
        "effects": effects,
        "outputs": outputs,
        // Metadata of its file and steps of the preprocessing, line by line.
        "surface_file": scene.metadata.as_ref().map(|told| told.lines().collect::<Vec<_>>()),
        "map": plan.prepared.as_ref().map(map),
        "models": models,
        "cite": cite,
        "complete": outcome.not_attempted() == 0,
        "states_requested": outcome.requested,
        "states": outcome.states,
        "failed": outcome.failed,
        "pulled_off": outcome.pulled_off,
        "kept_from_earlier_runs": outcome.kept,
        "notes": outcome.notes,
        "files": runs::file_names(&outcome.files),
        "threads": options.threads,
        "wall_seconds": outcome.seconds,
        "peak_memory_bytes": outcome.peak_memory,
        "machine": runs::machine(),
    });
    Ok(runs::write_manifest(&options.out, &whole)?)
}

/// The map as it was solved, in the units of the results.
fn map(map: &surface_io::Description) -> Value {
    json!({
        "columns": map.cells.columns,
        "rows": map.cells.rows,
        "size": [map.size.x, map.size.y],
        "undefined": map.undefined,
        "minimum": map.range[0],
        "maximum": map.range[1],
        "rms_height": map.rms_height,
        "rms_slope": map.rms_slope,
        "hurst": map.hurst.ok(),
        "fitted_wavenumbers": map.fitted,
        "spectrum": map.spectrum,
    })
}

/// A predicted cost, with what it rests on; what is not predicted is null.
fn predicted(of: &Cost, from: Option<PredictedFrom>) -> Value {
    let mut value = cost(of);
    value["from"] = json!(from.map(PredictedFrom::words));
    if from == Some(PredictedFrom::Sizes) {
        for unknown in ["applications", "linear_solves"] {
            value[unknown] = Value::Null;
        }
    }
    value
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
