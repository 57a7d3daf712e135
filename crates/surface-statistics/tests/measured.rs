//! Real maps against what an independent program (SurfaceTopography 1.27.1) measures on them.
//!
//! The files are no part of the repository: where they are absent, the test says that it skipped.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use contact_model::{Boundary, HeightMap};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use std::path::{Path, PathBuf};
use surface_io::{Detrend, Preprocessing, ReadOptions, Scan, SurfaceFile};
use surface_statistics::{Bins, Derivatives, DifferenceMap, PowerSpectrum, Taper};

/// Relative differences of all results.
const CLOSE: f64 = 1e-6;
/// Heights of planes, where a file has nothing else, are rounding: they are not compared.
const ROUNDING: f64 = 1e-9;
/// The program has C_2D = |h(q)|^2/(Lx Ly), this crate that over (2 pi)^2.
const SPECTRUM: f64 = TAU * TAU;

fn directory() -> Option<PathBuf> {
    let found = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/measured");
    found.join("expected.json").exists().then_some(found)
}

/// The logarithmic bins of that program: so many edges per decade and as many again, a hundredth of a decade
/// wider.
fn bins(from: f64, to: f64, per_decade: f64) -> Bins {
    let (low, high) = (from.log10(), to.log10());
    let count = ((high - low + 1.0) * per_decade).ceil() as usize;
    let (low, high) = (low - 0.01, high + 0.01);
    let edge = |k: usize| 10_f64.powf(low + (high - low) * (k as f64 / (count - 1) as f64));
    Bins::new((0..count).map(edge).collect()).unwrap()
}

fn numbers(value: &Value) -> Vec<[f64; 2]> {
    let pair = |p: &Value| Some([p[0].as_f64()?, p[1].as_f64()?]);
    value.as_array().into_iter().flatten().filter_map(pair).collect()
}

/// Whether each expected point is one of the curve.
fn compare(what: &str, curve: &[[f64; 2]], expected: &[[f64; 2]]) -> Result<f64, String> {
    let mut worst: f64 = 0.0;
    for [x, y] in expected {
        let near = curve.iter().min_by(|a, b| (a[0] / x).ln().abs().total_cmp(&(b[0] / x).ln().abs()));
        let [at, found] = near.ok_or("empty")?;
        worst = worst.max((at / x - 1.0).abs()).max((found / y - 1.0).abs());
        if worst > CLOSE {
            return Err(format!("{what} at {x:e}: {at:e}, {found:e}; expected {y:e}"));
        }
    }
    Ok(worst)
}

/// The autocorrelation of that program: of vectors with both components >= 0 alone, each with the same
/// weight, whatever its number of pairs.
fn quadrant(map: &HeightMap, bins: &Bins) -> Vec<[f64; 2]> {
    let differences = DifferenceMap::new(map, Boundary::Free);
    let mut sums = vec![[0.0; 3]; bins.edges().len() - 1];
    for y in 0..map.rows() {
        for x in 0..map.columns() {
            let r = (x as f64 * map.dx()).hypot(y as f64 * map.dy());
            if let Some(bin) = bins.index(r) {
                let [value, _] = differences.at([x.cast_signed(), y.cast_signed()]).unwrap();
                sums[bin] = [sums[bin][0] + 1.0, sums[bin][1] + r, sums[bin][2] + value];
            }
        }
    }
    sums.iter().filter(|s| s[0] > 0.0).map(|[n, r, a]| [r / n, a / n]).collect()
}

/// The largest relative difference; `None` for a plane.
fn check(entry: &Value, map: &HeightMap) -> Result<Option<f64>, String> {
    let plane = &entry["plane_removed"];
    let number = |name: &str| plane[name].as_f64().ok_or(name.to_owned());
    let rms = surface_gen::rms_height(map.heights());
    let range = map.highest().abs().max(entry["rms"].as_f64().ok_or("rms")?);
    if number("rms")? < ROUNDING * range {
        return Ok(None);
    }
    let derivatives = Derivatives::new(map, Boundary::Free).map_err(|e| e.to_string())?;
    let mut worst: f64 = 0.0;
    for (name, found) in [
        ("rms", rms),
        ("rms_gradient", derivatives.rms_gradient),
        ("rms_curvature", derivatives.rms_curvature),
    ] {
        let wanted = number(name)?;
        worst = worst.max((found / wanted - 1.0).abs());
        if worst > CLOSE {
            return Err(format!("{name}: {found:e}, expected {wanted:e}"));
        }
    }
    let (size, cell) = (map.size(), [map.dx(), map.dy()]);
    let waves = bins(TAU / size.x.max(size.y), PI / cell[0].max(cell[1]), 10.0);
    let spectrum = PowerSpectrum::radial(map, Taper::RadialHann, &waves).map_err(|e| e.to_string())?;
    let curve: Vec<_> =
        spectrum.wavenumber.iter().zip(&spectrum.density).map(|(q, c)| [*q, c * SPECTRUM]).collect();
    worst = worst.max(compare("spectrum", &curve, &numbers(&entry["psd"]))?);
    let from = (0.5 * (cell[0] + cell[1])).max(cell[0].min(cell[1]));
    let distances = bins(from, 0.5 * (size.x + size.y), 5.0);
    Ok(Some(worst.max(compare("autocorrelation", &quadrant(map, &distances), &numbers(&entry["acf"]))?)))
}

/// The map of a scan in the unit of the entry, without its plane.
fn map_of(scan: &Scan, entry: &Value) -> Result<HeightMap, String> {
    let plane = Preprocessing { detrend: Detrend::Plane, ..Preprocessing::default() };
    let map = scan.map(&plane).map_err(|e| e.to_string())?;
    let unit = match entry["unit"].as_str() {
        Some("nm") => 1e9,
        Some("\u{b5}m") => 1e6,
        Some("mm") => 1e3,
        _ => 1.0,
    };
    map.scaled(unit, unit).map_err(|e| e.to_string())
}

#[test]
fn measures_of_real_maps_are_those_of_an_independent_program() {
    let Some(directory) = directory() else {
        println!("skipped: no ../shared/measured beside the repository");
        return;
    };
    let text = std::fs::read_to_string(directory.join("expected.json")).unwrap();
    let expected: Vec<Value> = serde_json::from_str(&text.replace("NaN", "null")).unwrap();
    let (mut wrong, mut count, mut worst) = (Vec::new(), 0, 0.0_f64);
    for entry in expected.iter().filter(|entry| entry.get("psd").is_some()) {
        let name = entry["file"].as_str().unwrap();
        let channel = entry["channel"].as_u64().unwrap() as usize;
        let file = SurfaceFile::open(directory.join(name), &ReadOptions::default()).unwrap();
        let scan = file.scans().nth(channel).unwrap().unwrap();
        match map_of(&scan, entry).and_then(|map| check(entry, &map)) {
            Ok(Some(found)) => (count, worst) = (count + 1, worst.max(found)),
            Ok(None) => println!("{name}, channel {channel}: a plane"),
            Err(problem) => wrong.push(format!("{name}, channel {channel}: {problem}")),
        }
    }
    println!("{count} maps, largest relative difference {worst:e}");
    assert!(count >= 16 && wrong.is_empty(), "{} of {count}:\n{}", wrong.len(), wrong.join("\n"));
}
