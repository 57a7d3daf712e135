//! Electrical (thermal) conductance from the stiffness.

use contact_model::{Error, Result};

/// Constriction conductance `Lambda = 2 k/(E* (rho1 + rho2))`, exact for any contact of half-spaces.
///
/// `stiffness` k in force per length, `modulus` E* in force per length squared, resistivities in resistance times length; the
/// result is 1/resistance. Source: Barber, Proc. R. Soc. A 459, 53 (2003); Sec. I and Eq. 13 of the paper.
///
/// # Errors
/// [`Error::Domain`] for a stiffness or resistivity that is negative or not finite, a modulus that is not positive or two
/// bodies without any resistance.
///
/// ```
/// // A circle of radius 1: k = 2 E* a = 2, rho = 1 each: Lambda = 2 (Holm).
/// assert_eq!(analysis::conductance(2.0, 1.0, 1.0, 1.0)?, 2.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn conductance(stiffness: f64, modulus: f64, resistivity1: f64, resistivity2: f64) -> Result<f64> {
    for (name, value) in
        [("stiffness", stiffness), ("resistivity1", resistivity1), ("resistivity2", resistivity2)]
    {
        if !(value.is_finite() && value >= 0.0) {
            return Err(Error::domain(name, value, "a finite number >= 0"));
        }
    }
    if !(modulus.is_finite() && modulus > 0.0) {
        return Err(Error::domain("modulus", modulus, "a finite number > 0"));
    }
    let lambda = 2.0 * stiffness / (modulus * (resistivity1 + resistivity2));
    if lambda.is_finite() {
        Ok(lambda)
    } else {
        Err(Error::domain("resistivity1 + resistivity2", resistivity1 + resistivity2, "a finite number > 0"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eq_13_factor() {
        // k = 0.18 x 1.1419 E* L gives 0.411 L/(rho1 + rho2), Eq. 13 (three printed digits).
        let lambda = conductance(0.18 * 1.1419, 1.0, 0.5, 0.5).unwrap();
        approx::assert_abs_diff_eq!(lambda, 0.411, epsilon = 5e-4);
    }

    #[test]
    fn bad_values_are_named() {
        assert!(conductance(-1.0, 1.0, 1.0, 1.0).is_err());
        assert!(conductance(1.0, 0.0, 1.0, 1.0).is_err());
        assert!(conductance(1.0, 1.0, 0.0, 0.0).is_err());
        assert!(conductance(1.0, 1.0, f64::NAN, 1.0).is_err());
    }
}
