//! The lateral resolution that the tip of an instrument allows.

use contact_model::Cells;

/// A tip of radius R traces no summit sharper than itself; below the distance at which measured summits reach
/// half of its curvature, heights are the tip's as much as the surface's.
const SHARE: f64 = 0.5;

/// The shortest distance from which on the sharpest summit has less than half of the tip's curvature, along x
/// or y, whichever is longer; 0 where it has at all distances, `None` where it never has.
///
/// The curvature at a distance d is that of the second difference `(2 h(x) - h(x - d) - h(x + d))/d^2`,
/// largest over the map (A. Sanner, W. G. Noehring, L. A. Thimons, T. D. B. Jacobs, L. Pastewka, Appl. Surf.
/// Sci. Adv. 7, 100190 (2022)). Cost O(N) for each of up to half as many distances as there are cells along a
/// side, and it ends at the first that is reliable.
pub(super) fn reliable_from(cells: Cells, cell: [f64; 2], heights: &[f64], radius: f64) -> Option<f64> {
    let Cells { columns, rows } = cells;
    let along = |count: usize, step: usize, side: f64| {
        (1..=(count - 1) / 2).map(|k| (k, k * step, k as f64 * side)).find(|&(k, step_k, distance)| {
            let sharpest = (0..heights.len())
                .filter(|i| {
                    let place = if step == 1 { i % columns } else { i / columns };
                    (k..count - k).contains(&place)
                })
                .map(|i| 2.0 * heights[i] - heights[i - step_k] - heights[i + step_k])
                // NaN, where a point is undefined, is no maximum.
                .fold(f64::NEG_INFINITY, f64::max);
            sharpest / (distance * distance) < SHARE / radius
        })
    };
    let x = along(columns, 1, cell[0]);
    let y = along(rows, columns, cell[1]);
    let distance = |found: Option<(usize, usize, f64)>, count: usize| match found {
        // A line of two points has no curvature.
        None if count < 3 => Some(0.0),
        None => None,
        Some((1, ..)) => Some(0.0),
        Some((.., distance)) => Some(distance),
    };
    Some(distance(x, columns)?.max(distance(y, rows)?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_is_reliable_from_where_its_chord_is_flat() {
        // Summits of cos(q x) seen over d have the curvature 2 (1 - cos(q d))/d^2.
        let q = std::f64::consts::TAU / 64.0;
        let cells = Cells { columns: 256, rows: 4 };
        let heights: Vec<f64> = (0..1024).map(|i| (q * f64::from(i % 256)).cos()).collect();
        let curvature = |d: f64| 2.0 * (1.0 - (q * d).cos()) / (d * d);
        let blunt = 1.01 * SHARE / (q * q);
        assert_eq!(reliable_from(cells, [1.0; 2], &heights, 0.9 * blunt), Some(0.0));
        for d in [10.0, 20.0, 30.0_f64] {
            let radius = SHARE / curvature(d);
            let found = reliable_from(cells, [1.0; 2], &heights, radius).unwrap();
            assert!((found - d).abs() <= 1.0, "{found}, {d}");
        }
        // A parabola has one curvature at all distances.
        let parabola: Vec<f64> = (0..1024).map(|i| -0.5 * f64::from(i % 256).powi(2)).collect();
        assert_eq!(reliable_from(cells, [1.0; 2], &parabola, 0.4), Some(0.0));
        assert_eq!(reliable_from(cells, [1.0; 2], &parabola, 0.6), None);
    }
}
