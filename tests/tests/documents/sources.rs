//! Crates, modules and constants of the workspace as their sources declare them.

use super::root;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::{Attribute, Expr, ExprLit, Item, Lit, Meta};

/// A crate of `crates/` or `reproduction/`.
pub struct Package {
    /// Name of its folder, by which the others depend on it.
    pub name: String,
    /// Its folder from the root on.
    pub folder: String,
    /// `name` of its Cargo.toml.
    pub registered: String,
    /// `description` of its Cargo.toml.
    pub description: String,
    /// Crates of these folders among its `[dependencies]`.
    pub uses: BTreeSet<String>,
    /// Text of the `//!` lines of its library.
    pub front_page: String,
    /// Modules of its library and of its program.
    pub modules: Vec<Module>,
}

/// A module that is compiled outside of tests.
pub struct Module {
    pub name: String,
    /// The first sentence of its `//!` lines, without links.
    pub sentence: String,
    pub inner: Vec<Module>,
}

/// The crates, each after those that it uses.
pub fn packages() -> Vec<Package> {
    let inside = |of: &str| std::fs::read_dir(root().join(of)).unwrap().map(|entry| entry.unwrap().path());
    let folders = inside("crates").chain(inside("reproduction"));
    let folders: Vec<PathBuf> = folders.filter(|folder| folder.join("Cargo.toml").exists()).collect();
    let name = |folder: &PathBuf| folder.file_name().unwrap().to_string_lossy().into_owned();
    let names: BTreeSet<String> = folders.iter().map(name).collect();
    let mut packages: Vec<Package> = folders.iter().map(|f| package(f, name(f), &names)).collect();
    let uses = packages.iter().map(|p| (p.name.clone(), p.uses.clone())).collect();
    packages.sort_by_key(|p| (depth(&p.name, &uses), p.name.clone()));
    packages
}

type Uses = BTreeMap<String, BTreeSet<String>>;

fn depth(name: &str, uses: &Uses) -> usize {
    uses[name].iter().map(|used| 1 + depth(used, uses)).max().unwrap_or(0)
}

/// The crates that a crate uses, directly or indirectly.
pub fn reached<'a>(package: &'a Package, all: &'a [Package]) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open = vec![package];
    while let Some(next) = open.pop() {
        for used in all.iter().filter(|other| next.uses.contains(&other.name)) {
            if found.insert(used.name.as_str()) {
                open.push(used);
            }
        }
    }
    found
}

/// The crates that a crate uses directly and through no other crate that it uses.
pub fn nearest<'a>(package: &'a Package, all: &'a [Package]) -> Vec<&'a str> {
    let used: Vec<&Package> = all.iter().filter(|other| package.uses.contains(&other.name)).collect();
    let implied = |name: &str| used.iter().any(|other| reached(other, all).contains(name));
    used.iter().map(|other| other.name.as_str()).filter(|name| !implied(name)).collect()
}

fn package(folder: &Path, name: String, names: &BTreeSet<String>) -> Package {
    let manifest = std::fs::read_to_string(folder.join("Cargo.toml")).unwrap();
    let value = |key: &str| {
        let line = manifest.lines().find_map(|line| line.strip_prefix(&format!("{key} = \"")));
        line.and_then(|line| line.strip_suffix('"')).unwrap_or_else(|| panic!("{name}: no {key}")).to_owned()
    };
    let dependencies = manifest.lines().skip_while(|line| *line != "[dependencies]").skip(1);
    let keys = dependencies
        .take_while(|line| !line.starts_with('['))
        .filter_map(|line| line.split(['.', ' ', '=']).next())
        .filter(|key| names.contains(*key))
        .map(str::to_owned);
    let source = folder.join("src");
    let programs = ["lib.rs", "main.rs"].map(|file| source.join(file));
    Package {
        registered: value("name"),
        description: value("description"),
        uses: keys.collect(),
        front_page: documentation(&parsed(&source.join("lib.rs")).attrs),
        modules: programs
            .iter()
            .filter(|file| file.exists())
            .flat_map(|file| modules(&parsed(file).items, &source))
            .collect(),
        folder: folder.strip_prefix(root()).unwrap().display().to_string(),
        name,
    }
}

fn parsed(file: &Path) -> syn::File {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()))
}

/// Modules in files of their own.
fn modules(items: &[Item], children: &Path) -> Vec<Module> {
    let mut found = Vec::new();
    for item in items {
        let Item::Mod(inner) = item else { continue };
        if inner.content.is_some() || is_test(&inner.attrs) {
            continue;
        }
        let name = inner.ident.to_string();
        let folder = children.join(&name);
        let flat = children.join(format!("{name}.rs"));
        let file = parsed(&if flat.exists() { flat } else { folder.join("mod.rs") });
        let sentence = first_sentence(&super::readmes::plain(&documentation(&file.attrs)));
        found.push(Module { name, sentence, inner: modules(&file.items, &folder) });
    }
    found
}

fn is_test(attributes: &[Attribute]) -> bool {
    let parsed = |a: &Attribute| a.parse_args::<syn::Path>().is_ok_and(|path| path.is_ident("test"));
    attributes.iter().any(|a| a.path().is_ident("cfg") && parsed(a))
}

/// The lines of doc comments, without the space behind `//!`.
fn documentation(attributes: &[Attribute]) -> String {
    let mut text = String::new();
    for attribute in attributes {
        if let Meta::NameValue(pair) = &attribute.meta
            && pair.path.is_ident("doc")
            && let Expr::Lit(ExprLit { lit: Lit::Str(line), .. }) = &pair.value
        {
            let line = line.value();
            text += line.strip_prefix(' ').unwrap_or(&line);
            text.push('\n');
        }
    }
    text
}

/// Up to a full stop outside of brackets that a capital letter or nothing follows.
fn first_sentence(text: &str) -> String {
    let paragraph: Vec<&str> = text.lines().take_while(|line| !line.trim().is_empty()).collect();
    let paragraph = paragraph.join(" ");
    let mut open = 0_i32;
    for (at, c) in paragraph.char_indices() {
        match c {
            '(' | '[' => open += 1,
            ')' | ']' => open -= 1,
            '.' if open <= 0 => {
                let mut after = paragraph[at + 1..].chars();
                let space = after.next().is_none_or(|c| c == ' ');
                if space && after.next().is_none_or(|c| c.is_uppercase() || c == '`' || c == '*') {
                    return paragraph[..=at].to_owned();
                }
            }
            _ => {}
        }
    }
    paragraph
}

/// A constant with its documentation.
pub struct DocumentedConstant {
    pub name: String,
    pub meaning: String,
    pub value: String,
}

/// Constants of a file outside of functions and tests, whose type is a number.
pub fn constants(file: &Path) -> Vec<DocumentedConstant> {
    let text = std::fs::read_to_string(file).unwrap();
    let mut meaning: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for line in text.lines().take_while(|line| *line != "mod tests {") {
        if let Some(words) = line.strip_prefix("///") {
            meaning.push(words.trim());
            continue;
        }
        let declared =
            line.split_once("const ").filter(|(before, _)| before.is_empty() || before.starts_with("pub"));
        if let Some((name, rest)) = declared.and_then(|(_, rest)| rest.split_once(": "))
            && let Some((kind, value)) = rest.trim_end_matches(';').split_once(" = ")
            && ["f64", "f32", "usize", "u32", "(f64, f64)"].contains(&kind)
        {
            let first = meaning.split(|line| line.is_empty()).next().unwrap_or_default();
            found.push(DocumentedConstant {
                name: name.into(),
                meaning: first.join(" "),
                value: value.into(),
            });
        }
        meaning.clear();
    }
    found
}

/// Members of a struct, with the values that its constant `DEFAULT` gives them.
pub fn members(file: &Path) -> Vec<DocumentedConstant> {
    let text = std::fs::read_to_string(file).unwrap();
    let values: BTreeMap<&str, &str> =
        (text.lines().skip_while(|line| !line.contains("DEFAULT: Self = Self {")).skip(1))
            .take_while(|line| line.trim() != "};")
            .filter_map(|line| line.trim().trim_end_matches(',').split_once(": "))
            .collect();
    let mut meaning: Vec<&str> = Vec::new();
    let mut found = Vec::new();
    for line in
        text.lines().skip_while(|line| !line.starts_with("pub struct ")).take_while(|line| *line != "}")
    {
        let line = line.trim();
        if let Some(words) = line.strip_prefix("/// ") {
            meaning.push(words);
        } else if let Some((name, _)) = line.strip_prefix("pub ").and_then(|line| line.split_once(": ")) {
            let value = values.get(name).unwrap_or_else(|| panic!("no value of {name}"));
            found.push(DocumentedConstant {
                name: name.into(),
                meaning: meaning.join(" "),
                value: (*value).into(),
            });
            meaning.clear();
        }
    }
    assert_eq!(found.len(), values.len());
    found
}

/// Files below a folder with this ending, sorted, without those of tests.
pub fn files(folder: &Path, ending: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && !["tests", "target", "out", ".git"].contains(&name.as_str()) {
            found.extend(files(&path, ending));
        } else if name.ends_with(ending) && name != "tests.rs" {
            found.push(path);
        }
    }
    found.sort();
    found
}

#[test]
fn a_sentence_ends_at_a_full_stop_before_a_capital() {
    let cases = [
        ("Lines (Eqs. (6) and 7). More.", "Lines (Eqs. (6) and 7)."),
        ("The curve of Fig. 4, and\nmore. Then", "The curve of Fig. 4, and more."),
        ("No stop\n\nmore.", "No stop"),
    ];
    for (text, sentence) in cases {
        assert_eq!(first_sentence(text), sentence);
    }
}
