//! Shared by the pressures of round contacts.

use contact_model::{Error, Result};
use std::f64::consts::PI;

/// `|r| / a` where force, radius and position make sense.
///
/// # Errors
/// [`Error::Domain`] with the first value that does not.
pub(crate) fn position(force: f64, contact_radius: f64, r: f64) -> Result<f64> {
    if !(force.is_finite() && force >= 0.0) {
        return Err(Error::domain("force", force, "a finite number >= 0"));
    }
    if !(contact_radius.is_finite() && contact_radius > 0.0) {
        return Err(Error::domain("contact radius", contact_radius, "a finite number > 0"));
    }
    if !r.is_finite() {
        return Err(Error::domain("r", r, "a finite number"));
    }
    Ok(r.abs() / contact_radius)
}

/// `F / (pi a^2)`.
pub(crate) fn mean_pressure(force: f64, contact_radius: f64) -> f64 {
    force / contact_radius / contact_radius / PI
}
