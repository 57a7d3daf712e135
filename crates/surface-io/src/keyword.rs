//! Words of scenes and command lines.

use crate::quantity::QuantityError;
use std::fmt;

/// A word that is not one of those expected.
#[derive(Debug, Clone, PartialEq)]
pub struct KeywordError {
    /// The option that expects a word.
    pub what: &'static str,
    /// The word, shortened.
    pub found: String,
    /// The words that are known.
    pub expected: String,
    /// Why it is no quantity either, for options that also accept one.
    pub quantity: Option<QuantityError>,
}

impl KeywordError {
    pub(crate) fn new(what: &'static str, found: &str, expected: impl Into<String>) -> Self {
        let found = found.chars().take(32).collect();
        Self { what, found, expected: expected.into(), quantity: None }
    }
}

/// What a word stands for among those that are known; what is said behind the list of them.
pub(crate) fn among<T, const N: usize>(
    what: &'static str,
    text: &str,
    known: [(&str, T); N],
    behind: &str,
) -> Result<T, KeywordError> {
    let words = known.each_ref().map(|(word, _)| *word);
    let found = known.into_iter().find(|(word, _)| *word == text);
    found.map(|(_, value)| value).ok_or_else(|| {
        let expected = match &words[..] {
            [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
            words => words.concat(),
        };
        KeywordError::new(what, text, expected + behind)
    })
}

/// Declares what is chosen by a word in scenes and on command lines: what the choice is called, what is said
/// behind the list of its words in errors, and the word of each.
macro_rules! keywords {
    (
        $(#[$about:meta])* $name:ident: $what:literal $(, $behind:literal)?;
        $($(#[$doc:meta])* $choice:ident = $word:literal,)*
    ) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name { $($(#[$doc])* $choice,)* }

        impl $name {
            /// All of them.
            pub const ALL: [Self; [$($word),*].len()] = [$(Self::$choice),*];

            /// The word that stands for it in scenes and on command lines.
            pub fn word(self) -> &'static str {
                match self { $(Self::$choice => $word,)* }
            }
        }

        impl std::str::FromStr for $name {
            type Err = $crate::keyword::KeywordError;

            /// Reads a word.
            ///
            /// # Errors
            /// [`KeywordError`](crate::KeywordError) for other words.
            fn from_str(text: &str) -> Result<Self, Self::Err> {
                let known = Self::ALL.map(|choice| (choice.word(), choice));
                $crate::keyword::among($what, text, known, concat!($($behind)?))
            }
        }
    };
}
pub(crate) use keywords;

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

#[cfg(test)]
mod tests {
    use crate::format::Format;
    use crate::options::{Axes, Decimal};
    use crate::preprocessing::{AlignLines, Crop, Detrend, Fill, Undefined};

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
