//! Dependencies between the modules of each crate have no cycles: no module uses an item of a module that
//! depends on it.
//!
//! A use is a path to an item that another module defines, re-exports followed to the definition; a re-export
//! itself is not a use. Methods, whose paths are not written, are not considered.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};
use syn::{Item, ItemUse, UseTree, Visibility};

type Name = Vec<String>;

#[derive(Default)]
struct ParsedModule {
    items: BTreeSet<String>,
    /// Imported names and where they come from.
    imports: BTreeMap<String, Name>,
    /// Modules whose items are all imported.
    globs: Vec<Name>,
    /// Paths written in its code.
    paths: Vec<Name>,
}

#[derive(Default)]
struct Crate {
    modules: BTreeMap<Name, ParsedModule>,
}

fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|a| {
        let cfg = a.path().is_ident("cfg").then(|| a.parse_args::<syn::Path>().ok()).flatten();
        cfg.is_some_and(|path| path.is_ident("test"))
    })
}

/// Everything of one file that is not an item's name.
struct PathVisitor<'a>(&'a mut Vec<Name>);

impl<'ast> Visit<'ast> for PathVisitor<'_> {
    fn visit_path(&mut self, path: &'ast syn::Path) {
        self.0.push(path.segments.iter().map(|s| s.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        // Arguments of a macro are no syntax tree: paths are found among its tokens.
        let text = call.tokens.to_string().replace(" :: ", "::");
        let words = text.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        for word in words.filter(|word| word.contains("::")) {
            self.0.push(word.split("::").filter(|s| !s.is_empty()).map(str::to_owned).collect());
        }
        visit::visit_macro(self, call);
    }

    fn visit_item_use(&mut self, _: &'ast ItemUse) {}

    fn visit_item_mod(&mut self, _: &'ast syn::ItemMod) {}
}

impl Crate {
    /// The library or the program whose root this file is.
    fn read(root: &Path) -> Self {
        let mut found = Self::default();
        found.file(root, root.parent().unwrap_or(root), Vec::new());
        found
    }

    fn file(&mut self, file: &Path, children: &Path, name: Name) {
        let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        let tree = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        self.items(&tree.items, children, name);
    }

    fn items(&mut self, items: &[Item], children: &Path, name: Name) {
        let mut module = ParsedModule::default();
        for item in items {
            if let Item::Mod(inner) = item {
                if is_test(&inner.attrs) {
                    continue;
                }
                let child = inner.ident.to_string();
                let folder = children.join(&child);
                let path = [&name[..], std::slice::from_ref(&child)].concat();
                if let Some((_, items)) = &inner.content {
                    self.items(items, &folder, path);
                } else {
                    let flat = children.join(format!("{child}.rs"));
                    let file = if flat.exists() { flat } else { folder.join("mod.rs") };
                    self.file(&file, &folder, path);
                }
                continue;
            }
            module.take(item);
        }
        self.modules.insert(name, module);
    }

    /// The module that defines what a path written in a module leads to.
    fn definer(&self, at: &Name, path: &[String], depth: usize) -> Option<Name> {
        let (first, rest) = path.split_first()?;
        let module = self.modules.get(at)?;
        let child = [&at[..], std::slice::from_ref(first)].concat();
        match first.as_str() {
            _ if depth > 20 => None,
            "crate" => self.definer(&Vec::new(), rest, depth + 1),
            "self" => self.definer(at, rest, depth + 1),
            "super" => self.definer(&at[..at.len().checked_sub(1)?].to_vec(), rest, depth + 1),
            _ if self.modules.contains_key(&child) => self.definer(&child, rest, depth + 1),
            name if module.items.contains(name) => Some(at.clone()),
            name if module.imports.contains_key(name) => {
                let whole = [&module.imports[name][..], rest].concat();
                // `use self::x` of the same name would go round for ever.
                (whole != path).then(|| self.definer(at, &whole, depth + 1)).flatten()
            }
            _ => module.globs.iter().find_map(|glob| {
                let whole = [&glob[..], path].concat();
                self.definer(at, &whole, depth + 1)
            }),
        }
    }

    /// Which modules each module uses.
    fn uses(&self) -> BTreeMap<Name, BTreeSet<Name>> {
        let of = |(name, module): (&Name, &ParsedModule)| {
            let used = module.paths.iter().filter_map(|path| self.definer(name, path, 0));
            (name.clone(), used.filter(|other| other != name).collect())
        };
        self.modules.iter().map(of).collect()
    }
}

impl ParsedModule {
    fn take(&mut self, item: &Item) {
        let (name, attributes) = match item {
            Item::Const(i) => (Some(&i.ident), &i.attrs),
            Item::Enum(i) => (Some(&i.ident), &i.attrs),
            Item::Fn(i) => (Some(&i.sig.ident), &i.attrs),
            Item::Macro(i) => (i.ident.as_ref(), &i.attrs),
            Item::Static(i) => (Some(&i.ident), &i.attrs),
            Item::Struct(i) => (Some(&i.ident), &i.attrs),
            Item::Trait(i) => (Some(&i.ident), &i.attrs),
            Item::Type(i) => (Some(&i.ident), &i.attrs),
            Item::Impl(i) => (None, &i.attrs),
            Item::Use(i) => {
                if !is_test(&i.attrs) {
                    let exported = !matches!(i.vis, Visibility::Inherited);
                    self.import(&i.tree, &mut Vec::new(), exported);
                }
                return;
            }
            _ => return,
        };
        if is_test(attributes) {
            return;
        }
        self.items.extend(name.map(ToString::to_string));
        PathVisitor(&mut self.paths).visit_item(item);
    }

    fn import(&mut self, tree: &UseTree, before: &mut Name, exported: bool) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.import(&path.tree, before, exported);
                before.pop();
            }
            UseTree::Name(name) => {
                let name = name.ident.to_string();
                let whole = if name == "self" { before.clone() } else { [&before[..], &[name]].concat() };
                self.add(whole.last().cloned().unwrap_or_default(), whole, exported);
            }
            UseTree::Rename(rename) => {
                let whole = [&before[..], &[rename.ident.to_string()]].concat();
                self.add(rename.rename.to_string(), whole, exported);
            }
            UseTree::Glob(_) => self.globs.push(before.clone()),
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.import(tree, before, exported);
                }
            }
        }
    }

    fn add(&mut self, name: String, whole: Name, exported: bool) {
        if !exported {
            self.paths.push(whole.clone());
        }
        self.imports.insert(name, whole);
    }
}

/// The modules that can be reached from each.
fn reached(uses: &BTreeMap<Name, BTreeSet<Name>>, from: &Name) -> BTreeSet<Name> {
    let (mut found, mut open) = (BTreeSet::new(), vec![from.clone()]);
    while let Some(next) = open.pop() {
        for other in uses.get(&next).into_iter().flatten() {
            if found.insert(other.clone()) {
                open.push(other.clone());
            }
        }
    }
    found
}

#[test]
fn no_module_depends_on_itself() {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let inside = |of: &str| std::fs::read_dir(workspace.join(of)).unwrap().map(|entry| entry.unwrap().path());
    let roots: Vec<PathBuf> = inside("crates")
        .chain(inside("reproduction"))
        .chain([workspace.join("xtask")])
        .flat_map(|folder| ["lib.rs", "main.rs"].map(|name| folder.join("src").join(name)))
        .filter(|root| root.exists())
        .collect();
    assert!(roots.len() > 10);
    let mut cycles = Vec::new();
    for root in roots {
        let uses = Crate::read(&root).uses();
        let all: BTreeMap<&Name, BTreeSet<Name>> =
            uses.keys().map(|name| (name, reached(&uses, name))).collect();
        for (name, used) in &uses {
            for other in used.iter().filter(|&other| all[other].contains(name)) {
                let show = |name: &Name| format!("crate::{}", name.join("::"));
                cycles.push(format!("{}: {} -> {}", root.display(), show(name), show(other)));
            }
        }
    }
    assert!(cycles.is_empty(), "uses that close a cycle:\n{}", cycles.join("\n"));
}

#[test]
fn a_cycle_of_two_is_found() {
    let mut found = Crate::default();
    let file = |text: &str| syn::parse_file(text).unwrap().items;
    let items = file(
        "pub mod a { use super::b::B; pub struct A; mod tests {} fn f() { let _ = format!(\"{}\", B); } }
         pub mod b { pub use inner::B; pub fn g(_: &crate::a::A) {} pub mod inner { pub struct B; } }",
    );
    found.items(&items, Path::new("none"), Vec::new());
    let name = |path: &str| path.split("::").map(str::to_owned).collect::<Name>();
    let uses = found.uses();
    assert_eq!(uses[&name("a")], [name("b::inner")].into());
    assert_eq!(uses[&name("b")], [name("a")].into());
    assert!(
        reached(&uses, &name("b")).contains(&name("b::inner"))
            && !reached(&uses, &name("a")).contains(&name("a"))
    );
}
