//! Sets of cells of the grid, as sorted lists: work follows the contact, not the grid.

use crate::operator::convolution::Lengths;
use std::ops::Range;

/// A set of cells of an N x N grid: sorted linear indices `iy * N + ix`, with its rows.
#[derive(Debug, Clone, Default)]
pub struct CellSet {
    side: usize,
    index: Vec<u32>,
    rows: Vec<Row>,
}

/// The cells of one row of the grid that belong to a set.
#[derive(Debug, Clone)]
pub struct Row {
    /// Row of the grid.
    pub y: usize,
    /// Their positions in the list of the set.
    pub span: Range<usize>,
}

/// Bounding box of a set: first column and row, width and height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x: usize,
    /// First row.
    pub y: usize,
    /// Number of columns.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
}

impl CellSet {
    /// Takes strictly increasing linear indices below `side^2`.
    pub fn new(side: usize, index: Vec<u32>) -> Self {
        debug_assert!(index.windows(2).all(|w| w[0] < w[1]));
        let mut rows = Vec::new();
        let mut start = 0;
        while start < index.len() {
            let y = index[start] as usize / side;
            let end = (y + 1) * side;
            let length = index[start..].partition_point(|&i| (i as usize) < end);
            rows.push(Row { y, span: start..start + length });
            start += length;
        }
        Self { side, index, rows }
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.index.len()
    }

    /// Whether it has no cells.
    pub fn is_empty(&self) -> bool {
        self.index.is_empty()
    }

    /// Cells a side of the grid.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The sorted linear indices.
    pub fn index(&self) -> &[u32] {
        &self.index
    }

    /// The rows of the grid that hold cells of the set, in order.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Column and row of the cell at a position of the list.
    pub fn place(&self, position: usize) -> (usize, usize) {
        let i = self.index[position] as usize;
        (i % self.side, i / self.side)
    }

    /// The cells at the positions where `keep` says so.
    pub fn filter(&self, keep: impl Fn(usize) -> bool) -> Self {
        let index = self.index.iter().enumerate().filter(|&(k, _)| keep(k)).map(|(_, &i)| i).collect();
        Self::new(self.side, index)
    }

    /// For each cell of `part` (a subset of this set) its position in this list.
    pub fn positions(&self, part: &Self) -> Vec<u32> {
        let mut at = 0;
        part.index
            .iter()
            .map(|&i| {
                while self.index[at] != i {
                    at += 1;
                }
                at as u32
            })
            .collect()
    }

    /// Values on `other` carried over to this set: 0 on cells that `other` lacks, dropped where this set lacks them.
    pub fn carry(&self, other: &Self, values: &[f64]) -> Vec<f64> {
        let mut at = 0;
        self.index
            .iter()
            .map(|&i| {
                while at < other.index.len() && other.index[at] < i {
                    at += 1;
                }
                if other.index.get(at) == Some(&i) { values[at] } else { 0.0 }
            })
            .collect()
    }

    /// Circular lengths of a transform that is exact on the bounding box.
    pub fn free_lengths(&self) -> Lengths {
        self.window().map_or(Lengths { x: 2, y: 2 }, Lengths::free)
    }

    /// Number of cells of the bounding box.
    pub fn window_cells(&self) -> usize {
        self.window().map_or(0, |w| w.width * w.height)
    }

    /// Bounding box; `None` for the empty set.
    pub fn window(&self) -> Option<Window> {
        let (first, last) = (self.rows.first()?, self.rows.last()?);
        let column = |k: usize| self.index[k] as usize % self.side;
        let x = self.rows.iter().map(|r| column(r.span.start)).min()?;
        let end = self.rows.iter().map(|r| column(r.span.end - 1)).max()? + 1;
        Some(Window { x, y: first.y, width: end - x, height: last.y + 1 - first.y })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_window_and_carry() {
        let set = CellSet::new(4, vec![1, 6, 7, 13]);
        assert_eq!(set.rows().len(), 3);
        assert_eq!(set.window(), Some(Window { x: 1, y: 0, width: 3, height: 4 }));
        let part = set.filter(|k| k != 1);
        assert_eq!(part.index(), [1, 7, 13]);
        assert_eq!(set.positions(&part), [0, 2, 3]);
        assert_eq!(set.carry(&part, &[1.0, 2.0, 3.0]), [1.0, 0.0, 2.0, 3.0]);
        assert_eq!(part.carry(&set, &[1.0, 9.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert_eq!(CellSet::new(4, vec![]).window(), None);
        let low = CellSet::new(4, vec![9, 14]);
        assert_eq!(low.window(), Some(Window { x: 1, y: 2, width: 2, height: 2 }));
        assert_eq!(
            (set.window_cells(), low.window_cells(), CellSet::new(4, vec![]).window_cells()),
            (12, 4, 0)
        );
        assert!(!low.is_empty() && CellSet::new(4, vec![]).is_empty());
    }
}
