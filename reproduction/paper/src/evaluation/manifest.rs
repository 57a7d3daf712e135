//! `manifest.json`: the commands and the machine that made the files of a directory.

use crate::evaluation::{Outcome, Run};
use runs::Result;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Enters these outcomes of `command` (as typed) into `manifest.json`; entries of other commands in the same
/// directory are kept.
///
/// # Errors
/// [`runs::Error::File`] when it cannot be written.
pub fn write_manifest(run: &Run, name: &str, command: &str, outcomes: &[Outcome]) -> Result<PathBuf> {
    let path = run.out.join("manifest.json");
    let mut commands = previous(&path);
    commands.insert(name.to_owned(), entry(run, command, outcomes));
    let whole = json!({
        "project": "fractal-contact",
        "paper": crate::evaluation::header::PAPER,
        "commands": commands,
    });
    runs::write_manifest(&run.out, &whole)
}

/// Entries of earlier commands; a missing or unreadable manifest has none.
fn previous(path: &Path) -> Map<String, Value> {
    std::fs::read_to_string(path)
        .ok()
        .and_then(|text| serde_json::from_str::<Value>(&text).ok())
        .and_then(|v| v.get("commands").and_then(Value::as_object).cloned())
        .unwrap_or_default()
}

fn entry(run: &Run, command: &str, outcomes: &[Outcome]) -> Value {
    let figures: Map<String, Value> = outcomes
        .iter()
        .map(|o| {
            let files = runs::file_names(&o.files);
            let value = json!({ "seconds": o.seconds, "not_converged": o.not_converged, "files": files });
            (o.name.to_owned(), value)
        })
        .collect();
    let largest = |pick: fn(&Outcome) -> Option<f64>| outcomes.iter().filter_map(pick).reduce(f64::max);
    let parameters = json!({
        "preset": run.preset.as_str(),
        "cells": run.cells,
        "surfaces": run.surfaces,
        "elements": run.elements,
        "lines": run.lines,
        "fractal_dimensions": run.dimensions(),
        "forces_3d": run.forces_3d.spec(),
        "forces_1d": run.forces_1d.spec(),
        "tolerance": run.tolerance,
        "threads": run.threads,
        "fresh": run.fresh,
    });
    json!({
        "command": command,
        "parameters": parameters,
        "seed": run.seed,
        "versions": {
            "fractal-contact": env!("CARGO_PKG_VERSION"),
            "unit_format": fractal_contact::scenes::FORMAT,
            "bem3d_format": bem3d::FORMAT,
        },
        "machine": runs::machine(),
        "wall_seconds": outcomes.iter().map(|o| o.seconds).sum::<f64>(),
        "bem3d_unit_seconds": largest(|o| o.bem3d_seconds),
        "mdr1d_unit_seconds": largest(|o| o.mdr1d_seconds),
        "figures": figures,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::Request;

    #[test]
    fn entries_of_other_commands_stay() {
        let dir = tempfile::tempdir().unwrap();
        let run = Run::new(&Request { out: Some(dir.path().into()), ..Request::default() }).unwrap();
        std::fs::write(dir.path().join("manifest.json"), "not json").unwrap();
        let outcome = Outcome { name: "fig2", bem3d_seconds: Some(2.0), ..Outcome::default() };
        write_manifest(&run, "reproduce-fig2", "cargo xtask reproduce-fig2", &[outcome]).unwrap();
        let path = write_manifest(&run, "verify", "cargo xtask verify", &[]).unwrap();
        let v: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        assert_eq!(v["commands"]["reproduce-fig2"]["parameters"]["cells"], 513);
        assert_eq!(v["commands"]["reproduce-fig2"]["bem3d_unit_seconds"], 2.0);
        assert!(v["commands"]["verify"]["machine"]["cores"].as_u64().unwrap() >= 1);
    }
}
