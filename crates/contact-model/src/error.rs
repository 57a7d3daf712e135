//! The one error type of the model crates; its variants hold numbers.

use crate::state::{ContactState, Status};
use crate::units::{number, rounded};
use std::borrow::Cow;
use std::fmt;

/// Result type of the model crates.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// What is expected of most numbers.
const POSITIVE: &str = "a finite number > 0";
const NON_NEGATIVE: &str = "a finite number >= 0";

/// What can go wrong between a scene and a state.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// A number lies outside the range of meaningful values.
    Domain {
        /// The quantity, by its name in GLOSSARY.md (and its place, such as `heights[3, 7]`).
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
    /// The model does not support this surface, effect, load or output.
    Unsupported {
        /// Name of the model ([`crate::ContactModel::name`]).
        model: &'static str,
        /// The effect, load or output that was requested.
        what: Cow<'static, str>,
    },
    /// A load lies outside the range in which the model holds.
    OutOfRange {
        /// The quantity that left its range.
        name: Cow<'static, str>,
        /// The value that was prescribed or reached.
        value: f64,
        /// Smallest admissible value.
        min: f64,
        /// Largest admissible value.
        max: f64,
    },
    /// Something does not fit in memory; the work was not begun.
    OutOfMemory {
        /// What it is for, with its size, such as `a map of 20000 columns x 20000 rows`.
        what: Cow<'static, str>,
        /// Bytes that it needs, approximately.
        bytes: f64,
        /// Bytes that are available; `None` where the system refused without a number.
        available: Option<f64>,
    },
    /// The solver stopped before its tolerance was met; the best state is evidence, not an answer.
    NotConverged {
        /// Best state reached, with its full report.
        best: Box<ContactState>,
    },
    /// The caller stopped the solve (a deadline, Ctrl-C).
    Stopped {
        /// Best state so far where there is one. It has no stiffness, nor anything that follows from one
        /// ([`crate::Status::Stopped`]).
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

    /// [`Error::Domain`] for a number that overflows or underflows in double precision, or that makes a
    /// result overflow or underflow.
    pub fn not_representable(name: impl Into<Cow<'static, str>>, value: f64) -> Self {
        let expected = "numbers between 1e-308 and 1e308 in size, results among them (choose other units)";
        Self::domain(name, value, expected)
    }

    /// [`Error::Domain`] for a number that is not finite and positive; [`Error::not_representable`] for one
    /// that is.
    pub fn of_positive(name: impl Into<Cow<'static, str>>, value: f64) -> Self {
        if value.is_finite() && value > 0.0 {
            Self::not_representable(name, value)
        } else {
            Self::domain(name, value, POSITIVE)
        }
    }

    /// [`Error::Domain`] for a number that is negative or not finite; [`Error::not_representable`] for any
    /// other.
    pub fn of_non_negative(name: impl Into<Cow<'static, str>>, value: f64) -> Self {
        if value.is_finite() && value >= 0.0 {
            Self::not_representable(name, value)
        } else {
            Self::domain(name, value, NON_NEGATIVE)
        }
    }

    /// Shorthand for [`Error::Unsupported`].
    pub fn unsupported(model: &'static str, what: impl Into<Cow<'static, str>>) -> Self {
        Self::Unsupported { model, what: what.into() }
    }

    /// [`Error::Unsupported`] for a load that a model does not support.
    pub fn unsupported_load(model: &'static str, load: impl fmt::Display) -> Self {
        Self::unsupported(model, load.to_string())
    }

    /// Shorthand for [`Error::OutOfMemory`] where the system refused `bytes`.
    pub fn out_of_memory(what: impl Into<Cow<'static, str>>, bytes: f64) -> Self {
        Self::OutOfMemory { what: what.into(), bytes, available: None }
    }

    /// A tangential force beyond the sliding force, `mu F` by Coulomb's law.
    pub fn gross_slip(force: f64, limit: f64) -> Self {
        let name = "tangential force (beyond it the contact slips as a whole)".into();
        Self::OutOfRange { name, value: force, min: -limit, max: limit }
    }

    /// The best state of a solve that did not converge, with its status and certificate; any other error
    /// stays an error.
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
                write!(f, "{name} = {}: expected {expected}", shown(*value, &[expected]))
            }
            Self::Shape { name, found, expected } => {
                write!(f, "{name} has {found} values: expected {expected}")
            }
            Self::Unsupported { model, what } => write!(f, "the model {model} does not support {what}"),
            Self::OutOfRange { name, value, min, max } => {
                let [low, high] = [min, max].map(|end| shown(*end, &[]));
                let value = shown(*value, &[&low, &high]);
                write!(f, "{name} = {value} is ")?;
                match (min.is_finite(), max.is_finite()) {
                    (true, false) => write!(f, "below {low}, the smallest value for which the model holds"),
                    (false, true) => write!(f, "above {high}, the largest value for which the model holds"),
                    _ => write!(f, "outside [{low}, {high}], the range in which the model holds"),
                }
            }
            Self::OutOfMemory { what, bytes, available } => {
                write!(f, "{what}: needs about {} of memory, ", Gigabytes(*bytes))?;
                match available {
                    Some(there) => write!(f, "{} are available", Gigabytes(*there)),
                    None => write!(f, "more than the system grants"),
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

/// A number for a message. A number of few digits, which may have been typed, keeps them all; a computed one
/// is rounded to six digits. All digits are kept where the short form would equal a text beside it, such as a
/// limit that the number misses by rounding.
fn shown(value: f64, beside: &[&str]) -> String {
    /// The most digits that are taken as typed.
    const TYPED: usize = 12;
    let plain = |value: f64| {
        // Zero, infinities and NaN are short as they are.
        let long = value.is_finite() && value.abs() > 0.0 && !(1e-4..1e15).contains(&value.abs());
        if long { format!("{value:e}") } else { value.to_string() }
    };
    let computed = value.is_finite() && rounded(value, TYPED).to_bits() != value.to_bits();
    if !computed {
        return plain(value);
    }
    let short = number(rounded(value, 6));
    if beside.iter().any(|text| text.contains(&short)) { plain(value) } else { short }
}

/// A number of bytes, in the unit that suits it.
struct Gigabytes(f64);

impl fmt::Display for Gigabytes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let gigabytes = self.0 * 1e-9;
        if gigabytes == 0.0 || (1e-2..1.0).contains(&gigabytes) {
            write!(f, "{:.0} MB", 1e3 * gigabytes)
        } else if (1e-4..1e-2).contains(&gigabytes) {
            write!(f, "{:.1} MB", 1e3 * gigabytes)
        } else if (0.0..1e-4).contains(&gigabytes) {
            write!(f, "{:.0} kB", 1e6 * gigabytes)
        } else if (1.0..1e6).contains(&gigabytes) {
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
    if value.is_finite() && value > 0.0 { Ok(value) } else { Err(Error::domain(name, value, POSITIVE)) }
}

/// Checks that `value` is finite and not negative.
///
/// # Errors
/// [`Error::Domain`] otherwise.
pub(crate) fn non_negative(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value >= 0.0 { Ok(value) } else { Err(Error::domain(name, value, NON_NEGATIVE)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_digits_that_matter() {
        // Typed, and computed.
        for (value, text) in [
            (0.1, "0.1"),
            (-1.0, "-1"),
            (2_000_000.0, "2000000"),
            (123_456_789_012.0, "123456789012"),
            (1.0 / 3.0, "0.333333"),
            (0.869_565_217_391_304_3, "0.869565"),
            (0.1 + 0.2, "0.3"),
            (9.999_999_999_999_999e-10, "1e-9"),
            (2.0 / 3.0 * 1e10, "6.66667e9"),
            (5e-324, "5e-324"),
            (f64::INFINITY, "inf"),
            (0.0, "0"),
        ] {
            assert_eq!(Error::domain("x", value, "y").to_string(), format!("x = {text}: expected y"));
        }
        let beyond = 1.0 + f64::EPSILON;
        let error = Error::OutOfRange { name: "x".into(), value: beyond, min: 0.0, max: 1.0 };
        assert!(error.to_string().starts_with("x = 1.0000000000000002 is outside [0, 1]"), "{error}");
        let below = Error::OutOfRange { name: "x".into(), value: 0.0, min: 1.5, max: f64::INFINITY };
        assert_eq!(below.to_string(), "x = 0 is below 1.5, the smallest value for which the model holds");
        let error = Error::domain("x", beyond, "a number in [0, 1]");
        assert!(error.to_string().starts_with("x = 1.0000000000000002: expected"), "{error}");
    }

    #[test]
    fn bytes_have_the_unit_that_suits_them() {
        for (bytes, text) in [
            (0.0, "0 MB"),
            (2.3e4, "23 kB"),
            (1e5, "0.1 MB"),
            (5.12e6, "5.1 MB"),
            (6.9e7, "69 MB"),
            (6.4e9, "6.4 GB"),
            (2.7e22, "2.7e13 GB"),
        ] {
            assert_eq!(Gigabytes(bytes).to_string(), text);
        }
    }

    #[test]
    fn what_double_precision_does_not_hold_is_told_without_its_name() {
        let of = |error: Error| error.to_string();
        let size = "numbers between 1e-308 and 1e308 in size, results among them (choose other units)";
        assert_eq!(of(Error::of_positive("x", 1e300)), format!("x = 1e300: expected {size}"));
        assert_eq!(of(Error::of_positive("x", 0.0)), "x = 0: expected a finite number > 0");
        assert_eq!(of(Error::of_non_negative("x", 0.0)), format!("x = 0: expected {size}"));
        assert_eq!(of(Error::of_non_negative("x", f64::NAN)), "x = NaN: expected a finite number >= 0");
    }
}
