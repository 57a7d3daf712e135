//! What is kept of a model's states, and the names of their files.

use crate::scenes::read::distributed::{Bin, Distributed};
use crate::scenes::read::error::Result;
use analysis::Value;
use runs::fnv1a_128;
use std::fmt;
use std::path::Path;

/// What one model gave on one surface.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct ModelResult {
    /// Of all runs that had a part in it.
    pub seconds: f64,
    /// States in the order of the loads.
    pub states: Vec<StateResult>,
    /// Whether nothing is left to be solved.
    pub complete: bool,
    /// How many states an earlier run had kept.
    pub kept: usize,
}

/// One state as it is kept.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct StateResult {
    /// Number of the load or step.
    pub index: usize,
    /// Whether it was refused or missed its tolerance.
    pub failed: bool,
    /// The row of the table.
    pub row: Vec<Value>,
    /// Areas of the connected contacts.
    pub patches: Vec<f64>,
    /// Distributions.
    pub distributions: Vec<(Distributed, Vec<Bin>)>,
    /// Files of fields.
    pub files: Vec<StoredFile>,
}

/// A file that belongs to a state.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct StoredFile {
    /// Relative to the directory of the results.
    pub name: String,
    pub bytes: u64,
    /// [`fnv1a_128`] of its bytes.
    pub digest: u128,
}

impl StoredFile {
    /// Of a file as it is.
    pub fn of(out: &Path, name: String) -> Result<Self> {
        let path = out.join(&name);
        let content = runs::files::read(&path, u64::MAX)?;
        Ok(Self { name, bytes: content.len() as u64, digest: fnv1a_128(&content) })
    }

    /// Whether the file is still what it was.
    pub fn is_whole(&self, out: &Path) -> bool {
        Self::of(out, self.name.clone()).is_ok_and(|found| found == *self)
    }
}

impl StateResult {
    /// Whether all its files are still what they were.
    pub fn is_whole(&self, out: &Path) -> bool {
        self.files.iter().all(|file| file.is_whole(out))
    }
}

/// What the name of a field's file says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FieldFile<'a> {
    pub field: &'a str,
    pub model: &'a str,
    pub surface: usize,
    pub state: usize,
    pub extension: &'a str,
}

impl fmt::Display for FieldFile<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-{}-{}-{:03}.{}", self.field, self.model, self.surface, self.state, self.extension)
    }
}

/// Reads the name of a field's file; `None` for other names.
pub(crate) fn field_of_file(name: &str) -> Option<FieldFile<'_>> {
    let (field, rest) = name.split_once('-')?;
    let (rest, last) = rest.rsplit_once('-')?;
    let (state, extension) = last.split_once('.')?;
    let (model, surface) = rest.rsplit_once('-')?;
    let file =
        FieldFile { field, model, surface: surface.parse().ok()?, state: state.parse().ok()?, extension };
    (["pressure", "displacement", "gap", "plastic_depth", "heights"].contains(&field)
        && file.to_string() == name)
        .then_some(file)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_files_say_what_they_hold() {
        let file = FieldFile { field: "gap", model: "bem3d", surface: 3, state: 1234, extension: "npy" };
        assert_eq!(file.to_string(), "gap-bem3d-3-1234.npy");
        assert_eq!(field_of_file("gap-bem3d-3-1234.npy"), Some(file));
        assert_eq!(field_of_file("gap-bem3d-3-1234.pixels.png").map(|f| f.extension), Some("pixels.png"));
        for other in [
            "gap-bem3d-3-12.npy",
            "height-bem3d-3-012.npy",
            "gap-bem3d-012.npy",
            "gap.npy",
            "results.csv",
            "",
        ] {
            assert_eq!(field_of_file(other), None, "{other}");
        }
    }
}
