//! Maps as the bytes of files: as text, and in the format of a name's ending.

use crate::channel::check_unit;
use crate::error::ContentError;
use crate::instruments::{gwy, hdf5, netcdf, x3p};
use crate::lines::Lines;
use crate::npy;
use crate::quantity::{Dimension, Unit};
use crate::vti::{DataArray, Encoding, vti};
use contact_model::HeightMap;

/// Unit of the numbers of a map: metres, as [`crate::Scan::map`] gives them, or no unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Heights and side in metres.
    Metres,
    /// Heights and side in one unknown unit.
    Unitless,
}

impl Metric {
    /// The metric of a map made from heights of this unit.
    ///
    /// # Errors
    /// [`ContentError::Quantity`] for a unit that is no length.
    pub fn of(unit: &Unit) -> Result<Self, ContentError> {
        check_unit("unit", Some(unit))?;
        Ok(if unit.dimension() == Dimension::LENGTH { Self::Metres } else { Self::Unitless })
    }

    fn suffix(self) -> &'static str {
        match self {
            Self::Metres => " m",
            Self::Unitless => "",
        }
    }

    /// The symbol of the unit; empty without a unit.
    pub(crate) fn unit(self) -> &'static str {
        self.suffix().trim_start()
    }

    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Unitless => "none",
        }
    }
}

/// The bytes of a file of a map, in the format of its name's ending: `npy`, `h5`, `txt`, `xyz`, `vti`, `x3p`,
/// `gwy` or `nc` (NetCDF-3). The caller writes them.
///
/// All formats but NPY (an array `[row, column]`) contain the size and the unit; X3P is in metres only. Every
/// number is written so that the same double is read again. X3P contains the sides of a cell, whose multiple
/// may differ from the side of the map in the last bit. Undefined points are `nan` in text and XYZ, and NaN
/// in NPY, HDF5, X3P, NetCDF and VTI; they are masked in GWY. VTI also hides their cells ([`vti`]), and
/// NetCDF masks them too.
///
/// # Errors
/// [`ContentError::Ending`] for another ending, [`ContentError::LeftOut`] for a format that the build leaves
/// out, [`ContentError::Unspecified`] for X3P without a unit.
///
/// ```
/// use surface_io::{Metric, map_file};
/// let map = contact_model::HeightMap::new(2, 1e-6, vec![0.0, 1e-9, 2e-9, 3e-9])?;
/// assert_eq!(map_file("txt", &map, Metric::Metres)?, surface_io::text(&map, Metric::Metres).into_bytes());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn map_file(ending: &str, map: &HeightMap, metric: Metric) -> Result<Vec<u8>, ContentError> {
    Ok(match ending {
        "npy" => npy(&[map.rows(), map.columns()], &with_nan(map))?,
        "h5" => hdf5(map, metric)?,
        "txt" => text(map, metric).into_bytes(),
        "xyz" => xyz(map, metric).into_bytes(),
        "vti" => {
            let values = with_nan(map);
            let field = DataArray { name: "height", unit: metric.name(), values: &values };
            vti(map.cells(), map.size(), &[field], Encoding::Base64)?
        }
        "x3p" if metric == Metric::Unitless => {
            let remedy = "X3P is in metres: read the heights with a unit, or write txt";
            return Err(ContentError::unspecified("the unit of the heights", Vec::new(), remedy));
        }
        "x3p" => x3p(map)?,
        "gwy" => gwy(map, metric)?,
        "nc" => netcdf(map, metric)?,
        other => return Err(ContentError::Ending { found: other.chars().take(16).collect() }),
    })
}

/// A text matrix with a header: rows in lines, tabs between the numbers, `nan` at undefined points.
///
/// ```
/// use surface_io::{Metric, text};
/// let map = contact_model::HeightMap::new(2, [1e-6, 2e-6], vec![0.0, 1e-9, 2e-9, 3.5])?;
/// let written = text(&map, Metric::Metres);
/// assert_eq!(written, "# Width: 1e-6 m\n# Height: 2e-6 m\n# Value units: m\n0e0\t1e-9\n2e-9\t3.5e0\n");
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn text(map: &HeightMap, metric: Metric) -> String {
    let head = format!("{}# Value units: {}\n", sides(map, metric), metric.name());
    let mut written = Lines::new(head, 24 * map.heights().len());
    for row in map.heights().chunks_exact(map.columns()) {
        for (i, h) in row.iter().enumerate() {
            written.add_height(*h, if i + 1 == row.len() { '\n' } else { '\t' });
        }
    }
    written.text
}

/// Points x, y, z, one per line, at the centres of the cells, with size and units in comments; z is `nan` at
/// undefined points.
///
/// ```
/// use surface_io::{Metric, xyz};
/// let map = contact_model::HeightMap::new(1, [2.0, 4.0], vec![5.0])?;
/// let head = "# Width: 2e0\n# Height: 4e0\n# Lateral units: none\n# Value units: none\n# x y z\n";
/// assert_eq!(xyz(&map, Metric::Unitless), format!("{head}1e0 2e0 5e0\n"));
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn xyz(map: &HeightMap, metric: Metric) -> String {
    let (columns, unit) = (map.columns(), metric.name());
    let head = format!("{}# Lateral units: {unit}\n# Value units: {unit}\n# x y z\n", sides(map, metric));
    let mut written = Lines::new(head, 64 * map.heights().len());
    let centre = |k: usize, cell: f64| (k as f64 + 0.5) * cell;
    for (i, h) in map.heights().iter().enumerate() {
        let (x, y) = (centre(i % columns, map.dx()), centre(i / columns, map.dy()));
        written.add(format_args!("{x:e} {y:e} "));
        written.add_height(*h, '\n');
    }
    written.text
}

/// The lines of a header that say both sides.
fn sides(map: &HeightMap, metric: Metric) -> String {
    let (size, suffix) = (map.size(), metric.suffix());
    format!("# Width: {:e}{suffix}\n# Height: {:e}{suffix}\n", size.x, size.y)
}

/// The heights of a map with NaN at undefined points, as files have them.
pub(crate) fn with_nan(map: &HeightMap) -> Vec<f64> {
    map.heights().iter().map(|&h| if h.is_finite() { h } else { f64::NAN }).collect()
}

#[cfg(test)]
mod tests;
