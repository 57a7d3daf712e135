//! The cells that may touch at a given approach: those whose undeformed gap z is smaller.

use crate::cells::CellSet;
use std::sync::Arc;

/// How far above the asked approach the list is filled, so that a path of loads does not scan the grid each time.
const AHEAD: f64 = 2.0;

/// Finds the cells with `z < d`.
///
/// Outside them the gap `u + z - d` is positive because u is not negative: they need no check and no storage.
#[derive(Debug)]
pub struct Candidates {
    side: usize,
    z: Arc<Vec<f64>>,
    /// Cells with z < cap.
    list: CellSet,
    cap: f64,
}

impl Candidates {
    /// Takes the undeformed gaps of an N x N grid.
    pub fn new(side: usize, z: Arc<Vec<f64>>) -> Self {
        Self { side, z, list: CellSet::new(side, Vec::new()), cap: 0.0 }
    }

    /// The undeformed gaps of the whole grid.
    pub fn z(&self) -> &[f64] {
        &self.z
    }

    /// The cells with `z < d`.
    ///
    /// Cost: the grid once for each doubling of d, else the candidates of the last doubling.
    pub fn below(&mut self, d: f64) -> CellSet {
        if d > self.cap {
            self.cap = AHEAD * d;
            let cap = self.cap;
            let mut index = Vec::with_capacity(self.z.iter().filter(|&&z| z < cap).count());
            index.extend(self.z.iter().enumerate().filter(|&(_, &z)| z < cap).map(|(i, _)| i as u32));
            self.list = CellSet::new(self.side, index);
        }
        self.list.filter(|k| self.z[self.list.index()[k] as usize] < d)
    }

    /// Whether more than `count` cells lie below d.
    ///
    /// Cost: the grid at most, much less where the answer is yes.
    pub fn more_than(&self, count: usize, d: f64) -> bool {
        self.z.iter().filter(|&&z| z < d).nth(count).is_some()
    }

    /// The undeformed gaps on a set.
    pub fn gaps(&self, set: &CellSet) -> Vec<f64> {
        set.index().iter().map(|&i| self.z[i as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn below_is_strict_and_complete_whatever_was_asked_before() {
        let z = Arc::new(vec![0.0, 0.5, 1.0, 0.25, 3.0, 2.0, 0.0, 1.5, 0.75]);
        let mut candidates = Candidates::new(3, Arc::clone(&z));
        for d in [0.5, 0.1, 4.0, 1.0, 0.0] {
            let expected: Vec<u32> = (0..9).filter(|&i| z[i as usize] < d).collect();
            assert_eq!(candidates.below(d).index(), expected, "d = {d}");
            for count in 0..9 {
                assert_eq!(candidates.more_than(count, d), expected.len() > count, "{count} at d = {d}");
            }
        }
    }

    #[test]
    fn the_grid_is_scanned_for_twice_the_approach_in_any_unit() {
        // Work: a path of loads up to twice the first one is served from the list, and the list holds no more.
        for unit in [2f64.powi(-40), 1.0, 2f64.powi(40)] {
            let z = (0..16).map(|i| f64::from(i) * unit).collect();
            let mut candidates = Candidates::new(4, Arc::new(z));
            assert_eq!(candidates.below(3.0 * unit).len(), 3);
            assert_eq!(candidates.list.len(), 6, "z = 6 is not below twice 3");
            assert_eq!(candidates.below(6.0 * unit).len(), 6);
            assert_eq!(candidates.list.len(), 6, "no second scan");
        }
    }
}
