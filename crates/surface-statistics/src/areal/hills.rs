//! Hills of a map and their pruning.

use super::holes::HolePoint;
use contact_model::Cells;

/// Why a hill is incomplete.
const EDGE: u8 = 1;
const HOLE: u8 = 2;

/// Hills after pruning.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Hills {
    /// Peaks of those that are complete, by index, lowest index first.
    pub(super) peaks: Vec<usize>,
    /// Number of hills that are incomplete only because of a hole, not because of the edge of the measured
    /// region.
    pub(super) cut: usize,
}

/// The hills after pruning; heights are NaN where undefined, and `points` distinguishes holes from points
/// outside.
///
/// Points are added from the highest down; where two parts meet, the one with the lower peak ends in a
/// saddle. Its hill is united with the one on the other side if its peak is less than `pruning` above the
/// saddle: that is the order of Wolf's pruning, because the neighbour across the highest saddle of the least
/// hill has a higher peak.
pub(super) fn hills(heights: &[f64], points: &[HolePoint], cells: Cells, pruning: f64) -> Hills {
    let Cells { columns, rows } = cells;
    let mut order: Vec<usize> = (0..heights.len()).filter(|&i| !heights[i].is_nan()).collect();
    // Of equal heights the first is the higher one.
    order.sort_by(|&a, &b| heights[b].total_cmp(&heights[a]).then(a.cmp(&b)));
    let none = heights.len();
    // Hill (its peak) of each point, the part of points joined so far (its highest peak, through a chain),
    // and what each hill was united with.
    let mut hill = vec![none; heights.len()];
    let mut part: Vec<usize> = (0..heights.len()).collect();
    let mut united: Vec<usize> = (0..heights.len()).collect();
    let mut incomplete = vec![0_u8; heights.len()];
    for &i in &order {
        let (x, y) = (i % columns, i / columns);
        let at_edge = x == 0 || y == 0 || x + 1 == columns || y + 1 == rows;
        let mut open = if at_edge { EDGE } else { 0 };
        let mut steepest = none;
        let mut around = Vec::with_capacity(8);
        for ny in y.saturating_sub(1)..(y + 2).min(rows) {
            for nx in x.saturating_sub(1)..(x + 2).min(columns) {
                let j = ny * columns + nx;
                open |= match points[j] {
                    HolePoint::Hole => HOLE,
                    HolePoint::Outside => EDGE,
                    HolePoint::Measured | HolePoint::Filled => 0,
                };
                if j != i && hill[j] != none {
                    around.push(j);
                    if steepest == none || heights[j] > heights[steepest] {
                        steepest = j;
                    }
                }
            }
        }
        hill[i] = if steepest == none { i } else { hill[steepest] };
        incomplete[hill[i]] |= open;
        for &j in &around {
            let (mine, other) = (root(&mut part, i), root(&mut part, j));
            if mine == other {
                continue;
            }
            // The part with the lower peak ends here; a point that has just been added has no peak of its
            // own.
            let (lower, upper) = if higher(heights, other, mine) { (mine, other) } else { (other, mine) };
            if lower != i && heights[lower] - heights[i] < pruning {
                let mut across = upper;
                let mut highest = f64::NEG_INFINITY;
                for &k in &around {
                    if heights[k] > highest && root(&mut part, k) == upper {
                        (across, highest) = (hill[k], heights[k]);
                    }
                }
                united[lower] = across;
            }
            part[lower] = upper;
        }
    }
    let all: Vec<usize> = order.iter().copied().filter(|&i| hill[i] == i).collect();
    for &peak in &all {
        let kept = root(&mut united, peak);
        incomplete[kept] |= incomplete[peak];
    }
    let kept = |peak: &usize| united[*peak] == *peak;
    let cut = all.iter().filter(|peak| kept(peak) && incomplete[**peak] == HOLE).count();
    let mut peaks: Vec<usize> = all.into_iter().filter(|peak| kept(peak) && incomplete[*peak] == 0).collect();
    peaks.sort_unstable();
    Hills { peaks, cut }
}

/// Whether point a is higher than point b; of equal heights the first is.
fn higher(heights: &[f64], a: usize, b: usize) -> bool {
    heights[a] > heights[b] || (heights[a].total_cmp(&heights[b]).is_eq() && a < b)
}

/// The end of a chain, which is shortened.
fn root(next: &mut [usize], mut i: usize) -> usize {
    while next[i] != i {
        next[i] = next[next[i]];
        i = next[i];
    }
    i
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_hills_join_their_neighbours() {
        // A ridge with the heights 3, 2.5, 2.8, 1, 2 in a ditch inside a rim, all of whose heights differ.
        let row = [3.0, 2.5, 2.8, 1.0, 2.0];
        let field: Vec<f64> = (0..77)
            .map(|i| {
                let (x, y) = (i % 11, i / 11);
                let rim = x == 0 || y == 0 || x == 10 || y == 6;
                let height = if rim { 10.0 } else { -5.0 };
                if y == 3 && (3..8).contains(&x) { row[x - 3] } else { height - 0.01 * i as f64 }
            })
            .collect();
        let cells = Cells { columns: 11, rows: 7 };
        let measured = vec![HolePoint::Measured; 77];
        let found = |pruning: f64| hills(&field, &measured, cells, pruning).peaks;
        let at = |x: usize| 33 + x;
        assert_eq!(found(0.1), [at(3), at(5), at(7)]);
        assert_eq!(found(0.5), [at(3), at(7)]);
        assert_eq!(found(1.5), [at(3)]);
        // The rim's hills touch the edge; the ridge touches a hole.
        let mut hole = (field.clone(), measured.clone());
        (hole.0[at(4) + 11], hole.1[at(4) + 11]) = (f64::NAN, HolePoint::Hole);
        assert_eq!(hills(&hole.0, &hole.1, cells, 0.5), Hills { peaks: vec![at(7)], cut: 1 });
        hole.1[at(4) + 11] = HolePoint::Outside;
        assert_eq!(hills(&hole.0, &hole.1, cells, 0.5), Hills { peaks: vec![at(7)], cut: 0 });
    }
}
