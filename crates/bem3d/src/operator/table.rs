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
