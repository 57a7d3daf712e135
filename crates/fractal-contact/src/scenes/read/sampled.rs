//! Sampling of a map on fewer cells.

use contact_model::{Cells, HeightMap, Result};

/// Columns and rows with at most `longer` along the longer side.
pub(crate) fn sampled_cells(cells: Cells, longer: usize) -> Cells {
    let most = cells.columns.max(cells.rows);
    if most <= longer {
        return cells;
    }
    let fewer = |count: usize| (count * longer).div_ceil(most).max(1);
    Cells { columns: fewer(cells.columns), rows: fewer(cells.rows) }
}

/// The cells of a map nearest to the centres of a coarser grid, with at most `longer` along its longer side.
pub(crate) fn sampled(map: &HeightMap, longer: usize) -> Result<HeightMap> {
    let Cells { columns, rows } = sampled_cells(map.cells(), longer);
    if (Cells { columns, rows }) == map.cells() {
        return Ok(map.clone());
    }
    // floor((i + 1/2) n / m)
    let nearest = |i: usize, all: usize, few: usize| (2 * i + 1) * all / (2 * few);
    let at = |i: usize| {
        let (row, column) =
            (nearest(i / columns, map.rows(), rows), nearest(i % columns, map.columns(), columns));
        map.heights()[row * map.columns() + column]
    };
    let height = |h: f64| if h.is_finite() { h } else { f64::NAN };
    let heights = (0..columns * rows).map(|i| height(at(i))).collect();
    HeightMap::with_undefined([columns, rows], map.size(), heights)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sampled_maps_keep_their_shape_and_undefined_points() {
        let height = |i: usize| if i % 16 == 1 { f64::NAN } else { i as f64 };
        let map = HeightMap::with_undefined([16, 4], [8.0, 1.0], (0..64).map(height).collect()).unwrap();
        let thin = sampled(&map, 8).unwrap();
        assert_eq!((thin.cells(), thin.size(), thin.undefined()), ([8, 2].into(), map.size(), 2));
        assert_eq!((thin.heights()[1], thin.heights()[9]), (19.0, 51.0));
        assert_eq!(sampled(&map, 16).unwrap(), map);
        // Of an odd number every second one, beginning with the first.
        let odd = HeightMap::new([5, 1], [5.0, 1.0], vec![0.0, 1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(sampled(&odd, 3).unwrap().heights(), [0.0, 2.0, 4.0]);
        let all = HeightMap::with_undefined([2, 1], [2.0, 1.0], vec![1.0, f64::NAN]).unwrap();
        assert_eq!(
            sampled(&all, 1).unwrap_err().to_string(),
            "defined points = 0: expected at least 1 (every height of the map is undefined)"
        );
    }
}
