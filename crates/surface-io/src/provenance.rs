//! Where a value comes from, and contradictions between what a file and its reader state.

use crate::error::ContentError;
use std::fmt;

/// Where a statement about a file comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The file itself.
    File,
    /// The caller.
    Caller,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::File => "from the file",
            Self::Caller => "as given",
        })
    }
}

/// A value and where it comes from.
#[derive(Debug, Clone, PartialEq)]
pub struct Sourced<T> {
    /// The value.
    pub value: T,
    /// Where it comes from.
    pub origin: Origin,
}

/// Headers print lengths with three digits or more: half of the last one.
pub(crate) const PRINTED: f64 = 5e-3;

pub(crate) fn contradiction(
    what: &'static str,
    file: &impl fmt::Display,
    caller: &impl fmt::Display,
) -> ContentError {
    let (first, second) = (format!("{file} {}", Origin::File), format!("{caller} {}", Origin::Caller));
    ContentError::Contradiction { what, first, second }
}

/// The value of the caller, checked against that of the file where both exist; else that of the file.
pub(crate) fn sourced<T>(
    file: Option<T>,
    caller: Option<T>,
    agree: impl FnOnce(&T, &T) -> Result<(), ContentError>,
) -> Result<Option<Sourced<T>>, ContentError> {
    if let (Some(file), Some(caller)) = (&file, &caller) {
        agree(file, caller)?;
    }
    let caller = caller.map(|value| Sourced { value, origin: Origin::Caller });
    Ok(caller.or(file.map(|value| Sourced { value, origin: Origin::File })))
}
