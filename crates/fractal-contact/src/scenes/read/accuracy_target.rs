//! `accuracy`, `budget` and `memory` of `[scene]`.

use crate::scenes::read::key::{Key, KeyTable};
use crate::scenes::read::{Diagnostic, Entry, ReadResult, System, printed};
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

/// Keys of the accuracy.
pub(crate) static ACCURACY_KEYS: KeyTable<Option<RequestedAccuracy>> = KeyTable {
    name: "scene",
    kind: "",
    alternatives: &[],
    everyday: &["accuracy"],
    keys: &[
        Key {
            name: "accuracy",
            takes: "share, or `\"best\"`",
            about: "share (`\"1 %\"` or 0.01) that the error of the grid may have, instead of `cells` and `tolerance`; or as small as `budget` and `memory` allow",
            default: "the grid that is given",
            read: |accuracy, entry, _| {
                let share = if entry.as_word() == Some("best") { 0.0 } else { read_share(entry)? };
                *accuracy = Some(AccuracyTarget { share, seconds: BUDGET }.into());
                Ok(())
            },
            print: |accuracy, _| {
                let share = accuracy.as_ref()?.target.share;
                Some(if share > 0.0 { printed::number(share) } else { printed::text("best") })
            },
        },
        Key {
            name: "budget",
            takes: "time > 0",
            about: "time that `accuracy` may take, as predicted from the sizes for one thread of a [reference \
            machine](scene-results.md#the-grid-for-an-accuracy); it chooses the same grid on every machine",
            default: "`\"10 min\"`",
            read: |accuracy, entry, _| {
                let help = "it limits the time that `accuracy = \"1 %\"` may take: add that, or remove it";
                let accuracy = accuracy.as_mut().ok_or_else(|| alone(entry, help))?;
                // A waiting time has a unit in every scene.
                accuracy.target.seconds = entry.positive(Dimension::TIME, System::Si)?;
                Ok(())
            },
            print: |accuracy, _| {
                let seconds = accuracy.as_ref()?.target.seconds;
                (seconds.to_bits() != BUDGET.to_bits())
                    .then(|| printed::quantity(seconds, Dimension::TIME, System::Si))
            },
        },
        Key {
            name: "memory",
            takes: "amount in MB, GB or TB",
            about: "memory of one surface that `accuracy` may take; a machine that has less than the grid needs refuses",
            default: "`\"4 GB\"`",
            read: |accuracy, entry, _| {
                let help = "it limits the memory that `accuracy = \"1 %\"` may take: add that, or remove it";
                let accuracy = accuracy.as_mut().ok_or_else(|| alone(entry, help))?;
                accuracy.memory = read_memory(entry)?;
                Ok(())
            },
            print: |accuracy, _| {
                let bytes = accuracy.as_ref()?.memory;
                (bytes.to_bits() != MEMORY.to_bits()).then(|| print_memory(bytes))
            },
        },
    ],
};

fn alone(entry: &Entry<'_>, help: &str) -> Diagnostic {
    let message = format!("`{}` is given, but no `accuracy`", entry.name());
    entry.diagnostic_at_key(message).with_help(help)
}

fn read_share(entry: &Entry<'_>) -> ReadResult<f64> {
    let share = entry.pure_number()?;
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(entry
        .diagnostic(format!("`accuracy` = {}: expected a share above 0 and below 100 %", entry.shown()))
        .with_help("such as \"1 %\" or 0.01, or \"best\" within the `budget` and the `memory`"))
}

/// An amount of memory in bytes.
fn read_memory(entry: &Entry<'_>) -> ReadResult<f64> {
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

/// In the largest unit in which it is read as the same number.
fn print_memory(bytes: f64) -> String {
    let [(least, million), larger @ ..] = MEMORY_UNITS;
    let same = |unit: &f64| (bytes / unit) * unit;
    let found =
        larger.into_iter().rev().find(|(_, unit)| bytes >= *unit && same(unit).to_bits() == bytes.to_bits());
    let (word, unit) = found.unwrap_or((least, million));
    printed::text(&format!("{} {word}", bytes / unit))
}
