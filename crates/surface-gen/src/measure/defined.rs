//! Measures that need every height.

use contact_model::{Error, HeightMap, Result};

/// Refuses a map with undefined points, for a measure `what` that needs every height.
///
/// # Errors
/// [`Error::Domain`] with their number.
///
/// ```
/// let map = contact_model::HeightMap::with_undefined(2, 1.0, vec![0.0, 1.0, f64::NAN, 2.0])?;
/// let error = surface_gen::defined_everywhere(&map, "a spectrum").unwrap_err().to_string();
/// assert!(error.starts_with("undefined points = 1: expected 0: a spectrum needs every height"));
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn defined_everywhere(map: &HeightMap, what: &str) -> Result<()> {
    if map.undefined() == 0 {
        return Ok(());
    }
    let expected = format!("0: {what} needs every height (fill the undefined points or crop the map)");
    Err(Error::domain("undefined points", map.undefined() as f64, expected))
}
