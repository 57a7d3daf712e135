//! The two bodies of a contact, where E* alone does not say enough.

use crate::error::{Error, Result, positive};

/// The material of one body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub enum Body {
    /// The body does not deform.
    #[default]
    Rigid,
    /// Isotropic and linearly elastic.
    Elastic {
        /// Young's modulus E > 0 (force per length squared).
        young: f64,
        /// Poisson's ratio nu in [0, 1/2].
        poisson: f64,
    },
}

impl Body {
    /// `[(1 - nu)/G, (2 - nu)/(4 G), (1 - 2 nu)/G]` with `G = E/(2 (1 + nu))`; zeros for a rigid body.
    fn compliances(self) -> Result<[f64; 3]> {
        match self {
            Self::Rigid => Ok([0.0; 3]),
            Self::Elastic { young, poisson } => {
                positive("young", young)?;
                if !(0.0..=0.5).contains(&poisson) {
                    return Err(Error::domain("poisson", poisson, "a number in [0, 1/2]"));
                }
                let shear = young / (2.0 * (1.0 + poisson));
                Ok([(1.0 - poisson) / shear, (2.0 - poisson) / (4.0 * shear), (1.0 - 2.0 * poisson) / shear])
            }
        }
    }
}

/// The two bodies of a contact, which determine E* for normal and G* for tangential loads.
///
/// Tangential loads move the second over the first ([`crate::Tangential`]); nothing else depends on which is
/// which.
///
/// ```
/// use contact_model::{Body, Pair};
/// // A rigid body on one with E = 3, nu = 1/2 (G = 1): E* = 3/(1 - 1/4) = 4, G* = 4 G/(2 - nu) = 8/3.
/// let pair = Pair { first: Body::Rigid, second: Body::Elastic { young: 3.0, poisson: 0.5 } };
/// assert!((pair.contact_modulus()? - 4.0).abs() < 1e-15);
/// assert!((pair.shear_modulus()? - 8.0 / 3.0).abs() < 1e-15);
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// One body.
    pub first: Body,
    /// The other.
    pub second: Body,
}

impl Pair {
    /// Contact modulus E*: `1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2` (force per length squared).
    ///
    /// # Errors
    /// [`Error::Domain`] for a Young's modulus that is not positive, a Poisson's ratio outside [0, 1/2], two
    /// rigid bodies, or a result that no `f64` holds.
    pub fn contact_modulus(&self) -> Result<f64> {
        // (1 - nu^2)/E = (1 - nu)/(2 G).
        let [first, second] = self.compliances(0)?;
        held("contact_modulus", (0.5 * (first + second)).recip())
    }

    /// Effective shear modulus: `1/G* = (2 - nu1)/(4 G1) + (2 - nu2)/(4 G2)`; a round contact without slip
    /// has `k_x = 2 G* a`.
    ///
    /// Then `k_x / k_z = G*/E* = (2 - 2 nu)/(2 - nu)` where the bodies are alike or one is rigid (Mindlin
    /// 1949).
    ///
    /// # Errors
    /// As [`Pair::contact_modulus`].
    pub fn shear_modulus(&self) -> Result<f64> {
        let [first, second] = self.compliances(1)?;
        held("shear_modulus", (first + second).recip())
    }

    /// Dundurs' second constant,
    /// `beta = ((1 - 2 nu1)/G1 - (1 - 2 nu2)/G2) / (2 ((1 - nu1)/G1 + (1 - nu2)/G2))`, in [-1/2, 1/2].
    ///
    /// Normal and tangential problems are independent of each other exactly when it is 0: bodies that are
    /// alike, or a rigid one on an incompressible one. Theories of friction that take them as independent
    /// neglect terms of this order.
    ///
    /// # Errors
    /// As [`Pair::contact_modulus`].
    pub fn coupling(&self) -> Result<f64> {
        let [normal_first, normal_second] = self.compliances(0)?;
        let [first, second] = self.compliances(2)?;
        let normal = normal_first + normal_second;
        held("contact_modulus", normal.recip())?;
        Ok(0.5 * (first / normal - second / normal))
    }

    fn compliances(&self, which: usize) -> Result<[f64; 2]> {
        Ok([self.first.compliances()?[which], self.second.compliances()?[which]])
    }
}

/// A modulus that is a number: neither two rigid bodies nor out of the range of f64.
fn held(name: &'static str, value: f64) -> Result<f64> {
    if value.is_finite() && value > 0.0 {
        Ok(value)
    } else {
        Err(Error::domain(
            name,
            value,
            "a finite number > 0: at least one elastic body, moduli between 1e-308 and 1e308",
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::{assert_abs_diff_eq, assert_relative_eq};

    /// A handful of products.
    const ROUNDING: f64 = 1e-15;

    fn elastic(young: f64, poisson: f64) -> Body {
        Body::Elastic { young, poisson }
    }

    #[test]
    fn moduli_of_steel_on_steel() {
        let steel = elastic(210e9, 0.3);
        let pair = Pair { first: steel, second: steel };
        assert_relative_eq!(pair.contact_modulus().unwrap(), 210e9 / (2.0 * 0.91), max_relative = ROUNDING);
        // k_x / k_z = (2 - 2 nu)/(2 - nu) = 1.4/1.7.
        let ratio = pair.shear_modulus().unwrap() / pair.contact_modulus().unwrap();
        assert_relative_eq!(ratio, 1.4 / 1.7, max_relative = ROUNDING);
        assert_abs_diff_eq!(pair.coupling().unwrap(), 0.0);
        let on_rigid = Pair { second: Body::Rigid, ..pair };
        assert_relative_eq!(
            on_rigid.contact_modulus().unwrap(),
            2.0 * pair.contact_modulus().unwrap(),
            max_relative = ROUNDING
        );
        // beta = (1 - 2 nu)/(2 (1 - nu)) = 0.4/1.4.
        assert_relative_eq!(on_rigid.coupling().unwrap(), 0.4 / 1.4, max_relative = ROUNDING);
    }

    #[test]
    fn bodies_that_make_no_sense() {
        let pair = |first, second| Pair { first, second };
        assert!(pair(Body::Rigid, Body::Rigid).contact_modulus().is_err());
        assert!(pair(Body::Rigid, Body::Rigid).coupling().is_err());
        for (young, poisson) in [(0.0, 0.3), (-1.0, 0.3), (f64::NAN, 0.3), (1.0, 0.51), (1.0, f64::NAN)] {
            assert!(pair(Body::Rigid, elastic(young, poisson)).shear_modulus().is_err());
        }
        assert!(pair(Body::Rigid, elastic(1e-310, 0.3)).contact_modulus().is_err());
    }
}
