//! One number as text.

use crate::error::{ContentError, NumberKind, Place};
use crate::options::Decimal;

/// Words for a missing height, besides an empty place between two delimiters and `nan`; in lower case.
const MISSING: [&str; 11] =
    ["na", "n/a", "no data", "null", "none", "bad", "nodata", "-", "--", "---", "***"];

/// Words of spreadsheets for a place without a value, which begin with the mark of a comment.
pub(super) const ERRORS: [&str; 9] =
    ["#N/A", "#DIV/0!", "#NAME?", "#NULL!", "#NUM!", "#REF!", "#VALUE!", "#SPILL!", "#CALC!"];

/// Longest text that an error quotes, in characters.
const QUOTED: usize = 32;

impl Decimal {
    /// The number, NaN for a missing one.
    pub(super) fn number(self, token: &[u8], place: Place) -> Result<f64, ContentError> {
        let token = unquoted(token);
        if token.is_empty() {
            return Ok(f64::NAN);
        }
        let text = std::str::from_utf8(token).ok();
        let value = match self {
            Self::Point => text.and_then(parsed),
            Self::Comma if token.contains(&b'.') => None,
            Self::Comma => text.and_then(|t| parsed(&t.replacen(',', ".", 1))),
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

    /// Whether a line is one of a header: it begins with none of the characters of numbers, and has a word
    /// that is none. Empty places before the first word do not count: the first column of a data frame has no
    /// name.
    pub(super) fn is_header(self, line: &[u8]) -> bool {
        let line = line.trim_ascii();
        let first = line.iter().copied().find(|b| !matches!(b, b'"' | b',' | b';')).unwrap_or_default();
        let place = Place::Line { line: 0, value: 0 };
        let number = |token: &[u8]| match self.number(token, place) {
            Err(ContentError::Infinite { .. }) => true,
            read => read.is_ok(),
        };
        let begins = first.is_ascii_digit() || matches!(first, b'+' | b'-' | b'.');
        let mut tokens = line.split(|b| matches!(b, b' ' | b'\t' | b';' | b',' | b'\r'));
        !begins && tokens.any(|token| !number(token))
    }

    fn kind(self, text: Option<&str>) -> NumberKind {
        let Some(text) = text else { return NumberKind::None };
        let number = |t: &str| t.parse::<f64>().is_ok();
        if text.split_ascii_whitespace().count() > 1 && text.split_ascii_whitespace().all(number) {
            NumberKind::Two
        } else if self == Self::Point && text.contains(',') && number(&text.replacen(',', ".", 1)) {
            NumberKind::DecimalComma
        } else {
            NumberKind::None
        }
    }
}

/// A token without the quotes around it.
pub(super) fn unquoted(token: &[u8]) -> &[u8] {
    match token {
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        token => token,
    }
}

/// A number, also with a minus sign of Unicode or the exponent of Fortran's double precision, `1.0D-3`.
fn parsed(text: &str) -> Option<f64> {
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let other = |c: char| matches!(c, 'd' | 'D' | '\u{2212}');
    let number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-' | 'e' | 'E') || other(c);
    let is_number = text.contains(other) && text.chars().all(number);
    is_number.then(|| text.replace('\u{2212}', "-").replace(['d', 'D'], "e").parse().ok())?
}

/// Words, and what the C libraries of Microsoft print: `1.#QNAN`, `-1.#IND`, `nan(ind)`.
fn missing(text: &str) -> bool {
    let lower = text.to_ascii_lowercase();
    let of_library = || {
        let (digits, word) = lower.trim_start_matches(['+', '-']).split_once(".#")?;
        let known = matches!(word.trim_end_matches('0'), "qnan" | "snan" | "ind" | "inf" | "nan");
        (known && digits.bytes().all(|b| b.is_ascii_digit())).then_some(())
    };
    let with_brackets = lower.trim_start_matches(['+', '-']).starts_with("nan(") && lower.ends_with(')');
    let of_spreadsheet = || ERRORS.iter().any(|word| word.eq_ignore_ascii_case(text));
    with_brackets || of_library().is_some() || MISSING.contains(&&*lower) || of_spreadsheet()
}

fn wrong(token: &[u8], place: Place, kind: NumberKind) -> ContentError {
    // Four bytes are the longest character.
    let shown = String::from_utf8_lossy(&token[..token.len().min(4 * QUOTED)]);
    ContentError::Number { place, text: shown.chars().take(QUOTED).collect(), kind }
}
