//! The README of each crate, generated from the front page of its documentation.

use super::sources::Package;

/// The page, with links to items as plain text, headings one level deeper, and examples as they read.
pub fn readme(package: &Package) -> String {
    let mut text = format!("# {}\n\n", package.registered);
    let mut prose = String::new();
    // Whether a block of code is open, and whether it is Rust.
    let mut code = None;
    for line in package.front_page.lines() {
        match code {
            None if line.starts_with("```") => {
                text += &plain(&std::mem::take(&mut prose));
                let language = &line[3..];
                let rust = ["", "rust", "no_run", "ignore", "should_panic"].contains(&language);
                text.push_str(&["```", if rust { "rust" } else { language }, "\n"].concat());
                code = Some(rust);
            }
            None => {
                let deeper = if line.starts_with('#') { "#" } else { "" };
                prose.push_str(&[deeper, line, "\n"].concat());
            }
            Some(_) if line == "```" => {
                text += "```\n";
                code = None;
            }
            Some(rust) => {
                if !(rust && (line == "#" || line.starts_with("# "))) {
                    text += line;
                    text.push('\n');
                }
            }
        }
    }
    text += &plain(&prose);
    text + "\nThis is the front page of the crate's documentation. The crate is part of\n\
            [fractal-contact](../../README.md).\n"
}

/// Text without links, except those to other sites.
pub fn plain(text: &str) -> String {
    let mut found = String::new();
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        if c == '`' {
            let end = rest[1..].find('`').map_or(rest.len(), |end| end + 2);
            found += &rest[..end];
            rest = &rest[end..];
        } else if let Some((words, after)) = linked(rest) {
            found += words;
            rest = after;
        } else {
            found.push(c);
            rest = &rest[c.len_utf8()..];
        }
    }
    found
}

/// The words of a link to an item at the beginning of a text, and what follows the link.
fn linked(text: &str) -> Option<(&str, &str)> {
    let inside = text.strip_prefix('[')?;
    let (mut code, mut end) = (false, None);
    for (at, c) in inside.char_indices() {
        match c {
            '`' => code = !code,
            ']' if !code => {
                end = Some(at);
                break;
            }
            _ => {}
        }
    }
    let (words, after) = (&inside[..end?], &inside[end? + 1..]);
    if let Some(destination) = after.strip_prefix('(') {
        let (destination, after) = destination.split_once(')')?;
        return (!destination.contains("://")).then_some((words, after));
    }
    (words.starts_with('`') && words.ends_with('`')).then_some((words, after))
}

#[test]
fn links_to_items_become_plain_text() {
    let text = "[`A::b`] of [all](crate::all), `[c]`, [0, 1] and [that](https://e.org).";
    assert_eq!(plain(text), "`A::b` of all, `[c]`, [0, 1] and [that](https://e.org).");
}
