//! Runs the commands of the book as a reader would.

use runs::{Error, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A fenced block of commands.
#[derive(Debug, PartialEq)]
pub struct CodeBlock {
    /// File and line.
    pub place: String,
    /// Its text.
    pub text: String,
    /// Marked `long`: not run.
    pub long: bool,
}

/// The blocks of commands of all pages of a folder, in the order of the files' names.
pub fn blocks(folder: &Path) -> Result<Vec<CodeBlock>> {
    let mut all = Vec::new();
    for path in pages(folder)? {
        let text = fs::read_to_string(&path).map_err(Error::file("read", &path))?;
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        all.extend(blocks_of(&text, &name));
    }
    Ok(all)
}

/// The Markdown files of a folder, sorted.
pub fn pages(folder: &Path) -> Result<Vec<PathBuf>> {
    let failed = || Error::file("list", folder);
    let entries = fs::read_dir(folder).map_err(failed())?.collect::<Result<Vec<_>, _>>().map_err(failed())?;
    let mut pages: Vec<PathBuf> = entries.into_iter().map(|entry| entry.path()).collect();
    pages.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.sort();
    Ok(pages)
}

fn blocks_of(text: &str, name: &str) -> Vec<CodeBlock> {
    let mut blocks = Vec::new();
    let mut lines = text.lines().enumerate();
    while let Some((number, line)) = lines.next() {
        let long = line == "```sh,long";
        if !long && line != "```sh" {
            continue;
        }
        let inside = lines.by_ref().map(|(_, line)| line).take_while(|line| *line != "```");
        let text = inside.collect::<Vec<_>>().join("\n");
        blocks.push(CodeBlock { place: format!("{name}:{}", number + 1), text, long });
    }
    blocks
}

/// Paths of this program and of `fractal-contact`, which is built in the same profile.
pub fn programs(root: &Path) -> Result<[PathBuf; 2]> {
    let own = std::env::current_exe().map_err(Error::file("find", Path::new("xtask")))?;
    let profile = if cfg!(debug_assertions) { "dev" } else { "release" };
    let mut cargo = Command::new("cargo");
    // Not by their packages, whose features alone are others than those of the workspace.
    cargo.args(["build", "--quiet", "--locked", "--profile", profile, "--bins"]);
    let status = cargo.current_dir(root).status().map_err(Error::file("run", Path::new("cargo")))?;
    if !status.success() {
        return Err(Error::content(root, "cargo build --bins failed"));
    }
    let scenes = own.with_file_name(format!("fractal-contact{}", std::env::consts::EXE_SUFFIX));
    Ok([own, scenes])
}

/// A temporary directory with `data/`, and with both programs on the path, in which the commands run as in
/// the repository. It is removed when this value is dropped.
pub struct Scratch {
    folder: tempfile::TempDir,
}

impl Scratch {
    /// With copies of the files of `data/` and a `cargo` that knows `cargo xtask` alone.
    pub fn new(root: &Path, [xtask, scenes]: &[PathBuf; 2]) -> Result<Self> {
        let folder = tempfile::tempdir().map_err(Error::file("create a folder in", &std::env::temp_dir()))?;
        let programs = folder.path().join("programs");
        let set_up = format!(
            "mkdir '{programs}'
            cp -R '{root}/data' data
            ln -s '{scenes}' '{programs}/fractal-contact'
            printf '%s\\n' '#!/bin/sh' '[ \"$1\" = xtask ] || exit 127' shift 'exec \"{xtask}\" \"$@\"' > '{programs}/cargo'
            chmod +x '{programs}/cargo'",
            programs = programs.display(),
            root = root.display(),
            scenes = scenes.display(),
            xtask = xtask.display(),
        );
        let scratch = Self { folder };
        match scratch.run(&set_up)? {
            None => Ok(scratch),
            Some(output) => Err(Error::content(scratch.folder.path(), output)),
        }
    }

    /// An empty folder in it.
    pub fn empty(&self, name: &str) -> Result<PathBuf> {
        let folder = self.folder.path().join(name);
        fs::create_dir(&folder).map_err(Error::file("create", &folder))?;
        Ok(folder)
    }

    /// Runs commands up to the first failure. Returns `None`, or the output where one failed.
    pub fn run(&self, commands: &str) -> Result<Option<String>> {
        let here = self.folder.path();
        let path = std::env::var_os("PATH").unwrap_or_default();
        let paths = std::iter::once(here.join("programs")).chain(std::env::split_paths(&path));
        let joined = std::env::join_paths(paths).map_err(|error| Error::content(here, error.to_string()))?;
        let shell = Path::new("sh");
        let mut command = Command::new(shell);
        command.args(["-euc", commands]).current_dir(here).env("PATH", joined);
        let output = command.output().map_err(Error::file("run", shell))?;
        Ok((!output.status.success()).then(|| text(&output)))
    }
}

/// Both streams of a program.
pub fn text(output: &Output) -> String {
    [&output.stdout, &output.stderr].map(|bytes| String::from_utf8_lossy(bytes).into_owned()).concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_found_by_their_fences() {
        let page = "text\n```sh\na\nb\n```\n```sh,long\nc\n```\n```text\nd\n```\n";
        let found = blocks_of(page, "p.md");
        let block =
            |place: &str, text: &str, long| CodeBlock { place: place.into(), text: text.into(), long };
        assert_eq!(found, [block("p.md:2", "a\nb", false), block("p.md:6", "c", true)]);
    }
}
