//! The kernel of one grid and medium, and its symbols, shared by all surfaces of that grid.

use super::half_plane;
use super::love::{influence_of_rectangle, influence_row, smallest_eigenvalue};
use super::periodic::PeriodicKernel;
use super::symbol::Symbol;
use crate::geometry::{Grid, Lengths, Window};
use crate::tuning::KEPT_SYMBOLS;
use contact_model::Boundary;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// The body that deforms, and its continuation outside the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Medium {
    /// A half-space that is unloaded outside the map.
    HalfSpace,
    /// A half-space with periodic copies of the map.
    Periodic,
    /// A half-plane in plane strain, unloaded outside the line: one row of strips.
    HalfPlane,
}

impl Medium {
    /// What lies outside the map.
    pub fn boundary(self) -> Boundary {
        if self == Self::Periodic { Boundary::Periodic } else { Boundary::Free }
    }
}

impl From<Boundary> for Medium {
    fn from(boundary: Boundary) -> Self {
        if boundary == Boundary::Periodic { Self::Periodic } else { Self::HalfSpace }
    }
}

/// The kernel at all lags of a grid and the symbols made from it.
///
/// Rows and symbols are made when they are first needed, so that a contact of three cells does not compute a
/// table of four million. Its values depend on the grid alone, so that sharing it changes no result.
pub struct KernelTable {
    grid: Grid,
    medium: Medium,
    smallest_eigenvalue: f64,
    /// The periodic kernel, made at the first use with periodic boundaries.
    periodic: OnceLock<PeriodicKernel>,
    rows: Vec<OnceLock<Box<[f64]>>>,
    double: Mutex<Kept<f64>>,
    single: Mutex<Kept<f32>>,
    inverse: Mutex<Kept<f32>>,
}

impl fmt::Debug for KernelTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Grid { columns, rows, .. } = self.grid;
        write!(f, "KernelTable({columns} x {rows} cells, {:?})", self.medium)
    }
}

impl KernelTable {
    /// The table of a grid; one table serves all surfaces alive at the same time.
    pub fn shared(grid: Grid, medium: impl Into<Medium>) -> Arc<Self> {
        static LIVE: Mutex<Vec<Weak<KernelTable>>> = Mutex::new(Vec::new());
        let medium = medium.into();
        let mut live = lock(&LIVE);
        live.retain(|t| t.strong_count() > 0);
        let same = |t: &Arc<Self>| t.grid == grid && t.medium == medium;
        if let Some(table) = live.iter().filter_map(Weak::upgrade).find(same) {
            return table;
        }
        let table = Arc::new(Self {
            grid,
            medium,
            smallest_eigenvalue: match medium {
                Medium::HalfPlane => half_plane::smallest_eigenvalue(grid.stretch),
                _ => smallest_eigenvalue(grid.stretch),
            },
            periodic: OnceLock::new(),
            rows: (0..grid.rows).map(|_| OnceLock::new()).collect(),
            double: Mutex::default(),
            single: Mutex::default(),
            inverse: Mutex::default(),
        });
        live.push(Arc::downgrade(&table));
        table
    }

    /// The grid.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// What lies outside the map.
    pub fn boundary(&self) -> Boundary {
        self.medium.boundary()
    }

    /// What deforms.
    pub fn medium(&self) -> Medium {
        self.medium
    }

    fn is_periodic(&self) -> bool {
        self.medium == Medium::Periodic
    }

    fn periodic(&self) -> &PeriodicKernel {
        if let Some(kernel) = self.periodic.get() {
            return kernel;
        }
        // Made outside the cell: see `cached`.
        let kernel = PeriodicKernel::new(self.grid);
        self.periodic.get_or_init(|| kernel)
    }

    /// The constant in the kernel: 0 with free boundaries, [`PeriodicKernel::shift`] with periodic ones.
    pub fn shift(&self) -> f64 {
        if self.is_periodic() { self.periodic().shift() } else { 0.0 }
    }

    /// A lower bound of the eigenvalues of the kernel on every set of cells.
    pub fn smallest_eigenvalue(&self) -> f64 {
        self.smallest_eigenvalue
    }

    /// Displacement of a cell under its own unit pressure.
    pub fn own(&self) -> f64 {
        match self.medium {
            Medium::Periodic => self.periodic().at(0, 0),
            Medium::HalfSpace => influence_of_rectangle(0, 0, self.grid.stretch),
            Medium::HalfPlane => half_plane::influence(0, self.grid),
        }
    }

    /// Kernel at the lags `(0 .. columns, y)`.
    pub fn row(&self, y: usize) -> &[f64] {
        // The periodic kernel is made outside the cell of the row: see `cached`.
        let _ = self.shift();
        self.rows[y].get_or_init(|| {
            let mut row = vec![0.0; self.grid.columns].into_boxed_slice();
            self.fill(y, &mut row);
            row
        })
    }

    /// Writes the kernel at the lags `(0 .., y)`.
    fn fill(&self, y: usize, row: &mut [f64]) {
        match self.medium {
            Medium::Periodic => {
                let kernel = self.periodic();
                for (x, value) in row.iter_mut().enumerate() {
                    *value = kernel.at(x, y);
                }
            }
            Medium::HalfSpace => influence_row(y, self.grid.stretch, row),
            Medium::HalfPlane => {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = half_plane::influence(x, self.grid);
                }
            }
        }
    }

    /// Circular lengths of a transform that is exact on a window: the period itself where the window needs as
    /// much.
    pub fn exact_lengths(&self, window: Window) -> Lengths {
        self.within_period(Lengths::free(window))
    }

    /// Circular lengths for corrections of the pressure, exact up to lags of half `share` of the window
    /// ([`Lengths::shortened`]).
    pub fn shortened_lengths(&self, window: Window, share: f64) -> Lengths {
        self.within_period(Lengths::shortened(window, share))
    }

    /// Circular lengths of the preconditioner of a window.
    pub fn torus_lengths(&self, window: Window) -> Lengths {
        self.within_period(Lengths::torus(window))
    }

    fn within_period(&self, lengths: Lengths) -> Lengths {
        match self.medium {
            Medium::Periodic => lengths.within_period(self.grid),
            Medium::HalfSpace => lengths,
            // One row has no lag along y.
            Medium::HalfPlane => Lengths { y: 1, ..lengths },
        }
    }

    /// Scaled symbol of the operator in double precision.
    pub fn symbol_f64(&self, lengths: Lengths) -> Arc<Vec<f64>> {
        cached(&self.double, lengths, || self.exact_symbol(lengths).scaled())
    }

    /// Scaled symbol of the operator in single precision, rounded from the one in double precision, which
    /// certificates need.
    pub fn symbol_f32(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        let double = self.symbol_f64(lengths);
        cached(&self.single, lengths, || Arc::new(double.iter().map(|&value| value as f32).collect()))
    }

    /// The same for lengths that no operator in double precision takes.
    pub fn shortened_symbol(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        cached(&self.single, lengths, || self.exact_symbol(lengths).scaled())
    }

    /// Scaled inverse symbol of the kernel wrapped on a torus.
    pub fn inverse_symbol(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        cached(&self.inverse, lengths, || {
            let mut symbol = self.exact_symbol(lengths);
            // The wrapped kernel is positive definite; a rounding error in a tiny window must not turn a
            // sign.
            let floor = self.smallest_eigenvalue / 2.0;
            for value in &mut symbol.values {
                *value = 1.0 / value.max(floor);
            }
            symbol.scaled()
        })
    }

    /// Symbol of the kernel on a circular grid, with each lag taken the shorter way round.
    fn exact_symbol(&self, lengths: Lengths) -> Symbol {
        // The periodic kernel is made before threads ask for it.
        let _ = self.shift();
        Symbol::of_rows(lengths, |y, row| self.fill(y, row))
    }
}

/// The most recent symbols.
#[derive(Debug)]
pub(super) struct Kept<T> {
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
pub(super) fn cached<T>(
    kept: &Mutex<Kept<T>>,
    lengths: Lengths,
    make: impl FnOnce() -> Arc<Vec<T>>,
) -> Arc<Vec<T>> {
    let found = lock(kept).find(lengths);
    found.unwrap_or_else(|| {
        let symbol = make();
        lock(kept).keep(lengths, symbol)
    })
}

/// Locks the cache. A panic of another thread while it filled the cache leaves no incomplete entry.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::CellSet;
    use crate::operator::{DirectSum, FftConvolution, InfluenceOperator};
    use approx::assert_relative_eq;
    use std::cell::Cell;

    /// Rounding of transforms of a few hundred points.
    const DOUBLE: f64 = 1e-13;
    /// Single precision of the inverse.
    const SINGLE: f64 = 1e-5;

    #[test]
    fn surfaces_of_one_grid_share_a_table() {
        let grid = Grid::square(37, 37);
        let [free, again, periodic] = [Boundary::Free, Boundary::Free, Boundary::Periodic]
            .map(|boundary| KernelTable::shared(grid, boundary));
        assert!(Arc::ptr_eq(&free, &again) && !Arc::ptr_eq(&free, &periodic));
        for other in [Grid::square(37, 38), Grid::square(38, 37), Grid { stretch: 1.1, ..grid }] {
            assert!(!Arc::ptr_eq(&free, &KernelTable::shared(other, Boundary::Free)), "{other:?}");
        }
        assert_eq!((free.boundary(), periodic.boundary()), (Boundary::Free, Boundary::Periodic));
        assert_eq!((free.grid(), periodic.grid()), (grid, grid));
        assert!(Arc::ptr_eq(&periodic, &KernelTable::shared(grid, Boundary::Periodic)));
        assert_eq!(format!("{free:?}"), "KernelTable(37 x 37 cells, HalfSpace)");
    }

    #[test]
    fn uniform_pressure_sinks_a_periodic_map_by_its_shift_alone() {
        // Zero mean plus c: u = c times the number of cells everywhere, by pairs and by a transform. The
        // period itself is a length that serves, whatever its prime factors.
        for (columns, rows, stretch) in
            [(6, 6, 1.0), (7, 7, 1.0), (16, 16, 1.0), (1, 1, 1.0), (13, 4, 1.0), (5, 12, 1.6)]
        {
            let grid = Grid { columns, rows, stretch };
            let table = KernelTable::shared(grid, Boundary::Periodic);
            if columns == rows {
                assert_relative_eq!(table.shift(), 2.0 / columns as f64);
            }
            let (cells, p) = (CellSet::all(grid), vec![1.0; grid.count()]);
            let lengths = table.exact_lengths(grid.window());
            assert_eq!(lengths, Lengths { x: columns, y: rows }, "the period itself");
            let (mut pairs, mut transform) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            DirectSum(&table).apply(&cells, &p, &cells, &mut pairs);
            FftConvolution::new(grid.window(), lengths, table.symbol_f64(lengths)).apply(
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
        let free = KernelTable::shared(Grid::square(6, 6), Boundary::Free);
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
            let table = KernelTable::shared(grid, Boundary::Free);
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
            FftConvolution::<f32>::new(grid.window(), lengths, table.inverse_symbol(lengths))
                .apply(&cells, &board, &cells, &mut back);
            for (b, p) in back.iter().zip(&board) {
                assert_relative_eq!(*b, p / eigenvalue, max_relative = SINGLE);
            }
        }
    }

    #[test]
    fn nothing_is_locked_while_a_symbol_is_made() {
        // As a thread does that begins another solve while it waits: of other lengths, and of the same.
        let kept = Mutex::new(Kept::<u8>::default());
        let (a, b) = (Lengths { x: 2, y: 2 }, Lengths { x: 4, y: 2 });
        let symbol = cached(&kept, a, || {
            cached(&kept, b, || Arc::new(vec![2]));
            cached(&kept, a, || Arc::new(vec![1]));
            Arc::new(vec![1])
        });
        assert_eq!((*symbol).clone(), [1]);
        assert!(Arc::ptr_eq(&symbol, &cached(&kept, a, || unreachable!())));
        assert_eq!(lock(&kept).made.len(), 2);
    }

    #[test]
    fn the_oldest_symbols_are_dropped_where_they_fill_the_memory() {
        let kept = Mutex::new(Kept::<u8>::default());
        let made = Cell::new(0);
        let get = |x: usize, count: usize| {
            cached(&kept, Lengths { x, y: 2 }, || {
                made.set(made.get() + 1);
                Arc::new(vec![0; count])
            });
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
}
