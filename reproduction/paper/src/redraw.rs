//! Pictures drawn again from tables, without solving anything.

use crate::{curves, fig1, fig3, fig4, fig5, fig7, partial_slip, two_cases};
use runs::{Error, Result};
use std::path::{Path, PathBuf};

/// Tables of other runs that some pictures show as well.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Beside {
    /// A table of the same figure on a coarser grid, drawn below the curves of Fig. 2 or 6.
    pub over: Option<PathBuf>,
    /// A table of Fig. 2 on a finer grid, whose fitted laws are drawn in Figs. 3 and 7.
    pub finer: Option<PathBuf>,
}

/// Draws every picture of a directory again from the tables there: those of the figures, of the two cases, of
/// the study of accuracy (with its text) and of benches that have a picture. The tables are not changed.
///
/// # Errors
/// [`Error::File`] for a directory without such a table, for a table that cannot be read, and for pictures that cannot be written.
pub fn redraw(directory: &Path, beside: &Beside) -> Result<Vec<PathBuf>> {
    let over = beside.over.as_deref();
    let finer = beside.finer.as_deref();
    let mut files = Vec::new();
    for name in ["fig1", "fig2", "fig3", "fig4", "fig5", "fig6", "fig7", two_cases::NAME] {
        let csv = directory.join(format!("{name}.csv"));
        if !csv.exists() {
            continue;
        }
        files.extend(match name {
            "fig1" => fig1::draw(&csv, directory)?,
            "fig2" | "fig6" => curves::draw(name, &csv, over, directory)?,
            "fig3" => fig3::FIGURE.draw(&csv, finer, directory)?,
            "fig4" => fig4::draw(&csv, directory)?,
            "fig5" => fig5::draw(&csv, directory)?,
            "fig7" => fig7::FIGURE.draw(&csv, finer, directory)?,
            _ => two_cases::draw(&csv, directory)?,
        });
    }
    if directory.join("accuracy-cost.csv").exists() {
        files.extend(crate::evaluation::redraw_accuracy(directory)?);
    }
    files.extend(crate::evaluation::redraw_benches(directory)?);
    if directory.join("exponent.csv").exists() {
        files.extend(crate::draw_exponent(directory)?);
    }
    if directory.join(partial_slip::SLIPS).exists() {
        files.extend(partial_slip::draw_partial_slip(directory)?);
    }
    if directory.join(partial_slip::GRIDS).exists() {
        files.extend(partial_slip::draw_partial_slip_grids(directory)?);
    }
    if files.is_empty() {
        return Err(Error::content(directory, "no table that a picture is drawn from"));
    }
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    const COMMITTED: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");

    fn copied(folder: &str, tables: &[&str]) -> tempfile::TempDir {
        let dir = tempfile::tempdir().unwrap();
        for table in tables {
            fs::copy(format!("{COMMITTED}/{folder}/{table}"), dir.path().join(table)).unwrap();
        }
        dir
    }

    fn labels(files: &[PathBuf], name: &str) -> String {
        let svg = files.iter().find(|f| f.ends_with(format!("{name}.svg"))).unwrap();
        let text = fs::read_to_string(svg).unwrap();
        assert!(text.starts_with("<svg") && text.ends_with("</svg>\n") && !text.contains("NaN"), "{name}");
        text
    }

    #[test]
    fn committed_figures_are_drawn_whole_and_their_tables_stay() {
        let dir = copied("figures/paper", &["fig2.csv", "fig3.csv", "fig4.csv", "fig6.csv", "fig7.csv"]);
        let before = fs::read(dir.path().join("fig3.csv")).unwrap();
        let finer = Path::new(COMMITTED).join("figures/extended/fig2.csv");
        let files = redraw(dir.path(), &Beside { over: None, finer: Some(finer) }).unwrap();
        assert_eq!(files.len(), 10);
        assert!(files.iter().all(|f| fs::metadata(f).unwrap().len() > 5000));
        let two = labels(&files, "fig2");
        for d in ["2.0", "2.2", "2.4", "2.6", "2.8", "3.0"] {
            assert!(two.contains(&format!("aria-label=\"D_f = {d}\"")), "{d}");
        }
        assert!(two.contains("2049 × 2049 cells, 60 surfaces") && two.contains("standard errors"));
        assert!(labels(&files, "fig6").contains("contact elements"));
        assert!(labels(&files, "fig3").contains("16385 × 16385 cells, 4 surfaces"));
        assert_eq!(fs::read(dir.path().join("fig3.csv")).unwrap(), before);
    }

    #[test]
    fn studies_and_benches_are_drawn_and_an_empty_directory_is_named() {
        let dir = copied("figures/two-cases", &["two-cases.csv"]);
        let files = redraw(dir.path(), &Beside::default()).unwrap();
        assert_eq!(files.len(), 4);
        let text = labels(&files, "two-cases-ratio");
        assert!(
            text.contains("aria-label=\"Persson\"")
                && text.contains("aria-label=\"Greenwood and Williamson\"")
        );

        let dir = copied("bench", &["scaling.csv", "single.csv"]);
        assert!(redraw(dir.path(), &Beside::default()).unwrap_err().to_string().contains("no table"));
        fs::write(dir.path().join("scaling.png"), b"old").unwrap();
        let files = redraw(dir.path(), &Beside::default()).unwrap();
        assert!(labels(&files, "scaling").contains("aria-label=\"4097\""));
    }
}
