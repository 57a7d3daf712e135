//! Errors in quantities as written.

use super::dimension::Dimension;

/// Why a text is no quantity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum QuantityError {
    /// Nothing is written.
    #[error("empty: expected a number and a unit, such as \"1 mm\"")]
    Empty,
    /// It does not begin with a number.
    #[error("{text:?} does not begin with a number: expected a number and a unit, such as \"1 mm\"")]
    Number {
        /// The text.
        text: String,
    },
    /// A comma between digits.
    #[error("{text:?} has a decimal comma: write a point")]
    DecimalComma {
        /// The text.
        text: String,
    },
    /// Not a finite double, or one so small that digits are lost.
    #[error("{text}: beyond the range of double precision")]
    OutOfRange {
        /// The text.
        text: String,
    },
    /// An unknown symbol.
    #[error("unknown unit {text:?}: {}", known(.alike))]
    Unit {
        /// The symbol.
        text: String,
        /// Symbols that differ from it in upper and lower case only.
        alike: Vec<String>,
    },
    /// A product that is no product or can be read in two ways.
    #[error("unit {text:?}: expected products and one quotient, such as \"J/m^2\" or \"W/(m K)\"")]
    Form {
        /// The unit, shortened.
        text: String,
    },
    /// The quantity measures something else.
    #[error(
        "{text} is {found}: expected {expected}{}",
        .expected.example().map_or_else(String::new, |example| format!(", such as {example:?}"))
    )]
    Dimension {
        /// The quantity as written.
        text: String,
        /// What it measures.
        found: Dimension,
        /// What was expected.
        expected: Dimension,
    },
}

/// What a unit may be: those that differ in case only, or all.
fn known(alike: &[String]) -> String {
    if alike.is_empty() {
        return "expected m, g, s, A, K, N, Pa, J, W, V, Ohm, Hz or bar, with a prefix from f to T, angstrom, micron, inch, mil, psi, kgf, min, h, % or \"none\""
            .to_owned();
    }
    format!("upper and lower case differ, is it {}?", alike.join(" or "))
}
