//! Values as colours.

use crate::error::Result;
use crate::map::{encode_rgb, share};

/// Colour of undefined points.
pub(crate) const UNDEFINED: [u8; 3] = [205, 205, 205];
/// A field has two signs where the lesser one reaches this share of the other; below, it is rounding.
const TWO_SIGNS: f64 = 1e-3;
/// An end of a range below this share of the other is zero with what a solver leaves of it.
const ROUNDING: f64 = 1e-6;

/// A palette, from the lowest to the highest value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Palette {
    /// Viridis, which is perceptually uniform, for colour-blind readers too.
    Viridis,
    /// Blue below zero, white at it, red above.
    BlueRed,
}

impl Palette {
    /// All of them.
    pub const ALL: [Self; 2] = [Self::Viridis, Self::BlueRed];

    /// The colour at 0, the lowest value, to 1.
    fn at(self, t: f64) -> [u8; 3] {
        match self {
            Self::Viridis => colorous::VIRIDIS.eval_continuous(t).into_array(),
            Self::BlueRed => colorous::RED_BLUE.eval_continuous(1.0 - t).into_array(),
        }
    }

    /// 256 colours from the lowest to the highest value.
    pub fn colours(self) -> [[u8; 3]; 256] {
        std::array::from_fn(|i| self.at(i as f64 / 255.0))
    }
}

/// Maps values to colours.
///
/// ```
/// use plots::{ColourScale, Palette};
/// let scale = ColourScale::new((-1.0, 3.0), false, true);
/// assert_eq!((scale.ends(), scale.palette()), ((-3.0, 3.0), Palette::BlueRed));
/// assert_eq!(ColourScale::new((2.0, 3.0), true, true).ends(), (0.0, 3.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColourScale {
    low: f64,
    high: f64,
    palette: Palette,
    white_zero: bool,
}

impl ColourScale {
    /// The scale of values in this range. It is viridis from end to end; with a white zero it begins at 0. A
    /// `signed` field with values of both signs has blue to red, symmetric about a white zero. An end below a
    /// millionth of the other is what a solver left of zero, and the scale has zero there.
    pub fn new((low, high): (f64, f64), white_zero: bool, signed: bool) -> Self {
        let (least, most) = (low.abs().min(high.abs()), low.abs().max(high.abs()));
        let [low, high] = [low, high].map(|end| if end.abs() < ROUNDING * most { 0.0 } else { end });
        if signed && low < 0.0 && high > 0.0 && least >= TWO_SIGNS * most && most.is_finite() {
            return Self { low: -most, high: most, palette: Palette::BlueRed, white_zero };
        }
        let low = if white_zero { low.min(0.0) } else { low };
        Self { low, high, palette: Palette::Viridis, white_zero }
    }

    /// The scale of a constant with room around it.
    pub(crate) fn widened(self) -> Self {
        let room = if self.high > self.low { 0.0 } else { self.high.abs().max(f64::MIN_POSITIVE) };
        Self { low: (self.low - room).max(-f64::MAX), high: (self.high + room).min(f64::MAX), ..self }
    }

    /// The lowest and the highest value.
    pub fn ends(self) -> (f64, f64) {
        (self.low, self.high)
    }

    /// The palette of the scale.
    pub fn palette(self) -> Palette {
        self.palette
    }

    /// Whether zero has no colour.
    pub fn white_zero(self) -> bool {
        self.white_zero
    }

    /// The colour of a value; undefined ones are grey, a scale without a length has its middle colour.
    pub fn colour(self, value: f64) -> [u8; 3] {
        match value {
            v if !v.is_finite() => UNDEFINED,
            v if self.white_zero && v.abs() <= 0.0 => [255; 3],
            v if self.high > self.low => self.palette.at(share(v, self.low, self.high).clamp(0.0, 1.0)),
            _ => self.palette.at(0.5),
        }
    }

    /// A PNG with a pixel for each value, the last row on top.
    ///
    /// # Errors
    /// [`crate::Error`] where the encoder refuses.
    pub fn encode(self, columns: usize, values: &[f64]) -> Result<Vec<u8>> {
        let colour = |v: &f64| self.colour(*v);
        let pixels: Vec<[u8; 3]> = values.chunks(columns.max(1)).rev().flatten().map(colour).collect();
        encode_rgb("a picture", columns, &pixels.into_flattened())
    }
}

/// 256 colours of viridis, from the lowest to the highest value.
///
/// ```
/// assert_eq!(plots::viridis()[0], [68, 1, 84]);
/// ```
pub fn viridis() -> [[u8; 3]; 256] {
    Palette::Viridis.colours()
}

/// A PNG with a pixel for each value, the last row on top: viridis from the lowest to the highest of the
/// range, undefined points grey, and white at 0 where `white_zero`.
///
/// # Errors
/// [`crate::Error`] where the encoder refuses.
pub fn encode_viridis(
    columns: usize,
    values: &[f64],
    [low, high]: [f64; 2],
    white_zero: bool,
) -> Result<Vec<u8>> {
    ColourScale { low, high, palette: Palette::Viridis, white_zero }.encode(columns, values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_is_in_the_middle_where_a_field_has_signs() {
        let scale = ColourScale::new((-2.0, 6.0), true, true);
        let [r, g, b] = scale.colour(1e-9);
        assert!(r.min(g).min(b) > 235, "{r} {g} {b}");
        let ([low, .., blue], [red, .., high]) = (scale.colour(-6.0), scale.colour(6.0));
        assert!(blue > low && red > high && scale.colour(0.0) == [255; 3]);
        // Rounding is no sign, and neither has a height one.
        for (range, signed, ends) in [
            ((-1e-9, 6.0), true, (0.0, 6.0)),
            ((-4.0, 1e-9), false, (-4.0, 0.0)),
            ((-2.0, 6.0), false, (-2.0, 6.0)),
            ((2.0, 6.0), true, (2.0, 6.0)),
        ] {
            let scale = ColourScale::new(range, false, signed);
            assert_eq!((scale.palette(), scale.ends()), (Palette::Viridis, ends));
        }
        let nothing = ColourScale::new((f64::INFINITY, f64::NEG_INFINITY), false, true);
        assert_eq!(nothing.colour(f64::NAN), UNDEFINED);
        let constant = ColourScale::new((3.0, 3.0), false, true).widened();
        assert_eq!((constant.ends(), constant.colour(3.0)), ((0.0, 6.0), Palette::Viridis.at(0.5)));
    }
}
