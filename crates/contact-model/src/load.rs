//! What is prescribed in one solve.

use crate::error::{Error, Result, non_negative};
use std::fmt;

/// What is prescribed in one solve: the normal force, the approach or the mean gap, never two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Load {
    /// Normal force F >= 0; with adhesion it may be negative (a pull).
    Force(f64),
    /// Approach d >= 0, from first touch of the highest point; with adhesion it may be negative (the bodies
    /// are drawn apart and a neck joins them).
    Approach(f64),
    /// Mean gap >= 0 over the rectangle, for periodic boundaries, where no approach is defined.
    MeanGap(f64),
}

impl Load {
    /// The load itself where it is finite and not negative.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value otherwise.
    pub fn validated(self) -> Result<Self> {
        match self {
            Self::Force(f) => non_negative("force", f)?,
            Self::Approach(d) => non_negative("approach", d)?,
            Self::MeanGap(g) => non_negative("mean_gap", g)?,
        };
        Ok(self)
    }

    /// The load itself where it is finite, of either sign: for models with adhesion, which can pull.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value otherwise, or for a negative mean gap.
    ///
    /// ```
    /// use contact_model::Load;
    /// assert!(Load::Force(-1.0).validated_with_adhesion().is_ok());
    /// assert!(Load::Force(f64::NAN).validated_with_adhesion().is_err());
    /// ```
    pub fn validated_with_adhesion(self) -> Result<Self> {
        let (name, value) = match self {
            Self::Force(f) => ("force", f),
            Self::Approach(d) => ("approach", d),
            Self::MeanGap(_) => return self.validated(),
        };
        if value.is_finite() { Ok(self) } else { Err(Error::domain(name, value, "a finite number")) }
    }

    /// The error for this load where it is below `smallest`, the smallest load of its kind that an adhesive
    /// contact can bear.
    pub fn pull_off(self, smallest: f64) -> Error {
        let (name, value) = match self {
            Self::Force(force) => ("force (the contact pulls off under a prescribed force)", force),
            Self::Approach(approach) => {
                ("approach (the contact pulls off under a prescribed approach)", approach)
            }
            Self::MeanGap(gap) => ("mean gap (the contact pulls off under a prescribed mean gap)", gap),
        };
        Error::OutOfRange { name: name.into(), value, min: smallest, max: f64::INFINITY }
    }
}

impl fmt::Display for Load {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, value) = match self {
            Self::Force(force) => ("a force", force),
            Self::Approach(approach) => ("an approach", approach),
            Self::MeanGap(gap) => ("a mean gap", gap),
        };
        write!(f, "{what} of {value}")
    }
}
