//! What comments say: `# Width: 10 um`, `# Height: 10 um`, `# Value units: m`, as Gwyddion exports them and this crate writes them.

use crate::error::Problem;
use crate::quantity::{Dimension, Quantity, QuantityError, Unit};

/// The statements that count; everything else is a comment.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Heading {
    /// Length of a row.
    pub(crate) width: Option<Quantity>,
    /// Length of a column.
    pub(crate) height: Option<Quantity>,
    /// Unit of the heights.
    pub(crate) unit: Option<Unit>,
    /// Unit of x and y.
    pub(crate) lateral_unit: Option<Unit>,
}

/// Longest comment that is looked at, in bytes.
const LONGEST: usize = 200;

impl Heading {
    /// Takes what a comment says; the first statement of a kind counts.
    ///
    /// Width and height are words of everyday and count where they are lengths; units count or are an error.
    pub(super) fn read(&mut self, comment: &[u8], line: usize) -> Result<(), Problem> {
        if comment.len() > LONGEST {
            return Ok(());
        }
        // Files of older programs write the micro sign in Latin-1, whose bytes are the first 256 characters.
        let latin = || comment.iter().map(|&b| char::from(b)).collect();
        let text: String = std::str::from_utf8(comment).map_or_else(|_| latin(), str::to_owned);
        let Some((key, value)) = text.split_once(':') else { return Ok(()) };
        let key = key.trim().to_ascii_lowercase();
        match key.as_str() {
            "width" => self.width = self.width.or_else(|| length(value)),
            "height" => self.height = self.height.or_else(|| length(value)),
            "value units" | "lateral units" if !value.trim().is_empty() => {
                let unit =
                    unit(value).map_err(|source| Problem::Heading { line, key: key.clone(), source })?;
                let said = if key == "value units" { &mut self.unit } else { &mut self.lateral_unit };
                said.get_or_insert(unit);
            }
            _ => {}
        }
        Ok(())
    }

    /// Lengths without a unit count only where the heights are said to have none: elsewhere they are numbers of pixels.
    pub(super) fn side(&self, side: Option<Quantity>) -> Option<Quantity> {
        let plain = self.unit.as_ref().is_some_and(|u| u.dimension() == Dimension::NONE);
        side.filter(|q| plain || q.dimension() == Dimension::LENGTH)
    }
}

fn length(text: &str) -> Option<Quantity> {
    let quantity: Quantity = text.parse().ok()?;
    let known = quantity.dimension() == Dimension::LENGTH || quantity.dimension() == Dimension::NONE;
    (known && quantity.value() > 0.0).then_some(quantity)
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
