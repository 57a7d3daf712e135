//! Flags whose value is one of several words.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// The words of a flag, each with its value and its text in the help.
pub type Words<T> = &'static [(&'static str, T, &'static str)];

/// Reads one of the words.
pub fn words<T: Copy + Send + Sync + 'static>(all: Words<T>) -> impl TypedValueParser<Value = T> {
    let known = all.iter().map(|(word, _, help)| PossibleValue::new(*word).help(*help));
    PossibleValuesParser::new(known).try_map(|word| {
        all.iter().find(|(known, ..)| *known == word).map(|(_, value, _)| *value).ok_or("unknown value")
    })
}
