//! What a file holds: a scene, a surface or a table of results.

use crate::scenes::error::{Error, Result};
use crate::scenes::plan::Plan;
use crate::scenes::scene_file::SceneFile;
use std::path::Path;
use surface_io::{Preprocessing, ReadOptions, Scan, describe};

/// A few lines on a scene (`.toml`), a table (`.csv` with a header that explains itself) or a surface
/// (anything else).
///
/// `declared` is what the caller says about a surface's file, `preprocessing` what is done to its map before it is described.
///
/// # Errors
/// As [`SceneFile::read`] and [`crate::scenes::check`] for scenes; [`Error::Run`] and [`Error::Surface`] with
/// what is wrong with the file.
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
            let [low, high] = [low, high].map(crate::scenes::human_readable::number);
            text += &format!("{name:24} {low} to {high}, {} of {} rows\n", values.len(), file.rows.len());
        }
    }
    Ok(text)
}

fn surface(path: &Path, declared: &ReadOptions, preprocessing: &Preprocessing) -> Result<String> {
    let scan = Scan::read(path, declared).map_err(Error::Surface)?;
    let mut text = format!("{}\n", scan.metadata());
    match scan.map(preprocessing) {
        Ok(map) => text += &format!("\n{}\n", describe(&map)),
        // What stands in the way of a map is part of the answer.
        Err(error) => text += &format!("\nno map as it is: {error}\n"),
    }
    Ok(text)
}
