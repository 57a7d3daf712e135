//! Text out of files, made safe to show: no part of it can act as a command of a terminal.

use std::fmt::{self, Write};

/// Writes text with its control characters and marks of direction escaped, such as `\u{1b}` for the byte that
/// begins a command of a terminal.
///
/// ```
/// use std::fmt::Write as _;
/// let mut shown = String::new();
/// write!(contact_model::Escaping::of_line(&mut shown), "{}", "Height\u{1b}[2J\n").unwrap();
/// assert_eq!(shown, "Height\\u{1b}[2J\\n");
/// ```
#[derive(Debug)]
pub struct Escaping<W> {
    into: W,
    /// Whether ends of lines and tabs are escaped too.
    line: bool,
}

impl<W: Write> Escaping<W> {
    /// For text that belongs on one line: a name, a path, a message.
    pub fn of_line(into: W) -> Self {
        Self { into, line: true }
    }

    /// For text that has lines and tabs of its own.
    pub fn of_lines(into: W) -> Self {
        Self { into, line: false }
    }

    fn commands(&self, c: char) -> bool {
        match c {
            '\n' | '\t' => self.line,
            // Marks of direction, and ends of lines of Unicode.
            '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => true,
            c => c.is_control(),
        }
    }
}

impl<W: Write> Write for Escaping<W> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        let mut rest = text;
        while let Some((at, c)) = rest.char_indices().find(|(_, c)| self.commands(*c)) {
            self.into.write_str(&rest[..at])?;
            match c {
                '\n' | '\r' | '\t' => write!(self.into, "{}", c.escape_default())?,
                c => write!(self.into, "{}", c.escape_unicode())?,
            }
            rest = &rest[at + c.len_utf8()..];
        }
        self.into.write_str(rest)
    }
}

/// A name as it is shown, escaped as by [`Escaping::of_line`].
pub fn escaped(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    // A String takes everything.
    let _ = Escaping::of_line(&mut shown).write_str(text);
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_that_commands_a_terminal_passes() {
        let text = "a\u{1b}[31mb\u{9b}2Jc\r\nd\te\u{7f}\u{202e}f\0\u{2028} µm \"é\" \\";
        assert_eq!(
            escaped(text),
            "a\\u{1b}[31mb\\u{9b}2Jc\\r\\nd\\te\\u{7f}\\u{202e}f\\u{0}\\u{2028} µm \"é\" \\"
        );
        let mut lines = String::new();
        Escaping::of_lines(&mut lines).write_str("1\t2\n\u{7}3\r\n").unwrap();
        assert_eq!(lines, "1\t2\n\\u{7}3\\r\n");
    }
}
