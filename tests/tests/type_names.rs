//! A name stands for one type in the whole workspace, so that a reader who meets it knows which one is meant, and a
//! search finds it at once.
//!
//! `Error` and `Result` are the exceptions: each crate has its own, as in the standard library. Types of functions and
//! of tests count; associated types do not. Definitions of one name in one file are alternatives of which a feature
//! takes one.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

const EXCEPTIONS: [&str; 2] = ["Error", "Result"];

#[derive(Default)]
struct TypeNames(Vec<String>);

impl<'ast> Visit<'ast> for TypeNames {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let name = match item {
            syn::Item::Enum(item) => Some(&item.ident),
            syn::Item::Struct(item) => Some(&item.ident),
            syn::Item::Trait(item) => Some(&item.ident),
            syn::Item::Type(item) => Some(&item.ident),
            syn::Item::Union(item) => Some(&item.ident),
            _ => None,
        };
        self.0.extend(name.map(ToString::to_string));
        visit::visit_item(self, item);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        // Arguments of a macro are no syntax tree.
        let text = call.tokens.to_string();
        let words: Vec<&str> = text.split_whitespace().collect();
        let defined = words.windows(2).filter(|pair| ["struct", "enum", "trait", "union"].contains(&pair[0]));
        let names = defined.map(|pair| pair[1].trim_matches(|c: char| !c.is_alphanumeric()));
        self.0.extend(names.filter(|name| name.starts_with(char::is_uppercase)).map(str::to_owned));
    }
}

fn names(text: &str) -> Vec<String> {
    let mut found = TypeNames::default();
    found.visit_file(&syn::parse_file(text).unwrap());
    found.0
}

/// All sources below a folder.
fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            sources(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn a_name_stands_for_one_type() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut files = Vec::new();
    for folder in ["benches", "crates", "python", "reproduction", "tests", "xtask"] {
        sources(&workspace.join(folder), &mut files);
    }
    assert!(files.len() > 500);
    let mut places: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        let place = file.strip_prefix(&workspace).unwrap().display().to_string();
        for name in names(&text) {
            places.entry(name).or_default().insert(place.clone());
        }
    }
    let twice: Vec<String> = places
        .iter()
        .filter(|(name, places)| places.len() > 1 && !EXCEPTIONS.contains(&name.as_str()))
        .map(|(name, places)| {
            let places: Vec<&str> = places.iter().map(String::as_str).collect();
            format!("{name}: {}", places.join(", "))
        })
        .collect();
    assert!(twice.is_empty(), "names of several types:\n{}", twice.join("\n"));
}

#[test]
fn types_of_functions_and_tests_are_found() {
    let text = "struct A; enum B {} trait C { type D; } type E = A; mod tests { struct F; }
                fn f() { struct G; } impl C for A { type D = u8; }
                records! { pub struct H { a: u8 } }";
    assert_eq!(names(text), ["A", "B", "C", "E", "F", "G", "H"]);
}
