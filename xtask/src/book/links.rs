//! Checks the links of every Markdown file of the repository: both file and heading have to exist.

use super::commands::pages;
use runs::{Error, Result};
use std::collections::HashMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Folders that hold nothing written by hand.
const LEFT_OUT: [&str; 4] = ["target", "out", ".git", "book/book"];

/// The result of a check.
pub struct LinkCheck {
    /// Files read.
    pub files: usize,
    /// Links within the repository, includes and pictures among them.
    pub links: usize,
    /// `file:line: what is wrong`.
    pub broken: Vec<String>,
}

/// Checks all files below a root.
pub fn check(root: &Path) -> Result<LinkCheck> {
    let texts = markdown(root)?.into_iter().map(|path| {
        let text = fs::read_to_string(&path).map_err(Error::file("read", &path))?;
        Ok((path, text))
    });
    let texts: HashMap<PathBuf, String> = texts.collect::<Result<_>>()?;
    let mut found = LinkCheck { files: texts.len(), links: 0, broken: Vec::new() };
    for (path, text) in &texts {
        let name = path.strip_prefix(root).unwrap_or(path).display();
        for (line, link) in links(text) {
            found.links += 1;
            if let Some(wrong) = wrong(path, &link, &texts) {
                found.broken.push(format!("{name}:{line}: {link}: {wrong}"));
            }
        }
    }
    found.broken.extend(outside_the_book(root)?);
    found.broken.sort();
    Ok(found)
}

/// All Markdown files below a root that are written by hand, sorted.
pub fn markdown(root: &Path) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    collect(root, root, &mut files)?;
    files.sort();
    Ok(files)
}

fn collect(root: &Path, folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    files.extend(pages(folder)?);
    for entry in fs::read_dir(folder).map_err(Error::file("list", folder))? {
        let path = entry.map_err(Error::file("list", folder))?.path();
        let left_out = path.strip_prefix(root).is_ok_and(|p| LEFT_OUT.iter().any(|out| p == Path::new(out)));
        if path.is_dir() && !path.is_symlink() && !left_out {
            collect(root, &path, files)?;
        }
    }
    Ok(())
}

/// Pages that the summary does not name, and pages with Rust that the package `tests` does not compile.
fn outside_the_book(root: &Path) -> Result<Vec<String>> {
    let source = root.join("book/src");
    let read = |path: PathBuf| fs::read_to_string(&path).map_err(Error::file("read", &path));
    let (summary, tests) = (read(source.join("SUMMARY.md"))?, read(root.join("tests/src/lib.rs"))?);
    let mut wrong = Vec::new();
    for page in pages(&source)? {
        let name = page.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if name != "SUMMARY.md" && !summary.contains(&format!("({name})")) {
            wrong.push(format!("book/src/{name}: not in SUMMARY.md"));
        }
        let text = read(page)?;
        for (line, link) in links(&text) {
            // Pages turn `x.md` into `x.html`, which is not there; a folder shows its README.
            let file = Path::new(link.split('#').next().unwrap_or_default());
            let markdown = file.extension().is_some_and(|extension| extension == "md");
            let included = text.contains(&format!("include {}", file.display()));
            if file.starts_with("..") && markdown && !included {
                wrong.push(format!("book/src/{name}:{line}: {link}: link to its folder instead"));
            }
        }
        let rust = text.lines().any(|line| line.starts_with("```rust"));
        if rust && !tests.contains(&format!("book/src/{name}")) {
            wrong.push(format!("book/src/{name}: its Rust is not compiled (tests/src/lib.rs)"));
        }
    }
    Ok(wrong)
}

/// The destinations of the links of a text with their lines, without those to other sites.
fn links(text: &str) -> Vec<(usize, String)> {
    let mut links = Vec::new();
    for (number, line) in prose(text) {
        for after in line.split("](").skip(1) {
            links.push((number, after.split([')', ' ']).next().unwrap_or_default().to_owned()));
        }
        for after in line.split(" src=\"").skip(1) {
            links.push((number, after.split('"').next().unwrap_or_default().to_owned()));
        }
    }
    for (number, line) in text.lines().enumerate() {
        if let Some(after) = line.split("{{#include ").nth(1) {
            let path = after.split("}}").next().unwrap_or_default();
            links.push((number + 1, path.split(':').next().unwrap_or_default().to_owned()));
        }
    }
    links.retain(|(_, link)| !link.contains("://") && !link.starts_with("mailto:"));
    links
}

/// Numbered lines outside fenced blocks, without what stands between backticks.
fn prose(text: &str) -> Vec<(usize, String)> {
    let mut fenced = false;
    let mut lines = Vec::new();
    for (number, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced {
            lines.push((number + 1, line.split('`').step_by(2).collect()));
        }
    }
    lines
}

/// The fault of a link of a file.
fn wrong(file: &Path, link: &str, texts: &HashMap<PathBuf, String>) -> Option<String> {
    let (path, anchor) = link.split_once('#').map_or((link, None), |(path, anchor)| (path, Some(anchor)));
    let target = if path.is_empty() {
        file.to_owned()
    } else {
        let Ok(target) = file.with_file_name("").join(path).canonicalize() else {
            return Some("no such file".into());
        };
        target
    };
    let anchor = anchor?;
    let Some(text) = texts.get(&target) else {
        return Some("an anchor in a file that is no Markdown".into());
    };
    let headings = anchors(text);
    (!headings.iter().any(|heading| heading == anchor)).then(|| format!("no heading #{anchor}"))
}

/// The anchors of the headings of a text, as mdBook and the usual forges make them.
fn anchors(text: &str) -> Vec<String> {
    let mut fenced = false;
    let mut seen: HashMap<String, usize> = HashMap::new();
    let mut anchors = Vec::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        }
        if fenced || !line.starts_with('#') {
            continue;
        }
        let words = line.trim_start_matches('#').trim().to_lowercase();
        let kept = words.chars().filter(|c| c.is_alphanumeric() || "-_ ".contains(*c));
        let name: String = kept.map(|c| if c == ' ' { '-' } else { c }).collect();
        let count = seen.entry(name.clone()).or_default();
        anchors.push(if *count == 0 { name } else { format!("{name}-{count}") });
        *count += 1;
    }
    anchors
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_in_code_and_to_other_sites_are_left_out() {
        let text =
            "[a](b.md#c) `[no](x)` ![p](q.png)\n```\n[no](y)\n```\n[s](https://e.org)\n{{#include z.toml}}";
        let found = links(text);
        assert_eq!(found, [(1, "b.md#c".into()), (1, "q.png".into()), (6, "z.toml".into())]);
    }

    #[test]
    fn anchors_are_words_with_hyphens() {
        let text = "# What it costs\n## D_f, k_bar and E*\n```\n# a comment\n```\n## What it costs";
        assert_eq!(anchors(text), ["what-it-costs", "d_f-k_bar-and-e", "what-it-costs-1"]);
    }
}
