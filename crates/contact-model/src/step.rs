//! Paths of loads, as sequences of straight steps.

use crate::error::{Error, Result};
use crate::load::Load;

/// The end of a straight segment of a path; the segment begins where the last one ended. Before the first
/// step the time is 0 and there is no contact and no load.
///
/// The state at the end is exact for the model, however long the segment is. Friction that is solved cell by
/// cell is the exception: there a step is one increment. Where a model holds for a part of the segment only,
/// the error names how far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// Time at the end of the segment; it never decreases. Equal times are a jump. With friction alone the
    /// time has no influence.
    pub time: f64,
    /// Load at the end.
    pub load: Load,
}

impl Step {
    /// A step to this load.
    pub fn new(time: f64, load: Load) -> Self {
        Self { time, load }
    }

    /// The step itself where its numbers make sense after a step that ended at `last`.
    ///
    /// # Errors
    /// [`Error::Domain`] for a time before `last`, and as [`Load::validated`].
    pub fn validated(self, last: f64) -> Result<Self> {
        self.load.validated()?;
        self.validated_with_adhesion(last)
    }

    /// As [`Step::validated`], for models with adhesion, which can pull.
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
        self.load.validated_with_adhesion()?;
        Ok(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::load::Tangential;

    #[test]
    fn steps_are_checked() {
        let step = Step::new(1.0, Load::force(1.0));
        assert!(step.validated(0.0).is_ok() && step.validated(1.0).is_ok());
        let late = step.validated(2.0).unwrap_err().to_string();
        assert_eq!(late, "time = 1: expected a finite number >= 2, the last time");
        assert!(Step { load: Load::force(-1.0), ..step }.validated(0.0).is_err());
        for (load, component) in [
            (Tangential::Force([f64::NAN, 0.0]), "tangential force along x"),
            (Tangential::Force([0.0, f64::INFINITY]), "tangential force along y"),
            (Tangential::Displacement([0.0, f64::NAN]), "tangential displacement along y"),
        ] {
            let refused = Step { load: step.load.with_tangential(load), ..step }.validated(0.0).unwrap_err();
            assert!(refused.to_string().starts_with(&format!("{component} = ")), "{refused}");
        }
        let moved = step.load.with_tangential(Tangential::Displacement([-3.0, 2.0]));
        assert!(Step { load: moved, ..step }.validated(0.0).is_ok());
        assert!(Tangential::default().is_zero() && Tangential::Displacement([-0.0, 0.0]).is_zero());
        assert!(!Tangential::Force([0.0, 1e-300]).is_zero() && !Tangential::Force([f64::NAN, 0.0]).is_zero());
    }
}
