//! A model and a surface as a job, and its result as text.

use crate::scenes::error::{Error, Result};
use crate::scenes::model_on_surface::{ModelOnSurface, ModelResult};
use crate::scenes::scene_file::SceneFile;
use analysis::Value;
use contact_model::Stop;
use runs::Job;
use std::path::Path;

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

    fn key(&self) -> String {
        self.unit.key(self.scene)
    }

    fn cost(&self) -> u64 {
        self.unit.cost(self.scene)
    }

    fn solve(&self, stop: Stop<'_>) -> Result<ModelResult> {
        self.unit.solve(self.scene, self.out, stop)
    }

    fn encode(&self, result: &ModelResult) -> Option<String> {
        (result.whole && self.unit.numerics(self.scene).is_stored()).then(|| format(result))
    }

    /// A result without its files is as good as absent.
    fn decode(&self, text: &str) -> Option<ModelResult> {
        let result = parse(text, self.columns)?;
        result.files.iter().all(|f| self.out.join(f).is_file()).then_some(result)
    }
}

fn format(result: &ModelResult) -> String {
    let mut text =
        format!("seconds {:?}\nbytes {}\nfailed {}\n", result.seconds, result.bytes, result.failed);
    for row in &result.rows {
        let cells: Vec<String> = row.iter().map(cell).collect();
        text += &format!("row {}\n", cells.join("\t"));
    }
    for (state, areas) in &result.patches {
        let areas: Vec<String> = areas.iter().map(|a| format!("{a:?}")).collect();
        text += &format!("patches {state} {}\n", areas.join(" "));
    }
    for file in &result.files {
        text += &format!("file {}\n", file.display());
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

fn parse(text: &str, columns: usize) -> Option<ModelResult> {
    let mut result = ModelResult { whole: true, ..ModelResult::default() };
    for line in text.lines() {
        let (word, rest) = line.split_once(' ')?;
        match word {
            "seconds" => result.seconds = rest.parse().ok()?,
            "bytes" => result.bytes = rest.parse().ok()?,
            "failed" => result.failed = rest.parse().ok()?,
            "row" => {
                let row = rest.split('\t').map(parse_cell).collect::<Option<Vec<_>>>()?;
                (row.len() == columns).then(|| result.rows.push(row))?;
            }
            "patches" => {
                let (state, areas) = rest.split_once(' ')?;
                let areas = areas.split_whitespace().map(|a| a.parse().ok()).collect::<Option<Vec<f64>>>()?;
                result.patches.push((state.parse().ok()?, areas));
            }
            "file" => result.files.push(rest.into()),
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
        let result = ModelResult {
            seconds: 0.25,
            rows: vec![row.clone(), row],
            patches: vec![(1, vec![1e-300, 0.1]), (2, vec![])],
            files: vec!["a.npy".into()],
            bytes: 3,
            failed: 0,
            whole: true,
        };
        let text = format(&result);
        assert_eq!(parse(&text, 4), Some(result));
        assert_eq!(parse(&text, 5), None);
        assert_eq!(parse(&text.replace("n0.3", "x0.3"), 4), None);
    }
}
