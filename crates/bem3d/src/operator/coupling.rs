//! The coupling of normal and tangential displacements.

use super::convolution::Convolution;
use crate::geometry::{CellSet, Grid};
use crate::kernel::CouplingTable;
use contact_model::{Boundary, Interrupted, Stop};
use std::sync::Arc;

/// `u_z = beta (J_x q_x + J_y q_y)` and `(u_x, u_y) = -beta (J_x, J_y) p` on a grid in double precision, see
/// [`CouplingTable`]; beta is that of the body on which the tractions act as the first one.
#[derive(Debug)]
pub struct CouplingOperator {
    beta: f64,
    table: Arc<CouplingTable>,
    /// The convolution of `(p, q_x, q_y)`.
    plan: Option<Convolution<f64, 3, 2>>,
    /// Applications so far.
    pub applications: usize,
}

impl CouplingOperator {
    /// An operator without plans.
    pub fn new(grid: Grid, boundary: Boundary, beta: f64) -> Self {
        Self { beta, table: CouplingTable::shared(grid, boundary), plan: None, applications: 0 }
    }

    /// Normal displacement on the whole grid under tractions on a set, two numbers a cell.
    ///
    /// # Errors
    /// As [`Convolution::apply_to`].
    pub fn normal(&mut self, sources: &CellSet, q: &[f64], stop: Stop<'_>) -> Result<Vec<f64>, Interrupted> {
        let targets = CellSet::all(self.table.grid());
        let (x, y) = q.split_at(sources.len());
        let mut u = self.apply(sources, [None, Some(x), Some(y)], &targets, stop)?;
        u.truncate(targets.len());
        Ok(u)
    }

    /// Tangential displacement of cells under pressures on a set, two numbers a cell.
    ///
    /// # Errors
    /// As [`Convolution::apply_to`].
    pub fn tangential(
        &mut self,
        sources: &CellSet,
        p: &[f64],
        targets: &CellSet,
        stop: Stop<'_>,
    ) -> Result<Vec<f64>, Interrupted> {
        Ok(self.apply(sources, [Some(p), None, None], targets, stop)?.split_off(targets.len()))
    }

    /// The normal displacement and both tangential ones under the given fields `(p, q_x, q_y)`.
    ///
    /// Cost: the transforms of three fields of the grid, except for rows of zeros.
    fn apply(
        &mut self,
        sources: &CellSet,
        given: [Option<&[f64]>; 3],
        targets: &CellSet,
        stop: Stop<'_>,
    ) -> Result<Vec<f64>, Interrupted> {
        let mut u = vec![0.0; 3 * targets.len()];
        if sources.is_empty() || targets.is_empty() || self.beta.abs() <= 0.0 {
            return Ok(u);
        }
        self.applications += 1;
        let table = &self.table;
        let convolution = match &mut self.plan {
            Some(plan) => plan,
            plan => {
                let window = table.grid().window();
                let lengths = table.exact_lengths(window);
                plan.insert(Convolution::new(window, lengths, table.symbol_f64(lengths, stop)?))
            }
        };
        convolution.apply_to(sources, given, targets, &mut u, stop)?;
        for u in &mut u {
            *u *= self.beta;
        }
        Ok(u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    #[test]
    fn displacements_are_sums_over_pairs_and_reciprocal() {
        for (grid, boundary) in [
            (Grid { columns: 9, rows: 7, stretch: 1.0 }, Boundary::Free),
            (Grid { columns: 6, rows: 40, stretch: 1.3 }, Boundary::Free),
            (Grid { columns: 8, rows: 9, stretch: 0.7 }, Boundary::Periodic),
        ] {
            let beta = 0.27;
            let table = CouplingTable::shared(grid, boundary);
            let mut operator = CouplingOperator::new(grid, boundary, beta);
            let sources = CellSet::numbered(grid, |i| i % 5 != 2);
            let (all, n) = (CellSet::all(grid), sources.len());
            let q: Vec<f64> = (0..2 * n).map(|k| (1.1 * k as f64).sin()).collect();
            let p: Vec<f64> = (0..n).map(|k| 1.0 + (0.7 * k as f64).cos()).collect();
            let normal = operator.normal(&sources, &q, &never).unwrap();
            let tangential = operator.tangential(&sources, &p, &all, &never).unwrap();
            let places: Vec<(usize, usize)> = sources.places().collect();
            for (i, (x, y)) in all.places().enumerate() {
                let (mut expected, mut pressed) = (0.0, [0.0; 2]);
                for (j, &(xs, ys)) in places.iter().enumerate() {
                    let sign = |a: usize, b: usize| if a < b { -1.0 } else { 1.0 };
                    let [jx, jy] = table.lag(x.abs_diff(xs), y.abs_diff(ys));
                    let (jx, jy) = (sign(x, xs) * jx, sign(y, ys) * jy);
                    expected += beta * (jx * q[j] + jy * q[n + j]);
                    pressed = [pressed[0] - beta * jx * p[j], pressed[1] - beta * jy * p[j]];
                }
                assert!((normal[i] - expected).abs() < 1e-12, "{grid:?}: {} {expected}", normal[i]);
                assert!((tangential[i] - pressed[0]).abs() < 1e-12);
                assert!((tangential[grid.count() + i] - pressed[1]).abs() < 1e-12);
            }
            // The work of the pressure on the displacement of the tractions is that of the tractions on the
            // displacement of the pressure.
            let on_sources = sources.carry(&all, &normal);
            let work: f64 = on_sources.iter().zip(&p).map(|(u, p)| u * p).sum();
            let tangential = operator.tangential(&sources, &p, &sources, &never).unwrap();
            let other: f64 = tangential.iter().zip(&q).map(|(u, q)| u * q).sum();
            approx::assert_relative_eq!(work, other, max_relative = 1e-11);
        }
    }

    #[test]
    fn periodic_differences_are_sums_over_images() {
        // Over images in squares, those at the edges by half, the lattice sum of x/r^2 converges as one over
        // the square of its side.
        let grid = Grid { columns: 5, rows: 5, stretch: 1.0 };
        let periodic = CouplingTable::shared(grid, Boundary::Periodic);
        let free = CouplingTable::shared(Grid { columns: 205, rows: 205, stretch: 1.0 }, Boundary::Free);
        let images = |(x, y): (usize, usize), m: isize| -> f64 {
            let lag = |a: usize, i: isize| a.cast_signed() + 5 * i;
            let weight = |i: isize| if i.abs() == m { 0.5 } else { 1.0 };
            let mut sum = 0.0;
            for (i, j) in (-m..=m).flat_map(|i| (-m..=m).map(move |j| (i, j))) {
                let (lx, ly) = (lag(x, i), lag(y, j));
                let value = free.lag(lx.unsigned_abs(), ly.unsigned_abs())[0];
                sum += weight(i) * weight(j) * lx.signum() as f64 * value;
            }
            sum
        };
        for to in [(1, 0), (2, 1), (1, 2)] {
            // The field of a uniform charge on a square, pi x over its area, is that of the mean.
            let (one, two) = (images(to, 20), images(to, 40));
            let expected = two + (two - one) / 3.0 - std::f64::consts::PI * to.0 as f64 / 25.0;
            let found = periodic.lag(to.0, to.1)[0];
            assert!((found - expected).abs() < 1e-9, "{to:?}: {found} {expected}");
        }
    }
}
