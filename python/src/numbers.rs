//! Numbers and pairs of them from Python: no truth values, no texts, no masked points, though some of these
//! convert to a number.

use pyo3::exceptions::{PyOverflowError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyFloat, PyInt, PyMapping, PyString};

/// What the error says of a value: its type, and of a text how it becomes a number.
fn refused(of: &Bound<'_, PyAny>, expected: &str) -> PyErr {
    let name = of.get_type().name().map_or_else(|_| "?".to_owned(), |name| name.to_string());
    let remedy =
        if of.is_instance_of::<PyString>() { ": fc.si makes a number of a text with a unit" } else { "" };
    PyTypeError::new_err(format!("expected {expected}, not {name}{remedy}"))
}

/// A value as an error shows it.
pub fn shown(of: &Bound<'_, PyAny>) -> String {
    of.repr().map_or_else(|_| "?".into(), |text| text.to_string())
}

/// The error of a value that is no number of something: a whole number, such as a negative one, is of the right type.
pub fn of_value_or_type(of: &Bound<'_, PyAny>, message: String) -> PyErr {
    if of.is_instance_of::<PyInt>() && !of.is_instance_of::<PyBool>() {
        PyValueError::new_err(message)
    } else {
        PyTypeError::new_err(message)
    }
}

/// Whether a value is none of the numbers though it may convert to one.
fn is_no_number(of: &Bound<'_, PyAny>) -> bool {
    if of.is_instance_of::<PyBool>() {
        return true;
    }
    // Of numpy: truth values, complex numbers, texts, and the masked point.
    let kind = of.getattr("dtype").and_then(|dtype| dtype.getattr("kind")).ok();
    let other = kind.and_then(|kind| kind.extract::<char>().ok()).is_some_and(|kind| !"fiuO".contains(kind));
    other || of.get_type().name().is_ok_and(|name| name == "MaskedConstant")
}

/// A real number.
#[derive(Debug, Clone, Copy)]
pub struct RealNumber(pub f64);

impl<'py> FromPyObject<'_, 'py> for RealNumber {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(float) = of.cast_exact::<PyFloat>() {
            return Ok(Self(float.value()));
        }
        if is_no_number(&of) {
            return Err(refused(&of, "a real number"));
        }
        of.extract::<f64>().map(Self).or_else(|error| {
            // Whole numbers beyond the largest float: refused by name where a finite number is needed.
            if error.is_instance_of::<PyOverflowError>(of.py()) {
                Ok(Self(if of.lt(0)? { f64::NEG_INFINITY } else { f64::INFINITY }))
            } else {
                Err(refused(&of, "a real number"))
            }
        })
    }
}

/// A value that stands alone or in a pair.
pub trait Single: Sized {
    /// One of them, and two, in words.
    const WORDS: [&'static str; 2];

    /// The value, where it is one.
    fn single(of: &Bound<'_, PyAny>) -> Option<Self>;
}

impl Single for f64 {
    const WORDS: [&'static str; 2] = ["a number", "two numbers, along x and along y"];

    fn single(of: &Bound<'_, PyAny>) -> Option<Self> {
        of.extract::<RealNumber>().ok().map(|RealNumber(value)| value)
    }
}

impl Single for usize {
    const WORDS: [&'static str; 2] = ["a whole number", "two, along x and along y"];

    fn single(of: &Bound<'_, PyAny>) -> Option<Self> {
        if is_no_number(of) { None } else { of.extract().ok() }
    }
}

impl Single for String {
    const WORDS: [&'static str; 2] = ["a text", "two texts"];

    fn single(of: &Bound<'_, PyAny>) -> Option<Self> {
        of.extract().ok()
    }
}

/// A value, or a pair of them as a tuple, a list or an array.
#[derive(Debug, Clone, Copy)]
pub enum OneOrTwo<T> {
    One(T),
    Two([T; 2]),
}

impl<T: Single> OneOrTwo<T> {
    /// One or two of them, where it is that.
    pub fn of(of: &Bound<'_, PyAny>) -> Option<Self> {
        if let Some(one) = T::single(of) {
            return Some(Self::One(one));
        }
        pair(of).map(Self::Two)
    }
}

/// The two values of what has exactly two.
pub fn pair<T: Single>(of: &Bound<'_, PyAny>) -> Option<[T; 2]> {
    if of.is_instance_of::<PyString>() || of.cast::<PyMapping>().is_ok() {
        return None;
    }
    // One more than there may be, of what may never end.
    let items = of.try_iter().ok()?.take(3).map(|item| T::single(&item.ok()?));
    items.collect::<Option<Vec<T>>>()?.try_into().ok()
}

impl<'py, T: Single> FromPyObject<'_, 'py> for OneOrTwo<T> {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        Self::of(&of).ok_or_else(|| {
            let [one, two] = T::WORDS;
            let shown = shown(&of);
            of_value_or_type(&of, format!("expected {one} or {two}, not {shown}"))
        })
    }
}

/// The seed of a surface, or its number.
#[derive(Debug, Clone, Copy)]
pub struct Seed(pub u64);

impl<'py> FromPyObject<'_, 'py> for Seed {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        let expected = "a whole number from 0 to 2^64 - 1";
        if is_no_number(&of) {
            return Err(refused(&of, expected));
        }
        of.extract().map(Self).map_err(|error: PyErr| {
            if error.is_instance_of::<PyOverflowError>(of.py()) {
                PyValueError::new_err(format!("expected {expected}, not {}", &*of))
            } else {
                refused(&of, expected)
            }
        })
    }
}

/// A pair of whole numbers.
pub struct NumberPair(pub [usize; 2]);

impl<'py> FromPyObject<'_, 'py> for NumberPair {
    type Error = PyErr;

    fn extract(of: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        pair(&of).map(Self).ok_or_else(|| {
            let shown = shown(&of);
            PyTypeError::new_err(format!(
                "expected two whole numbers >= 0, the first and the one after the last, not {shown}"
            ))
        })
    }
}
