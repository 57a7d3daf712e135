//! The elastic operator `u = K p` between sets of cells, in scaled units (`u_i = sum_j I(i - j) p_j`).
//!
//! [`direct`] is the exact sum over pairs of cells, [`convolution`] the FFT on a window, [`dense`] the factor of a small set.
//! [`Operators`] holds the ones that a surface needs and makes each when it is first asked for.

pub mod convolution;
pub mod dense;
pub mod direct;
mod table;

pub use table::Table;

use crate::cells::{CellSet, Window};
use crate::strategy;
use convolution::{Convolution, Lengths};
use std::sync::Arc;

/// The operators of one surface, with the count of what they did.
#[derive(Debug)]
pub struct Operators {
    table: Arc<Table>,
    exact: Option<Convolution<f64>>,
    fast: Option<Convolution<f32>>,
    inverse: Option<Convolution<f32>>,
    /// Applications of K so far, all precisions together.
    pub applications: usize,
}

impl Operators {
    /// Nothing is built yet.
    pub fn new(table: Arc<Table>) -> Self {
        Self { table, exact: None, fast: None, inverse: None, applications: 0 }
    }

    /// The kernel table.
    pub fn table(&self) -> &Table {
        &self.table
    }

    /// `u = K p` in double precision without approximation: direct sums or the FFT, whichever is cheaper.
    pub fn exact(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet) -> Vec<f64> {
        let mut u = vec![0.0; targets.len()];
        if sources.is_empty() || targets.is_empty() {
            return u;
        }
        self.applications += 1;
        let window = union(sources, targets);
        if strategy::direct_is_cheaper(sources.len(), targets.len(), Lengths::free(window)) {
            direct::apply(&self.table, sources, p, targets, &mut u);
        } else {
            let table = &self.table;
            let operator = planned(&mut self.exact, window, table, |t, w| {
                let lengths = Lengths::free(w);
                Convolution::new(w, lengths, t.symbol_f64(lengths))
            });
            operator.apply(sources, p, targets, &mut u);
        }
        u
    }

    /// `u = K p` on the same set in single precision, for use inside an iteration that is checked with [`Self::exact`].
    pub fn fast(&mut self, set: &CellSet, p: &[f64], u: &mut [f64]) {
        self.applications += 1;
        let Some(window) = set.window() else { return };
        if strategy::direct_is_cheaper(set.len(), set.len(), Lengths::free(window)) {
            direct::apply(&self.table, set, p, set, u);
        } else {
            let operator = planned(&mut self.fast, window, &self.table, |t, w| {
                let lengths = Lengths::free(w);
                Convolution::new(w, lengths, t.symbol_f32(lengths))
            });
            operator.apply(set, p, set, u);
        }
    }

    /// `out = B r` on the same set: the inverse of the kernel wrapped on a torus around the set (about |q| / 2 pi).
    ///
    /// Positive definite. A quarter of the cost of K or less.
    pub fn inverse(&mut self, set: &CellSet, r: &[f64], out: &mut [f64]) {
        let Some(window) = set.window() else { return };
        let operator = planned(&mut self.inverse, window, &self.table, |t, w| {
            let lengths = Lengths::torus(w);
            Convolution::new(w, lengths, t.inverse_symbol(lengths))
        });
        operator.apply(set, r, set, out);
    }
}

impl Operators {
    /// What was used for a state, in one short phrase.
    pub fn describe(&self, solved: &crate::active_set::Solved) -> String {
        if solved.q.is_some() {
            return format!("dense {}", solved.contact.len());
        }
        match &self.fast {
            Some(fast) => format!("fft {} x {}, f32 in f64", fast.lengths().x, fast.lengths().y),
            None => format!("direct {}", solved.contact.len()),
        }
    }
}

/// The convolution of `slot` where its window holds the wanted one without waste, else a new one.
fn planned<'a, T: convolution::Real>(
    slot: &'a mut Option<Convolution<T>>,
    window: Window,
    table: &Table,
    plan: impl Fn(&Table, Window) -> Convolution<T>,
) -> &'a mut Convolution<T> {
    let fits = slot.as_ref().is_some_and(|c| holds(c.window(), window) && !wasteful(c.window(), window));
    if !fits {
        *slot = None;
    }
    slot.get_or_insert_with(|| plan(table, window))
}

fn holds(outer: Window, inner: Window) -> bool {
    outer.x <= inner.x
        && outer.y <= inner.y
        && outer.x + outer.width >= inner.x + inner.width
        && outer.y + outer.height >= inner.y + inner.height
}

/// Making a new plan costs about three applications, so a window that is only a little too large is kept.
fn wasteful(outer: Window, inner: Window) -> bool {
    10 * inner.width * inner.height < 6 * outer.width * outer.height
}

fn union(a: &CellSet, b: &CellSet) -> Window {
    match (a.window(), b.window()) {
        (Some(a), Some(b)) => {
            let (x, y) = (a.x.min(b.x), a.y.min(b.y));
            let width = (a.x + a.width).max(b.x + b.width) - x;
            let height = (a.y + a.height).max(b.y + b.height) - y;
            Window { x, y, width, height }
        }
        (Some(w), None) | (None, Some(w)) => w,
        (None, None) => Window { x: 0, y: 0, width: 1, height: 1 },
    }
}
