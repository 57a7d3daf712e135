//! Discrete Fourier transforms of even kernels.

use crate::geometry::Lengths;
use crate::real::Real;
use realfft::RealFftPlanner;
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
    pub fn of_kernel(lengths: Lengths, kernel: impl Fn(usize, usize) -> f64) -> Self {
        Self::of_rows(lengths, |y, row| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = kernel(x, y);
            }
        })
    }

    /// The same of a kernel that `fill` writes row by row: at the lags `(0 ..= lx / 2, y)`.
    pub fn of_rows(lengths: Lengths, fill: impl FnMut(usize, &mut [f64])) -> Self {
        let (half_x, half_y) = (lengths.x / 2 + 1, lengths.y / 2 + 1);
        let mut planner = RealFftPlanner::<f64>::new();
        // table[y][x] -> transform along x -> transpose -> transform along y.
        let mut by_column = vec![0.0; half_x * half_y];
        even_rows(&mut planner, lengths.x, half_y, fill, |y, row| {
            for (kx, &value) in row.iter().enumerate() {
                by_column[kx * half_y + y] = value;
            }
        });
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

    /// The values over the number of points (neither transform is normalised), in the precision of a convolution.
    pub fn scaled<T: Real>(&self) -> Arc<Vec<T>> {
        let norm = 1.0 / self.lengths.points() as f64;
        Arc::new(self.values.iter().map(|&v| T::of(v * norm)).collect())
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
