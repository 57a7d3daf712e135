//! Love's kernel and its symbols, shared by all surfaces of one grid size.

use super::convolution::{Convolution, Lengths, Symbol};
use crate::love::influence;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError, Weak};

/// Numbers kept at most in the symbols of one kind: 134 MB of f64, four times the largest symbol of 2049 cells a side.
const KEPT: usize = 1 << 24;

/// Love's kernel at the lags `0 .. n` in both directions and the symbols made from it.
///
/// Rows and symbols are made when they are first needed: a contact of three cells does not pay for a table of four million.
/// What it holds depends on the grid alone, so that sharing it changes no result.
pub struct Table {
    cells: usize,
    rows: Vec<OnceLock<Box<[f64]>>>,
    double: Mutex<Kept<f64>>,
    single: Mutex<Kept<f32>>,
    inverse: Mutex<Kept<f32>>,
}

impl fmt::Debug for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Table({} cells)", self.cells)
    }
}

impl Table {
    /// The table of a grid of `cells` a side; one table serves all surfaces alive at the same time.
    pub fn shared(cells: usize) -> Arc<Self> {
        static LIVE: Mutex<Vec<Weak<Table>>> = Mutex::new(Vec::new());
        let mut live = lock(&LIVE);
        live.retain(|t| t.strong_count() > 0);
        if let Some(table) = live.iter().filter_map(Weak::upgrade).find(|t| t.cells == cells) {
            return table;
        }
        let table = Arc::new(Self::new(cells));
        live.push(Arc::downgrade(&table));
        table
    }

    fn new(cells: usize) -> Self {
        Self {
            cells,
            rows: (0..cells).map(|_| OnceLock::new()).collect(),
            double: Mutex::default(),
            single: Mutex::default(),
            inverse: Mutex::default(),
        }
    }

    /// Kernel at the lags `(0 .. cells, y)`.
    pub fn row(&self, y: usize) -> &[f64] {
        self.rows[y].get_or_init(|| (0..self.cells).map(|x| influence(x, y)).collect())
    }

    /// Scaled symbol of the free operator in double precision.
    pub fn symbol_f64(&self, lengths: Lengths) -> Arc<Vec<f64>> {
        lock(&self.double).get(lengths, || Convolution::<f64>::scaled(&free_symbol(lengths)))
    }

    /// Scaled symbol of the free operator in single precision.
    pub fn symbol_f32(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        lock(&self.single).get(lengths, || Convolution::<f32>::scaled(&free_symbol(lengths)))
    }

    /// Scaled inverse symbol of the kernel wrapped on a torus.
    pub fn inverse_symbol(&self, lengths: Lengths) -> Arc<Vec<f32>> {
        lock(&self.inverse).get(lengths, || {
            let mut symbol = free_symbol(lengths);
            // The wrapped kernel is positive definite; a rounding error in a tiny window must not turn a sign.
            let floor = crate::love::SMALLEST_EIGENVALUE / 2.0;
            for value in &mut symbol.values {
                *value = 1.0 / value.max(floor);
            }
            Convolution::<f32>::scaled(&symbol)
        })
    }
}

/// Symbol of the kernel at the lags of a circular grid, each taken the shorter way round.
fn free_symbol(lengths: Lengths) -> Symbol {
    Symbol::of_kernel(lengths, influence)
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
