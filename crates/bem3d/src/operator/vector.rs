//! Convolution of tangential tractions with their kernel, a symmetric tensor, on a window of the grid.

use super::influence::InfluenceOperator;
use super::transform::Transform;
use crate::geometry::{CellSet, Lengths, Window};
use crate::kernel::TangentialTable;
use crate::real::Real;
use rustfft::num_complex::Complex;
use std::fmt;
use std::sync::Arc;

/// A planned convolution on a window. Values on a set of n cells are n components along x, then n along y.
///
/// An application takes two transforms forward and two back. The off-diagonal entry of the kernel is odd in
/// both lags, so that its transform is also real and changes its sign with that of a wave: a quarter of the
/// symbol is stored for each entry.
pub struct VectorConvolution<T: Real> {
    transform: Transform<T, 2>,
    /// Entries `[xx, yy, xy]` of the symbol divided by the number of points.
    symbol: Arc<Vec<[T; 3]>>,
}

impl<T: Real> fmt::Debug for VectorConvolution<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (window, lengths) = (self.transform.window(), self.transform.lengths());
        write!(f, "VectorConvolution<{}>({window:?}, {lengths:?})", T::NAME)
    }
}

impl<T: Real> VectorConvolution<T> {
    /// Plans for a window with a symbol of [`TangentialTable`].
    ///
    /// Memory: `2 height * (lx / 2 + 1)` complex numbers besides the symbol, and a few columns for each thread.
    pub fn new(window: Window, lengths: Lengths, symbol: Arc<Vec<[T; 3]>>) -> Self {
        Self { transform: Transform::new(window, lengths), symbol }
    }

    /// The window.
    pub fn window(&self) -> Window {
        self.transform.window()
    }

    /// The bands of rows of one component, which threads share: first row of each in the window.
    pub fn bands(&self) -> impl ExactSizeIterator<Item = usize> + Clone + use<T> {
        let bands = self.transform.bands();
        let count = bands.len() / 2;
        bands.take(count)
    }

    /// Transforms both components: `fill` writes row y of each, which is zero before, for all y with `given`.
    pub fn forward(
        &mut self,
        given: impl Fn(usize) -> bool + Sync,
        fill: impl Fn(usize, usize, &mut [T]) + Sync,
    ) {
        let (rows, height) = (self.transform.rows(), self.window().height);
        self.transform.forward(
            |at| at % rows < height && given(at % rows),
            |at, line| fill(at / rows, at % rows, line),
        );
    }

    /// Multiplies the spectra by the symbol. Only the bands of rows in `wanted` are valid afterwards.
    pub fn multiply(&mut self, wanted: impl Fn(usize) -> bool) {
        let (rows, height) = (self.transform.rows(), self.window().height);
        let (symbol, half) = (&self.symbol, self.transform.lengths().y / 2 + 1);
        self.transform.change(
            |at| at % rows < height && wanted(at % rows),
            |kx, [x, y]| multiply(x, y, &symbol[kx * half..][..half]),
        );
    }

    /// Transforms back: `take` reads row y of each component where it is `wanted`. Each band of rows has its own
    /// output, those of the first component before those of the second.
    pub fn backward<O: Send>(
        &mut self,
        wanted: impl Fn(usize) -> bool + Sync,
        outputs: impl ExactSizeIterator<Item = O> + Send,
        take: impl Fn(&mut O, usize, usize, &mut [T]) + Sync,
    ) {
        let (rows, height) = (self.transform.rows(), self.window().height);
        self.transform.backward(
            |at| at % rows < height && wanted(at % rows),
            outputs,
            |output, at, line| take(output, at / rows, at % rows, line),
        );
    }
}

impl<T: Real> InfluenceOperator<T> for VectorConvolution<T> {
    /// Both sets lie inside the window; vectors hold two components.
    fn apply(&mut self, sources: &CellSet, q: &[T], targets: &CellSet, u: &mut [T]) {
        let Window { x: x0, y: y0, .. } = self.window();
        let (n, rows) = (sources.len(), self.bands());
        let held = |y: usize| targets.row(y + y0).is_some();
        self.forward(
            |y| sources.row(y + y0).is_some(),
            |component, y, line| {
                if let Some(row) = sources.row(y + y0) {
                    row.spread(&q[component * n..][..n], line, x0);
                }
            },
        );
        self.multiply(held);
        let (along_x, along_y) = u.split_at_mut(targets.len());
        let mut outputs = targets.split(along_x, rows.clone().map(|y| y + y0));
        outputs.extend(targets.split(along_y, rows.map(|y| y + y0)));
        self.backward(held, outputs.into_iter(), |(start, u), _, y, line| {
            if let Some(row) = targets.row(y + y0) {
                row.after(*start).collect(line, u, x0);
            }
        });
    }
}

/// Multiplies full columns of both components by the symbol given on its first half.
fn multiply<T: Real>(x: &mut [Complex<T>], y: &mut [Complex<T>], symbol: &[[T; 3]]) {
    let (half, length) = (symbol.len(), x.len());
    let (x, mirrored_x) = x.split_at_mut(half);
    let (y, mirrored_y) = y.split_at_mut(half);
    let act = |x: &mut Complex<T>, y: &mut Complex<T>, [xx, yy, xy]: [T; 3]| {
        (*x, *y) = (*x * xx + *y * xy, *x * xy + *y * yy);
    };
    for ((x, y), &symbol) in x.iter_mut().zip(y).zip(symbol) {
        act(x, y, symbol);
    }
    let mirrored = symbol[1..=(length - half)].iter().rev();
    for ((x, y), &[xx, yy, xy]) in mirrored_x.iter_mut().zip(mirrored_y).zip(mirrored) {
        act(x, y, [xx, yy, T::default() - xy]);
    }
}

/// The sum over pairs: the reference of the convolution, and the faster one for a few hundred cells.
#[derive(Debug)]
pub struct DirectVectorSum<'a>(pub &'a TangentialTable);

impl<T: Real> InfluenceOperator<T> for DirectVectorSum<'_> {
    /// `u_i = sum_j K(i - j) q_j`. Cost: O(sources x targets).
    fn apply(&mut self, sources: &CellSet, q: &[T], targets: &CellSet, u: &mut [T]) {
        let n = sources.len();
        let (qx, qy) = q.split_at(n);
        let (ux, uy) = u.split_at_mut(targets.len());
        for (own, other, along, u) in [(qx, qy, 0, ux), (qy, qx, 1, uy)] {
            targets.update(n * targets.len(), u, |target, u| {
                let u = &mut u[target.span()];
                u.fill(T::default());
                for source in sources.rows() {
                    let line = self.0.row(source.y.abs_diff(target.y));
                    let (own, other) = (&own[source.span()], &other[source.span()]);
                    for (&x, u) in target.columns.iter().zip(&mut *u) {
                        let mut sum = 0.0;
                        for ((&xs, own), other) in source.columns.iter().zip(own).zip(other) {
                            let entries = line[x.abs_diff(xs) as usize];
                            let across =
                                if (x < xs) == (target.y < source.y) { entries[2] } else { -entries[2] };
                            sum += entries[along] * own.to_f64() + across * other.to_f64();
                        }
                        *u += T::of(sum);
                    }
                }
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Grid;
    use crate::tuning::BAND;
    use contact_model::Boundary;

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
                DirectVectorSum(&table).apply(sources, &q, targets, &mut direct);
                let window = grid.window();
                let lengths = table.exact_lengths(window);
                let mut operator = VectorConvolution::<f64>::new(window, lengths, table.symbol_f64(lengths));
                operator.apply(sources, &q, targets, &mut fast);
                let scale = direct.iter().fold(0.0, |m: f64, u| m.max(u.abs()));
                for (a, b) in direct.iter().zip(&fast) {
                    assert!((a - b).abs() < 1e-13 * scale, "{columns} {rows} {boundary:?}: {a} {b}");
                }
                let single: Vec<f32> = q.iter().map(|&q| q as f32).collect();
                let mut rough = vec![0.0f32; fast.len()];
                let mut operator = VectorConvolution::<f32>::new(window, lengths, table.symbol_f32(lengths));
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
        DirectVectorSum(&table).apply(&source, &[1.0, 0.0], &targets, &mut u);
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
        VectorConvolution::<f32>::new(window, lengths, table.symbol_f32(lengths))
            .apply(&all, &q, &all, &mut u);
        VectorConvolution::<f32>::new(window, lengths, table.inverse_symbol(lengths))
            .apply(&all, &u, &all, &mut back);
        for (q, back) in q.iter().zip(&back) {
            assert!((q - back).abs() < 1e-4, "{q} {back}");
        }
    }
}
