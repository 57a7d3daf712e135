//! Convolution with an even kernel on a window of the grid, by real FFTs of its rows and complex ones of its columns.

use super::influence::InfluenceOperator;
use crate::geometry::{CellSet, Lengths, Window};
use crate::real::{Real, binary_unit};
use crate::tuning::{ALIASED, CACHE_LINE, SQUARE, TILE};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftPlanner};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A planned convolution on a window: `u = kernel * p` from rows of the window to rows of the window.
///
/// Rows are transformed one by one; their spectra are stored column by column, [`TILE`] rows at a time, so that whole cache lines
/// move and the column transforms run through memory in order. Most of the time of a plain implementation goes into that move.
pub struct FftConvolution<T: Real> {
    window: Window,
    lengths: Lengths,
    /// Symbol divided by the number of points (neither transform is normalised).
    symbol: Arc<Vec<T>>,
    row_forward: Arc<dyn RealToComplex<T>>,
    row_inverse: Arc<dyn ComplexToReal<T>>,
    column_forward: Arc<dyn Fft<T>>,
    column_inverse: Arc<dyn Fft<T>>,
    /// Row spectra, column after column at a distance of `pitch`, from `start` on (where a cache line begins).
    spectrum: Vec<Complex<T>>,
    start: usize,
    pitch: usize,
    /// One tile of row spectra, row after row.
    lines: Vec<Complex<T>>,
    column: Vec<Complex<T>>,
    row: Vec<T>,
    scratch: Vec<Complex<T>>,
}

impl<T: Real> fmt::Debug for FftConvolution<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FftConvolution<{}>({:?}, {:?})", T::NAME, self.window, self.lengths)
    }
}

impl<T: Real> FftConvolution<T> {
    /// Plans for a window with a symbol of [`crate::kernel::Symbol::scaled`].
    ///
    /// Memory: `height * (lx / 2 + 1)` complex numbers besides the symbol.
    pub fn new(window: Window, lengths: Lengths, symbol: Arc<Vec<T>>) -> Self {
        let mut real = RealFftPlanner::<T>::new();
        let mut complex = FftPlanner::<T>::new();
        let (row_forward, row_inverse) = (real.plan_fft_forward(lengths.x), real.plan_fft_inverse(lengths.x));
        let column_forward = complex.plan_fft_forward(lengths.y);
        let column_inverse = complex.plan_fft_inverse(lengths.y);
        let scratch = [
            row_forward.get_scratch_len(),
            row_inverse.get_scratch_len(),
            column_forward.get_inplace_scratch_len(),
            column_inverse.get_inplace_scratch_len(),
        ];
        let scratch = scratch.into_iter().max().unwrap_or(0);
        let zero = Complex::default();
        let half = lengths.x / 2 + 1;
        let mut pitch = window.height.next_multiple_of(TILE);
        if pitch.is_multiple_of(ALIASED) {
            pitch += TILE;
        }
        let spectrum = vec![zero; half * pitch + TILE];
        let start = Some(spectrum.as_ptr().align_offset(CACHE_LINE)).filter(|&s| s <= TILE).unwrap_or(0);
        Self {
            window,
            lengths,
            symbol,
            row_forward,
            row_inverse,
            column_forward,
            column_inverse,
            spectrum,
            start,
            pitch,
            lines: vec![zero; TILE * half],
            column: vec![zero; lengths.y],
            row: vec![T::default(); lengths.x],
            scratch: vec![zero; scratch],
        }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The convolution of whole rows of the window: `fill` writes row y (given as zeros) where `given` says so, `take` reads the result
    /// where it is `wanted`. Both see the rows in increasing order, all of `fill` before the first of `take`.
    ///
    /// Cost: O(lx ly log) at most; rows and columns of zeros are not transformed.
    pub fn rows(
        &mut self,
        given: impl Fn(usize) -> bool,
        mut fill: impl FnMut(usize, &mut [T]),
        wanted: impl Fn(usize) -> bool,
        mut take: impl FnMut(usize, &[T]),
    ) {
        let tiles = self.window.height.div_ceil(TILE);
        let within = |tile: usize| tile * TILE..((tile + 1) * TILE).min(self.window.height);
        let runs = |has: &dyn Fn(usize) -> bool| runs(tiles, |tile| within(tile).any(has));
        let (sources, targets) = (runs(&given), runs(&wanted));
        let half = self.lengths.x / 2 + 1;
        for tile in sources.iter().flat_map(Range::clone) {
            for (j, line) in self.lines.chunks_exact_mut(half).enumerate() {
                let y = tile * TILE + j;
                if y < self.window.height && given(y) {
                    self.row.fill(T::default());
                    fill(y, &mut self.row[..self.window.width]);
                    let done = self.row_forward.process_with_scratch(&mut self.row, line, &mut self.scratch);
                    debug_assert!(done.is_ok());
                } else {
                    line.fill(Complex::default());
                }
            }
            to_columns(&self.lines, half, &mut self.spectrum[self.start + tile * TILE..], self.pitch);
        }
        self.columns(&sources, &targets);
        for tile in targets.iter().flat_map(Range::clone) {
            to_rows(&self.spectrum[self.start + tile * TILE..], self.pitch, &mut self.lines, half);
            for (j, line) in self.lines.chunks_exact_mut(half).enumerate() {
                let y = tile * TILE + j;
                if y >= self.window.height || !wanted(y) {
                    continue;
                }
                // The spectrum of a real row has real ends; rounding may say otherwise and the plan would complain.
                line[0].im = T::default();
                if self.lengths.x.is_multiple_of(2) {
                    line[half - 1].im = T::default();
                }
                let done = self.row_inverse.process_with_scratch(line, &mut self.row, &mut self.scratch);
                debug_assert!(done.is_ok());
                take(y, &self.row[..self.window.width]);
            }
        }
    }

    /// Transforms each column, multiplies it by the symbol and transforms it back.
    fn columns(&mut self, sources: &[Range<usize>], targets: &[Range<usize>]) {
        let (half, half_y) = (self.lengths.x / 2 + 1, self.lengths.y / 2 + 1);
        let height = self.window.height;
        let rows = |tiles: &Range<usize>| tiles.start * TILE..(tiles.end * TILE).min(height);
        for (kx, symbol) in self.symbol.chunks_exact(half_y).take(half).enumerate() {
            let line = &mut self.spectrum[self.start + kx * self.pitch..][..height];
            let mut end = 0;
            for y in sources.iter().map(rows) {
                self.column[end..y.start].fill(Complex::default());
                self.column[y.clone()].copy_from_slice(&line[y.clone()]);
                end = y.end;
            }
            self.column[end..].fill(Complex::default());
            self.column_forward.process_with_scratch(&mut self.column, &mut self.scratch);
            multiply_even(&mut self.column, symbol);
            self.column_inverse.process_with_scratch(&mut self.column, &mut self.scratch);
            for y in targets.iter().map(rows) {
                line[y.clone()].copy_from_slice(&self.column[y]);
            }
        }
    }
}

/// Runs of consecutive numbers below `count` that have a property.
fn runs(count: usize, has: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut runs: Vec<Range<usize>> = Vec::new();
    for i in (0..count).filter(|&i| has(i)) {
        match runs.last_mut() {
            Some(run) if run.end == i => run.end += 1,
            _ => runs.push(i..i + 1),
        }
    }
    runs
}

impl<T: Real> InfluenceOperator<T> for FftConvolution<T> {
    /// Both sets lie inside the window. Rows without sources are not transformed forward, rows without targets not backward.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        let Window { x: x0, y: y0, height, .. } = self.window;
        let held = |set: &CellSet| {
            let mut held = vec![false; height];
            for row in set.rows() {
                held[row.y - y0] = true;
            }
            held
        };
        let (given, wanted) = (held(sources), held(targets));
        let (mut from, mut to) = (sources.rows(), targets.rows());
        self.rows(
            |y| given[y],
            |_, line| {
                if let Some(row) = from.next() {
                    row.spread(p, line, x0);
                }
            },
            |y| wanted[y],
            |_, line| {
                if let Some(row) = to.next() {
                    row.collect(line, u, x0);
                }
            },
        );
    }
}

/// Double-precision vectors through a single-precision transform.
impl InfluenceOperator<f64> for FftConvolution<f32> {
    fn apply(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut [f64]) {
        let unit = binary_unit(p);
        let scale = unit.recip();
        let single: Vec<f32> = p.iter().map(|p| (p * scale) as f32).collect();
        let mut displacement = vec![0.0f32; u.len()];
        self.apply(sources, &single, targets, &mut displacement);
        for (u, &value) in u.iter_mut().zip(&displacement) {
            *u = f64::from(value) * unit;
        }
    }
}

/// Writes a tile of rows as columns: `columns[k * pitch + j] = lines[j * half + k]`.
fn to_columns<T: Real>(lines: &[Complex<T>], half: usize, columns: &mut [Complex<T>], pitch: usize) {
    let mut row = lines.chunks_exact(half);
    let rows: [&[Complex<T>]; TILE] = std::array::from_fn(|_| row.next().unwrap_or_default());
    for (k, column) in columns.chunks_mut(pitch).take(half).enumerate() {
        for (value, row) in column[..TILE].iter_mut().zip(&rows) {
            *value = row[k];
        }
    }
}

/// Reads a tile of rows back from columns, square by square: the inverse of [`to_columns`].
fn to_rows<T: Real>(columns: &[Complex<T>], pitch: usize, lines: &mut [Complex<T>], half: usize) {
    let squares = half - half % SQUARE;
    for k in (0..squares).step_by(SQUARE) {
        for j in (0..TILE).step_by(SQUARE) {
            let square: [&[Complex<T>]; SQUARE] =
                std::array::from_fn(|i| &columns[(k + i) * pitch + j..][..SQUARE]);
            for i in 0..SQUARE {
                let row = &mut lines[(j + i) * half + k..][..SQUARE];
                row.copy_from_slice(&square.map(|column| column[i]));
            }
        }
    }
    for (k, column) in columns.chunks(pitch).enumerate().take(half).skip(squares) {
        for (j, &value) in column[..TILE].iter().enumerate() {
            lines[j * half + k] = value;
        }
    }
}

/// Multiplies a full column by an even real symbol given on its first half.
fn multiply_even<T: Real>(column: &mut [Complex<T>], symbol: &[T]) {
    let length = column.len();
    for (value, &s) in column.iter_mut().zip(symbol) {
        *value = *value * s;
    }
    for (value, &s) in column[symbol.len()..].iter_mut().zip(symbol[1..=(length - symbol.len())].iter().rev())
    {
        *value = *value * s;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::kernel::Symbol;
    use crate::kernel::love::influence;

    #[test]
    fn single_precision_serves_pressures_of_any_size() {
        // Powers of two out of the range of f32 change no bit.
        let grid = Grid::square(6, 6);
        let cells = CellSet::all(grid);
        let lengths = Lengths::free(grid.window());
        let symbol = Symbol::of_kernel(lengths, influence);
        let mut operator = FftConvolution::<f32>::new(grid.window(), lengths, symbol.scaled());
        assert!(format!("{operator:?}").starts_with("FftConvolution<f32>(Window"));
        let mut displacement = |unit: f64| {
            let p: Vec<f64> = (0..36).map(|k| unit * (1.0 + f64::from(k % 5))).collect();
            let mut u = vec![0.0; 36];
            operator.apply(&cells, &p, &cells, &mut u);
            u
        };
        let expected = displacement(1.0);
        assert!(expected.iter().all(|u| u.is_finite() && *u > 0.0));
        for exponent in [-300, -140, 140, 300] {
            let unit = 2f64.powi(exponent);
            let scaled: Vec<f64> = displacement(unit).iter().map(|u| u / unit).collect();
            assert_eq!(scaled, expected, "2^{exponent}");
        }
        assert!(displacement(0.0).iter().all(|&u| u == 0.0));
    }

    #[test]
    fn runs_of_tiles() {
        assert_eq!(runs(7, |i| i != 2 && i != 3), [0..2, 4..7]);
        assert!(runs(3, |_| false).is_empty());
    }

    #[test]
    fn only_rows_with_cells_are_read_and_written() {
        // More rows than two tiles; rows are seen in order, the given ones before the wanted ones.
        let grid = Grid::square(6, 2 * TILE + 5);
        let lengths = Lengths::free(grid.window());
        let symbol = Symbol::of_kernel(lengths, influence);
        let mut operator = FftConvolution::<f64>::new(grid.window(), lengths, symbol.scaled());
        let (given, wanted) = ([1, TILE + 1, 2 * TILE + 4], [0, 3, 2 * TILE]);
        let (mut read, mut written) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            (read, written) = (Vec::new(), Vec::new());
            operator.rows(
                |y| given.contains(&y),
                |y, row| {
                    assert!(row.len() == 6 && row.iter().all(|&p| p == 0.0));
                    row[2] = 1.0;
                    read.push(y);
                },
                |y| wanted.contains(&y),
                |y, row| written.push((y, row[4])),
            );
        }
        assert_eq!(read, given);
        for (&(y, u), wanted) in written.iter().zip(wanted) {
            assert_eq!(y, wanted);
            let expected: f64 = given.iter().map(|given| influence(2, given.abs_diff(y))).sum();
            approx::assert_relative_eq!(u, expected, max_relative = 1e-13);
        }
        assert_eq!(written.len(), wanted.len());
    }

    #[test]
    fn odd_and_prime_lengths_are_circular_convolutions() {
        // One pressed cell at a time against the kernel itself.
        for (columns, rows) in [(1, 1), (1, 5), (7, 1), (3, 13), (5, 4), (17, 9), (34, 33)] {
            let grid = Grid::square(columns, rows);
            let lengths = Lengths { x: columns, y: rows };
            let fold = |lag: usize, n: usize| lag.min(n - lag);
            let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 2.5 * y as f64);
            let symbol = Symbol::of_kernel(lengths, kernel);
            let mut operator = FftConvolution::<f64>::new(grid.window(), lengths, symbol.scaled());
            let (all, mut u) = (CellSet::all(grid), vec![0.0; grid.count()]);
            for (x0, y0) in [(0, 0), (columns / 2, rows - 1)] {
                let mut p = vec![0.0; grid.count()];
                p[y0 * columns + x0] = 1.0;
                operator.apply(&all, &p, &all, &mut u);
                for (k, u) in u.iter().enumerate() {
                    let (x, y) = ((k % columns).abs_diff(x0), (k / columns).abs_diff(y0));
                    let expected = kernel(fold(x, columns), fold(y, rows));
                    approx::assert_relative_eq!(*u, expected, max_relative = 1e-13, epsilon = 1e-14);
                }
            }
        }
    }
}
