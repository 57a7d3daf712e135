//! Wavelengths at which a map is reliable.

use crate::fit::FitOptions;
use contact_model::units::five;
use contact_model::{Boundary, Error, HeightMap, Result};

/// Cells of the shortest wave of a grid.
const CELLS: f64 = 2.0;
/// Waves along the shorter side of the longest wave of a free map.
const WAVES: f64 = 2.0;

/// Limits between which the wavelengths of a measured map are reliable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReliableWavelengths {
    /// Two of the longer cell sides, or the instrument's limit where that is longer.
    pub shortest: f64,
    /// The longer side of a periodic map; half of the shorter side of a free one, because longer waves cannot
    /// be separated from the trend that was removed, and Hann's window spreads each wave over its two
    /// neighbours.
    pub longest: f64,
    /// Whether `shortest` is the instrument's.
    pub limited_by_instrument: bool,
}

impl ReliableWavelengths {
    /// Limits of a map; `instrument` is the shortest wavelength that the instrument resolves, where it is
    /// known.
    ///
    /// For a tip of radius R it is 2 d, the length of the stencil `[h(x - d) - 2 h(x) + h(x + d)]/d^2`, with
    /// the shortest distance d at which no summit has more than half of the curvature 1/R. `surface-io`
    /// reports d as "heights are reliable from ... on". Source: Sanner, Noehring, Thimons, Jacobs, Pastewka,
    /// Appl. Surf. Sci. Adv. 7, 100190 (2022), section 4. Cost O(1).
    ///
    /// # Errors
    /// [`Error::Domain`] for an instrument's limit that is no positive number, and where no wavelength
    /// remains.
    ///
    /// ```
    /// use contact_model::{Boundary, HeightMap};
    /// use surface_statistics::ReliableWavelengths;
    /// let map = HeightMap::new([100, 50], [10.0, 5.0], vec![0.0; 5000])?;
    /// let found = ReliableWavelengths::new(&map, Boundary::Free, Some(0.3))?;
    /// assert_eq!((found.shortest, found.longest, found.limited_by_instrument), (0.3, 2.5, true));
    /// # Ok::<(), contact_model::Error>(())
    /// ```
    pub fn new(map: &HeightMap, boundary: Boundary, instrument: Option<f64>) -> Result<Self> {
        if let Some(limit) = instrument.filter(|limit| !(limit.is_finite() && *limit > 0.0)) {
            let name = "shortest wavelength that the instrument resolves";
            return Err(Error::domain(name, limit, "a finite number > 0"));
        }
        let size = map.size();
        let longest = match boundary {
            Boundary::Periodic => size.x.max(size.y),
            _ => size.shorter() / WAVES,
        };
        let cells = CELLS * map.dx().max(map.dy());
        let shortest = instrument.unwrap_or(0.0).max(cells);
        if shortest > longest {
            let expected = format!("at most {}, the longest that the map has", five(longest, ""));
            return Err(Error::domain("shortest reliable wavelength", shortest, expected));
        }
        Ok(Self { shortest, longest, limited_by_instrument: shortest > cells })
    }

    /// Options of a fit between these wavelengths.
    pub fn fit_options(&self, boundary: Boundary) -> FitOptions {
        FitOptions { boundary, shortest: Some(self.shortest), longest: Some(self.longest) }
    }
}
