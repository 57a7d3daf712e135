//! Where the keys and values of a scene stand in its text, for messages.

use crate::scenes::read::Diagnostic;
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Places in the text of a scene, by the path of a key such as `scene.surface.size`. Elements of lists are
/// counted from 0: `scene.models.1`. A question that was not read from a text has none.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct Places(Vec<TomlPlace>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct TomlPlace {
    path: String,
    key: Range<usize>,
    value: Range<usize>,
}

impl Places {
    /// Those of a whole text.
    pub fn of(document: &DeTable<'_>) -> Self {
        let mut places = Self::default();
        places.add_table("", document);
        places
    }

    fn add_table(&mut self, path: &str, table: &DeTable<'_>) {
        for (key, value) in table {
            let path =
                if path.is_empty() { key.get_ref().to_string() } else { format!("{path}.{}", key.get_ref()) };
            self.add(path, key.span(), value);
        }
    }

    fn add(&mut self, path: String, key: Range<usize>, value: &Spanned<DeValue<'_>>) {
        match value.get_ref() {
            DeValue::Table(table) => self.add_table(&path, table),
            DeValue::Array(array) => {
                for (i, item) in array.iter().enumerate() {
                    self.add(format!("{path}.{i}"), item.span(), item);
                }
            }
            _ => {}
        }
        self.0.push(TomlPlace { path, key, value: value.span() });
    }

    fn find(&self, path: &str) -> Option<&TomlPlace> {
        self.0.iter().find(|place| place.path == path)
    }

    /// Whether the key is given.
    pub fn has(&self, path: &str) -> bool {
        self.find(path).is_some()
    }

    /// Where the key stands.
    pub fn key(&self, path: &str) -> Option<Range<usize>> {
        self.find(path).map(|place| place.key.clone())
    }

    /// Where its value stands.
    pub fn value(&self, path: &str) -> Option<Range<usize>> {
        self.find(path).map(|place| place.value.clone())
    }

    /// A mistake of a key.
    pub fn at_key(&self, path: &str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(message).at(self.key(path))
    }

    /// A mistake of a value.
    pub fn at_value(&self, path: &str, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(message).at(self.value(path))
    }
}
