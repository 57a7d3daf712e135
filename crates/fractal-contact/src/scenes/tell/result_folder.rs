//! Ownership of the files in a directory of results: the files that its manifest lists belong to the program.

use crate::scenes::read::{Result, SceneFile};
use crate::scenes::run::field_of_file;
use crate::scenes::tell::{cycles, distributions, law, pictures, statistics, thresholds};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Component, Path, PathBuf};

/// Largest size of a manifest that is read, in bytes.
const LARGEST_MANIFEST: u64 = 1 << 28;

/// A directory that a run may write into.
pub(crate) struct ResultFolder {
    directory: PathBuf,
    /// Names of files that earlier runs wrote.
    owned: BTreeSet<String>,
}

impl ResultFolder {
    /// Reads the manifest of earlier runs.
    ///
    /// # Errors
    /// The name of a file that this run would overwrite and no run of a scene wrote; a directory that cannot
    /// be read.
    pub fn claim(directory: &Path, scene: &SceneFile) -> Result<Self> {
        let entries =
            std::fs::read_dir(directory).map_err(runs::Error::file("read the directory", directory))?;
        let entries: Vec<String> =
            entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok()).collect();
        // After the directory: another shard writes its manifest before its fields.
        let listed = Manifest::read(directory);
        let mut owned = listed.files;
        for entry in entries {
            if owned.contains(&entry) {
                continue;
            }
            if listed.interrupted && field_of_file(&entry).is_some() {
                owned.insert(entry);
            } else if may_write(scene, &entry) {
                let reason = "no run of a scene wrote this file, and its results would replace it: move it away, \
                              or choose another directory for the results";
                return Err(runs::Error::content(&directory.join(entry), reason).into());
            }
        }
        Ok(Self { directory: directory.to_owned(), owned })
    }

    /// The files that earlier runs wrote and those, but for fields, that a run of this scene may write.
    pub fn files(&self, scene: &SceneFile) -> BTreeSet<String> {
        let mut files = self.owned.clone();
        files.extend(
            [
                "results.csv",
                "ensemble.csv",
                "patches.csv",
                cycles::FILE,
                law::FILE,
                thresholds::FILE,
                "report.html",
                "manifest.json",
            ]
            .map(str::to_owned),
        );
        files.extend(pictures::curve_files(scene));
        files.extend(distributions::files(scene));
        files.extend(statistics::FILES.map(str::to_owned));
        files.retain(|name| self.owned.contains(name) || may_write(scene, name));
        files
    }

    /// Removes the files of earlier runs that are not among `files`, and returns their number.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub fn remove_others(&self, files: &[PathBuf]) -> Result<usize> {
        let mut removed = 0;
        let written: BTreeSet<&Path> = files.iter().map(PathBuf::as_path).collect();
        for path in self.owned.iter().map(|name| self.directory.join(name)) {
            if !written.contains(&*path) && path.symlink_metadata().is_ok_and(|m| !m.is_dir()) {
                std::fs::remove_file(&path).map_err(runs::Error::file("remove", &path))?;
                removed += 1;
            }
        }
        Ok(removed)
    }
}

/// The files of a run according to its manifest.
#[derive(Debug, Default, PartialEq)]
struct Manifest {
    /// Their names; names that point outside of the directory are ignored.
    files: BTreeSet<String>,
    /// Whether the run was interrupted: there may then be fields that it does not list.
    interrupted: bool,
}

impl Manifest {
    fn read(directory: &Path) -> Self {
        let path = directory.join("manifest.json");
        let text = runs::files::read(&path, LARGEST_MANIFEST).unwrap_or_default();
        let manifest: Value = serde_json::from_slice(&text).unwrap_or_default();
        if manifest["project"] != "fractal-contact" || !manifest["scene"].is_string() {
            return Self::default();
        }
        let plain = |name: &&str| {
            matches!(Path::new(name).components().collect::<Vec<_>>()[..], [Component::Normal(_)])
        };
        let files = manifest["files"].as_array().into_iter().flatten();
        let mut files: BTreeSet<String> =
            files.filter_map(Value::as_str).filter(plain).map(str::to_owned).collect();
        files.insert("manifest.json".to_owned());
        Self { files, interrupted: manifest["complete"] == false }
    }
}

/// Whether a scene may write a file of this name.
fn may_write(scene: &SceneFile, name: &str) -> bool {
    let requested = &scene.requested;
    match name {
        "results.csv" | "report.html" | "manifest.json" => true,
        _ if statistics::FILES.contains(&name) => requested.statistics,
        "patches.csv" => requested.outputs.contact_patches,
        cycles::FILE => cycles::are_counted(scene),
        law::FILE => requested.law,
        thresholds::FILE => thresholds::are_told(scene),
        "ensemble.csv" => scene.sampling.surfaces > 1,
        _ if distributions::files(scene).iter().any(|file| file == name) => true,
        _ if requested.curves && pictures::curve_files(scene).iter().any(|file| file == name) => true,
        _ => field_of_file(name).is_some_and(|file| {
            requested.fields().any(|(field, formats)| {
                field.name == file.field && formats.iter().any(|format| format.extension() == file.extension)
            }) && scene.models.iter().any(|model| model.name() == file.model)
                && file.surface < scene.sampling.surfaces
                && file.state < scene.request.count()
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_names_in_the_manifest_of_a_scene_are_owned() {
        let dir = tempfile::tempdir().unwrap();
        let manifest = |text: &str| std::fs::write(dir.path().join("manifest.json"), text).unwrap();
        assert_eq!(Manifest::read(dir.path()), Manifest::default());
        for nobodys in [
            "",
            "{",
            "[]",
            r#"{"project": "fractal-contact", "files": ["a"]}"#,
            r#"{"scene": "", "files": ["a"]}"#,
        ] {
            manifest(nobodys);
            assert_eq!(Manifest::read(dir.path()), Manifest::default(), "{nobodys}");
        }
        manifest(
            r#"{"project": "fractal-contact", "scene": "", "files": ["a", "../b", "/c", ".", "", "d/e", 3]}"#,
        );
        let files = ["a", "manifest.json"].map(str::to_owned).into();
        assert_eq!(Manifest::read(dir.path()), Manifest { files, interrupted: false });
    }
}
