//! Named columns with units; no input or output.

use crate::{Error, Result, Value};

/// A column: its name, its unit and its meaning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Column {
    /// Name, as in the header of a CSV.
    pub name: &'static str,
    /// Unit (`1` for a pure number, `-` for text).
    pub unit: &'static str,
    /// Its meaning, in one phrase.
    pub meaning: &'static str,
}

/// A table whose every number is finite and whose every row fits its columns.
///
/// ```
/// use contact_model::{Column, Table};
/// let column = |name, unit| Column { name, unit, meaning: "" };
/// let mut table = Table::new("Two numbers", vec![column("x", "L"), column("k", "1")]);
/// table.push(vec![0.5.into(), None::<f64>.into()])?;
/// assert!(table.push(vec![f64::NAN.into(), 1.0.into()]).is_err());
/// assert_eq!(table.rows().len(), 1);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    title: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Value>>,
}

impl Table {
    /// An empty table.
    pub fn new(title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self { title: title.into(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`Error::Shape`] for a row of another length, [`Error::Domain`] for a number that is NaN or infinite;
    /// the table is unchanged.
    pub fn push(&mut self, row: Vec<Value>) -> Result<()> {
        if row.len() != self.columns.len() {
            return Err(Error::Shape {
                name: "row".into(),
                found: row.len(),
                expected: format!("{} (one per column)", self.columns.len()).into(),
            });
        }
        for (column, value) in self.columns.iter().zip(&row) {
            if let Value::Number(v) = *value
                && !v.is_finite()
            {
                return Err(Error::domain(column.name, v, "a finite number (or an empty entry)"));
            }
        }
        self.rows.push(row);
        Ok(())
    }

    /// The title of the table.
    pub fn title(&self) -> &str {
        &self.title
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The rows.
    pub fn rows(&self) -> &[Vec<Value>] {
        &self.rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_of_another_length_are_refused() {
        let mut t = Table::new("t", vec![Column { name: "x", unit: "1", meaning: "" }]);
        assert!(t.push(vec![]).is_err());
        assert!(t.push(vec![f64::INFINITY.into()]).is_err());
        t.push(vec![3_usize.into()]).unwrap();
        assert_eq!(t.rows(), [vec![Value::Count(3)]]);
        assert_eq!((t.title(), t.columns()[0].name), ("t", "x"));
    }
}
