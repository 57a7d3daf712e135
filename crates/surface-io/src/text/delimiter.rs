//! What stands between the numbers of a line.

use crate::options::Decimal;
use std::fmt;

/// Delimiter between two numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delimiter {
    Whitespace,
    Tab,
    Comma,
    Semicolon,
}

impl Delimiter {
    /// The delimiter of a line of data: a semicolon if there is one, else a tab, else a comma, else
    /// whitespace.
    pub(super) fn of(line: &[u8], decimal: Decimal) -> Self {
        if line.contains(&b';') {
            Self::Semicolon
        } else if line.contains(&b'\t') {
            Self::Tab
        } else if line.contains(&b',') && decimal == Decimal::Point {
            Self::Comma
        } else {
            Self::Whitespace
        }
    }

    /// What stands between the delimiters of a line, each without spaces around it.
    pub(super) fn tokens(self, data: &[u8]) -> impl Iterator<Item = &[u8]> {
        let (spaces, byte) = (self == Self::Whitespace, self.byte());
        let between = move |b: &u8| if spaces { b.is_ascii_whitespace() } else { *b == byte };
        data.split(between).map(<[u8]>::trim_ascii).filter(move |token| !(spaces && token.is_empty()))
    }

    pub(super) fn byte(self) -> u8 {
        match self {
            Self::Whitespace => b' ',
            Self::Tab => b'\t',
            Self::Comma => b',',
            Self::Semicolon => b';',
        }
    }
}

impl fmt::Display for Delimiter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Whitespace => "spaces between numbers",
            Self::Tab => "tabs between numbers",
            Self::Comma => "commas between numbers",
            Self::Semicolon => "semicolons between numbers",
        })
    }
}
