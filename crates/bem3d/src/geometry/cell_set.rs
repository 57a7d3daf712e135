//! Sets of cells of a grid, so that the work is proportional to the contact, not to the grid.

use super::grid::{Grid, Window};
use crate::tasks::each;
use crate::tuning::{BAND, LANES, LONG_RUN, PASSED_SINGLY};
use contact_model::{Interrupted, Stop, never};
use numerics::parallel::{map, threads_for};
use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::ops::{AddAssign, Range};

/// A set of cells, row by row. Values on it stand one after the other in the order of the cells.
///
/// Every cell has its column; where the cells of a row form long runs, the runs are kept too, and values move
/// run by run.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct CellSet {
    rows: Vec<RowStart>,
    columns: Vec<u32>,
    runs: Vec<ColumnRun>,
}

/// Where a row begins in the lists of its set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct RowStart {
    y: u32,
    cells: u32,
    runs: u32,
}

/// Neighbouring cells of one row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct ColumnRun {
    x: u32,
    length: u32,
}

/// The cells of a set in one row of the grid.
#[derive(Debug, Clone, Copy)]
pub struct SetRow<'a> {
    /// Row of the grid.
    pub y: usize,
    /// Position of its first cell.
    start: usize,
    /// Columns of its cells.
    pub columns: &'a [u32],
    runs: &'a [ColumnRun],
}

impl SetRow<'_> {
    /// The row where the values of the set from position `start` on are given.
    pub fn after(self, start: usize) -> Self {
        Self { start: self.start - start, ..self }
    }

    /// Positions of its cells in the list of the set.
    pub fn span(&self) -> Range<usize> {
        self.start..self.start + self.columns.len()
    }

    /// Its runs as columns of a row that begins at column x0, with the positions of their values.
    fn runs(&self, x0: usize) -> impl Iterator<Item = (Range<usize>, Range<usize>)> + '_ {
        let mut at = self.start;
        self.runs.iter().map(move |run| {
            let (x, length) = (run.x as usize - x0, run.length as usize);
            at += length;
            (x..x + length, at - length..at)
        })
    }

    /// Writes the values of a set where they belong in a row that begins at column x0; the rest of the row
    /// stays.
    pub fn spread<T: Copy>(&self, values: &[T], row: &mut [T], x0: usize) {
        if self.runs.is_empty() {
            for (&x, &value) in self.columns.iter().zip(&values[self.span()]) {
                row[x as usize - x0] = value;
            }
        } else {
            for (columns, at) in self.runs(x0) {
                row[columns].copy_from_slice(&values[at]);
            }
        }
    }

    /// Reads the values of a set from a row that begins at column x0.
    pub fn collect<T: Copy>(&self, row: &[T], values: &mut [T], x0: usize) {
        if self.runs.is_empty() {
            for (&x, value) in self.columns.iter().zip(&mut values[self.span()]) {
                *value = row[x as usize - x0];
            }
        } else {
            for (columns, at) in self.runs(x0) {
                values[at].copy_from_slice(&row[columns]);
            }
        }
    }

    /// Adds a row that begins at column x0 to the values of a set.
    pub fn add<T: Copy + AddAssign>(&self, row: &[T], values: &mut [T], x0: usize) {
        if self.runs.is_empty() {
            for (&x, value) in self.columns.iter().zip(&mut values[self.span()]) {
                *value += row[x as usize - x0];
            }
        } else {
            for (columns, at) in self.runs(x0) {
                for (value, &more) in values[at].iter_mut().zip(&row[columns]) {
                    *value += more;
                }
            }
        }
    }

    /// Writes one value to its cells in a row that begins at column x0.
    pub fn fill<T: Copy>(&self, value: T, row: &mut [T], x0: usize) {
        if self.runs.is_empty() {
            for &x in self.columns {
                row[x as usize - x0] = value;
            }
        } else {
            for (columns, _) in self.runs(x0) {
                row[columns].fill(value);
            }
        }
    }
}

/// Its rows with the number of cells in each, then the columns of all.
impl Serialize for CellSet {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let rows: Vec<(u32, u32)> = self.rows().map(|row| (row.y as u32, row.columns.len() as u32)).collect();
        (rows, &self.columns).serialize(to)
    }
}

impl<'de> Deserialize<'de> for CellSet {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let (rows, columns) = <(Vec<(u32, u32)>, Vec<u32>)>::deserialize(from)?;
        let mut set = Self::default();
        let mut rest = &columns[..];
        for (y, length) in rows {
            let row = rest.split_at_checked(length as usize).filter(|(row, _)| {
                let follows = set.rows.last().is_none_or(|last| last.y < y);
                follows && !row.is_empty() && row.is_sorted_by(|a, b| a < b)
            });
            let (row, after) = row.ok_or_else(|| D::Error::custom("rows of cells in order"))?;
            set.push_row(y as usize, row.iter().copied());
            rest = after;
        }
        if rest.is_empty() { Ok(set) } else { Err(D::Error::custom("cells in rows")) }
    }
}

impl CellSet {
    /// All cells of a grid.
    pub fn all(grid: Grid) -> Self {
        Self::from_rows((0..grid.rows).map(|y| (y, 0..grid.columns as u32)))
    }

    /// From rows in increasing order, each with its columns in increasing order.
    pub fn from_rows<C: IntoIterator<Item = u32>>(rows: impl IntoIterator<Item = (usize, C)>) -> Self {
        let mut set = Self::default();
        for (y, columns) in rows {
            set.push_row(y, columns);
        }
        set
    }

    /// The cells with one of these strictly increasing linear indices `y * columns + x`.
    pub fn from_index(grid: Grid, index: &[u32]) -> Self {
        let row = |i: &u32| *i as usize / grid.columns;
        let rows = index.chunk_by(|a, b| row(a) == row(b));
        Self::from_rows(rows.map(|cells| {
            let first = (row(&cells[0]) * grid.columns) as u32;
            (row(&cells[0]), cells.iter().map(move |i| i - first))
        }))
    }

    /// The cells of a grid whose value, row-major, is kept.
    pub fn of_grid<T: Copy + Sync>(grid: Grid, values: &[T], keep: impl Fn(T) -> bool + Sync) -> Self {
        let columns = grid.columns;
        Self::of_bands(values.len(), values.chunks(BAND * columns).enumerate(), |set, (band, values)| {
            for (y, values) in values.chunks_exact(columns).enumerate() {
                set.push_kept(band * BAND + y, |k| k as u32, values, &keep);
            }
        })
    }

    /// Puts bands of rows together, each made by one thread.
    fn of_bands<P: Send>(
        work: usize,
        bands: impl ExactSizeIterator<Item = P> + Send,
        make: impl Fn(&mut Self, P) + Sync,
    ) -> Self {
        if threads_for(work) == 1 {
            let mut whole = Self::default();
            bands.for_each(|band| make(&mut whole, band));
            return whole;
        }
        let parts = map(work, bands, |band| {
            let mut part = Self::default();
            make(&mut part, band);
            part
        });
        let mut parts = parts.into_iter();
        let mut whole = parts.next().unwrap_or_default();
        for part in parts {
            let (cells, runs) = (whole.columns.len() as u32, whole.runs.len() as u32);
            let moved = |row: &RowStart| RowStart { cells: row.cells + cells, runs: row.runs + runs, ..*row };
            whole.rows.extend(part.rows.iter().map(moved));
            whole.columns.extend_from_slice(&part.columns);
            whole.runs.extend_from_slice(&part.runs);
        }
        whole
    }

    /// Ranges of rows of the grid that threads share.
    fn bands(&self) -> impl ExactSizeIterator<Item = Range<usize>> + use<> {
        let first = self.rows.first().map_or(0, |row| row.y as usize / BAND);
        let end = self.rows.last().map_or(0, |row| row.y as usize / BAND + 1);
        (first..end).map(|band| band * BAND..(band + 1) * BAND)
    }

    /// The cells of a grid whose linear index is kept.
    #[cfg(test)]
    pub fn numbered(grid: Grid, keep: impl Fn(usize) -> bool) -> Self {
        let index: Vec<u32> = (0..grid.count() as u32).filter(|&i| keep(i as usize)).collect();
        Self::from_index(grid, &index)
    }

    /// Adds the cells of the next row that has any.
    fn push_row(&mut self, y: usize, columns: impl IntoIterator<Item = u32>) {
        let first = self.columns.len();
        self.columns.extend(columns);
        self.end_row(y, first);
    }

    /// Adds the next row from two increasing lists of its columns.
    ///
    /// Cost: the cells between two cells of the shorter list are copied as a whole.
    fn push_merged(&mut self, y: usize, a: &[u32], b: &[u32]) {
        let first = self.columns.len();
        let (few, mut many) = if a.len() < b.len() { (a, b) } else { (b, a) };
        for &x in few {
            // A few steps, then halving: the next cell is near where both lists are long.
            let near = many.iter().take(PASSED_SINGLY).take_while(|&&other| other < x).count();
            let before = if near < PASSED_SINGLY {
                near
            } else {
                near + many[near..].partition_point(|&other| other < x)
            };
            let (passed, rest) = many.split_at(before);
            self.columns.extend_from_slice(passed);
            many = rest;
            if many.first() != Some(&x) {
                self.columns.push(x);
            }
        }
        self.columns.extend_from_slice(many);
        self.end_row(y, first);
    }

    /// Adds the cells of the next row whose value is kept; `column` gives that of the k-th value.
    ///
    /// Cost: a comparison a cell where nothing is kept; elsewhere no branch depends on the pattern.
    fn push_kept<T: Copy>(
        &mut self,
        y: usize,
        column: impl Fn(usize) -> u32,
        values: &[T],
        keep: impl Fn(T) -> bool,
    ) {
        let first = self.columns.len();
        self.columns.resize(first + values.len(), 0);
        let kept = &mut self.columns[first..];
        let mut count = 0;
        for (i, values) in values.chunks(LANES).enumerate() {
            if values.iter().fold(false, |any, &value| any | keep(value)) {
                for (j, &value) in values.iter().enumerate() {
                    kept[count] = column(i * LANES + j);
                    count += usize::from(keep(value));
                }
            }
        }
        self.columns.truncate(first + count);
        self.end_row(y, first);
    }

    /// Makes a row of the columns from `first` on, unless there are none.
    fn end_row(&mut self, y: usize, first: usize) {
        let row = &self.columns[first..];
        let Some(&x) = row.first() else { return };
        self.rows.push(RowStart { y: y as u32, cells: first as u32, runs: self.runs.len() as u32 });
        let breaks = row.windows(2).filter(|pair| pair[0] + 1 != pair[1]).count();
        if row.len() < LONG_RUN * (breaks + 1) {
            return;
        }
        let mut run = ColumnRun { x, length: 1 };
        for &x in &row[1..] {
            if x == run.x + run.length {
                run.length += 1;
            } else {
                self.runs.push(std::mem::replace(&mut run, ColumnRun { x, length: 1 }));
            }
        }
        self.runs.push(run);
    }

    /// Whether a grid has all its cells.
    pub fn is_on(&self, grid: Grid) -> bool {
        let on_row = |row: SetRow<'_>| row.columns.last().is_none_or(|&x| (x as usize) < grid.columns);
        self.rows().all(|row| row.y < grid.rows && on_row(row))
    }

    /// Number of cells.
    pub fn len(&self) -> usize {
        self.columns.len()
    }

    /// Whether it has no cells.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// The rows of the grid that hold cells of the set, in order.
    pub fn rows(&self) -> impl Iterator<Item = SetRow<'_>> + Clone {
        self.numbered_rows(0..self.rows.len())
    }

    /// Those of them that lie in a range of rows of the grid.
    pub fn rows_within(&self, ys: Range<usize>) -> impl Iterator<Item = SetRow<'_>> + Clone {
        self.numbered_rows(self.number(ys.start)..self.number(ys.end))
    }

    /// The cells in one row of the grid, where there are any.
    pub fn row(&self, y: usize) -> Option<SetRow<'_>> {
        let number = self.number(y);
        (self.rows.get(number)?.y as usize == y).then(|| self.numbered_row(number))
    }

    /// Number of rows with cells before row y of the grid.
    fn number(&self, y: usize) -> usize {
        // Where no row before it is empty its place is known.
        let first = self.rows.first().map_or(0, |row| row.y as usize);
        if let Some(place) = y.checked_sub(first)
            && self.rows.get(place).is_some_and(|row| row.y as usize == y)
        {
            return place;
        }
        self.rows.partition_point(|row| (row.y as usize) < y)
    }

    /// Position of the first cell in row y of the grid or after it.
    fn position(&self, y: usize) -> usize {
        self.rows.get(self.number(y)).map_or(self.columns.len(), |row| row.cells as usize)
    }

    fn numbered_rows(&self, numbers: Range<usize>) -> impl Iterator<Item = SetRow<'_>> + Clone {
        numbers.map(move |number| self.numbered_row(number))
    }

    fn numbered_row(&self, number: usize) -> SetRow<'_> {
        let end = RowStart { y: u32::MAX, cells: self.columns.len() as u32, runs: self.runs.len() as u32 };
        let (row, next) = (self.rows[number], self.rows.get(number + 1).copied().unwrap_or(end));
        SetRow {
            y: row.y as usize,
            start: row.cells as usize,
            columns: &self.columns[row.cells as usize..next.cells as usize],
            runs: &self.runs[row.runs as usize..next.runs as usize],
        }
    }

    /// Cuts values on the set into those of bands of rows that begin at these rows of the grid, each with its
    /// first position. The first band begins at the first row of the set or before it.
    pub fn split<'v, T>(
        &self,
        mut values: &'v mut [T],
        bands: impl Iterator<Item = usize>,
    ) -> Vec<(usize, &'v mut [T])> {
        let mut starts: Vec<usize> = bands.map(|y| self.position(y)).collect();
        starts.push(self.len());
        let cut = |pair: &[usize]| {
            let (band, rest) = std::mem::take(&mut values).split_at_mut(pair[1] - pair[0]);
            values = rest;
            (pair[0], band)
        };
        starts.windows(2).map(cut).collect()
    }

    /// Column and row of each cell.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.rows().flat_map(|row| row.columns.iter().map(move |&x| (x as usize, row.y)))
    }

    /// Linear index `y * columns + x` of each cell.
    pub fn index(&self, grid: Grid) -> impl Iterator<Item = usize> + '_ {
        self.places().map(move |(x, y)| y * grid.columns + x)
    }

    /// Bounding box; `None` for the empty set.
    pub fn window(&self) -> Option<Window> {
        let (first, last) = (self.rows.first()?.y as usize, self.rows.last()?.y as usize);
        let ends = self.rows().filter_map(|row| Some((*row.columns.first()?, *row.columns.last()?)));
        let (low, high) = ends.fold((u32::MAX, 0), |(low, high), (a, b)| (low.min(a), high.max(b)));
        let width = (high + 1).checked_sub(low)? as usize;
        Some(Window { x: low as usize, y: first, width, height: last + 1 - first })
    }

    /// The cells whose value is kept.
    pub fn filter<T: Copy + Sync>(&self, values: &[T], keep: impl Fn(T) -> bool + Sync) -> Self {
        Self::of_bands(self.len(), self.bands(), |kept, ys| {
            for row in self.rows_within(ys) {
                kept.push_kept(row.y, |k| row.columns[k], &values[row.span()], &keep);
            }
        })
    }

    /// The cells that `other` lacks.
    pub fn without(&self, other: &Self) -> Self {
        Self::of_bands(self.len(), self.bands(), |rest, ys| {
            for row in self.rows_within(ys) {
                let mut taken = columns(other.row(row.y));
                let lacks = |x: &u32| {
                    while taken.first().is_some_and(|first| first < x) {
                        taken = &taken[1..];
                    }
                    taken.first() != Some(x)
                };
                rest.push_row(row.y, row.columns.iter().copied().filter(lacks));
            }
        })
    }

    /// The cells of either set.
    pub fn union(&self, other: &Self) -> Self {
        let ends =
            [self, other].into_iter().flat_map(|set| set.rows.first().into_iter().chain(set.rows.last()));
        let bands = ends.map(|row| row.y as usize / BAND);
        let (first, end) =
            bands.fold((usize::MAX, 0), |(first, end), band| (first.min(band), end.max(band + 1)));
        Self::of_bands(self.len() + other.len(), first.min(end)..end, |both, band| {
            for y in band * BAND..(band + 1) * BAND {
                let (a, b) = (self.row(y), other.row(y));
                if a.is_some() || b.is_some() {
                    both.push_merged(y, columns(a), columns(b));
                }
            }
        })
    }

    /// Values on `other` carried over to this set: 0 on cells that `other` lacks, dropped where this set
    /// lacks them.
    pub fn carry<T: Copy + Default + Send + Sync>(&self, other: &Self, values: &[T]) -> Vec<T> {
        let mut carried = Vec::new();
        self.carry_to(other, values, &mut carried);
        carried
    }

    /// The same into a vector that is at hand.
    pub fn carry_to<T: Copy + Default + Send + Sync>(
        &self,
        other: &Self,
        values: &[T],
        carried: &mut Vec<T>,
    ) {
        carried.resize(self.len(), T::default());
        self.beside(other, values, carried, |row, line, own, x0| match line {
            Some(line) => row.collect(line, own, x0),
            None => own[row.span()].fill(T::default()),
        });
    }

    /// Adds values on `other` to values on this set.
    pub fn add_carried<T: Copy + Default + AddAssign + Send + Sync>(
        &self,
        other: &Self,
        values: &[T],
        sums: &mut [T],
    ) {
        self.beside(other, values, sums, |row, line, own, x0| {
            if let Some(line) = line {
                row.add(line, own, x0);
            }
        });
    }

    /// Changes values on the set row by row, `work` in all.
    pub fn update<T: Send>(
        &self,
        work: usize,
        values: &mut [T],
        change: impl Fn(SetRow<'_>, &mut [T]) + Sync,
    ) {
        let _ = self.update_until(work, values, &never, change);
    }

    /// The same until a stop, which is asked between bands of rows.
    ///
    /// # Errors
    /// [`Interrupted`] where rows are left.
    pub fn update_until<T: Send>(
        &self,
        work: usize,
        values: &mut [T],
        stop: Stop<'_>,
        change: impl Fn(SetRow<'_>, &mut [T]) + Sync,
    ) -> Result<(), Interrupted> {
        let parts = self.split(values, self.bands().map(|ys| ys.start));
        each(work, self.bands().zip(parts), stop, |(ys, (start, values))| {
            for row in self.rows_within(ys) {
                change(row.after(start), values);
            }
        })
    }

    /// Changes the values `own` of each row by those on `other`, given as a line that begins at a column and is
    /// zero elsewhere; `None` where `other` has no cell in the row.
    fn beside<T: Copy + Default + Send + Sync>(
        &self,
        other: &Self,
        values: &[T],
        own: &mut [T],
        change: impl Fn(SetRow<'_>, Option<&[T]>, &mut [T], usize) + Sync,
    ) {
        let window = self.window().into_iter().chain(other.window()).reduce(Window::union);
        let Some(window) = window else { return };
        let parts = self.split(own, self.bands().map(|ys| ys.start));
        map(self.len() + other.len(), self.bands().zip(parts), |(ys, (start, own))| {
            let mut line = vec![T::default(); window.width];
            for row in self.rows_within(ys) {
                let Some(other) = other.row(row.y) else {
                    change(row.after(start), None, own, window.x);
                    continue;
                };
                other.spread(values, &mut line, window.x);
                change(row.after(start), Some(&line), own, window.x);
                other.fill(T::default(), &mut line, window.x);
            }
        });
    }
}

fn columns(row: Option<SetRow<'_>>) -> &[u32] {
    row.map_or(&[], |row| row.columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GRID: Grid = Grid { columns: 4, rows: 5, stretch: 1.0 };

    fn set(index: &[u32]) -> CellSet {
        CellSet::from_index(GRID, index)
    }

    fn index(set: &CellSet) -> Vec<usize> {
        set.index(GRID).collect()
    }

    #[test]
    fn rows_window_and_carry() {
        let all = set(&[1, 6, 7, 13]);
        assert_eq!(
            all.rows().map(|row| (row.y, row.span())).collect::<Vec<_>>(),
            [(0, 0..1), (1, 1..3), (3, 3..4)]
        );
        assert_eq!(all.window(), Some(Window { x: 1, y: 0, width: 3, height: 4 }));
        let part = all.filter(&[0, 1, 2, 3], |k| k != 1);
        assert_eq!(index(&part), [1, 7, 13]);
        assert_eq!(all.carry(&part, &[1.0, 2.0, 3.0]), [1.0, 0.0, 2.0, 3.0]);
        assert_eq!(part.carry(&all, &[1.0, 9.0, 2.0, 3.0]), [1.0, 2.0, 3.0]);
        assert_eq!(index(&all.without(&part)), [6]);
        assert_eq!(index(&all.without(&set(&[0, 5, 6, 8, 13, 19]))), [1, 7]);
        assert_eq!(set(&[]).window(), None);
        assert_eq!(set(&[9, 14]).window(), Some(Window { x: 1, y: 2, width: 2, height: 2 }));
        assert!(set(&[]).is_empty() && !all.is_empty());
        assert_eq!(index(&set(&[0, 9, 19]).union(&set(&[0, 3, 8, 10, 16]))), [0, 3, 8, 9, 10, 16, 19]);
        assert_eq!(CellSet::all(GRID).len(), 20);
    }

    proptest! {
        #[test]
        fn sets_equal_plain_lists(
            columns in 1usize..40, rows in 1usize..6,
            picks in prop::collection::vec(0.0..1.0f64, 240), density in 0.05..1.0f64, other in 0.05..1.0f64,
        ) {
            let grid = Grid::square(columns, rows);
            let list = |from: f64, to: f64| -> Vec<u32> {
                (0..grid.count() as u32).filter(|&i| (from..to).contains(&picks[i as usize])).collect()
            };
            let (a, b) = (list(0.0, density), list(other - 0.5, other));
            let (set_a, set_b) = (CellSet::from_index(grid, &a), CellSet::from_index(grid, &b));
            let index = |set: &CellSet| set.index(grid).map(|i| i as u32).collect::<Vec<_>>();
            prop_assert_eq!(index(&set_a), a.clone());
            let mut union = [a.clone(), b.clone()].concat();
            union.sort_unstable();
            union.dedup();
            prop_assert_eq!(index(&set_a.union(&set_b)), union);
            let values: Vec<f64> = (0..b.len()).map(|k| 1.0 + k as f64).collect();
            let expected: Vec<f64> =
                a.iter().map(|i| b.binary_search(i).map_or(0.0, |k| values[k])).collect();
            // Into a vector that held something else, and added to what was there.
            let (mut carried, mut sums) = (vec![7.0; 3], vec![0.5; a.len()]);
            set_a.carry_to(&set_b, &values, &mut carried);
            prop_assert_eq!(&carried, &expected);
            set_a.add_carried(&set_b, &values, &mut sums);
            prop_assert_eq!(sums, expected.iter().map(|v| v + 0.5).collect::<Vec<_>>());
            let both = set_a.union(&set_b);
            let plain = |keep: &dyn Fn(usize, u32) -> bool| -> Vec<u32> {
                index(&both).into_iter().enumerate().filter(|&(k, i)| keep(k, i)).map(|(_, i)| i).collect()
            };
            // Rows and runs, too, are those of the list.
            let others = plain(&|_, i| b.binary_search(&i).is_err());
            prop_assert_eq!(both.without(&set_b), CellSet::from_index(grid, &others));
            let order: Vec<usize> = (0..both.len()).collect();
            let third = plain(&|k, _| k % 40 > 20 || k.is_multiple_of(3));
            let kept = both.filter(&order, |k| k % 40 > 20 || k.is_multiple_of(3));
            prop_assert_eq!(kept, CellSet::from_index(grid, &third));
            let picks = &picks[..grid.count()];
            prop_assert_eq!(CellSet::of_grid(grid, picks, |pick| pick < density), set_a.clone());
            let window = set_a.window().unwrap_or(grid.window());
            let (mut back, mut twice) = (vec![0.0; a.len()], vec![1.0; a.len()]);
            let values: Vec<f64> = (0..a.len()).map(|k| 1.0 + k as f64).collect();
            for row in set_a.rows() {
                let mut line = vec![0.0; window.width];
                row.spread(&values, &mut line, window.x);
                prop_assert_eq!(line.iter().filter(|&&v| v > 0.0).count(), row.columns.len());
                row.collect(&line, &mut back, window.x);
                row.add(&line, &mut twice, window.x);
                row.fill(0.0, &mut line, window.x);
                prop_assert!(line.iter().all(|&v| v == 0.0));
            }
            prop_assert_eq!(&back, &values);
            let one_more: Vec<f64> = values.iter().map(|v| v + 1.0).collect();
            prop_assert_eq!(twice, one_more);
        }
    }
}
