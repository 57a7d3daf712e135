//! Paths of loads, as sequences of straight steps.

use crate::error::{Error, Result};
use crate::load::Load;
use std::fmt;

/// The tangential load: its components along x (columns of a map) and along y (rows). Signed: the second body
/// is moved over the first ([`crate::Pair`]). Which one is which matters to full coupling alone
/// ([`crate::Coupling`]).
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Tangential {
    /// Tangential force that the second body exerts on the first, at most mu F in size. At mu F the whole contact
    /// slides, and its displacement is the least at which it does; a model may give that to a relative 1e-6.
    Force([f64; 2]),
    /// Tangential displacement of the second body relative to the first, far from the contact.
    Displacement([f64; 2]),
}

impl Tangential {
    /// A force along x alone.
    pub fn force_along_x(force: f64) -> Self {
        Self::Force([force, 0.0])
    }

    /// A displacement along x alone.
    pub fn displacement_along_x(displacement: f64) -> Self {
        Self::Displacement([displacement, 0.0])
    }

    /// Both components, whichever quantity is prescribed.
    pub fn components(self) -> [f64; 2] {
        match self {
            Self::Force(components) | Self::Displacement(components) => components,
        }
    }

    /// Whether nothing is prescribed but zeros.
    pub fn is_zero(self) -> bool {
        self.components().iter().all(|component| component.abs() <= 0.0)
    }

    /// Refuses a component along y, for models that work along x alone.
    ///
    /// # Errors
    /// [`Error::Unsupported`] naming the model and the component, unless that is 0.
    ///
    /// ```
    /// use contact_model::Tangential;
    /// assert!(Tangential::Force([3.0, 0.0]).refuse_y("mine").is_ok());
    /// let refused = Tangential::Displacement([3.0, 4.0]).refuse_y("mine").unwrap_err().to_string();
    /// assert_eq!(
    ///     refused,
    ///     "the model mine does not support a tangential displacement along y (4): it takes the component along x alone"
    /// );
    /// ```
    pub fn refuse_y(self, model: &'static str) -> Result<()> {
        let [_, y] = self.components();
        if y.abs() <= 0.0 {
            return Ok(());
        }
        let what = format!("a {} along y ({y}): it takes the component along x alone", self.words());
        Err(Error::unsupported(model, what))
    }

    /// What is prescribed.
    fn words(self) -> &'static str {
        match self {
            Self::Force(_) => "tangential force",
            Self::Displacement(_) => "tangential displacement",
        }
    }
}

impl fmt::Display for Tangential {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y] = self.components();
        write!(f, "a {} of ({x}, {y})", self.words())
    }
}

/// Directions of the tangential loads that a model answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Directions {
    /// Along x alone, to and fro.
    AlongX,
    /// Any direction of the plane, which may change along the path.
    Plane,
}

impl Default for Tangential {
    /// No tangential force.
    fn default() -> Self {
        Self::Force([0.0; 2])
    }
}

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
    /// [`Error::Domain`] for a time before `last`, a normal load as [`Load::validated`], or a component of the
    /// tangential load that is not finite.
    pub fn validated(self, last: f64) -> Result<Self> {
        self.normal.validated()?;
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
        self.normal.validated_with_adhesion()?;
        for (component, along) in self.tangential.components().into_iter().zip(["x", "y"]) {
            if !component.is_finite() {
                let name = format!("{} along {along}", self.tangential.words());
                return Err(Error::domain(name, component, "a finite number"));
            }
        }
        Ok(self)
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
        for (load, component) in [
            (Tangential::Force([f64::NAN, 0.0]), "tangential force along x"),
            (Tangential::Force([0.0, f64::INFINITY]), "tangential force along y"),
            (Tangential::Displacement([0.0, f64::NAN]), "tangential displacement along y"),
        ] {
            let refused = Step { tangential: load, ..step }.validated(0.0).unwrap_err();
            assert!(refused.to_string().starts_with(&format!("{component} = ")), "{refused}");
        }
        assert!(Step { tangential: Tangential::Displacement([-3.0, 2.0]), ..step }.validated(0.0).is_ok());
        assert!(Tangential::default().is_zero() && Tangential::Displacement([-0.0, 0.0]).is_zero());
        assert!(!Tangential::Force([0.0, 1e-300]).is_zero() && !Tangential::Force([f64::NAN, 0.0]).is_zero());
    }
}
