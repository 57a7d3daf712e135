//! What comments say: `# Width: 10 um`, `# Height: 10 um`, `# Value units: m`, as Gwyddion exports them and
//! this crate writes them.

use crate::error::ContentError;
use crate::format::Format;
use crate::quantity::{Dimension, Quantity, QuantityError, Unit};

/// The statements that count; everything else is a comment.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Heading {
    /// Length of a row, Lx.
    width: Option<Side>,
    /// Length of a column, Ly.
    height: Option<Side>,
    /// Unit of the heights.
    pub(crate) unit: Option<Unit>,
    /// Unit of x and y.
    pub(crate) lateral_unit: Option<Unit>,
    /// Name of the channel.
    pub(crate) name: Option<String>,
}

/// A side and how far it may be rounded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Side {
    pub(crate) quantity: Quantity,
    /// Half of the last decimal that is printed, relative; 0 for whole numbers and those with an exponent.
    pub(crate) rounding: f64,
}

/// Keys in small letters, and those of Gwyddion in German in English.
fn english(key: &str) -> String {
    let key = key.to_lowercase();
    let known = match key.as_str() {
        "kanal" => "channel",
        "breite" => "width",
        "h\u{f6}he" => "height",
        "werteeinheiten" => "value units",
        _ => return key,
    };
    known.to_owned()
}

/// Longest comment that is looked at, in bytes.
const LONGEST: usize = 200;

impl Heading {
    /// Takes what a comment says; the first statement of a kind counts, and another side of the same name is an error.
    ///
    /// Width and height are words of everyday and count where they are lengths; units count or are an error.
    pub(super) fn read(&mut self, comment: &[u8], line: usize) -> Result<(), ContentError> {
        if comment.len() > LONGEST {
            return Ok(());
        }
        // Files of older programs write the micro sign in Latin-1, whose bytes are the first 256 characters.
        let latin = || comment.iter().map(|&b| char::from(b)).collect();
        let text: String = std::str::from_utf8(comment).map_or_else(|_| latin(), str::to_owned);
        let Some((key, value)) = text.split_once(':') else { return Ok(()) };
        let key = english(key.trim());
        match key.as_str() {
            "channel" => {
                let name = value.trim();
                self.name = self.name.take().or_else(|| (!name.is_empty()).then(|| name.to_owned()));
            }
            "width" | "height" => {
                let side = side(value);
                let negative = |s: &Side| s.quantity.value() <= 0.0;
                if let Some(Side { quantity, .. }) = side.filter(negative)
                    && quantity.dimension() == Dimension::LENGTH
                {
                    return Err(ContentError::Side { line, key, value: quantity });
                }
                let field = if key == "width" { &mut self.width } else { &mut self.height };
                let side = side.filter(|s| !negative(s));
                if let (Some(first), Some(second)) = (&field, &side)
                    && first.quantity.dimension() == second.quantity.dimension()
                    && first.quantity.value().to_bits() != second.quantity.value().to_bits()
                {
                    let said = |quantity: &Quantity| format!("{key}: {quantity}");
                    let (first, second) = (said(&first.quantity), said(&second.quantity));
                    return Err(ContentError::Contradiction {
                        what: "two lines of the header",
                        first,
                        second,
                    });
                }
                *field = field.or(side);
            }
            "value units" | "lateral units" if !value.trim().is_empty() => {
                let unit =
                    unit(value).map_err(|source| ContentError::Heading { line, key: key.clone(), source })?;
                let field = if key == "value units" { &mut self.unit } else { &mut self.lateral_unit };
                field.get_or_insert(unit);
            }
            _ => {}
        }
        Ok(())
    }

    /// The format that the comments are those of: points have a unit of x and y, a matrix has a width and a
    /// height.
    pub(crate) fn format(&self) -> Option<Format> {
        let matrix = self.width.is_some() && self.height.is_some();
        let points = self.lateral_unit.is_some();
        if points { Some(Format::Xyz) } else { matrix.then_some(Format::Text) }
    }

    /// Width and height. Without a unit they count only where the heights are said to have none: elsewhere
    /// they are numbers of pixels.
    pub(crate) fn sides(&self) -> [Option<Side>; 2] {
        let plain = self.unit.as_ref().is_some_and(|u| u.dimension() == Dimension::NONE);
        let counts = |side: &Side| plain || side.quantity.dimension() == Dimension::LENGTH;
        [self.width.filter(counts), self.height.filter(counts)]
    }
}

/// A length or a plain number; `None` for other words.
fn side(text: &str) -> Option<Side> {
    let quantity: Quantity = text.parse().ok()?;
    let known = quantity.dimension() == Dimension::LENGTH || quantity.dimension() == Dimension::NONE;
    let number = text.trim().split(|c: char| !(c.is_ascii_digit() || matches!(c, '.' | '+' | '-'))).next()?;
    let exponent = text.trim()[number.len()..].starts_with(['e', 'E']);
    let rounding = match (number.split_once('.'), number.parse::<f64>()) {
        (Some((_, decimals)), Ok(number)) if !exponent => {
            0.5 * 0.1_f64.powf(decimals.len() as f64) / number.abs()
        }
        _ => 0.0,
    };
    known.then_some(Side { quantity, rounding })
}

fn unit(text: &str) -> Result<Unit, QuantityError> {
    let unit: Unit = text.parse()?;
    if unit.dimension() == Dimension::LENGTH || unit == Unit::none() {
        Ok(unit)
    } else {
        let (text, found) = (unit.to_string(), unit.dimension());
        Err(QuantityError::Dimension { text, found, expected: Dimension::LENGTH })
    }
}
