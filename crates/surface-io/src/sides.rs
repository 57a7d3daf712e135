//! Lengths along x and y, as they are given and for each axis.

use crate::quantity::{Quantity, QuantityError};
use std::fmt;
use std::str::FromStr;

/// Lengths along x and y as a caller gives them.
///
/// ```
/// use surface_io::Sides;
/// let size: Sides = "4 mm x 3 mm".parse()?;
/// assert_eq!(size, Sides::Two(["4 mm".parse()?, "3 mm".parse()?]));
/// assert_eq!("0.5 um".parse(), Ok(Sides::One("0.5 um".parse()?)));
/// # Ok::<(), surface_io::QuantityError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sides {
    /// One value for both axes: of a square map, or of square cells.
    One(Quantity),
    /// Along x and along y.
    Two([Quantity; 2]),
}

impl Sides {
    /// Along x and along y.
    pub fn both(self) -> [Quantity; 2] {
        match self {
            Self::One(side) => [side, side],
            Self::Two(sides) => sides,
        }
    }
}

impl From<Quantity> for Sides {
    fn from(side: Quantity) -> Self {
        Self::One(side)
    }
}

/// Along x and along y.
impl From<[Quantity; 2]> for Sides {
    fn from(sides: [Quantity; 2]) -> Self {
        Self::Two(sides)
    }
}

impl fmt::Display for Sides {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::One(side) => write!(f, "{side}"),
            Self::Two([x, y]) => write!(f, "{x} x {y}"),
        }
    }
}

impl FromStr for Sides {
    type Err = QuantityError;

    /// Reads one quantity, or two with an `x` or a comma between, such as `4 mm x 3 mm` or `4 mm, 3 mm`.
    ///
    /// # Errors
    /// As [`Quantity::from_str`].
    fn from_str(text: &str) -> Result<Self, QuantityError> {
        // An x inside a unit has a letter beside it.
        let beside = |c: Option<char>| c.is_some_and(|c| !c.is_alphabetic());
        let between = text.char_indices().find(|&(at, c)| {
            let after = text[at + c.len_utf8()..].chars().next();
            let before = text[..at].chars().next_back();
            // A decimal comma has digits on both sides.
            let is_list =
                || before.is_some_and(char::is_alphabetic) || after.is_some_and(char::is_whitespace);
            c == '×' || (c == 'x' && beside(before) && beside(after)) || (c == ',' && is_list())
        });
        match between {
            Some((at, c)) => Ok(Self::Two([text[..at].parse()?, text[at + c.len_utf8()..].parse()?])),
            None => text.parse().map(Self::One),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_or_two_sides_are_read() {
        let two = |x: &str, y: &str| Ok(Sides::Two([x.parse().unwrap(), y.parse().unwrap()]));
        for text in ["4 mm x 3 um", "4mm×3um", " 4 mm  x  3 um ", "4 mm, 3 um", "4mm,3um"] {
            assert_eq!(text.parse(), two("4 mm", "3 um"), "{text}");
        }
        for text in ["4x3", "4, 3"] {
            assert_eq!(text.parse(), two("4", "3"));
        }
        assert_eq!("1e-3".parse(), Ok(Sides::One("1e-3".parse().unwrap())));
        for text in [
            "",
            "x",
            "4 x",
            "4 mm x 3 mm x 2 mm",
            "4 px",
            "x 4",
            "0,5 um x 1 um",
            "0,5",
            "4,3",
            "4 mm, 3 mm, 2 mm",
        ] {
            assert!(text.parse::<Sides>().is_err(), "{text}");
        }
        assert_eq!("4 mm x 3 um".parse::<Sides>().unwrap().to_string(), "4 mm x 3 um");
    }
}
