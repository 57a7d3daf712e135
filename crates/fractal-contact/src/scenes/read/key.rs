//! The keys of a table of a scene. One entry says how a key is read from TOML, from a flag or from Python, how
//! it is printed, and what the book says about it.

use crate::scenes::read::{Diagnostic, Entries, Entry, Places, ReadResult, RegisteredModel, System};

/// The settings of the whole scene by which the values of its keys are read.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Context<'a> {
    /// Whether numbers carry units.
    pub system: System,
    /// Models of the user's own, which can be named beside those of the library.
    pub own: &'a [RegisteredModel],
}

/// A key that sets a part of a `T`.
pub(crate) struct Key<T: 'static> {
    pub name: &'static str,
    /// Its values, in Markdown.
    pub takes: &'static str,
    /// The sentence with which the book explains the key, in Markdown. It is empty for a former name, which is
    /// still read and no longer recommended.
    pub about: &'static str,
    /// The value that holds in a scene without the key, in Markdown. It is empty for a key that has to be given.
    pub default: &'static str,
    pub read: fn(&mut T, &Entry<'_>, Context<'_>) -> ReadResult<()>,
    /// Its value as TOML; `None` where it is not given.
    pub print: fn(&T, System) -> Option<String>,
}

/// The keys of a table, or of one kind of it.
pub(crate) struct KeyTable<T: 'static> {
    /// The table, as `scene.surface`.
    pub name: &'static str,
    /// Where these keys belong to one kind of the table, the line that selects it, as `kind = "file"`;
    /// otherwise empty.
    pub kind: &'static str,
    pub keys: &'static [Key<T>],
    /// Keys of which at most one is given.
    pub alternatives: &'static [&'static [&'static str]],
    /// Keys that are flags of the program too.
    pub everyday: &'static [&'static str],
}

impl<T> KeyTable<T> {
    /// Reads the keys that are there.
    pub fn read(&self, value: &mut T, table: &Entries<'_>, context: Context<'_>) -> ReadResult<()> {
        let given = self.keys.iter().filter_map(|key| Some((key, table.find(key.name)?)));
        let given: Vec<(&Key<T>, Entry<'_>)> = given.collect();
        for keys in self.alternatives {
            table.one_of(keys)?;
        }
        given.into_iter().try_for_each(|(key, entry)| (key.read)(value, &entry, context))
    }

    /// Sets one key; `None` where there is none of this name.
    pub fn set(&self, value: &mut T, entry: &Entry<'_>, context: Context<'_>) -> Option<ReadResult<()>> {
        let key = self.keys.iter().find(|key| key.name == entry.name())?;
        let others = self.alternatives.iter().filter(|keys| keys.contains(&key.name)).copied().flatten();
        let is_given = |other: &Key<T>| (other.print)(value, context.system).is_some();
        let mut given = others.filter_map(|name| self.keys.iter().find(|other| other.name == *name));
        Some(match given.find(|other| other.name != key.name && is_given(other)) {
            Some(other) => {
                let message = format!("`{}` and `{}` are both given", other.name, key.name);
                Err(entry
                    .diagnostic(message)
                    .with_help("they say the same thing twice or contradict each other: keep one"))
            }
            None => (key.read)(value, entry, context),
        })
    }

    /// The keys that have a value, with that as TOML.
    pub fn print(&self, value: &T, system: System) -> Vec<(&'static str, String)> {
        self.keys.iter().filter_map(|key| Some((key.name, (key.print)(value, system)?))).collect()
    }

    /// Its keys as the book describes them.
    pub fn describe(&self) -> impl Iterator<Item = SceneKey> {
        let is_shown = |name: &str| self.keys.iter().any(|key| key.name == name && !key.about.is_empty());
        let alternative = move |key: &str| -> Vec<&'static str> {
            let others = self.alternatives.iter().filter(|keys| keys.contains(&key)).copied().flatten();
            others.copied().filter(|other| *other != key && is_shown(other)).collect()
        };
        self.keys.iter().filter(|key| !key.about.is_empty()).map(move |key| SceneKey {
            table: self.name,
            kind: self.kind,
            name: key.name,
            takes: key.takes,
            about: key.about,
            default: key.default,
            instead_of: alternative(key.name),
            everyday: self.everyday.contains(&key.name),
        })
    }
}

/// A key of a scene as the book describes it.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub struct SceneKey {
    /// Its table, as `scene.surface`.
    pub table: &'static str,
    /// Where it belongs to one kind of the table, the line that selects that, as `kind = "file"`; otherwise
    /// empty.
    pub kind: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its values, in Markdown.
    pub takes: &'static str,
    /// The sentence that explains it, in Markdown.
    pub about: &'static str,
    /// The value that holds in a scene without the key, in Markdown. It is empty for a key that has to be given.
    pub default: &'static str,
    /// The keys in whose place it is given.
    pub instead_of: Vec<&'static str>,
    /// Whether the program has a flag of this name.
    pub everyday: bool,
}

/// The mistake of a key that has to be there.
pub(crate) fn missing(table: &str, key: &str, example: &str, places: &Places) -> Diagnostic {
    Diagnostic::of_type(format!("`{key}` is missing in [{table}]"))
        .at(places.key(table))
        .with_help(format!("add `{key} = {example}`"))
}
