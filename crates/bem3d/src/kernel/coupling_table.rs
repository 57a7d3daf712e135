//! The kernel that couples normal and tangential displacements, and its symbols.

use super::periodic::{Integrand, symbol};
use super::symbol::{Parity, Symbol};
use super::table::Medium;
use super::tangential::coupling;
use crate::geometry::{Grid, Lengths, Window};
use std::sync::{Arc, OnceLock};

/// The kernel `J = (J_x, J_y)` of a grid, the integrals of `(x, y)/r^2` over a cell: with Dundurs' beta,
/// tractions cause the normal displacement `u_z = beta (J_x q_x + J_y q_y)` and pressures the tangential one
/// `-beta J p`, in the units of [`super::TangentialTable`]. With periodic boundaries its mean is zero.
#[derive(Debug)]
pub struct CouplingTable {
    grid: Grid,
    medium: Medium,
    /// With periodic boundaries: `J_x`, and `J_y` with the lags exchanged, at the lags `0 ..= n/2`.
    periodic: OnceLock<[Vec<f64>; 2]>,
}

impl CouplingTable {
    /// The table of a grid.
    pub fn new(grid: Grid, medium: Medium) -> Self {
        Self { grid, medium, periodic: OnceLock::new() }
    }

    /// `(J_x, J_y)` at positive lags; `J_x` is odd along x and even along y.
    pub fn lag(&self, x: usize, y: usize) -> [f64; 2] {
        let stretch = self.grid.stretch;
        if self.medium != Medium::Periodic {
            return [coupling(x, y, stretch), coupling(y, x, stretch.recip())];
        }
        let Grid { columns, rows, .. } = self.grid;
        let fold = |lag: usize, period: usize| {
            let lag = lag % period;
            if 2 * lag > period { (period - lag, -1.0) } else { (lag, 1.0) }
        };
        let ((x, sign_x), (y, sign_y)) = (fold(x, columns), fold(y, rows));
        let [along_x, along_y] = self.periodic();
        [sign_x * along_x[x * (rows / 2 + 1) + y], sign_y * along_y[y * (columns / 2 + 1) + x]]
    }

    fn periodic(&self) -> &[Vec<f64>; 2] {
        if let Some(made) = self.periodic.get() {
            return made;
        }
        // Made outside the cell: threads share the work.
        let Grid { columns, rows, stretch } = self.grid;
        let turned = Grid { columns: rows, rows: columns, stretch: stretch.recip() };
        let made = [self.grid, turned].map(|grid| {
            let (half, points) = (grid.rows / 2 + 1, grid.count() as f64);
            let waves = symbol(grid, Integrand::Coupling);
            let lengths = Lengths { x: grid.columns, y: grid.rows };
            Symbol::with_parity(lengths, [Parity::Odd, Parity::Even], |ky, row| {
                for (kx, value) in row.iter_mut().enumerate() {
                    *value = waves[kx * half + ky] / points;
                }
            })
            .values
        });
        self.periodic.get_or_init(|| made)
    }

    /// Circular lengths of a transform that is exact on a window.
    pub fn exact_lengths(&self, window: Window) -> Lengths {
        let lengths = Lengths::reaching(window, usize::MAX);
        if self.medium == Medium::Periodic { lengths.within_period(self.grid) } else { lengths }
    }

    /// The sums of `f sin` of both components on the half spectrum quarter, `[kx * (ly / 2 + 1) + ky]`, over the
    /// number of points: `-i` times them are the symbols.
    pub fn symbol(&self, lengths: Lengths) -> Arc<Vec<[f64; 2]>> {
        let _ = self.lag(0, 0);
        let part = |component: usize, parity: [Parity; 2]| {
            Symbol::with_parity(lengths, parity, |y, row| {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = self.lag(x, y)[component];
                }
            })
            .values
        };
        let (x, y) = (part(0, [Parity::Odd, Parity::Even]), part(1, [Parity::Even, Parity::Odd]));
        let norm = 1.0 / lengths.points() as f64;
        Arc::new(x.into_iter().zip(y).map(|(x, y)| [x * norm, y * norm]).collect())
    }
}
