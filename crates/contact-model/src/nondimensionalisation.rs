//! A problem's own units, so that solvers see numbers near 1 whatever the caller's units are.

use crate::error::{Error, Result, positive};

/// Units in which a model solves: horizontal lengths in `length`, vertical ones in `height`, moduli in
/// `contact_modulus`.
///
/// The unit of force is `E* length height`, that of stiffness `E* length`, that of area `length^2`. The
/// products are taken in an order that neither overflows nor underflows on the way, so a scene in units of
/// 1e-150 or 1e150 loses nothing; only a result that no `f64` can hold is an error. Numbers may have either
/// sign, because adhesion pulls.
///
/// This is arithmetic for solvers. The normalised quantities that are reported (`F_bar`, `k_bar`) belong to
/// [`crate::Normalisation`].
///
/// ```
/// use contact_model::Nondimensionalisation;
/// let nondimensional = Nondimensionalisation::new(1e150, 1e-150, 1e-150)?;
/// // A sphere of radius 2 lengths pressed 0.02 deep, solved in numbers near 1: k = 2 a.
/// let a: f64 = (0.02_f64 * 2.0).sqrt();
/// assert!((nondimensional.stiffness(2.0 * a)? - 0.4).abs() < 1e-15);
/// assert!(Nondimensionalisation::new(1e300, 1e300, 1.0)?.stiffness(1.0).is_err());
/// # Ok::<(), contact_model::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Nondimensionalisation {
    pub(crate) contact_modulus: f64,
    length: f64,
    height: f64,
}

impl Nondimensionalisation {
    /// Units of modulus, horizontal length and vertical height.
    ///
    /// # Errors
    /// [`Error::Domain`] for one that is not finite and positive or whose reciprocal overflows (below 6e-309).
    pub fn new(contact_modulus: f64, length: f64, height: f64) -> Result<Self> {
        for (name, unit) in [("contact_modulus", contact_modulus), ("length", length), ("height", height)] {
            positive(name, unit)?;
            if unit.recip().is_infinite() {
                return Err(Error::domain(
                    name,
                    unit,
                    "a number with a finite reciprocal (choose other units)",
                ));
            }
        }
        Ok(Self { contact_modulus, length, height })
    }

    /// The units of a body whose modulus is `factor` times as large.
    ///
    /// # Errors
    /// As [`Nondimensionalisation::new`].
    pub fn with_modulus_times(self, factor: f64) -> Result<Self> {
        Self::new(self.contact_modulus * factor, self.length, self.height)
    }

    /// `force / (E* length height)`, dimensionless; infinite or 0 where no `f64` holds it.
    pub fn force_in(self, force: f64) -> f64 {
        product([force, self.contact_modulus.recip(), self.length.recip(), self.height.recip()])
    }

    /// `length / unit`, dimensionless.
    pub fn length_in(self, length: f64) -> f64 {
        length / self.length
    }

    /// `approach / height`, dimensionless.
    pub fn approach_in(self, approach: f64) -> f64 {
        approach / self.height
    }

    /// `pressure length / (E* height)`, dimensionless; infinite or 0 where no `f64` holds it.
    pub fn pressure_in(self, pressure: f64) -> f64 {
        product([pressure, self.length, self.contact_modulus.recip(), self.height.recip()])
    }

    /// `value E* length height`, a force.
    ///
    /// # Errors
    /// [`Error::Domain`] where no `f64` holds it: it overflows, or a value other than 0 vanishes.
    pub fn force(self, value: f64) -> Result<f64> {
        held("force", value, product([value, self.contact_modulus, self.length, self.height]))
    }

    /// `value height`, an approach.
    ///
    /// # Errors
    /// As [`Nondimensionalisation::force`].
    pub fn approach(self, value: f64) -> Result<f64> {
        held("approach", value, value * self.height)
    }

    /// `value E* length`, a stiffness.
    ///
    /// # Errors
    /// As [`Nondimensionalisation::force`].
    pub fn stiffness(self, value: f64) -> Result<f64> {
        held("stiffness", value, product([value, self.contact_modulus, self.length]))
    }

    /// `value E* height / length`, a pressure.
    ///
    /// # Errors
    /// As [`Nondimensionalisation::force`].
    pub fn pressure(self, value: f64) -> Result<f64> {
        held("pressure", value, product([value, self.contact_modulus, self.height, self.length.recip()]))
    }

    /// `value length^2`, an area.
    ///
    /// # Errors
    /// As [`Nondimensionalisation::force`].
    pub fn area(self, value: f64) -> Result<f64> {
        held("area", value, product([value, self.length, self.length]))
    }
}

/// `result` unless it overflowed or a value other than 0 became 0 on the way out.
fn held(name: &'static str, value: f64, result: f64) -> Result<f64> {
    if result.is_finite() && (result.abs() > 0.0 || value.abs() <= 0.0) {
        Ok(result)
    } else {
        Err(Error::not_representable(name, result))
    }
}

/// Product of a number of either sign and units > 0 without overflow or underflow on the way: the largest
/// left while below 1, else the smallest.
fn product<const N: usize>(mut factors: [f64; N]) -> f64 {
    let sign = factors[0];
    factors[0] = sign.abs();
    factors.sort_by(f64::total_cmp);
    let (mut low, mut high) = (0, N);
    let mut result = 1.0;
    while low < high {
        if result < 1.0 {
            high -= 1;
            result *= factors[high];
        } else {
            result *= factors[low];
            low += 1;
        }
    }
    result.copysign(sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Four factors and three reciprocals, each rounded once.
    const ROUNDING: f64 = 8.0 * f64::EPSILON;

    #[test]
    fn there_and_back_at_extreme_scales() {
        for (contact_modulus, length) in
            [(1.0, 1.0), (1e-150, 1e150), (1e150, 1e-150), (1e10, 1e-150), (1e-10, 1e150)]
        {
            let nondimensional = Nondimensionalisation::new(contact_modulus, length, length).unwrap();
            for value in [1e-12, 0.37, 1e6, -0.37] {
                let force = nondimensional.force(value).unwrap();
                assert_relative_eq!(nondimensional.force_in(force), value, max_relative = ROUNDING);
            }
        }
    }

    #[test]
    fn what_no_number_holds_is_an_error() {
        let nondimensional = Nondimensionalisation::new(1e150, 1e150, 1e150).unwrap();
        assert!(
            nondimensional.force(1.0).is_err()
                && nondimensional.stiffness(1.0).is_ok()
                && nondimensional.area(1e10).is_err()
        );
        let nondimensional = Nondimensionalisation::new(1e-150, 1e-150, 1e-150).unwrap();
        let e = nondimensional.force(1.0).unwrap_err().to_string();
        assert!(e.starts_with("force = 0: expected"), "{e}");
        assert!(nondimensional.force(0.0).is_ok_and(|f| f <= 0.0) && nondimensional.force(-1.0).is_err());
        assert!(
            Nondimensionalisation::new(0.0, 1.0, 1.0).is_err()
                && Nondimensionalisation::new(1.0, 1e-310, 1.0).is_err()
        );
    }
}
