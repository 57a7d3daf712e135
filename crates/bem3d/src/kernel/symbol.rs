//! Discrete Fourier transforms of kernels that are even or odd in each direction.

use crate::geometry::Lengths;
use crate::real::Real;
use crate::tasks::for_each;
use crate::tuning::CACHE_LINE;
use contact_model::{Interrupted, Stop, never};
use numerics::parallel::threads_for;
use numerics::plan::Precision as _;
use realfft::RealToComplex;
use rustfft::num_complex::Complex;
use std::sync::Arc;

/// The parity of a kernel: its change when a lag changes its sign.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Parity {
    /// Even: its transform is the sum of `f cos`.
    Even,
    /// Odd: its transform is `-i` times the sum of `f sin`. Values of an odd kernel at lag 0 and at half the
    /// length are ignored.
    Odd,
}

/// Real symbol of an even kernel on the half spectrum quarter, `symbol[kx * (ly / 2 + 1) + ky]`.
///
/// In a direction in which the kernel is odd these are sums of `f sin`, without the factor `-i`, and change
/// their sign with that of the wave.
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
    /// Cost: one evaluation of the kernel for each lag and two passes of real FFTs.
    pub fn of_kernel(lengths: Lengths, kernel: impl Fn(usize, usize) -> f64 + Sync) -> Self {
        Self::to_its_end(lengths, Self::of_kernel_until(lengths, kernel, &never))
    }

    /// The same until a stop.
    ///
    /// # Errors
    /// As [`Self::with_parity_until`].
    pub fn of_kernel_until(
        lengths: Lengths,
        kernel: impl Fn(usize, usize) -> f64 + Sync,
        stop: Stop<'_>,
    ) -> Result<Self, Interrupted> {
        let fill = |y: usize, row: &mut [f64]| {
            for (x, value) in row.iter_mut().enumerate() {
                *value = kernel(x, y);
            }
        };
        Self::with_parity_until(lengths, [Parity::Even; 2], fill, stop)
    }

    /// A symbol that no stop left unfinished.
    fn to_its_end(lengths: Lengths, made: Result<Self, Interrupted>) -> Self {
        made.unwrap_or(Self { lengths, values: Vec::new() })
    }

    /// The same of a kernel with these parities along x and y, which `fill` writes row by row: at the lags
    /// `(0 ..= lx / 2, y)`.
    pub fn with_parity(
        lengths: Lengths,
        parities: [Parity; 2],
        fill: impl Fn(usize, &mut [f64]) + Sync,
    ) -> Self {
        Self::to_its_end(lengths, Self::with_parity_until(lengths, parities, fill, &never))
    }

    /// The same until a stop.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between rows and between some columns.
    pub fn with_parity_until(
        lengths: Lengths,
        [along_x, along_y]: [Parity; 2],
        fill: impl Fn(usize, &mut [f64]) + Sync,
        stop: Stop<'_>,
    ) -> Result<Self, Interrupted> {
        let (half_x, half_y) = (lengths.x / 2 + 1, lengths.y / 2 + 1);
        // Transform along x, then along y: some columns at a time are gathered from the rows.
        let mut rows = vec![0.0; half_x * half_y];
        let mut values = vec![0.0; half_x * half_y];
        let threads = threads_for(rows.len());
        let buffers = |length, parity| -> Vec<HalfTransform> {
            let plan = f64::real_forward(length);
            (0..threads).map(|_| HalfTransform::new(&plan, parity)).collect()
        };
        for_each(
            &mut buffers(lengths.x, along_x),
            rows.chunks_exact_mut(half_x).enumerate(),
            stop,
            |transform, (y, row)| {
                fill(y, row);
                transform.apply(row);
            },
        )?;
        let blocks = values.chunks_mut(GATHERED * half_y).enumerate();
        for_each(&mut buffers(lengths.y, along_y), blocks, stop, |transform, (block, columns)| {
            for (y, row) in rows.chunks_exact(half_x).enumerate() {
                for (column, &value) in columns.chunks_exact_mut(half_y).zip(&row[block * GATHERED..]) {
                    column[y] = value;
                }
            }
            columns.chunks_exact_mut(half_y).for_each(|column| transform.apply(column));
        })?;
        Ok(Self { lengths, values })
    }

    /// The values over the number of points (neither transform is normalised), in the precision of a
    /// convolution.
    pub fn scaled<T: Real>(&self) -> Arc<Vec<[T; 1]>> {
        let norm = 1.0 / self.lengths.points() as f64;
        Arc::new(self.values.iter().map(|&v| [T::of(v * norm)]).collect())
    }
}

/// Number of columns that are gathered from the rows at a time: a cache line of each row.
const GATHERED: usize = CACHE_LINE / size_of::<f64>();

/// Transforms even or odd sequences.
struct HalfTransform {
    parity: Parity,
    plan: Arc<dyn RealToComplex<f64>>,
    input: Vec<f64>,
    output: Vec<Complex<f64>>,
    scratch: Vec<Complex<f64>>,
}

impl HalfTransform {
    fn new(plan: &Arc<dyn RealToComplex<f64>>, parity: Parity) -> Self {
        let plan = Arc::clone(plan);
        let (input, output, scratch) =
            (plan.make_input_vec(), plan.make_output_vec(), plan.make_scratch_vec());
        Self { parity, plan, input, output, scratch }
    }

    /// Transforms a sequence given by its first half, `length / 2 + 1` values, to that half of its transform.
    fn apply(&mut self, half: &mut [f64]) {
        let Self { parity, plan, input, output, scratch } = self;
        let length = input.len();
        input[..half.len()].copy_from_slice(half);
        let mirrored = 1..=(length - half.len());
        match parity {
            Parity::Even => mirrored.for_each(|x| input[length - x] = half[x]),
            Parity::Odd => {
                mirrored.for_each(|x| input[length - x] = -half[x]);
                input[0] = 0.0;
                if length.is_multiple_of(2) {
                    input[length / 2] = 0.0;
                }
            }
        }
        // Lengths come from the plan itself, so this cannot fail.
        let done = plan.process_with_scratch(input, output, scratch);
        debug_assert!(done.is_ok());
        for (value, spectrum) in half.iter_mut().zip(output) {
            *value = match parity {
                Parity::Even => spectrum.re,
                Parity::Odd => -spectrum.im,
            };
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

    #[test]
    fn symbols_of_odd_kernels_are_sine_sums() {
        for (lx, ly) in [(6, 4), (5, 4), (7, 9), (1, 3), (8, 1)] {
            let lengths = Lengths { x: lx, y: ly };
            let kernel = |x: usize, y: usize| 1.0 / (1.0 + x as f64 + 2.0 * y as f64);
            let angle = |k: usize, x: usize, l: usize| std::f64::consts::TAU * (k * x) as f64 / l as f64;
            for parities in [[Parity::Odd, Parity::Odd], [Parity::Odd, Parity::Even]] {
                let symbol = Symbol::with_parity(lengths, parities, |y, row| {
                    row.iter_mut().enumerate().for_each(|(x, value)| *value = kernel(x, y));
                });
                // The kernel at a circular lag, and the wave that its parity leaves.
                let sign = |parity, x: usize, l: usize| match (parity, (2 * x).cmp(&l)) {
                    (Parity::Even, _) | (_, std::cmp::Ordering::Less) => {
                        f64::from(u8::from(x > 0 || parity == Parity::Even))
                    }
                    (_, std::cmp::Ordering::Equal) => 0.0,
                    _ => -1.0,
                };
                let wave =
                    |parity, angle: f64| if parity == Parity::Even { angle.cos() } else { angle.sin() };
                for (kx, ky) in (0..=lx / 2).flat_map(|kx| (0..=ly / 2).map(move |ky| (kx, ky))) {
                    let term = move |x: usize, y: usize| {
                        kernel(x.min(lx - x), y.min(ly - y))
                            * sign(parities[0], x, lx)
                            * sign(parities[1], y, ly)
                            * wave(parities[0], angle(kx, x, lx))
                            * wave(parities[1], angle(ky, y, ly))
                    };
                    let sum: f64 = (0..lx).flat_map(|x| (0..ly).map(move |y| term(x, y))).sum();
                    approx::assert_relative_eq!(symbol.values[kx * (ly / 2 + 1) + ky], sum, epsilon = 1e-13);
                }
            }
        }
    }
}
