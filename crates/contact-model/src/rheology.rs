//! Time dependence of the material.

use crate::error::{Error, Result, non_negative, positive};

/// Time dependence of the material: `F/F_elastic` after a step of the approach is `E*(t)/E*`, with E* the
/// scene's modulus.
///
/// Poisson's ratio does not change with time, so `E*(t)` follows the shear modulus: `G(t) = (1 - nu)/2 E*(t)`
/// for a rigid indenter on one viscoelastic body. Viscosities are those of an incompressible body (nu = 1/2)
/// in shear: `E* = 4 G`.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
#[allow(clippy::large_enum_variant)] // A plain value that is copied a few times per scene.
pub enum Rheology {
    /// None.
    #[default]
    Elastic,
    /// Kelvin-Voigt element with this viscosity, of a material with nu = 1/2: a spring (the scene's E* = 4 G)
    /// beside a dashpot.
    KelvinVoigt {
        /// Viscosity eta.
        viscosity: f64,
    },
    /// Maxwell element of a material with nu = 1/2: a spring (the scene's E* = 4 G) and a dashpot in series,
    /// `E*(t) = E* exp(-G t / eta)`. It flows: no load is carried for ever.
    Maxwell {
        /// Viscosity eta.
        viscosity: f64,
    },
    /// Standard solid (Zener): the scene's E* is the modulus after infinite time, `E*(t) = E* (1 + weight
    /// exp(-t / time))`.
    StandardSolid {
        /// The arm that relaxes.
        arm: Relaxing,
    },
    /// Prony series: the scene's E* is the modulus after infinite time, `E*(t) = E* (1 + sum weight_i exp(-t
    /// / time_i))`.
    Prony(PronySeries),
}

impl Rheology {
    /// Checks the parameters.
    ///
    /// # Errors
    /// [`Error::Domain`] with the first value that makes no sense.
    pub fn validate(&self) -> Result<()> {
        match self {
            // The terms of a series are checked when it is made.
            Self::Elastic | Self::Prony(_) => {}
            Self::KelvinVoigt { viscosity } | Self::Maxwell { viscosity } => {
                positive("viscosity", *viscosity)?;
            }
            Self::StandardSolid { arm } => arm.validate()?,
        }
        Ok(())
    }
}

/// An arm that relaxes: a spring and a dashpot in series, beside the spring that remains.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Relaxing {
    /// Its stiffness over that of the spring that remains, >= 0.
    pub weight: f64,
    /// Its relaxation time > 0.
    pub time: f64,
}

impl Relaxing {
    /// Checks both numbers.
    ///
    /// # Errors
    /// [`Error::Domain`] with the value.
    pub fn validate(&self) -> Result<()> {
        non_negative("weight of a relaxing arm", self.weight)?;
        positive("relaxation time", self.time)?;
        Ok(())
    }
}

/// Relaxing arms with different times, at most [`PronySeries::MOST`] of them.
///
/// The number of places is fixed so that [`crate::Effects`] can be copied like a number; measured series over
/// four decades of time have four to twelve terms.
///
/// ```
/// use contact_model::{PronySeries, Relaxing};
/// let series = PronySeries::new(&[Relaxing { weight: 2.0, time: 1.0 }, Relaxing { weight: 1.0, time: 10.0 }])?;
/// assert_eq!(series.arms().len(), 2);
/// assert!(PronySeries::new(&[Relaxing { weight: 1.0, time: 0.0 }]).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PronySeries {
    arms: [Relaxing; Self::MOST],
    count: usize,
}

impl PronySeries {
    /// Most arms that a series can have.
    pub const MOST: usize = 16;

    /// A series of these arms.
    ///
    /// # Errors
    /// [`Error::Shape`] for more than [`PronySeries::MOST`]; [`Error::Domain`] for a weight or time that
    /// makes no sense.
    pub fn new(arms: &[Relaxing]) -> Result<Self> {
        let mut series = Self::default();
        let Some(places) = series.arms.get_mut(..arms.len()) else {
            return Err(Error::Shape {
                name: "Prony series".into(),
                found: arms.len(),
                expected: format!("at most {}", Self::MOST).into(),
            });
        };
        for arm in arms {
            arm.validate()?;
        }
        places.copy_from_slice(arms);
        series.count = arms.len();
        Ok(series)
    }

    /// The arms, in the order given.
    pub fn arms(&self) -> &[Relaxing] {
        &self.arms[..self.count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_checked() {
        assert!(Rheology::Elastic.validate().is_ok());
        assert!(Rheology::Maxwell { viscosity: 0.0 }.validate().is_err());
        assert!(Rheology::KelvinVoigt { viscosity: f64::NAN }.validate().is_err());
        let arm = Relaxing { weight: -1.0, time: 1.0 };
        assert!(Rheology::StandardSolid { arm }.validate().is_err() && PronySeries::new(&[arm]).is_err());
        let arm = Relaxing { weight: 0.0, time: 1.0 };
        assert!(PronySeries::new(&[arm; 16]).is_ok_and(|s| s.arms() == [arm; 16]));
        assert!(matches!(PronySeries::new(&[arm; 17]), Err(Error::Shape { found: 17, .. })));
    }
}
