//! `cargo xtask book`: the links and formulas of every Markdown file, the commands of the book, its pictures, its
//! pages and their links.
//!
//! Blocks fenced as `sh` in `book/src` are run, in a temporary directory with `data/` in it; those fenced as
//! `sh,long` take minutes or hours and are only counted. Rust blocks are doctests of the package `tests`.

mod built;
mod commands;
mod formulas;
mod links;
mod pictures;

use commands::{Scratch, programs};
use runs::{Error, Result};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

/// Checks the book, or draws its pictures again.
pub fn book(draw: bool) -> Result<ExitCode> {
    let root = root()?;
    if draw {
        let failed = pictures::store(&root, &Scratch::new(&root, &programs(&root)?)?)?;
        if let Some(output) = &failed {
            runs::out!("{output}");
        }
        return Ok(if failed.is_none() { ExitCode::SUCCESS } else { ExitCode::FAILURE });
    }
    let found = links::check(&root)?;
    found.broken.iter().for_each(|line| runs::out!("{line}"));
    runs::out!("{} links in {} files, {} broken", found.links, found.files, found.broken.len());

    let formulas = formulas::check(&root)?;
    formulas.wrong.iter().for_each(|line| runs::out!("{line}"));
    let (count, wrong) = (formulas.formulas, formulas.wrong.len());
    if formulas.set {
        runs::out!("{count} formulas checked with KaTeX, {wrong} wrong");
    } else {
        runs::out!("NOT CHECKED: {count} formulas, because node is not installed");
    }

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

    let start = Instant::now();
    let stale = pictures::check(&root, &scratch)?;
    for line in &stale {
        runs::out!("{line}");
    }
    let seconds = start.elapsed().as_secs_f64();
    runs::out!("pictures drawn anew in {seconds:.0} s, {} differ (cargo xtask book --pictures)", stale.len());

    let pages = build(&root)?;
    let whole = found.broken.is_empty() && wrong == 0 && failed == 0 && stale.is_empty() && pages;
    Ok(if whole { ExitCode::SUCCESS } else { ExitCode::from(3) })
}

fn root() -> Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    root.canonicalize().map_err(Error::file("find", &root))
}

/// Builds the pages where mdbook is installed and checks their links; `false` where it warns or fails, or a link
/// is dead.
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
    if !clean {
        runs::out!("{said}");
        return Ok(false);
    }
    let found = built::check(&root.join("book/book"))?;
    found.broken.iter().for_each(|line| runs::out!("{line}"));
    let (pages, links, broken) = (found.pages, found.links, found.broken.len());
    runs::out!("mdbook built {pages} pages into book/book, with {links} links, {broken} broken");
    Ok(found.broken.is_empty())
}
