//! A model and a surface as a job, and its result as text.

use crate::scenes::calibration;
use crate::scenes::distributed::{Bin, Distributed};
use crate::scenes::error::{Error, Result};
use crate::scenes::model_on_surface::ModelOnSurface;
use crate::scenes::scene_file::SceneFile;
use crate::scenes::state_result::{ModelResult, StateResult, StoredFile};
use analysis::Value;
use contact_model::Stop;
use runs::{Job, ResultKind};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error as _};
use std::path::Path;
use std::time::{Duration, Instant};

/// What is solved is kept at most so often: an interruption loses what is younger, and the state in hand.
const KEEP_EVERY: Duration = Duration::from_secs(1);

/// A unit with what all units of a run share.
pub(crate) struct SceneJob<'a> {
    pub unit: ModelOnSurface,
    pub scene: &'a SceneFile,
    /// Directory of the results.
    pub out: &'a Path,
    /// Number of columns of a row.
    pub columns: usize,
}

impl Job for SceneJob<'_> {
    type Output = ModelResult;
    type Error = Error;

    const KIND: ResultKind = ResultKind::new("scene", 1);

    fn key(&self) -> String {
        self.unit.key(self.scene)
    }

    fn name(&self) -> String {
        format!("{}, surface {}", self.unit.numerics(self.scene).name(), self.unit.surface)
    }

    fn cost(&self) -> u64 {
        self.unit.cost(self.scene)
    }

    fn memory(&self) -> f64 {
        calibration::least_memory(self.scene, self.unit.numerics(self.scene))
    }

    fn stored_bytes(&self) -> u64 {
        self.unit.stored_bytes(self.scene, self.columns)
    }

    fn is_stored(&self) -> bool {
        self.unit.numerics(self.scene).is_stored()
    }

    fn solve(&self, stop: Stop<'_>) -> Result<ModelResult> {
        self.resume(None, &|_| Ok(()), stop)
    }

    fn resume(
        &self,
        stored: Option<ModelResult>,
        store: &dyn Fn(&ModelResult) -> runs::Result<()>,
        stop: Stop<'_>,
    ) -> Result<ModelResult> {
        let mut begun = stored.unwrap_or_default();
        begun.states.retain(|state| self.has_whole(state));
        begun.kept = begun.states.len();
        let mut last = Instant::now();
        let mut keep = |result: &ModelResult| {
            if last.elapsed() >= KEEP_EVERY && self.is_stored() {
                store(result)?;
                last = Instant::now();
            }
            Ok(())
        };
        self.unit.solve(self.scene, self.out, begun, &mut keep, stop)
    }

    /// A result with a state or a file missing or changed is as good as absent.
    fn is_whole(&self, result: &ModelResult) -> bool {
        result.complete && result.states.iter().all(|state| self.has_whole(state))
    }
}

impl SceneJob<'_> {
    /// Whether a stored state has all columns, and its files are what they were.
    fn has_whole(&self, state: &StateResult) -> bool {
        state.row.len() == self.columns && state.is_whole(self.out)
    }
}

impl Serialize for ModelResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        serializer.serialize_str(&format(self))
    }
}

impl<'de> Deserialize<'de> for ModelResult {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> std::result::Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        let result = parse(&text).ok_or_else(|| D::Error::custom("not the states of a model"))?;
        Ok(Self { kept: result.states.len(), ..result })
    }
}

fn format(result: &ModelResult) -> String {
    let mut text = format!("complete {}\nseconds {:?}\n", result.complete, result.seconds);
    for state in &result.states {
        let cells: Vec<String> = state.row.iter().map(cell).collect();
        text += &format!("state {} {}\nrow {}\n", state.index, state.failed, cells.join("\t"));
        if !state.patches.is_empty() {
            let areas: Vec<String> = state.patches.iter().map(|a| format!("{a:?}")).collect();
            text += &format!("patches {}\n", areas.join(" "));
        }
        for (of, bins) in &state.distributions {
            let bins: Vec<String> = bins.iter().map(|[a, b, d]| format!("{a:?},{b:?},{d:?}")).collect();
            text += &format!("distribution {} {}\n", of.name(), bins.join(" "));
        }
        for StoredFile { name, bytes, digest } in &state.files {
            text += &format!("file {digest:032x} {bytes} {name}\n");
        }
    }
    text
}

fn cell(value: &Value) -> String {
    match value {
        Value::Text(t) => format!("t{}", t.replace(['\t', '\n', '\r'], " ")),
        Value::Number(v) => format!("n{v:?}"),
        Value::Count(n) => format!("c{n}"),
        Value::Flag(b) => format!("b{b}"),
        Value::Empty => String::new(),
    }
}

fn parse_cell(text: &str) -> Option<Value> {
    let Some(kind) = text.chars().next() else { return Some(Value::Empty) };
    let rest = &text[kind.len_utf8()..];
    Some(match kind {
        't' => Value::Text(rest.to_owned()),
        'n' => Value::Number(rest.parse().ok()?),
        'c' => Value::Count(rest.parse().ok()?),
        'b' => Value::Flag(rest.parse().ok()?),
        _ => return None,
    })
}

fn parse(text: &str) -> Option<ModelResult> {
    let mut result = ModelResult::default();
    for line in text.lines() {
        let (word, rest) = line.split_once(' ')?;
        match (word, result.states.last_mut()) {
            ("complete", None) => result.complete = rest.parse().ok()?,
            ("seconds", None) => result.seconds = rest.parse().ok()?,
            ("state", _) => {
                let (index, failed) = rest.split_once(' ')?;
                let (index, failed) = (index.parse().ok()?, failed.parse().ok()?);
                result.states.push(StateResult { index, failed, ..StateResult::default() });
            }
            ("row", Some(state)) => {
                state.row = rest.split('\t').map(parse_cell).collect::<Option<Vec<_>>>()?;
            }
            ("patches", Some(state)) => {
                state.patches = rest.split(' ').map(|a| a.parse().ok()).collect::<Option<Vec<f64>>>()?;
            }
            ("distribution", Some(state)) => {
                let (name, bins) = rest.split_once(' ')?;
                let (_, of) = Distributed::ALL.into_iter().find(|(known, _)| *known == name)?;
                let bin = |text: &str| -> Option<Bin> {
                    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.parse().ok()).collect();
                    numbers?.try_into().ok()
                };
                let bins: Option<Vec<Bin>> = bins.split(' ').filter(|bin| !bin.is_empty()).map(bin).collect();
                state.distributions.push((of, bins?));
            }
            ("file", Some(state)) => {
                let mut words = rest.splitn(3, ' ');
                let digest = u128::from_str_radix(words.next()?, 16).ok()?;
                let (bytes, name) = (words.next()?.parse().ok()?, words.next()?.to_owned());
                state.files.push(StoredFile { name, bytes, digest });
            }
            _ => return None,
        }
    }
    Some(result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_back_bit_for_bit() {
        let row = vec![Value::Text("a b".into()), Value::Number(1.0 / 3.0), Value::Count(7), Value::Empty];
        let file = StoredFile { name: "a b.npy".into(), bytes: 3, digest: 7 };
        let first = StateResult { row: row.clone(), patches: vec![1e-300, 0.1], ..StateResult::default() };
        let distributions = vec![
            (Distributed::Gap, vec![[0.0, 0.1, 1e-300], [0.1, 0.2, 3.0]]),
            (Distributed::Pressure, vec![]),
        ];
        let first = StateResult { distributions, ..first };
        let second = StateResult { index: 2, failed: true, row, files: vec![file], ..StateResult::default() };
        let result = ModelResult {
            seconds: 0.25,
            states: vec![first, second],
            complete: false,
            ..ModelResult::default()
        };
        let text = format(&result);
        assert_eq!(parse(&text), Some(result));
        assert_eq!(parse(&text.replace("n0.3", "x0.3")), None);
        assert_eq!(parse("row \n"), None);
    }
}
