//! Connected patches of a set of cells.

use contact_model::{Boundary, Cells};

/// Number of cells in each connected patch of a set, in the order of the patches' first cells; cells are
/// connected when they share an edge.
///
/// `index` holds strictly increasing linear indices `iy * columns + ix` on a grid of `cells` (one number for
/// equal columns and rows, or `[columns, rows]`). Where the boundary is periodic, opposite edges of the grid are
/// joined. Cost: O(n log n) at worst, O(n) in practice, for n cells of the set; it does not depend on the
/// size of the grid.
///
/// ```
/// use contact_model::Boundary;
/// // Two cells in opposite corners of a row of 3 x 3, and one below the first.
/// let index = [0, 2, 3];
/// assert_eq!(surface_gen::patches(3, &index, Boundary::Free), [2, 1]);
/// assert_eq!(surface_gen::patches(3, &index, Boundary::Periodic), [3]);
/// // The same indices on 6 columns and 2 rows: one row of three cells, of which the last two touch.
/// assert_eq!(surface_gen::patches([6, 2], &index, Boundary::Free), [1, 2]);
/// ```
pub fn patches(cells: impl Into<Cells>, index: &[u32], boundary: Boundary) -> Vec<usize> {
    let mut forest = Forest { parent: (0..index.len()).collect() };
    neighbours(cells.into(), index, boundary, |a, b| forest.join(a, b));
    let mut sizes = vec![0; index.len()];
    for k in 0..index.len() {
        sizes[forest.root(k)] += 1;
    }
    sizes.retain(|&size| size > 0);
    sizes
}

/// Number of edges between a cell of a set and one that is not of the set; with free boundaries the edges of
/// the grid count as well. Arguments, conventions and cost as those of [`patches`].
///
/// ```
/// use contact_model::Boundary;
/// // A row of three cells, and the same around the grid.
/// assert_eq!(surface_gen::boundary_edges(3, &[3, 4, 5], Boundary::Free), 8);
/// assert_eq!(surface_gen::boundary_edges(3, &[3, 4, 5], Boundary::Periodic), 6);
/// ```
pub fn boundary_edges(cells: impl Into<Cells>, index: &[u32], boundary: Boundary) -> usize {
    let mut shared = 0;
    neighbours(cells.into(), index, boundary, |_, _| shared += 1);
    4 * index.len() - 2 * shared
}

/// Calls `pair` with the positions in the list of every two cells that share an edge, once for each edge.
fn neighbours(cells: Cells, index: &[u32], boundary: Boundary, mut pair: impl FnMut(usize, usize)) {
    let Cells { columns, rows } = cells;
    debug_assert!(index.windows(2).all(|w| w[0] < w[1]));
    let place = |k: usize| (index[k] as usize % columns, index[k] as usize / columns);
    // Position in the list of the cell above the one looked at: both go through the list in order.
    let mut above = 0;
    for k in 0..index.len() {
        let (x, y) = place(k);
        if x > 0 && k > 0 && index[k - 1] + 1 == index[k] {
            pair(k - 1, k);
        }
        if y > 0 {
            let wanted = index[k] - columns as u32;
            while index[above] < wanted {
                above += 1;
            }
            if index[above] == wanted {
                pair(above, k);
            }
        }
    }
    let [along_x, along_y] = boundary.repeats();
    if along_x || along_y {
        let find = |x: usize, y: usize| index.binary_search(&((y * columns + x) as u32)).ok();
        for k in 0..index.len() {
            let (x, y) = place(k);
            let over_x = (along_x && x == 0).then(|| find(columns - 1, y));
            let over_y = (along_y && y == 0).then(|| find(x, rows - 1));
            for other in [over_x, over_y] {
                if let Some(other) = other.flatten() {
                    pair(k, other);
                }
            }
        }
    }
}

/// Disjoint sets; the root of a set is its first member.
struct Forest {
    parent: Vec<usize>,
}

impl Forest {
    fn root(&mut self, mut k: usize) -> usize {
        while self.parent[k] != k {
            self.parent[k] = self.parent[self.parent[k]];
            k = self.parent[k];
        }
        k
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use proptest::test_runner::RngSeed;

    /// Flood fill on the whole grid: the reference.
    fn flooded(cells: impl Into<Cells>, set: &[bool], boundary: Boundary) -> Vec<usize> {
        let Cells { columns, rows } = cells.into();
        let mut seen = vec![false; set.len()];
        let mut sizes = Vec::new();
        for start in 0..set.len() {
            if !set[start] || seen[start] {
                continue;
            }
            let (mut stack, mut size) = (vec![start], 0);
            seen[start] = true;
            while let Some(i) = stack.pop() {
                size += 1;
                let (x, y) = (i % columns, i / columns);
                for (dx, dy) in [(1, 0), (columns - 1, 0), (0, 1), (0, rows - 1)] {
                    let (to_x, to_y) = ((x + dx) % columns, (y + dy) % rows);
                    let wraps = [to_x.abs_diff(x) > 1, to_y.abs_diff(y) > 1];
                    let leaves = (0..2).any(|i| wraps[i] && !boundary.repeats()[i]);
                    let j = to_y * columns + to_x;
                    if set[j] && !seen[j] && !leaves {
                        seen[j] = true;
                        stack.push(j);
                    }
                }
            }
            sizes.push(size);
        }
        sizes
    }

    fn index(set: &[bool]) -> Vec<u32> {
        set.iter().enumerate().filter(|(_, on)| **on).map(|(i, _)| i as u32).collect()
    }

    #[test]
    fn corners_do_not_connect_and_rings_are_one() {
        let board: Vec<bool> = (0..16).map(|i| (i + i / 4) % 2 == 0).collect();
        assert_eq!(patches(4, &index(&board), Boundary::Free), [1; 8]);
        assert_eq!(patches(4, &index(&board), Boundary::Periodic), [1; 8]);
        let ring: Vec<bool> = (0..25).map(|i| i != 12).collect();
        assert_eq!(patches(5, &index(&ring), Boundary::Free), [24]);
        assert!(patches(5, &[], Boundary::Free).is_empty());
        assert_eq!(patches(1, &[0], Boundary::Periodic), [1]);
        // A comb: teeth that meet in the last row only.
        let comb: Vec<bool> = (0..49).map(|i| i % 2 == 0 && i % 7 % 2 == 0 || i >= 42).collect();
        assert_eq!(patches(7, &index(&comb), Boundary::Free), flooded(7, &comb, Boundary::Free));
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 64, rng_seed: RngSeed::Fixed(11), ..ProptestConfig::default() })]

        /// Beside the flood fill, and what cannot depend on the way: the sum, and the number without and with
        /// the wrap.
        #[test]
        fn a_flood_finds_the_same(set in proptest::collection::vec(0.0..1.0_f64, 81), density in 0.05..0.95_f64) {
            let set: Vec<bool> = set.into_iter().map(|u| u < density).collect();
            let index = index(&set);
            for cells in [[9, 9], [27, 3], [3, 27], [81, 1], [1, 81]] {
                for &boundary in Boundary::ALL {
                    let found = patches(cells, &index, boundary);
                    prop_assert_eq!(found.iter().sum::<usize>(), index.len());
                    prop_assert_eq!(&found, &flooded(cells, &set, boundary));
                }
                let [free, periodic] = [Boundary::Free, Boundary::Periodic].map(|b| patches(cells, &index, b).len());
                prop_assert!(periodic <= free);
            }
        }
    }
}
