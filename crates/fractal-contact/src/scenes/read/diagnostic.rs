//! Mistakes in a scene, shown at their place in the text.

use contact_model::Error;
use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Longest part of a line that is shown.
const SHOWN: usize = 100;

/// A mistake in a scene, or a note on it: the message, its place and a remedy. Its `Display` is a few lines
/// with the place underlined.
///
/// ```
/// use fractal_contact::scenes::Diagnostic;
/// let diagnostic = Diagnostic::new("`force = -1`: expected a number > 0").at(0..10).with_help("press, do not pull");
/// assert_eq!(
///     diagnostic.placed("a.toml".as_ref(), "force = -1\n").to_string(),
///     "error: `force = -1`: expected a number > 0\n --> a.toml:1:1\n  |\n1 | force = -1\n  | ^^^^^^^^^^\n  = help: press, do not pull"
/// );
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    message: String,
    kind: DiagnosticKind,
    span: Option<Range<usize>>,
    help: Option<String>,
    place: Option<Box<SourceSpan>>,
}

/// The kinds that callers with an error type of their own distinguish.
#[derive(Debug, Clone, PartialEq)]
enum DiagnosticKind {
    Note,
    Mistake,
    /// A value of another type than expected, or none where one is needed.
    Type,
    /// A number outside of its range.
    Domain(Box<Error>),
    /// Keys that their table does not have; those of which nothing is known.
    Unknown(Vec<String>),
}

/// The place of a mistake in the text.
#[derive(Debug, Clone, PartialEq, Eq)]
struct SourceSpan {
    path: PathBuf,
    /// Line and column from 1, the text of the line and the length of the marked part.
    line: Option<(usize, usize, String, usize)>,
}

impl Diagnostic {
    /// A mistake of the whole file.
    pub fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), kind: DiagnosticKind::Mistake, span: None, help: None, place: None }
    }

    /// A remark on the whole file, which is still read.
    pub fn note(message: impl Into<String>) -> Self {
        Self { kind: DiagnosticKind::Note, ..Self::new(message) }
    }

    /// A value of another type than expected, or none where one is needed.
    pub(crate) fn of_type(message: impl Into<String>) -> Self {
        Self { kind: DiagnosticKind::Type, ..Self::new(message) }
    }

    /// A number outside of its range.
    pub(crate) fn of_domain(message: impl Into<String>, error: Error) -> Self {
        Self { kind: DiagnosticKind::Domain(Box::new(error)), ..Self::new(message) }
    }

    /// Keys that their table does not have; those of which nothing is known.
    pub(crate) fn of_unknown(message: impl Into<String>, names: Vec<String>) -> Self {
        Self { kind: DiagnosticKind::Unknown(names), ..Self::new(message) }
    }

    /// The keys that their table does not have and of which nothing is known.
    pub(crate) fn unknown(&self) -> &[String] {
        match &self.kind {
            DiagnosticKind::Unknown(names) => names,
            _ => &[],
        }
    }

    /// Whether a value is of another type than expected, or missing.
    pub fn is_type(&self) -> bool {
        self.kind == DiagnosticKind::Type
    }

    /// The number outside of its range, as [`Error::Domain`].
    pub fn domain(&self) -> Option<&Error> {
        match &self.kind {
            DiagnosticKind::Domain(error) => Some(error),
            _ => None,
        }
    }

    /// Sets the place to these bytes of the text, where they are known; a place given before is kept.
    #[must_use]
    pub fn at(mut self, span: impl Into<Option<Range<usize>>>) -> Self {
        self.span = self.span.or(span.into());
        self
    }

    /// Forgets the place.
    #[must_use]
    pub(crate) fn without_span(self) -> Self {
        Self { span: None, ..self }
    }

    /// Adds a remedy.
    #[must_use]
    pub fn with_help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    /// Adds the file and its text, so that the place can be shown.
    #[must_use]
    pub fn placed(mut self, path: &Path, text: &str) -> Self {
        let line = self.span.clone().map(|span| excerpt(text, &span));
        self.place.get_or_insert(Box::new(SourceSpan { path: path.to_owned(), line }));
        self
    }

    /// The same for the value of a flag of the program that sets this key.
    #[must_use]
    pub fn of_flag(mut self, key: &str, flag: &str) -> Self {
        self.message = self.message.replace(&format!("`{key}`"), &format!("`{flag}`"));
        self
    }

    /// For a text that is not in a file yet: the message shows these words instead of a path.
    #[must_use]
    pub fn told_of(mut self, words: &str) -> Self {
        if let Some(place) = &mut self.place {
            place.path = words.into();
        }
        self
    }

    /// The message, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// The remedy.
    pub fn help(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Line of the text, from 1, where the mistake has a place.
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref()?.line.as_ref().map(|(number, ..)| *number)
    }
}

fn excerpt(text: &str, span: &Range<usize>) -> (usize, usize, String, usize) {
    let mut at = span.start.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    let begin = text[..at].rfind('\n').map_or(0, |i| i + 1);
    let line = text[begin..].lines().next().unwrap_or_default();
    let number = text[..begin].matches('\n').count() + 1;
    let column = text[begin..at].chars().count() + 1;
    let mut end = span.end.clamp(at, begin + line.len().max(at - begin));
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    let width = text[at..end].chars().count().max(1);
    let shown: String = line.chars().map(|c| if c == '\t' { ' ' } else { c }).collect();
    (number, column, shown, width)
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", if self.kind == DiagnosticKind::Note { "note" } else { "error" }, self.message)?;
        let mut indent = 1;
        if let Some(place) = &self.place {
            let path = place.path.display();
            if let Some((number, column, line, width)) = &place.line {
                let label = number.to_string();
                indent = label.len();
                let blank = " ".repeat(indent);
                // A long line is shown around the place.
                let first = if column + width > SHOWN { column.saturating_sub(SHOWN / 2) } else { 0 };
                let part: String = line.chars().skip(first).take(SHOWN).collect();
                let before = column - 1 - first.min(column - 1);
                let marks = "^".repeat((*width).min(SHOWN.saturating_sub(before)).max(1));
                write!(
                    f,
                    "\n{blank}--> {path}:{number}:{column}\n{blank} |\n{label} | {}\n{blank} | {}{marks}",
                    part.trim_end(),
                    " ".repeat(before)
                )?;
            } else {
                write!(f, "\n --> {path}")?;
            }
        }
        if let Some(help) = &self.help {
            for line in help.lines() {
                write!(f, "\n{} = help: {line}", " ".repeat(indent))?;
            }
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_counted_in_characters() {
        let text = "a = 1\r\nµ = \"x\"\n";
        let at = text.find('"').unwrap();
        let shown = Diagnostic::new("m").at(at..at + 3).placed("f".as_ref(), text).to_string();
        assert_eq!(shown, "error: m\n --> f:2:5\n  |\n2 | µ = \"x\"\n  |     ^^^");
    }

    #[test]
    fn any_span_of_any_text_is_shown_in_a_few_lines() {
        for text in ["", "\n", "é", "a\nb", "\n\n", &"x".repeat(5000)] {
            for start in 0..(text.len() + 2).min(40) {
                for end in [0, start, start + 1, text.len(), text.len() + 7] {
                    let shown = Diagnostic::new("m").at(start..end).placed("f".as_ref(), text).to_string();
                    assert!(shown.lines().count() <= 6 && shown.lines().all(|l| l.chars().count() < 140));
                }
            }
        }
    }
}
