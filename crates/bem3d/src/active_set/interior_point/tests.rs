//! The interior-point method beside the equations that it solves, by sums over pairs.

use super::*;
use crate::geometry::Grid;
use crate::kernel::{LayerOnGrid, LayerSymbol, Medium, NormalTable, PeriodicKernel};
use crate::tuning::Tuning;
use contact_model::{Boundary, Layer, LayerBase, never};

/// A plate on a bed that is ten thousand times as soft, under a wavy map with cells that cannot touch.
#[test]
fn the_conditions_of_contact_hold_to_what_was_asked_for() {
    let base = LayerBase::HalfSpace { young: 1e-4, poisson: 0.3 };
    let layer = Layer { thickness: 0.3, young: 1.0, poisson: 0.3, base };
    let layer = LayerOnGrid { thickness: 0.3, share: 1.0, symbol: LayerSymbol::new(&layer) };
    let grid = Grid { columns: 15, rows: 12, stretch: 1.2 };
    let cells = CellSet::numbered(grid, |i| i % 17 != 3);
    let places: Vec<(usize, usize)> = cells.places().collect();
    let z: Vec<f64> =
        places.iter().map(|&(x, y)| 2.0 + (1.3 * x as f64).sin() + (0.9 * y as f64).cos()).collect();
    for boundary in [Boundary::Free, Boundary::Periodic] {
        let table = NormalTable::shared(grid, Medium::Layer(layer, boundary, PeriodicKernel::Cells));
        let displaced = |p: &[f64]| -> Vec<f64> {
            let by =
                |a: (usize, usize), b: (usize, usize)| table.lag(a.0.abs_diff(b.0), a.1.abs_diff(b.1))[0];
            let u = |&a: &(usize, usize)| places.iter().zip(p).map(|(&b, p)| by(a, b) * p).sum::<f64>();
            places.iter().zip(&z).map(|(a, z)| u(a) + z).collect()
        };
        let mut operators = Operators::new(std::sync::Arc::clone(&table), &Tuning::DEFAULT);
        let mut solve = |force: Option<f64>, approach: f64| {
            let operators = &mut operators;
            InteriorProblem { operators, cells: &cells, z: &z, force, approach, enough: 1e-9 }
                .solve(0.01, &never)
        };
        let by_force = solve(Some(0.05), 0.0).unwrap().unwrap();
        let by_approach = solve(None, by_force.approach).unwrap().unwrap();
        assert!(by_approach.approach.to_bits() == by_force.approach.to_bits());
        for InteriorPressure { p, gap, approach, .. } in [&by_force, &by_approach] {
            assert!(p.iter().chain(gap).all(|value| *value > 0.0));
            approx::assert_relative_eq!(sum(p), 0.05, max_relative = 1e-6);
            assert!(dot(p, gap) < 1e-8 * sum(p), "{}", dot(p, gap));
            for (u, gap) in displaced(p).iter().zip(gap) {
                assert!((u - approach - gap).abs() < 2e-9);
            }
        }
        let touching = by_force.p.iter().zip(&by_force.gap).filter(|(p, gap)| *p > *gap).count();
        assert!(touching > 5 && touching < 100, "{touching}");
    }
}
