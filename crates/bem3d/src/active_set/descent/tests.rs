//! Tests against known minima, and of the descent used on its own.

use super::*;
use crate::geometry::Grid;
use crate::kernel::NormalTable;
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};

/// Rounding of a few additions.
const ROUNDING_OF_SUMS: f64 = 1e-14;

#[test]
fn a_pressure_is_projected_by_hand() {
    let projected = |y: &[f64], hardness: f64, force: Option<f64>| {
        let mut y = y.to_vec();
        Feasible { bounds: Bounds::UpTo(hardness), force }.project(&mut y);
        y
    };
    let close = |found: Vec<f64>, expected: &[f64]| {
        for (found, expected) in found.iter().zip(expected) {
            assert_relative_eq!(*found, *expected, epsilon = ROUNDING_OF_SUMS);
        }
    };
    // An approach: each by itself.
    assert_eq!(projected(&[-1.0, 0.5, 3.0], 2.0, None), [0.0, 0.5, 2.0]);
    // A force: all are shifted, those that leave the bounds stay there.
    close(projected(&[1.0, 2.0, 3.0], f64::INFINITY, Some(3.0)), &[0.0, 1.0, 2.0]);
    close(projected(&[1.0, 2.0, 3.0], f64::INFINITY, Some(9.0)), &[2.0, 3.0, 4.0]);
    close(projected(&[0.0, 2.0, 9.0], 3.0, Some(4.5)), &[0.0, 1.5, 3.0]);
    close(projected(&[0.0, 2.0, 9.0], 3.0, Some(7.0)), &[1.0, 3.0, 3.0]);
    // All of them, nearly none, far apart, and equal ones.
    close(projected(&[0.0, 2.0, 9.0], 3.0, Some(9.0)), &[3.0, 3.0, 3.0]);
    close(projected(&[0.0, 2.0, 9.0], 3.0, Some(1e-12)), &[0.0, 0.0, 1e-12]);
    close(projected(&[-1e12, 0.0, 1e12], 3.0, Some(4.0)), &[0.0, 1.0, 3.0]);
    close(projected(&[0.7; 4], 3.0, Some(2.0)), &[0.5; 4]);
    close(projected(&[5.0], 3.0, Some(2.0)), &[2.0]);
}

/// Energy `p'Gp/2 + z'p` and gap `Gp + z` of a pressure on all cells.
fn evaluated(operators: &mut Operators, cells: &CellSet, p: &[f64], z: &[f64]) -> (f64, Vec<f64>) {
    let mut u = Vec::new();
    operators.exact(cells, p, cells, &mut u);
    let energy = 0.5 * dot(p, &u) + dot(p, z);
    u.iter_mut().zip(z).for_each(|(u, z)| *u += z);
    (energy, u)
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
            let mut operators = Operators::new(NormalTable::shared(grid, boundary), &Tuning::DEFAULT);
            let cells = CellSet::all(grid);
            // z - d where the approach is prescribed.
            let z: Vec<f64> = z.iter().map(|z| z - if force.is_none() { 1.5 } else { 0.0 }).collect();
            let feasible = Feasible { bounds: Bounds::UpTo(hardness), force };
            let mut p: Vec<f64> = (0..n).map(|i| (i % 5) as f64).collect();
            feasible.project(&mut p);
            let (mut last, mut gap) = evaluated(&mut operators, &cells, &p, &z);
            for _ in 0..100 {
                let taken = descend(&mut operators, &cells, (&mut p, &mut gap), feasible, 5, &never);
                let (energy, exact) = evaluated(&mut operators, &cells, &p, &z);
                assert!(energy <= last + ROUNDING_OF_SUMS * last.abs(), "{energy} {last}");
                assert!(p.iter().all(|p| (0.0..=hardness).contains(p)));
                if let Some(force) = force {
                    assert_relative_eq!(sum(&p), force, max_relative = 1e-12);
                }
                for (gap, exact) in gap.iter().zip(&exact) {
                    assert_relative_eq!(*gap, *exact, epsilon = 1e-12, max_relative = 1e-12);
                }
                (last, gap) = (energy, exact);
                if taken == 0 {
                    break;
                }
            }
            let plane = if force.is_some() {
                let inside: Vec<f64> = p
                    .iter()
                    .zip(&gap)
                    .filter(|(p, _)| **p > 0.0 && **p < hardness)
                    .map(|(_, g)| *g)
                    .collect();
                sum(&inside) / inside.len() as f64
            } else {
                0.0
            };
            for (p, gap) in p.iter().zip(&gap) {
                let gap = gap - plane;
                let miss = match *p {
                    p if p <= 0.0 => -gap,
                    p if p >= hardness => gap,
                    _ => gap.abs(),
                };
                assert!(miss < 1e-9, "{boundary:?} {hardness} {force:?}: {miss}");
            }
        }
    }
}

#[test]
fn nothing_is_done_at_a_solution_or_when_stopped() {
    let grid = Grid::square(3, 1);
    let mut operators = Operators::new(NormalTable::shared(grid, Boundary::Free), &Tuning::DEFAULT);
    let cells = CellSet::all(grid);
    let feasible = Feasible { bounds: Bounds::UpTo(1.0), force: Some(1.0) };
    // The saturated cell is the lowest.
    let (mut p, mut gap) = (vec![0.0, 1.0, 0.0], vec![0.5, -0.5, 0.5]);
    assert_eq!(descend(&mut operators, &cells, (&mut p, &mut gap), feasible, 9, &never), 0);
    assert_eq!((p, operators.plans.applications), (vec![0.0, 1.0, 0.0], 0));
    let (mut p, mut gap) = (vec![1.0, 0.0, 0.0], vec![0.5, -0.5, 0.5]);
    assert_eq!(descend(&mut operators, &cells, (&mut p, &mut gap), feasible, 9, &|| true), 0);
    assert_eq!(p, [1.0, 0.0, 0.0]);
}
