//! Convolution with an even kernel on a window of the grid, by real FFTs of its rows and complex ones of its columns.

use crate::cells::{CellSet, Window};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftNum, FftPlanner};
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Rows that are laid down together: 32 complex numbers in single precision are four cache lines, next to each other in each column.
const TILE: usize = 32;
/// Bytes of a cache line.
const LINE: usize = 64;
/// Columns at a distance of a multiple of so many numbers would fall into the same few lines of the cache.
const ALIASED: usize = 64;

/// Length of a wrapped transform, as a multiple of the window.
const WRAPPED: f64 = 1.5;

/// Floating point of a convolution: f64, or f32 inside an iteration that is certified in f64.
pub trait Real: FftNum + Default {
    /// Name in reports.
    const NAME: &'static str;
    /// Rounds to this precision.
    fn of(value: f64) -> Self;
    /// Widens to f64.
    fn to_f64(self) -> f64;
    /// A power of two that brings values of this magnitude into the middle of the range; 1 where f64 needs none.
    fn unit(largest: f64) -> f64;
}

impl Real for f64 {
    const NAME: &'static str = "f64";
    fn of(value: f64) -> Self {
        value
    }
    fn to_f64(self) -> f64 {
        self
    }
    fn unit(_largest: f64) -> f64 {
        1.0
    }
}

impl Real for f32 {
    const NAME: &'static str = "f32";
    fn of(value: f64) -> Self {
        value as Self
    }
    fn to_f64(self) -> f64 {
        f64::from(self)
    }
    fn unit(largest: f64) -> f64 {
        if largest > 0.0 { largest.log2().floor().clamp(-1000.0, 1000.0).exp2() } else { 1.0 }
    }
}

/// Circular lengths of the transform of a window (columns, rows).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lengths {
    /// Circular length along x, even.
    pub x: usize,
    /// Circular length along y, even.
    pub y: usize,
}

impl Lengths {
    /// Shortest good lengths that leave a kernel of full reach free of wrap-around.
    ///
    /// For an even kernel `2 (n - 1)` is enough: the only lag that meets its mirror image is `n - 1`, and it is equal to it.
    pub fn free(window: Window) -> Self {
        let exact = |n: usize| good_length((2 * n.saturating_sub(1)).max(2));
        Self { x: exact(window.width), y: exact(window.height) }
    }

    /// Good lengths for most lags: those up to [`WRAPPED`] half times the window are exact, farther ones take the shorter way round.
    ///
    /// Positive definite: the kernel's symbol falls as 1 / q, what the kink half way round adds as 1 / q^2, less from the first wave on.
    pub fn wrapped(self, window: Window) -> Self {
        let wrap = |n: usize, exact: usize| good_length((WRAPPED * n as f64) as usize - 1).min(exact);
        Self { x: wrap(window.width, self.x), y: wrap(window.height, self.y) }
    }

    /// Shortest good lengths of a torus that holds the window once.
    pub fn torus(window: Window) -> Self {
        Self { x: good_length(window.width.max(2)), y: good_length(window.height.max(2)) }
    }

    /// Number of points of the transform.
    pub fn points(self) -> usize {
        self.x * self.y
    }
}

/// Smallest even number `>= n` with no prime factor above 5.
pub fn good_length(n: usize) -> usize {
    let mut m = n.max(2).next_multiple_of(2);
    while !is_smooth(m) {
        m += 2;
    }
    m
}

fn is_smooth(mut m: usize) -> bool {
    for p in [2, 3, 5] {
        while m.is_multiple_of(p) {
            m /= p;
        }
    }
    m == 1
}

/// Real symbol of an even kernel on the half spectrum quarter, `symbol[kx * (ly / 2 + 1) + ky]`.
#[derive(Debug, Clone)]
pub struct Symbol {
    /// Circular lengths.
    pub lengths: Lengths,
    /// Values, `(lx / 2 + 1) * (ly / 2 + 1)` of them.
    pub values: Vec<f64>,
}

impl Symbol {
    /// Discrete Fourier transform of the even kernel `kernel(x, y)`, lags 0 ..= l/2 in each direction.
    ///
    /// Cost: one evaluation of the kernel a lag and two passes of real FFTs.
    pub fn of_kernel(lengths: Lengths, kernel: impl Fn(usize, usize) -> f64) -> Self {
        let (half_x, half_y) = (lengths.x / 2 + 1, lengths.y / 2 + 1);
        let mut planner = RealFftPlanner::<f64>::new();
        // table[y][x] -> transform along x -> transpose -> transform along y.
        let mut by_column = vec![0.0; half_x * half_y];
        even_rows(
            &mut planner,
            lengths.x,
            half_y,
            |y, row| {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = kernel(x, y);
                }
            },
            |y, row| {
                for (kx, &value) in row.iter().enumerate() {
                    by_column[kx * half_y + y] = value;
                }
            },
        );
        let mut values = vec![0.0; half_x * half_y];
        even_rows(
            &mut planner,
            lengths.y,
            half_x,
            |kx, row| {
                row.copy_from_slice(&by_column[kx * half_y..(kx + 1) * half_y]);
            },
            |kx, row| values[kx * half_y..(kx + 1) * half_y].copy_from_slice(row),
        );
        Self { lengths, values }
    }
}

/// Transforms `count` even sequences of circular length `length`, given and returned by their first `length / 2 + 1` values.
fn even_rows(
    planner: &mut RealFftPlanner<f64>,
    length: usize,
    count: usize,
    mut fill: impl FnMut(usize, &mut [f64]),
    mut take: impl FnMut(usize, &[f64]),
) {
    let plan = planner.plan_fft_forward(length);
    let (mut input, mut output, mut scratch) =
        (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
    let half = length / 2 + 1;
    let mut row = vec![0.0; half];
    for i in 0..count {
        fill(i, &mut row);
        input[..half].copy_from_slice(&row);
        for x in 1..=(length - half) {
            input[length - x] = row[x];
        }
        // Lengths come from the plan itself, so this cannot fail.
        let done = plan.process_with_scratch(&mut input, &mut output, &mut scratch);
        debug_assert!(done.is_ok());
        for (value, spectrum) in row.iter_mut().zip(&output) {
            *value = spectrum.re;
        }
        take(i, &row);
    }
}

/// A planned convolution on a window: `u = kernel * p` from rows of the window to rows of the window.
///
/// Rows are transformed one by one; their spectra are laid down column by column, [`TILE`] rows at a time, so that whole cache lines
/// move and the column transforms run through memory in order. Most of the time of a plain implementation goes into that move.
pub struct Convolution<T: Real> {
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

impl<T: Real> fmt::Debug for Convolution<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Convolution<{}>({:?}, {:?})", T::NAME, self.window, self.lengths)
    }
}

impl<T: Real> Convolution<T> {
    /// Plans for a window with a symbol of [`Convolution::scaled`].
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
        let start = Some(spectrum.as_ptr().align_offset(LINE)).filter(|&s| s <= TILE).unwrap_or(0);
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

    /// A symbol in the form and precision that [`Convolution::new`] takes.
    pub fn scaled(symbol: &Symbol) -> Arc<Vec<T>> {
        let norm = 1.0 / symbol.lengths.points() as f64;
        Arc::new(symbol.values.iter().map(|&v| T::of(v * norm)).collect())
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.window
    }

    /// The circular lengths.
    pub fn lengths(&self) -> Lengths {
        self.lengths
    }

    /// `out = kernel * p`: `p` lives on `sources`, `out` on `targets`, both inside the window.
    ///
    /// Rows without sources are not transformed forward, rows without targets not backward.
    /// Cost: O(lx ly log) at most.
    pub fn apply(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet, out: &mut [f64]) {
        let unit = T::unit(p.iter().fold(0.0, |m: f64, p| m.max(p.abs())));
        let scale = unit.recip();
        let Window { x: x0, y: y0, height, .. } = self.window;
        let (from, to) = (Rows::new(sources, y0, height), Rows::new(targets, y0, height));
        self.rows(
            |y| from.holds(y),
            |y, row| {
                let start = (y + y0) * sources.side() + x0;
                for k in from.span(y) {
                    row[sources.index()[k] as usize - start] = T::of(p[k] * scale);
                }
            },
            |y| to.holds(y),
            |y, row| {
                let start = (y + y0) * targets.side() + x0;
                for k in to.span(y) {
                    out[k] = row[targets.index()[k] as usize - start].to_f64() * unit;
                }
            },
        );
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
            lay_down(&self.lines, half, &mut self.spectrum[self.start + tile * TILE..], self.pitch);
        }
        self.columns(&sources, &targets);
        for tile in targets.iter().flat_map(Range::clone) {
            take_up(&self.spectrum[self.start + tile * TILE..], self.pitch, &mut self.lines, half);
            for (j, line) in self.lines.chunks_exact_mut(half).enumerate() {
                let y = tile * TILE + j;
                if y >= self.window.height || !wanted(y) {
                    continue;
                }
                // The spectrum of a real row has real ends; rounding may say otherwise and the plan would complain.
                line[0].im = T::default();
                line[half - 1].im = T::default();
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

/// The rows of a set by their number in a window.
struct Rows<'a> {
    set: &'a CellSet,
    /// Position in the set's list of rows, `u32::MAX` where the row is empty.
    at: Vec<u32>,
}

impl<'a> Rows<'a> {
    fn new(set: &'a CellSet, first: usize, height: usize) -> Self {
        let mut at = vec![u32::MAX; height];
        for (k, row) in set.rows().iter().enumerate() {
            at[row.y - first] = k as u32;
        }
        Self { set, at }
    }

    fn holds(&self, y: usize) -> bool {
        self.at[y] != u32::MAX
    }

    /// Positions of the cells of row y in the list of the set.
    fn span(&self, y: usize) -> Range<usize> {
        self.set.rows().get(self.at[y] as usize).map_or(0..0, |row| row.span.clone())
    }
}

/// Writes a tile of rows as columns: `columns[k * pitch + j] = lines[j * half + k]`.
fn lay_down<T: Real>(lines: &[Complex<T>], half: usize, columns: &mut [Complex<T>], pitch: usize) {
    let mut row = lines.chunks_exact(half);
    let rows: [&[Complex<T>]; TILE] = std::array::from_fn(|_| row.next().unwrap_or_default());
    for (k, column) in columns.chunks_mut(pitch).take(half).enumerate() {
        for (value, row) in column[..TILE].iter_mut().zip(&rows) {
            *value = row[k];
        }
    }
}

/// Reads a tile of rows back from columns: the inverse of [`lay_down`].
fn take_up<T: Real>(columns: &[Complex<T>], pitch: usize, lines: &mut [Complex<T>], half: usize) {
    for (k, column) in columns.chunks(pitch).take(half).enumerate() {
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

    #[test]
    fn good_lengths_are_even_and_smooth() {
        assert_eq!([1, 2, 7, 4096, 4097, 2049].map(good_length), [2, 2, 8, 4096, 4320, 2160]);
    }

    #[test]
    fn a_window_of_2049_fits_4096() {
        let window = Window { x: 0, y: 0, width: 2049, height: 1 };
        assert_eq!(Lengths::free(window), Lengths { x: 4096, y: 2 });
    }

    #[test]
    fn single_precision_serves_pressures_of_any_size() {
        // Powers of two out of the range of f32 change no bit.
        let side = 6;
        let cells = CellSet::new(side, (0..36).collect());
        let window = Window { x: 0, y: 0, width: side, height: side };
        let lengths = Lengths::free(window);
        let symbol = Symbol::of_kernel(lengths, crate::love::influence);
        let mut operator = Convolution::<f32>::new(window, lengths, Convolution::<f32>::scaled(&symbol));
        assert!(format!("{operator:?}").starts_with("Convolution<f32>(Window"));
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
    fn empty_rows_cost_nothing() {
        // Cells in rows 5 and 7 of the grid, the second and the last of a window that begins at row 4.
        let set = CellSet::new(8, vec![41, 42, 63]);
        let rows = Rows::new(&set, 4, 4);
        assert_eq!([0, 1, 2, 3].map(|y| rows.holds(y)), [false, true, false, true]);
        assert_eq!([0, 1, 2, 3].map(|y| rows.span(y)), [0..0, 0..2, 0..0, 2..3]);
        assert_eq!(runs(7, |i| i != 2 && i != 3), [0..2, 4..7]);
    }

    #[test]
    fn symbol_is_the_cosine_sum() {
        let lengths = Lengths { x: 6, y: 4 };
        let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 2.0 * y as f64);
        let symbol = Symbol::of_kernel(lengths, kernel);
        assert_eq!(symbol.values.len(), 4 * 3);
        let angle = |k: usize, x: usize, l: usize| std::f64::consts::TAU * (k * x) as f64 / l as f64;
        for kx in 0..=3 {
            for ky in 0..=2 {
                let mut sum = 0.0;
                for y in 0..4 {
                    for x in 0..6 {
                        let value = kernel(x.min(6 - x), y.min(4 - y));
                        sum += value * angle(kx, x, 6).cos() * angle(ky, y, 4).cos();
                    }
                }
                approx::assert_relative_eq!(symbol.values[kx * 3 + ky], sum, epsilon = 1e-13);
            }
        }
    }
}
