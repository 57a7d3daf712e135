//! The entries of a periodic kernel at the lags of one period, from their values at the waves of the grid.

use super::symbol::{Parity, Symbol};
use crate::geometry::{Grid, Lengths};

/// Entries at the lags `0 ..= n/2` in both directions; other lags follow by parity.
#[derive(Debug)]
pub struct Period<const E: usize> {
    grid: Grid,
    parities: [[Parity; 2]; E],
    /// Whether x and y may be exchanged.
    symmetric: bool,
    /// Values of each entry, `[x * (rows / 2 + 1) + y]`.
    quarters: [Vec<f64>; E],
    shift: f64,
}

impl<const E: usize> Period<E> {
    /// From the symbol of each entry at the waves of a grid, `[kx * (rows / 2 + 1) + ky]`, without its factor
    /// `-i` in each direction in which it is odd.
    ///
    /// Cost: a real transform of the grid for each entry.
    pub fn from_waves(grid: Grid, parities: [[Parity; 2]; E], waves: [Vec<f64>; E]) -> Self {
        let (half, points) = (grid.rows / 2 + 1, grid.count() as f64);
        let lengths = Lengths { x: grid.columns, y: grid.rows };
        let mut entry = 0;
        let quarters = waves.map(|waves| {
            // The transform is its own inverse but for the number of points and, of a kernel that is odd in
            // both directions, for the sign of (-i)^2.
            let parity = parities[entry];
            let points = if parity == [Parity::Odd; 2] { -points } else { points };
            entry += 1;
            let mut lags = Symbol::with_parity(lengths, parity, |ky, row| {
                for (kx, value) in row.iter_mut().enumerate() {
                    *value = waves[kx * half + ky];
                }
            });
            for value in &mut lags.values {
                *value /= points;
            }
            lags.values
        });
        Self { grid, parities, symmetric: false, quarters, shift: 0.0 }
    }

    /// The same with a constant added to the entries that are even in both lags.
    ///
    /// Displacements are measured from their mean. The constant makes the kernel definite; it changes neither
    /// the tractions under given forces nor gaps and slips, but only the place from which displacements are
    /// measured.
    pub fn raised_by(mut self, shift: f64) -> Self {
        self.shift = shift;
        for (quarter, parity) in self.quarters.iter_mut().zip(self.parities) {
            if parity == [Parity::Even; 2] {
                for value in quarter {
                    *value += shift;
                }
            }
        }
        self
    }

    /// The same of a kernel in which x and y may be exchanged, to the last bit.
    pub fn symmetric(self) -> Self {
        Self { symmetric: true, ..self }
    }

    /// The smallest value of an entry.
    pub fn lowest(&self, entry: usize) -> f64 {
        self.quarters[entry].iter().copied().fold(f64::INFINITY, f64::min)
    }

    /// The constant that was added.
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// An entry at a lag. Beyond half a period the lag the other way round is taken.
    pub fn at(&self, entry: usize, x: usize, y: usize) -> f64 {
        let fold = |lag: usize, period: usize, parity: Parity| {
            let lag = lag % period;
            let sign = if parity == Parity::Odd { -1.0 } else { 1.0 };
            if 2 * lag > period { (period - lag, sign) } else { (lag, 1.0) }
        };
        let [along_x, along_y] = self.parities[entry];
        let (x, sign_x) = fold(x, self.grid.columns, along_x);
        let (y, sign_y) = fold(y, self.grid.rows, along_y);
        let (x, y) = if self.symmetric { (x.max(y), x.min(y)) } else { (x, y) };
        sign_x * sign_y * self.quarters[entry][x * (self.grid.rows / 2 + 1) + y]
    }
}
