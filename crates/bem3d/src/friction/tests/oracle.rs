//! The reference implementation: sums over every pair of cells of a small grid and accelerated projected
//! gradients, without sets or transforms.

use crate::friction::TangentialControl;
use crate::geometry::{CellSet, Grid};
use crate::kernel::TangentialTable;

/// Steps at most.
const STEPS: usize = 200_000;
/// The iteration ends at a step of less than this share of the tractions.
const SMALL: f64 = 1e-14;

/// All cells of a grid, also those without contact, whose tractions are zero.
pub struct Oracle {
    grid: Grid,
    matrix: Vec<Vec<f64>>,
    /// An upper bound of its eigenvalues.
    bound: f64,
    traction: Vec<f64>,
    displacement: [f64; 2],
}

pub struct OracleState {
    pub traction: Vec<f64>,
    pub slip: Vec<f64>,
    pub displacement: [f64; 2],
    pub dissipated: f64,
}

impl Oracle {
    pub fn new(table: &TangentialTable) -> Self {
        let grid = table.grid();
        let n = grid.count();
        let place = |i: usize| ((i % grid.columns).cast_signed(), (i / grid.columns).cast_signed());
        let entry = |row: usize, column: usize| {
            let ((xi, yi), (xj, yj)) = (place(row % n), place(column % n));
            let (x, y) = (xi - xj, yi - yj);
            let [xx, yy, xy] = table.lag(x.unsigned_abs(), y.unsigned_abs());
            match (row / n, column / n) {
                (0, 0) => xx - table.shift(),
                (1, 1) => yy - table.shift(),
                _ => (x.signum() * y.signum()) as f64 * xy,
            }
        };
        let matrix: Vec<Vec<f64>> =
            (0..2 * n).map(|row| (0..2 * n).map(|column| entry(row, column)).collect()).collect();
        let sum = |row: &Vec<f64>| row.iter().map(|v| v.abs()).sum::<f64>();
        let bound = matrix.iter().map(sum).fold(0.0, f64::max);
        Self { grid, matrix, bound, traction: vec![0.0; 2 * n], displacement: [0.0; 2] }
    }

    fn displaced(&self, q: &[f64]) -> Vec<f64> {
        self.matrix.iter().map(|row| row.iter().zip(q).map(|(k, q)| k * q).sum()).collect()
    }

    /// The next state; tractions and slip on the cells.
    pub fn advance(&mut self, cells: &CellSet, limit: &[f64], control: TangentialControl) -> OracleState {
        let n = self.grid.count();
        let place: Vec<usize> = cells.index(self.grid).collect();
        let mut reference = self.displaced(&self.traction);
        for (k, u) in reference.iter_mut().enumerate() {
            *u = self.displacement[k / n] - *u;
        }
        let shift = match control {
            TangentialControl::Displacement(delta) => delta.map(|delta| delta / self.bound),
            TangentialControl::Force(_) => [0.0; 2],
        };
        let mut admissible = AdmissibleTractions { n, place: &place, limit, control, shift };
        let q = self.minimised(&mut admissible, &reference);
        let u = self.displaced(&q);
        let delta = match control {
            TangentialControl::Displacement(delta) => delta,
            TangentialControl::Force(_) => admissible.shift.map(|shift| shift * self.bound),
        };
        let slip = |k: usize| delta[k / n] - u[k] - reference[k];
        let on_cells: Vec<usize> = place.iter().copied().chain(place.iter().map(|i| n + i)).collect();
        let expected = OracleState {
            traction: on_cells.iter().map(|&k| q[k]).collect(),
            slip: on_cells.iter().map(|&k| slip(k)).collect(),
            displacement: delta,
            dissipated: on_cells.iter().map(|&k| q[k] * slip(k)).sum(),
        };
        (self.traction, self.displacement) = (q, delta);
        expected
    }

    /// The tractions of least energy, by accelerated projected gradients from the present ones.
    fn minimised(&self, admissible: &mut AdmissibleTractions<'_>, reference: &[f64]) -> Vec<f64> {
        let mut q = admissible.project(&self.traction);
        let (mut ahead, mut t) = (q.clone(), 1.0_f64);
        let scale = admissible.limit.iter().copied().fold(0.0, f64::max);
        let (step, mut done) = (1.0 / self.bound, 0);
        for _ in 0..STEPS {
            let u = self.displaced(&ahead);
            let y: Vec<f64> =
                ahead.iter().zip(&u).zip(reference).map(|((q, u), r)| q - step * (u + r)).collect();
            let next = admissible.project(&y);
            let change: Vec<f64> = next.iter().zip(&q).map(|(next, q)| next - q).collect();
            // Momentum that leads uphill is forgotten.
            let uphill: f64 =
                ahead.iter().zip(&next).zip(&change).map(|((ahead, next), d)| (ahead - next) * d).sum();
            let next_t = if uphill > 0.0 { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * t * t).sqrt()) };
            let momentum = if uphill > 0.0 { 0.0 } else { (t - 1.0) / next_t };
            ahead = next.iter().zip(&change).map(|(next, d)| next + momentum * d).collect();
            (q, t) = (next, next_t);
            let largest = change.iter().fold(0.0, |largest: f64, d| largest.max(d.abs()));
            done = if largest < SMALL * scale { done + 1 } else { 0 };
            if done > 20 {
                break;
            }
        }
        q
    }
}

/// The tractions of all cells that obey their limits and a load.
struct AdmissibleTractions<'a> {
    /// Number of all cells, and those in contact.
    n: usize,
    place: &'a [usize],
    /// Largest tractions of the latter.
    limit: &'a [f64],
    control: TangentialControl,
    /// The shift of all vectors that brings the sum of the last projections to the force.
    shift: [f64; 2],
}

impl AdmissibleTractions<'_> {
    /// The nearest of them; the shift is found by plain steps.
    fn project(&mut self, y: &[f64]) -> Vec<f64> {
        let Self { n, place, limit, control, ref mut shift } = *self;
        loop {
            let mut q = vec![0.0; 2 * n];
            let mut sum = [0.0; 2];
            for (&i, &b) in place.iter().zip(limit) {
                let (x, y) = (y[i] + shift[0], y[n + i] + shift[1]);
                let scale = (b / x.hypot(y)).min(1.0);
                (q[i], q[n + i]) = (scale * x, scale * y);
                sum = [sum[0] + q[i], sum[1] + q[n + i]];
            }
            let TangentialControl::Force(force) = control else { return q };
            let missing = [force[0] - sum[0], force[1] - sum[1]];
            if missing[0].hypot(missing[1]) < 1e-15 * limit.iter().sum::<f64>() {
                return q;
            }
            *shift = [0, 1].map(|k| shift[k] + missing[k] / place.len() as f64);
        }
    }
}
