//! Words that only this project would understand are refused in everything that a reader is given to read.

use super::names::documents;
use super::root;
use super::sources::files;
use std::path::PathBuf;

/// A private word or phrase in small letters, and what to write instead. A `#` stands for a digit.
const PRIVATE: [(&str, &str); 30] = [
    ("this page answers", "begin with the question and its answer"),
    ("surfaces of #.#", "surfaces with D_f = #.#"),
    ("surface of #.#", "a surface with D_f = #.#"),
    ("lines of #.#", "lines with D_f = #.#"),
    ("line of #.#", "a line with D_f = #.#"),
    ("by chance #", "p = #"),
    ("the grid leaves", "the discretisation error is"),
    ("finest grid leaves", "the remaining discretisation error"),
    ("told", "reported, printed, named"),
    ("held area", "fixed contact area"),
    ("counted area", "area of the cells in contact"),
    ("counted areas", "areas of the cells in contact"),
    ("area counted", "area of the cells in contact"),
    ("areas counted", "areas of the cells in contact"),
    ("asked for", "requested, prescribed"),
    ("so many", "the number, or its symbol"),
    ("what touches", "the cells in contact, or their number"),
    ("what lies apart", "the open cells"),
    ("what neither", "name the thing that is missing"),
    ("confirmed at none", "neither excluded nor confirmed"),
    ("nothing was expected", "we had predicted nothing"),
    ("it is exact zeros", "the residuals vanish"),
    ("from a state further apart", "started further apart"),
    ("without a positive one", "whose stability is zero or negative"),
    ("a factor from the attached share", "scaled by the share of attached cells"),
    ("comes nearer by", "multiplies the error by"),
    ("to a minimum, by its square", "of second order"),
    ("do not lower that of", "do not reduce the error of"),
    ("lets heights be seen", "the lateral resolution of the tip"),
    ("until the jump has gone on", "until the contact has jumped"),
];

/// Good English that contains one of them.
const ALLOWED: [&str; 3] = ["told apart", "be told that", "not so many"];

/// Whether the phrase stands in the text as whole words.
fn holds(text: &str, phrase: &str) -> bool {
    let (text, phrase): (Vec<char>, Vec<char>) = (text.chars().collect(), phrase.chars().collect());
    let word = |at: Option<&char>| at.is_some_and(|c| c.is_alphanumeric());
    text.windows(phrase.len()).enumerate().any(|(at, part)| {
        let same = |(found, wanted): (&char, &char)| match wanted {
            '#' => found.is_ascii_digit(),
            _ => found == wanted,
        };
        let before = at > 0 && word(text.get(at - 1));
        part.iter().zip(&phrase).all(same) && !before && !word(text.get(at + phrase.len()))
    })
}

/// The prose of a document in paragraphs: small letters, lines joined, without code and without quoted names.
/// Each has the number of its first line.
fn paragraphs(text: &str) -> Vec<(usize, String)> {
    let (mut code, mut found) = (false, vec![(1, String::new())]);
    for (number, line) in text.lines().enumerate() {
        let fence = line.trim_start().starts_with("```");
        code ^= fence;
        let apart = line.trim().is_empty() || line.starts_with(['|', '#', '-']) || fence;
        if apart {
            found.push((number + 1, String::new()));
        }
        if !code && !fence {
            let prose: String = line.split('`').step_by(2).collect::<Vec<_>>().join("`");
            let paragraph = &mut found.last_mut().unwrap().1;
            *paragraph += &(prose.trim().to_lowercase() + " ");
        }
    }
    found
}

/// The private phrases of a text: line of the paragraph, phrase, and what to write instead.
fn private(text: &str) -> Vec<(usize, &'static str, &'static str)> {
    let mut found = Vec::new();
    for (line, mut paragraph) in paragraphs(text) {
        for allowed in ALLOWED {
            paragraph = paragraph.replace(allowed, "");
        }
        let here = PRIVATE.iter().filter(|(phrase, _)| holds(&paragraph, phrase));
        found.extend(here.map(|&(phrase, instead)| (line, phrase, instead)));
    }
    found
}

#[test]
fn a_phrase_is_found_across_lines_and_not_in_code() {
    let found = |text| private(text).into_iter().map(|(line, phrase, _)| (line, phrase)).collect::<Vec<_>>();
    assert_eq!(found("One.\n\nThe force that is asked\nfor."), [(2, "asked for")]);
    assert_eq!(found("Lines of 2.4 differ."), [(1, "lines of #.#")]);
    assert_eq!(found("```\nasked for\n```\n`told` apart from tolds, told apart"), []);
}

#[test]
fn documents_have_no_private_words() {
    let mut pages: Vec<PathBuf> = documents();
    pages.extend(["SECURITY.md", "data/scenes/README.md", "data/measured/README.md"].map(|f| root().join(f)));
    for folder in ["data/accuracy", "data/bench", "data/exponent", "data/figures", "data/partial-slip"] {
        // Hypotheses stay as they were written before the run.
        let written_before = |page: &PathBuf| page.ends_with("hypotheses.md");
        pages.extend(files(&root().join(folder), ".md").into_iter().filter(|page| !written_before(page)));
    }
    let mut faults = Vec::new();
    for page in pages {
        let text = std::fs::read_to_string(&page).unwrap();
        let page = page.display();
        let shown = |(line, phrase, instead)| format!("{page}:{line}: \"{phrase}\" (write: {instead})");
        faults.extend(private(&text).into_iter().map(shown));
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
