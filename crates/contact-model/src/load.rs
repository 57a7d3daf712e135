//! What is prescribed in one solve.

use crate::error::{Result, non_negative};

/// What is prescribed in one solve: the normal force or the approach, never both.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Load {
    /// Normal force F >= 0.
    Force(f64),
    /// Approach d >= 0, from first touch of the highest point.
    Approach(f64),
}

impl Load {
    /// The load itself where it is finite and not negative.
    ///
    /// # Errors
    /// [`crate::Error::Domain`] with the value otherwise.
    pub fn validated(self) -> Result<Self> {
        match self {
            Self::Force(f) => non_negative("force", f)?,
            Self::Approach(d) => non_negative("approach", d)?,
        };
        Ok(self)
    }
}
