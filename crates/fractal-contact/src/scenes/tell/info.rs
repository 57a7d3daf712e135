//! Descriptions of files: a scene, a surface or a table of results.

use crate::scenes::plan::{Plan, of_slopes};
use crate::scenes::read::asked_surface::AskedFile;
use crate::scenes::read::missing_keys::{MissingKey, missing_keys};
use crate::scenes::read::{
    Error, Remark, Result, SceneFile, System, description, exchanged_sides, number, remarks,
};
use crate::scenes::tell::statistics::MeasuredMap;
use crate::scenes::tell::{MapStatisticsTables, SurfaceReport};
use contact_model::Boundary;
use runs::Header;
use std::path::Path;
use surface_io::{
    Description, Detrend, Dimension, Metadata, Preprocessed, Preprocessing, Quantity, ReadOptions, Scan,
    SurfaceFile, Undefined,
};
use surface_statistics::FilledPoints;

/// A few lines on a scene (`.toml`), a table (`.csv` with a header that explains itself) or a surface
/// (anything else).
///
/// `declared` are the options for reading a surface's file, and `preprocessing` is applied to its map before
/// it is described.
///
/// # Errors
/// As [`SceneFile::read`] and [`crate::scenes::check`] for scenes; [`Error::Run`] and [`Error::Surface`] for
/// errors of the file.
pub fn info(path: &Path, declared: &ReadOptions, preprocessing: &Preprocessing) -> Result<String> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match ending {
        "toml" => Ok(Plan::new(&SceneFile::read(path)?)?.to_string()),
        "csv" if explains_itself(path) => table(path),
        _ => surface(path, declared, preprocessing),
    }
}

fn explains_itself(path: &Path) -> bool {
    runs::files::read(path, u64::MAX)
        .is_ok_and(|bytes| bytes.starts_with(b"# ") && bytes.windows(10).any(|w| w == b"\n# column "))
}

fn table(path: &Path) -> Result<String> {
    let file = runs::CsvFile::read(path)?;
    let mut text = format!("{} rows of {} columns\n\n", file.rows.len(), file.columns.len());
    for line in &file.comments {
        text += &format!("{line}\n");
    }
    text.push('\n');
    for name in &file.columns {
        let values: Vec<f64> = file.numbers(name)?.into_iter().flatten().collect();
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if values.is_empty() {
            let mut words: Vec<&str> = file.texts(name)?;
            words.sort_unstable();
            words.dedup();
            words.retain(|w| !w.is_empty());
            let some: Vec<&str> = words.iter().copied().take(6).collect();
            let more = if words.len() > some.len() { ", ..." } else { "" };
            text += &format!(
                "{name:24} {}{more}\n",
                if some.is_empty() { "empty".into() } else { some.join(", ") }
            );
        } else {
            let [low, high] = [low, high].map(number);
            text += &format!("{name:24} {low} to {high}, {} of {} rows\n", values.len(), file.rows.len());
        }
    }
    Ok(text)
}

fn surface(path: &Path, declared: &ReadOptions, preprocessing: &Preprocessing) -> Result<String> {
    let file = SurfaceFile::open(path, declared)?;
    if file.len() > 1 && declared.channel.is_none() {
        return each(file);
    }
    if file.has_no_heights() {
        return each(file);
    }
    let scan = file.scan()?;
    Ok(match scan.preprocessed(preprocessing) {
        Ok(found) => {
            let system = system(scan.metadata());
            let mut description = description(&found.map, system);
            let mut fit = "";
            if description.hurst.is_ok() {
                // Only one exponent is shown: that of the statistics, which has an interval.
                description = description.without_fit();
                fit = "fractal dimension  with --out DIR, which fits the spectrum, with its interval\n";
            }
            let text = described(&scan, &found, &description);
            let line = |message: &str, help: &str| format!("note       {message}\n           {help}\n");
            let slopes = of_slopes(system, Some(&description));
            let slopes = slopes.map(|note| line(note.message(), note.help().unwrap_or_default()));
            let untilted = preprocessing.detrend != Detrend::default();
            let remarks = remarks(&scan, preprocessing, &found.map, untilted).into_iter();
            let remarks = exchanged_sides(declared, scan.metadata(), system).into_iter().chain(remarks);
            let remarks: String = remarks.map(|Remark { message, help }| line(&message, help)).collect();
            format!("{text}{fit}{}{remarks}", slopes.unwrap_or_default())
        }
        // The reason why the file gives no map is part of the description.
        Err(error) => format!("{}\n\nno map without further options: {error}\n", scan.metadata()),
    })
}

/// As [`info`] of a surface, with its statistics. Tables and pictures of parameters, spectra and height
/// differences and `report.html` are written into a directory; the parameters are also returned as lines.
///
/// The map is taken as a piece of a larger surface and not as periodic.
///
/// # Errors
/// [`Error::Surface`] for errors of the file and where it gives no map; [`Error::Run`] for files that cannot
/// be written.
pub fn info_statistics(
    path: &Path,
    declared: &ReadOptions,
    preprocessing: &Preprocessing,
    out: &Path,
) -> Result<String> {
    let ending = path.extension().and_then(|e| e.to_str());
    if ending == Some("toml") || ending == Some("csv") && explains_itself(path) {
        let reason = format!("{} is no surface: statistics are of the heights in a file", path.display());
        return Err(Error::Argument { name: "out", reason });
    }
    let scan = SurfaceFile::open(path, declared).and_then(SurfaceFile::scan)?;
    let found = scan.preprocessed(preprocessing)?;
    let statistics = statistics_of(&scan, &found);
    let name = path.file_name().map_or_else(|| "surface".into(), |name| name.to_string_lossy().into_owned());
    let mut header = Header { command: format!("fractal-contact info {name}"), ..Header::default() };
    for step in &found.steps {
        header = header.with_note(step.clone());
    }
    runs::files::create_directory(out)?;
    let mut files = Vec::new();
    let mut write = |name: &str, bytes: Vec<u8>| -> Result<()> {
        let path = out.join(name);
        runs::files::write_whole(&path, &bytes)?;
        files.push(path);
        Ok(())
    };
    statistics.files(&header, &name, &mut write)?;
    let report = SurfaceReport {
        name: &name,
        metadata: scan.metadata(),
        steps: &found.steps,
        map: &found.map,
        statistics: &statistics,
    };
    write("report.html", report.page()?.html().into_bytes())?;
    let names: Vec<String> = runs::file_names(&files);
    // Only one exponent is shown: that of the statistics, which has an interval.
    let text = described(&scan, &found, &description(&found.map, system(scan.metadata())).without_fit());
    Ok(format!("{text}\n{}\n{}: {}\n", statistics.text(), out.display(), names.join(", ")))
}

/// Statistics of a map that is a piece of a larger surface.
fn statistics_of(scan: &Scan, found: &Preprocessed) -> MapStatisticsTables {
    let filled = found.holes.as_ref().map(FilledPoints::new);
    let measured = MeasuredMap {
        map: &found.map,
        filled: filled.as_ref(),
        profile: scan.metadata().profile,
        boundary: Boundary::Free,
        instrument: found.reliable_from,
    };
    MapStatisticsTables::new(measured, system(scan.metadata()))
}

/// The description of a file in memory: its channels, the keys that it lacks, and its map.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct DescribedFile {
    /// All channels as JSON, as [`info_json`] has them.
    pub channels: String,
    /// The keys that the file needs besides those that are given, for the channel that was chosen.
    pub missing: Vec<MissingKey>,
    /// The map, its statistics and its spectrum as HTML, or the reason why the file gives no map as it is read now.
    pub map: std::result::Result<String, String>,
}

/// Describes a file in memory. `given` returns the value of a key of `[scene.surface]`, and all that are given are
/// in `asked` too.
///
/// # Errors
/// [`Error::Surface`] for a file that has no channel which can be read.
pub fn describe_file(
    name: &str,
    bytes: &[u8],
    asked: &AskedFile,
    given: &dyn Fn(&str) -> Option<String>,
) -> Result<DescribedFile> {
    let (declared, preprocessing) = (&asked.declared, asked.preprocessing());
    let channels =
        channels_json(&|declared| SurfaceFile::from_bytes(name, bytes, declared), declared, &preprocessing)?;
    let scan = SurfaceFile::from_bytes(name, bytes, declared).and_then(SurfaceFile::scan);
    let (missing, map) = match scan {
        Ok(scan) => {
            let map = match scan.preprocessed(&preprocessing) {
                Ok(found) => Ok(page_of(name, &scan, &found)?),
                Err(error) => Err(error.to_string()),
            };
            (missing_keys(scan.metadata(), given), map)
        }
        Err(error) => (Vec::new(), Err(error.to_string())),
    };
    Ok(DescribedFile { channels, missing, map })
}

/// The page of a surface without its frame.
fn page_of(name: &str, scan: &Scan, found: &Preprocessed) -> Result<String> {
    let statistics = &statistics_of(scan, found);
    let (metadata, steps, map) = (scan.metadata(), &found.steps, &found.map);
    Ok(SurfaceReport { name, metadata, steps, map, statistics }.page()?.content())
}

/// Whether lengths are in metres.
fn system(of: &Metadata) -> System {
    let metric = of.unit.as_ref().is_some_and(|unit| unit.value.dimension() == Dimension::LENGTH);
    if metric { System::Si } else { System::None }
}

/// The metadata of a file, the steps of its preprocessing, and a description of the map.
fn described(scan: &Scan, found: &Preprocessed, description: &Description) -> String {
    let steps: String = found.steps.iter().map(|step| format!("then       {step}\n")).collect();
    format!("{}\n{steps}\n{description}\n", scan.metadata())
}

/// A description of each channel of a file with several.
fn each(file: SurfaceFile<'_>) -> Result<String> {
    let mut text = match file.len() {
        1 => "1 channel, whose values are no heights\n".to_owned(),
        count => format!("{count} channels; --channel NUMBER or NAME describes one\n"),
    };
    for scan in file.scans() {
        match scan {
            Ok(scan) => text += &format!("\n{}\n", scan.metadata()),
            // The other channels are described nevertheless.
            Err(error) if error.problem().is_some() => text += &format!("\nnot read   {error}\n"),
            Err(error) => return Err(error.into()),
        }
    }
    Ok(text)
}

/// All channels of a surface's file as JSON:
/// `{"channels": [{"name", "columns", "rows", "profile", "size": [x, y], "heights", "unit", "undefined", "minimum", "maximum", "rms", "notes", "steps"}]}`.
///
/// Heights are those of the file, or of its map after the steps of `preprocessing` where there are any; `steps`
/// has a line for each. Lengths are in metres, and then `unit` is "m"; values with another or no unit are given
/// as in the file. `heights` is false where the file says that the channel does not hold heights (but a phase
/// or a current). `rms` is about the mean, `undefined` is a share of the points, and a value that neither the
/// file nor `declared` gives is null. A channel that cannot be read beside others, or that gives no map, has `error`, and
/// its name and its cells as far as they are known; `notes` are remarks on the file.
///
/// # Errors
/// [`Error::Surface`] for errors of the file.
pub fn info_json(path: &Path, declared: &ReadOptions, preprocessing: &Preprocessing) -> Result<String> {
    channels_json(&|declared| SurfaceFile::open(path, declared), declared, preprocessing)
}

/// Opens a file with these options.
type Open<'a> = dyn Fn(&ReadOptions) -> surface_io::Result<SurfaceFile<'a>> + 'a;

fn channels_json(open: &Open<'_>, declared: &ReadOptions, preprocessing: &Preprocessing) -> Result<String> {
    let file = open(declared)?;
    let mut channels = Vec::with_capacity(file.len());
    for (number, scan) in file.scans().enumerate() {
        let mut described = serde_json::json!({});
        let found = scan.and_then(|scan| {
            described = of_metadata(scan.metadata());
            channel(&scan, number, (open, declared), preprocessing)
        });
        channels.push(match found {
            Ok(channel) => channel,
            Err(error) if error.problem().is_some() => {
                // What it is called is known, although its heights are not.
                let mut channel = serde_json::json!({ "error": error.to_string() });
                for name in ["name", "details", "columns", "rows", "heights"] {
                    if let Some(known) = described.get(name) {
                        channel[name] = known.clone();
                    }
                }
                channel
            }
            Err(error) => return Err(error.into()),
        });
    }
    Ok(format!("{:#}\n", serde_json::json!({ "channels": channels })))
}

/// The channel of a number, after the steps of its preprocessing.
fn channel(
    scan: &Scan,
    number: usize,
    (open, declared): (&Open<'_>, &ReadOptions),
    preprocessing: &Preprocessing,
) -> surface_io::Result<serde_json::Value> {
    let metadata = scan.metadata();
    let mut described = of_metadata(metadata);
    if *preprocessing == Preprocessing::default() {
        return Ok(described);
    }
    let mut preprocessing = preprocessing.clone();
    if preprocessing.fill.is_none() {
        // The share of undefined points is part of the answer.
        preprocessing.undefined.get_or_insert(Undefined::NoContact);
    }
    let known = metadata.size.is_some();
    let Preprocessed { map, steps, .. } = if known {
        scan.preprocessed(&preprocessing)?
    } else {
        // Most steps need no lengths: cells of 1, whose size is not told.
        let dimension = metadata.unit.as_ref().map_or(Dimension::NONE, |unit| unit.value.dimension());
        let cell = Quantity::new(1.0, dimension).ok().map(Into::into);
        let file = open(&ReadOptions { cell, ..declared.clone() })?;
        match file.scans().nth(number) {
            Some(scan) => scan?.preprocessed(&preprocessing)?,
            None => scan.preprocessed(&preprocessing)?,
        }
    };
    let (low, high) =
        map.defined().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), h| (low.min(h), high.max(h)));
    let some = low <= high;
    for (name, value) in [
        ("columns", map.columns().into()),
        ("rows", map.rows().into()),
        ("size", serde_json::json!(known.then(|| [map.size().x, map.size().y]))),
        ("undefined", serde_json::json!(map.undefined() as f64 / map.heights().len() as f64)),
        ("minimum", serde_json::json!(some.then_some(low))),
        ("maximum", serde_json::json!(some.then_some(high))),
        ("rms", serde_json::json!(some.then(|| surface_gen::rms_height(&map.defined().collect::<Vec<_>>())))),
        ("steps", steps.into()),
    ] {
        described[name] = value;
    }
    Ok(described)
}

fn of_metadata(metadata: &Metadata) -> serde_json::Value {
    let unit = metadata.unit.as_ref().map(|unit| &unit.value);
    let metric = unit.filter(|unit| unit.dimension() == Dimension::LENGTH);
    let height = |value: f64| metric.map_or(value, |unit| unit.to_si(value));
    let unit = match (metric, &metadata.no_heights) {
        (Some(_), _) => Some("m"),
        (None, Some(unit)) if !unit.is_empty() => Some(unit.as_str()),
        _ => None,
    };
    serde_json::json!({
        "name": metadata.name,
        "details": metadata.details,
        "columns": metadata.columns,
        "rows": metadata.rows,
        "profile": metadata.profile,
        "size": metadata.size.map(|size| size.map(Quantity::value)),
        "heights": metadata.no_heights.is_none(),
        "unit": unit,
        "undefined": metadata.undefined_share(),
        "minimum": metadata.range.map(|[low, _]| height(low)),
        "maximum": metadata.range.map(|[_, high]| height(high)),
        "rms": metadata.rms_height.map(height),
        "notes": metadata.notes,
        "steps": Vec::<String>::new(),
    })
}
