//! Lines on which a field has a level.

use crate::error::{Error, Result};
use contact_model::Cells;
use contour::ContourBuilder;

/// The lines on which values on a lattice have one of the levels, as points in steps of the lattice from its first point,
/// (column, row). Lines are closed or end at the edges of the lattice.
///
/// # Errors
/// [`Error`] with the name of the picture, for another number of values than points, and values that are not finite.
pub fn contour_lines(
    name: &str,
    points: Cells,
    values: &[f64],
    levels: &[f64],
) -> Result<Vec<Vec<[f64; 2]>>> {
    if points.checked_count() != Some(values.len()) || !values.iter().all(|value| value.is_finite()) {
        let Cells { columns, rows } = points;
        let message = format!("{} finite values expected on {columns} x {rows} points", values.len());
        return Err(Error::new(name, message));
    }
    let found = ContourBuilder::new(points.columns, points.rows, true).lines(values, levels);
    let found = found.map_err(|error| Error::new(name, error.to_string()))?;
    // Its points lie in the middles of squares, and it closes all lines around the lattice.
    let (right, top) = ((points.columns - 1) as f64, (points.rows - 1) as f64);
    let is_inside = |at: &[f64; 2]| (0.0..=right).contains(&at[0]) && (0.0..=top).contains(&at[1]);
    let mut lines = Vec::new();
    for ring in found.iter().flat_map(contour::Line::geometry) {
        let mut ring: Vec<[f64; 2]> = ring.0.iter().map(|at| [at.x - 0.5, at.y - 0.5]).collect();
        if let Some(outside) = ring.iter().position(|at| !is_inside(at)) {
            // The last point is the first one again.
            ring.pop();
            ring.rotate_left(outside);
        }
        let parts = ring.split(|at| !is_inside(at)).filter(|part| part.len() > 1);
        lines.extend(parts.map(<[[f64; 2]]>::to_vec));
    }
    Ok(lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of a plane the lines are straight and where they should be; of a hill they are closed.
    #[test]
    fn lines_of_a_plane_and_of_a_hill() {
        let plane: Vec<f64> = (0..12).map(|i| f64::from(i % 4) + 2.0 * f64::from(i / 4)).collect();
        let lines = contour_lines("a", Cells { columns: 4, rows: 3 }, &plane, &[2.5, 100.0]).unwrap();
        assert_eq!(lines.len(), 1);
        let on = |[x, y]: &[f64; 2]| (x + 2.0 * y - 2.5).abs() < 1e-12;
        assert!(lines[0].len() > 2 && lines[0].iter().all(on), "{lines:?}");
        let hill: Vec<f64> = (0..25).map(|i| if i == 12 { 1.0 } else { 0.0 }).collect();
        let lines = contour_lines("a", Cells { columns: 5, rows: 5 }, &hill, &[0.5]).unwrap();
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
        assert!(contour_lines("a", Cells { columns: 5, rows: 5 }, &hill[1..], &[0.5]).is_err());
    }
}
