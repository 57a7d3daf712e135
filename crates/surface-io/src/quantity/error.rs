//! What is wrong with a quantity as written.

use super::dimension::Dimension;
use std::fmt;

/// Why a text is no quantity.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum QuantityError {
    /// Nothing is written.
    Empty,
    /// It does not begin with a number.
    Number {
        /// The text.
        text: String,
    },
    /// A comma between digits.
    DecimalComma {
        /// The text.
        text: String,
    },
    /// Not a finite double, or one so small that digits are lost.
    OutOfRange {
        /// The text.
        text: String,
    },
    /// An unknown symbol.
    Unit {
        /// The symbol.
        text: String,
        /// Symbols that differ from it in upper and lower case only.
        alike: Vec<String>,
    },
    /// A product that is no product or can be read in two ways.
    Form {
        /// The unit, shortened.
        text: String,
    },
    /// The quantity measures something else.
    Dimension {
        /// The quantity as written.
        text: String,
        /// What it measures.
        found: Dimension,
        /// What was expected.
        expected: Dimension,
    },
}

impl fmt::Display for QuantityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "empty: expected a number and a unit, such as \"1 mm\""),
            Self::Number { text } => {
                write!(
                    f,
                    "{text:?} does not begin with a number: expected a number and a unit, such as \"1 mm\""
                )
            }
            Self::DecimalComma { text } => write!(f, "{text:?} has a decimal comma: write a point"),
            Self::OutOfRange { text } => write!(f, "{text}: beyond the range of double precision"),
            Self::Unit { text, alike } if alike.is_empty() => {
                write!(
                    f,
                    "unknown unit {text:?}: expected m, g, s, A, K, N, Pa, J, W, V, Ohm, Hz or bar, with a prefix from f to T, \
                     angstrom, min, h, % or \"none\""
                )
            }
            Self::Unit { text, alike } => {
                write!(f, "unknown unit {text:?}: upper and lower case differ, is it {}?", alike.join(" or "))
            }
            Self::Form { text } => {
                write!(
                    f,
                    "unit {text:?}: expected products and one quotient, such as \"J/m^2\" or \"W/(m K)\""
                )
            }
            Self::Dimension { text, found, expected } => {
                write!(f, "{text} is {found}: expected {expected}")?;
                match expected.example() {
                    Some(example) => write!(f, ", such as {example:?}"),
                    None => Ok(()),
                }
            }
        }
    }
}

impl std::error::Error for QuantityError {}
