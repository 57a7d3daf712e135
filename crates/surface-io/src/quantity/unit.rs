//! Units: products of powers of symbols.

use super::dimension::Dimension;
use super::error::QuantityError;
use super::symbols;
use std::fmt;
use std::str::FromStr;

/// Largest power of a symbol, either sign: beyond it nothing has a meaning here.
const LARGEST_POWER: i8 = 9;

/// Longest text of a unit in bytes.
const LONGEST: usize = 64;

/// A unit such as `um`, `GPa`, `J/m^2` or `W/(m K)`.
///
/// Symbols m, g, s, A, K, N, Pa, J, W, V, Ohm, Hz, bar with the prefixes f, p, n, u (also the Greek letter),
/// m, c, d, k, M, G, T; angstrom, micron, inch, mil, psi, kgf, min, h, %. Products by a space, `*` or a
/// centred dot, one `/` with brackets around more than one symbol behind it, powers as `^2` or as
/// superscripts. The empty text and `none` are the unit of plain numbers.
///
/// ```
/// let unit: surface_io::Unit = "um".parse()?;
/// assert_eq!(unit.to_si(250.0), 250e-6);
/// # Ok::<(), surface_io::QuantityError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    text: String,
    dimension: Dimension,
    /// Power of ten.
    exponent: i32,
    /// What is no power of ten (60 for minutes).
    factor: f64,
}

impl Unit {
    /// The unit of plain numbers.
    pub fn none() -> Self {
        Self { text: String::new(), dimension: Dimension::NONE, exponent: 0, factor: 1.0 }
    }

    /// Reads a unit as files of other programs write it, also in words: `meters`, `Nanometre`.
    pub(crate) fn of_file(text: &str) -> Result<Self, QuantityError> {
        let word = text.trim().to_lowercase().replace("metre", "meter");
        let prefix = match word.trim_end_matches('s').strip_suffix("meter") {
            Some("") => "",
            Some("kilo") => "k",
            Some("centi") => "c",
            Some("milli") => "m",
            Some("micro") => "u",
            Some("nano") => "n",
            Some("pico") => "p",
            _ => return text.parse(),
        };
        format!("{prefix}m").parse()
    }

    /// Dimension: what it measures.
    pub fn dimension(&self) -> Dimension {
        self.dimension
    }

    /// A number of this unit in SI units, rounded once for powers of ten up to 22.
    pub fn to_si(&self, number: f64) -> f64 {
        // 10^22 is the largest power of ten that a double holds exactly; dividing by one rounds once,
        // multiplying by 1e-6 twice.
        let scaled = if self.exponent < 0 {
            number / 10_f64.powi(-self.exponent)
        } else {
            number * 10_f64.powi(self.exponent)
        };
        scaled * self.factor
    }

    /// Whether both are one unit, however spelled.
    pub(crate) fn same(&self, other: &Self) -> bool {
        // The factors are products of whole numbers, exact in doubles; that of psi is equal to itself.
        self.dimension == other.dimension
            && self.exponent == other.exponent
            && self.factor.to_bits() == other.factor.to_bits()
    }

    /// A number written with this unit: mantissa and exponent are read together, so that only the nearest
    /// double is taken.
    pub(super) fn joined(&self, mantissa: &str, exponent: i64) -> Option<f64> {
        let exponent = exponent + i64::from(self.exponent);
        format!("{mantissa}e{exponent}").parse::<f64>().ok().map(|value| value * self.factor)
    }
}

impl fmt::Display for Unit {
    /// As it was written; `no unit` for plain numbers.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.text.is_empty() { "no unit" } else { &self.text })
    }
}

impl FromStr for Unit {
    type Err = QuantityError;

    /// Reads a unit.
    ///
    /// # Errors
    /// [`QuantityError::Unit`] with the part that is unknown and what may have been meant;
    /// [`QuantityError::Form`] for a product that can be read in two ways.
    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let text = text.trim();
        if text.is_empty() || text == "none" {
            return Ok(Self::none());
        }
        let form = || QuantityError::Form { text: text.chars().take(LONGEST).collect() };
        if text.len() > LONGEST {
            return Err(form());
        }
        let plain = ascii(text);
        let mut unit = Self { text: text.to_owned(), ..Self::none() };
        let (above, below) = match plain.split_once('/') {
            Some((above, below)) => (above, Some(below.trim())),
            None => (plain.as_str(), None),
        };
        if below.is_none() || above.trim() != "1" {
            unit.product(above, 1).ok_or_else(form)??;
        }
        if let Some(below) = below {
            let bracketed = below.strip_prefix('(').and_then(|rest| rest.strip_suffix(')'));
            // "W/m K" is read in two ways by two people.
            if bracketed.is_none() && symbols_of(below).count() > 1 {
                return Err(form());
            }
            unit.product(bracketed.unwrap_or(below), -1).ok_or_else(form)??;
        }
        Ok(unit)
    }
}

fn symbols_of(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c == '*' || c.is_whitespace()).filter(|part| !part.is_empty())
}

impl Unit {
    /// Multiplies by a product of powers of symbols; `None` where the text has not that form.
    fn product(&mut self, text: &str, sign: i8) -> Option<Result<(), QuantityError>> {
        symbols_of(text).next()?;
        for part in symbols_of(text) {
            let (name, power) = match part.split_once('^') {
                Some((name, power)) => (name, power.parse::<i8>().ok()?),
                None => (part, 1),
            };
            if power == 0 || power.unsigned_abs() > LARGEST_POWER.unsigned_abs() {
                return None;
            }
            let Some((symbol, prefix)) = symbols::find(name) else {
                return Some(Err(QuantityError::Unit { text: name.to_owned(), alike: symbols::alike(name) }));
            };
            let power = power * sign;
            self.dimension = self.dimension.times(symbol.dimension, power)?;
            self.exponent += i32::from(power) * (symbol.exponent + prefix);
            self.factor *= symbol.factor.powi(i32::from(power));
        }
        Some(Ok(()))
    }
}

/// The Greek letters, dots and superscripts of print as ASCII.
fn ascii(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut raised = false;
    for c in text.chars() {
        let digit = match c {
            '\u{207b}' => Some('-'),
            '\u{b9}' => Some('1'),
            '\u{b2}' => Some('2'),
            '\u{b3}' => Some('3'),
            '\u{2070}' | '\u{2074}'..='\u{2079}' => char::from_digit(u32::from(c) - 0x2070, 10),
            _ => None,
        };
        if let Some(digit) = digit {
            if !raised {
                plain.push('^');
            }
            plain.push(digit);
        } else {
            match c {
                '\u{b5}' | '\u{3bc}' => plain.push('u'),
                '\u{3a9}' | '\u{2126}' => plain.push_str("Ohm"),
                '\u{c5}' | '\u{212b}' => plain.push_str("angstrom"),
                '\u{b7}' | '\u{22c5}' => plain.push('*'),
                c => plain.push(c),
            }
        }
        raised = digit.is_some();
    }
    plain
}
