//! The length of the pages of the book.

use super::{BEGIN, END, root, without_formulas};

/// Largest number of words of a page, so that it can be read in one sitting.
const WORDS: usize = 1500;

/// Pages that are tables made by a program.
const GENERATED: [&str; 3] = ["models.md", "modules.md", "quantities.md"];

/// Words outside of blocks of code, of formulas and of generated parts.
fn words(text: &str) -> usize {
    let (mut code, mut generated, mut count) = (false, false, 0);
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            code = !code;
        } else if line.starts_with(BEGIN) {
            generated = true;
        } else if line.starts_with(END) {
            generated = false;
        } else if !code && !generated {
            let line = without_formulas(line);
            count += line.split_whitespace().filter(|word| word.contains(char::is_alphanumeric)).count();
        }
    }
    count
}

#[test]
fn pages_are_short() {
    let mut long = Vec::new();
    for page in super::sources::files(&root().join("book/src"), ".md") {
        let name = page.file_name().unwrap().to_string_lossy().into_owned();
        let count = words(&std::fs::read_to_string(&page).unwrap());
        if count > WORDS && !GENERATED.contains(&name.as_str()) {
            long.push(format!("{name}: {count}"));
        }
    }
    assert!(long.is_empty(), "pages of more than {WORDS} words: {long:#?}");
}
