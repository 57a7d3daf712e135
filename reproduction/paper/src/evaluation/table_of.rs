//! Tables whose columns define their values, and reading rows back.

use contact_model::{Column, Table, Value};
use csv::StringRecord;
use runs::{CsvFile, Error, Result, number};
use serde::de::DeserializeOwned;
use std::path::Path;

/// A table with one row for each item, built column by column from name, unit, meaning and value.
///
/// ```
/// use paper::evaluation::TableOf;
/// let table = TableOf::new("Squares", &[1.0, 2.0])
///     .column("x", "L", "side", |x| *x)
///     .column("area", "L^2", "its square", |x| x * x)
///     .table()?;
/// assert_eq!(table.rows()[1], [2.0.into(), 4.0.into()]);
/// # Ok::<(), paper::evaluation::Error>(())
/// ```
#[derive(Debug)]
pub struct TableOf<'a, T> {
    title: String,
    items: &'a [T],
    columns: Vec<Column>,
    rows: Vec<Vec<Value>>,
}

impl<'a, T> TableOf<'a, T> {
    /// A table without columns.
    pub fn new(title: impl Into<String>, items: &'a [T]) -> Self {
        Self { title: title.into(), items, columns: Vec::new(), rows: vec![Vec::new(); items.len()] }
    }

    /// Adds a column, as in [`Column`], with its value for each item.
    #[must_use]
    pub fn column<V: Into<Value>>(
        mut self,
        name: &'static str,
        unit: &'static str,
        meaning: &'static str,
        value: impl Fn(&'a T) -> V,
    ) -> Self {
        self.columns.push(Column { name, unit, meaning });
        for (row, item) in self.rows.iter_mut().zip(self.items) {
            row.push(value(item).into());
        }
        self
    }

    /// The finished table.
    ///
    /// # Errors
    /// [`Error::Model`] for a number that is not finite.
    pub fn table(self) -> Result<Table> {
        let mut table = Table::new(self.title.clone(), self.columns);
        for row in self.rows {
            table.push(row).map_err(Error::model(self.title.as_str()))?;
        }
        Ok(table)
    }
}

/// The names of columns that stand beside something else.
pub(crate) const fn names<T, const N: usize>(columns: &[(&'static str, T); N]) -> [&'static str; N] {
    let mut names = [""; N];
    let mut i = 0;
    while i < N {
        names[i] = columns[i].0;
        i += 1;
    }
    names
}

/// Rows of a table in Markdown, from their cells.
pub fn markdown_rows<C: AsRef<str>, const N: usize>(rows: impl IntoIterator<Item = [C; N]>) -> String {
    // A bar inside a cell would end it.
    let escaped = |cells: [C; N]| cells.map(|cell| cell.as_ref().replace('|', "\\|"));
    rows.into_iter().map(|cells| format!("| {} |\n", escaped(cells).join(" | "))).collect()
}

/// A table in Markdown: its two first lines, and the cells of each row.
pub fn markdown_table<C: AsRef<str>, const N: usize>(
    head: &str,
    rows: impl IntoIterator<Item = [C; N]>,
) -> String {
    format!("{head}\n{}", markdown_rows(rows))
}

/// A number as text; empty where it is missing.
pub(crate) fn maybe(value: Option<f64>) -> String {
    value.map(number).unwrap_or_default()
}

/// The rows of a CSV file, read by the names of the columns.
///
/// # Errors
/// [`Error::File`] for a column that is missing or an entry that does not fit it.
pub fn read_rows<T: DeserializeOwned>(path: &Path, file: &CsvFile) -> Result<Vec<T>> {
    let names = StringRecord::from(file.columns.as_slice());
    let row = |row: &Vec<String>| StringRecord::from(row.as_slice()).deserialize(Some(&names));
    let rows: Result<_, csv::Error> = file.rows.iter().map(row).collect();
    rows.map_err(|e| Error::content(path, e.to_string()))
}
