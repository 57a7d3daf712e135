//! Numbers with units: `"1 mm"`, `"70 GPa"`, `"50 mJ/m^2"`.
//!
//! Own code rather than a crate: `uom` fixes units at compile time and reads one type of quantity per parser,
//! the crates that parse any unit are under the GPL or young, and a scene file needs one thing that none has:
//! an error that says what was meant by `Mpa`.

mod dimension;
mod error;
mod symbols;
mod unit;

pub use dimension::Dimension;
pub use error::QuantityError;
pub use unit::Unit;

use contact_model::units::{ascii, multiple, number};
use std::fmt;
use std::str::FromStr;

/// A finite number in SI units (m, kg, s, A, K and their products) and its dimension.
///
/// ```
/// use surface_io::{Dimension, Quantity};
/// let radius: Quantity = "0.3 um".parse()?;
/// // The decimal exponents are joined before the number is read, so this is the double nearest to 3e-7.
/// assert_eq!(radius.value(), 3e-7);
/// assert_eq!(radius.dimension(), Dimension::LENGTH);
/// assert_eq!(Quantity::parse_as("50 mJ/m^2", Dimension::ENERGY_PER_AREA)?, 0.05);
/// # Ok::<(), surface_io::QuantityError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    value: f64,
    dimension: Dimension,
}

impl Quantity {
    /// A finite number in SI units of the given dimension.
    ///
    /// # Errors
    /// [`QuantityError::OutOfRange`] for NaN and infinities.
    pub fn new(value: f64, dimension: Dimension) -> Result<Self, QuantityError> {
        if value.is_finite() {
            Ok(Self { value, dimension })
        } else {
            Err(QuantityError::OutOfRange { text: value.to_string() })
        }
    }

    /// A number of the given unit.
    ///
    /// # Errors
    /// [`QuantityError::OutOfRange`] where the number in SI units is not finite.
    pub fn of(number: f64, unit: &Unit) -> Result<Self, QuantityError> {
        Self::new(unit.to_si(number), unit.dimension())
    }

    /// Value in SI units.
    pub fn value(self) -> f64 {
        self.value
    }

    /// Dimension: what is measured.
    pub fn dimension(self) -> Dimension {
        self.dimension
    }

    /// Value in SI units where the dimension is the expected one.
    ///
    /// # Errors
    /// [`QuantityError::Dimension`] otherwise.
    pub fn expect(self, expected: Dimension) -> Result<f64, QuantityError> {
        if self.dimension == expected {
            Ok(self.value)
        } else {
            Err(QuantityError::Dimension { text: self.to_string(), found: self.dimension, expected })
        }
    }

    /// Reads a quantity of the expected dimension and gives its value in SI units.
    ///
    /// # Errors
    /// As [`Quantity::from_str`], and [`QuantityError::Dimension`] with the text as written.
    pub fn parse_as(text: &str, expected: Dimension) -> Result<f64, QuantityError> {
        let found: Self = text.parse()?;
        found.expect(expected).map_err(|_| QuantityError::Dimension {
            text: text.trim().to_owned(),
            found: found.dimension,
            expected,
        })
    }
}

impl FromStr for Quantity {
    type Err = QuantityError;

    /// Reads a number and a unit, with or without a space between; a number alone has no dimension.
    ///
    /// For units that are powers of ten of SI units (all but those of time and of feet and pounds) the result
    /// is the double nearest to what is written.
    ///
    /// # Errors
    /// [`QuantityError`] for what is no number, a decimal comma, an unknown unit (with what may have been
    /// meant), a number that does not fit.
    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let text = text.trim();
        let (mantissa, exponent, rest) = split(text)?;
        let unit: Unit = rest.parse()?;
        let value = unit.joined(mantissa, exponent).filter(|v| v.is_finite());
        let lost =
            |v: &f64| v.abs() < f64::MIN_POSITIVE && mantissa.bytes().any(|b| (b'1'..=b'9').contains(&b));
        match value {
            Some(value) if !lost(&value) => Ok(Self { value, dimension: unit.dimension() }),
            _ => Err(QuantityError::OutOfRange { text: text.to_owned() }),
        }
    }
}

/// Mantissa, decimal exponent and the rest of a text that begins with a number.
fn split(text: &str) -> Result<(&str, i64, &str), QuantityError> {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    if text.is_empty() {
        return Err(QuantityError::Empty);
    }
    let mut end = usize::from(matches!(bytes[0], b'+' | b'-'));
    let whole = digits(end);
    end += whole;
    let mut decimals = 0;
    if bytes.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return Err(QuantityError::Number { text: text.to_owned() });
    }
    if bytes.get(end) == Some(&b',') && digits(end + 1) > 0 {
        return Err(QuantityError::DecimalComma { text: text.to_owned() });
    }
    let mantissa = &text[..end];
    let mut exponent = 0;
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let count = digits(end + 1 + sign);
        if count > 0 {
            let stop = end + 1 + sign + count;
            // Digits that overflow an i64 are far beyond every double of either sign.
            let size = text[end + 1 + sign..stop].parse().unwrap_or(1_000_000_i64).min(1_000_000);
            exponent = if bytes[end + 1] == b'-' { -size } else { size };
            end = stop;
        }
    }
    Ok((mantissa, exponent, &text[end..]))
}

impl fmt::Display for Quantity {
    /// The value in the multiple of its unit that suits it, such as `1.5 um`, or in SI units with all digits where
    /// rounding would change it: read again it is the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let in_unit = |number: &str, unit: &str| {
            if self.dimension == Dimension::NONE { number.to_owned() } else { format!("{number} {unit}") }
        };
        let symbol = self.dimension.symbol();
        let (unit, factor) = multiple(&symbol, self.value);
        let suited = in_unit(&number(factor * self.value), &ascii(&unit));
        let rounded = in_unit(&number(self.value), &symbol);
        let is_exact = |text: &&String| text.parse() == Ok(*self);
        match [&suited, &rounded].into_iter().find(is_exact) {
            Some(text) => f.write_str(text),
            None => f.write_str(&in_unit(&format!("{:e}", self.value), &symbol)),
        }
    }
}

#[cfg(test)]
mod tests;
