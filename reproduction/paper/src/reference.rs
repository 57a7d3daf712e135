//! Compares a small run with stored numbers, for continuous integration.

use crate::evaluation::{Request, Run};
use crate::{fig2, fig6};
use runs::{CsvFile, Error, Progress, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Largest relative difference of a stored number. The 3D solves have the tolerance 1e-10, and k follows it;
/// another processor or version of the transform library moves last digits.
pub const RELATIVE: f64 = 1e-6;

/// Columns that are compared as numbers; all others must be equal.
const NUMBERS: [&str; 6] = [
    "force_bar",
    "stiffness_bar",
    "stiffness_bar_se",
    "stiffness_bar_log_mean",
    "contact_fraction",
    "approach_over_h",
];

/// The fixed small run: under half a minute on two cores.
fn small(out: PathBuf) -> Result<Run> {
    Run::new(&Request {
        cells: Some(65),
        surfaces: Some(4),
        elements: Some(1 << 13),
        lines: Some(10),
        forces: Some("1e-3:20:10,0.086,1".to_owned()),
        tolerance: Some(1e-10),
        fresh: true,
        out: Some(out),
        ..Request::default()
    })
}

/// Runs Figs. 2 and 6 at a small fixed size in `scratch` and compares with `reference/quick-fig2.csv` and
/// `quick-fig6.csv`; with `bless` it rewrites those instead. Returns one line per difference.
///
/// # Errors
/// Errors of a figure; a reference file that is missing or not a table.
pub fn check_reference(
    reference: &Path,
    scratch: &Path,
    bless: bool,
    progress: &dyn Progress,
) -> Result<Vec<String>> {
    let run = small(scratch.to_owned())?;
    let mut differences = Vec::new();
    for outcome in [fig2(&run, progress)?, fig6(&run, progress)?] {
        if outcome.not_converged > 0 {
            differences.push(format!("{}: {} solves not converged", outcome.name, outcome.not_converged));
        }
        let fresh = scratch.join(format!("{}.csv", outcome.name));
        let stored = reference.join(format!("quick-{}.csv", outcome.name));
        if bless {
            runs::files::create_directory(reference)?;
            let bytes = fs::read(&fresh).map_err(Error::file("read", &fresh))?;
            runs::files::write_whole(&stored, &bytes)?;
        } else {
            differences.extend(compare(outcome.name, &CsvFile::read(&stored)?, &CsvFile::read(&fresh)?));
        }
    }
    Ok(differences)
}

fn compare(name: &str, stored: &CsvFile, fresh: &CsvFile) -> Vec<String> {
    if stored.columns != fresh.columns || stored.rows.len() != fresh.rows.len() {
        return vec![format!(
            "{name}: {} rows of {:?} stored, {} rows of {:?} here",
            stored.rows.len(),
            stored.columns,
            fresh.rows.len(),
            fresh.columns
        )];
    }
    let mut differences = Vec::new();
    for (i, (a, b)) in stored.rows.iter().zip(&fresh.rows).enumerate() {
        for (column, (a, b)) in stored.columns.iter().zip(a.iter().zip(b)) {
            let same = match (a.parse::<f64>(), b.parse::<f64>()) {
                (Ok(x), Ok(y)) if NUMBERS.contains(&column.as_str()) => {
                    (x - y).abs() <= RELATIVE * x.abs().max(y.abs())
                }
                _ => a == b,
            };
            if !same {
                differences.push(format!("{name}, row {}: {column} {a} stored, {b} here", i + 1));
            }
        }
    }
    differences
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_digits_may_differ_and_nothing_else() {
        let file = |k: &str, status: &str| CsvFile {
            comments: vec![],
            columns: vec!["stiffness_bar".into(), "below_floor".into()],
            rows: vec![vec![k.into(), status.into()]],
        };
        let stored = file("0.5", "true");
        assert_eq!(compare("f", &stored, &file("0.50000001", "true")), Vec::<String>::new());
        assert_eq!(
            compare("f", &stored, &file("0.51", "true")),
            ["f, row 1: stiffness_bar 0.5 stored, 0.51 here"]
        );
        assert_eq!(compare("f", &stored, &file("0.5", "false")).len(), 1);
        assert_eq!(compare("f", &stored, &file("", "true")).len(), 1);
        let shorter = CsvFile { rows: vec![], ..stored.clone() };
        assert_eq!(compare("f", &stored, &shorter).len(), 1);
    }
}
