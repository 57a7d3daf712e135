//! Labels that several pictures share.

use runs::CsvFile;

/// The normalised force on an axis.
pub(crate) const FORCE: &str = "normalised force $\\bar{F} = F/(E^* h L)$";
/// The normalised stiffness on an axis.
pub(crate) const STIFFNESS: &str = "normalised stiffness $\\bar{k} = k/(1.1419 E^* L)$";
/// The fractal dimension on an axis.
pub(crate) const DIMENSION: &str = "fractal dimension $D_{\\rm{f}}$";

/// A fractal dimension in a legend.
pub(crate) fn dimension(d: f64) -> String {
    format!("$D_{{\\rm{{f}}}} = {d:?}$")
}

/// The title of a table: its first line.
pub(crate) fn title(file: &CsvFile) -> String {
    file.comments.first().cloned().unwrap_or_default()
}

/// Cells and surfaces of a model, from the header that `evaluation::describe` wrote; `None` where the header
/// names none.
pub(crate) fn ensemble(file: &CsvFile, model: &str) -> Option<String> {
    let start = format!("{model}: ");
    let line = file.comments.iter().find_map(|c| c.strip_prefix(&start).filter(|c| c.contains("per D_f")))?;
    let before = |words: &str| {
        let (text, _) = line.split_once(words)?;
        text.rsplit([' ', ',']).next()?.parse::<u64>().ok()
    };
    let count = before(" surfaces per D_f")?;
    let (size, what) = match before(" cells a side") {
        Some(n) => (format!("{n} × {n} cells"), "surfaces"),
        None => (elements(before(" elements")?), "lines"),
    };
    Some(format!("{size}, {count} {what}"))
}

/// [`ensemble`] below a title.
pub(crate) fn subtitle(file: &CsvFile, model: &str) -> String {
    ensemble(file, model).map_or_else(String::new, |e| format!("{e} for each $D_{{\\rm{{f}}}}$"))
}

/// A number of elements; a large power of two as such.
pub(crate) fn elements(n: u64) -> String {
    if n.is_power_of_two() && n > 4096 {
        format!("$2^{{{}}}$ elements", n.ilog2())
    } else {
        format!("{n} elements")
    }
}

/// The value of a flag in the command that made a table.
pub(crate) fn flag<'a>(file: &'a CsvFile, name: &str) -> Option<&'a str> {
    let command = file.comments.iter().find_map(|c| c.strip_prefix("command: "))?;
    command.split_whitespace().skip_while(|w| *w != name).nth(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_name_cells_and_surfaces() {
        let file = CsvFile {
            comments: vec![
                "Fig. 2: curves".into(),
                "bem3d: 2049 cells a side, tolerance 0.001, 60 surfaces per D_f, loads 1e-8:20:29".into(),
                "mdr1d: 1048576 elements, 500 surfaces per D_f, loads 1e-9:20:42".into(),
                "command: cargo xtask reproduce-two-cases --cells 512".into(),
            ],
            columns: Vec::new(),
            rows: Vec::new(),
        };
        assert_eq!(title(&file), "Fig. 2: curves");
        assert!(ensemble(&file, "bem3d").unwrap().starts_with("2049 × 2049 cells, 60 surfaces"));
        assert!(ensemble(&file, "mdr1d").unwrap().starts_with("$2^{20}$ elements, 500 lines"));
        assert_eq!(ensemble(&file, "hertz"), None);
        assert_eq!((flag(&file, "--cells"), flag(&file, "--df")), (Some("512"), None));
    }
}
