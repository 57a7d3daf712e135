//! The tangent of the last state compared with the state that it predicts, and coarse grids compared with the
//! fine one.

use super::*;
use crate::active_set::Bounds;
use crate::active_set::residuals::Residuals;
use crate::active_set::state::Continuation;
use crate::kernel::love::influence;
use crate::response::normal::{self, Responding, StiffnessRequest};
use approx::assert_relative_eq;
use contact_model::{Boundary, Status, never};

fn problem(grid: Grid, z: Vec<f64>) -> Problem {
    Problem::new(grid, Arc::new(z), Boundary::Free, &Tuning::DEFAULT)
}

/// The tangent of the last state.
mod tangent {
    use super::*;

    const TUNING: Tuning = Tuning::DEFAULT;

    /// A paraboloid with waves on it under a path of forces; the state and q at each.
    fn path(grid: Grid, forces: &[f64]) -> (Problem, Vec<(Solved, Vec<f64>)>) {
        let (a, b) = grid.cell();
        let z = (0..grid.count())
            .map(|i| {
                let x = ((i % grid.columns) as f64 - (grid.columns / 2) as f64 + 1.0) * a;
                let y = ((i / grid.columns) as f64 - (grid.rows / 2) as f64) * b;
                (x * x + y * y) / 100.0 + 0.4 * (1.0 - f64::cos(0.9 * x) * f64::cos(0.7 * y))
            })
            .collect();
        let mut problem = problem(grid, z);
        let limits = Limits {
            tolerance: 1e-9,
            height: Some(1.0),
            outer_iterations: 200,
            factor: false,
            is_guess: false,
        };
        let states = forces
            .iter()
            .map(|&force| {
                let (set, p) = (CellSet::all(grid), vec![1.0; grid.count()]);
                let guess = Guess { set, p, d: 4.0 * force };
                let solved = solve(&mut problem, Control::Force(force), guess, limits, &never).unwrap();
                assert_eq!(solved.status, Status::Converged);
                let k = normal::solve(
                    &mut problem,
                    &solved,
                    &Responding::whole(&solved, Bounds::Unlimited),
                    StiffnessRequest { tolerance: 1e-9, q: None, expected: None },
                    &never,
                )
                .unwrap();
                (solved, k.q().to_vec())
            })
            .collect();
        (problem, states)
    }

    fn last((solved, q): &(Solved, Vec<f64>)) -> LastState {
        LastState {
            contact: solved.contact.clone(),
            p: solved.p.clone(),
            d: solved.d,
            force: solved.p.iter().sum(),
            tangent: Some((q.clone(), q.iter().sum())),
        }
    }

    #[test]
    fn the_secant_between_two_loads_says_more_than_the_tangent_at_the_first() {
        for grid in [Grid::square(48, 48), Grid { columns: 40, rows: 52, stretch: 1.2 }] {
            let (mut problem, states) = path(grid, &[100.0, 200.0]);
            let solved = &states[1].0;
            let carried = solved.contact.carry(&states[0].0.contact, &states[0].1);
            let extrapolated = last(&states[0]).tangent_at(solved, &solved.contact, &TUNING).unwrap();
            // A tolerance that any guess meets returns what the guess is worth.
            let [carried, extrapolated] = [carried, extrapolated].map(|q| {
                let k = normal::solve(
                    &mut problem,
                    solved,
                    &Responding::whole(solved, Bounds::Unlimited),
                    StiffnessRequest { tolerance: 100.0, q: Some(q), expected: None },
                    &never,
                )
                .unwrap();
                assert_eq!(k.steps, 0);
                k.solve_error
            });
            assert!(extrapolated < 0.5 * carried, "{extrapolated} {carried}");
            // Between equal loads, or on the way down, there is no better guess than the tangent at the
            // larger load.
            let back = last(&states[1]).tangent_at(&states[0].0, &states[0].0.contact, &TUNING).unwrap();
            assert_eq!(back, states[0].0.contact.carry(&solved.contact, &states[1].1));
            assert_eq!(last(&states[1]).tangent_at(solved, &solved.contact, &TUNING).unwrap(), states[1].1);
            let bare = LastState { tangent: None, ..last(&states[0]) };
            assert!(bare.tangent_at(solved, &solved.contact, &TUNING).is_none());
        }
    }

    #[test]
    fn the_tangent_predicts_an_approach_from_above() {
        let (_, states) = path(Grid::square(48, 48), &[100.0, 150.0]);
        let (before, after) = (last(&states[0]), &states[1].0);
        let guess = before.extrapolated(Control::Force(150.0), &TUNING).unwrap();
        assert!(guess.d > after.d && guess.d < 1.2 * after.d, "{} {}", guess.d, after.d);
        assert_relative_eq!(guess.p.iter().sum::<f64>(), 150.0, max_relative = 1e-6);
        let approach = before.extrapolated(Control::Approach(after.d), &TUNING).unwrap();
        assert_relative_eq!(approach.d, after.d);
        assert!(approach.p.iter().sum::<f64>() < 150.0, "the stiffness grows on the way");
        // Without a tangent the pressure is scaled; down the approach stays where it was.
        let bare = LastState { tangent: None, ..last(&states[0]) };
        let down = bare.extrapolated(Control::Force(50.0), &TUNING).unwrap();
        assert_relative_eq!(down.d, bare.d);
        assert_relative_eq!(down.p[7], 0.5 * bare.p[7], max_relative = 1e-6);
        let up = bare.extrapolated(Control::Force(200.0), &TUNING).unwrap();
        assert_relative_eq!(up.d, 2.0 * bare.d, max_relative = 1e-6);
        assert_relative_eq!(bare.ratio(Control::Approach(2.0 * bare.d)), 2.0);
        // A cell without pressure is not in the guess.
        let mut p = bare.p.clone();
        p[7] = 0.0;
        let open = LastState { p, tangent: None, ..last(&states[0]) };
        let guess = open.extrapolated(Control::Force(100.0), &TUNING).unwrap();
        assert_eq!((guess.set.len(), guess.p.len()), (bare.p.len() - 1, bare.p.len() - 1));
        for far in [3.3, 3001.0] {
            assert!(bare.extrapolated(Control::Force(far), &TUNING).is_none(), "thirty times away is far");
        }
        // No cell keeps its pressure.
        assert!(
            before
                .extrapolated(Control::Approach(0.05 * before.d), &TUNING)
                .is_none_or(|g| !g.set.is_empty())
        );
    }

    #[test]
    fn a_tangent_is_followed_unless_it_overshoots() {
        const GRID: Grid = Grid { columns: 2049, rows: 2049, stretch: 1.0 };
        let every = |step: usize| {
            let contact = CellSet::from_index(GRID, &(0..2049 * 2049_u32).step_by(step).collect::<Vec<_>>());
            LastState { contact, p: Vec::new(), d: 1.0, force: 1.0, tangent: None }
        };
        let overshoots = |last: &LastState, ratio: f64, predicted: &dyn Fn() -> usize| {
            last.overshoots(Control::Force(ratio), GRID.count(), &TUNING, || Ok(predicted())).unwrap()
        };
        let (few, many) = (every(20_000), every(8));
        assert!(!overshoots(&few, 2.0, &|| usize::MAX), "few cells: nothing to save");
        assert!(!overshoots(&many, 1.1, &|| usize::MAX), "a small step");
        assert!(overshoots(&many, 2.0, &|| unreachable!("much will touch: no need to count")));
        let scattered = every(200);
        let cells = scattered.contact.len();
        assert!(overshoots(&scattered, 2.0, &|| 20 * cells));
        assert!(!overshoots(&scattered, 2.0, &|| 3 * cells));
    }
}

#[test]
fn a_guess_predicts_the_cells_that_it_makes_penetrate() {
    // A corner under its own load: u = I(x, y) around it. Steps of z and an approach between the
    // values of u + z.
    for grid in [Grid::square(8, 8), Grid::square(8, 6)] {
        let z: Vec<f64> = (0..grid.count()).map(|i| (i % 8 + i / 8) as f64 / 8.0).collect();
        let mut problem = problem(grid, z.clone());
        let mut predicted = |cells: &[u32], p: f64, d: f64| {
            let guess = Guess { set: CellSet::from_index(grid, cells), p: vec![p; cells.len()], d };
            predicted_cells(&mut problem, &guess, &never).unwrap()
        };
        for d in [0.9, 1.3, 2.0] {
            let expected = (0..grid.count()).filter(|&i| influence(i % 8, i / 8) + z[i] < d).count();
            assert!(expected > 1);
            assert_eq!(predicted(&[0], 1.0, d), expected, "d = {d}");
        }
        // Without pressure the cells below the plane penetrate; one at its height does not: z = 1/8 holds for
        // cells 1 and 8.
        assert_eq!(predicted(&[1], 0.0, 0.125), 1);
        // At least the guess itself.
        assert_eq!(predicted(&[0, 1, 2], 100.0, 0.1), 3);
    }
}

fn limits() -> Limits {
    Limits { tolerance: 1e-6, height: Some(1.0), outer_iterations: 50, factor: false, is_guess: false }
}

/// A broad hill with one needle on its flank that no coarse grid sees as a summit, and an undefined point.
fn needle(grid: Grid) -> Vec<f64> {
    let (middle, side) = ((grid.columns as f64 / 2.0, grid.rows as f64 / 2.0), grid.cell());
    let mut z: Vec<f64> = (0..grid.count())
        .map(|i| {
            let (x, y) = ((i % grid.columns) as f64 - middle.0, (i / grid.columns) as f64 - middle.1);
            0.2 + ((x * side.0).powi(2) + (y * side.1).powi(2)) / 48.5f64.powi(2)
        })
        .collect();
    z[3 * grid.columns + 5] = 0.0;
    z[7 * grid.columns + 11] = f64::INFINITY;
    z
}

/// A square, rectangles, and one with few rows, which are left as they are.
const GRIDS: [Grid; 4] = [
    Grid { columns: 97, rows: 97, stretch: 1.0 },
    Grid { columns: 120, rows: 70, stretch: 1.0 },
    Grid { columns: 75, rows: 98, stretch: 1.3 },
    Grid { columns: 201, rows: 20, stretch: 0.9 },
];

#[test]
fn a_needle_that_coarse_grids_lose_still_carries() {
    for grid in GRIDS {
        let mut problem = problem(grid, needle(grid));
        let target = Control::Approach(0.3);
        let guess = cold_start(&mut problem, target, limits(), &never).unwrap();
        assert!(problem.coarser.is_some(), "{grid:?}: this test is about coarse grids");
        let solved = solve(&mut problem, target, guess, limits(), &never).unwrap();
        assert_eq!(solved.status, Status::Converged);
        assert!(solved.contact.index(grid).any(|i| i == 3 * grid.columns + 5), "{grid:?}");
        assert!(solved.contact.len() > 10, "the hill carries too");
    }
}

#[test]
fn a_coarse_grid_keeps_the_force() {
    for grid in GRIDS {
        let mut problem = problem(grid, needle(grid));
        let force = 40.0;
        let guess = cold_start(&mut problem, Control::Force(force), limits(), &never).unwrap();
        assert_relative_eq!(guess.p.iter().sum::<f64>(), force, max_relative = 1e-12);
        assert!(guess.p.iter().all(|&p| p > 0.0));
        assert_eq!(guess.p.len(), guess.set.len());
        // It is a guess worth its price: the approach and where most of the force is.
        let solved = solve(&mut problem, Control::Force(force), guess.clone(), limits(), &never).unwrap();
        assert!((guess.d / solved.d - 1.0).abs() < 0.1, "{grid:?}: {} {}", guess.d, solved.d);
        let shared: f64 = solved.contact.carry(&guess.set, &guess.p).iter().sum();
        assert!(shared > 0.8 * force, "{grid:?}: {shared}");
    }
}

#[test]
fn an_approach_below_every_coarse_summit_starts_from_the_fine_grid() {
    for grid in GRIDS {
        let mut problem = problem(grid, needle(grid));
        let guess = cold_start(&mut problem, Control::Approach(1e-3), limits(), &never).unwrap();
        assert_eq!(guess.set, CellSet::from_index(grid, &[(3 * grid.columns + 5) as u32]));
    }
}

#[test]
fn a_small_set_needs_no_coarse_grid() {
    let grid = GRIDS[0];
    let mut problem = problem(grid, needle(grid));
    let guess =
        cold_start(&mut problem, Control::Force(0.05), Limits { factor: true, ..limits() }, &never).unwrap();
    assert!(problem.coarser.is_none());
    assert_relative_eq!(guess.p.iter().sum::<f64>(), 0.05, max_relative = 1e-12);
    // All cells with z below what the force sinks one cell alone.
    assert_eq!(guess.set, problem.candidates.below(0.05 * influence(0, 0)));
    problem.nested = false;
    let guess = cold_start(&mut problem, Control::Force(40.0), limits(), &never).unwrap();
    assert!(problem.coarser.is_none() && guess.set.len() == grid.count() - 1);
}

#[test]
fn a_coarse_grid_is_the_mean_of_its_defined_cells() {
    // 50 columns in pairs, 51 rows in pairs and one alone.
    let grid = Grid { columns: 50, rows: 51, stretch: 1.5 };
    let mut z: Vec<f64> = (0..grid.count()).map(|i| i as f64).collect();
    z[0] = f64::INFINITY;
    for i in [2, 3, 52, 53] {
        z[i] = f64::INFINITY;
    }
    let coarse = coarser(&problem(grid, z));
    assert_eq!(coarse.grid(), Grid { columns: 25, rows: 26, stretch: 1.5 });
    let z = coarse.candidates.z();
    assert_relative_eq!(z[0], (1.0 + 50.0 + 51.0) / 3.0);
    assert!(z[1].is_infinite());
    assert_relative_eq!(z[2], (4.0 + 5.0 + 54.0 + 55.0) / 4.0);
    assert_relative_eq!(z[25 * 25 + 24], 2549.0 - 0.5, max_relative = 1e-14);
    // Cells twice as long and as wide as before.
    let narrow = coarser(&problem(Grid { columns: 49, rows: 24, stretch: 1.5 }, vec![1.0; 49 * 24]));
    let (a, b) = narrow.grid().cell();
    assert_eq!((narrow.grid().columns, narrow.grid().rows), (25, 24));
    assert_relative_eq!(a / b, 2.0 * 1.5 * 1.5, max_relative = 1e-14);
    // And the other way: rows in pairs, columns as they are.
    let flat = coarser(&problem(Grid { columns: 24, rows: 49, stretch: 1.5 }, vec![1.0; 49 * 24]));
    let (a, b) = flat.grid().cell();
    assert_eq!((flat.grid().columns, flat.grid().rows), (24, 25));
    assert_relative_eq!(a / b, 0.5 * 1.5 * 1.5, max_relative = 1e-14);
}

#[test]
fn a_coarse_pressure_goes_to_the_fine_cells_below_the_plane() {
    let grid = Grid::square(64, 64);
    let mut z = vec![1.0; grid.count()];
    // The plane is at 0.5. Of coarse cell 0 two fine cells lie below it and two above; of cell 1 one lies
    // below and one in it; of cell 2 one lies in it and none below.
    (z[0], z[1]) = (0.0, 0.2);
    (z[2], z[3]) = (0.1, 0.5);
    z[4] = 0.5;
    let problem = problem(grid, z);
    let solved = Solved {
        contact: CellSet::from_index(Grid::square(32, 32), &[0, 1, 2]),
        p: vec![1.0, 3.0, 4.0],
        d: 0.5,
        q: None,
        residuals: Residuals::default(),
        steps: 0,
        status: Status::Converged,
        continuation: Continuation::default(),
    };
    let guess = prolonged(&problem, &solved);
    assert_eq!(guess.set, CellSet::from_index(grid, &[0, 1, 2, 4, 5, 68, 69]));
    // Forces are counted in the side of a cell: twice the pressure on a quarter of the area.
    for (p, expected) in guess.p.iter().zip([1.0, 1.0, 6.0, 2.0, 2.0, 2.0, 2.0]) {
        assert_relative_eq!(*p, expected);
    }
}
