//! Comments at the end of lines.

use super::number;

/// The data of a line and its comment.
pub(super) fn without_comment(line: &[u8]) -> (&[u8], Option<&[u8]>) {
    // A mark inside a word is none: `1.#QNAN`, `#N/A`.
    let begins = |&at: &usize| {
        matches!(line[at], b'#' | b'%')
            && (at == 0 || line[at - 1].is_ascii_whitespace())
            && !number::ERRORS.iter().any(|word| starts_with(&line[at..], word))
    };
    match (0..line.len()).find(begins) {
        Some(at) => (line[..at].trim_ascii(), Some(&line[at + 1..])),
        None => (line, None),
    }
}

fn starts_with(line: &[u8], word: &str) -> bool {
    line.get(..word.len()).is_some_and(|first| first.eq_ignore_ascii_case(word.as_bytes()))
}
