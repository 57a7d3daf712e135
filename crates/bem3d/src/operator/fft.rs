//! Convolution with an even kernel on a window of the grid, by real FFTs of its rows and complex ones of its
//! columns.

use super::influence::InfluenceOperator;
use crate::geometry::{CellSet, Lengths, Window};
use crate::real::{Real, binary_unit, update};
use crate::tuning::{BAND, CACHE_LINE, SQUARE, STRIPE_BYTES};
use numerics::parallel::{for_each, threads_for};
use realfft::{ComplexToReal, RealToComplex};
use rustfft::Fft;
use rustfft::num_complex::Complex;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// A planned convolution on a window: `u = kernel * p` from rows of the window to rows of the window.
///
/// The spectra of rows are kept in stripes of a few columns each, stripe by stripe: a row writes whole cache
/// lines, the columns of a stripe are transformed where it lies in the cache, and threads share rows and
/// stripes among them.
pub struct FftConvolution<T: Real> {
    window: Window,
    lengths: Lengths,
    /// Symbol divided by the number of points (neither transform is normalised).
    symbol: Arc<Vec<T>>,
    row_forward: Arc<dyn RealToComplex<T>>,
    row_inverse: Arc<dyn ComplexToReal<T>>,
    column_forward: Arc<dyn Fft<T>>,
    column_inverse: Arc<dyn Fft<T>>,
    /// Row spectra: of each stripe all rows, of each row the columns of the stripe; from `start` on (where a
    /// cache line begins).
    spectrum: Vec<Complex<T>>,
    start: usize,
    /// Which bands of rows were given last.
    given: Vec<bool>,
    buffers: Vec<Buffers<T>>,
    rounded: Rounded,
}

/// Buffers of one thread.
struct Buffers<T: Real> {
    row: Vec<T>,
    line: Vec<Complex<T>>,
    /// Columns that share cache lines, one after the other.
    columns: Vec<Complex<T>>,
    scratch: Vec<Complex<T>>,
}

impl<T: Real> fmt::Debug for FftConvolution<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FftConvolution<{}>({:?}, {:?})", T::NAME, self.window, self.lengths)
    }
}

impl<T: Real> FftConvolution<T> {
    /// Columns of a stripe.
    const STRIPE: usize = STRIPE_BYTES / size_of::<Complex<T>>();
    /// Columns of one cache line: they are read and written together.
    const TOGETHER: usize = CACHE_LINE / size_of::<Complex<T>>();

    /// Plans for a window with a symbol of [`crate::kernel::Symbol::scaled`].
    ///
    /// Memory: `height * (lx / 2 + 1)` complex numbers besides the symbol, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths, symbol: Arc<Vec<T>>) -> Self {
        let stripes = (lengths.x / 2 + 1).div_ceil(Self::STRIPE);
        let spectrum = vec![Complex::default(); stripes * Self::STRIPE * window.height + Self::TOGETHER];
        let start = spectrum.as_ptr().align_offset(CACHE_LINE);
        Self {
            window,
            lengths,
            symbol,
            row_forward: T::real_forward(lengths.x),
            row_inverse: T::real_inverse(lengths.x),
            column_forward: T::forward(lengths.y),
            column_inverse: T::inverse(lengths.y),
            spectrum,
            start: if start <= Self::TOGETHER { start } else { 0 },
            given: vec![false; window.height.div_ceil(BAND)],
            buffers: Vec::new(),
            rounded: Rounded::default(),
        }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The bands of rows of the window, which threads share: first row of each.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<T> {
        (0..self.window.height.div_ceil(BAND)).map(|band| band * BAND)
    }

    /// Buffers for as many threads as the transform is worth.
    fn make_buffers(&mut self) {
        let zero = Complex::default();
        let Lengths { x, y } = self.lengths;
        let scratch = [
            self.row_forward.get_scratch_len(),
            self.row_inverse.get_scratch_len(),
            self.column_forward.get_inplace_scratch_len(),
            self.column_inverse.get_inplace_scratch_len(),
        ];
        let scratch = scratch.into_iter().max().unwrap_or(0);
        self.buffers.resize_with(threads_for(self.lengths.points()), || Buffers {
            row: vec![T::default(); x],
            line: vec![zero; x / 2 + 1],
            columns: vec![zero; Self::TOGETHER * Self::pitch(y)],
            scratch: vec![zero; scratch],
        });
    }

    /// Distance of columns that are transformed one after the other: at a multiple of a page they would share
    /// few lines of the cache.
    fn pitch(length: usize) -> usize {
        length + Self::TOGETHER
    }

    /// Transforms the rows of the window: `fill` writes row y (given as zeros) where `given` says so.
    pub fn forward(&mut self, given: impl Fn(usize) -> bool + Sync, fill: impl Fn(usize, &mut [T]) + Sync) {
        self.make_buffers();
        let Self { window: Window { width, height, .. }, row_forward, buffers, .. } = self;
        let (width, height) = (*width, *height);
        for (band, any) in self.given.iter_mut().enumerate() {
            *any = (band * BAND..((band + 1) * BAND).min(height)).any(&given);
        }
        let mut bands: Vec<Vec<&mut [Complex<T>]>> = self.given.iter().map(|_| Vec::new()).collect();
        for stripe in self.spectrum[self.start..].chunks_exact_mut(Self::STRIPE * height) {
            for (band, piece) in bands.iter_mut().zip(stripe.chunks_mut(Self::STRIPE * BAND)) {
                band.push(piece);
            }
        }
        let known = &self.given;
        let bands: Vec<_> = bands.into_iter().enumerate().filter(|(band, _)| known[*band]).collect();
        for_each(buffers, bands.into_iter(), |buffer, (band, mut pieces)| {
            for (j, y) in (band * BAND..((band + 1) * BAND).min(height)).enumerate() {
                let at = j * Self::STRIPE;
                if !given(y) {
                    for piece in &mut pieces {
                        piece[at..at + Self::STRIPE].fill(Complex::default());
                    }
                    continue;
                }
                buffer.row.fill(T::default());
                fill(y, &mut buffer.row[..width]);
                let Buffers { row, line, scratch, .. } = buffer;
                let done = row_forward.process_with_scratch(row, line, scratch);
                debug_assert!(done.is_ok());
                for (piece, values) in pieces.iter_mut().zip(line.chunks(Self::STRIPE)) {
                    piece[at..at + values.len()].copy_from_slice(values);
                }
            }
        });
    }

    /// Multiplies the spectrum by the symbol: a transform of each column forward and back. Only the bands of
    /// rows `wanted` are right afterwards.
    ///
    /// Cost: O(lx ly log) with [`Self::forward`] and [`Self::backward`]; rows of zeros are not transformed.
    pub fn multiply(&mut self, wanted: impl Fn(usize) -> bool) {
        let Self { window: Window { height, .. }, lengths, column_forward, column_inverse, buffers, .. } =
            self;
        let (height, half_y) = (*height, lengths.y / 2 + 1);
        let rows = |bands: Vec<Range<usize>>| -> Vec<Range<usize>> {
            bands.into_iter().map(|bands| bands.start * BAND..(bands.end * BAND).min(height)).collect()
        };
        let bands = self.given.len();
        let sources = rows(runs(bands, |band| self.given[band]));
        let targets = rows(runs(bands, |band| (band * BAND..((band + 1) * BAND).min(height)).any(&wanted)));
        let pitch = Self::pitch(lengths.y);
        let stripes = self.spectrum[self.start..].chunks_exact_mut(Self::STRIPE * height);
        let symbols = self.symbol.chunks(half_y * Self::STRIPE);
        for_each(buffers, stripes.zip(symbols), |buffer, (stripe, symbols)| {
            let Buffers { columns, scratch, .. } = buffer;
            for (k, symbols) in symbols.chunks(half_y * Self::TOGETHER).enumerate() {
                let first = k * Self::TOGETHER;
                let mut end = 0;
                for rows in &sources {
                    clear(columns, pitch, end..rows.start);
                    to_columns::<T>(stripe, Self::STRIPE, first, rows.clone(), columns, pitch);
                    end = rows.end;
                }
                clear(columns, pitch, end..lengths.y);
                for (column, symbol) in columns.chunks_exact_mut(pitch).zip(symbols.chunks_exact(half_y)) {
                    let column = &mut column[..lengths.y];
                    column_forward.process_with_scratch(column, scratch);
                    multiply_even(column, symbol);
                    column_inverse.process_with_scratch(column, scratch);
                }
                for rows in &targets {
                    to_rows::<T>(columns, pitch, stripe, Self::STRIPE, first, rows.clone());
                }
            }
        });
    }

    /// Transforms rows back: `take` reads row y where it is `wanted`, and may write over it. Each band of rows
    /// has its own output, of those given in order.
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, &mut [T]) + Sync,
    ) {
        let Self { window: Window { width, height, .. }, lengths, row_inverse, buffers, .. } = self;
        let (width, height, half) = (*width, *height, lengths.x / 2 + 1);
        let even = lengths.x.is_multiple_of(2);
        let spectrum = &self.spectrum[self.start..];
        for_each(buffers, outputs.enumerate(), |buffer, (band, mut output)| {
            let Buffers { row, line, scratch, .. } = buffer;
            for y in (band * BAND..((band + 1) * BAND).min(height)).filter(|&y| wanted(y)) {
                let stripes = spectrum.chunks_exact(Self::STRIPE * height);
                for (values, stripe) in line.chunks_mut(Self::STRIPE).zip(stripes) {
                    values.copy_from_slice(&stripe[y * Self::STRIPE..][..values.len()]);
                }
                // The spectrum of a real row has real ends; rounding may say otherwise and the plan would
                // complain.
                line[0].im = T::default();
                if even {
                    line[half - 1].im = T::default();
                }
                let done = row_inverse.process_with_scratch(line, row, scratch);
                debug_assert!(done.is_ok());
                take(&mut output, y, &mut row[..width]);
            }
        });
    }
}

/// Clears the same rows of each column.
fn clear<T: Real>(columns: &mut [Complex<T>], pitch: usize, rows: Range<usize>) {
    for column in columns.chunks_exact_mut(pitch) {
        column[rows.clone()].fill(Complex::default());
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
    /// Both sets lie inside the window. Rows without sources are not transformed forward, rows without
    /// targets not backward.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        let Window { x: x0, y: y0, .. } = self.window;
        let held = |y: usize| targets.row(y + y0).is_some();
        self.forward(
            |y| sources.row(y + y0).is_some(),
            |y, line| {
                if let Some(row) = sources.row(y + y0) {
                    row.spread(p, line, x0);
                }
            },
        );
        self.multiply(held);
        let outputs = targets.split(u, self.bands().map(|y| y + y0));
        self.backward(held, outputs.into_iter(), |(start, u), y, line| {
            if let Some(row) = targets.row(y + y0) {
                row.after(*start).collect(line, u, x0);
            }
        });
    }
}

/// Double-precision vectors through a single-precision transform.
impl InfluenceOperator<f64> for FftConvolution<f32> {
    fn apply(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, u: &mut [f64]) {
        let mut rounded = std::mem::take(&mut self.rounded);
        rounded.apply(p, u, |p, u| self.apply(sources, p, targets, u));
        self.rounded = rounded;
    }
}

/// Double-precision vectors in single precision, over a unit of their own.
#[derive(Debug, Default)]
pub struct Rounded {
    p: Vec<f32>,
    u: Vec<f32>,
}

impl Rounded {
    /// `u` as `apply` finds it from `p` in single precision.
    pub fn apply(&mut self, p: &[f64], u: &mut [f64], apply: impl FnOnce(&[f32], &mut [f32])) {
        let unit = binary_unit(p);
        let scale = unit.recip();
        self.p.resize(p.len(), 0.0);
        self.u.resize(u.len(), 0.0);
        update(&mut self.p, p, |single, p| *single = (p * scale) as f32);
        apply(&self.p, &mut self.u);
        update(u, &self.u, |u, &single| *u = f64::from(single) * unit);
    }
}

/// Reads columns from `first` on out of some rows of a stripe, square by square:
/// `columns[i * pitch + y] = stripe[y * width + first + i]`.
fn to_columns<T: Real>(
    stripe: &[Complex<T>],
    width: usize,
    first: usize,
    rows: Range<usize>,
    columns: &mut [Complex<T>],
    pitch: usize,
) {
    let count = columns.len() / pitch;
    let squares = rows.start..rows.end - rows.len() % SQUARE;
    for y in squares.clone().step_by(SQUARE) {
        let lines: [&[Complex<T>]; SQUARE] =
            std::array::from_fn(|j| &stripe[(y + j) * width + first..][..count]);
        for (i, column) in columns.chunks_exact_mut(pitch).enumerate() {
            column[y..y + SQUARE].copy_from_slice(&lines.map(|line| line[i]));
        }
    }
    for y in squares.end..rows.end {
        let line = &stripe[y * width + first..][..count];
        for (column, &value) in columns.chunks_exact_mut(pitch).zip(line) {
            column[y] = value;
        }
    }
}

/// Writes columns back to some rows of a stripe: the inverse of [`to_columns`].
fn to_rows<T: Real>(
    columns: &[Complex<T>],
    pitch: usize,
    stripe: &mut [Complex<T>],
    width: usize,
    first: usize,
    rows: Range<usize>,
) {
    let count = columns.len() / pitch;
    let squares = rows.start..rows.end - rows.len() % SQUARE;
    for y in squares.clone().step_by(SQUARE) {
        for i in (0..count).step_by(SQUARE) {
            let square: [&[Complex<T>]; SQUARE] =
                std::array::from_fn(|k| &columns[(i + k) * pitch + y..][..SQUARE]);
            for j in 0..SQUARE {
                let line = &mut stripe[(y + j) * width + first + i..][..SQUARE];
                line.copy_from_slice(&square.map(|column| column[j]));
            }
        }
    }
    for y in squares.end..rows.end {
        let line = &mut stripe[y * width + first..][..count];
        for (value, column) in line.iter_mut().zip(columns.chunks_exact(pitch)) {
            *value = column[y];
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
    use std::sync::Mutex;

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
        // More rows than two bands; each is seen once.
        let grid = Grid::square(6, 2 * BAND + 5);
        let lengths = Lengths::free(grid.window());
        let symbol = Symbol::of_kernel(lengths, influence);
        let mut operator = FftConvolution::<f64>::new(grid.window(), lengths, symbol.scaled());
        let (given, wanted) = ([1, BAND + 1, 2 * BAND + 4], [0, 3, 2 * BAND]);
        let (mut read, mut written) = (Vec::new(), Vec::new());
        for _ in 0..2 {
            let seen = Mutex::new(Vec::new());
            operator.forward(
                |y| given.contains(&y),
                |y, row| {
                    assert!(row.len() == 6 && row.iter().all(|&p| p == 0.0));
                    row[2] = 1.0;
                    seen.lock().unwrap().push(y);
                },
            );
            operator.multiply(|y| wanted.contains(&y));
            let mut bands: Vec<Vec<(usize, f64)>> = operator.bands().map(|_| Vec::new()).collect();
            operator.backward(
                |y| wanted.contains(&y),
                bands.iter_mut(),
                |band, y, row| band.push((y, row[4])),
            );
            (read, written) = (seen.into_inner().unwrap(), bands.concat());
        }
        read.sort_unstable();
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
