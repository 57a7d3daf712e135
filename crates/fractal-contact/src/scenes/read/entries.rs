//! Reads a table of a scene key by key; a key that is never read is an error.

use crate::scenes::read::other_words::{meant, stands_for};
use crate::scenes::read::{Diagnostic, Places};
use contact_model::Error;
use std::borrow::Cow;
use std::cell::RefCell;
use std::f64::consts::PI;
use std::ops::Range;
use surface_io::{Dimension, Quantity, Sides};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Result of reading.
pub(crate) type ReadResult<T> = Result<T, Diagnostic>;

/// Whether numbers carry units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum System {
    /// Every dimensional number has its unit; results are in SI.
    Si,
    /// Plain numbers in any consistent units.
    None,
}

impl System {
    /// Unit of a column of a table. In a scene without units a dimensional number is in the scene's own
    /// units; only pure numbers and texts keep theirs.
    pub(crate) fn unit(self, si: &'static str) -> &'static str {
        match (self, si) {
            (Self::Si, _) | (Self::None, "1" | "-") => si,
            (Self::None, _) => "scene",
        }
    }

    /// Unit in a picture; empty where the scene has no units.
    pub(crate) fn shown(self, si: &str) -> &str {
        if self == Self::Si { si } else { "" }
    }
}

/// One table.
#[derive(Debug)]
pub(crate) struct Entries<'a> {
    name: String,
    span: Option<Range<usize>>,
    content: Content<'a>,
    known: RefCell<Vec<&'static str>>,
}

#[derive(Debug)]
enum Content<'a> {
    Table(&'a DeTable<'a>),
    /// A value that stands for a table of this key alone.
    Only(&'static str, Entry<'a>),
}

impl<'a> Entries<'a> {
    /// A table of this name, such as `scene.surface`; the whole file has an empty name.
    fn named(name: &str, table: &'a DeTable<'a>) -> Self {
        let content = Content::Table(table);
        Self { name: name.into(), span: None, content, known: RefCell::default() }
    }

    /// Reads a text that is the content of the table of this name.
    pub fn of_text<T>(
        name: &str,
        text: &str,
        read: impl FnOnce(Entries<'_>) -> ReadResult<T>,
    ) -> ReadResult<T> {
        let document = DeTable::parse(text).map_err(|error| syntax(&error))?;
        read(Entries::named(name, document.get_ref()))
    }

    /// Reads the value of one key as a flag has it: a value of TOML such as `512` or `["1 N", "2 N"]`, a number such as
    /// `.5` or `5.`, which TOML does not know, or else a text such as `0.5 um`.
    pub fn of_word<T>(
        path: &str,
        word: &str,
        read: impl FnOnce(&Entry<'_>) -> ReadResult<T>,
    ) -> ReadResult<T> {
        let text = || Spanned::new(0..word.len(), DeValue::String(Cow::Borrowed(word)));
        let number = word.trim().parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.map(|number| format!("{number:?}"));
        let value = match (DeValue::parse(word), &number) {
            (Ok(value), _) if !value.get_ref().is_datetime() => value,
            (_, Some(number)) => DeValue::parse(number).unwrap_or_else(|_| text()),
            _ => text(),
        };
        // A flag has no place in a text.
        read(&Entry { path: path.to_owned(), key: None, value: &value }).map_err(Diagnostic::without_span)
    }

    /// Where all keys and values stand.
    pub fn places(&self) -> Places {
        match &self.content {
            Content::Table(table) => Places::of(table),
            Content::Only(..) => Places::default(),
        }
    }

    /// Name of the table, `[scene.surface]`.
    pub fn title(&self) -> String {
        if self.name.is_empty() { "the file".into() } else { format!("[{}]", self.name) }
    }

    fn path(&self, key: &str) -> String {
        if self.name.is_empty() { key.to_owned() } else { format!("{}.{key}", self.name) }
    }

    /// The keys that are there.
    pub fn keys(&self) -> impl Iterator<Item = &str> {
        self.spanned_keys().into_iter().map(|(name, _)| name)
    }

    fn spanned_keys(&self) -> Vec<(&str, Range<usize>)> {
        match &self.content {
            Content::Table(table) => table.keys().map(|key| (key.get_ref().as_ref(), key.span())).collect(),
            Content::Only(key, entry) => vec![(key, entry.key_span())],
        }
    }

    /// A mistake of the table itself.
    pub fn diagnostic(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(message).at(self.span.clone())
    }

    /// The value of a key, if it is there.
    pub fn find(&self, key: &'static str) -> Option<Entry<'a>> {
        let mut known = self.known.borrow_mut();
        if !known.contains(&key) {
            known.push(key);
        }
        self.entry(key)
    }

    /// The value of a key as `read` reads it, if it is there.
    pub fn optional<T>(
        &self,
        key: &'static str,
        read: impl FnOnce(&Entry<'a>) -> ReadResult<T>,
    ) -> ReadResult<Option<T>> {
        self.find(key).map(|entry| read(&entry)).transpose()
    }

    /// Replaces a value by that of a key, if it is there.
    pub fn set<T>(
        &self,
        value: &mut T,
        key: &'static str,
        read: impl FnOnce(&Entry<'a>) -> ReadResult<T>,
    ) -> ReadResult<()> {
        self.optional(key, read).map(|given| given.into_iter().for_each(|given| *value = given))
    }

    /// The value of any key, which does not count as read by this.
    pub fn entry(&self, key: &str) -> Option<Entry<'a>> {
        match &self.content {
            Content::Table(table) => {
                let (key, value) = table.iter().find(|(k, _)| k.get_ref().as_ref() == key)?;
                Some(Entry { path: self.path(key.get_ref()), key: Some(key.span()), value })
            }
            Content::Only(only, entry) => (*only == key).then(|| entry.clone()),
        }
    }

    /// The value of a key that has to be there.
    pub fn require(&self, key: &'static str, example: &str) -> ReadResult<Entry<'a>> {
        self.find(key).ok_or_else(|| {
            let known = self.known.borrow();
            let is_meant = |name: &&str| {
                !known.contains(name)
                    && (distance(name, key) <= 1 + key.len() / 4 || stands_for(&self.name, key, name))
            };
            if let Some(found) = self.keys().find(is_meant).and_then(|name| self.entry(name)) {
                let name = found.name();
                // What stands beside it may be wrong in the same way.
                let others = self.keys().filter(|other| *other != name && !known.contains(other));
                let others = others.filter_map(|other| meant(&self.name, other));
                let help: Vec<String> =
                    std::iter::once(format!("write `{key}` for `{name}`")).chain(others).collect();
                let message = format!("`{key}` is missing in {}, and `{name}` is no key of it", self.title());
                return found.diagnostic_at_key(message).with_help(help.join(", and "));
            }
            let missing = Diagnostic::of_type(format!("`{key}` is missing in {}", self.title()));
            missing.at(self.span.clone()).with_help(format!("add `{key} = {example}`"))
        })
    }

    /// A table, if it is there.
    pub fn table(&self, key: &'static str) -> ReadResult<Option<Entries<'a>>> {
        self.optional(key, Entry::table)
    }

    /// At most one of these keys.
    pub fn one_of(&self, keys: &[&'static str]) -> ReadResult<Option<(&'static str, Entry<'a>)>> {
        let mut found: Option<(&'static str, Entry<'a>)> = None;
        for &key in keys {
            let Some(entry) = self.find(key) else { continue };
            if let Some((first, _)) = &found {
                return Err(entry
                    .diagnostic_at_key(format!("`{first}` and `{key}` are both given in {}", self.title()))
                    .with_help(format!(
                        "they say the same thing twice or contradict each other: keep `{first}` or `{key}`"
                    )));
            }
            found = Some((key, entry));
        }
        Ok(found)
    }

    /// An error where a key was given that was never read.
    pub fn finish(self) -> ReadResult<()> {
        self.known_only()
    }

    /// The same for a table that is read further. All such keys are named, with what was probably meant by each.
    pub fn known_only(&self) -> ReadResult<()> {
        let known = self.known.borrow();
        let mut unknown = self.spanned_keys();
        unknown.retain(|(name, _)| !known.contains(name));
        unknown.sort_by_key(|(_, span)| span.start);
        if unknown.is_empty() {
            return Ok(());
        }
        // Names of older versions are read, but not suggested.
        let current: Vec<&str> =
            known.iter().copied().filter(|k| !["chance", "width", "modulus"].contains(k)).collect();
        let names: Vec<String> = unknown.iter().map(|(name, _)| format!("`{name}`")).collect();
        let place = if self.name.is_empty() { String::new() } else { format!(" in {}", self.title()) };
        let what = match (self.name.as_str(), names.len()) {
            ("", 1) => "is no table",
            ("", _) => "are no tables",
            ("effects", 1) => "is no effect",
            ("effects", _) => "are no effects",
            (_, 1) => "is no key",
            _ => "are no keys",
        };
        let meanings: Vec<Option<String>> = unknown
            .iter()
            .map(|(name, _)| meant(&self.name, name).or_else(|| near(name, &current)))
            .collect();
        let mut help: Vec<String> = Vec::new();
        for meaning in meanings.iter().flatten() {
            if !help.contains(meaning) {
                help.push(meaning.clone());
            }
        }
        let untold = unknown.iter().zip(&meanings).filter(|(_, meaning)| meaning.is_none());
        let untold: Vec<String> = untold.map(|((name, _), _)| (*name).to_owned()).collect();
        if !untold.is_empty() {
            help.push(format!("known here: {}", current.join(", ")));
        }
        Err(Diagnostic::of_unknown(format!("{} {what}{place}", in_a_row(&names)), untold)
            .at(unknown[0].1.clone())
            .with_help(help.join("\n")))
    }
}

/// `a`, `a and b`, `a, b and c`.
fn in_a_row(names: &[String]) -> String {
    match names {
        [most @ .., last] if !most.is_empty() => format!("{} and {last}", most.join(", ")),
        names => names.concat(),
    }
}

fn syntax(error: &toml::de::Error) -> Diagnostic {
    let message = error.message().lines().collect::<Vec<_>>().join(", ");
    if message.starts_with("string values must be quoted") {
        return Diagnostic::new("a value that is neither a number nor in quotation marks")
            .with_help("a quantity with its unit and a text stand in quotation marks, such as \"210 GPa\"")
            .at(error.span());
    }
    Diagnostic::new(message)
        .with_help("this is not valid TOML: text is quoted, tables are `[name]`, each key stands once")
        .at(error.span())
}

/// A quantity of this dimension, as it stands in a file.
fn example(dimension: Dimension) -> String {
    format!("\"{}\"", dimension.example().unwrap_or("1"))
}

/// The name that was probably meant.
fn near(name: &str, known: &[&str]) -> Option<String> {
    let (_, found) = known
        .iter()
        .map(|k| (distance(name, k), *k))
        .min()
        .filter(|(distance, found)| *distance <= 1 + found.len() / 4)?;
    Some(format!("did you mean `{found}` for `{name}`?"))
}

/// The name that was probably meant, or all of them.
pub(crate) fn suggestion(name: &str, known: &[&str]) -> String {
    let near = known.iter().map(|k| (distance(name, k), *k)).min();
    match near {
        Some((d, k)) if d <= 1 + k.len() / 4 => {
            format!("did you mean `{k}`? Known here: {}", known.join(", "))
        }
        _ => format!("known here: {}", known.join(", ")),
    }
}

/// The name among these that was probably meant.
pub(crate) fn nearest<'k>(name: &str, known: impl Iterator<Item = &'k str>) -> Option<&'k str> {
    let near = known.map(|known| (distance(name, known), known)).min()?;
    (near.0 <= 1 + name.len() / 4).then_some(near.1)
}

/// Levenshtein's distance of a name from a known one, of which a beginning is as near as can be; only the first 64
/// characters of a long name count.
fn distance(a: &str, b: &str) -> usize {
    /// Shorter beginnings may be those of anything.
    const BEGINNING: usize = 3;
    if a.len() >= BEGINNING && b.starts_with(a) {
        return usize::from(a != b);
    }
    strsim::levenshtein(&a.chars().take(64).collect::<String>(), b)
}

/// One length, or two along x and y.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LengthOrPair {
    One(f64),
    Two([f64; 2]),
}

/// One value.
#[derive(Debug, Clone)]
pub(crate) struct Entry<'a> {
    path: String,
    key: Option<Range<usize>>,
    value: &'a Spanned<DeValue<'a>>,
}

impl<'a> Entry<'a> {
    /// Its key with the name of its table.
    pub fn path(&self) -> &str {
        &self.path
    }

    /// Name of its key.
    pub fn name(&self) -> &str {
        self.path.rsplit('.').next().unwrap_or(&self.path)
    }

    /// Where the value stands.
    pub fn span(&self) -> Range<usize> {
        self.value.span()
    }

    /// Where the key stands.
    pub fn key_span(&self) -> Range<usize> {
        self.key.clone().unwrap_or_else(|| self.span())
    }

    /// A mistake of this value.
    pub fn diagnostic(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(message).at(self.span())
    }

    /// A mistake of this key.
    pub fn diagnostic_at_key(&self, message: impl Into<String>) -> Diagnostic {
        Diagnostic::new(message).at(self.key_span())
    }

    fn wrong(&self, expected: &str, example: &str) -> Diagnostic {
        Diagnostic::of_type(format!("`{}` is {}: expected {expected}", self.path, self.kind()))
            .at(self.span())
            .with_help(format!("write {example}"))
    }

    /// A mistake of the value of a number.
    pub fn outside(&self, value: f64, expected: impl Into<Cow<'static, str>>) -> Diagnostic {
        let expected = expected.into();
        let message = format!("`{}` = {}: expected {expected}", self.path, self.shown());
        Diagnostic::of_domain(message, Error::domain(self.path.clone(), value, expected)).at(self.span())
    }

    fn kind(&self) -> &'static str {
        match self.value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a plain number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        }
    }

    pub fn table(&self) -> ReadResult<Entries<'a>> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                let span = self.key.clone().or_else(|| Some(self.span()));
                Ok(Entries { span, ..Entries::named(&self.path, table) })
            }
            _ => Err(self.wrong("a table", &format!("[{}] on a line of its own", self.path))),
        }
    }

    /// A table; any other value stands for a table with this key alone.
    pub fn table_or(&self, key: &'static str) -> ReadResult<Entries<'a>> {
        if self.is_table() {
            return self.table();
        }
        let content = Content::Only(key, self.clone());
        Ok(Entries { name: self.path.clone(), span: self.key.clone(), content, known: RefCell::default() })
    }

    pub fn is_table(&self) -> bool {
        self.value.get_ref().is_table()
    }

    pub fn is_list(&self) -> bool {
        self.value.get_ref().is_array()
    }

    pub fn is_text(&self) -> bool {
        self.value.get_ref().is_str()
    }

    /// Elements of a list; one value is a list of one.
    pub fn list(&self) -> Vec<Entry<'a>> {
        match self.value.get_ref() {
            DeValue::Array(array) => {
                array.iter().map(|value| Entry { path: self.path.clone(), key: None, value }).collect()
            }
            _ => vec![self.clone()],
        }
    }

    pub fn text(&self) -> ReadResult<&'a str> {
        self.value.get_ref().as_str().ok_or_else(|| self.wrong("text", "it in double quotes"))
    }

    /// The text, where it is one.
    pub fn as_word(&self) -> Option<&'a str> {
        self.value.get_ref().as_str()
    }

    pub fn flag(&self) -> ReadResult<bool> {
        self.value
            .get_ref()
            .as_bool()
            .ok_or_else(|| self.wrong("true or false", "true or false, without quotes"))
    }

    /// One of these words, each with its value.
    pub fn choice<T: Copy>(&self, words: &[(&str, T)]) -> ReadResult<T> {
        let names: Vec<&str> = words.iter().map(|(name, _)| *name).collect();
        let example = names.iter().map(|n| format!("\"{n}\"")).collect::<Vec<_>>().join(" or ");
        let Some(text) = self.value.get_ref().as_str() else {
            return Err(self.wrong("a word", &example));
        };
        words.iter().find(|(name, _)| *name == text).map(|(_, value)| *value).ok_or_else(|| {
            self.diagnostic(format!("`{}` is \"{text}\": unknown value", self.path))
                .with_help(suggestion(text, &names))
        })
    }

    /// A finite plain number.
    pub fn number(&self) -> ReadResult<f64> {
        let digits = match self.value.get_ref() {
            DeValue::Float(v) => v.as_str().replace('_', ""),
            DeValue::Integer(v) if v.radix() == 10 => v.as_str().replace('_', ""),
            _ => return Err(self.wrong("a plain number", "a number such as 0.5 or 1e-3, without quotes")),
        };
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            value => Err(self
                .outside(value.unwrap_or(f64::NAN), "a finite number")
                .with_help("write it in digits")),
        }
    }

    /// A pure number: as [`Entry::number`], or a percentage such as `"30 %"`.
    pub fn pure_number(&self) -> ReadResult<f64> {
        let Some(text) = self.as_word() else { return self.number() };
        let percent = text.trim().strip_suffix('%').and_then(|text| text.trim().parse::<f64>().ok());
        match percent.filter(|percent| percent.is_finite()) {
            Some(percent) => Ok(percent / 100.0),
            None => Err(self.wrong("a pure number", "0.3 or \"30 %\"")),
        }
    }

    /// An angle in degrees: with its unit, `"30 deg"` or `"5 mrad"`, or a plain number of degrees.
    pub fn angle(&self) -> ReadResult<f64> {
        // Longer names before those that end them.
        const UNITS: [(&str, f64); 4] =
            [("deg", 1.0), ("mrad", 0.18 / PI), ("urad", 0.18e-3 / PI), ("rad", 180.0 / PI)];
        let Some(text) = self.as_word() else { return self.number() };
        let angle = UNITS.iter().find_map(|(unit, degrees)| {
            Some(text.trim().strip_suffix(unit)?.trim().parse::<f64>().ok()? * degrees)
        });
        match angle.filter(|angle| angle.is_finite()) {
            Some(angle) => Ok(angle),
            None => Err(self.wrong("an angle", "\"30 deg\", \"5 mrad\" or 30, in degrees")),
        }
    }

    /// A number as [`Entry::number`], or an infinity: `inf`, `-inf`.
    pub fn any_number(&self) -> ReadResult<f64> {
        match self.value.get_ref() {
            DeValue::Float(v) if matches!(v.as_str(), "inf" | "+inf") => Ok(f64::INFINITY),
            DeValue::Float(v) if v.as_str() == "-inf" => Ok(f64::NEG_INFINITY),
            _ => self.number(),
        }
    }

    /// A whole number from `least`.
    pub fn count(&self, least: u64) -> ReadResult<u64> {
        let (digits, radix) = match self.value.get_ref() {
            DeValue::Integer(written) => (written.as_str().replace('_', ""), written.radix()),
            DeValue::Float(written) => (written.as_str().replace('_', ""), 10),
            _ => return Err(self.wrong(&format!("a whole number >= {least}"), "it without quotes")),
        };
        let whole = u64::from_str_radix(&digits, radix).ok().filter(|whole| *whole >= least);
        whole.ok_or_else(|| {
            let value = digits.parse().unwrap_or(f64::NAN);
            let most = if value > u64::MAX as f64 { ", below 2^64" } else { "" };
            self.outside(value, format!("a whole number >= {least}{most}"))
        })
    }

    /// The same of cells, rows and the like.
    pub fn size(&self, least: u64) -> ReadResult<usize> {
        self.count(least).map(|count| count as usize)
    }

    /// A number with its unit in SI, or a plain number where the scene has none.
    pub fn quantity(&self, dimension: Dimension, system: System) -> ReadResult<f64> {
        match (system, self.value.get_ref()) {
            (System::None, DeValue::String(text)) => Err(Diagnostic::of_type(format!(
                "`{}` is the text \"{text}\": expected a plain number, without a unit",
                self.path
            ))
            .at(self.span())
            .with_help(
                "write a plain number, or remove `units = \"none\"` and give every quantity its unit",
            )),
            (System::None, _) => self.number(),
            (System::Si, DeValue::String(text)) => Quantity::parse_as(text, dimension).map_err(|reason| {
                self.diagnostic(format!("`{}`: {reason}", self.path))
                    .with_help(self.help_with_quantity(text, dimension))
            }),
            (System::Si, DeValue::Integer(_) | DeValue::Float(_)) => {
                let value = self.number()?;
                Err(self.diagnostic(format!("`{}` = {value} has no unit: expected {dimension}", self.path)).with_help(format!(
                    "write it with its unit, such as {}; a dimensionless scene says `units = \"none\"` in [scene]",
                    example(dimension)
                )))
            }
            (System::Si, _) => Err(self.wrong(&dimension.to_string(), &example(dimension))),
        }
    }

    /// How to write a quantity of this dimension: as another load, where the text is one, or in another unit.
    fn help_with_quantity(&self, text: &str, dimension: Dimension) -> String {
        const LOADS: [(&str, &str, Dimension); 3] = [
            ("force", "--force", Dimension::FORCE),
            ("mean_pressure", "--pressure", Dimension::PRESSURE),
            ("approach", "--approach", Dimension::LENGTH),
        ];
        let is = |of: Dimension| Quantity::parse_as(text, of).is_ok();
        let is_load = LOADS.iter().any(|(key, ..)| *key == self.name());
        if let Some((key, flag, _)) = LOADS.iter().find(|(.., of)| is_load && is(*of)) {
            return format!(
                "prescribe it as `{key} = \"{text}\"` in a scene, or as `{flag} '{text}'` in `press`; {dimension} has its unit, such as {}",
                example(dimension)
            );
        }
        if let Some(number) = text.trim().strip_suffix("HV").map(str::trim) {
            return format!("a Vickers hardness is in kgf/mm^2: write \"{number} kgf/mm^2\"");
        }
        format!("write {dimension} with its unit, such as {}", example(dimension))
    }

    /// The same, > 0.
    pub fn positive(&self, dimension: Dimension, system: System) -> ReadResult<f64> {
        self.above_zero(self.quantity(dimension, system)?)
    }

    /// The same, >= 0.
    pub fn not_negative(&self, dimension: Dimension, system: System) -> ReadResult<f64> {
        self.zero_or_above(self.quantity(dimension, system)?)
    }

    /// One length > 0, or two in a list.
    pub fn lengths(&self, system: System) -> ReadResult<LengthOrPair> {
        // As on the command line: "2 mm x 1 mm".
        let both =
            self.as_word().map(|text| (text.contains(" x ") || text.contains(','), text.parse::<Sides>()));
        let dimension = if system == System::Si { Dimension::LENGTH } else { Dimension::NONE };
        let wrong = |reason: surface_io::QuantityError| {
            self.diagnostic(format!("`{}`: {reason}", self.path))
                .with_help("two lengths with their units: [\"2 mm\", \"1 mm\"] or \"2 mm x 1 mm\"")
        };
        match both {
            Some((_, Ok(Sides::Two(both)))) => {
                let side = |side: Quantity| self.above_zero(side.expect(dimension).map_err(wrong)?);
                return Ok(LengthOrPair::Two([side(both[0])?, side(both[1])?]));
            }
            Some((true, Err(reason))) => return Err(wrong(reason)),
            _ => {}
        }
        if !self.is_list() {
            return self.positive(Dimension::LENGTH, system).map(LengthOrPair::One);
        }
        let values = self.list();
        let [x, y] = &values[..] else {
            let example = if system == System::Si { "[\"2 mm\", \"1 mm\"]" } else { "[2, 1]" };
            return Err(self
                .diagnostic(format!("`{}` has {} values: expected one, or two", self.path, values.len()))
                .with_help(format!(
                    "along x, then along y, such as {example}; one value where both are the same"
                )));
        };
        let length = |entry: &Self| entry.positive(Dimension::LENGTH, system);
        Ok(LengthOrPair::Two([length(x)?, length(y)?]))
    }

    /// A pure number > 0.
    pub fn positive_number(&self) -> ReadResult<f64> {
        self.above_zero(self.pure_number()?)
    }

    /// A pure number >= 0.
    pub fn not_negative_number(&self) -> ReadResult<f64> {
        self.zero_or_above(self.pure_number()?)
    }

    fn above_zero(&self, value: f64) -> ReadResult<f64> {
        let refused =
            || self.outside(value, "a number > 0").with_help("check the sign; zero is not allowed here");
        if value > 0.0 { Ok(value) } else { Err(refused()) }
    }

    fn zero_or_above(&self, value: f64) -> ReadResult<f64> {
        let refused = || self.outside(value, "a number >= 0").with_help("check the sign");
        if value >= 0.0 { Ok(value) } else { Err(refused()) }
    }

    /// The value as written.
    pub fn shown(&self) -> String {
        match self.value.get_ref() {
            DeValue::String(text) => text.to_string(),
            DeValue::Integer(v) => v.as_str().to_owned(),
            DeValue::Float(v) => v.as_str().to_owned(),
            DeValue::Boolean(v) => v.to_string(),
            _ => self.kind().to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_names_are_suggested() {
        assert_eq!(distance("kitten", "sitting"), 3);
        assert!(suggestion("adhesoin", &["boundary", "adhesion"]).starts_with("did you mean `adhesion`?"));
        assert_eq!(suggestion("plasticity", &["boundary"]), "known here: boundary");
    }
}
