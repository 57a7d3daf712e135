//! Checks that the files, items and commands between backticks in handwritten documents exist.

use super::sources::files;
use super::{BEGIN, END, root};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The table of crates by their readers.
pub(super) const FOR_READERS: &str = "crates/README.md";

/// Documents with names of this repository. The change log also has names that no longer exist.
pub(super) fn documents() -> Vec<PathBuf> {
    let mut found = files(&root().join("book/src"), ".md");
    found.retain(|page| !page.ends_with("SUMMARY.md"));
    found.extend(
        [
            "ARCHITECTURE.md",
            "CONTRIBUTING.md",
            "README.md",
            "GLOSSARY.md",
            FOR_READERS,
            "reproduction/README.md",
        ]
        .map(|name| root().join(name)),
    );
    found.extend(super::sources::packages().iter().map(|p| root().join(&p.folder).join("README.md")));
    found
}

/// The text between backticks outside of blocks of code and generated parts, with its line.
fn quoted(text: &str) -> Vec<(usize, String)> {
    let (mut code, mut generated) = (false, false);
    let (mut found, mut open): (_, Option<String>) = (Vec::new(), None);
    for (number, line) in text.lines().enumerate() {
        if line.trim_start().starts_with("```") {
            code = !code;
            continue;
        }
        generated = (generated || line.starts_with(BEGIN)) && !line.starts_with(END);
        if code || generated {
            continue;
        }
        // Words between backticks may go over the end of a line, not over that of a paragraph.
        for (i, part) in super::without_formulas(line).split('`').enumerate() {
            match (i, open.take()) {
                (0, Some(begun)) if !line.trim().is_empty() => open = Some(begun + " " + part.trim_start()),
                (0, _) => {}
                (_, Some(words)) => found.push((number + 1, words)),
                (_, None) => open = Some(part.to_owned()),
            }
        }
    }
    found
}

/// `a/{b,c}.rs` as `a/b.rs` and `a/c.rs`.
fn spelled_out(path: &str) -> Vec<String> {
    match path.split_once('{').and_then(|(before, rest)| Some((before, rest.split_once('}')?))) {
        Some((before, (choices, after))) => {
            choices.split(',').flat_map(|c| spelled_out(&format!("{before}{}{after}", c.trim()))).collect()
        }
        None => vec![path.to_owned()],
    }
}

/// Every file and folder, relative to the root.
fn tree() -> BTreeSet<String> {
    fn collect(folder: &Path, top: &Path, found: &mut BTreeSet<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.strip_prefix(top).unwrap().to_string_lossy().replace('\\', "/");
            if ["target", "out", ".git"].contains(&name.as_str()) {
                continue;
            }
            if path.is_dir() {
                collect(&path, top, found);
            }
            found.insert(name);
        }
    }
    let mut found = BTreeSet::new();
    collect(&root(), &root(), &mut found);
    found
}

/// Whether a name looks like a path of this repository, and not like a placeholder or a file that a program
/// writes.
fn is_path(name: &str, top: &BTreeSet<&str>) -> bool {
    let plain = name.replace(", ", ",").chars().all(|c| c.is_alphanumeric() || "_./-{},".contains(c));
    let capitals = |part: &str| part.len() > 1 && part.chars().all(|c| c.is_uppercase() || c == '_');
    let held = name
        .split(['/', '.'])
        .any(|part| capitals(part) && !["README", "NOTES", "VALUES", "SUMMARY"].contains(&part));
    let first = name.split('/').next().unwrap_or_default();
    plain
        && !held
        && (Path::new(name).extension().is_some_and(|e| e == "rs")
            || (name.contains('/') && top.contains(first)))
}

fn is_item(name: &str) -> bool {
    name.contains("::") && name.split("::").all(is_identifier)
}

/// Words of several parts, as only code has them: `HeightMap`, `height_map`.
fn is_word(name: &str) -> bool {
    let (capitals, small) = (name.matches(char::is_uppercase).count(), name.contains(char::is_lowercase));
    let snake = name.trim_matches('_').contains('_') && (capitals == 0 || !small);
    let camel = !name.contains('_') && name.starts_with(char::is_uppercase) && capitals > 1 && small;
    (snake || camel) && is_identifier(name)
}

fn is_identifier(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
    name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') && name.chars().all(plain)
}

fn words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| !(c.is_alphanumeric() || c == '_'))
}

/// `stiffness_grid_error` as `stiffness`: the quantity of a column of its error or scatter.
fn quantity_of(column: &str) -> &str {
    let endings = ["_grid_error", "_grid_order", "_se", "_sd"];
    endings.iter().find_map(|ending| column.strip_suffix(ending)).unwrap_or(column)
}

/// `check-reference` as `CheckReference`.
fn variant(command: &str) -> String {
    let capital = |part: &str| part[..1].to_uppercase() + &part[1..];
    command.split('-').filter(|part| !part.is_empty()).map(capital).collect()
}

#[test]
fn words_between_backticks_are_found() {
    let text = "`a` b `c\nd` e\n\n`f` | `g`\n```\n`no`\n```\n";
    let found: Vec<_> = quoted(text).into_iter().map(|(_, words)| words).collect();
    assert_eq!(found, ["a", "c d", "f", "g"]);
}

#[test]
fn names_in_documents_exist() {
    let tree = tree();
    let top: BTreeSet<&str> = tree.iter().map(String::as_str).filter(|name| !name.contains('/')).collect();
    let mut sources = String::new();
    for folder in ["crates", "reproduction", "xtask", "tests", "python"] {
        for file in files(&root().join(folder), ".rs") {
            let text = std::fs::read_to_string(file).unwrap();
            for line in text.lines().filter(|line| !line.trim_start().starts_with("//")) {
                sources += line;
                sources.push('\n');
            }
        }
    }
    for file in files(&root().join("python"), ".py") {
        sources += &std::fs::read_to_string(file).unwrap();
    }
    // Exceptions of Python are written so in Rust.
    sources = sources.replace("PyRuntimeError", "RuntimeError");
    sources += &tree.iter().map(String::as_str).collect::<Vec<_>>().join("\n");
    let identifiers: BTreeSet<&str> = words(&sources).collect();
    let arguments = std::fs::read_to_string(root().join("xtask/src/arguments.rs")).unwrap();
    let commands: BTreeSet<&str> = words(&arguments).collect();
    let mut wrong = Vec::new();
    for document in documents() {
        let text = std::fs::read_to_string(&document).unwrap();
        let place = document.strip_prefix(root()).unwrap().display().to_string();
        for (line, name) in quoted(&text) {
            let mut missing = |what: &str| wrong.push(format!("{place}:{line}: {what} `{name}`"));
            if is_path(&name, &top) {
                for path in spelled_out(name.trim_end_matches('/')) {
                    let ending = format!("/{path}");
                    if !tree.iter().any(|file| *file == path || file.ends_with(&ending)) {
                        missing("no file");
                    }
                }
            } else if is_item(name.trim_end_matches("()")) || is_word(name.trim_end_matches("()")) {
                let is_known =
                    |word: &str| identifiers.contains(word) || identifiers.contains(quantity_of(word));
                if !words(&name).all(is_known) {
                    missing("no item");
                }
            } else if let Some(rest) = name.strip_prefix("cargo xtask ") {
                let command = rest.split_whitespace().next().unwrap_or_default();
                let known = command.starts_with('-') || commands.contains(variant(command).as_str());
                if !known && command.chars().all(|c| c.is_lowercase() || c == '-') {
                    missing("no command");
                }
            }
        }
    }
    assert!(wrong.is_empty(), "names that are not there:\n{}", wrong.join("\n"));
}

/// Tables `file, functions` of ARCHITECTURE.md and on front pages of crates, whose files are in their `src`.
#[test]
fn functions_are_in_the_files_that_tables_name() {
    let mut checked = 0;
    let architecture = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let packages = super::sources::packages();
    let front_pages = packages.iter().map(|p| (root().join(&p.folder).join("src"), &p.front_page));
    for (folder, page) in std::iter::once((root(), &architecture)).chain(front_pages) {
        let rows = page.lines().skip_while(|line| !line.starts_with("| file | functions |"));
        for row in rows.skip(2).take_while(|line| line.starts_with('|')) {
            let cells: Vec<&str> = row.split('|').map(str::trim).collect();
            let file = folder.join(cells[1].trim_matches('`'));
            let text = std::fs::read_to_string(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
            for name in cells[2].split('`').skip(1).step_by(2) {
                let name = name.rsplit("::").next().unwrap();
                let declared = [format!("fn {name}("), format!("fn {name}<")];
                assert!(declared.iter().any(|words| text.contains(words)), "{}: no {name}", file.display());
                checked += 1;
            }
        }
    }
    assert!(checked > 0, "no table of files and functions");
}

#[test]
fn counts_in_the_readme_are_right() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    let readme = readme.split_whitespace().collect::<Vec<_>>().join(" ");
    let scenes = std::fs::read_dir(root().join("data/scenes")).unwrap();
    let scenes =
        scenes.filter(|entry| entry.as_ref().unwrap().path().extension().is_some_and(|e| e == "toml"));
    let cases = tests::stability::cases().len();
    for words in [format!("has {} scenes", scenes.count()), format!("{cases} of {cases} pass")] {
        assert!(readme.contains(&words), "README.md does not say \"{words}\"");
    }
}
