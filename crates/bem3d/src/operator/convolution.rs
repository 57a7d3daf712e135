//! Convolution with a kernel on a window of the grid, by FFTs of pairs of its rows and of its columns.

use super::influence::InfluenceOperator;
use super::transform::{Room, Transform};
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::Tensor;
use crate::real::{Real, binary_unit, update};
use contact_model::{Interrupted, Stop};
use numerics::parallel::widest;
use rustfft::num_complex::Complex;
use std::fmt;
use std::sync::Arc;

/// A planned convolution on a window: `u = K t` from rows of the window to rows of the window, of N components
/// with a kernel of E entries.
///
/// Values on a set of n cells are n of the first component, then n of the next one. An application takes N
/// transforms forward and N back. Of the symbol a quarter is kept, because each entry is even or odd in both
/// directions.
pub struct Convolution<T: Real, const N: usize, const E: usize> {
    transform: Transform<T, N>,
    /// Symbol divided by the number of points (neither transform is normalised).
    symbol: Arc<Vec<[T; E]>>,
    rounded: Rounded,
}

/// The convolution of pressures.
pub type FftConvolution<T> = Convolution<T, 1, 1>;
/// The convolution of tangential tractions.
pub type VectorConvolution<T> = Convolution<T, 2, 3>;

impl<T: Real, const N: usize, const E: usize> fmt::Debug for Convolution<T, N, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (window, lengths) = (self.transform.window(), self.transform.lengths());
        write!(f, "Convolution<{}, {N}, {E}>({window:?}, {lengths:?})", T::NAME)
    }
}

impl<T: Real, const N: usize, const E: usize> Convolution<T, N, E>
where
    [T; E]: Tensor<T, N>,
{
    /// Plans for a window with a symbol of [`crate::kernel::KernelTable`] or of
    /// [`crate::kernel::Symbol::scaled`].
    ///
    /// Memory: `N height * (lx / 2 + 1)` complex numbers besides the symbol, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths, symbol: Arc<Vec<[T; E]>>) -> Self {
        Self::within(&Room::default(), window, lengths, symbol)
    }

    /// The same with its spectra in a room that other transforms use too.
    pub fn within(room: &Room<T>, window: Window, lengths: Lengths, symbol: Arc<Vec<[T; E]>>) -> Self {
        Self { transform: Transform::new(window, lengths, room), symbol, rounded: Rounded::default() }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.transform.window()
    }

    /// The bands of rows of one component, which threads share: first row of each in the window.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<T, N, E> {
        let bands = self.transform.bands();
        let count = bands.len() / N;
        bands.take(count)
    }

    /// Transforms the rows of the window: `fill` writes row y of each component, `(component, y, row)`, which is
    /// zero before, for all with `given(component, y)`.
    ///
    /// # Errors
    /// As [`Transform::forward`].
    pub fn forward(
        &mut self,
        given: impl Fn(usize, usize) -> bool + Sync,
        fill: impl Fn(usize, usize, &mut [T]) + Sync,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let (rows, height) = (self.transform.rows(), self.window().height);
        self.transform.forward(
            |at| at % rows < height && given(at / rows, at % rows),
            |at, line| fill(at / rows, at % rows, line),
            stop,
        )
    }

    /// Multiplies the spectra by the symbol: a transform of each column forward and back. Only the bands of
    /// rows in `wanted` are valid afterwards.
    ///
    /// Cost: O(lx ly log) with [`Self::forward`] and [`Self::backward`]; rows of zeros are not transformed.
    ///
    /// # Errors
    /// As [`Transform::change`].
    pub fn multiply(&mut self, wanted: impl Fn(usize) -> bool, stop: Stop<'_>) -> Result<(), Interrupted> {
        let (rows, height) = (self.transform.rows(), self.window().height);
        let (symbol, half) = (&self.symbol, self.transform.lengths().y / 2 + 1);
        self.transform.change(
            |at| at % rows < height && wanted(at % rows),
            |kx, columns| multiply(columns, &symbol[kx * half..][..half]),
            stop,
        )
    }

    /// Transforms rows back: `take` reads row y of each component, `(output, component, y, row)`, where it is
    /// `wanted`, and may write over it. Each band of rows has its own output, those of the first component
    /// before those of the next one.
    ///
    /// # Errors
    /// As [`Transform::backward`].
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, usize, &mut [T]) + Sync,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let (rows, height) = (self.transform.rows(), self.window().height);
        self.transform.backward(
            |at| at % rows < height && wanted(at % rows),
            outputs,
            |output, at, line| take(output, at / rows, at % rows, line),
            stop,
        )
    }

    /// The displacements under the components that are given; the others are zero.
    ///
    /// Both sets lie inside the window. Rows without sources are not transformed forward, rows without targets
    /// not backward.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop, which is asked between bands of rows and stripes of columns.
    pub fn apply_to(
        &mut self,
        sources: &CellSet,
        given: [Option<&[T]>; N],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Window { x: x0, y: y0, .. } = self.window();
        let held = |y: usize| targets.row(y + y0).is_some();
        self.forward(
            |component, y| given[component].is_some() && sources.row(y + y0).is_some(),
            |component, y, line| {
                if let (Some(row), Some(values)) = (sources.row(y + y0), given[component]) {
                    row.spread(values, line, x0);
                }
            },
            stop,
        )?;
        self.multiply(held, stop)?;
        let mut outputs = Vec::with_capacity(N * self.bands().len());
        for u in u.chunks_exact_mut(targets.len().max(1)) {
            outputs.extend(targets.split(u, self.bands().map(|y| y + y0)));
        }
        let take = |(start, u): &mut (usize, &mut [T]), _, y: usize, line: &mut [T]| {
            if let Some(row) = targets.row(y + y0) {
                row.after(*start).collect(line, u, x0);
            }
        };
        self.backward(held, outputs.into_iter(), take, stop)
    }
}

impl<T: Real, const N: usize, const E: usize> InfluenceOperator<T> for Convolution<T, N, E>
where
    [T; E]: Tensor<T, N>,
{
    fn apply_until(
        &mut self,
        sources: &CellSet,
        t: &[T],
        targets: &CellSet,
        u: &mut [T],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let n = sources.len();
        self.apply_to(sources, std::array::from_fn(|i| Some(&t[i * n..][..n])), targets, u, stop)
    }
}

/// Double-precision vectors through a single-precision transform.
impl<const N: usize, const E: usize> InfluenceOperator<f64> for Convolution<f32, N, E>
where
    [f32; E]: Tensor<f32, N>,
{
    fn apply_until(
        &mut self,
        sources: &CellSet,
        p: &[f64],
        targets: &CellSet,
        u: &mut [f64],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let mut rounded = std::mem::take(&mut self.rounded);
        let done = rounded.apply(p, u, |p, u| self.apply_until(sources, p, targets, u, stop));
        self.rounded = rounded;
        done
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
    pub fn apply(
        &mut self,
        p: &[f64],
        u: &mut [f64],
        apply: impl FnOnce(&[f32], &mut [f32]) -> Result<(), Interrupted>,
    ) -> Result<(), Interrupted> {
        let unit = binary_unit(p);
        let scale = unit.recip();
        self.p.resize(p.len(), 0.0);
        self.u.resize(u.len(), 0.0);
        update(&mut self.p, p, |single, p| *single = (p * scale) as f32);
        apply(&self.p, &mut self.u)?;
        update(u, &self.u, |u, &single| *u = f64::from(single) * unit);
        Ok(())
    }
}

/// Multiplies full columns of all components by the symbol given on its first half.
fn multiply<T: Real, S: Tensor<T, N>, const N: usize>(columns: [&mut [Complex<T>]; N], symbol: &[S]) {
    let mut halves = columns.map(|column| column.split_at_mut(symbol.len()));
    act(halves.each_mut().map(|(first, _)| &mut **first), symbol.iter().copied());
    let rest = halves[0].1.len();
    let mirrored = symbol[1..=rest].iter().rev().map(|entries| entries.mirrored());
    act(halves.map(|(_, second)| second), mirrored);
}

/// Multiplies the first waves of all components, each by its entries.
fn act<T: Real, S: Tensor<T, N>, const N: usize>(
    columns: [&mut [Complex<T>]; N],
    symbol: impl ExactSizeIterator<Item = S>,
) {
    let count = symbol.len();
    let mut columns = columns.map(|column| &mut column[..count]);
    if let [column] = &mut columns[..] {
        // Of one component, as a loop over one slice, which is vectorised.
        widest(
            #[inline(always)]
            move || {
                for (value, entries) in column.iter_mut().zip(symbol) {
                    *value = entries.displacements([*value; N])[0];
                }
            },
        );
        return;
    }
    for (k, entries) in symbol.enumerate() {
        let moved = entries.displacements(std::array::from_fn(|i| columns[i][k]));
        for (column, moved) in columns.iter_mut().zip(moved) {
            column[k] = moved;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::kernel::love::influence;
    use crate::kernel::{NormalTable, Symbol, TangentialTable};
    use crate::operator::DirectSum;
    use crate::tuning::BAND;
    use contact_model::Boundary;
    use contact_model::never;
    use std::sync::Mutex;

    #[test]
    fn single_precision_serves_pressures_of_any_size() {
        // Powers of two out of the range of f32 change no bit.
        let grid = Grid::square(6, 6);
        let cells = CellSet::all(grid);
        let lengths = Lengths::free(grid.window());
        let symbol = Symbol::of_kernel(lengths, influence);
        let mut operator = FftConvolution::<f32>::new(grid.window(), lengths, symbol.scaled());
        assert!(format!("{operator:?}").starts_with("Convolution<f32, 1, 1>(Window"));
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
            let done = operator.forward(
                |_, y| given.contains(&y),
                |_, y, row| {
                    assert!(row.len() == 6 && row.iter().all(|&p| p == 0.0));
                    row[2] = 1.0;
                    seen.lock().unwrap().push(y);
                },
                &never,
            );
            done.unwrap();
            operator.multiply(|y| wanted.contains(&y), &never).unwrap();
            let mut bands: Vec<Vec<(usize, f64)>> = operator.bands().map(|_| Vec::new()).collect();
            let done = operator.backward(
                |y| wanted.contains(&y),
                bands.iter_mut(),
                |band, _, y, row| band.push((y, row[4])),
                &never,
            );
            done.unwrap();
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
    fn a_convolution_that_is_left_anywhere_gives_the_same_bits_afterwards() {
        use std::cell::Cell;
        let grid = Grid::square(70, 2 * BAND + 5);
        let cells = CellSet::all(grid);
        let table = NormalTable::shared(grid, Boundary::Free);
        let lengths = table.exact_lengths(grid.window());
        let symbol = table.symbol_f64(lengths, &never).unwrap();
        let mut operator = FftConvolution::<f64>::new(grid.window(), lengths, symbol);
        let p: Vec<f64> = (0..grid.count()).map(|k| (0.3 * k as f64).sin()).collect();
        let mut whole = vec![0.0; p.len()];
        operator.apply(&cells, &p, &cells, &mut whole);
        let polls = Cell::new(0);
        let mut interrupted = 0;
        for before in 0.. {
            polls.set(0);
            let stop = || polls.replace(polls.get() + 1) == before;
            let mut u = vec![0.0; p.len()];
            if operator.apply_until(&cells, &p, &cells, &mut u, &stop).is_ok() {
                assert_eq!(u, whole);
                break;
            }
            assert_eq!(polls.get(), before + 1, "nothing is begun after a stop");
            interrupted += 1;
            operator.apply(&cells, &p, &cells, &mut u);
            assert_eq!(u, whole, "after a stop at poll {before}");
        }
        // Three bands of rows twice, and the stripes of columns.
        assert!(interrupted > 6, "{interrupted}");
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

    #[test]
    fn the_convolution_is_the_sum_over_pairs() {
        for (columns, rows, stretch, boundary, c) in [
            (9, 9, 1.0, Boundary::Free, 0.43),
            (8, 13, 1.4, Boundary::Free, 1.0),
            (1, 1, 1.0, Boundary::Free, 0.5),
            (2, 1, 1.0, Boundary::Free, 0.5),
            (1, 17, 0.7, Boundary::Free, 0.3),
            (20, 2 * BAND + 5, 1.0, Boundary::Free, 0.8),
            (8, 8, 1.0, Boundary::Periodic, 0.43),
            (9, 6, 1.6, Boundary::Periodic, 1.0),
            (1, 7, 1.0, Boundary::Periodic, 1.0),
        ] {
            let grid = Grid { columns, rows, stretch };
            let table = TangentialTable::shared(grid, boundary, c);
            let some = CellSet::numbered(grid, |i| i % 7 != 3 && i % 11 != 5);
            let all = CellSet::all(grid);
            for (sources, targets) in [(&some, &all), (&all, &some), (&some, &some)] {
                let q: Vec<f64> = (0..2 * sources.len()).map(|k| (1.3 * k as f64).sin() - 0.2).collect();
                let (mut direct, mut fast) = (vec![9.0; 2 * targets.len()], vec![7.0; 2 * targets.len()]);
                DirectSum(&table).apply(sources, &q, targets, &mut direct);
                let window = grid.window();
                let lengths = table.exact_lengths(window);
                let mut operator = VectorConvolution::<f64>::new(
                    window,
                    lengths,
                    table.symbol_f64(lengths, &never).unwrap(),
                );
                operator.apply(sources, &q, targets, &mut fast);
                let scale = direct.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
                for (a, b) in direct.iter().zip(&fast) {
                    assert!((a - b).abs() < 1e-13 * scale, "{columns} {rows} {boundary:?}: {a} {b}");
                }
                let single: Vec<f32> = q.iter().map(|&q| q as f32).collect();
                let mut rough = vec![0.0f32; fast.len()];
                let mut operator = VectorConvolution::<f32>::new(
                    window,
                    lengths,
                    table.symbol_f32(lengths, &never).unwrap(),
                );
                operator.apply(sources, &single, targets, &mut rough);
                for (a, &b) in direct.iter().zip(&rough) {
                    assert!((a - f64::from(b)).abs() < 2e-6 * scale, "{columns} {rows}: {a} {b}");
                }
            }
        }
    }

    #[test]
    fn the_kernel_is_that_of_the_point_forces() {
        // One cell with a traction along x: signs and entries by hand.
        let grid = Grid { columns: 4, rows: 3, stretch: 1.3 };
        let table = TangentialTable::shared(grid, Boundary::Free, 0.6);
        let (source, targets) = (CellSet::from_index(grid, &[5]), CellSet::from_index(grid, &[0, 2, 8, 10]));
        let mut u = vec![0.0; 8];
        DirectSum(&table).apply(&source, &[1.0, 0.0], &targets, &mut u);
        let [xx, _, xy] = table.lag(1, 1);
        assert!(xy > 0.0);
        // Cells to the lower left, lower right, upper left and upper right: x y is positive, negative, ...
        assert_eq!(u, [xx, xx, xx, xx, xy, -xy, -xy, xy]);
    }

    #[test]
    fn an_inverse_on_the_torus_undoes_the_circular_convolution() {
        let grid = Grid { columns: 12, rows: 10, stretch: 1.2 };
        let table = TangentialTable::shared(grid, Boundary::Periodic, 0.7);
        let (window, all) = (grid.window(), CellSet::all(grid));
        let lengths = Lengths { x: 12, y: 10 };
        let q: Vec<f32> = (0..240).map(|k| (0.7 * k as f32).cos()).collect();
        let (mut u, mut back) = (vec![0.0; 240], vec![0.0; 240]);
        VectorConvolution::<f32>::new(window, lengths, table.symbol_f32(lengths, &never).unwrap())
            .apply(&all, &q, &all, &mut u);
        VectorConvolution::<f32>::new(window, lengths, table.inverse_symbol(lengths, &never).unwrap())
            .apply(&all, &u, &all, &mut back);
        for (q, back) in q.iter().zip(&back) {
            assert!((q - back).abs() < 1e-4, "{q} {back}");
        }
    }
}
