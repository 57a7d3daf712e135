//! Undefined points of a map whose hills are counted: small patches are filled, and larger ones are holes or
//! outside of the map.

use contact_model::Cells;

/// Number of cells of the largest patch that is filled: a scattered failure of an instrument, not a region
/// that it did not see.
const LARGEST: usize = 16;
/// Sweeps over a patch: more than such a patch needs for the digits that decide which point is higher.
const SWEEPS: usize = 60;

/// Kind of a point of a map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HolePoint {
    /// A point with a measured height.
    Measured,
    /// A point with the mean height of its neighbours.
    Filled,
    /// A point without a height, in a patch that does not touch the edge of the map.
    Hole,
    /// A point without a height, in a patch that touches the edge: outside of the region that the instrument
    /// measured.
    Outside,
}

/// Fills patches of at most 16 undefined points, joined along the axes, so that each filled height is the
/// mean of its neighbours': no filled point is a peak. Returns the kind of each point.
pub(super) fn fill_small(heights: &mut [f64], cells: Cells) -> Vec<HolePoint> {
    let mut points = vec![HolePoint::Measured; heights.len()];
    let mut seen: Vec<bool> = heights.iter().map(|h| !h.is_nan()).collect();
    for start in 0..heights.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut patch = vec![start];
        let (mut at, mut edge) = (0, false);
        while at < patch.len() {
            let mut neighbours = 0;
            for j in around(patch[at], cells) {
                neighbours += 1;
                if !seen[j] {
                    seen[j] = true;
                    patch.push(j);
                }
            }
            edge |= neighbours < 4;
            at += 1;
        }
        let of = match (patch.len() <= LARGEST && patch.len() < heights.len(), edge) {
            (true, _) => HolePoint::Filled,
            (false, true) => HolePoint::Outside,
            (false, false) => HolePoint::Hole,
        };
        for &i in &patch {
            points[i] = of;
        }
        if of == HolePoint::Filled {
            fill(heights, cells, &patch);
        }
    }
    points
}

fn fill(heights: &mut [f64], cells: Cells, patch: &[usize]) {
    let mut measured: Vec<usize> =
        patch.iter().flat_map(|&i| around(i, cells)).filter(|&j| !heights[j].is_nan()).collect();
    measured.sort_unstable();
    measured.dedup();
    let mean = measured.iter().map(|&j| heights[j]).sum::<f64>() / measured.len() as f64;
    for &i in patch {
        heights[i] = mean;
    }
    for _ in 0..SWEEPS {
        for &i in patch {
            let (sum, count) = around(i, cells).fold((0.0, 0), |(sum, n), j| (sum + heights[j], n + 1));
            heights[i] = sum / f64::from(count);
        }
    }
}

/// Neighbours along the axes.
fn around(i: usize, Cells { columns, rows }: Cells) -> impl Iterator<Item = usize> {
    let (x, y) = (i % columns, i / columns);
    let left = (x > 0).then(|| i - 1);
    let right = (x + 1 < columns).then(|| i + 1);
    let below = (y > 0).then(|| i - columns);
    let above = (y + 1 < rows).then(|| i + columns);
    [left, right, below, above].into_iter().flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_patches_of_a_plane_are_the_plane_and_large_ones_stay() {
        let cells = Cells { columns: 12, rows: 10 };
        let plane = |i: usize| (2 * (i % 12) + 3 * (i / 12)) as f64;
        // A patch of three, one of 4 x 5 inside, one of 3 x 6 at the edge.
        let hole = |i: usize| {
            let (x, y) = (i % 12, i / 12);
            [(2, 1), (3, 1), (3, 2)].contains(&(x, y))
                || ((4..8).contains(&x) && (4..9).contains(&y))
                || (x > 8 && y < 6)
                || i == 119
        };
        let mut heights: Vec<f64> = (0..120).map(|i| if hole(i) { f64::NAN } else { plane(i) }).collect();
        let points = fill_small(&mut heights, cells);
        let count = |of: HolePoint| points.iter().filter(|p| **p == of).count();
        assert_eq!([HolePoint::Filled, HolePoint::Hole, HolePoint::Outside].map(count), [4, 20, 18]);
        for i in [14, 15, 27] {
            assert!((heights[i] - plane(i)).abs() < 1e-9, "{} {}", heights[i], plane(i));
        }
        // At a corner there are two neighbours.
        assert!((heights[119] - 0.5 * (plane(118) + plane(107))).abs() < 1e-9);
        let mut nothing = vec![f64::NAN; 4];
        assert_eq!(fill_small(&mut nothing, Cells { columns: 2, rows: 2 }), [HolePoint::Outside; 4]);
    }
}
