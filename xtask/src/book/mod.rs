//! `cargo xtask book`: the links of every Markdown file, the commands of the book, its pictures, its pages.
//!
//! Blocks fenced as `sh` in `book/src` are run, in a temporary directory with `data/` in it; those fenced as
//! `sh,long` take minutes or hours and are only counted. Rust blocks are doctests of the package `tests`.

mod commands;
mod links;

use commands::{Scratch, programs};
use runs::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Checks the book, or makes its pictures again.
pub fn book(pictures: bool) -> Result<ExitCode> {
    let root = root()?;
    if pictures {
        return make_pictures(&root);
    }
    let found = links::check(&root)?;
    found.broken.iter().for_each(|line| runs::out!("{line}"));
    runs::out!("{} links in {} files, {} broken", found.links, found.files, found.broken.len());

    let blocks = commands::blocks(&root.join("book/src"))?;
    let long = blocks.iter().filter(|block| block.long).count();
    let scratch = Scratch::new(&root, &programs(&root)?)?;
    let start = Instant::now();
    let mut failed = 0;
    for block in blocks.iter().filter(|block| !block.long) {
        let begun = Instant::now();
        let done = scratch.run(&block.text)?;
        runs::out!("{:>6.1} s  {}", begun.elapsed().as_secs_f64(), block.place);
        if let Some(output) = done {
            failed += 1;
            runs::out!("{}\n{output}", block.text);
        }
    }
    let run = blocks.len() - long;
    runs::out!(
        "{run} blocks of commands run in {:.0} s, {failed} failed; {long} long ones not run",
        start.elapsed().as_secs_f64()
    );

    let pages = build(&root)?;
    let whole = found.broken.is_empty() && failed == 0 && pages;
    Ok(if whole { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

fn root() -> Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().map_err(Error::file("find", &root))
}

/// Runs `book/pictures.sh`, which writes into `book/src/pictures`.
fn make_pictures(root: &Path) -> Result<ExitCode> {
    let script = root.join("book/pictures.sh");
    let text = std::fs::read_to_string(&script).map_err(Error::file("read", &script))?;
    let scratch = Scratch::new(root, &programs(root)?)?;
    let folder = root.join("book/src/pictures");
    let failed = scratch.run(&format!("pictures='{}'\n{text}", folder.display()))?;
    if let Some(output) = &failed {
        runs::out!("{output}");
    }
    Ok(if failed.is_none() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Builds the pages where mdbook is installed; `false` where it warns or fails.
fn build(root: &Path) -> Result<bool> {
    let program = Path::new("mdbook");
    let output = match Command::new(program).arg("build").arg(root.join("book")).output() {
        Ok(output) => output,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            runs::out!("mdbook is not installed: pages not built (cargo install mdbook --locked)");
            return Ok(true);
        }
        Err(source) => return Err(Error::file("run", program)(source)),
    };
    let said = commands::text(&output);
    let clean = output.status.success() && !said.contains("WARN") && !said.contains("ERROR");
    runs::out!("{}", if clean { "mdbook built the pages into book/book".to_owned() } else { said });
    Ok(clean)
}
