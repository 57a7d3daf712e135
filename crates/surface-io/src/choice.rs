//! The choice of one of several channels.

use std::fmt;
use std::str::FromStr;

/// The choice of a channel of a file.
///
/// ```
/// use surface_io::ChannelChoice;
/// assert_eq!("2".parse(), Ok(ChannelChoice::Number(2)));
/// assert_eq!("ZSensor".parse(), Ok(ChannelChoice::Name("ZSensor".into())));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum ChannelChoice {
    /// By its number, counted from 0.
    Number(usize),
    /// By its name, which no other channel may have.
    Name(String),
}

impl FromStr for ChannelChoice {
    type Err = std::convert::Infallible;

    /// A whole number, or else a name.
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        Ok(text.trim().parse().map_or_else(|_| Self::Name(text.trim().to_owned()), Self::Number))
    }
}

impl fmt::Display for ChannelChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) => write!(f, "{number}"),
            Self::Name(name) => write!(f, "{name:?}"),
        }
    }
}
