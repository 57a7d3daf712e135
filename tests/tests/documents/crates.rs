//! The lists of crates and modules with their purposes, and the direction of their dependencies.

use super::sources::{Module, nearest, packages, reached};
use super::{root, table};

/// Crates, each after those that it uses.
pub fn crates() -> String {
    let all = packages();
    let cells = |package| {
        let uses: Vec<String> = nearest(package, &all).iter().map(|name| format!("`{name}`")).collect();
        vec![format!("`{}`", package.name), package.description.clone(), uses.join(", ")]
    };
    table(&["crate", "what it is", "uses"], all.iter().map(cells))
}

/// The page of the book about all modules.
pub fn modules_page() -> String {
    let mut text = String::from(
        "# Crates and modules\n\n\
         Where is a piece of the code? This page lists every crate of `crates/` and `reproduction/`, each after those\n\
         that it uses, with its modules and the first sentence of each. It is written from the sources, and a test\n\
         compares it with them. \
         [ARCHITECTURE.md](../..) has the rules that hold between crates.\n",
    );
    for package in packages() {
        let description = wrapped(&package.description, "");
        text.push_str(&["\n## ", &package.name, "\n\n", &description, "\n\n"].concat());
        list(&package.modules, 0, &mut text);
    }
    text
}

fn list(modules: &[Module], depth: usize, text: &mut String) {
    for module in modules {
        let begin = "  ".repeat(depth);
        let item = [&begin, "- `", &module.name, "`: ", &module.sentence].concat();
        text.push_str(&(wrapped(&item, &(begin + "  ")) + "\n"));
        list(&module.inner, depth + 1, text);
    }
}

/// A paragraph, or an item of a list, within 110 columns; later lines begin with `margin`.
fn wrapped(item: &str, margin: &str) -> String {
    const COLUMNS: usize = 110;
    let words = item.trim_start().split(' ');
    let mut lines = vec![item[..item.len() - item.trim_start().len()].to_owned()];
    for (i, word) in words.enumerate() {
        let last = lines.last_mut().unwrap();
        if last.chars().count() + 1 + word.chars().count() > COLUMNS {
            lines.push([margin, word].concat());
        } else {
            last.push_str(if i == 0 { "" } else { " " });
            last.push_str(word);
        }
    }
    lines.join("\n")
}

#[test]
fn ci_lists_the_existing_dependencies() {
    let gate = std::fs::read_to_string(root().join(".ci/run")).unwrap();
    let all = packages();
    let mut listed = 0;
    for line in gate.lines().filter_map(|line| line.strip_prefix("arrows ")) {
        let mut names = line.split_whitespace();
        let name = names.next().unwrap();
        let package =
            all.iter().find(|package| package.name == name).unwrap_or_else(|| panic!("no crate {name}"));
        assert_eq!(names.collect::<std::collections::BTreeSet<_>>(), reached(package, &all), "{name}");
        listed += 1;
    }
    assert_eq!(listed, all.len(), "crates that .ci/run lists");
}

#[test]
fn the_table_by_readers_has_every_crate() {
    let text = std::fs::read_to_string(root().join(super::names::FOR_READERS)).unwrap();
    for package in packages().iter().filter(|package| package.folder.starts_with("crates/")) {
        let link = format!("({}/README.md)", package.name);
        assert!(text.contains(&link), "{} has no {}", super::names::FOR_READERS, package.name);
    }
}

#[test]
fn models_are_used_together_only_where_the_architecture_says() {
    let all = packages();
    let models = |package| {
        let reached = reached(package, &all);
        ["bem3d", "mdr1d", "analytic"].iter().filter(|model| reached.contains(*model)).count()
    };
    let meet = all.iter().filter(|package| models(package) > 1).map(|package| format!("`{}`", package.name));
    let mut meet: Vec<_> = meet.collect();
    meet.sort();
    let sentence = format!("meet in {} and `tests` only", meet.join(", "));
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(text.contains(&sentence), "ARCHITECTURE.md does not say \"{sentence}\"");
}

#[test]
fn every_module_says_what_it_is() {
    fn silent(modules: &[Module], place: &str, found: &mut Vec<String>) {
        for module in modules {
            let place = format!("{place}::{}", module.name);
            if module.sentence.is_empty() {
                found.push(place.clone());
            }
            silent(&module.inner, &place, found);
        }
    }
    let mut found = Vec::new();
    for package in packages() {
        silent(&package.modules, &package.name, &mut found);
    }
    assert!(found.is_empty(), "modules that begin without `//!`: {found:?}");
}
