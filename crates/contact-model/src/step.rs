//! Paths of loads: what happens is a sequence of straight steps.

use crate::error::{Error, Result};
use crate::load::Load;

/// The tangential load, in one fixed direction. Signed.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tangential {
    /// Tangential force.
    Force(f64),
    /// Tangential displacement of the bodies relative to each other, far from the contact.
    Displacement(f64),
}

impl Default for Tangential {
    /// No tangential force.
    fn default() -> Self {
        Self::Force(0.0)
    }
}

/// The end of a straight segment of a path; it begins where the last one ended. Before the first step: time
/// 0, no contact, no load.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Time at the end of the segment; it never decreases. Equal times are a jump. Friction alone does not
    /// look at it.
    pub time: f64,
    /// Normal load at the end.
    pub normal: Load,
    /// Tangential load at the end.
    pub tangential: Tangential,
}

impl Step {
    /// A step of the normal load alone.
    pub fn normal(time: f64, normal: Load) -> Self {
        Self { time, normal, tangential: Tangential::default() }
    }

    /// The step itself where its numbers make sense after a step that ended at `last`.
    ///
    /// # Errors
    /// [`Error::Domain`] for a time before `last`, a normal load as [`Load::validated`], or a tangential load that is not finite.
    pub fn validated(self, last: f64) -> Result<Self> {
        self.normal.validated()?;
        self.validated_with_adhesion(last)
    }

    /// The same for models with adhesion, which can pull.
    ///
    /// # Errors
    /// As [`Step::validated`], with [`Load::validated_with_adhesion`].
    pub fn validated_with_adhesion(self, last: f64) -> Result<Self> {
        if !(self.time.is_finite() && self.time >= last) {
            return Err(Error::domain(
                "time",
                self.time,
                format!("a finite number >= {last}, the last time"),
            ));
        }
        self.normal.validated_with_adhesion()?;
        let (name, value) = match self.tangential {
            Tangential::Force(force) => ("tangential force", force),
            Tangential::Displacement(displacement) => ("tangential displacement", displacement),
        };
        if value.is_finite() { Ok(self) } else { Err(Error::domain(name, value, "a finite number")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_checked() {
        let step = Step::normal(1.0, Load::Force(1.0));
        assert!(step.validated(0.0).is_ok() && step.validated(1.0).is_ok());
        let late = step.validated(2.0).unwrap_err().to_string();
        assert_eq!(late, "time = 1: expected a finite number >= 2, the last time");
        assert!(Step { normal: Load::Force(-1.0), ..step }.validated(0.0).is_err());
        assert!(Step { tangential: Tangential::Force(f64::NAN), ..step }.validated(0.0).is_err());
        assert!(Step { tangential: Tangential::Displacement(-3.0), ..step }.validated(0.0).is_ok());
    }
}
