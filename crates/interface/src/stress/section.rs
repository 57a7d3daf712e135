//! The stress in a vertical section of the body.

use super::load::{StressedBody, SurfaceLoad, check_memory, scaled_depths};
use super::plan::SubsurfaceStress;
use contact_model::{Error, Result, Stop};

/// The line of the map below which a section is taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionLine {
    /// The row with this number: a section along x.
    Row(usize),
    /// The column with this number: a section along y.
    Column(usize),
}

/// The stress in a vertical section through the centres of the cells of a row or a column.
#[derive(Debug, Clone, PartialEq)]
pub struct StressSection {
    /// Distances along the line, of the centres of cells.
    pub positions: Vec<f64>,
    /// The depths.
    pub depths: Vec<f64>,
    /// The components xx, yy, zz, yz, xz, xy, depth by depth: `stress[depth * positions.len() + position]`.
    pub stress: Vec<[f64; 6]>,
}

/// The stress below a row or a column of the map, at the depths given.
///
/// Cost: that of [`SubsurfaceStress::at_depth`] for each depth. One depth is kept beside the section.
///
/// # Errors
/// Those of [`SubsurfaceStress::new`] and [`SubsurfaceStress::at_depth`]; [`Error::Domain`] for a row or a
/// column that the map does not have.
///
/// ```
/// use contact_model::{Field, never};
/// use interface::stress::{SectionLine, StressedBody, SurfaceLoad, stress_section};
/// let load = SurfaceLoad::new(Field::new([3, 2], [3.0, 2.0], vec![0.0, 1.0, 0.0, 0.0, 1.0, 0.0])?)?;
/// let section = stress_section(&load, StressedBody::new(0.3), SectionLine::Row(0), &[0.0, 1.0], &never)?;
/// assert_eq!((section.positions.as_slice(), section.stress.len()), (&[0.5, 1.5, 2.5][..], 6));
/// assert!((section.stress[1][2] + 1.0).abs() < 1e-13, "the loaded cell at the surface");
/// # Ok::<(), contact_model::Error>(())
/// ```
pub fn stress_section(
    load: &SurfaceLoad,
    body: StressedBody,
    line: SectionLine,
    depths: &[f64],
    stop: Stop<'_>,
) -> Result<StressSection> {
    let cells = load.cells();
    let (name, number, lines, count, side) = match line {
        SectionLine::Row(row) => ("row", row, cells.rows, cells.columns, load.pressure().dx()),
        SectionLine::Column(column) => ("column", column, cells.columns, cells.rows, load.pressure().dy()),
    };
    if number >= lines {
        return Err(Error::domain(name, number as f64, format!("a number below {lines}")));
    }
    scaled_depths(load, depths)?;
    check_memory(cells, 48.0 * count as f64 * depths.len() as f64)?;
    let plan = SubsurfaceStress::new(load, body)?;
    let mut stress = Vec::with_capacity(count * depths.len());
    for &depth in depths {
        let plane = plan.at_depth(depth, stop)?;
        stress.extend((0..count).map(|i| match line {
            SectionLine::Row(row) => plane.at(i, row),
            SectionLine::Column(column) => plane.at(column, i),
        }));
    }
    let positions = (0..count).map(|i| (i as f64 + 0.5) * side).collect();
    Ok(StressSection { positions, depths: depths.to_vec(), stress })
}
