//! Convolution with an even kernel on a window of the grid, by FFTs of pairs of its rows and of its
//! columns.

use super::influence::InfluenceOperator;
use super::transform::Transform;
use crate::geometry::{CellSet, Lengths, Window};
use crate::real::{Real, binary_unit, update};
use rustfft::num_complex::Complex;
use std::fmt;
use std::sync::Arc;

/// A planned convolution on a window: `u = kernel * p` from rows of the window to rows of the window.
pub struct FftConvolution<T: Real> {
    transform: Transform<T, 1>,
    /// Symbol divided by the number of points (neither transform is normalised).
    symbol: Arc<Vec<T>>,
    rounded: Rounded,
}

impl<T: Real> fmt::Debug for FftConvolution<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (window, lengths) = (self.transform.window(), self.transform.lengths());
        write!(f, "FftConvolution<{}>({window:?}, {lengths:?})", T::NAME)
    }
}

impl<T: Real> FftConvolution<T> {
    /// Plans for a window with a symbol of [`crate::kernel::Symbol::scaled`].
    ///
    /// Memory: `height * (lx / 2 + 1)` complex numbers besides the symbol, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths, symbol: Arc<Vec<T>>) -> Self {
        Self { transform: Transform::new(window, lengths), symbol, rounded: Rounded::default() }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.transform.window()
    }

    /// The bands of rows of the window, which threads share: first row of each.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<T> {
        self.transform.bands()
    }

    /// Transforms the rows of the window: `fill` writes row y, which is zero before, for all y with `given`.
    pub fn forward(&mut self, given: impl Fn(usize) -> bool + Sync, fill: impl Fn(usize, &mut [T]) + Sync) {
        self.transform.forward(given, fill);
    }

    /// Multiplies the spectrum by the symbol: a transform of each column forward and back. Only the bands of
    /// rows in `wanted` are valid afterwards.
    ///
    /// Cost: O(lx ly log) with [`Self::forward`] and [`Self::backward`]; rows of zeros are not transformed.
    pub fn multiply(&mut self, wanted: impl Fn(usize) -> bool) {
        let (symbol, half) = (&self.symbol, self.transform.lengths().y / 2 + 1);
        self.transform.change(wanted, |kx, [column]| multiply_even(column, &symbol[kx * half..][..half]));
    }

    /// Transforms rows back: `take` reads row y where it is `wanted`, and may write over it. Each band of rows
    /// has its own output, of those given in order.
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, &mut [T]) + Sync,
    ) {
        self.transform.backward(wanted, outputs, take);
    }
}

impl<T: Real> InfluenceOperator<T> for FftConvolution<T> {
    /// Both sets lie inside the window. Rows without sources are not transformed forward, rows without
    /// targets not backward.
    fn apply(&mut self, sources: &CellSet, p: &[T], targets: &CellSet, u: &mut [T]) {
        let Window { x: x0, y: y0, .. } = self.window();
        let held = |y: usize| targets.row(y + y0).is_some();
        self.transform.forward(
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
    /// `u` from `apply`, which gets `p` in single precision.
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
    use crate::tuning::BAND;
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
