//! Area against force.

use contact_model::{Error, Result};

/// `kappa = A E* |grad h|/F`, the factor of `A = kappa F/(E* |grad h|)`, dimensionless (not the kappa_n of a
/// body r^n).
///
/// `area` A in length squared, `slope` |grad h| the rms slope of the surface. Source: Sec. I of the paper
/// ("near 2").
///
/// # Errors
/// [`Error::Domain`] for a force, modulus or slope that is not finite and positive, or an area that is
/// negative or not finite.
///
/// ```
/// assert_eq!(analysis::kappa(0.02, 0.01, 1.0, 1.0)?, 2.0);
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn kappa(area: f64, force: f64, contact_modulus: f64, slope: f64) -> Result<f64> {
    for (name, value) in [("force", force), ("contact_modulus", contact_modulus), ("slope", slope)] {
        if !(value.is_finite() && value > 0.0) {
            return Err(Error::domain(name, value, "a finite number > 0"));
        }
    }
    if !(area.is_finite() && area >= 0.0) {
        return Err(Error::domain("area", area, "a finite number >= 0"));
    }
    Ok(area * contact_modulus * slope / force)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bad_values_are_named() {
        assert!(kappa(0.1, 0.0, 1.0, 1.0).is_err());
        assert!(kappa(0.1, 1.0, 1.0, f64::NAN).is_err());
        assert!(kappa(-0.1, 1.0, 1.0, 1.0).is_err());
        approx::assert_abs_diff_eq!(kappa(0.0, 1.0, 1.0, 1.0).unwrap(), 0.0);
    }
}
