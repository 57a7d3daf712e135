//! The only place that divides by `E* h L`.

use crate::error::{Error, Result};
use crate::load::Load;

/// The paper's saturation stiffness, `k_s = 1.1419 E* L` (Sec. II), which is the unit of `k_bar`.
///
/// It is `1.012 x 2/sqrt(pi)`, an old value for the rigid square punch; the converged one is 1.152298, so the
/// continuum plateau of `k_bar` is 1.0091. It stays the unit because Eq. 8 defines `k_bar` with it.
pub const PAPER_STIFFNESS_FACTOR: f64 = 1.1419;

/// Normalisation of one surface: what turns forces and stiffnesses into `F_bar` and `k_bar`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Normalisation {
    /// Contact modulus E* (force per length squared).
    pub contact_modulus: f64,
    /// `L = sqrt(Lx Ly)` of the nominal contact area: the side of a square (also for the 1D line that stands
    /// for it).
    pub length: f64,
    /// Measured rms height of this surface; `None` for a body without one (a sphere, a punch).
    pub height: Option<f64>,
}

impl Normalisation {
    /// `F_bar = F / (E* h L)` (Eq. 10), dimensionless.
    ///
    /// # Errors
    /// [`Error::Domain`] when the surface has no rms height, or one of 0.
    pub fn force_bar(&self, force: f64) -> Result<f64> {
        Ok(force / self.force_unit()?)
    }

    /// `F = F_bar E* h L`: the inverse of [`Normalisation::force_bar`].
    ///
    /// # Errors
    /// As [`Normalisation::force_bar`].
    pub fn force(&self, force_bar: f64) -> Result<f64> {
        Ok(force_bar * self.force_unit()?)
    }

    /// The forces of a list of `F_bar`, as [`crate::PreparedContact::sweep`] takes them.
    ///
    /// # Errors
    /// As [`Normalisation::force_bar`].
    pub fn loads(&self, force_bar: &[f64]) -> Result<Vec<Load>> {
        force_bar.iter().map(|&f| self.force(f).map(Load::force)).collect()
    }

    /// `k_bar = k / (1.1419 E* L)` (Eq. 8), dimensionless.
    pub fn stiffness_bar(&self, stiffness: f64) -> f64 {
        stiffness / (PAPER_STIFFNESS_FACTOR * self.contact_modulus * self.length)
    }

    /// Contact length `k / E*` (Eq. 1), a length.
    pub fn contact_length(&self, stiffness: f64) -> f64 {
        stiffness / self.contact_modulus
    }

    /// `d / h`, dimensionless.
    ///
    /// # Errors
    /// As [`Normalisation::force_bar`].
    pub fn approach_over_h(&self, approach: f64) -> Result<f64> {
        Ok(approach / self.rms_height()?)
    }

    /// `A / A0`, dimensionless.
    pub fn contact_fraction(&self, area: f64) -> f64 {
        area / (self.length * self.length)
    }

    /// The rms height, where the surface has one that is positive.
    ///
    /// # Errors
    /// [`Error::Domain`] otherwise.
    pub fn rms_height(&self) -> Result<f64> {
        let h = self.height.unwrap_or(0.0);
        if h > 0.0 {
            Ok(h)
        } else {
            Err(Error::domain("rms_height", h, "a rough surface (rms height > 0) for normalised quantities"))
        }
    }

    fn force_unit(&self) -> Result<f64> {
        Ok(self.contact_modulus * self.rms_height()? * self.length)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_flat_map_has_no_force_bar() {
        let s = Normalisation { contact_modulus: 1.0, length: 1.0, height: Some(0.0) };
        assert!(s.force_bar(1.0).is_err());
        assert!(Normalisation { height: None, ..s }.force_bar(1.0).is_err());
    }

    #[test]
    fn one_cell_alone_in_k_bar() {
        // data/paper/VALUES.md: one cell of an N x N grid is k_bar = 0.780372 / N.
        let s = Normalisation { contact_modulus: 2.0, length: 3.0, height: Some(1.0) };
        let k = 0.891_106_989 * 2.0 * 3.0 / 2049.0;
        approx::assert_relative_eq!(s.stiffness_bar(k), 0.780_372 / 2049.0, max_relative = 1e-6);
    }
}
