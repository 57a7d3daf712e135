//! The kernel, free or periodic, and its symbols, shared by all surfaces of one grid size.

use super::convolution::{Convolution, Lengths, Symbol, good_length};
use super::periodic::{self, Periodic};
use crate::cells::Window;
use crate::love::influence;
use contact_model::Boundary;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// Numbers kept at most in the symbols of one kind: 134 MB of f64, four times the largest symbol of 2049 cells a side.
const KEPT: usize = 1 << 24;

/// The kernel at the lags `0 .. n` in both directions and the symbols made from it.
///
/// Rows and symbols are made when they are first needed: a contact of three cells does not pay for a table of four million.
/// What it holds depends on the grid alone, so that sharing it changes no result.
pub struct Table {
    cells: usize,
    boundary: Boundary,
    /// Made at the first use where the square repeats itself.
    periodic: OnceLock<Periodic>,
    rows: Vec<OnceLock<Box<[f64]>>>,
    double: Mutex<Kept<f64>>,
    single: Mutex<Kept<f32>>,
    inverse: Mutex<Kept<f32>>,
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Table({} cells, {:?})", self.cells, self.boundary)
    }
}

impl Table {
    /// The table of a grid of `cells` a side; one table serves all surfaces alive at the same time.
    pub fn shared(cells: usize, boundary: Boundary) -> Arc<Self> {
        static LIVE: Mutex<Vec<Weak<Table>>> = Mutex::new(Vec::new());
        let mut live = lock(&LIVE);
        live.retain(|t| t.strong_count() > 0);
        if let Some(table) =
            live.iter().filter_map(Weak::upgrade).find(|t| (t.cells, t.boundary) == (cells, boundary))
        {
            return table;
        }
        let table = Arc::new(Self::new(cells, boundary));
        live.push(Arc::downgrade(&table));
        table
    }

    fn new(cells: usize, boundary: Boundary) -> Self {
        Self {
            cells,
            boundary,
            periodic: OnceLock::new(),
            rows: (0..cells).map(|_| OnceLock::new()).collect(),
            double: Mutex::default(),
            single: Mutex::default(),
            inverse: Mutex::default(),
        }
    }

    /// What lies outside the square.
    pub fn boundary(&self) -> Boundary {
        self.boundary
    }

    /// The constant in the kernel: nothing with free boundaries, [`periodic::shift`] with periodic ones.
    pub fn shift(&self) -> f64 {
        if self.boundary == Boundary::Periodic { periodic::shift(self.cells) } else { 0.0 }
    }

    /// Kernel at a lag.
    fn at(&self, x: usize, y: usize) -> f64 {
        match self.boundary {
            Boundary::Periodic => self.periodic.get_or_init(|| Periodic::new(self.cells)).at(x, y),
            _ => influence(x, y),
        }
    }

    /// Kernel at the lags `(0 .. cells, y)`.
    pub fn row(&self, y: usize) -> &[f64] {
        self.rows[y].get_or_init(|| (0..self.cells).map(|x| self.at(x, y)).collect())
    }

    /// Shortest good lengths of a transform that is exact on a window: the period itself where it is one.
    pub fn lengths(&self, window: Window) -> Lengths {
        let free = Lengths::free(window);
        if self.boundary != Boundary::Periodic || good_length(self.cells) != self.cells {
            return free;
        }
        Lengths { x: free.x.min(self.cells), y: free.y.min(self.cells) }
    }

    /// Scaled symbol of the operator in double precision.
    pub fn symbol_f64(&self, lengths: Lengths) -> Arc<Vec<f64>> {
        lock(&self.double).get(lengths, || Convolution::<f64>::scaled(&self.symbol(lengths)))
    }

    /// Scaled symbol of the operator in single precision.
    pub fn symbol_f32(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        lock(&self.single).get(lengths, || Convolution::<f32>::scaled(&self.symbol(lengths)))
    }

    /// Scaled inverse symbol of the kernel wrapped on a torus.
    pub fn inverse_symbol(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        lock(&self.inverse).get(lengths, || {
            let mut symbol = self.symbol(lengths);
            // The wrapped kernel is positive definite; a rounding error in a tiny window must not turn a sign.
            let floor = crate::love::SMALLEST_EIGENVALUE / 2.0;
            for value in &mut symbol.values {
                *value = 1.0 / value.max(floor);
            }
            Convolution::<f32>::scaled(&symbol)
        })
    }

    /// Symbol of the kernel at the lags of a circular grid, each taken the shorter way round.
    fn symbol(&self, lengths: Lengths) -> Symbol {
        Symbol::of_kernel(lengths, |x, y| self.at(x, y))
    }
}

/// The symbols made last.
#[derive(Default)]
struct Kept<T> {
    made: Vec<(Lengths, Arc<Vec<T>>)>,
}

impl<T> Kept<T> {
    fn get(&mut self, lengths: Lengths, make: impl FnOnce() -> Arc<Vec<T>>) -> Arc<Vec<T>> {
        if let Some((_, symbol)) = self.made.iter().find(|(l, _)| *l == lengths) {
            return Arc::clone(symbol);
        }
        let symbol = make();
        self.made.push((lengths, Arc::clone(&symbol)));
        while self.made.len() > 1 && self.made.iter().map(|(_, s)| s.len()).sum::<usize>() > KEPT {
            self.made.remove(0);
        }
        symbol
    }
}

/// Locks; a panic of another thread while it filled a cache leaves nothing half-made behind.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cells::CellSet;
    use crate::operator::direct;
    use approx::assert_relative_eq;
    use std::cell::Cell;

    /// Rounding of transforms of a few hundred points.
    const DOUBLE: f64 = 1e-13;
    /// Single precision of the inverse.
    const SINGLE: f64 = 1e-5;

    fn all(side: usize) -> CellSet {
        CellSet::new(side, (0..(side * side) as u32).collect())
    }

    #[test]
    fn surfaces_of_one_grid_share_a_table() {
        let [free, again, periodic] =
            [Boundary::Free, Boundary::Free, Boundary::Periodic].map(|b| Table::shared(37, b));
        assert!(Arc::ptr_eq(&free, &again));
        assert!(!Arc::ptr_eq(&free, &periodic) && !Arc::ptr_eq(&free, &Table::shared(38, Boundary::Free)));
        assert_eq!((free.boundary(), periodic.boundary()), (Boundary::Free, Boundary::Periodic));
        assert!(Arc::ptr_eq(&periodic, &Table::shared(37, Boundary::Periodic)));
        assert_eq!(format!("{free:?}"), "Table(37 cells, Free)");
    }

    #[test]
    fn uniform_pressure_sinks_a_periodic_square_by_its_shift_alone() {
        // Zero mean plus c: u = c N^2 everywhere, by pairs and by a transform. 6 and 16 are lengths of a transform, 7 is not.
        for side in [6, 7, 16] {
            let table = Table::shared(side, Boundary::Periodic);
            assert_relative_eq!(table.shift(), 2.0 / side as f64);
            let (cells, p) = (all(side), vec![1.0; side * side]);
            let Some(window) = cells.window() else { unreachable!() };
            let lengths = table.lengths(window);
            if side == 7 {
                assert_eq!(lengths, Lengths::free(window));
            } else {
                assert_eq!(lengths, Lengths { x: side, y: side }, "the period itself");
            }
            let (mut pairs, mut transform) = (vec![0.0; p.len()], vec![0.0; p.len()]);
            direct::apply(&table, &cells, &p, &cells, &mut pairs);
            Convolution::new(window, lengths, table.symbol_f64(lengths)).apply(
                &cells,
                &p,
                &cells,
                &mut transform,
            );
            for (a, b) in pairs.iter().zip(&transform) {
                assert_relative_eq!(*a, 2.0 * side as f64, max_relative = DOUBLE);
                assert_relative_eq!(*b, 2.0 * side as f64, max_relative = DOUBLE);
            }
        }
        let free = Table::shared(6, Boundary::Free);
        assert!(free.shift() == 0.0);
        let window = Window { x: 0, y: 0, width: 6, height: 6 };
        assert_eq!(free.lengths(window), Lengths { x: 10, y: 10 });
    }

    #[test]
    fn the_inverse_is_one_over_the_eigenvalue_of_a_wave() {
        // The checkerboard on a torus of 16 cells: the smallest eigenvalue, which the floor of the inverse must not touch.
        let side = 16;
        let table = Table::shared(side, Boundary::Free);
        let cells = all(side);
        let Some(window) = cells.window() else { unreachable!() };
        let lengths = Lengths::torus(window);
        assert_eq!(lengths, Lengths { x: side, y: side });
        let board: Vec<f64> =
            (0..side * side).map(|k| if (k + k / side).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
        let lag = |x: usize| x.min(side - x);
        let eigenvalue: f64 =
            (0..side * side).map(|k| board[k] * influence(lag(k % side), lag(k / side))).sum();
        assert!((eigenvalue / crate::love::SMALLEST_EIGENVALUE - 1.0).abs() < 0.01, "{eigenvalue}");
        let mut back = vec![0.0; board.len()];
        Convolution::<f32>::new(window, lengths, table.inverse_symbol(lengths))
            .apply(&cells, &board, &cells, &mut back);
        for (b, p) in back.iter().zip(&board) {
            assert_relative_eq!(*b, p / eigenvalue, max_relative = SINGLE);
        }
    }

    #[test]
    fn the_oldest_symbols_are_dropped_where_they_fill_the_memory() {
        let mut kept = Kept::<u8>::default();
        let made = Cell::new(0);
        let mut get = |x: usize, count: usize| {
            kept.get(Lengths { x, y: 2 }, || {
                made.set(made.get() + 1);
                Arc::new(vec![0; count])
            });
            made.get()
        };
        assert_eq!((get(2, KEPT / 2), get(4, KEPT / 2)), (1, 2));
        assert_eq!((get(2, 0), get(4, 0)), (2, 2), "what just fits is kept");
        assert_eq!(get(6, 1), 3);
        assert_eq!((get(4, 0), get(6, 0)), (3, 3), "one too much: only the oldest went");
        assert_eq!((get(2, KEPT + 1), get(2, 0)), (4, 4), "the last one stays whatever its size");
        assert_eq!(get(6, 1), 5);
        const { assert!(KEPT >= 2049 * 2049, "a grid of 2049 cells a side finds its symbol again") };
    }
}
