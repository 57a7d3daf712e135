//! Electrical (thermal) conductance from the stiffness.

use contact_model::{Conductance, Result};

/// Constriction conductance `Lambda = 2 k/(E* (rho1 + rho2))` of half-spaces, exact for the stiffness k at
/// fixed contact area ([`contact_model::ContactState::stiffness_fixed_area`]).
///
/// The slope dF/dd equals that stiffness only without hardness and adhesion. With a hardness the slope leaves
/// out the saturated cells, although they conduct. With adhesion it includes moving fronts and attraction
/// across gaps, which do not conduct.
///
/// This is the formula of [`Conductance`] for a fitted or averaged stiffness; a state has its own conductance
/// on request. `stiffness` k in force per length, `contact_modulus` E* in force per length squared,
/// resistivities in resistance times length; the result is 1/resistance. Source: Barber, Proc. R. Soc. A 459,
/// 53 (2003); Sec. I and Eq. 13 of the paper.
///
/// # Errors
/// [`contact_model::Error::Domain`] for a stiffness or resistivity that is negative or not finite, a modulus
/// that is not positive or two bodies without any resistance.
///
/// ```
/// // A circle of radius 1: k = 2 E* a = 2, rho = 1 each: Lambda = 2 (Holm).
/// assert_eq!(analysis::conductance(2.0, 1.0, 1.0, 1.0)?, 2.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn conductance(
    stiffness: f64,
    contact_modulus: f64,
    resistivity1: f64,
    resistivity2: f64,
) -> Result<f64> {
    let asked = Conductance::Electrical { first: resistivity1, second: resistivity2 };
    // It is on, so it is there.
    Ok(asked.of(stiffness, contact_modulus)?.unwrap_or_default())
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
