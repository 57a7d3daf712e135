//! Real files of instruments against what an independent reader (SurfaceTopography 1.27.1) finds in them.
//!
//! The files are no part of the repository: where they are absent, the test says that it skipped.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use serde_json::Value;
use std::path::{Path, PathBuf};
use surface_io::{ReadOptions, Scan, SurfaceFile};

/// Relative differences of sizes, extrema and rms.
const CLOSE: f64 = 1e-6;

/// A directory of files beside the repository or one of its work trees.
fn directory(name: &str) -> Option<PathBuf> {
    let above = Path::new(env!("CARGO_MANIFEST_DIR")).ancestors();
    let mut found = above.map(|above| above.join("shared").join(name));
    found.find(|found| found.join("expected.json").exists())
}

/// What is expected of the files of a directory; `None`, with a word, where it is absent.
fn expectations(name: &str) -> Option<(PathBuf, Vec<Value>)> {
    let Some(directory) = directory(name) else {
        println!("skipped: no shared/{name} beside the repository");
        return None;
    };
    let text = std::fs::read_to_string(directory.join("expected.json")).unwrap();
    Some((directory, serde_json::from_str(&text.replace("NaN", "null")).unwrap()))
}

/// Factor of a length unit, in metres; `None` for what is none.
fn metres(unit: &str) -> Option<f64> {
    match unit {
        "m" => Some(1.0),
        "mm" => Some(1e-3),
        "\u{b5}m" => Some(1e-6),
        "nm" => Some(1e-9),
        _ => None,
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().map(|all| all.iter().filter_map(Value::as_f64).collect()).unwrap_or_default()
}

fn check(expected: &Value, scan: &Scan) -> Result<(), String> {
    let metadata = scan.metadata();
    let unit = expected["unit"].as_str().unwrap_or_default();
    let factor = metres(unit);
    // Without a length unit, values are compared as they stand; a pair is the unit of the sides and that of the values.
    let of_pair = unit.strip_prefix("('").and_then(|pair| metres(pair.split('\'').next()?));
    let lateral = factor.or(of_pair).unwrap_or(1.0);
    let own = metadata.unit.as_ref().map_or(1.0, |u| u.value.to_si(1.0));
    let to = factor.map_or(1.0, |factor| own / factor);
    let close = |what: &str, found: f64, wanted: f64, scale: f64| {
        let near = (found - wanted).abs() <= CLOSE * scale.max(wanted.abs());
        near.then_some(()).ok_or_else(|| format!("{what}: {found:e}, expected {wanted:e}"))
    };
    let pixels: Vec<usize> = numbers(&expected["pixels"]).iter().map(|n| *n as usize).collect();
    if [metadata.columns, metadata.rows] != pixels[..] {
        return Err(format!("{} x {}, expected {pixels:?}", metadata.columns, metadata.rows));
    }
    let sizes = numbers(&expected["sizes"]);
    match (metadata.size, &sizes[..]) {
        (Some(size), [_, _]) => {
            for (found, wanted) in size.iter().zip(sizes) {
                close("size", found.value(), wanted * lateral, 0.0)?;
            }
        }
        (None, []) => {}
        (found, _) => return Err(format!("size {found:?}, expected {sizes:?}")),
    }
    if metadata.unit.is_some() != factor.is_some() {
        return Err(format!("unit {:?}, expected {unit:?}", metadata.unit));
    }
    let rms = expected["rms"].as_f64().unwrap();
    close("undefined", metadata.undefined_share(), expected["undefined"].as_f64().unwrap(), 0.0)?;
    let [low, high] = metadata.range.ok_or("no height")?;
    close("minimum", low * to, expected["minimum"].as_f64().unwrap(), rms)?;
    close("maximum", high * to, expected["maximum"].as_f64().unwrap(), rms)?;
    close("rms", metadata.rms_height.ok_or("no rms")? * to, rms, rms)?;
    for sample in expected["samples"].as_array().into_iter().flatten() {
        let at = numbers(sample);
        let found = scan.height(at[1] as usize, at[0] as usize);
        match (found, sample[2].as_f64()) {
            (Some(found), Some(wanted)) => close(&format!("height at {sample}"), found * to, wanted, rms)?,
            (None, None) => {}
            (found, _) => return Err(format!("height at {sample}: {found:?}")),
        }
    }
    Ok(())
}

#[test]
fn real_files_are_read_as_an_independent_reader_does() {
    let Some((directory, expected)) = expectations("measured") else { return };
    let mut wrong = Vec::new();
    for entry in &expected {
        let name = entry["file"].as_str().unwrap();
        let file = SurfaceFile::open(&directory.join(name), &ReadOptions::default());
        let found = match (file, entry.get("refused")) {
            (Err(error), Some(_)) => {
                println!("refused: {error}");
                Ok(())
            }
            (Ok(file), Some(_)) => match file.scan() {
                Ok(_) => Err("read".into()),
                Err(error) => {
                    println!("refused: {error}");
                    Ok(())
                }
            },
            (Err(error), None) => Err(error.to_string()),
            (Ok(file), None) => {
                let channel = entry["channel"].as_u64().unwrap() as usize;
                match file.scans().nth(channel) {
                    None => Err("no such channel".into()),
                    Some(Err(error)) => Err(error.to_string()),
                    Some(Ok(scan)) => check(entry, &scan),
                }
            }
        };
        if let Err(problem) = found {
            wrong.push(format!("{name}, channel {}: {problem}", entry["channel"]));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), expected.len(), wrong.join("\n"));
}

/// Endings of files whose formats are read elsewhere or not yet.
const PASSED: [&str; 5] = ["opdx", "tmd", "nms", "bcrf", "frt"];

/// That reader lists channels of heights only: they are found by their names, a lone one by having heights.
#[test]
fn real_files_of_probe_microscopes_are_read_as_an_independent_reader_does() {
    let Some((directory, expected)) = expectations("formats") else { return };
    let mut wrong = Vec::new();
    for entry in &expected {
        let (file, name) = (entry["file"].as_str().unwrap(), entry["name"].as_str().unwrap());
        if PASSED.iter().any(|ending| file.ends_with(&format!(".{ending}"))) {
            continue;
        }
        let channel = (name != "Default").then(|| surface_io::ChannelChoice::Name(name.to_owned()));
        let options = ReadOptions { channel, ..ReadOptions::default() };
        let scan = Scan::read(&directory.join(file), &options).map_err(|error| error.to_string());
        if let Err(problem) = scan.and_then(|scan| check(entry, &scan)) {
            wrong.push(format!("{file}, {name}: {problem}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), expected.len(), wrong.join("\n"));
}
