//! Discrete Fourier transforms of even kernels.

use crate::geometry::Lengths;
use crate::real::Real;
use crate::tuning::CACHE_LINE;
use numerics::parallel::{for_each, threads_for};
use numerics::plan::Precision as _;
use realfft::RealToComplex;
use rustfft::num_complex::Complex;
use std::sync::Arc;

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
    pub fn of_kernel(lengths: Lengths, kernel: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        Self::of_rows(lengths, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = kernel(x, y);
            }
        })
    }

    /// The same of a kernel that `fill` writes row by row: at the lags `(0 ..= lx / 2, y)`.
    pub fn of_rows(lengths: Lengths, fill: impl Fn(usize, &mut [f64]) + Sync) -> Self {
        let (half_x, half_y) = (lengths.x / 2 + 1, lengths.y / 2 + 1);
        // Transform along x, then along y: some columns at a time are gathered from the rows.
        let mut rows = vec![0.0; half_x * half_y];
        let mut values = vec![0.0; half_x * half_y];
        let threads = threads_for(rows.len());
        let buffers = |length| -> Vec<EvenTransform> {
            let plan = f64::real_forward(length);
            (0..threads).map(|_| EvenTransform::new(&plan)).collect()
        };
        for_each(
            &mut buffers(lengths.x),
            rows.chunks_exact_mut(half_x).enumerate(),
            |transform, (y, row)| {
                fill(y, row);
                transform.apply(row);
            },
        );
        let blocks = values.chunks_mut(GATHERED * half_y).enumerate();
        for_each(&mut buffers(lengths.y), blocks, |transform, (block, columns)| {
            for (y, row) in rows.chunks_exact(half_x).enumerate() {
                for (column, &value) in columns.chunks_exact_mut(half_y).zip(&row[block * GATHERED..]) {
                    column[y] = value;
                }
            }
            columns.chunks_exact_mut(half_y).for_each(|column| transform.apply(column));
        });
        Self { lengths, values }
    }

    /// The values over the number of points (neither transform is normalised), in the precision of a
    /// convolution.
    pub fn scaled<T: Real>(&self) -> Arc<Vec<T>> {
        let norm = 1.0 / self.lengths.points() as f64;
        Arc::new(self.values.iter().map(|&v| T::of(v * norm)).collect())
    }
}

/// Columns that are gathered from the rows at a time: a cache line of each.
const GATHERED: usize = CACHE_LINE / size_of::<f64>();

/// Transforms even sequences.
struct EvenTransform {
    plan: Arc<dyn RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl EvenTransform {
    fn new(plan: &Arc<dyn RealToComplex<f64>>) -> Self {
        let plan = Arc::clone(plan);
        let (input, output, scratch) =
            (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
        Self { plan, input, output, scratch }
    }

    /// Transforms a sequence given by its first half, `length / 2 + 1` values, to that half of its transform.
    fn apply(&mut self, half: &mut [f64]) {
        let Self { plan, input, output, scratch } = self;
        let length = input.len();
        input[..half.len()].copy_from_slice(half);
        for x in 1..=(length - half.len()) {
            input[length - x] = half[x];
        }
        // Lengths come from the plan itself, so this cannot fail.
        let done = plan.process_with_scratch(input, output, scratch);
        debug_assert!(done.is_ok());
        for (value, spectrum) in half.iter_mut().zip(output) {
            *value = spectrum.re;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbol_is_the_cosine_sum() {
        for (lx, ly) in [(6, 4), (5, 4), (6, 7), (1, 3), (9, 1)] {
            let lengths = Lengths { x: lx, y: ly };
            let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 2.0 * y as f64);
            let symbol = Symbol::of_kernel(lengths, kernel);
            assert_eq!(symbol.values.len(), (lx / 2 + 1) * (ly / 2 + 1));
            let angle = |k: usize, x: usize, l: usize| std::f64::consts::TAU * (k * x) as f64 / l as f64;
            for kx in 0..=lx / 2 {
                for ky in 0..=ly / 2 {
                    let mut sum = 0.0;
                    for y in 0..ly {
                        for x in 0..lx {
                            let value = kernel(x.min(lx - x), y.min(ly - y));
                            sum += value * angle(kx, x, lx).cos() * angle(ky, y, ly).cos();
                        }
                    }
                    approx::assert_relative_eq!(symbol.values[kx * (ly / 2 + 1) + ky], sum, epsilon = 1e-13);
                }
            }
        }
    }
}
