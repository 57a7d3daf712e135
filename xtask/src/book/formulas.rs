//! Checks the formulas of every Markdown file with KaTeX: blocks fenced as `math`, and code between two
//! dollar signs.

use super::links;
use runs::{Error, Result};
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};

/// A formula in TeX.
#[derive(Debug, PartialEq)]
struct BookFormula {
    /// Line of its beginning.
    line: usize,
    source: String,
    /// On lines of its own.
    display: bool,
}

/// The result of a check.
pub struct FormulaCheck {
    /// Formulas read.
    pub formulas: usize,
    /// Whether node was installed, so that they were checked.
    pub set: bool,
    /// `file:line: what is wrong`.
    pub wrong: Vec<String>,
}

/// Sets every formula below a root with the KaTeX that the pages use, where node is installed.
pub fn check(root: &Path) -> Result<FormulaCheck> {
    let mut found = FormulaCheck { formulas: 0, set: false, wrong: Vec::new() };
    let mut input = String::new();
    for path in links::markdown(root)? {
        let text = fs::read_to_string(&path).map_err(Error::file("read", &path))?;
        let name = path.strip_prefix(root).unwrap_or(&path).display();
        for BookFormula { line, source, display } in formulas(&text) {
            found.formulas += 1;
            let display = if display { "display" } else { "" };
            input.push_str(&[&format!("{name}:{line}"), source.as_str(), display, ""].join("\0"));
        }
    }
    let node = Path::new("node");
    let failed = || Error::file("run", node);
    let mut command = Command::new(node);
    command.arg(root.join("book/check-formulas.js")).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = match command.spawn() {
        Ok(child) => child,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(found),
        Err(source) => return Err(failed()(source)),
    };
    // The script reads everything before it prints.
    if let Some(mut stdin) = child.stdin.take() {
        stdin.write_all(input.as_bytes()).map_err(failed())?;
    }
    let output = child.wait_with_output().map_err(failed())?;
    if !output.status.success() {
        return Err(Error::content(node, "book/check-formulas.js failed"));
    }
    found.set = true;
    found.wrong = String::from_utf8_lossy(&output.stdout).lines().map(str::to_owned).collect();
    Ok(found)
}

fn formulas(text: &str) -> Vec<BookFormula> {
    let (mut found, mut prose) = (Vec::new(), String::new());
    // The language of the fence that is open.
    let mut fence: Option<&str> = None;
    for (number, line) in text.lines().enumerate() {
        let bare = line.trim();
        match (fence, bare.strip_prefix("```")) {
            (None, Some(language)) => {
                fence = Some(language);
                if language == "math" {
                    found.push(BookFormula { line: number + 1, source: String::new(), display: true });
                }
            }
            (Some(_), Some("")) => fence = None,
            (Some("math"), _) => {
                if let Some(formula) = found.last_mut() {
                    formula.source += line;
                    formula.source.push('\n');
                }
            }
            (Some(_), _) => {}
            (None, None) => prose += line,
        }
        prose.push('\n');
    }
    found.extend(inline(&prose));
    found.sort_by_key(|formula| formula.line);
    found
}

/// Spans of code within a paragraph that stand between two dollar signs.
fn inline(prose: &str) -> Vec<BookFormula> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(begin) = prose[at..].find('`').map(|i| at + i) {
        let ticks = prose[begin..].len() - prose[begin..].trim_start_matches('`').len();
        let inside = begin + ticks;
        let paragraph = prose[inside..].find("\n\n").map_or(prose.len(), |i| inside + i);
        // A span ends with as many backticks as it begins with.
        let mut end = None;
        let mut from = inside;
        while let Some(i) = prose[from..paragraph].find('`').map(|i| from + i) {
            let run = prose[i..].len() - prose[i..].trim_start_matches('`').len();
            if run == ticks {
                end = Some(i);
                break;
            }
            from = i + run;
        }
        let Some(end) = end else {
            at = inside;
            continue;
        };
        at = end + ticks;
        if ticks == 1 && prose[..begin].ends_with('$') && prose[at..].starts_with('$') {
            let line = prose[..begin].matches('\n').count() + 1;
            let row = prose.lines().nth(line - 1).is_some_and(|line| line.starts_with('|'));
            let source = prose[inside..end].to_owned();
            // In a table a bar is written with a backslash.
            let source = if row { source.replace("\\|", "|") } else { source };
            found.push(BookFormula { line, source, display: false });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_blocks_and_code_between_dollar_signs() {
        let text = "a $`x^2`$, `$` and `$y`\n\n```math\nk = 2 E^* a\n```\n```sh\n$`no`$\n```\n| $`\\|z\\|`$ |\n`` $`no`$ ``\n";
        let formula = |line, source: &str, display| BookFormula { line, source: source.into(), display };
        let expected =
            [formula(1, "x^2", false), formula(3, "k = 2 E^* a\n", true), formula(9, "|z|", false)];
        assert_eq!(formulas(text), expected);
    }
}
