//! One number as text.

use crate::error::{ContentError, NumberKind, Place};
use crate::options::Decimal;

/// Words for a missing height, besides an empty place between two delimiters and `nan`; in lower case.
const MISSING: [&str; 10] = ["na", "n/a", "null", "none", "bad", "nodata", "-", "--", "---", "***"];

/// Longest text that an error quotes, in characters.
const QUOTED: usize = 32;

/// How numbers are read.
#[derive(Debug, Clone, Copy)]
pub(super) struct Numbers {
    pub(super) decimal: Decimal,
}

impl Numbers {
    /// The number, NaN for a missing one.
    pub(super) fn read(self, token: &[u8], place: Place) -> Result<f64, ContentError> {
        if token.is_empty() {
            return Ok(f64::NAN);
        }
        let text = std::str::from_utf8(token).ok();
        let value = match self.decimal {
            Decimal::Point => text.and_then(|t| t.parse::<f64>().ok()),
            Decimal::Comma if token.contains(&b'.') => None,
            Decimal::Comma => text.and_then(|t| t.replacen(',', ".", 1).parse().ok()),
        };
        match value {
            Some(value) if value.is_infinite() && token.iter().any(u8::is_ascii_digit) => {
                Err(wrong(token, place, NumberKind::TooLarge))
            }
            Some(value) if value.is_infinite() => Err(ContentError::Infinite { place, value }),
            Some(value) => Ok(value),
            None if text.is_some_and(missing) => Ok(f64::NAN),
            None => Err(wrong(token, place, self.kind(text))),
        }
    }

    /// Whether a line is one of a header: it begins with none of the characters of numbers, and has a word that is none.
    pub(super) fn is_header(self, line: &[u8]) -> bool {
        let line = line.trim_ascii();
        let first = line.first().copied().unwrap_or_default();
        let place = Place::Line { line: 0, value: 0 };
        let number = |token: &[u8]| match self.read(token, place) {
            Err(ContentError::Infinite { .. }) => true,
            read => read.is_ok(),
        };
        let begins = first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.' | b',' | b';');
        let mut tokens = line.split(|b| matches!(b, b' ' | b'\t' | b';' | b',' | b'\r'));
        !begins && tokens.any(|token| !number(token))
    }

    fn kind(self, text: Option<&str>) -> NumberKind {
        let Some(text) = text else { return NumberKind::None };
        let number = |t: &str| t.parse::<f64>().is_ok();
        if text.split_ascii_whitespace().count() > 1 && text.split_ascii_whitespace().all(number) {
            NumberKind::Two
        } else if self.decimal == Decimal::Point && text.contains(',') && number(&text.replacen(',', ".", 1))
        {
            NumberKind::DecimalComma
        } else {
            NumberKind::None
        }
    }
}

fn missing(text: &str) -> bool {
    MISSING.iter().any(|word| word.eq_ignore_ascii_case(text))
}

fn wrong(token: &[u8], place: Place, kind: NumberKind) -> ContentError {
    // Four bytes are the longest character.
    let shown = String::from_utf8_lossy(&token[..token.len().min(4 * QUOTED)]);
    ContentError::Number { place, text: shown.chars().take(QUOTED).collect(), kind }
}
