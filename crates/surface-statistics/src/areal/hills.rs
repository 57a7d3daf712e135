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
    let mut order: Vec<usize> = (0..heights.len()).filter(|&i| !heights[i].is_nan()).collect();
    // Of equal heights the first is the higher one.
    order.sort_by(|&a, &b| heights[b].total_cmp(&heights[a]).then(a.cmp(&b)));
    let mut hills = GrowingHills::new(heights);
    for &i in &order {
        hills.add(i, points, cells);
        hills.join(i, pruning);
    }
    hills.pruned(&order)
}

/// Hills while points are added from the highest down.
struct GrowingHills<'a> {
    heights: &'a [f64],
    /// Hill (its peak) of each point that has been added; the number of points for the others.
    hill: Vec<usize>,
    /// The part of points joined so far that a point belongs to: its highest peak, through a chain.
    part: Vec<usize>,
    /// What each hill was united with, through a chain.
    united: Vec<usize>,
    /// Why each hill is incomplete, bit by bit.
    incomplete: Vec<u8>,
    /// The neighbours of the last point that were added before it.
    around: Vec<usize>,
}

impl<'a> GrowingHills<'a> {
    fn new(heights: &'a [f64]) -> Self {
        let count = heights.len();
        Self {
            heights,
            hill: vec![count; count],
            part: (0..count).collect(),
            united: (0..count).collect(),
            incomplete: vec![0; count],
            around: Vec::with_capacity(8),
        }
    }

    /// Adds a point to the hill of its highest neighbour, or as a peak where none has been added.
    fn add(&mut self, i: usize, points: &[HolePoint], cells: Cells) {
        let Self { heights, hill, incomplete, around, .. } = self;
        let Cells { columns, rows } = cells;
        let none = heights.len();
        let (x, y) = (i % columns, i / columns);
        let at_edge = x == 0 || y == 0 || x + 1 == columns || y + 1 == rows;
        let mut open = if at_edge { EDGE } else { 0 };
        let mut steepest = none;
        around.clear();
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
    }

    /// Joins the parts around the point that has been added, which is a saddle where there are several. The
    /// lower hill is united with the one across where its peak is less than `pruning` above.
    fn join(&mut self, i: usize, pruning: f64) {
        let Self { heights, hill, part, united, around, .. } = self;
        for &j in around.iter() {
            let (mine, other) = (root(part, i), root(part, j));
            if mine == other {
                continue;
            }
            // The part with the lower peak ends here; a point that has just been added has no peak of its
            // own.
            let (lower, upper) = if higher(heights, other, mine) { (mine, other) } else { (other, mine) };
            if lower != i && heights[lower] - heights[i] < pruning {
                let mut across = upper;
                let mut highest = f64::NEG_INFINITY;
                for &k in around.iter() {
                    if heights[k] > highest && root(part, k) == upper {
                        (across, highest) = (hill[k], heights[k]);
                    }
                }
                united[lower] = across;
            }
            part[lower] = upper;
        }
    }

    /// The hills that are united with no other.
    fn pruned(mut self, order: &[usize]) -> Hills {
        let all: Vec<usize> = order.iter().copied().filter(|&i| self.hill[i] == i).collect();
        for &peak in &all {
            let kept = root(&mut self.united, peak);
            self.incomplete[kept] |= self.incomplete[peak];
        }
        let kept = |peak: &usize| self.united[*peak] == *peak;
        let cut = all.iter().filter(|peak| kept(peak) && self.incomplete[**peak] == HOLE).count();
        let mut peaks: Vec<usize> =
            all.into_iter().filter(|peak| kept(peak) && self.incomplete[*peak] == 0).collect();
        peaks.sort_unstable();
        Hills { peaks, cut }
    }
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
