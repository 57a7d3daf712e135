//! Maps as text.

use crate::error::{Error, Problem, Result};
use crate::quantity::{Dimension, Unit};
use crate::scan::check_unit;
use crate::vti::{Encoding, Field, vti};
use crate::{files, npy};
use contact_model::HeightMap;
use std::fmt::{self, Write as _};
use std::path::Path;

/// What the numbers of a map are: metres, as [`crate::Scan::map`] gives them, or without a unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Heights and side in metres.
    Metres,
    /// Heights and side in one unit that nobody said.
    Unitless,
}

impl Metric {
    /// The metric of a map made from heights of this unit.
    ///
    /// # Errors
    /// [`Problem::Quantity`] for a unit that is no length.
    pub fn of(unit: &Unit) -> Result<Self, Problem> {
        check_unit("unit", Some(unit))?;
        Ok(if unit.dimension() == Dimension::LENGTH { Self::Metres } else { Self::Unitless })
    }

    fn suffix(self) -> &'static str {
        match self {
            Self::Metres => " m",
            Self::Unitless => "",
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Unitless => "none",
        }
    }
}

/// Writes a map whole or not at all, in the format of the name's ending: `npy`, `txt`, `xyz` or `vti`.
///
/// Text, XYZ and VTI say the side of a cell and the unit, NPY says neither. Every number is written so that the same double is read again.
///
/// # Errors
/// [`Error::System`] where the system refuses, [`Error::Content`] for another ending.
///
/// ```no_run
/// use surface_io::{Metric, write_map};
/// let map = contact_model::HeightMap::new(2, 1e-6, vec![0.0, 1e-9, 2e-9, 3e-9])?;
/// write_map("a.txt".as_ref(), &map, Metric::Metres)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_map(path: &Path, map: &HeightMap, metric: Metric) -> Result<()> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default();
    let bytes = match ending {
        "npy" => npy(&[map.columns(), map.columns()], map.heights()).map_err(Error::content(path))?,
        "txt" => text(map, metric).into_bytes(),
        "xyz" => xyz(map, metric).into_bytes(),
        "vti" => {
            let field = Field { name: "height", unit: metric.name(), values: map.heights() };
            vti(map.columns(), map.dx(), &[field], Encoding::Base64).map_err(Error::content(path))?
        }
        other => {
            let problem = Problem::Ending { found: other.chars().take(16).collect() };
            return Err(Error::content(path)(problem));
        }
    };
    files::write_whole(path, &bytes)
}

/// A text matrix with a header: rows in lines, tabs between the numbers.
///
/// ```
/// use surface_io::{Metric, text};
/// let map = contact_model::HeightMap::new(2, 1e-6, vec![0.0, 1e-9, 2e-9, 3.5])?;
/// let written = text(&map, Metric::Metres);
/// assert_eq!(written, "# Width: 1e-6 m\n# Height: 1e-6 m\n# Value units: m\n0e0\t1e-9\n2e-9\t3.5e0\n");
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn text(map: &HeightMap, metric: Metric) -> String {
    let (side, suffix) = (map.length(), metric.suffix());
    let head =
        format!("# Width: {side:e}{suffix}\n# Height: {side:e}{suffix}\n# Value units: {}\n", metric.name());
    let mut written = Lines::new(head, 24 * map.heights().len());
    for row in map.heights().chunks_exact(map.columns()) {
        for (i, h) in row.iter().enumerate() {
            let end = if i + 1 == row.len() { '\n' } else { '\t' };
            written.add(format_args!("{h:e}{end}"));
        }
    }
    written.text
}

/// Points x, y, z, one per line, at the centres of the cells, with the units in comments.
///
/// ```
/// use surface_io::{Metric, xyz};
/// let map = contact_model::HeightMap::new(1, 2.0, vec![5.0])?;
/// assert_eq!(xyz(&map, Metric::Unitless), "# Lateral units: none\n# Value units: none\n# x y z\n1e0 1e0 5e0\n");
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn xyz(map: &HeightMap, metric: Metric) -> String {
    let (cells, cell, unit) = (map.columns(), map.dx(), metric.name());
    let head = format!("# Lateral units: {unit}\n# Value units: {unit}\n# x y z\n");
    let mut written = Lines::new(head, 64 * map.heights().len());
    for (i, h) in map.heights().iter().enumerate() {
        let centre = |k: usize| (k as f64 + 0.5) * cell;
        written.add(format_args!("{:e} {:e} {h:e}\n", centre(i % cells), centre(i / cells)));
    }
    written.text
}

/// Text that grows.
pub(crate) struct Lines {
    pub(crate) text: String,
}

impl Lines {
    pub(crate) fn new(mut head: String, more: usize) -> Self {
        head.reserve(more);
        Self { text: head }
    }

    pub(crate) fn add(&mut self, arguments: fmt::Arguments<'_>) {
        // Writing to a string does not fail.
        let _ = self.text.write_fmt(arguments);
    }
}

#[cfg(test)]
mod tests;
