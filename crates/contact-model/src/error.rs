//! The one error type of the model crates: numbers, not prose.

use crate::state::{ContactState, Status};
use std::borrow::Cow;
use std::fmt;

/// Result of everything in the model crates.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What can go wrong between a scene and a state.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside what is meaningful.
    Domain {
        /// The quantity, in the words of ARCHITECTURE.md (and where it came from, such as `heights[3, 7]`).
        name: Cow<'static, str>,
        /// The value found.
        value: f64,
        /// What was expected instead.
        expected: Cow<'static, str>,
    },
    /// An array does not have the expected number of values.
    Shape {
        /// The array.
        name: Cow<'static, str>,
        /// Number of values found.
        found: usize,
        /// What was expected instead.
        expected: Cow<'static, str>,
    },
    /// The model does not know this surface, effect, load or output.
    Unsupported {
        /// Name of the model ([`crate::ContactModel::name`]).
        model: &'static str,
        /// What it was asked for.
        what: Cow<'static, str>,
    },
    /// A load outside the range in which the model holds.
    OutOfRange {
        /// The quantity that left its range.
        name: Cow<'static, str>,
        /// The value that was asked for or reached.
        value: f64,
        /// Smallest admissible value.
        min: f64,
        /// Largest admissible value.
        max: f64,
    },
    /// Something does not fit in memory; it was not begun.
    OutOfMemory {
        /// What it is for, with its size, such as `a map of 20000 columns x 20000 rows`.
        what: Cow<'static, str>,
        /// Bytes that it needs, about.
        bytes: f64,
        /// Bytes that there are; `None` where the system only refused.
        available: Option<f64>,
    },
    /// The solver stopped before its tolerance was met; the best state is evidence, not an answer.
    NotConverged {
        /// Best state reached, with its full report.
        best: Box<ContactState>,
    },
    /// The caller's stop closure said so (a deadline, Ctrl-C).
    Stopped {
        /// Best state so far where there is one.
        best: Option<Box<ContactState>>,
    },
}

impl Error {
    /// Shorthand for [`Error::Domain`].
    pub fn domain(
        name: impl Into<Cow<'static, str>>,
        value: f64,
        expected: impl Into<Cow<'static, str>>,
    ) -> Self {
        Self::Domain { name: name.into(), value, expected: expected.into() }
    }

    /// Shorthand for [`Error::Unsupported`].
    pub fn unsupported(model: &'static str, what: impl Into<Cow<'static, str>>) -> Self {
        Self::Unsupported { model, what: what.into() }
    }

    /// [`Error::Unsupported`] for a load that a model has no answer to.
    pub fn unsupported_load(model: &'static str, load: impl fmt::Display) -> Self {
        Self::unsupported(model, load.to_string())
    }

    /// Shorthand for [`Error::OutOfMemory`] where the system refused `bytes`.
    pub fn out_of_memory(what: impl Into<Cow<'static, str>>, bytes: f64) -> Self {
        Self::OutOfMemory { what: what.into(), bytes, available: None }
    }

    /// A tangential force beyond the limit `mu F` of Coulomb's friction.
    pub fn gross_slip(force: f64, limit: f64) -> Self {
        let name = "tangential force (beyond it the contact slips as a whole)".into();
        Self::OutOfRange { name, value: force, min: -limit, max: limit }
    }

    /// The state reached where a solve did not converge, which has its status and certificate; any other
    /// error stays one.
    ///
    /// # Errors
    /// The error itself.
    ///
    /// ```
    /// use contact_model::{ContactState, Error, SolveReport};
    /// let best = Box::new(ContactState::new(1.0, SolveReport::exact("test")));
    /// let result = Err(Error::NotConverged { best }).or_else(Error::into_best);
    /// assert_eq!(result.unwrap().force, 1.0);
    /// assert!(Error::domain("force", -1.0, "a number >= 0").into_best().is_err());
    /// ```
    pub fn into_best(self) -> Result<ContactState> {
        match self {
            Self::NotConverged { best } => Ok(*best),
            other => Err(other),
        }
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Domain { name, value, expected } => {
                write!(f, "{name} = {}: expected {expected}", Short(*value))
            }
            Self::Shape { name, found, expected } => {
                write!(f, "{name} has {found} values: expected {expected}")
            }
            Self::Unsupported { model, what } => write!(f, "the model {model} does not support {what}"),
            Self::OutOfRange { name, value, min, max } => {
                let [value, min, max] = [value, min, max].map(|v| Short(*v));
                write!(f, "{name} = {value} is outside [{min}, {max}], the range in which the model holds")
            }
            Self::OutOfMemory { what, bytes, available } => {
                write!(f, "{what}: needs about {} of memory, ", Gigabytes(*bytes))?;
                match available {
                    Some(there) => write!(f, "{} are available", Gigabytes(*there)),
                    None => write!(f, "more than there is"),
                }
            }
            Self::NotConverged { best } => {
                let r = &best.report;
                if r.status == Status::PulledOff {
                    return f.write_str(&r.strategy);
                }
                write!(
                    f,
                    "not converged after {} iterations: {}; {}",
                    r.iterations, r.certificate, r.strategy
                )
            }
            Self::Stopped { .. } => write!(f, "stopped by the caller before the solve was complete"),
        }
    }
}

impl std::error::Error for Error {}

/// A number without a row of zeros.
struct Short(f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        // Zero, infinities and NaN are short as they are.
        let long = value.is_finite() && value.abs() > 0.0 && !(1e-4..1e15).contains(&value.abs());
        if long { write!(f, "{value:e}") } else { write!(f, "{value}") }
    }
}

/// A number of bytes.
struct Gigabytes(f64);

impl fmt::Display for Gigabytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gigabytes = self.0 * 1e-9;
        if (0.1..1e6).contains(&gigabytes) {
            write!(f, "{gigabytes:.1} GB")
        } else {
            write!(f, "{gigabytes:.1e} GB")
        }
    }
}

/// Checks that `value` is finite and positive.
///
/// # Errors
/// [`Error::Domain`] otherwise.
pub(crate) fn positive(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::domain(name, value, "a finite number > 0"))
    }
}

/// Checks that `value` is finite and not negative.
///
/// # Errors
/// [`Error::Domain`] otherwise.
pub(crate) fn non_negative(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 {
        Ok(value)
    } else {
        Err(Error::domain(name, value, "a finite number >= 0"))
    }
}
