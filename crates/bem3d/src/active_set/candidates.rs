//! The cells that may touch at a given approach: those whose undeformed gap z is smaller.

use crate::geometry::{CellSet, Grid};
use crate::tuning::{CANDIDATES_AHEAD, CHUNK, COUNTED_CHUNKS, LISTED_CANDIDATES};
use numerics::parallel::map;
use std::sync::Arc;

/// Finds the cells with `z < d`.
///
/// Outside them the gap `u + z - d` is positive where u is not negative: they need no check and no storage. A surface
/// that may rise beside a load ([`crate::kernel::Kernel::may_bulge`]) takes all cells, with an infinite d.
/// Undefined points have an infinite z and are never among them.
#[derive(Debug)]
pub struct Candidates {
    grid: Grid,
    z: Arc<Vec<f64>>,
    range: GapRange,
    /// Cells with z < cap, where they are few.
    list: CellSet,
    cap: f64,
}

/// The range of the undeformed gaps.
#[derive(Debug, Clone, Copy)]
pub struct GapRange {
    /// The defined cell with the smallest gap, as a linear index.
    pub highest: u32,
    /// Its gap.
    pub first: f64,
    /// The largest finite gap, at least 0.
    pub deepest: f64,
}

impl GapRange {
    fn of(z: &[f64]) -> Self {
        let chunks = map(z.len(), z.chunks(CHUNK), |z| {
            let (mut lowest, mut deepest) = (0, 0.0f64);
            for (i, &value) in z.iter().enumerate() {
                if value < z[lowest] {
                    lowest = i;
                }
                if value.is_finite() {
                    deepest = deepest.max(value);
                }
            }
            (lowest, z[lowest], deepest)
        });
        let mut range = Self { highest: 0, first: f64::INFINITY, deepest: 0.0 };
        for (k, (at, first, deepest)) in chunks.into_iter().enumerate() {
            if first < range.first {
                (range.highest, range.first) = ((k * CHUNK + at) as u32, first);
            }
            range.deepest = range.deepest.max(deepest);
        }
        range
    }
}

impl Candidates {
    /// Takes the undeformed gaps of a grid, row-major.
    pub fn new(grid: Grid, z: Arc<Vec<f64>>) -> Self {
        let range = GapRange::of(&z);
        Self { grid, z, range, list: CellSet::default(), cap: 0.0 }
    }

    /// The undeformed gaps of the whole grid.
    pub fn z(&self) -> &[f64] {
        &self.z
    }

    /// The same, shared.
    pub fn shared(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.z)
    }

    /// The range of the undeformed gaps.
    pub fn range(&self) -> GapRange {
        self.range
    }

    /// The cells with `z < d`.
    ///
    /// Cost: one pass over the grid for each doubling of d, and over the candidates of the last doubling
    /// otherwise; one pass over the grid each time where many cells lie below.
    pub fn below(&mut self, d: f64) -> CellSet {
        if d > self.cap {
            let cap = CANDIDATES_AHEAD * d;
            if self.more_than(self.grid.count() / LISTED_CANDIDATES, cap) {
                return CellSet::of_grid(self.grid, &self.z, |z| z < d);
            }
            (self.list, self.cap) = (CellSet::of_grid(self.grid, &self.z, |z| z < cap), cap);
        }
        self.list.filter(&self.gaps(&self.list), |z| z < d)
    }

    /// Whether more than `count` cells lie below d.
    ///
    /// Cost: at most one pass over the grid, much less where the answer is yes.
    pub fn more_than(&self, count: usize, d: f64) -> bool {
        let below = |z: &[f64]| z.iter().filter(|&&z| z < d).count();
        let mut counted = 0;
        self.z.chunks(COUNTED_CHUNKS * CHUNK).any(|z| {
            counted += map(z.len(), z.chunks(CHUNK), below).iter().sum::<usize>();
            counted > count
        })
    }

    /// The `count` lowest defined cells outside a set, or all of them where there are fewer.
    ///
    /// Cost: one pass over the grid.
    pub fn lowest_outside(&self, set: &CellSet, count: usize) -> CellSet {
        let mut taken = vec![false; self.z.len()];
        set.index(self.grid).for_each(|i| taken[i] = true);
        let mut others: Vec<u32> =
            (0..self.z.len()).filter(|&i| !taken[i] && self.z[i].is_finite()).map(|i| i as u32).collect();
        if count < others.len() {
            let z = |i: &u32| self.z[*i as usize];
            others.select_nth_unstable_by(count, |a, b| z(a).total_cmp(&z(b)).then(a.cmp(b)));
            others.truncate(count);
        }
        others.sort_unstable();
        CellSet::from_index(self.grid, &others)
    }

    /// The undeformed gaps on a set.
    pub fn gaps(&self, set: &CellSet) -> Vec<f64> {
        let mut gaps = vec![0.0; set.len()];
        self.add_to(set, &mut gaps);
        gaps
    }

    /// Adds the undeformed gaps on a set to values on it.
    pub fn add_to(&self, set: &CellSet, values: &mut [f64]) {
        set.update(set.len(), values, |row, values| {
            row.add(&self.z[row.y * self.grid.columns..][..self.grid.columns], values, 0);
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_is_strict_and_complete_whatever_was_asked_before() {
        let z = Arc::new(vec![0.0, 0.5, 1.0, 0.25, 3.0, f64::INFINITY, 0.0, 1.5, 0.75, 4.0, 5.0, 6.0]);
        for grid in [Grid::square(3, 4), Grid::square(12, 1), Grid::square(1, 12)] {
            let mut candidates = Candidates::new(grid, Arc::clone(&z));
            for d in [0.1, 0.5, 0.1, 4.0, 1.0, 0.0, 1e300] {
                let expected: Vec<usize> = (0..12).filter(|&i| z[i] < d).collect();
                assert_eq!(candidates.below(d).index(grid).collect::<Vec<_>>(), expected, "d = {d}");
                for count in 0..12 {
                    assert_eq!(candidates.more_than(count, d), expected.len() > count, "{count} at d = {d}");
                }
            }
        }
    }

    #[test]
    fn the_grid_is_scanned_for_twice_the_approach_in_any_unit() {
        // Work: a path of loads up to twice the first one uses the list, and the list holds no more cells
        // than that.
        for unit in [2f64.powi(-40), 1.0, 2f64.powi(40)] {
            let z = (0..64).map(|i| f64::from(i) * unit).collect();
            let mut candidates = Candidates::new(Grid::square(8, 8), Arc::new(z));
            assert_eq!(candidates.below(3.0 * unit).len(), 3);
            assert_eq!(candidates.list.len(), 6, "z = 6 is not below twice 3");
            assert_eq!(candidates.below(6.0 * unit).len(), 6);
            assert_eq!(candidates.list.len(), 6, "no second scan");
            assert_eq!(candidates.below(30.0 * unit).len(), 30, "many: not listed");
            assert_eq!(candidates.list.len(), 6);
        }
    }
}
