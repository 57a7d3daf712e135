//! Discrete Fourier transforms of real fields on a rectangle, planned once.
//!
//! The field has `columns` x `rows` values, row-major. Of its waves (mx, my), those with `0 <= mx <=
//! columns/2` are stored; the others are their conjugates. Wave (mx, my) has the index `mx rows + my`, where
//! negative my count from the end, so that the waves of one mx are contiguous. The operator of a solver, with
//! its fused products, has a transform of its own.

use crate::parallel::{for_each_until, threads_for};
use crate::plan::Precision;
use realfft::{ComplexToReal, RealToComplex};
use rustfft::Fft;
pub use rustfft::num_complex::Complex64;
use std::fmt;
use std::sync::Arc;

/// Rows that are gathered from the columns at a time: 16 complex numbers are four cache lines.
const ROWS: usize = 16;

/// From values to waves.
#[derive(Clone)]
pub struct ForwardTransform {
    columns: usize,
    rows: usize,
    along_x: Arc<dyn RealToComplex<f64>>,
    along_y: Arc<dyn Fft<f64>>,
}

/// From waves to values.
#[derive(Clone)]
pub struct InverseTransform {
    columns: usize,
    rows: usize,
    along_x: Arc<dyn ComplexToReal<f64>>,
    along_y: Arc<dyn Fft<f64>>,
}

impl fmt::Debug for ForwardTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { columns, rows, .. } = self;
        f.debug_struct("ForwardTransform")
            .field("columns", columns)
            .field("rows", rows)
            .finish_non_exhaustive()
    }
}

impl fmt::Debug for InverseTransform {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { columns, rows, .. } = self;
        f.debug_struct("InverseTransform")
            .field("columns", columns)
            .field("rows", rows)
            .finish_non_exhaustive()
    }
}

impl ForwardTransform {
    /// Plans transforms of `columns` x `rows` values, at least one of each.
    pub fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, along_x: f64::real_forward(columns), along_y: f64::forward(rows) }
    }

    /// The transform `H = sum h exp(-2 pi i (mx ix / columns + my iy / rows))`, without a factor; `fill(iy,
    /// row)` writes the values h of row iy into `row`, which holds zeros.
    ///
    /// Cost O(N log N) for N values, on one thread; memory 8 bytes for each value.
    ///
    /// ```
    /// use numerics::fourier::ForwardTransform;
    /// // cos(2 pi ix / 4) in each of two rows: |H| = 4 2 / 2 for mx = 1.
    /// let waves = ForwardTransform::new(4, 2).of(|_, row| row.copy_from_slice(&[1.0, 0.0, -1.0, 0.0]));
    /// assert!((waves[2] - 4.0).norm() < 1e-15 && waves[0].norm() < 1e-15);
    /// ```
    pub fn of(&self, mut fill: impl FnMut(usize, &mut [f64])) -> Vec<Complex64> {
        let Self { columns, rows, along_x, along_y } = self;
        let mut waves = vec![Complex64::new(0.0, 0.0); (columns / 2 + 1) * rows];
        let (mut input, mut output) = (along_x.make_input_vec(), along_x.make_output_vec());
        let mut scratch = along_x.make_scratch_vec();
        for iy in 0..*rows {
            input.fill(0.0);
            fill(iy, &mut input);
            let done = along_x.process_with_scratch(&mut input, &mut output, &mut scratch);
            debug_assert!(done.is_ok(), "buffers come from the plan");
            for (mx, value) in output.iter().enumerate() {
                waves[mx * rows + iy] = *value;
            }
        }
        along_y.process(&mut waves);
        waves
    }
}

#[derive(Clone)]
struct RowScratch {
    gathered: Vec<Complex64>,
    fft: Vec<Complex64>,
}

impl InverseTransform {
    /// Plans transforms to `columns` x `rows` values, at least one of each.
    pub fn new(columns: usize, rows: usize) -> Self {
        Self { columns, rows, along_x: f64::real_inverse(columns), along_y: f64::inverse(rows) }
    }

    /// The values `h = sum H exp(2 pi i (mx ix / columns + my iy / rows))`, summed over the whole plane of
    /// waves, without a factor.
    ///
    /// `fill(mx, column)` writes the waves H of column mx into `column`, which holds zeros, for mx below
    /// `filled <= columns/2 + 1`; all other waves are 0. Of waves that are their own conjugates the real part
    /// counts. Threads share the work, and the bits are the same for any number of them. Cost O(N log N) for
    /// N values, memory 8 bytes for each beside the values.
    ///
    /// ```
    /// use numerics::fourier::{Complex64, InverseTransform};
    /// // Amplitude 2 |H| of the wave (1, 0) and its conjugate.
    /// let values = InverseTransform::new(4, 1).of(2, |mx, column| column[0] = Complex64::new(0.5 * mx as f64, 0.0));
    /// assert!(values.iter().zip([1.0, 0.0, -1.0, 0.0]).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-15));
    /// ```
    pub fn of(&self, filled: usize, fill: impl Fn(usize, &mut [Complex64]) + Sync) -> Vec<f64> {
        self.of_until(filled, fill, &|| false).unwrap_or_default()
    }

    /// As [`InverseTransform::of`]; `None` where `stops`, which is asked between columns and between rows, says to stop.
    pub fn of_until(
        &self,
        filled: usize,
        fill: impl Fn(usize, &mut [Complex64]) + Sync,
        stops: &dyn Fn() -> bool,
    ) -> Option<Vec<f64>> {
        let zero = Complex64::new(0.0, 0.0);
        let threads = threads_for(self.columns * self.rows);
        let mut scratch = vec![vec![zero; self.along_y.get_inplace_scratch_len()]; threads];
        let mut waves = vec![Vec::new(); filled];
        let all =
            for_each_until(&mut scratch, waves.iter_mut().enumerate(), stops, |scratch, (mx, column)| {
                column.resize(self.rows, zero);
                fill(mx, column);
                self.along_y.process_with_scratch(column, scratch);
            });
        if !all {
            return None;
        }
        let gathered = vec![zero; ROWS * (self.columns / 2 + 1)];
        let mut scratch = vec![RowScratch { gathered, fft: self.along_x.make_scratch_vec() }; threads];
        let mut values = vec![0.0; self.columns * self.rows];
        let all = for_each_until(
            &mut scratch,
            values.chunks_mut(ROWS * self.columns).enumerate(),
            stops,
            |scratch, (block, rows)| self.rows(&waves, block, rows, scratch),
        );
        all.then_some(values)
    }

    /// Transforms block number `block` of rows along x.
    fn rows(&self, waves: &[Vec<Complex64>], block: usize, rows: &mut [f64], scratch: &mut RowScratch) {
        let (first, width) = (block * ROWS, self.columns / 2 + 1);
        scratch.gathered.fill(Complex64::new(0.0, 0.0));
        for (mx, column) in waves.iter().enumerate() {
            let part = &column[first..first + rows.len() / self.columns];
            for (iy, &value) in part.iter().enumerate() {
                scratch.gathered[iy * width + mx] = value;
            }
        }
        for (spectrum, row) in
            scratch.gathered.chunks_exact_mut(width).zip(rows.chunks_exact_mut(self.columns))
        {
            // Real but for rounding: the waves (0, my) and (0, -my) are conjugate, and those of columns/2.
            spectrum[0].im = 0.0;
            if self.columns.is_multiple_of(2) {
                spectrum[self.columns / 2].im = 0.0;
            }
            let done = self.along_x.process_with_scratch(spectrum, row, &mut scratch.fft);
            debug_assert!(done.is_ok(), "buffers come from the plan, the ends are real");
        }
    }
}

/// The smallest multiple of `step` of at least `least` and `step` whose only prime factors are 2, 3 and 5,
/// for a step that has no others: transforms of such lengths are fast.
///
/// ```
/// use numerics::fourier::fast_length;
/// assert_eq!([1, 7, 11, 257].map(|least| fast_length(least, 1)), [1, 8, 12, 270]);
/// assert_eq!([1, 7, 15].map(|least| fast_length(least, 2)), [2, 8, 16]);
/// ```
pub fn fast_length(least: usize, step: usize) -> usize {
    let mut length = least.max(step).next_multiple_of(step);
    while !is_smooth(length) {
        length += step;
    }
    length
}

fn is_smooth(mut length: usize) -> bool {
    for prime in [2, 3, 5] {
        while length.is_multiple_of(prime) {
            length /= prime;
        }
    }
    length == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_lengths_are_products_of_small_primes() {
        assert_eq!([1, 7, 11, 31, 257].map(|n| fast_length(n, 1)), [1, 8, 12, 32, 270]);
        assert_eq!([1, 2, 7, 4096, 4097, 2049].map(|n| fast_length(n, 2)), [2, 2, 8, 4096, 4320, 2160]);
    }

    #[test]
    fn waves_are_those_of_the_sum_and_come_back() {
        for (columns, rows) in [(1, 1), (5, 3), (6, 4), (1, 7), (9, 1), (33, 40)] {
            let values: Vec<f64> = (0..columns * rows).map(|i| (i * i % 17) as f64 - 3.0).collect();
            let row = |iy: usize| &values[iy * columns..(iy + 1) * columns];
            let waves = ForwardTransform::new(columns, rows).of(|iy, to| to.copy_from_slice(row(iy)));
            for (mx, my) in [(0, 0), (columns / 2, rows / 2), (columns / 2, rows - 1)] {
                let term = |i: usize| {
                    let turns = (mx * (i % columns)) as f64 / columns as f64
                        + (my * (i / columns)) as f64 / rows as f64;
                    Complex64::from_polar(values[i], -std::f64::consts::TAU * turns)
                };
                let sum: Complex64 = (0..values.len()).map(term).sum();
                assert!((waves[mx * rows + my] - sum).norm() < 1e-9, "{columns} x {rows}: {mx} {my}");
            }
            let back = InverseTransform::new(columns, rows)
                .of(columns / 2 + 1, |mx, column| column.copy_from_slice(&waves[mx * rows..(mx + 1) * rows]));
            let count = values.len() as f64;
            assert!(
                back.iter().zip(&values).all(|(b, v)| (b / count - v).abs() < 1e-12),
                "{columns} x {rows}"
            );
        }
    }

    #[test]
    fn columns_that_are_not_filled_are_zero() {
        let values = InverseTransform::new(8, 3).of(1, |_, column| column[0] = Complex64::new(2.0, 1.0));
        assert!(values.iter().all(|v| (v - 2.0).abs() < 1e-15));
    }
}
