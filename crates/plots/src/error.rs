//! The one error type of this crate; it names the picture.

/// Result of everything that draws.
pub type Result<T, E = Error> = std::result::Result<T, E>;

/// A picture that cannot be drawn.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{picture}: {reason}")]
pub struct Error {
    /// The picture, as the caller named it, or the font.
    pub picture: String,
    /// The reason, in words.
    pub reason: String,
}

impl Error {
    pub(crate) fn new(picture: &str, reason: impl Into<String>) -> Self {
        Self { picture: picture.to_owned(), reason: reason.into() }
    }
}
