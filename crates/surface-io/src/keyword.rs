//! Words of scenes and command lines.

use crate::format::Format;
use crate::options::{Axes, Border, Decimal};
use crate::preprocessing::{AlignLines, Crop, Detrend, Fill, Mirror, Undefined, Window};
use crate::quantity::QuantityError;
use std::fmt;
use std::str::FromStr;
use std::sync::LazyLock;

/// A word that is not one of those expected.
#[derive(Debug, Clone, PartialEq)]
pub struct KeywordError {
    /// What it should say.
    pub what: &'static str,
    /// The word, shortened.
    pub found: String,
    /// The words that are known.
    pub expected: &'static str,
    /// Why it is no quantity either, where one is allowed.
    pub quantity: Option<QuantityError>,
}

impl KeywordError {
    fn new(what: &'static str, found: &str, expected: &'static str) -> Self {
        Self { what, found: found.chars().take(32).collect(), expected, quantity: None }
    }
}

/// What a word stands for among those that are known.
fn among<T, const N: usize>(
    what: &'static str,
    text: &str,
    known: [(&str, T); N],
    expected: &'static str,
) -> Result<T, KeywordError> {
    let found = known.into_iter().find(|(word, _)| *word == text);
    found.map(|(_, value)| value).ok_or_else(|| KeywordError::new(what, text, expected))
}

impl fmt::Display for KeywordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {:?}: expected {}", self.what, self.found, self.expected)?;
        match &self.quantity {
            Some(error) => write!(f, " ({error})"),
            None => Ok(()),
        }
    }
}

impl std::error::Error for KeywordError {}

impl FromStr for Format {
    type Err = KeywordError;

    /// Reads a [`Format::word`].
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        among("format", text, Self::ALL.map(|format| (format.word(), format)), &FORMATS)
    }
}

/// All words of [`Format`].
static FORMATS: LazyLock<String> = LazyLock::new(|| {
    let [first @ .., last] = Format::ALL.map(Format::word);
    format!("{} or {last}", first.join(", "))
});

impl FromStr for Decimal {
    type Err = KeywordError;

    /// Reads `point` or `comma`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        let known = [("point", Self::Point), ("comma", Self::Comma)];
        among("decimal", text, known, "point or comma")
    }
}

impl FromStr for Axes {
    type Err = KeywordError;

    /// Reads `xy` or `yx`: the first index is x, or y.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        let known = [Self::Xy, Self::Yx].map(|axes| (axes.word(), axes));
        among("axes", text, known, "xy or yx, what the first and the second index count along")
    }
}

impl FromStr for Border {
    type Err = KeywordError;

    /// Reads `axes` or `heights`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        among("border", text, [("axes", Self::Axes), ("heights", Self::Heights)], "axes or heights")
    }
}

impl FromStr for Detrend {
    type Err = KeywordError;

    /// Reads `none`, `mean`, `plane`, `quadric`, `sphere` or `cylinder`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        let known = Self::ALL.map(|detrend| (detrend.word(), detrend));
        among("detrend", text, known, "none, mean, plane, quadric, sphere or cylinder")
    }
}

impl FromStr for AlignLines {
    type Err = KeywordError;

    /// Reads `median_difference` or `median`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        let known = Self::ALL.map(|align| (align.word(), align));
        among("align_lines", text, known, "median_difference or median")
    }
}

impl FromStr for Fill {
    type Err = KeywordError;

    /// Reads `neighbours`, `plane` or a height such as `-2 um`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        match text {
            "neighbours" => Ok(Self::Neighbours),
            "plane" => Ok(Self::Plane),
            other => other.parse().map(Self::Value).map_err(|quantity| {
                let error =
                    KeywordError::new("fill", other, "neighbours, plane or a height such as \"-2 um\"");
                KeywordError { quantity: Some(quantity), ..error }
            }),
        }
    }
}

impl FromStr for Undefined {
    type Err = KeywordError;

    /// Reads `no_contact`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        let known = [("no_contact", Self::NoContact)];
        among("undefined", text, known, "no_contact (fill gives undefined points a height)")
    }
}

impl FromStr for Crop {
    type Err = KeywordError;

    /// Reads `centre`, `defined`, or row, column, rows and columns as in `10,20,256,512`; with three numbers
    /// there are as many columns as rows.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        match text {
            "centre" => return Ok(Self::Centre),
            "defined" => return Ok(Self::Defined),
            _ => {}
        }
        let numbers: Result<Vec<usize>, _> = text.split(',').map(|part| part.trim().parse()).collect();
        match numbers.as_deref() {
            Ok(&[row, column, cells]) => Ok(Self::Window { row, column, rows: cells, columns: cells }),
            Ok(&[row, column, rows, columns]) => Ok(Self::Window { row, column, rows, columns }),
            _ => Err(KeywordError::new(
                "crop",
                text,
                "centre, defined, or row, column, rows and columns such as \"10,20,256,512\"",
            )),
        }
    }
}

impl FromStr for Mirror {
    type Err = KeywordError;

    /// Reads `x` or `y`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        among("mirror", text, [("x", Self::X), ("y", Self::Y)], "x or y")
    }
}

impl FromStr for Window {
    type Err = KeywordError;

    /// Reads `hann`.
    ///
    /// # Errors
    /// [`KeywordError`] for other words.
    fn from_str(text: &str) -> Result<Self, KeywordError> {
        among("window", text, [("hann", Self::Hann)], "hann")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_read_or_named() {
        assert_eq!("npy".parse(), Ok(Format::Npy));
        assert_eq!("text".parse(), Ok(Format::Text));
        assert_eq!("xyz".parse(), Ok(Format::Xyz));
        for format in Format::ALL {
            assert_eq!(format.word().parse(), Ok(format));
        }
        assert_eq!("point".parse(), Ok(Decimal::Point));
        assert_eq!("comma".parse(), Ok(Decimal::Comma));
        assert_eq!("xy".parse(), Ok(Axes::Xy));
        assert_eq!("yx".parse(), Ok(Axes::Yx));
        assert_eq!("none".parse(), Ok(Detrend::Nothing));
        assert_eq!("mean".parse(), Ok(Detrend::Mean));
        assert_eq!("plane".parse(), Ok(Detrend::Plane));
        assert_eq!("quadric".parse(), Ok(Detrend::Quadric));
        assert_eq!("median_difference".parse(), Ok(AlignLines::MedianDifference));
        assert_eq!("median".parse(), Ok(AlignLines::Median));
        assert_eq!("neighbours".parse(), Ok(Fill::Neighbours));
        assert_eq!("plane".parse(), Ok(Fill::Plane));
        assert_eq!("-2 um".parse(), Ok(Fill::Value("-2e-6 m".parse().unwrap())));
        assert_eq!("centre".parse(), Ok(Crop::Centre));
        assert_eq!("1, 2,3".parse(), Ok(Crop::Window { row: 1, column: 2, rows: 3, columns: 3 }));
        assert_eq!("1,2,3,4".parse(), Ok(Crop::Window { row: 1, column: 2, rows: 3, columns: 4 }));
        assert_eq!("no_contact".parse(), Ok(Undefined::NoContact));
        for (text, error) in [
            ("jpeg".parse::<Format>().unwrap_err(), "format = \"jpeg\": expected npy, text, xyz, profile, gwy"),
            ("dot".parse::<Decimal>().unwrap_err(), "decimal = \"dot\": expected point or comma"),
            ("zx".parse::<Axes>().unwrap_err(), "axes = \"zx\": expected xy or yx"),
            ("tilt".parse::<Detrend>().unwrap_err(), "detrend = \"tilt\": expected none, mean, plane, quadric, sphere or cylinder"),
            ("mean".parse::<AlignLines>().unwrap_err(), "align_lines = \"mean\": expected median_difference or median"),
            ("middle".parse::<Crop>().unwrap_err(), "crop = \"middle\": expected centre, defined, or row"),
            ("1,-2,3".parse::<Crop>().unwrap_err(), "crop = \"1,-2,3\": expected centre, defined, or row"),
            ("skip".parse::<Undefined>().unwrap_err(), "undefined = \"skip\": expected no_contact (fill gives"),
            (
                "2 Um".parse::<Fill>().unwrap_err(),
                "fill = \"2 Um\": expected neighbours, plane or a height such as \"-2 um\" (unknown unit \"Um\": upper and lower case differ, is it um?)",
            ),
        ]
        .map(|(found, expected)| (found.to_string(), expected))
        {
            assert!(text.starts_with(error), "{text}");
        }
    }
}
