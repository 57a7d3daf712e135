//! Time dependence of the material.

use crate::error::{Error, Result, non_negative, positive};
use crate::pair::{Body, Pair};

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

    /// The relaxation of a material with the scene's modulus; `None` for an elastic one.
    ///
    /// # Errors
    /// As [`Rheology::validate`]; [`Error::Domain`] for a time `4 eta/E*` or a rate that no `f64` holds.
    pub fn spectrum(&self, contact_modulus: f64) -> Result<Option<RelaxationSpectrum>> {
        self.validate()?;
        let time = |viscosity: f64| {
            let time = 4.0 * (viscosity / contact_modulus);
            if time.is_normal() && time.recip().is_normal() {
                Ok(time)
            } else {
                Err(Error::not_representable("4 viscosity/modulus", time))
            }
        };
        let spectrum = match self {
            Self::Elastic => return Ok(None),
            Self::KelvinVoigt { viscosity } => RelaxationSpectrum::of(1.0, time(*viscosity)?, &[]),
            Self::Maxwell { viscosity } => {
                RelaxationSpectrum::of(0.0, 0.0, &[Relaxing { weight: 1.0, time: time(*viscosity)? }])
            }
            Self::StandardSolid { arm } => RelaxationSpectrum::of(1.0, 0.0, &[*arm]),
            Self::Prony(series) => RelaxationSpectrum::of(1.0, 0.0, series.arms()),
        };
        if spectrum.arms.iter().all(|arm| arm.rate.is_normal() && arm.weight.is_finite()) {
            Ok(Some(spectrum))
        } else {
            Err(Error::not_representable("1/relaxation time", f64::INFINITY))
        }
    }

    /// Checks that one function of time holds for all that deforms: one body beside a rigid one, or two of one material;
    /// and that viscosities mean what they say.
    ///
    /// # Errors
    /// [`Error::Unsupported`] by `model` for two bodies of different materials, which would relax each in its own way,
    /// and for a viscosity of two bodies; [`Error::Domain`] for a viscosity of a material that is not incompressible.
    pub fn check_pair(&self, pair: &Pair, model: &'static str) -> Result<()> {
        /// Numbers of a material may have been rounded.
        const SAME: f64 = 1e-9;
        let is_viscosity = matches!(self, Self::KelvinVoigt { .. } | Self::Maxwell { .. });
        let body = match (pair.first, pair.second) {
            (Body::Rigid, body) | (body, Body::Rigid) => body,
            (
                Body::Elastic { young: first, poisson: nu_first },
                Body::Elastic { young: second, poisson: nu_second },
            ) => {
                let is_one_material =
                    (first / second - 1.0).abs() <= SAME && (nu_first - nu_second).abs() <= SAME;
                if is_one_material && !is_viscosity {
                    return Ok(());
                }
                let what = if is_one_material {
                    "a viscosity of two bodies, which is that of one (take a standard solid or a Prony series)"
                } else {
                    "a rheology of two bodies of different materials, which would relax each in its own way \
                     (one has to be rigid, or both of one material)"
                };
                return Err(Error::unsupported(model, what));
            }
        };
        match body {
            Body::Elastic { poisson, .. } if is_viscosity && (poisson - 0.5).abs() > SAME => {
                let expected =
                    "1/2, for which viscosities are meant (a standard solid or Prony series has none)";
                Err(Error::domain("poisson", poisson, expected))
            }
            _ => Ok(()),
        }
    }
}

/// How the modulus of a material relaxes, over the scene's E*: `E*(t)/E* = e + sum w_i exp(-r_i t) + v delta(t)`.
#[derive(Debug, Clone, PartialEq)]
pub struct RelaxationSpectrum {
    /// e, 0 for a fluid.
    pub equilibrium: f64,
    /// v, a time: the dashpot of Kelvin and Voigt.
    pub viscous: f64,
    /// Arms with different rates, in ascending order.
    pub arms: Vec<RelaxingRate>,
}

/// An arm that relaxes, by its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelaxingRate {
    /// Its stiffness over E*, > 0.
    pub weight: f64,
    /// One over its relaxation time.
    pub rate: f64,
}

impl RelaxationSpectrum {
    fn of(equilibrium: f64, viscous: f64, relaxing: &[Relaxing]) -> Self {
        let mut arms: Vec<RelaxingRate> = relaxing
            .iter()
            .filter(|arm| arm.weight > 0.0)
            .map(|arm| RelaxingRate { weight: arm.weight, rate: arm.time.recip() })
            .collect();
        arms.sort_by(|a, b| a.rate.total_cmp(&b.rate));
        // Equal times are one arm.
        arms.dedup_by(|next, kept| {
            let same = next.rate <= kept.rate;
            kept.weight += if same { next.weight } else { 0.0 };
            same
        });
        Self { equilibrium, viscous, arms }
    }

    /// Whether a jump of the approach takes an infinite force.
    pub fn is_stiff(&self) -> bool {
        self.viscous > 0.0
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
/// four decades of time have four to twelve terms, and fits of master curves up to fifty.
///
/// ```
/// use contact_model::{PronySeries, Relaxing};
/// let series = PronySeries::new(&[Relaxing { weight: 2.0, time: 1.0 }, Relaxing { weight: 1.0, time: 10.0 }])?;
/// assert_eq!(series.arms().len(), 2);
/// assert!(PronySeries::new(&[Relaxing { weight: 1.0, time: 0.0 }]).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PronySeries {
    arms: [Relaxing; Self::MOST],
    count: usize,
}

impl Default for PronySeries {
    fn default() -> Self {
        Self { arms: [Relaxing { weight: 0.0, time: 0.0 }; Self::MOST], count: 0 }
    }
}

impl PronySeries {
    /// Most arms that a series can have.
    pub const MOST: usize = 64;

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
        assert!(PronySeries::new(&[arm; 64]).is_ok_and(|s| s.arms() == [arm; 64]));
        assert!(matches!(PronySeries::new(&[arm; 65]), Err(Error::Shape { found: 65, .. })));
    }

    #[test]
    fn times_out_of_range_are_errors() {
        assert!(Rheology::Maxwell { viscosity: 1e300 }.spectrum(1e-300).is_err());
        assert!(Rheology::Maxwell { viscosity: -1.0 }.spectrum(1.0).is_err());
        assert!(Rheology::Elastic.spectrum(1.0).unwrap().is_none());
        let arm = Relaxing { weight: 1.0, time: 1e-309 };
        assert!(Rheology::StandardSolid { arm }.spectrum(1.0).is_err());
    }

    #[test]
    fn a_spectrum_has_each_rate_once() {
        let arms =
            [(1.0, 2.0), (0.0, 5.0), (2.0, 2.0), (0.5, 4.0)].map(|(weight, time)| Relaxing { weight, time });
        let series = Rheology::Prony(PronySeries::new(&arms).unwrap());
        let spectrum = series.spectrum(7.0).unwrap().unwrap();
        let rates: Vec<_> = spectrum.arms.iter().map(|arm| (arm.weight, arm.rate)).collect();
        assert_eq!((spectrum.equilibrium, spectrum.is_stiff()), (1.0, false));
        assert_eq!(rates, [(0.5, 0.25), (3.0, 0.5)]);
        // Viscosities of an incompressible body in shear: a time eta/G with G = E*/4.
        let fluid = Rheology::Maxwell { viscosity: 6.0 }.spectrum(4.0).unwrap().unwrap();
        assert_eq!((fluid.equilibrium, fluid.arms[0].rate), (0.0, 1.0 / 6.0));
        let solid = Rheology::KelvinVoigt { viscosity: 6.0 }.spectrum(4.0).unwrap().unwrap();
        assert!(solid.is_stiff() && solid.viscous.to_bits() == 6f64.to_bits() && solid.arms.is_empty());
    }
}
