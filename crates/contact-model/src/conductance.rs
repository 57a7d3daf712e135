//! Conductance through a contact.

use crate::error::{Error, Result, non_negative, positive};

/// Conductance through the contact of two half-spaces: `Lambda = 2 k/(E* (rho_1 + rho_2))` (Barber 2003; Eq.
/// 13 of the paper), with the stiffness k at fixed contact area
/// ([`crate::ContactState::stiffness_fixed_area`]).
///
/// The formula is exact for any contact area, periodic or not, because potential and normal displacement are
/// the same harmonic function. The bodies conduct through the real contact only: films and radiation are
/// neglected, cells at the hardness conduct, and an attraction across a gap does not. The conductance costs
/// nothing beyond that stiffness.
///
/// ```
/// use contact_model::Conductance;
/// // A circle of radius 1 (k = 2 E* a) between bodies of resistivity 1: Holm's constriction, Lambda = 2.
/// let electrical = Conductance::Electrical { first: 1.0, second: 1.0 };
/// assert_eq!(electrical.of(2.0, 1.0)?, Some(2.0));
/// // In heat, conductivities of 2 (resistivities of 1/2): twice as much.
/// assert_eq!(Conductance::Thermal { first: 2.0, second: 2.0 }.of(2.0, 1.0)?, Some(4.0));
/// assert_eq!(Conductance::Off.of(2.0, 1.0)?, None);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Conductance {
    /// No conductance is computed.
    #[default]
    Off,
    /// Electrical conductance: resistivities of both bodies >= 0 (resistance times length), not both 0.
    Electrical {
        /// Resistivity rho_1 of one body.
        first: f64,
        /// Resistivity rho_2 of the other.
        second: f64,
    },
    /// Thermal conductance: conductivities of both bodies > 0 (power per length and temperature).
    Thermal {
        /// Conductivity of one body, `1/rho_1`.
        first: f64,
        /// Conductivity of the other.
        second: f64,
    },
}

impl Conductance {
    /// `rho_1 + rho_2`; `None` where it is off.
    ///
    /// # Errors
    /// [`Error::Domain`] for a resistivity that is negative, a conductivity that is not positive, a number
    /// that is not finite, or a sum that is 0 or that no f64 holds.
    pub fn resistivity(self) -> Result<Option<f64>> {
        let (first, second) = match self {
            Self::Off => return Ok(None),
            Self::Electrical { first, second } => {
                (non_negative("resistivity", first)?, non_negative("resistivity", second)?)
            }
            Self::Thermal { first, second } => {
                (positive("conductivity", first)?.recip(), positive("conductivity", second)?.recip())
            }
        };
        let sum = first + second;
        if sum.is_finite() && sum > 0.0 {
            Ok(Some(sum))
        } else {
            Err(Error::domain("resistivity of both bodies", sum, "a finite number > 0"))
        }
    }

    /// The conductance of a contact with this stiffness k between bodies with this E*; `None` where it is
    /// off.
    ///
    /// # Errors
    /// As [`Conductance::resistivity`]; [`Error::Domain`] for a stiffness that is negative, a modulus that is
    /// not positive, or a result that no f64 holds.
    pub fn of(self, stiffness: f64, contact_modulus: f64) -> Result<Option<f64>> {
        let Some(resistivity) = self.resistivity()? else { return Ok(None) };
        non_negative("stiffness", stiffness)?;
        positive("contact_modulus", contact_modulus)?;
        let conductance = 2.0 * (stiffness / contact_modulus) / resistivity;
        if conductance.is_finite() && (conductance > 0.0 || stiffness <= 0.0) {
            Ok(Some(conductance))
        } else {
            Err(Error::not_representable("conductance", conductance))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_13_factor() {
        // k = 0.18 x 1.1419 E* L gives 0.411 L/(rho1 + rho2), Eq. 13 (three printed digits).
        let lambda = Conductance::Electrical { first: 0.25, second: 0.75 }.of(0.18 * 1.1419, 1.0).unwrap();
        approx::assert_abs_diff_eq!(lambda.unwrap(), 0.411, epsilon = 5e-4);
    }

    #[test]
    fn one_body_may_be_a_perfect_conductor_but_not_both() {
        assert_eq!(Conductance::Electrical { first: 0.0, second: 1.0 }.of(1.0, 1.0).unwrap(), Some(2.0));
        for off in [
            Conductance::Electrical { first: 0.0, second: 0.0 },
            Conductance::Electrical { first: -1.0, second: 2.0 },
            Conductance::Electrical { first: f64::NAN, second: 2.0 },
            Conductance::Thermal { first: 0.0, second: 1.0 },
            Conductance::Thermal { first: f64::INFINITY, second: 1.0 },
            Conductance::Thermal { first: 1e-310, second: 1.0 },
        ] {
            assert!(off.of(1.0, 1.0).is_err(), "{off:?}");
        }
        let on = Conductance::Thermal { first: 1.0, second: 1.0 };
        assert!(on.of(-1.0, 1.0).is_err() && on.of(1.0, 0.0).is_err() && on.of(1e300, 1e-300).is_err());
        assert_eq!(on.of(0.0, 1.0).unwrap(), Some(0.0));
    }
}
