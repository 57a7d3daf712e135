//! `accuracy`, `budget` and `memory` of `[scene]`.

use crate::scenes::read::{Entries, Entry, Read, System};
use analysis::AccuracyTarget;
use surface_io::Dimension;

/// Default budget of `accuracy`, in seconds.
const BUDGET: f64 = 600.0;
/// Default `memory` of `accuracy`, in bytes.
const MEMORY: f64 = 4e9;
/// Units of an amount of memory.
const MEMORY_UNITS: [(&str, f64); 3] = [("MB", 1e6), ("GB", 1e9), ("TB", 1e12)];

/// The accuracy that a scene requests, and what the run may take for it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RequestedAccuracy {
    /// The error of the grid, and the time: seconds of one thread of the machine whose times are compiled in.
    pub target: AccuracyTarget,
    /// Memory of one surface, in bytes.
    pub memory: f64,
}

impl From<AccuracyTarget> for RequestedAccuracy {
    /// With the default of `memory`, 4 GB.
    fn from(target: AccuracyTarget) -> Self {
        Self { target, memory: MEMORY }
    }
}

/// Reads `accuracy`, `budget` and `memory`, with the place of the first.
pub(crate) fn read_accuracy<'a>(scene: &Entries<'a>) -> Read<Option<(RequestedAccuracy, Entry<'a>)>> {
    let accuracy = scene.find("accuracy");
    let help = "it limits the time that `accuracy = \"1 %\"` may take: add that, or remove it";
    let budget = scene.beside("budget", "accuracy", help)?;
    let help = "it limits the memory that `accuracy = \"1 %\"` may take: add that, or remove it";
    let memory = scene.beside("memory", "accuracy", help)?;
    let Some(entry) = accuracy else { return Ok(None) };
    let share = if entry.as_word() == Some("best") { 0.0 } else { read_share(&entry)? };
    // The budget is a waiting time: it has a unit in every scene.
    let seconds = budget.map_or(Ok(BUDGET), |entry| entry.positive(Dimension::TIME, System::Si))?;
    let memory = memory.as_ref().map_or(Ok(MEMORY), read_memory)?;
    Ok(Some((RequestedAccuracy { target: AccuracyTarget { share, seconds }, memory }, entry)))
}

fn read_share(entry: &Entry<'_>) -> Read<f64> {
    let share = entry.pure_number()?;
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(entry
        .diagnostic(format!("`accuracy` = {}: expected a share above 0 and below 100 %", entry.shown()))
        .with_help("such as \"1 %\" or 0.01, or \"best\" within the `budget` and the `memory`"))
}

/// An amount of memory in bytes.
fn read_memory(entry: &Entry<'_>) -> Read<f64> {
    let amount = entry.as_word().and_then(|text| {
        MEMORY_UNITS.iter().find_map(|(unit, bytes)| {
            Some(text.trim().strip_suffix(unit)?.trim().parse::<f64>().ok()? * bytes)
        })
    });
    amount.filter(|bytes| *bytes > 0.0 && bytes.is_finite()).ok_or_else(|| {
        entry
            .diagnostic(format!("`memory` = {}: expected an amount of memory above 0", entry.shown()))
            .with_help("write it with its unit, MB, GB or TB, such as \"4 GB\"")
    })
}
