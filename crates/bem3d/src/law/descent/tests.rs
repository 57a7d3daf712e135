//! Tests against known minima, and of the descent used on its own.

use super::*;
use crate::geometry::{CellSet, Grid};
use crate::kernel::{NormalTable, TangentialTable};
use crate::law::{Discs, PressureRange};
use crate::operator::{Operators, TangentialOperators};
use crate::parts::Recorder;
use crate::real::sum;
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, Interrupted, never};

/// Rounding of a few additions.
const ROUNDING_OF_SUMS: f64 = 1e-14;

/// A pressure on all cells of a grid and the gap under it, on their way to the solution.
struct PressureOnAll {
    operators: Operators,
    cells: CellSet,
    law: PressureRange,
    force: Option<f64>,
    p: Vec<f64>,
    gap: Vec<f64>,
}

impl PressureOnAll {
    /// Descends in at most this number of steps. Returns the number of steps taken.
    fn descend(&mut self, steps: usize, stop: Stop<'_>) -> Result<usize, Interrupted> {
        let Self { operators, cells, law, force, p, gap } = self;
        let own = operators.table().own();
        let force = force.map(|force| [force]);
        let descent = Descent { law: &*law, force, tractions: p, gradient: gap, own };
        let displace = |change: &[f64], u: &mut Vec<f64>| operators.exact(cells, change, cells, u, stop);
        descend(descent, displace, steps, stop)
    }

    /// Energy `p'Gp/2 + z'p` and gap `Gp + z` of the pressure.
    fn evaluated(&mut self, z: &[f64]) -> (f64, Vec<f64>) {
        let Self { operators, cells, p, .. } = self;
        let mut u = Vec::new();
        operators.exact(cells, p, cells, &mut u, &never).unwrap();
        let energy = 0.5 * dot(p, &u) + dot(p, z);
        u.iter_mut().zip(z).for_each(|(u, z)| *u += z);
        (energy, u)
    }

    /// Descends until the energy does not fall any more, and asserts that every step lowers it and obeys the bounds
    /// and the force.
    fn descend_to_the_end(&mut self, z: &[f64]) {
        let (mut last, gap) = self.evaluated(z);
        self.gap = gap;
        for _ in 0..100 {
            let taken = self.descend(5, &never);
            let (energy, exact) = self.evaluated(z);
            assert!(energy <= last + ROUNDING_OF_SUMS * last.abs(), "{energy} {last}");
            assert!(self.p.iter().all(|p| (0.0..=self.law.upper).contains(p)));
            if let Some(force) = self.force {
                assert_relative_eq!(sum(&self.p), force, max_relative = 1e-12);
            }
            for (gap, exact) in self.gap.iter().zip(&exact) {
                assert_relative_eq!(*gap, *exact, epsilon = 1e-12, max_relative = 1e-12);
            }
            (last, self.gap) = (energy, exact);
            if taken == Ok(0) {
                break;
            }
        }
    }

    /// Asserts the conditions of contact; under a force the gap counts from its mean on the cells between their
    /// bounds.
    fn assert_solved(&self, what: &str) {
        let (p, upper) = (&self.p, self.law.upper);
        let plane = if self.force.is_some() {
            let inside: Vec<f64> =
                p.iter().zip(&self.gap).filter(|(p, _)| **p > 0.0 && **p < upper).map(|(_, g)| *g).collect();
            sum(&inside) / inside.len() as f64
        } else {
            0.0
        };
        for (p, gap) in p.iter().zip(&self.gap) {
            let gap = gap - plane;
            let miss = match *p {
                p if p <= 0.0 => -gap,
                p if p >= upper => gap,
                _ => gap.abs(),
            };
            assert!(miss < 1e-9, "{what}: {miss}");
        }
    }
}

/// Starting from pressures far from any solution, the energy falls in every step, the bounds and the force
/// hold, and the residuals of the conditions tend to zero, with and without a hardness.
#[test]
fn every_step_lowers_the_energy_and_the_end_is_the_solution() {
    for (grid, boundary) in [
        (Grid { columns: 9, rows: 7, stretch: 1.3 }, Boundary::Periodic),
        (Grid::square(1, 12), Boundary::Free),
        (Grid::square(8, 8), Boundary::Free),
    ] {
        let n = grid.count();
        let z: Vec<f64> = (0..n).map(|i| ((i * i * 7 + 3 * i) % 23) as f64 / 10.0).collect();
        for (hardness, force) in [
            (1.0, Some(0.5 * n as f64)),
            (0.3, Some(0.29 * n as f64)),
            (f64::INFINITY, Some(0.1 * n as f64)),
            (0.2, None),
            (f64::INFINITY, None),
        ] {
            // z - d where the approach is prescribed.
            let z: Vec<f64> = z.iter().map(|z| z - if force.is_none() { 1.5 } else { 0.0 }).collect();
            let law = PressureRange { upper: hardness };
            let mut p: Vec<f64> = (0..n).map(|i| (i % 5) as f64).collect();
            law.project(&mut p, force.map(|force| [force]));
            let operators = Operators::new(NormalTable::shared(grid, boundary), &Tuning::DEFAULT);
            let cells = CellSet::all(grid);
            let mut pressure = PressureOnAll { operators, cells, law, force, p, gap: Vec::new() };
            pressure.descend_to_the_end(&z);
            pressure.assert_solved(&format!("{boundary:?} {hardness} {force:?}"));
        }
    }
}

/// The same with friction: tractions in discs, under a displacement or a force.
#[test]
fn every_step_lowers_the_energy_of_tractions_too() {
    for (grid, boundary) in [
        (Grid { columns: 6, rows: 5, stretch: 1.3 }, Boundary::Periodic),
        (Grid::square(7, 6), Boundary::Free),
    ] {
        let n = grid.count();
        let limit: Vec<f64> = (0..n).map(|i| ((i * i * 7 + 3 * i) % 23) as f64 / 10.0).collect();
        let law = Discs { limit: &limit };
        let most = sum(&limit);
        for (delta, force) in
            [([2.0, -1.0], None), ([90.0, 0.0], None), ([0.0; 2], Some([0.4 * most, 0.2 * most]))]
        {
            let table = TangentialTable::shared(grid, boundary, 0.6);
            let mut operators = TangentialOperators::new(table, &Tuning::DEFAULT, &Recorder::default());
            let cells = CellSet::all(grid);
            let mut q: Vec<f64> = (0..2 * n).map(|i| (i % 5) as f64 - 2.0).collect();
            law.project(&mut q, force);
            let mut evaluated = |q: &[f64]| {
                let mut u = Vec::new();
                operators.exact(&cells, q, &cells, &mut u, &never).unwrap();
                let gradient: Vec<f64> = (0..2 * n).map(|k| u[k] - delta[usize::from(k >= n)]).collect();
                let energy = 0.5 * dot(q, &u) - delta[0] * sum(&q[..n]) - delta[1] * sum(&q[n..]);
                (energy, gradient)
            };
            let (mut last, mut gradient) = evaluated(&q);
            for _ in 0..200 {
                let descent =
                    Descent { law: &law, force, tractions: &mut q, gradient: &mut gradient, own: 5.0 };
                let mut other = TangentialOperators::new(
                    TangentialTable::shared(grid, boundary, 0.6),
                    &Tuning::DEFAULT,
                    &Recorder::default(),
                );
                let displace =
                    |change: &[f64], u: &mut Vec<f64>| other.exact(&cells, change, &cells, u, &never);
                let taken = descend(descent, displace, 5, &never).unwrap();
                let (energy, exact) = evaluated(&q);
                assert!(energy <= last + 1e-12 * last.abs(), "{energy} {last}");
                assert!((0..n).all(|i| q[i].hypot(q[n + i]) <= limit[i]));
                (last, gradient) = (energy, exact);
                if taken == 0 {
                    break;
                }
            }
            // At the end the duality gap vanishes; under a force with the displacement of cells that stick.
            let stuck: Vec<usize> = (0..n).filter(|&i| q[i].hypot(q[n + i]) < 0.99 * limit[i]).collect();
            let mean = [0, n].map(|start| {
                let of = stuck.iter().map(|i| gradient[start + i]).sum::<f64>() / stuck.len() as f64;
                if force.is_some() { of } else { 0.0 }
            });
            let slip = |i: usize| [mean[0] - gradient[i], mean[1] - gradient[n + i]];
            let gap: f64 = (0..n).map(|i| law.excess(i, [q[i], q[n + i]], slip(i))).sum();
            let scale = most * gradient.iter().fold(1.0, |a: f64, g| a.max(g.abs()));
            assert!(gap < 1e-9 * scale, "{boundary:?} {delta:?} {force:?}: {}", gap / scale);
        }
    }
}

#[test]
fn nothing_is_done_at_a_solution_or_when_stopped() {
    let grid = Grid::square(3, 1);
    let mut pressure = PressureOnAll {
        operators: Operators::new(NormalTable::shared(grid, Boundary::Free), &Tuning::DEFAULT),
        cells: CellSet::all(grid),
        law: PressureRange { upper: 1.0 },
        force: Some(1.0),
        p: vec![0.0, 1.0, 0.0],
        gap: vec![0.5, -0.5, 0.5],
    };
    // The saturated cell is the lowest.
    assert_eq!(pressure.descend(9, &never), Ok(0));
    assert_eq!((&pressure.p[..], pressure.operators.plans.applications), (&[0.0, 1.0, 0.0][..], 0));
    (pressure.p, pressure.gap) = (vec![1.0, 0.0, 0.0], vec![0.5, -0.5, 0.5]);
    assert_eq!(pressure.descend(9, &|| true), Err(Interrupted));
    assert_eq!(pressure.p, [1.0, 0.0, 0.0]);
}
