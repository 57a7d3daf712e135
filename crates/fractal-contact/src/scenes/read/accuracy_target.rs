//! `accuracy` and `budget` of `[scene]`.

use crate::scenes::read::{Entries, Entry, Read, System};
use analysis::AccuracyTarget;
use surface_io::Dimension;

/// Default budget of `accuracy`, in seconds.
const BUDGET: f64 = 600.0;

/// Reads `accuracy` and `budget`, with the place of the former.
pub(crate) fn read_accuracy<'a>(scene: &Entries<'a>) -> Read<Option<(AccuracyTarget, Entry<'a>)>> {
    let accuracy = scene.find("accuracy");
    let help = "it limits the time that `accuracy = \"1 %\"` may take: add that, or remove it";
    let budget = scene.beside("budget", "accuracy", help)?;
    let Some(entry) = accuracy else { return Ok(None) };
    let share = if entry.as_word() == Some("best") { 0.0 } else { read_share(&entry)? };
    // The budget is a waiting time: it has a unit in every scene.
    let seconds = budget.map_or(Ok(BUDGET), |entry| entry.positive(Dimension::TIME, System::Si))?;
    Ok(Some((AccuracyTarget { share, seconds }, entry)))
}

fn read_share(entry: &Entry<'_>) -> Read<f64> {
    let share = entry.pure_number()?;
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(entry
        .diagnostic(format!("`accuracy` = {}: expected a share above 0 and below 100 %", entry.shown()))
        .with_help("such as \"1 %\" or 0.01, or \"best\" within the `budget`"))
}
