//! The kernels, and for each grid a table of one with its symbols, shared by all surfaces of that grid.

use super::along_a_line::AlongALine;
use super::coupling::CouplingKernel;
use super::definition::{Coefficients, Kernel};
use super::half_plane::HalfPlane;
use super::half_space::HalfSpace;
use super::layer::{LayerOnGrid, LayeredBody};
use super::periodic::{PeriodicHalfSpace, PeriodicKernel};
use super::symbol::{Parity, Symbol};
use super::tangential::TangentialKernel;
use super::tensor::Invertible;
use crate::geometry::{Grid, Lengths, Window};
use crate::real::Real;
use crate::tuning::KEPT_SYMBOLS;
use contact_model::{Boundary, Interrupted, Stop};
use std::any::Any;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// The body that deforms under a pressure, and its continuation outside the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Medium {
    /// A half-space that is unloaded outside the map.
    HalfSpace,
    /// A half-space with periodic copies of the map.
    Periodic(PeriodicKernel),
    /// A half-plane in plane strain, unloaded outside the line: one row of strips.
    HalfPlane,
    /// A half-space with copies of the map along one axis alone.
    AlongALine(Boundary),
    /// A layer on a base, with this boundary of the map.
    Layer(LayerOnGrid, Boundary, PeriodicKernel),
}

impl From<Boundary> for Medium {
    fn from(boundary: Boundary) -> Self {
        match boundary.repeats() {
            [false, false] => Self::HalfSpace,
            [true, true] => Self::Periodic(PeriodicKernel::Cells),
            _ => Self::AlongALine(boundary),
        }
    }
}

impl Medium {
    /// The same medium on a coarser grid, whose cells have `times` the side: a medium counts lengths in that side.
    pub fn on_larger_cells(self, times: f64) -> Self {
        match self {
            Self::Layer(layer, boundary, exact_for) => {
                Self::Layer(LayerOnGrid { thickness: layer.thickness / times, ..layer }, boundary, exact_for)
            }
            other => other,
        }
    }
}

/// Table of the normal displacement under a pressure.
pub type NormalTable = KernelTable<1>;
/// Table of the tangential displacements under tangential tractions, `[xx, yy, xy]`.
pub type TangentialTable = KernelTable<3>;
/// Table of the coupling of normal and tangential displacements, `[x, y]`.
pub type CouplingTable = KernelTable<2>;

// The kernels: each is a file of this folder and a line here.

impl NormalTable {
    /// The table of a grid on a medium.
    pub fn shared(grid: Grid, medium: impl Into<Medium>) -> Arc<Self> {
        match medium.into() {
            Medium::HalfSpace => Self::of(HalfSpace { grid }),
            Medium::Periodic(exact_for) => Self::of(PeriodicHalfSpace { grid, exact_for }),
            Medium::HalfPlane => Self::of(HalfPlane { grid }),
            Medium::AlongALine(boundary) => Self::of(AlongALine { grid, boundary }),
            Medium::Layer(layer, boundary, exact_for) => {
                Self::of(LayeredBody { grid, boundary, layer, exact_for })
            }
        }
    }
}

impl TangentialTable {
    /// The table of a grid and of bodies of the constant `compliance = E* sum nu/(2 G)`.
    pub fn shared(grid: Grid, boundary: Boundary, compliance: f64) -> Arc<Self> {
        Self::of(TangentialKernel { grid, boundary, compliance })
    }
}

impl CouplingTable {
    /// The table of a grid.
    pub fn shared(grid: Grid, boundary: Boundary) -> Arc<Self> {
        Self::of(CouplingKernel { grid, boundary })
    }
}

/// A kernel at all lags of its grid, and the symbols made from it.
///
/// Rows and symbols are made when they are first needed, so that a contact of three cells does not compute a
/// table of four million. Its values depend on the kernel alone, so that sharing it changes no result.
pub struct KernelTable<const E: usize> {
    kernel: Box<dyn Kernel<E>>,
    coefficients: OnceLock<Coefficients<E>>,
    smallest_eigenvalue: OnceLock<f64>,
    rows: Vec<OnceLock<Box<[[f64; E]]>>>,
    double: Mutex<Kept<[f64; E]>>,
    single: Mutex<Kept<[f32; E]>>,
    inverse: Mutex<Kept<[f32; E]>>,
}

impl<const E: usize> fmt::Debug for KernelTable<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "KernelTable({:?})", self.kernel)
    }
}

impl<const E: usize> KernelTable<E> {
    /// The table of a kernel; one table serves all surfaces alive at the same time.
    fn of<K: Kernel<E> + PartialEq>(kernel: K) -> Arc<Self> {
        static LIVE: Mutex<Vec<Weak<dyn Any + Send + Sync>>> = Mutex::new(Vec::new());
        let mut live = lock(&LIVE);
        live.retain(|table| table.strong_count() > 0);
        let same = |table: &Arc<Self>| (&*table.kernel as &dyn Any).downcast_ref() == Some(&kernel);
        let tables = live.iter().filter_map(Weak::upgrade).filter_map(|table| table.downcast::<Self>().ok());
        if let Some(table) = { tables }.find(same) {
            return table;
        }
        let rows = (0..kernel.grid().rows).map(|_| OnceLock::new()).collect();
        let table = Arc::new(Self {
            kernel: Box::new(kernel),
            coefficients: OnceLock::new(),
            smallest_eigenvalue: OnceLock::new(),
            rows,
            double: Mutex::default(),
            single: Mutex::default(),
            inverse: Mutex::default(),
        });
        let any: Arc<dyn Any + Send + Sync> = Arc::<Self>::clone(&table);
        live.push(Arc::downgrade(&any));
        table
    }

    /// The kernel.
    pub fn kernel(&self) -> &dyn Kernel<E> {
        &*self.kernel
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.kernel.grid()
    }

    /// The boundary of the map.
    pub fn boundary(&self) -> Boundary {
        self.kernel.boundary()
    }

    /// The coefficients. Threads that fill rows call this first: see `cached`.
    fn coefficients(&self) -> &Coefficients<E> {
        if let Some(made) = self.coefficients.get() {
            return made;
        }
        // Made outside the cell: see `cached`.
        let made = self.kernel.coefficients();
        self.coefficients.get_or_init(|| made)
    }

    /// The constant in the entries of the diagonal: 0 with free boundaries.
    pub fn shift(&self) -> f64 {
        self.coefficients().shift()
    }

    /// A lower bound of the eigenvalues of the kernel on every set of cells.
    pub fn smallest_eigenvalue(&self) -> f64 {
        *self.smallest_eigenvalue.get_or_init(|| self.kernel.smallest_eigenvalue())
    }

    /// The largest displacement of a cell along its own unit traction.
    pub fn own(&self) -> f64 {
        self.lag(0, 0).into_iter().fold(0.0, f64::max)
    }

    /// The entries at a lag within the grid.
    pub fn lag(&self, x: usize, y: usize) -> [f64; E] {
        self.row(y)[x]
    }

    /// The entries at the lags `(0 .. columns, y)`.
    pub fn row(&self, y: usize) -> &[[f64; E]] {
        // Made outside the cell of the row: see `cached`.
        let coefficients = self.coefficients();
        self.rows[y].get_or_init(|| {
            let mut row = vec![[0.0; E]; self.grid().columns].into_boxed_slice();
            let mut values = vec![0.0; row.len()];
            for entry in 0..E {
                coefficients.fill(entry, y, &mut values);
                row.iter_mut().zip(&values).for_each(|(entries, value)| entries[entry] = *value);
            }
            row
        })
    }

    /// Circular lengths of a transform that is exact on a window: the period itself where the window needs as
    /// much.
    ///
    /// An even kernel needs `2 (n - 1)` cells; an entry that is odd would meet its negative at the lag `n - 1`.
    pub fn exact_lengths(&self, window: Window) -> Lengths {
        self.kernel.within_period(self.unrepeated_lengths(window))
    }

    fn unrepeated_lengths(&self, window: Window) -> Lengths {
        let odd = self.kernel.parities().as_flattened().contains(&Parity::Odd);
        if odd { Lengths::reaching(window, usize::MAX) } else { Lengths::free(window) }
    }

    /// Circular lengths for corrections of the tractions, exact up to lags of half `share` of the window
    /// ([`Lengths::shortened`]).
    pub fn shortened_lengths(&self, window: Window, share: f64) -> Lengths {
        if !self.kernel.may_be_shortened() {
            return self.exact_lengths(window);
        }
        let (short, exact) = (Lengths::shortened(window, share), self.unrepeated_lengths(window));
        self.kernel.within_period(Lengths { x: short.x.min(exact.x), y: short.y.min(exact.y) })
    }

    /// Circular lengths of the preconditioner of a window.
    pub fn torus_lengths(&self, window: Window) -> Lengths {
        self.kernel.within_period(Lengths::torus(window))
    }

    /// Scaled symbol of the operator in double precision, `[kx * (ly / 2 + 1) + ky]`.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn symbol_f64(&self, lengths: Lengths, stop: Stop<'_>) -> Result<Arc<Vec<[f64; E]>>, Interrupted> {
        cached(&self.double, lengths, || Ok(scaled(lengths, self.symbol(lengths, stop)?)))
    }

    /// Scaled symbol of the operator in single precision, rounded from the one in double precision, which
    /// certificates need.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn symbol_f32(&self, lengths: Lengths, stop: Stop<'_>) -> Result<Arc<Vec<[f32; E]>>, Interrupted> {
        let double = self.symbol_f64(lengths, stop)?;
        cached(&self.single, lengths, || {
            Ok(Arc::new(double.iter().map(|entries| entries.map(|value| value as f32)).collect()))
        })
    }

    /// The same for lengths that no operator in double precision takes.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn shortened_symbol(
        &self,
        lengths: Lengths,
        stop: Stop<'_>,
    ) -> Result<Arc<Vec<[f32; E]>>, Interrupted> {
        cached(&self.single, lengths, || Ok(scaled(lengths, self.symbol(lengths, stop)?)))
    }

    /// Symbol of the kernel on a circular grid, with each lag taken the shorter way round.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub(super) fn symbol(
        &self,
        lengths: Lengths,
        stop: Stop<'_>,
    ) -> Result<impl Iterator<Item = [f64; E]> + use<E>, Interrupted> {
        let coefficients = self.coefficients();
        let parities = self.kernel.parities();
        let mut entries = [const { Vec::new() }; E];
        for (entry, values) in entries.iter_mut().enumerate() {
            let fill = |y: usize, row: &mut [f64]| coefficients.fill(entry, y, row);
            *values = Symbol::with_parity_until(lengths, parities[entry], fill, stop)?.values;
        }
        // An entry that is odd in both directions has the square of -i.
        let signs = parities.map(|parity| if parity == [Parity::Odd; 2] { -1.0 } else { 1.0 });
        let points = entries[0].len();
        Ok((0..points).map(move |k| std::array::from_fn(|entry| signs[entry] * entries[entry][k])))
    }
}

impl<const E: usize> KernelTable<E>
where
    [f64; E]: Invertible,
{
    /// Scaled inverse symbol of the kernel wrapped on a torus.
    ///
    /// The wrapped kernel is positive definite; a rounding error in a tiny window must not turn a sign.
    ///
    /// # Errors
    /// As [`Symbol::with_parity_until`].
    pub fn inverse_symbol(
        &self,
        lengths: Lengths,
        stop: Stop<'_>,
    ) -> Result<Arc<Vec<[f32; E]>>, Interrupted> {
        let floor = self.smallest_eigenvalue() / 2.0;
        cached(&self.inverse, lengths, || {
            Ok(scaled(lengths, self.symbol(lengths, stop)?.map(|entries| entries.inverse(floor))))
        })
    }
}

/// A symbol over the number of points (neither transform is normalised), in the precision of a convolution.
fn scaled<T: Real, const E: usize>(
    lengths: Lengths,
    symbol: impl Iterator<Item = [f64; E]>,
) -> Arc<Vec<[T; E]>> {
    let norm = 1.0 / lengths.points() as f64;
    Arc::new(symbol.map(|entries| entries.map(|value| T::of(value * norm))).collect())
}

/// The most recent symbols.
#[derive(Debug)]
struct Kept<T> {
    made: Vec<(Lengths, Arc<Vec<T>>)>,
}

impl<T> Default for Kept<T> {
    fn default() -> Self {
        Self { made: Vec::new() }
    }
}

impl<T> Kept<T> {
    fn find(&self, lengths: Lengths) -> Option<Arc<Vec<T>>> {
        self.made.iter().find(|(l, _)| *l == lengths).map(|(_, symbol)| Arc::clone(symbol))
    }

    fn keep(&mut self, lengths: Lengths, symbol: Arc<Vec<T>>) -> Arc<Vec<T>> {
        if let Some(symbol) = self.find(lengths) {
            return symbol; // Another thread was faster.
        }
        self.made.push((lengths, Arc::clone(&symbol)));
        while self.made.len() > 1 && self.made.iter().map(|(_, s)| s.len()).sum::<usize>() > KEPT_SYMBOLS {
            self.made.remove(0);
        }
        symbol
    }
}

/// The symbol of some lengths, made where there is none.
///
/// No lock is held while it is made: threads share that work, and a thread that waits may begin another
/// solve, which would then wait for the lock for ever. Two threads may make the same symbol; one of them is
/// kept.
fn cached<T>(
    kept: &Mutex<Kept<T>>,
    lengths: Lengths,
    make: impl FnOnce() -> Result<Arc<Vec<T>>, Interrupted>,
) -> Result<Arc<Vec<T>>, Interrupted> {
    if let Some(symbol) = { lock(kept).find(lengths) } {
        return Ok(symbol);
    }
    let symbol = make()?;
    Ok(lock(kept).keep(lengths, symbol))
}

/// Locks the cache. A panic of another thread while it filled the cache leaves no incomplete entry.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::CellSet;
    use crate::kernel::Evidence;
    use crate::kernel::love::influence_of_rectangle;
    use crate::operator::{DirectSum, FftConvolution, InfluenceOperator};
    use approx::assert_relative_eq;
    use contact_model::never;
    use std::cell::Cell;

    /// Rounding of transforms of a few hundred points.
    const DOUBLE: f64 = 1e-13;
    /// Single precision of the inverse.
    const SINGLE: f64 = 1e-5;

    #[test]
    fn surfaces_of_one_grid_share_a_table() {
        let grid = Grid::square(37, 37);
        let [free, again, periodic] = [Boundary::Free, Boundary::Free, Boundary::Periodic]
            .map(|boundary| NormalTable::shared(grid, boundary));
        assert!(Arc::ptr_eq(&free, &again) && !Arc::ptr_eq(&free, &periodic));
        for other in [Grid::square(37, 38), Grid::square(38, 37), Grid { stretch: 1.1, ..grid }] {
            assert!(!Arc::ptr_eq(&free, &NormalTable::shared(other, Boundary::Free)), "{other:?}");
        }
        assert_eq!((free.boundary(), periodic.boundary()), (Boundary::Free, Boundary::Periodic));
        assert_eq!((free.grid(), periodic.grid()), (grid, grid));
        assert!(Arc::ptr_eq(&periodic, &NormalTable::shared(grid, Boundary::Periodic)));
        assert_eq!(
            format!("{free:?}"),
            "KernelTable(HalfSpace { grid: Grid { columns: 37, rows: 37, stretch: 1.0 } })"
        );
    }

    #[test]
    fn uniform_pressure_sinks_a_periodic_map_by_its_shift_alone() {
        // Zero mean plus c: u = c times the number of cells everywhere, by pairs and by a transform. The
        // period itself is a length that serves, whatever its prime factors.
        for (columns, rows, stretch) in
            [(6, 6, 1.0), (7, 7, 1.0), (16, 16, 1.0), (1, 1, 1.0), (13, 4, 1.0), (5, 12, 1.6)]
        {
            let grid = Grid { columns, rows, stretch };
            let table = NormalTable::shared(grid, Boundary::Periodic);
            if columns == rows {
                assert_relative_eq!(table.shift(), 2.0 / columns as f64);
            }
            let (cells, p) = (CellSet::all(grid), vec![1.0; grid.count()]);
            let lengths = table.exact_lengths(grid.window());
            assert_eq!(lengths, Lengths { x: columns, y: rows }, "the period itself");
            let (mut pairs, mut transform) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            DirectSum(&table).apply(&cells, &p, &cells, &mut pairs);
            FftConvolution::new(grid.window(), lengths, table.symbol_f64(lengths, &never).unwrap()).apply(
                &cells,
                &p,
                &cells,
                &mut transform,
            );
            let expected = table.shift() * grid.count() as f64;
            for (a, b) in pairs.iter().zip(&transform) {
                assert_relative_eq!(*a, expected, max_relative = DOUBLE);
                assert_relative_eq!(*b, expected, max_relative = DOUBLE);
            }
        }
        let free = NormalTable::shared(Grid::square(6, 6), Boundary::Free);
        assert!(free.shift() == 0.0);
        let window = Window { x: 0, y: 0, width: 6, height: 6 };
        assert_eq!(free.exact_lengths(window), Lengths { x: 10, y: 10 });
    }

    #[test]
    fn the_inverse_is_one_over_the_eigenvalue_of_a_wave() {
        // The checkerboard on a torus: the smallest eigenvalue, which the floor of the inverse must not
        // touch.
        for (columns, rows, stretch) in [(16, 16, 1.0), (24, 16, 1.0), (20, 16, 1.5)] {
            let grid = Grid { columns, rows, stretch };
            let table = NormalTable::shared(grid, Boundary::Free);
            let cells = CellSet::all(grid);
            let lengths = Lengths { x: columns, y: rows };
            let place = |k: usize| (k % columns, k / columns);
            let board: Vec<f64> =
                cells.places().map(|(x, y)| if (x + y).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
            let lag = |x: usize, period: usize| x.min(period - x);
            let eigenvalue: f64 = (0..grid.count())
                .map(|k| {
                    let (x, y) = place(k);
                    board[k] * influence_of_rectangle(lag(x, columns), lag(y, rows), stretch)
                })
                .sum();
            let smallest = table.smallest_eigenvalue();
            assert!((eigenvalue / smallest - 1.0).abs() < 0.01, "{grid:?}: {eigenvalue} {smallest}");
            let mut back = vec![0.0; board.len()];
            FftConvolution::<f32>::new(
                grid.window(),
                lengths,
                table.inverse_symbol(lengths, &never).unwrap(),
            )
            .apply(&cells, &board, &cells, &mut back);
            for (b, p) in back.iter().zip(&board) {
                assert_relative_eq!(*b, p / eigenvalue, max_relative = SINGLE);
            }
        }
    }

    #[test]
    fn kernels_of_pressures_are_what_they_say() {
        let line = Grid { columns: 40, rows: 1, stretch: 1.0 };
        let plane = Grid { columns: 9, rows: 7, stretch: 1.0 };
        let oblong = Grid { columns: 6, rows: 8, stretch: 1.4 };
        for (medium, grid) in [
            (Medium::HalfPlane, line),
            (Medium::HalfSpace, plane),
            (Medium::HalfSpace, oblong),
            (Medium::Periodic(PeriodicKernel::Cells), plane),
            (Medium::Periodic(PeriodicKernel::Cells), oblong),
            (Medium::AlongALine(Boundary::PeriodicAlongX), plane),
            (Medium::AlongALine(Boundary::PeriodicAlongX), oblong),
            (Medium::AlongALine(Boundary::PeriodicAlongY), oblong),
            (Medium::Periodic(PeriodicKernel::Waves), plane),
            (Medium::Periodic(PeriodicKernel::Waves), oblong),
        ] {
            let table = NormalTable::shared(grid, medium);
            let sets: [&dyn Fn(usize) -> bool; 5] =
                [&|_| true, &|k| k % 39 == 0, &|k| k % 3 == 0, &|k| !(8..30).contains(&k), &|k| {
                    k * k % 7 < 3
                }];
            for keep in sets {
                let places: Vec<_> = CellSet::numbered(grid, keep).places().collect();
                let entry = |i: usize, j: usize| {
                    let ((x, y), (a, b)) = (places[i], places[j]);
                    table.lag(x.abs_diff(a), y.abs_diff(b))[0]
                };
                let n = places.len();
                // With twice the constant of a periodic kernel: with it once, nearly full sets violate the property
                // by about a thousandth.
                let raised = |by: f64| inverse(n, &|i, j| entry(i, j) + by * table.shift());
                let inverse = raised(1.0);
                let negative = |inverse: &[f64]| {
                    let largest = (0..n).map(|i| inverse[i * n + i]).fold(0.0, f64::max);
                    let off_diagonal = (0..n * n).filter(|k| k / n != k % n).map(|k| inverse[k]);
                    off_diagonal.fold(f64::MIN, f64::max) <= 1e-12 * largest
                };
                let full_period = matches!(medium, Medium::Periodic(_)) && n == grid.count();
                assert!(!(full_period && negative(&raised(0.0))), "the text says otherwise: {grid:?}");
                let evidence = table.kernel().inverse_m_matrix();
                assert!(negative(&inverse) || evidence == Evidence::Violated, "{medium:?} {grid:?}");
                // Below the bound of the eigenvalues: G - lambda is positive definite as long as elimination
                // meets positive pivots.
                let bound = table.smallest_eigenvalue() * (1.0 - 1e-6);
                let lowered = |i, j| entry(i, j) - if i == j { bound } else { 0.0 };
                assert!(pivots(n, &lowered).iter().all(|&p| p > 0.0), "{medium:?} {grid:?}");
            }
        }
    }

    #[test]
    fn nothing_is_locked_while_a_symbol_is_made() {
        // As a thread does that begins another solve while it waits: of other lengths, and of the same.
        let kept = Mutex::new(Kept::<u8>::default());
        let (a, b) = (Lengths { x: 2, y: 2 }, Lengths { x: 4, y: 2 });
        let symbol = cached(&kept, a, || {
            cached(&kept, b, || Ok(Arc::new(vec![2]))).unwrap();
            cached(&kept, a, || Ok(Arc::new(vec![1]))).unwrap();
            Ok(Arc::new(vec![1]))
        });
        let symbol = symbol.unwrap();
        assert_eq!((*symbol).clone(), [1]);
        assert!(Arc::ptr_eq(&symbol, &cached(&kept, a, || unreachable!()).unwrap()));
        assert_eq!(lock(&kept).made.len(), 2);
    }

    #[test]
    fn a_symbol_that_is_left_unfinished_is_not_kept() {
        let table = NormalTable::shared(Grid::square(51, 43), Boundary::Free);
        let lengths = table.exact_lengths(table.grid().window());
        for before in [0, 1, 30] {
            let polls = Cell::new(0);
            let stop = || polls.replace(polls.get() + 1) == before;
            assert_eq!(table.symbol_f64(lengths, &stop).map(|_| ()), Err(Interrupted));
            assert!(lock(&table.double).made.is_empty());
        }
        assert!(table.symbol_f64(lengths, &never).is_ok());
    }

    #[test]
    fn the_oldest_symbols_are_dropped_where_they_fill_the_memory() {
        let kept = Mutex::new(Kept::<u8>::default());
        let made = Cell::new(0);
        let get = |x: usize, count: usize| {
            cached(&kept, Lengths { x, y: 2 }, || {
                made.set(made.get() + 1);
                Ok(Arc::new(vec![0; count]))
            })
            .unwrap();
            made.get()
        };
        assert_eq!((get(2, KEPT_SYMBOLS / 2), get(4, KEPT_SYMBOLS / 2)), (1, 2));
        assert_eq!((get(2, 0), get(4, 0)), (2, 2), "what just fits is kept");
        assert_eq!(get(6, 1), 3);
        assert_eq!((get(4, 0), get(6, 0)), (3, 3), "one too much: only the oldest went");
        assert_eq!((get(2, KEPT_SYMBOLS + 1), get(2, 0)), (4, 4), "the last one stays whatever its size");
        assert_eq!(get(6, 1), 5);
        const { assert!(KEPT_SYMBOLS >= 2049 * 2049, "a grid of 2049 cells a side finds its symbol again") };
    }

    fn eliminated(n: usize, width: usize, a: &mut [f64]) -> Vec<f64> {
        let mut pivots = Vec::new();
        for k in 0..n {
            let pivot = a[k * width + k];
            pivots.push(pivot);
            let above = a[k * width..(k + 1) * width].to_vec();
            for i in (0..n).filter(|&i| i != k) {
                let factor = a[i * width + k] / pivot;
                for (value, above) in a[i * width..(i + 1) * width].iter_mut().zip(&above) {
                    *value -= factor * above;
                }
            }
        }
        pivots
    }

    fn pivots(n: usize, entry: &dyn Fn(usize, usize) -> f64) -> Vec<f64> {
        let mut a: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        eliminated(n, n, &mut a)
    }

    fn inverse(n: usize, entry: &dyn Fn(usize, usize) -> f64) -> Vec<f64> {
        let width = 2 * n;
        let value = |k: usize| {
            let (i, j) = (k / width, k % width);
            if j < n { entry(i, j) } else { f64::from(u8::from(j - n == i)) }
        };
        let mut a: Vec<f64> = (0..n * width).map(value).collect();
        let pivots = eliminated(n, width, &mut a);
        (0..n * n).map(|k| a[(k / n) * width + n + k % n] / pivots[k / n]).collect()
    }
}
