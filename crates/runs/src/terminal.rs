//! Text for standard output and standard error. Writing it never panics, its control characters are escaped, and a
//! terminal gets lines that are folded at its width.

use console::Term;
use contact_model::Escaping;
use std::fmt::{self, Arguments, Write as _};
use std::io::{ErrorKind, Write};

/// Characters of a line of prose on a terminal.
const WIDTH: usize = 80;
/// Lines are not folded shorter than this: there would be no room beside the indentation.
const NARROWEST: usize = 40;
/// What a shell reports of a program that SIGPIPE has ended.
const BROKEN_PIPE: i32 = 141;

/// Writes a line to standard output, for programs.
///
/// If nobody reads it any more (`... | head -1`), the process ends quietly with the exit code 141, as if by
/// SIGPIPE. If it cannot be written (a full device), the process ends with a message and the exit code 1.
/// Files are written whole, so that no incomplete file remains.
#[macro_export]
macro_rules! out {
    ($($text:tt)*) => { $crate::print(format_args!("{}\n", format_args!($($text)*))) };
}

/// Writes a line to standard error, for programs; where that is closed or full the line is lost, and the
/// computation continues.
#[macro_export]
macro_rules! err {
    ($($text:tt)*) => { $crate::print_error(format_args!("{}\n", format_args!($($text)*))) };
}

/// [`out!`](crate::out) without the end of the line.
pub fn print(text: Arguments<'_>) {
    let mut out = std::io::stdout().lock();
    if let Err(error) = write_to(&mut out, &Term::stdout(), text).and_then(|()| out.flush()) {
        if error.kind() != ErrorKind::BrokenPipe {
            print_error(format_args!("error: cannot write to standard output: {error}\n"));
            std::process::exit(1);
        }
        std::process::exit(BROKEN_PIPE);
    }
}

/// [`err!`](crate::err) without the end of the line.
pub fn print_error(text: Arguments<'_>) {
    let _ = write_to(&mut std::io::stderr().lock(), &Term::stderr(), text);
}

/// Writes text, folded at the width of the terminal where there is one.
fn write_to(into: &mut dyn Write, terminal: &Term, text: Arguments<'_>) -> std::io::Result<()> {
    if !terminal.is_term() {
        return write(into, text);
    }
    // A terminal may not know its size.
    let columns = terminal.size_checked().map_or(WIDTH, |(_, columns)| columns.into()).max(NARROWEST);
    write(into, format_args!("{}", folded_at(&text.to_string(), columns)))
}

/// Text with lines of at most 80 characters where its words allow it, for a terminal: what is folded goes on
/// below the text of its line, which begins behind a label and two spaces.
///
/// ```
/// let text = format!("  effects  {}\n", "hardness ".repeat(8).trim_end());
/// let folded = runs::folded(&text);
/// assert!(folded.starts_with("  effects  hardness ") && folded.ends_with("hardness\n           hardness\n"));
/// ```
pub fn folded(text: &str) -> String {
    folded_at(text, WIDTH)
}

/// As [`folded`], for another number of characters.
fn folded_at(text: &str, width: usize) -> String {
    text.split_inclusive('\n').map(|line| folded_line(line, width)).collect()
}

fn folded_line(line: &str, width: usize) -> String {
    /// The longest label.
    const LABEL: usize = 32;
    let count = |text: &str| text.chars().count();
    if count(line.trim_end()) <= width {
        return line.to_owned();
    }
    let indent = line.len() - line.trim_start().len();
    let label = line[indent..].find("  ").map(|end| indent + end).filter(|end| *end < LABEL);
    let begin = label.map_or(0, |end| line.len() - line[end..].trim_start().len());
    let hang = if begin > 0 { count(&line[..begin]) } else { indent + 2 };
    let (mut text, rest) = (line[..begin].to_owned(), &line[begin..]);
    let mut used = count(&text);
    for (i, word) in rest.split(' ').enumerate() {
        if i > 0 && used + 1 + count(word.trim_end()) > width {
            text.push('\n');
            text.extend(std::iter::repeat_n(' ', hang));
            used = hang;
        } else if i > 0 {
            text.push(' ');
            used += 1;
        }
        text.push_str(word);
        used += count(word);
    }
    text
}

/// Writes text whose control characters, but for ends of lines and tabs, are written out: names in files,
/// tokens that an error quotes and paths may hold commands of a terminal.
fn write(into: &mut dyn Write, text: Arguments<'_>) -> std::io::Result<()> {
    let mut target = Target { into, failed: None };
    match (Escaping::of_lines(&mut target).write_fmt(text), target.failed) {
        (Ok(()), _) => Ok(()),
        (Err(_), failed) => Err(failed.unwrap_or_else(|| std::io::Error::other("text that cannot be shown"))),
    }
}

/// Bytes as a target of text, which keeps the reason of a failure.
struct Target<'a> {
    into: &'a mut dyn Write,
    failed: Option<std::io::Error>,
}

impl fmt::Write for Target<'_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.into.write_all(text.as_bytes()).map_err(|error| {
            self.failed = Some(error);
            fmt::Error
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_commands_no_terminal() {
        let mut bytes = Vec::new();
        let name = "Height\u{1b}]0;title\u{7}";
        write(&mut bytes, format_args!("channel\t{name}\n{name:?}\r\n")).unwrap();
        let shown = String::from_utf8(bytes).unwrap();
        assert_eq!(shown, "channel\tHeight\\u{1b}]0;title\\u{7}\n\"Height\\u{1b}]0;title\\u{7}\"\\r\n");
        let full = write(&mut [0_u8; 2].as_mut_slice(), format_args!("abc")).unwrap_err();
        assert_eq!(full.kind(), ErrorKind::WriteZero);
    }

    #[test]
    fn long_lines_are_folded_at_spaces() {
        let short = "a\n\n  b  c\n";
        assert_eq!(folded(short), short);
        let words = "word ".repeat(40);
        let long = format!("note: {words}\n    label      {words}\nend");
        let text = folded(&long);
        assert!(text.lines().all(|line| line.trim_end().chars().count() <= 80), "{text}");
        assert!(
            text.contains("\n  word") && text.contains("\n               word") && text.ends_with("\nend")
        );
        assert_eq!(text.split_whitespace().count(), long.split_whitespace().count());
        // What has no spaces stays whole.
        let path = "x".repeat(200);
        assert_eq!(folded(&format!("at {path}\n")), format!("at\n  {path}\n"));
    }
}
