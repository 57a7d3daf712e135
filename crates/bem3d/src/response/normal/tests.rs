//! Stiffnesses compared with the literature and with a factor, and the parts of their stated error, in every
//! recipe.

use super::*;
use crate::active_set::{self, Control, Guess, Limits};
use crate::geometry::{CellSet, Grid};
use crate::linear::Factor;
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, Status, never};
use std::cell::Cell;
use std::f64::consts::PI;
use std::sync::Arc;

/// Solved to this, set errors and values agree to many digits.
const TIGHT: f64 = 1e-9;
/// Single precision in the estimates with a preconditioner.
const SINGLE: f64 = 1e-4;

/// Tuned constants that choose one recipe for every system: by pairs and by transforms, without and with the
/// preconditioner.
fn recipes() -> [Tuning; 4] {
    let without = Tuning { preconditioned: 2.0, preconditioned_large: 2.0, ..Tuning::DEFAULT };
    let with = Tuning { preconditioned: 0.0, ..without };
    let pairs = |tuning: Tuning| Tuning { pair_ns: 0.0, ..tuning };
    let transforms = |tuning: Tuning| Tuning { point_ns: 0.0, ..tuning };
    [pairs(with), transforms(with), pairs(without), transforms(without)]
}

/// The recipes with the preconditioner.
fn preconditioned() -> [Tuning; 2] {
    let [pairs, transforms, ..] = recipes();
    [pairs, transforms]
}

/// The stiffness of the whole contact.
fn solve(
    problem: &mut Problem,
    state: &Solved,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<NormalStiffness, Interrupted> {
    let wanted = StiffnessRequest { tolerance, q: guess, expected: None };
    super::solve(problem, state, &Responding::whole(state, Bounds::Unlimited), wanted, stop)
}

#[expect(clippy::large_types_passed_by_value, reason = "as `Problem::new`")]
fn flat(grid: Grid, tuning: Tuning) -> Problem {
    Problem::new(grid, Arc::new(vec![0.0; grid.count()]), Boundary::Free, &tuning)
}

/// A state with these pressures and gaps on all cells of a grid; contact where the pressure is positive.
fn state(grid: Grid, p: &[f64], gap: Vec<f64>) -> Solved {
    let checked = CellSet::all(grid);
    let contact = checked.filter(p, |p| p > 0.0);
    let p = p.iter().copied().filter(|&p| p > 0.0).collect();
    // All fields but these are those of a solve that has nothing to do.
    let guess = Guess { set: CellSet::from_index(grid, &[0]), p: vec![1.0], d: 1.0 };
    let limits = Limits { tolerance: 0.5, height: None, outer_iterations: 0, factor: false, is_guess: false };
    let problem = &mut flat(grid, Tuning::DEFAULT);
    let mut state = active_set::solve(problem, Control::Approach(1.0), guess, limits, &never).unwrap();
    (state.continuation.checked, state.continuation.gap) = (checked, gap);
    Solved { contact, p, d: 1.0, q: None, steps: 0, status: Status::Converged, ..state }
}

/// Full contact, nothing undecided.
fn full(grid: Grid) -> Solved {
    state(grid, &vec![1.0; grid.count()], vec![0.0; grid.count()])
}

/// The same state, factored.
fn factored(state: &Solved, grid: Grid) -> Solved {
    let factor = Factor::new(&NormalTable::shared(grid, Boundary::Free), &state.contact).unwrap();
    let (q, _) = factor.solve_pair(&vec![0.0; state.p.len()]);
    Solved { q: Some(q), ..state.clone() }
}

#[test]
fn full_contact_of_small_squares() {
    // data/paper/VALUES.md, given to 8 or 9 digits; k / (E* L) = pi k_scaled / N.
    for (side, expected) in
        [(1, 0.891_106_989), (2, 0.993_186_221), (4, 1.065_467_232), (8, 1.106_498_258), (16, 1.128_630_66)]
    {
        let grid = Grid::square(side, side);
        for (tuning, factor) in
            recipes().map(|tuning| (tuning, false)).into_iter().chain([(Tuning::DEFAULT, true)])
        {
            let mut problem = flat(grid, tuning);
            let (set, p) = (CellSet::all(grid), vec![1.0; grid.count()]);
            let guess = Guess { set, p, d: 4.0 * grid.count() as f64 };
            let limits =
                Limits { tolerance: 1e-9, height: None, outer_iterations: 100, factor, is_guess: false };
            let solved = active_set::solve(&mut problem, Control::Force(1.0), guess, limits, &never).unwrap();
            assert_eq!((solved.status, solved.contact.len()), (Status::Converged, grid.count()));
            let k = solve(&mut problem, &solved, None, 1e-9, &never).unwrap();
            assert_relative_eq!(PI * k.k() / side as f64, expected, max_relative = 5e-9);
            assert!(k.error() < 1e-9, "{}", k.error());
        }
    }
}

#[test]
fn the_estimate_covers_a_loose_solve() {
    for grid in [Grid::square(32, 32), Grid { columns: 40, rows: 21, stretch: 1.2 }] {
        let state = full(grid);
        let exact: f64 = factored(&state, grid).q.unwrap().iter().sum();
        for tuning in recipes() {
            let mut problem = flat(grid, tuning);
            for tolerance in [1e-1, 1e-2, 1e-3, 1e-4, 1e-9] {
                let loose = solve(&mut problem, &state, None, tolerance, &never).unwrap();
                let (error, estimate) = ((loose.k() / exact - 1.0).abs(), loose.solve_error);
                let rounding = 1e-12;
                assert!(
                    error <= estimate + rounding && estimate <= tolerance,
                    "{tolerance}: {error} {estimate}"
                );
                assert!(loose.k() <= exact * (1.0 + rounding), "a Ritz value is a lower bound");
            }
        }
    }
}

#[test]
fn both_parts_of_the_error_add_up() {
    let k = NormalStiffness { solve_error: 0.25, set_error: 0.5, ..NormalStiffness::unknown() };
    assert_relative_eq!(k.error(), 0.75);
    assert!(NormalStiffness::unknown().error().is_infinite());
}

#[test]
fn cells_on_the_wrong_side_by_hand() {
    for grid in [Grid::square(2, 2), Grid { columns: 4, rows: 1, stretch: 1.6 }] {
        let table = NormalTable::shared(grid, Boundary::Free);
        let (eigenvalue, own) = (table.smallest_eigenvalue(), table.own());
        // The second contact cell carries less than its gap of 0.4 may change; the first far more.
        let estimate = |p: f64| {
            let doubtful = state(grid, &[3.0, 0.0, p, 0.0], vec![0.01, -0.2, 0.4, 1.0]);
            let left = doubtful.gap_on(&doubtful.contact);
            let doubts = Doubts { undecided: CellSet::default(), left, room: doubtful.p };
            doubts.change(&table, &[0.2, 0.3], &[0.7])
        };
        let added = 0.3f64.powi(2) / eigenvalue;
        let removed = 0.3f64.powi(2) * own;
        assert_relative_eq!(estimate(0.1), added + removed, max_relative = 1e-14);
        assert_relative_eq!(estimate(0.4 / eigenvalue), added, max_relative = 1e-14);
        assert_relative_eq!(estimate(1.0), added, max_relative = 1e-14);
    }
}

#[test]
fn the_stated_error_of_an_undecided_corner_is_what_the_corner_changes() {
    // A small map with and without one corner. Schur complements lie between the smallest eigenvalue and
    // G_jj: the estimate exceeds the change by a factor between 1 and 1.9325 for square cells.
    for grid in [Grid::square(4, 4), Grid { columns: 6, rows: 3, stretch: 1.2 }] {
        let table = NormalTable::shared(grid, Boundary::Free);
        let excess = table.own() / table.smallest_eigenvalue();
        let value = |state: &Solved| factored(state, grid).q.unwrap().iter().sum::<f64>();
        let with = value(&full(grid));
        if grid == Grid::square(4, 4) {
            // data/paper/VALUES.md.
            assert_relative_eq!(PI * with / 4.0, 1.065_467_232, max_relative = 5e-9);
        }
        let (mut p, mut gap) = (vec![1.0; grid.count()], vec![0.0; grid.count()]);
        (p[0], gap[0]) = (0.0, -1e-9);
        let open = state(grid, &p, gap.clone());
        (p[0], gap[0]) = (1e-12, 1e-9);
        let closed = state(grid, &p, gap);
        let without = value(&open);
        for (state, own) in [(&open, without), (&closed, with)] {
            let exact = factored(state, grid);
            let ways = recipes().map(|tuning| (tuning, state)).into_iter().chain([(Tuning::DEFAULT, &exact)]);
            for (tuning, state) in ways {
                let k = solve(&mut flat(grid, tuning), state, None, TIGHT, &never).unwrap();
                assert_relative_eq!(k.k(), own, max_relative = TIGHT);
                let ratio = k.set_error * k.k() / (with - without);
                assert!((1.0..excess).contains(&ratio), "{grid:?}: {ratio}");
            }
        }
    }
}

#[test]
fn every_recipe_states_the_same_error_of_a_guess() {
    // A uniform q is a poor guess; a tolerance that it meets returns its bounds.
    for grid in [Grid::square(8, 8), Grid { columns: 5, rows: 12, stretch: 0.9 }] {
        let (state, guess) = (full(grid), vec![0.05; grid.count()]);
        let exact: f64 = factored(&state, grid).q.unwrap().iter().sum();
        let [pairs, transforms, plain_pairs, plain_transforms] = recipes().map(|tuning| {
            let k = solve(&mut flat(grid, tuning), &state, Some(guess.clone()), 10.0, &never).unwrap();
            assert_eq!((k.steps, k.q()), (0, guess.as_slice()));
            assert!(k.solve_error > 1e-3 && k.solve_error >= exact / k.k() - 1.0);
            k
        });
        for (one, two) in [(&pairs, &transforms), (&plain_pairs, &plain_transforms)] {
            assert_relative_eq!(one.solve_error, two.solve_error, max_relative = SINGLE);
        }
        for other in [&transforms, &plain_pairs, &plain_transforms] {
            assert_relative_eq!(pairs.k(), other.k(), max_relative = 1e-12);
        }
    }
}

#[test]
fn a_good_guess_costs_no_step_and_a_cold_start_a_few() {
    for grid in [Grid::square(32, 32), Grid::square(45, 20)] {
        let state = full(grid);
        for tuning in preconditioned() {
            let mut problem = flat(grid, tuning);
            let cold = solve(&mut problem, &state, None, 1e-4, &never).unwrap();
            let (cold_work, steps) = (problem.operators.plans.applications, cold.steps);
            // Counts, not times: one correction reaches what is asked, and one exact application says so.
            assert_eq!(cold_work, steps + 1);
            assert!((3..=8).contains(&steps) && cold_work <= 10, "{steps} steps, {cold_work} applications");
            let tight = solve(&mut problem, &state, Some(cold.q().to_vec()), TIGHT, &never).unwrap();
            assert!(tight.steps > 0);
            let before = problem.operators.plans.applications;
            let warm = solve(&mut problem, &state, Some(tight.q().to_vec()), 1e-6, &never).unwrap();
            assert_eq!(warm.steps, 0);
            // Where one application would be a transform, the first is one in single precision.
            let looks =
                if problem.operators.last().unwrap().to_string().starts_with("direct") { 1 } else { 2 };
            assert_eq!(problem.operators.plans.applications - before, looks, "it is good enough");
        }
        // That of a factored state is exact.
        let mut problem = flat(grid, Tuning::DEFAULT);
        let exact = solve(&mut problem, &factored(&state, grid), None, TIGHT, &never).unwrap();
        assert!(exact.steps == 0 && exact.solve_error < 1e-12, "{}", exact.solve_error);
        assert_eq!(problem.operators.plans.applications, 1);
        assert!(
            !problem.operators.last().unwrap().has_preconditioner(),
            "a factored state needs no transform"
        );
    }
}

#[test]
fn a_stopped_solve_claims_nothing() {
    let grid = Grid::square(8, 8);
    for tuning in recipes() {
        let mut problem = flat(grid, tuning);
        let polls = Cell::new(0);
        let count = || {
            polls.set(polls.get() + 1);
            false
        };
        assert!(solve(&mut problem, &full(grid), None, TIGHT, &count).unwrap().solve_error <= TIGHT);
        assert!(polls.get() > 3);
        for before in [0, 1, 2] {
            polls.set(0);
            let few = || {
                polls.set(polls.get() + 1);
                polls.get() > before
            };
            let stopped = solve(&mut problem, &full(grid), None, TIGHT, &few);
            assert!(stopped.is_err() && polls.get() == before + 1, "nothing is asked after a stop");
        }
    }
    let nothing = state(grid, &[0.0; 64], vec![1.0; 64]);
    assert!(
        solve(&mut flat(grid, Tuning::DEFAULT), &nothing, None, TIGHT, &never).unwrap().error().is_infinite()
    );
}

#[test]
fn an_unattainable_tolerance_ends_when_nothing_improves() {
    let grid = Grid::square(16, 16);
    for tuning in preconditioned() {
        let mut problem = flat(grid, tuning);
        let k = solve(&mut problem, &full(grid), None, -1.0, &never).unwrap();
        assert!(k.solve_error < 1e-13, "{}", k.solve_error);
        let work = problem.operators.plans.applications;
        println!("{work} applications {} steps", k.steps);
        assert!(work <= 70, "{work} applications");
        // Every application but the exact ones is a step, those that changed nothing included.
        assert!(work - k.steps <= 12, "{work} applications, {} steps", k.steps);
    }
}
