//! Headers of files that are text: lines of keys and values in sections.

use crate::error::{Error, Result};
use crate::extent::Extent;
use crate::fields::decoded;
use crate::source::OpenedFile;
use crate::subject::Subject;

/// A line of such a header.
pub(crate) enum HeaderLine<'l> {
    /// The name of the section that begins.
    Section(&'l str),
    /// A key and its value.
    Entry(&'l str, &'l str),
    /// The first key and its value of a section without a name.
    First(&'l str, &'l str),
    /// The last line.
    End,
    /// A comment, an empty line.
    Passed,
    /// No such line; what was expected.
    Wrong(&'static str),
}

impl<'l> HeaderLine<'l> {
    /// A key and its value with a mark between, or the name of a section in brackets.
    pub(crate) fn in_section(line: &'l str, between: char) -> Self {
        match line.strip_prefix('[').and_then(|line| line.strip_suffix(']')) {
            Some(name) => Self::Section(name),
            None => Self::entry(line, between),
        }
    }

    /// A key and its value with a mark between; a comment without one.
    pub(crate) fn entry(line: &'l str, between: char) -> Self {
        line.split_once(between).map_or(Self::Passed, |(key, value)| Self::Entry(key, value))
    }
}

/// Relative error of a number of a header that has six digits.
pub(crate) const SIX_DIGITS: f64 = 1e-5;

/// A text header; names of sections and keys are in small letters.
pub(crate) struct TextHeader {
    sections: Vec<Section>,
    /// Offset behind its last line.
    pub(crate) end: u64,
}

/// A section of it; the first has no name.
pub(crate) struct Section {
    pub(crate) name: String,
    entries: Vec<(String, String, u64)>,
    subject: Subject,
}

impl TextHeader {
    /// Reads lines up to the one that ends the header, and returns whether there is one.
    pub(crate) fn read(
        subject: &Subject,
        text: &[u8],
        line: impl for<'l> Fn(&'l str) -> HeaderLine<'l>,
    ) -> Result<(Self, bool)> {
        let section = |name: &str| Section {
            name: name.trim().to_lowercase(),
            entries: Vec::new(),
            subject: subject.clone(),
        };
        let mut found = Self { sections: vec![section("")], end: 0 };
        for bytes in text.split_inclusive(|&b| b == b'\n') {
            let offset = found.end;
            found.end += bytes.len() as u64;
            let text = decoded(bytes);
            let line = line(text.trim_end_matches(['\r', '\n']));
            if let HeaderLine::First(..) = line {
                found.sections.push(section(""));
            }
            match line {
                HeaderLine::Section(name) => found.sections.push(section(name)),
                HeaderLine::Entry(key, value) | HeaderLine::First(key, value) => {
                    let entry = (key.trim().to_lowercase(), value.trim().to_owned(), offset);
                    if let Some(section) = found.sections.last_mut() {
                        section.entries.push(entry);
                    }
                }
                HeaderLine::End => return Ok((found, true)),
                HeaderLine::Passed => {}
                HeaderLine::Wrong(expected) => return Err(subject.wrong(offset, expected)),
            }
        }
        Ok((found, false))
    }

    /// Reads lines up to one that ends the header; an error says that it is expected.
    pub(crate) fn up_to_end(
        source: &OpenedFile<'_>,
        text: &[u8],
        line: impl for<'l> Fn(&'l str) -> HeaderLine<'l>,
        expected: &str,
    ) -> Result<Self> {
        let (header, ended) = Self::read(source.subject(), text, line)?;
        if ended { Ok(header) } else { Err(source.wrong(header.end, format!("{expected} (cut short?)"))) }
    }

    pub(crate) fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// The first section of this name; the nameless one where there is none.
    pub(crate) fn section(&self, name: &str) -> &Section {
        self.sections.iter().find(|s| s.name == name).unwrap_or(&self.sections[0])
    }
}

impl Section {
    /// The value of a key.
    pub(crate) fn text(&self, key: &str) -> Option<&str> {
        self.entries.iter().find(|e| e.0 == key).map(|e| e.1.as_str())
    }

    /// Keys and values in their order.
    pub(crate) fn entries(&self) -> impl Iterator<Item = (&str, &str)> {
        self.entries.iter().map(|e| (e.0.as_str(), e.1.as_str()))
    }

    /// Where a key stands, the beginning of the file where it does not.
    pub(crate) fn at(&self, key: &str) -> u64 {
        self.entries.iter().find(|e| e.0 == key).map_or(0, |e| e.2)
    }

    /// An error about the value of a key.
    pub(crate) fn wrong(&self, key: &str, expected: impl std::fmt::Display) -> Error {
        let found = match self.text(key) {
            Some(text) => format!("{:?}", text.chars().take(32).collect::<String>()),
            None => "nothing".to_owned(),
        };
        self.subject.wrong(self.at(key), format!("{expected} as {key}, found {found}"))
    }

    /// A finite number, where the key has a value.
    pub(crate) fn number(&self, key: &str) -> Result<Option<f64>> {
        let Some(text) = self.text(key).filter(|text| !text.is_empty()) else { return Ok(None) };
        let number = text.parse().ok().filter(|number: &f64| number.is_finite());
        number.map(Some).ok_or_else(|| self.wrong(key, "a number"))
    }

    /// A finite number that must be there.
    pub(crate) fn some_number(&self, key: &str) -> Result<f64> {
        self.number(key)?.ok_or_else(|| self.wrong(key, "a number"))
    }

    /// A whole number that must be there.
    pub(crate) fn whole(&self, key: &str) -> Result<usize> {
        let number = self.text(key).and_then(|text| text.parse().ok());
        number.ok_or_else(|| self.wrong(key, "a whole number"))
    }

    /// A side of the map in a unit; `None` where there is no length above 0.
    pub(crate) fn side(&self, key: &str, unit: &str) -> Option<Extent> {
        Extent::of_side(self.text(key)?.parse().ok()?, unit)
    }
}

/// A number and what stands behind it.
pub(crate) fn number_and_text(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let digits = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ',');
    // An exponent has digits behind its letter.
    let end = text.char_indices().find(|&(at, c)| {
        let exponent = matches!(c, 'e' | 'E') && text[at + 1..].starts_with(digits);
        !digits(c) && !exponent
    });
    let (number, unit) = text.split_at(end.map_or(text.len(), |(at, _)| at));
    Some((number.replacen(',', ".", 1).parse().ok()?, unit.trim()))
}
