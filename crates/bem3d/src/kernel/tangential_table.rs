//! The tangential kernel of one grid and pair of bodies, and its symbols.

use super::love::{influence_of_rectangle, smallest_eigenvalue};
use super::periodic::{Integrand, symbol};
use super::symbol::{Parity, Symbol};
use super::table::{Kept, Medium, cached, lock};
use super::tangential::{across, along_x, along_y};
use crate::geometry::{Grid, Lengths, Window};
use crate::real::Real;
use std::fmt;
use std::sync::{Arc, Mutex, OnceLock, Weak};

/// The constant in the periodic kernel, over the side of the square with as many cells.
const SHIFT: f64 = 2.0;

/// An entry of the influence tensor of tractions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Entry {
    /// Displacement along x under a traction along x.
    XX,
    /// Displacement along y under a traction along y.
    YY,
    /// Displacement along one axis under a traction along the other; odd in both lags.
    XY,
}

impl Entry {
    fn parity(self) -> [Parity; 2] {
        match self {
            Self::XX | Self::YY => [Parity::Even; 2],
            Self::XY => [Parity::Odd; 2],
        }
    }
}

/// The kernel `K = I + c M` of tangential tractions on a grid: I are the influence coefficients of pressure,
/// M the integrals of `(x^2, y^2, x y)/r^3` (see `kernel/tangential.rs`), c the constant of the bodies,
/// `E* sum nu/(2 G)`, in [0, 1].
///
/// So `u_i = (h_c / (pi E*)) sum_j K(i - j) q_j`, the relative displacement of both bodies. With periodic
/// boundaries displacements are measured from their mean, except for a constant ([`TangentialTable::shift`])
/// in both diagonal entries, which makes the kernel definite.
pub struct TangentialTable {
    grid: Grid,
    medium: Medium,
    compliance: f64,
    /// Entries at the lags `0 ..= n/2`, with periodic boundaries.
    periodic: OnceLock<[Vec<f64>; 3]>,
    rows: Vec<OnceLock<Box<[[f64; 3]]>>>,
    double: Mutex<Kept<[f64; 3]>>,
    single: Mutex<Kept<[f32; 3]>>,
    inverse: Mutex<Kept<[f32; 3]>>,
}

impl fmt::Debug for TangentialTable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Grid { columns, rows, .. } = self.grid;
        write!(f, "TangentialTable({columns} x {rows} cells, {:?}, c = {})", self.medium, self.compliance)
    }
}

impl TangentialTable {
    /// The table of a grid and of bodies of the constant `compliance`; one table serves all surfaces alive at
    /// the same time. There is no table for a half-plane, which is treated as a half-space.
    pub fn shared(grid: Grid, medium: impl Into<Medium>, compliance: f64) -> Arc<Self> {
        static LIVE: Mutex<Vec<Weak<TangentialTable>>> = Mutex::new(Vec::new());
        let medium = medium.into();
        let mut live = lock(&LIVE);
        live.retain(|table| table.strong_count() > 0);
        let same = |table: &Arc<Self>| {
            table.grid == grid && table.medium == medium && table.compliance.to_bits() == compliance.to_bits()
        };
        if let Some(table) = live.iter().filter_map(Weak::upgrade).find(same) {
            return table;
        }
        let table = Arc::new(Self {
            grid,
            medium,
            compliance,
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

    fn is_periodic(&self) -> bool {
        self.medium == Medium::Periodic
    }

    /// The constant in the diagonal entries: 0 with free boundaries.
    pub fn shift(&self) -> f64 {
        if self.is_periodic() { SHIFT / (self.grid.count() as f64).sqrt() } else { 0.0 }
    }

    /// A lower bound of the eigenvalues on every set of cells: that of the normal kernel. For a wave along
    /// its own direction the contribution of M vanishes in the continuum and is only slightly negative on the
    /// lattice: the smallest eigenvalue of K is not below that of I by more than 2e-5 of it, for c = 0.43 and
    /// 1 and sides of a cell 1 : 1 to 1 : 9.
    pub fn smallest_eigenvalue(&self) -> f64 {
        (1.0 - 1e-4) * smallest_eigenvalue(self.grid.stretch)
    }

    /// The larger displacement of a cell along its own unit traction.
    pub fn own(&self) -> f64 {
        let [xx, yy, _] = self.lag(0, 0);
        xx.max(yy)
    }

    /// Entries `[xx, yy, xy]` at positive lags.
    pub fn lag(&self, x: usize, y: usize) -> [f64; 3] {
        [Entry::XX, Entry::YY, Entry::XY].map(|entry| self.entry(entry, x, y))
    }

    /// Entries `[xx, yy, xy]` at the lags `(0 .. columns, y)`.
    pub fn row(&self, y: usize) -> &[[f64; 3]] {
        // Made outside the cell of the row: see `cached`.
        self.prepare();
        self.rows[y].get_or_init(|| (0..self.grid.columns).map(|x| self.lag(x, y)).collect())
    }

    fn entry(&self, entry: Entry, x: usize, y: usize) -> f64 {
        if self.is_periodic() {
            return self.periodic_entry(entry, x, y);
        }
        let (c, stretch) = (self.compliance, self.grid.stretch);
        match entry {
            Entry::XX => influence_of_rectangle(x, y, stretch) + c * along_x(x, y, stretch),
            Entry::YY => influence_of_rectangle(x, y, stretch) + c * along_y(x, y, stretch),
            Entry::XY => c * across(x, y, stretch),
        }
    }

    fn periodic_entry(&self, entry: Entry, x: usize, y: usize) -> f64 {
        let Grid { columns, rows, .. } = self.grid;
        let fold = |lag: usize, period: usize| {
            let lag = lag % period;
            if 2 * lag > period { (period - lag, -1.0) } else { (lag, 1.0) }
        };
        let ((x, sign_x), (y, sign_y)) = (fold(x, columns), fold(y, rows));
        let value = self.periodic()[entry as usize][x * (rows / 2 + 1) + y];
        if entry == Entry::XY { sign_x * sign_y * value } else { value }
    }

    /// Makes the parts for which threads would otherwise wait.
    fn prepare(&self) {
        if self.is_periodic() {
            self.periodic();
        }
    }

    /// From the symbol at the waves of the grid, as [`super::periodic::PeriodicKernel`]: the transform is its
    /// own inverse but for the number of points and, of an odd kernel, for the sign of `(-i)^2`.
    fn periodic(&self) -> &[Vec<f64>; 3] {
        if let Some(made) = self.periodic.get() {
            return made;
        }
        // Made outside the cell: see `cached`.
        let (grid, c) = (self.grid, self.compliance);
        let normal = symbol(grid, Integrand::Normal);
        let entries =
            [(Integrand::AlongX, Entry::XX), (Integrand::AlongY, Entry::YY), (Integrand::Across, Entry::XY)];
        let made = entries.map(|(integrand, entry)| {
            let shear = symbol(grid, integrand);
            let (half, points) = (grid.rows / 2 + 1, grid.count() as f64);
            let lengths = Lengths { x: grid.columns, y: grid.rows };
            let sign = if entry == Entry::XY { -1.0 } else { 1.0 };
            let mut lags = Symbol::with_parity(lengths, entry.parity(), |ky, row| {
                for (kx, value) in row.iter_mut().enumerate() {
                    let at = kx * half + ky;
                    let normal = if entry == Entry::XY { 0.0 } else { normal[at] };
                    *value = sign * (normal + c * shear[at]) / points;
                }
            });
            if entry != Entry::XY {
                lags.values.iter_mut().for_each(|value| *value += self.shift());
            }
            lags.values
        });
        self.periodic.get_or_init(|| made)
    }

    /// Circular lengths of a transform that is exact on a window.
    ///
    /// An even kernel needs `2 (n - 1)` cells; the off-diagonal entry, which is odd, would coincide with its
    /// negative at lag `n - 1`.
    pub fn exact_lengths(&self, window: Window) -> Lengths {
        self.within_period(Lengths::reaching(window, usize::MAX))
    }

    /// Circular lengths for corrections of the tractions ([`Lengths::shortened`]).
    pub fn shortened_lengths(&self, window: Window, share: f64) -> Lengths {
        let (short, exact) = (Lengths::shortened(window, share), Lengths::reaching(window, usize::MAX));
        self.within_period(Lengths { x: short.x.min(exact.x), y: short.y.min(exact.y) })
    }

    /// Circular lengths of the preconditioner of a window.
    pub fn torus_lengths(&self, window: Window) -> Lengths {
        self.within_period(Lengths::torus(window))
    }

    fn within_period(&self, lengths: Lengths) -> Lengths {
        if self.is_periodic() { lengths.within_period(self.grid) } else { lengths }
    }

    /// Scaled symbol of the operator in double precision.
    pub fn symbol_f64(&self, lengths: Lengths) -> Arc<Vec<[f64; 3]>> {
        cached(&self.double, lengths, || self.tensor(lengths).scaled())
    }

    /// Scaled symbol of the operator in single precision, rounded from the one in double precision.
    pub fn symbol_f32(&self, lengths: Lengths) -> Arc<Vec<[f32; 3]>> {
        let double = self.symbol_f64(lengths);
        cached(&self.single, lengths, || {
            Arc::new(double.iter().map(|entries| entries.map(|value| value as f32)).collect())
        })
    }

    /// The same for lengths that no operator in double precision takes.
    pub fn shortened_symbol(&self, lengths: Lengths) -> Arc<Vec<[f32; 3]>> {
        cached(&self.single, lengths, || self.tensor(lengths).scaled())
    }

    /// Scaled inverse symbol of the kernel wrapped on a torus.
    pub fn inverse_symbol(&self, lengths: Lengths) -> Arc<Vec<[f32; 3]>> {
        cached(&self.inverse, lengths, || {
            self.tensor(lengths).inverse(self.smallest_eigenvalue() / 2.0).scaled()
        })
    }

    /// Symbol of the kernel at the lags of a circular grid, each taken the shorter way round.
    fn tensor(&self, lengths: Lengths) -> TensorSymbol {
        self.prepare();
        let part = |entry: Entry| {
            Symbol::with_parity(lengths, entry.parity(), |y, row| {
                for (x, value) in row.iter_mut().enumerate() {
                    *value = self.entry(entry, x, y);
                }
            })
            .values
        };
        let (xx, yy, xy) = (part(Entry::XX), part(Entry::YY), part(Entry::XY));
        // An odd kernel has the square of -i.
        let values = xx.into_iter().zip(yy).zip(xy).map(|((xx, yy), xy)| [xx, yy, -xy]).collect();
        TensorSymbol { lengths, values }
    }
}

/// Real symmetric symbol `[xx, yy, xy]` on the half spectrum quarter, `[kx * (ly / 2 + 1) + ky]`; the
/// off-diagonal entry changes its sign with that of a wave.
#[derive(Debug, Clone)]
pub struct TensorSymbol {
    lengths: Lengths,
    values: Vec<[f64; 3]>,
}

impl TensorSymbol {
    /// The inverse at each wave. A rounding error in a tiny window must not turn a sign: eigenvalues below
    /// `floor` are raised to it, both together.
    fn inverse(mut self, floor: f64) -> Self {
        for value in &mut self.values {
            let [xx, yy, xy] = *value;
            let smallest = f64::midpoint(xx, yy) - (0.5 * (xx - yy)).hypot(xy);
            let raised = (floor - smallest).max(0.0);
            let (xx, yy) = (xx + raised, yy + raised);
            let determinant = xx * yy - xy * xy;
            *value = [yy / determinant, xx / determinant, -xy / determinant];
        }
        self
    }

    /// The values over the number of points, in the precision of a convolution.
    fn scaled<T: Real>(&self) -> Arc<Vec<[T; 3]>> {
        let norm = 1.0 / self.lengths.points() as f64;
        Arc::new(self.values.iter().map(|entries| entries.map(|value| T::of(value * norm))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::Boundary;

    #[test]
    fn surfaces_of_one_grid_and_pair_share_a_table() {
        let grid = Grid::square(21, 20);
        let table = |boundary, c| TangentialTable::shared(grid, boundary, c);
        let (one, two) = (table(Boundary::Free, 0.3), table(Boundary::Free, 0.3));
        assert!(Arc::ptr_eq(&one, &two));
        assert!(!Arc::ptr_eq(&one, &table(Boundary::Free, 0.31)));
        assert!(!Arc::ptr_eq(&one, &table(Boundary::Periodic, 0.3)));
        assert_eq!(format!("{one:?}"), "TangentialTable(21 x 20 cells, HalfSpace, c = 0.3)");
    }

    #[test]
    fn periodic_entries_are_sums_over_images() {
        // As for the normal kernel: differences of the kernel, images in a square, its edges by half.
        for (columns, rows, stretch, [mx, my]) in
            [(4_usize, 4_usize, 1.0, [40_isize, 40_isize]), (5, 8, 1.0, [48, 30]), (6, 4, 1.8, [50, 243])]
        {
            let grid = Grid { columns, rows, stretch };
            let c = 0.6;
            let table = TangentialTable::shared(grid, Boundary::Periodic, c);
            let free = TangentialTable::shared(grid, Boundary::Free, c);
            let images = |entry: Entry, (x, y): (usize, usize), times: isize| -> f64 {
                let (mx, my) = (times * mx, times * my);
                let lag = |a: usize, i: isize, n: usize| a.cast_signed() + i * n.cast_signed();
                let weight = |i: isize, m: isize| if i.abs() == m { 0.5 } else { 1.0 };
                (-mx..=mx)
                    .flat_map(|i| (-my..=my).map(move |j| (i, j)))
                    .map(|(i, j)| {
                        let (lx, ly) = (lag(x, i, columns), lag(y, j, rows));
                        let sign = if entry == Entry::XY { (lx.signum() * ly.signum()) as f64 } else { 1.0 };
                        let image = free.entry(entry, lx.unsigned_abs(), ly.unsigned_abs());
                        weight(i, mx) * weight(j, my) * sign * image
                    })
                    .sum()
            };
            for to in [(columns / 2, 0), (columns / 3, rows / 2), (1, 1), (columns - 1, 1)] {
                for (k, entry) in [Entry::XX, Entry::YY, Entry::XY].into_iter().enumerate() {
                    let difference = |times| images(entry, (0, 0), times) - images(entry, to, times);
                    let expected = 2.0 * difference(2) - difference(1);
                    let found = table.lag(0, 0)[k] - table.lag(to.0, to.1)[k];
                    assert!(
                        (found - expected).abs() < 6e-5,
                        "{columns} {rows} {stretch} {entry:?} {to:?}: {found} {expected}"
                    );
                }
            }
        }
    }

    #[test]
    fn periodic_entries_have_the_mean_of_their_shift() {
        for (columns, rows, stretch) in [(5, 5, 1.0), (8, 6, 1.0), (30, 42, 2.0), (60, 3, 0.4)] {
            let grid = Grid { columns, rows, stretch };
            let table = TangentialTable::shared(grid, Boundary::Periodic, 0.8);
            let mean = |k: usize| {
                let all = (0..grid.count()).map(|i| table.lag(i % columns, i / columns)[k]);
                all.sum::<f64>() / grid.count() as f64
            };
            assert_relative_eq!(mean(0), table.shift(), max_relative = 1e-12);
            assert_relative_eq!(mean(1), table.shift(), max_relative = 1e-12);
            assert!(mean(2).abs() < 1e-13);
        }
    }

    #[test]
    fn a_long_wave_is_that_of_the_continuum() {
        // (I - nu k k'/k^2)/(G |k|) = (1 + c k_t^2/k^2)/|k| 2/E* with 2/E* = (1 - nu)/G, here times pi E*.
        let (n, nu) = (256, 0.3);
        let c = nu / (1.0 - nu);
        let table = TangentialTable::shared(Grid::square(n, n), Boundary::Periodic, c);
        let lengths = Lengths { x: n, y: n };
        let symbol = table.tensor(lengths);
        for (kx, ky) in [(1_u32, 0_u32), (0, 2), (2, 1), (3, 3)] {
            let (qx, qy) = (f64::from(kx), f64::from(ky));
            let (q2, wave) = (qx * qx + qy * qy, std::f64::consts::TAU / n as f64);
            let over = |transverse: f64| n as f64 / q2.sqrt() * transverse;
            let expected = [
                over(1.0 - nu * qx * qx / q2) / (1.0 - nu),
                over(1.0 - nu * qy * qy / q2) / (1.0 - nu),
                over(-nu * qx * qy / q2) / (1.0 - nu),
            ];
            let found = symbol.values[kx as usize * (n / 2 + 1) + ky as usize];
            for (found, expected) in found.into_iter().zip(expected) {
                // The mean over a cell, and the waves that the grid takes for this one.
                assert!((found - expected).abs() < 0.5 * wave * over(1.0), "{kx} {ky}: {found} {expected}");
            }
        }
    }

    #[test]
    fn the_smallest_eigenvalue_is_one_of_the_lattice() {
        for (columns, rows, stretch) in [(40, 40, 1.0), (30, 42, 2.0), (31, 8, 0.4)] {
            for c in [0.0, 0.43, 1.0] {
                let table = TangentialTable::shared(Grid { columns, rows, stretch }, Boundary::Periodic, c);
                let symbol = table.tensor(Lengths { x: columns, y: rows });
                let lowest = symbol
                    .values
                    .iter()
                    .map(|[xx, yy, xy]| f64::midpoint(*xx, *yy) - (0.5 * (xx - yy)).hypot(*xy))
                    .fold(f64::INFINITY, f64::min);
                assert!(lowest >= table.smallest_eigenvalue(), "{stretch} {c}: {lowest}");
            }
        }
    }
}
