//! Sets of cells as runs along the rows: what contact looks like that fills the grid.

use crate::cells::CellSet;
use std::ops::Range;

/// A set of cells of an N x N grid, row by row as runs of neighbours. Values on it stand one after the other in the order of the cells.
///
/// A vector on the set is as short as the set, and goes into a row of the grid and back run by run.
#[derive(Debug, Default)]
pub struct Runs {
    side: usize,
    /// Where each row begins; one more at the end.
    rows: Vec<Row>,
    stretches: Vec<Run>,
    /// The column of each cell in the rows whose runs are short.
    columns: Vec<u32>,
}

/// From so many cells a run on, whole runs are moved; below it, cell by cell is faster.
const LONG: usize = 8;

/// Beginning of a row in the lists of its set.
#[derive(Debug, Clone, Copy)]
struct Row {
    run: u32,
    value: u32,
    column: u32,
}

#[derive(Debug, Clone, Copy)]
struct Run {
    /// First column.
    x: u32,
    /// Number of cells.
    length: u32,
    /// Position of its first value.
    at: u32,
}

impl Runs {
    /// The cells that `mark` marks, row after row.
    pub fn marked(side: usize, mark: impl FnMut(usize, &mut [bool])) -> Self {
        let mut set = Self::default();
        set.mark(side, mark);
        set
    }

    /// Becomes the set of the cells that `mark` marks, row after row.
    ///
    /// Cost: the grid once.
    pub fn mark(&mut self, side: usize, mut mark: impl FnMut(usize, &mut [bool])) {
        self.side = side;
        self.rows.clear();
        self.stretches.clear();
        self.columns.clear();
        let mut row = Row { run: 0, value: 0, column: 0 };
        self.rows.push(row);
        let mut marks = vec![false; side];
        for y in 0..side {
            marks.fill(false);
            mark(y, &mut marks);
            let (mut from, first, before) = (0, self.stretches.len(), row.value);
            while let Some(skipped) = marks[from..].iter().position(|&m| m) {
                let x = from + skipped;
                let length = marks[x..].iter().position(|&m| !m).unwrap_or(side - x);
                self.stretches.push(Run { x: x as u32, length: length as u32, at: row.value });
                from = x + length;
                row.value += length as u32;
            }
            if ((row.value - before) as usize) < LONG * (self.stretches.len() - first) {
                self.columns.extend(self.stretches[first..].iter().flat_map(|run| run.x..run.x + run.length));
            }
            row = Row { run: self.stretches.len() as u32, column: self.columns.len() as u32, ..row };
            self.rows.push(row);
        }
    }

    /// The cells of a list.
    pub fn of(set: &CellSet) -> Self {
        Self::marked(set.side(), marks(set))
    }

    /// The same cells as a list.
    pub fn cells(&self) -> CellSet {
        let mut index = Vec::with_capacity(self.len());
        for y in 0..self.side {
            for (columns, _) in self.row(y) {
                index.extend(columns.map(|x| (y * self.side + x) as u32));
            }
        }
        CellSet::new(self.side, index)
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.rows.last().map_or(0, |row| row.value as usize)
    }

    /// Cells a side of the grid.
    pub fn side(&self) -> usize {
        self.side
    }

    /// The runs of row y: columns, and the positions of their values.
    pub fn row(&self, y: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> + '_ {
        self.stretches[self.rows[y].run as usize..self.rows[y + 1].run as usize].iter().map(|run| {
            let (x, at, length) = (run.x as usize, run.at as usize, run.length as usize);
            (x..x + length, at..at + length)
        })
    }

    /// Positions of the values of row y.
    pub fn span(&self, y: usize) -> Range<usize> {
        self.rows[y].value as usize..self.rows[y + 1].value as usize
    }

    /// Columns of the cells of row y, where its runs are so short that they are better moved one by one.
    fn scattered(&self, y: usize) -> Option<&[u32]> {
        let columns = self.rows[y].column as usize..self.rows[y + 1].column as usize;
        (!columns.is_empty()).then(|| &self.columns[columns])
    }

    /// Writes the values of row y where they belong; the rest of the row stays.
    pub fn spread<T: Copy>(&self, y: usize, values: &[T], row: &mut [T]) {
        if let Some(columns) = self.scattered(y) {
            for (&x, &value) in columns.iter().zip(&values[self.span(y)]) {
                row[x as usize] = value;
            }
        } else {
            for (columns, at) in self.row(y) {
                row[columns].copy_from_slice(&values[at]);
            }
        }
    }

    /// Reads the values of row y.
    pub fn collect<T: Copy>(&self, y: usize, row: &[T], values: &mut [T]) {
        if let Some(columns) = self.scattered(y) {
            for (&x, value) in columns.iter().zip(&mut values[self.span(y)]) {
                *value = row[x as usize];
            }
        } else {
            for (columns, at) in self.row(y) {
                values[at].copy_from_slice(&row[columns]);
            }
        }
    }

    /// Adds row y to the values.
    pub fn add(&self, y: usize, row: &[f32], values: &mut [f32]) {
        if let Some(columns) = self.scattered(y) {
            for (&x, value) in columns.iter().zip(&mut values[self.span(y)]) {
                *value += row[x as usize];
            }
        } else {
            for (columns, at) in self.row(y) {
                for (value, more) in values[at].iter_mut().zip(&row[columns]) {
                    *value += more;
                }
            }
        }
    }

    /// Writes one value to all cells of row y.
    pub fn fill<T: Copy>(&self, y: usize, value: T, row: &mut [T]) {
        if let Some(columns) = self.scattered(y) {
            for &x in columns {
                row[x as usize] = value;
            }
        } else {
            for (columns, _) in self.row(y) {
                row[columns].fill(value);
            }
        }
    }

    /// Values on another set carried over to this one: 0 on cells that the other lacks.
    pub fn carry<T: Copy + Default>(&self, other: &Self, values: &[T]) -> Vec<T> {
        let mut carried = Vec::new();
        self.carry_to(other, values, &mut carried);
        carried
    }

    /// The same into a vector that is at hand.
    pub fn carry_to<T: Copy + Default>(&self, other: &Self, values: &[T], carried: &mut Vec<T>) {
        carried.clear();
        carried.resize(self.len(), T::default());
        let mut row = vec![T::default(); self.side];
        for y in 0..self.side {
            row.fill(T::default());
            other.spread(y, values, &mut row);
            self.collect(y, &row, carried);
        }
    }

    /// Becomes the set of the cells of another whose values are positive.
    pub fn positive(&mut self, other: &Self, values: &[f64]) {
        let mut row = vec![0.0; other.side];
        self.mark(other.side, |y, marks| {
            row.fill(0.0);
            other.spread(y, values, &mut row);
            for (mark, &value) in marks.iter_mut().zip(&row) {
                *mark = value > 0.0;
            }
        });
    }
}

/// Marks the cells of a list, row after row.
pub fn marks(set: &CellSet) -> impl FnMut(usize, &mut [bool]) + '_ {
    let mut rows = set.rows().iter().peekable();
    move |y, marks| {
        if let Some(row) = rows.next_if(|row| row.y == y) {
            for &i in &set.index()[row.span.clone()] {
                marks[i as usize - y * set.side()] = true;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn runs_are_the_list(side in 1usize..20, picks in proptest::collection::vec(any::<bool>(), 1..90), other in 1usize..5) {
            let list = |step: usize| {
                let index = (0..side * side).filter(|i| picks[i * step % picks.len()]).map(|i| i as u32);
                CellSet::new(side, index.collect())
            };
            let (a, b) = (list(1), list(other));
            let (runs, others) = (Runs::of(&a), Runs::of(&b));
            let back = runs.cells();
            prop_assert_eq!(back.index(), a.index());
            prop_assert_eq!((runs.len(), runs.side()), (a.len(), side));
            let values: Vec<f64> = (0..b.len()).map(|k| 1.0 + k as f64).collect();
            prop_assert_eq!(runs.carry(&others, &values), a.carry(&b, &values));
            // A set that held something else before.
            let mut odd = Runs::of(&b);
            let alternating: Vec<f64> = (0..a.len()).map(|k| if k % 2 == 1 { 1.0 } else { -1.0 }).collect();
            odd.positive(&runs, &alternating);
            let (odd, expected) = (odd.cells(), a.filter(|k| k % 2 == 1));
            prop_assert_eq!(odd.index(), expected.index());
            for y in 0..side {
                let row: Vec<f32> = (0..side).map(|x| 1.0 + x as f32).collect();
                let (mut sum, mut read) = (vec![0.5; runs.len()], vec![0.0; runs.len()]);
                runs.add(y, &row, &mut sum);
                runs.collect(y, &row, &mut read);
                let expected: Vec<f32> = read.iter().map(|read| 0.5 + read).collect();
                prop_assert_eq!(sum, expected);
                let span = runs.span(y);
                prop_assert_eq!(span.clone().count(), runs.row(y).map(|(columns, _)| columns.len()).sum::<usize>());
                prop_assert!(runs.row(y).flat_map(|(_, at)| at).eq(span));
            }
        }
    }
}
