//! Values of Python as the text of a table of a scene, so that the reader of scenes reads both.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyMapping, PyTuple};
use toml::{Table, Value};

/// The text of a table; a key whose value is None is left out. `path` is what the table is called in errors.
///
/// # Errors
/// `TypeError` for what no table holds, `ValueError` for a whole number beyond the range of a float.
pub fn toml_text(of: &Bound<'_, PyDict>, path: &str) -> PyResult<String> {
    Ok(table(of.as_mapping(), path, 0)?.to_string())
}

/// The text of one value.
///
/// # Errors
/// As [`toml_text`].
pub fn toml_value(of: &Bound<'_, PyAny>, path: &str) -> PyResult<String> {
    Ok(value(of, path, 0)?.to_string())
}

/// Tables and lists in each other; no scene has more, and one that holds itself has no end.
const DEEPEST: usize = 8;

fn table(of: &Bound<'_, PyMapping>, path: &str, depth: usize) -> PyResult<Table> {
    let mut table = Table::new();
    for item in of.items()? {
        let (key, item): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let shown = key.repr()?;
        let key: String = key
            .extract()
            .map_err(|_| PyTypeError::new_err(format!("{path} has the key {shown}: expected text")))?;
        if !item.is_none() {
            let value = value(&item, &format!("{path}.{key}"), depth + 1)?;
            table.insert(key, value);
        }
    }
    Ok(table)
}

fn value(of: &Bound<'_, PyAny>, path: &str, depth: usize) -> PyResult<Value> {
    if depth > DEEPEST {
        return Err(PyValueError::new_err(format!("{path} is nested more than {DEEPEST} deep")));
    }
    // A truth value of numpy is none of the numbers, though it converts to one.
    if let Ok(flag) = of.extract::<bool>() {
        return Ok(Value::Boolean(flag));
    }
    if let Ok(text) = of.extract::<String>() {
        return Ok(Value::String(text));
    }
    if let Ok(mapping) = of.cast::<PyMapping>() {
        return table(mapping, path, depth).map(Value::Table);
    }
    if of.is_instance_of::<PyList>() || of.is_instance_of::<PyTuple>() {
        let values = of.try_iter()?.map(|item| value(&item?, path, depth + 1));
        return values.collect::<PyResult<_>>().map(Value::Array);
    }
    if let Ok(whole) = of.extract::<i64>() {
        return Ok(Value::Integer(whole));
    }
    match of.extract::<f64>() {
        Ok(number) => Ok(Value::Float(number)),
        Err(error) if error.is_instance_of::<PyOverflowError>(of.py()) => {
            Err(PyValueError::new_err(format!("{path} is beyond the range of a float")))
        }
        Err(_) => Err(PyTypeError::new_err(format!(
            "{path} is {}: expected a number, text, list or mapping",
            of.repr()?
        ))),
    }
}
