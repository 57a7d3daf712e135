//! Convolution with an even kernel on a window of the grid, by real FFTs of pruned rows and blocked columns.

use crate::cells::{CellSet, Window};
use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};
use rustfft::num_complex::Complex;
use rustfft::{Fft, FftNum, FftPlanner};
use std::fmt;
use std::sync::Arc;

/// Columns transformed together: whole cache lines for the transposition.
const BLOCK: usize = 16;

/// Gap between the columns of a block: at a stride of a power of two they would all fall into the same few lines of the cache.
const SKEW: usize = 8;

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

/// A planned convolution on a window: `u = kernel * p` from the cells of one set to those of another.
pub struct Convolution<T: Real> {
    window: Window,
    lengths: Lengths,
    /// Symbol divided by the number of points (neither transform is normalised).
    symbol: Arc<Vec<T>>,
    row_forward: Arc<dyn RealToComplex<T>>,
    row_inverse: Arc<dyn ComplexToReal<T>>,
    column_forward: Arc<dyn Fft<T>>,
    column_inverse: Arc<dyn Fft<T>>,
    spectrum: Vec<Complex<T>>,
    columns: Vec<Complex<T>>,
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
        Self {
            window,
            lengths,
            symbol,
            row_forward,
            row_inverse,
            column_forward,
            column_inverse,
            spectrum: vec![zero; window.height * (lengths.x / 2 + 1)],
            columns: vec![zero; BLOCK * (lengths.y + SKEW)],
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
        self.forward_rows(sources, p, unit.recip());
        self.columns(sources, targets);
        self.inverse_rows(targets, out, unit);
    }

    fn forward_rows(&mut self, sources: &CellSet, p: &[f64], scale: f64) {
        let half = self.lengths.x / 2 + 1;
        for row in sources.rows() {
            self.row.fill(T::default());
            let start = row.y * sources.side() + self.window.x;
            for k in row.span.clone() {
                self.row[sources.index()[k] as usize - start] = T::of(p[k] * scale);
            }
            let y = row.y - self.window.y;
            let output = &mut self.spectrum[y * half..(y + 1) * half];
            let done = self.row_forward.process_with_scratch(&mut self.row, output, &mut self.scratch);
            debug_assert!(done.is_ok());
        }
    }

    fn columns(&mut self, sources: &CellSet, targets: &CellSet) {
        let half = self.lengths.x / 2 + 1;
        let (length, half_y) = (self.lengths.y, self.lengths.y / 2 + 1);
        let stride = length + SKEW;
        for first in (0..half).step_by(BLOCK) {
            let width = BLOCK.min(half - first);
            self.columns.fill(Complex::default());
            for row in sources.rows() {
                let y = row.y - self.window.y;
                let line = &self.spectrum[y * half + first..y * half + first + width];
                for (c, &value) in line.iter().enumerate() {
                    self.columns[c * stride + y] = value;
                }
            }
            for c in 0..width {
                let column = &mut self.columns[c * stride..c * stride + length];
                self.column_forward.process_with_scratch(column, &mut self.scratch);
                multiply_even(column, &self.symbol[(first + c) * half_y..(first + c + 1) * half_y]);
                self.column_inverse.process_with_scratch(column, &mut self.scratch);
            }
            for row in targets.rows() {
                let y = row.y - self.window.y;
                let line = &mut self.spectrum[y * half + first..y * half + first + width];
                for (c, value) in line.iter_mut().enumerate() {
                    *value = self.columns[c * stride + y];
                }
            }
        }
    }

    fn inverse_rows(&mut self, targets: &CellSet, out: &mut [f64], unit: f64) {
        let half = self.lengths.x / 2 + 1;
        for row in targets.rows() {
            let y = row.y - self.window.y;
            let input = &mut self.spectrum[y * half..(y + 1) * half];
            // The spectrum of a real row has real ends; rounding may say otherwise and the plan would complain.
            input[0].im = T::default();
            input[half - 1].im = T::default();
            let done = self.row_inverse.process_with_scratch(input, &mut self.row, &mut self.scratch);
            debug_assert!(done.is_ok());
            let start = row.y * targets.side() + self.window.x;
            for k in row.span.clone() {
                out[k] = self.row[targets.index()[k] as usize - start].to_f64() * unit;
            }
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
    fn symbol_is_the_cosine_sum() {
        let lengths = Lengths { x: 6, y: 4 };
        let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 2.0 * y as f64);
        let symbol = Symbol::of_kernel(lengths, kernel);
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
