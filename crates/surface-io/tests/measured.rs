//! Real files of instruments against what an independent reader (SurfaceTopography 1.27.1) finds in them.
//!
//! The files are no part of the repository: where they are absent, the test says that it skipped.

#![allow(clippy::unwrap_used)] // Tests, as a whole.

use serde_json::Value;
use std::path::{Path, PathBuf};
use surface_io::{Axes, Border, ReadOptions, Scan, SurfaceFile};

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
    // Without a length unit, values are compared as they stand; a pair is the unit of the sides and that of
    // the values.
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
        let file = SurfaceFile::open(directory.join(name), &ReadOptions::default());
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

/// Of these the independent reader is wrong; tests of their own say where.
const OTHERWISE: [&str; 1] = ["nms-1.nms"];

/// That reader lists channels of heights only: they are found by their names, a lone one by having heights.
#[test]
fn real_files_of_more_formats_are_read_as_an_independent_reader_does() {
    let Some((directory, expected)) = expectations("formats") else { return };
    let mut wrong = Vec::new();
    for entry in &expected {
        let (file, name) = (entry["file"].as_str().unwrap(), entry["name"].as_str().unwrap());
        if OTHERWISE.contains(&file) {
            continue;
        }
        let channel =
            (!name.eq_ignore_ascii_case("Default")).then(|| surface_io::ChannelChoice::Name(name.to_owned()));
        let options = ReadOptions { channel, ..ReadOptions::default() };
        let scan = Scan::read(directory.join(file), &options).map_err(|error| error.to_string());
        if let Err(problem) = scan.and_then(|scan| check(entry, &scan)) {
            wrong.push(format!("{file}, {name}: {problem}"));
        }
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), expected.len(), wrong.join("\n"));
}

/// The bytes `25 8a bb f6 ff 87 73 40` at offset 1376 are 312.49999, of which 512 make 160 um in nm: the
/// field of a 100x objective. Read as mm, as the independent reader does, they make 160 m. The numbers 0 and
/// 65535 both occur, and the header has 0 and 65535 (offset 8) for the heights 2.689124584197998 and
/// 6.007402420043945 (offset 16); that reader divides by 65534 and finds 6.007453 as the largest.
#[test]
fn a_map_of_a_confocal_microscope_is_160_um_wide() {
    let Some(directory) = directory("formats") else { return };
    let path = directory.join("nms-1.nms");
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes[8..16], [0, 0, 0, 0, 0xff, 0xff, 0, 0]);
    assert_eq!(bytes[1376..1384], [0x25, 0x8a, 0xbb, 0xf6, 0xff, 0x87, 0x73, 0x40]);
    let scan = Scan::read(&path, &ReadOptions::default()).unwrap();
    let metadata = scan.metadata();
    assert_eq!([metadata.columns, metadata.rows, metadata.undefined], [512, 512, 0]);
    for side in metadata.size.unwrap() {
        assert!((side.value() / 160e-6 - 1.0).abs() < 1e-6, "{side}");
    }
    let [low, high] = metadata.range.unwrap();
    assert!((low - 2.689_124_584_197_998).abs() < 1e-12 && (high - 6.007_402_420_043_945).abs() < 1e-12);
    // Heights of the independent reader, of which those above the lowest are 65535 / 65534 too large.
    for (row, column, other) in [
        (0, 0, 2.689_124_584_197_998),
        (0, 511, 4.886_203_864_803_356),
        (511, 0, 3.810_475_042_778_954),
        (102, 170, 3.648_242_275_268_189_3),
    ] {
        let expected = low + (other - low) * 65534.0 / 65535.0;
        assert!((scan.height(row, column).unwrap() - expected).abs() < 1e-9, "{row}, {column}");
    }
    assert!((metadata.rms_height.unwrap() - 0.718_718_598_411_046_9 * 65534.0 / 65535.0).abs() < 1e-9);
}

/// 3001 points at places 0 to 49.96669 um, the first number 11.047387 in units of 1.24177e-4 um.
#[test]
fn a_line_of_a_stylus_has_the_distance_of_its_places() {
    let Some(directory) = directory("formats") else { return };
    let path = directory.join("opdx-3.opdx");
    let bytes = std::fs::read(&path).unwrap();
    let double = |at: usize| f64::from_le_bytes(bytes[at..at + 8].try_into().unwrap());
    let (extent, scale, first) = (double(48334), double(48474), double(48561));
    let scan = Scan::read(&path, &ReadOptions::default()).unwrap();
    let metadata = scan.metadata();
    assert_eq!([metadata.columns, metadata.rows, metadata.undefined], [3001, 1, 0]);
    // A profile: one step wide along y.
    let [length, width] = metadata.size.unwrap().map(surface_io::Quantity::value);
    assert!(metadata.profile && (width * 3001.0 / length - 1.0).abs() < 1e-12);
    assert_eq!(metadata.name.as_deref(), Some("Raw Height"));
    assert!((extent - 49.96669).abs() < 1e-5 && (double(24134) - extent).abs() <= 0.0);
    let unit = &metadata.unit.as_ref().unwrap().value;
    assert!((unit.to_si(scan.height(0, 0).unwrap()) - scale * first * 1e-6).abs() < 1e-20);
    assert!((unit.to_si(scan.height(0, 3000).unwrap()) - scale * double(48561 + 24000) * 1e-6).abs() < 1e-20);
}

/// Files of `../shared/reports`: JPK's integers have the scale of their group, an array without labels tells
/// its order, a simple field.
#[test]
fn reported_files_are_read() {
    let Some(directory) = directory("reports") else { return };
    let read = |name: &str, axes| {
        let options = ReadOptions { axes, ..ReadOptions::default() };
        Scan::read(directory.join(name), &options).unwrap()
    };
    let jpk = read("h5-jpk.h5", None);
    assert_eq!(jpk.metadata().unit.as_ref().map(|unit| unit.value.to_string()).as_deref(), Some("m"));
    let [low, high] = jpk.metadata().range.unwrap();
    let of_count = |height: f64| (height + 1e-6) / 1.5e-15;
    for height in [low, high] {
        assert!((of_count(height) - of_count(height).round()).abs() < 1e-3, "{height:e}");
    }
    let (plain, turned) = (read("h5-plain.h5", None), read("h5-plain.h5", Some(Axes::Yx)));
    assert_eq!([plain.metadata().columns, plain.metadata().rows], [3, 4]);
    assert_eq!([turned.metadata().columns, turned.metadata().rows], [4, 3]);
    assert_eq!(plain.height(3, 1), turned.height(1, 3));
    let field = read("made.gsf", None);
    assert_eq!(field.metadata().size.map(|size| size.map(surface_io::Quantity::value)), Some([4e-6, 3e-6]));
    assert_eq!(field.height(1, 0).map(|h| (h * 1e10).round()), Some(40.0));
}

/// The values of `../shared/reports/expected.json`, or the refusal that it allows, of every file there.
#[test]
fn reports_have_their_expected_values() {
    let Some(directory) = directory("reports") else { return };
    let text = std::fs::read_to_string(directory.join("expected.json")).unwrap();
    let all: serde_json::Map<String, Value> = serde_json::from_str(&text).unwrap();
    let mut wrong = Vec::new();
    for (name, expected) in &all {
        let options = ReadOptions {
            // Of several; a channel of no heights is described when it is asked for.
            channel: matches!(name.as_str(), "gwy-concat.txt" | "nano-two.spm" | "nano-nosoft.spm")
                .then(|| "0".parse().unwrap()),
            border: matches!(name.as_str(), "pandas.csv" | "axes-matrix.txt").then_some(Border::Axes),
            ..ReadOptions::default()
        };
        let found = match (name.as_str(), Scan::read(directory.join(name), &options)) {
            ("x3p-upsidedown.x3p", Err(error)) if error.to_string().contains("third axis") => Ok(()),
            (_, Err(error)) => Err(error.to_string()),
            ("nano-aspect-2to1.spm", Ok(scan)) if scan.metadata().size.is_none() => {
                noted(&scan, "Aspect Ratio")
            }
            ("x3p-rotated.x3p", Ok(scan)) => noted(&scan, "rotated"),
            ("x3p-zinc-float.x3p", Ok(scan)) => noted(&scan, "increment"),
            ("nano-nosoft.spm", Ok(scan)) => {
                scan.metadata().no_heights.is_some().then_some(()).ok_or_else(|| "heights".to_owned())
            }
            ("gwy-nounit.gwy", Ok(scan)) => noted(&scan, "without a unit"),
            (_, Ok(scan)) => as_reported(expected, &scan),
        };
        wrong.extend(found.err().map(|problem| format!("{name}: {problem}")));
    }
    assert!(wrong.is_empty(), "{} of {}:\n{}", wrong.len(), all.len(), wrong.join("\n"));
}

fn noted(scan: &Scan, what: &str) -> Result<(), String> {
    let notes = &scan.metadata().notes;
    notes
        .iter()
        .any(|note| note.contains(what))
        .then_some(())
        .ok_or_else(|| format!("no note of it: {notes:?}"))
}

/// Compares what an entry states; heights row by row, `null` where undefined.
fn as_reported(expected: &Value, scan: &Scan) -> Result<(), String> {
    let metadata = scan.metadata();
    let same = |what: &str, found: &[f64], wanted: &[f64]| {
        let near = found.len() == wanted.len()
            && found
                .iter()
                .zip(wanted)
                .all(|(a, b)| (a - b).abs() <= 1e-9 * b.abs() || a.is_nan() && b.is_nan());
        near.then_some(()).ok_or_else(|| format!("{what} {found:?}, expected {wanted:?}"))
    };
    let lengths = |sides: Option<[surface_io::Quantity; 2]>| {
        sides.map_or(Vec::new(), |sides| sides.map(surface_io::Quantity::value).to_vec())
    };
    if let Some(shape) = expected.get("shape") {
        same("shape", &[metadata.rows as f64, metadata.columns as f64], &numbers(shape))?;
    }
    if let Some(undefined) = expected["undefined"].as_f64() {
        same("undefined", &[metadata.undefined as f64], &[undefined])?;
    }
    if let Some(size) = expected.get("size") {
        same("size", &lengths(metadata.size), &numbers(size))?;
    }
    let cell = metadata.cell.as_ref().map(|cell| cell.value);
    for key in ["cell", "cell_m"] {
        if let Some(sides) = expected.get(key) {
            same(key, &lengths(cell), &numbers(sides))?;
        }
    }
    let metric = metadata.unit.as_ref().map(|unit| unit.value.to_si(1.0));
    if expected["unit"] == "m" && metric.is_none() {
        return Err("no unit".into());
    }
    for (key, factor) in [("heights", 1.0), ("heights_m", metric.unwrap_or(1.0))] {
        for (row, line) in expected[key].as_array().into_iter().flatten().enumerate() {
            let wanted: Vec<f64> =
                line.as_array().into_iter().flatten().map(|h| h.as_f64().unwrap_or(f64::NAN)).collect();
            let of = |column| scan.height(row, column).map_or(f64::NAN, |h| factor * h);
            same(key, &(0..metadata.columns).map(of).collect::<Vec<_>>(), &wanted)?;
        }
    }
    Ok(())
}
