//! Finished units on disk: `DIR/.units/<hash>.txt`, written whole, checked on reading.

use crate::error::Result;
use crate::scene_file::SceneFile;
use crate::unit::{Unit, UnitResult};
use analysis::Value;
use figures::{clean, create_directory, fnv1a_128, write_whole};
use std::path::{Path, PathBuf};

/// Where finished units are kept.
#[derive(Debug)]
pub(crate) struct Store {
    out: PathBuf,
    fresh: bool,
}

impl Store {
    /// Opens (and creates) `out` and `out/.units`. With `fresh` nothing stored is read.
    pub fn open(out: &Path, fresh: bool) -> Result<Self> {
        let units = out.join(".units");
        create_directory(&units)?;
        clean(out)?;
        clean(&units)?;
        Ok(Self { out: out.to_owned(), fresh })
    }

    fn path(&self, key: &str) -> PathBuf {
        self.out.join(".units").join(format!("{:032x}.txt", fnv1a_128(key.as_bytes())))
    }

    /// The stored result of this very unit; damaged, foreign or without its files it is as good as absent.
    pub fn load(&self, unit: &Unit, scene: &SceneFile, columns: usize) -> Option<UnitResult> {
        if self.fresh || !unit.numerics(scene).is_stored() {
            return None;
        }
        let key = unit.key(scene);
        let result = parse(&std::fs::read_to_string(self.path(&key)).ok()?, &key, columns)?;
        result.files.iter().all(|f| self.out.join(f).is_file()).then_some(result)
    }

    pub fn save(&self, unit: &Unit, scene: &SceneFile, result: &UnitResult) -> Result<()> {
        if !unit.numerics(scene).is_stored() {
            return Ok(());
        }
        let key = unit.key(scene);
        Ok(write_whole(&self.path(&key), format(&key, result).as_bytes())?)
    }
}

fn head(key: &str) -> String {
    let key: String = key.lines().map(|line| format!("# {line}\n")).collect();
    format!("# fractal-contact: one model and one surface of a scene\n{key}")
}

fn format(key: &str, result: &UnitResult) -> String {
    let mut text = head(key);
    text += &format!("seconds {:?}\nbytes {}\nfailed {}\n", result.seconds, result.bytes, result.failed);
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
    let digest = fnv1a_128(text.as_bytes());
    text + &format!("whole {digest:032x}\n")
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

/// `None` unless the text is whole and belongs to this key.
fn parse(text: &str, key: &str, columns: usize) -> Option<UnitResult> {
    let (body, digest) = text.split_at(text.rfind("whole ")?);
    let digest = u128::from_str_radix(digest.strip_prefix("whole ")?.trim_end(), 16).ok()?;
    if digest != fnv1a_128(body.as_bytes()) {
        return None;
    }
    let mut result = UnitResult { whole: true, ..UnitResult::default() };
    for line in body.strip_prefix(&head(key))?.lines() {
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
    fn results_come_back_bit_for_bit_and_damaged_ones_do_not() {
        let row = vec![Value::Text("a b".into()), Value::Number(1.0 / 3.0), Value::Count(7), Value::Empty];
        let result = UnitResult {
            seconds: 0.25,
            rows: vec![row.clone(), row],
            patches: vec![(1, vec![1e-300, 0.1]), (2, vec![])],
            files: vec!["a.npy".into()],
            bytes: 3,
            failed: 0,
            whole: true,
        };
        let text = format("k 1\nl", &result);
        assert_eq!(parse(&text, "k 1\nl", 4), Some(result));
        assert_eq!(parse(&text, "k 2\nl", 4), None);
        assert_eq!(parse(&text, "k 1\nl", 5), None);
        assert_eq!(parse(&text.replace("0.25", "0.26"), "k 1\nl", 4), None);
        for cut in 0..text.len() - 1 {
            assert_eq!(parse(&text[..cut], "k 1\nl", 4), None);
        }
    }
}
