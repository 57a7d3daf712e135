//! CSV with a header that explains itself.

use crate::error::{Error, Result};
use crate::files;
use contact_model::Source;
use contact_model::{Table, Value};
use flate2::read::GzDecoder;
use std::io::Read as _;
use std::path::Path;

/// Content of the `#` lines besides the title and the columns of the table. They contain no times and no
/// machine, so that the same run gives the same bytes.
#[derive(Debug, Clone, Default)]
pub struct Header {
    /// Publications on which the numbers are based.
    pub sources: Vec<String>,
    /// Parameters and choices, one line each.
    pub notes: Vec<String>,
    /// The command that makes the same bytes.
    pub command: String,
}

impl Header {
    /// A header of the output of this command.
    pub fn new(command: impl Into<String>) -> Self {
        Self { command: command.into(), ..Self::default() }
    }

    /// Adds a model's own sources, each once.
    #[must_use]
    pub fn with_sources(mut self, sources: &[Source]) -> Self {
        for source in sources {
            let line = format!("{}: {}", source.citation, source.what);
            if !self.sources.contains(&line) {
                self.sources.push(line);
            }
        }
        self
    }

    /// Adds a line.
    #[must_use]
    pub fn with_note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }
}

/// Writes a table whole, as [`csv_bytes`] has it.
///
/// # Errors
/// [`Error::File`] when it cannot be written.
pub fn write_csv(path: &Path, table: &Table, header: &Header) -> Result<()> {
    Ok(files::write_whole(path, &csv_bytes(table, header))?)
}

/// A table as the bytes of a file: `#` lines (title, columns with units, sources, parameters, version, command),
/// column names, rows.
///
/// Numbers are the shortest decimals that read back to the same bits; absent entries are empty.
pub fn csv_bytes(table: &Table, header: &Header) -> Vec<u8> {
    let mut text = String::new();
    let mut line = |s: &str| {
        text.push_str("# ");
        // A header line stays one line.
        text.push_str(&s.replace(['\n', '\r'], " "));
        text.push('\n');
    };
    line(table.title());
    for c in table.columns() {
        line(&format!("column {} [{}]: {}", c.name, c.unit, c.meaning));
    }
    header.sources.iter().for_each(|s| line(&format!("source: {s}")));
    header.notes.iter().for_each(|s| line(s));
    line(&format!("version: fractal-contact {}", env!("CARGO_PKG_VERSION")));
    line(&format!("command: {}", header.command));
    let mut bytes = text.into_bytes();
    let mut writer = csv::Writer::from_writer(&mut bytes);
    // A vector takes whatever is written, and every row has the length of the first.
    let names = table.columns().iter().map(|c| c.name.to_owned()).collect();
    let rows = table.rows().iter().map(|row| row.iter().map(value).collect());
    for record in std::iter::once(names).chain(rows) {
        let record: Vec<String> = record;
        let _ = writer.write_record(record);
    }
    let _ = writer.flush();
    drop(writer);
    bytes
}

/// Shortest decimal that reads back to the same bits.
pub fn number(v: f64) -> String {
    format!("{v:?}")
}

fn value(v: &Value) -> String {
    match v {
        Value::Text(t) => t.clone(),
        Value::Number(v) => number(*v),
        Value::Count(n) => n.to_string(),
        Value::Flag(b) => b.to_string(),
        Value::Empty => String::new(),
    }
}

/// The largest table that is read, bytes.
const LARGEST: u64 = 1 << 32;

/// A CSV file read back.
#[derive(Debug, Clone, PartialEq)]
pub struct CsvFile {
    /// The `#` lines without their mark.
    pub comments: Vec<String>,
    /// Column names.
    pub columns: Vec<String>,
    /// Rows of text.
    pub rows: Vec<Vec<String>>,
}

impl CsvFile {
    /// Reads a file written by [`write_csv`], packed by gzip where its name ends in `.gz`.
    ///
    /// # Errors
    /// [`Error::File`] when it cannot be read or is no table.
    pub fn read(path: &Path) -> Result<Self> {
        let mut bytes = files::read(path, LARGEST)?;
        if path.extension().is_some_and(|e| e == "gz") {
            let mut unpacked = Vec::new();
            let failed = |e: std::io::Error| Error::content(path, e.to_string());
            // A file may unpack to a thousand times its size.
            GzDecoder::new(bytes.as_slice()).take(LARGEST).read_to_end(&mut unpacked).map_err(failed)?;
            bytes = unpacked;
        }
        let text = String::from_utf8(bytes).map_err(|e| Error::content(path, format!("no text: {e}")))?;
        let comments =
            text.lines().filter_map(|l| l.strip_prefix('#')).map(|l| l.trim().to_owned()).collect();
        let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(text.as_bytes());
        let failed = |e: csv::Error| Error::content(path, e.to_string());
        let columns = reader.headers().map_err(failed)?.iter().map(str::to_owned).collect();
        let rows = reader
            .records()
            .map(|r| r.map(|r| r.iter().map(str::to_owned).collect()).map_err(failed))
            .collect::<Result<_>>()?;
        Ok(Self { comments, columns, rows })
    }

    /// Index of a column.
    ///
    /// # Errors
    /// [`Error::File`] when there is no such column.
    pub fn column(&self, name: &str) -> Result<usize> {
        self.columns
            .iter()
            .position(|c| c == name)
            .ok_or_else(|| Error::content(Path::new(name), "no such column"))
    }

    /// A column of numbers; `None` for an empty entry or text.
    ///
    /// # Errors
    /// As [`CsvFile::column`].
    pub fn numbers(&self, name: &str) -> Result<Vec<Option<f64>>> {
        let at = self.column(name)?;
        Ok(self.rows.iter().map(|r| r[at].parse().ok()).collect())
    }

    /// A column of text.
    ///
    /// # Errors
    /// As [`CsvFile::column`].
    pub fn texts(&self, name: &str) -> Result<Vec<&str>> {
        let at = self.column(name)?;
        Ok(self.rows.iter().map(|r| r[at].as_str()).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::Column;

    #[test]
    fn a_table_comes_back_bit_for_bit() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("t.csv");
        let column = |name, unit| Column { name, unit, meaning: "a, b" };
        let mut table =
            Table::new("Title\nof two", vec![column("x", "L"), column("t", "-"), column("n", "1")]);
        let values = [1.0 / 3.0, 1e-300, f64::MAX, -0.0];
        for v in values {
            table.push(vec![v.into(), "a \"b\", c".into(), None::<f64>.into()]).unwrap();
        }
        write_csv(&path, &table, &Header::new("cargo").with_note("seed 1")).unwrap();
        let file = CsvFile::read(&path).unwrap();
        let back: Vec<u64> = file.numbers("x").unwrap().into_iter().map(|v| v.unwrap().to_bits()).collect();
        assert_eq!(back, values.map(f64::to_bits));
        assert_eq!(file.texts("t").unwrap()[0], "a \"b\", c");
        assert_eq!(file.numbers("n").unwrap(), [None; 4]);
        assert!(file.column("y").is_err());
        assert_eq!(file.comments[0], "Title of two");
        assert!(file.comments.contains(&"column x [L]: a, b".to_owned()));
        assert_eq!(file.comments.last().unwrap(), "command: cargo");
    }

    #[test]
    fn what_cannot_be_written_is_named() {
        let table = Table::new("t", vec![]);
        let path = Path::new("/nonexistent/t.csv");
        let error = write_csv(path, &table, &Header::default()).unwrap_err();
        assert!(error.to_string().starts_with("cannot write /nonexistent/t.csv"), "{error}");
        assert!(CsvFile::read(path).is_err());
    }
}
