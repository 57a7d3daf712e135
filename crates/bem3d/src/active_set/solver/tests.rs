//! Whole solves in every recipe, single outer iterations, and the gap beside plain sums.

use super::*;
use crate::geometry::Grid;
use crate::kernel::KernelTable;
use crate::kernel::love::influence;
use crate::operator::{DirectSum, InfluenceOperator};
use crate::stiffness;
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};
use proptest::prelude::*;
use std::sync::Arc;

const TOLERANCE: f64 = 1e-9;
/// Rounding of a double-precision transform, in units of the largest displacement.
const DOUBLE: f64 = 1e-12;

#[expect(clippy::large_types_passed_by_value, reason = "as `Problem::new`")]
fn problem(grid: Grid, z: &[f64], tuning: Tuning) -> Problem {
    Problem::new(grid, Arc::new(z.to_vec()), Boundary::Free, &tuning)
}

fn limits(factor: bool) -> Limits {
    Limits { tolerance: TOLERANCE, height: Some(1.0), outer_iterations: 200, factor }
}

/// Uniform pressure everywhere.
fn everything(grid: Grid, target: Target) -> Guess {
    let d = match target {
        Target::Force(force) => force * 4.0,
        Target::Approach(d) => d,
    };
    Guess { set: CellSet::all(grid), p: vec![1.0; grid.count()], d, far: false }
}

/// Reproducible rough gaps, lowest 0.
fn rough(grid: Grid, seed: u64) -> Vec<f64> {
    let mut state = seed.wrapping_mul(2).wrapping_add(1);
    let mut z: Vec<f64> = (0..grid.count())
        .map(|_| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        })
        .collect();
    let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
    for z in &mut z {
        *z -= lowest;
    }
    z
}

/// Tuned constants that choose one recipe for every system, and how its description begins and ends.
fn recipes() -> [(Tuning, &'static str, &'static str); 5] {
    let never = Tuning { preconditioned: 2.0, preconditioned_large: 2.0, ..Tuning::DEFAULT };
    let always = Tuning { preconditioned: 0.0, ..never };
    let pairs = |tuning: Tuning| Tuning { pair_ns: 0.0, ..tuning };
    let transforms = |tuning: Tuning| Tuning { point_ns: 0.0, ..tuning };
    let two_levels =
        Tuning { pair_ns: 1e9, point_ns: 1e3, close_pair_ns: 0.0, spread_ns: 0.0, scattered: 0, ..never };
    [
        (pairs(never), "direct", "direct"),
        (transforms(never), "fft", "f32 in f64"),
        (pairs(always), "direct, ", ""),
        (transforms(always), "fft", ""),
        (two_levels, "two levels", "order 6"),
    ]
}

/// The recipe of the last system is the one that the tuned constants are made for.
fn assert_recipe(problem: &Problem, (_, begins, ends): (Tuning, &str, &str)) {
    let recipe = problem.operators.last().unwrap().to_string();
    assert!(recipe.starts_with(begins) && recipe.ends_with(ends), "{recipe}");
}

#[test]
fn every_recipe_finds_the_factored_state() {
    let squares = [1, 2, 3, 31].map(|n| (n, n, 1.0, Boundary::Free));
    let others = [
        (48, 29, 1.0, Boundary::Free),
        (1, 40, 1.0, Boundary::Free),
        (24, 31, 1.4, Boundary::Free),
        (21, 21, 1.0, Boundary::Periodic),
        (30, 16, 0.8, Boundary::Periodic),
    ];
    for (columns, rows, stretch, boundary) in squares.into_iter().chain(others) {
        let grid = Grid { columns, rows, stretch };
        let z = Arc::new(rough(grid, 9));
        let scale = (grid.count() as f64).sqrt() / 48.0;
        let forces = [0.3, 2.0, 30.0, 600.0 * scale].map(Target::Force);
        for target in forces.into_iter().chain([Target::Approach(0.7)]) {
            let what = format!("{grid:?} {boundary:?} {target:?}");
            let always = Tuning { always_factored: usize::MAX, ..Tuning::DEFAULT };
            let mut reference = Problem::new(grid, Arc::clone(&z), boundary, &always);
            let exact = solve(&mut reference, target, everything(grid, target), limits(true), &never);
            assert_eq!(exact.status, Status::Converged, "{what}");
            // A single cell under a force is solved by its guess.
            assert!(exact.q.is_some() || grid.count() == 1, "{what}");
            let k: Option<f64> = exact.q.as_ref().map(|q| q.iter().sum());
            for recipe in recipes() {
                let known = boundary == Boundary::Free && grid.has_square_cells();
                if recipe.1 == "two levels" && (!known || columns.min(rows) < 31) {
                    continue;
                }
                let mut problem = Problem::new(grid, Arc::clone(&z), boundary, &recipe.0);
                let found = solve(&mut problem, target, everything(grid, target), limits(false), &never);
                assert_eq!(
                    (found.status, found.q.is_some()),
                    (Status::Converged, false),
                    "{what} {}",
                    recipe.1
                );
                assert_eq!(found.contact, exact.contact, "{what} {}", recipe.1);
                assert_relative_eq!(found.d, exact.d, max_relative = 1e-7);
                let peak = largest(&exact.p);
                for (a, b) in found.p.iter().zip(&exact.p) {
                    assert!((a - b).abs() < 1e-6 * peak, "{what} {}: {a} {b}", recipe.1);
                }
                if problem.operators.last().is_some() {
                    assert_recipe(&problem, recipe);
                }
                let Some(k) = k else { continue };
                let tangent = stiffness::solve(&mut problem, &exact, None, TOLERANCE, &never);
                assert_relative_eq!(tangent.value, k, max_relative = TOLERANCE);
                let tangent = stiffness::solve(&mut problem, &found, None, TOLERANCE, &never);
                assert!(tangent.solve_error <= TOLERANCE, "{what} {}: {tangent:?}", recipe.1);
                assert_relative_eq!(tangent.value, k, max_relative = 1e-8);
            }
        }
    }
}

#[test]
fn the_stiffness_of_a_large_contact_is_the_same_in_every_recipe() {
    let grid = Grid::square(96, 96);
    let z = rough(grid, 4);
    let target = Target::Force(4000.0);
    let mut first = problem(grid, &z, Tuning::DEFAULT);
    let solved = solve(&mut first, target, everything(grid, target), limits(false), &never);
    assert!(solved.contact.len() > grid.count() / 3, "{} cells", solved.contact.len());
    let reference = stiffness::solve(&mut first, &solved, None, 1e-8, &never);
    assert!(first.operators.last().unwrap().has_preconditioner());
    for recipe in recipes() {
        let mut problem = problem(grid, &z, recipe.0);
        let found = stiffness::solve(&mut problem, &solved, None, 1e-8, &never);
        assert_recipe(&problem, recipe);
        assert_relative_eq!(found.value, reference.value, max_relative = 1e-8);
        assert!(found.solve_error <= 1e-8 && found.solve_error > 0.0, "{}", found.solve_error);
        assert_relative_eq!(found.set_error, reference.set_error, epsilon = 1e-8);
    }
}

#[test]
fn a_state_taken_up_again_is_not_evaluated_again() {
    let loose = Limits { tolerance: 1e-2, ..limits(false) };
    for (columns, rows, force) in [(31, 31, 2.0), (96, 96, 4000.0), (57, 20, 30.0)] {
        let (grid, target) = (Grid::square(columns, rows), Target::Force(force));
        let z = rough(grid, 4);
        let [again, resumed] = [false, true].map(|resumed| {
            let mut problem = problem(grid, &z, Tuning::DEFAULT);
            let solved = solve(&mut problem, target, everything(grid, target), loose, &never);
            assert_eq!(solved.status, Status::Converged);
            let before = problem.operators.applications;
            let tight = if resumed {
                resume(&mut problem, target, solved, limits(false), &never)
            } else {
                let guess = Guess { set: solved.contact, p: solved.p, d: solved.d, far: false };
                solve(&mut problem, target, guess, limits(false), &never)
            };
            assert_eq!(tight.status, Status::Converged);
            (tight, problem.operators.applications - before)
        });
        assert_eq!(resumed.1 + 1, again.1, "one application less");
        assert_eq!(resumed.0.contact, again.0.contact);
        assert_relative_eq!(resumed.0.d, again.0.d, max_relative = 1e-8);
        // Stopped at once, it is the state that it was.
        let mut problem = problem(grid, &z, Tuning::DEFAULT);
        let solved = solve(&mut problem, target, everything(grid, target), loose, &never);
        let (contact, d, residuals) = (solved.contact.clone(), solved.d, solved.residuals);
        let work = problem.operators.applications;
        let same = resume(&mut problem, target, solved, limits(false), &|| true);
        assert_eq!((same.status, same.steps), (Status::Stopped, 0));
        assert_eq!(problem.operators.applications, work);
        assert_eq!(same.contact, contact);
        assert_relative_eq!(same.d, d);
        assert_relative_eq!(same.residuals.worst(), residuals.worst());
    }
}

#[test]
fn work_of_standard_solves_is_pinned() {
    // Counts, not times: a change of the algorithm shows here. The band leaves room for other processors'
    // last digits.
    let grid = Grid::square(64, 64);
    for (force, most) in [(0.5, 50), (5.0, 60), (50.0, 60)] {
        let mut problem = problem(grid, &rough(grid, 3), Tuning::DEFAULT);
        let target = Target::Force(force);
        let solved = solve(&mut problem, target, everything(grid, target), limits(false), &never);
        assert_eq!(solved.status, Status::Converged);
        let work = problem.operators.applications;
        println!("force {force}: {work} applications");
        assert!(work <= most, "force {force}: {work} applications, {most} were enough");
    }
}

#[test]
fn an_unreachable_tolerance_stagnates_and_keeps_the_best() {
    let grid = Grid::square(16, 16);
    let mut problem = problem(grid, &rough(grid, 5), Tuning::DEFAULT);
    let target = Target::Force(3.0);
    let limits = Limits { tolerance: 1e-30, ..limits(false) };
    let solved = solve(&mut problem, target, everything(grid, target), limits, &never);
    assert_eq!(solved.status, Status::Stagnated);
    assert!(solved.residuals.worst() < 1e-11, "{}", solved.residuals.worst());
}

#[test]
fn stop_and_the_limit_of_iterations_are_told_apart() {
    let grid = Grid::square(16, 16);
    let target = Target::Force(3.0);
    let z = rough(grid, 5);
    let mut first = problem(grid, &z, Tuning::DEFAULT);
    let stopped = solve(&mut first, target, everything(grid, target), limits(false), &|| true);
    assert_eq!(stopped.status, Status::Stopped);
    let mut second = problem(grid, &z, Tuning::DEFAULT);
    let few = Limits { outer_iterations: 1, ..limits(false) };
    let limited = solve(&mut second, target, everything(grid, target), few, &never);
    assert_eq!(limited.status, Status::IterationLimit);
    assert!(!limited.p.is_empty());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::default() })]

    #[test]
    fn factoring_and_iterating_find_the_same_state(
        columns in 1usize..14, rows in 1usize..14, stretch in prop_oneof![Just(1.0), 0.7f64..1.4],
        seed in any::<u64>(), force in 0.01..60.0f64,
    ) {
        let grid = Grid { columns, rows, stretch };
        let target = Target::Force(force);
        let [exact, iterated] = [true, false].map(|factor| {
            let mut problem = problem(grid, &rough(grid, seed), Tuning::DEFAULT);
            solve(&mut problem, target, everything(grid, target), limits(factor), &never)
        });
        prop_assert_eq!(exact.status, Status::Converged);
        prop_assert_eq!(iterated.status, Status::Converged);
        prop_assert!((exact.d - iterated.d).abs() <= 1e-8 * (1.0 + exact.d));
        // A single cell is solved by its guess.
        prop_assert!(grid.count() == 1 || (exact.q.is_some() && iterated.q.is_none() && iterated.steps > 0));
        if exact.q.is_some() {
            prop_assert!(exact.residuals.worst() <= 1e-12 * (1.0 + exact.d));
        }
    }

    #[test]
    fn force_and_approach_are_two_ways_to_one_state(
        columns in 2usize..14, rows in 1usize..14, seed in any::<u64>(), force in 0.01..60.0f64,
    ) {
        let grid = Grid::square(columns, rows);
        let mut problem = problem(grid, &rough(grid, seed), Tuning::DEFAULT);
        let target = Target::Force(force);
        let pressed = solve(&mut problem, target, everything(grid, target), limits(true), &never);
        let target = Target::Approach(pressed.d);
        let moved = solve(&mut problem, target, everything(grid, target), limits(true), &never);
        assert_relative_eq!(moved.p.iter().sum::<f64>(), force, max_relative = 1e-9);
    }
}

const EIGHT: Grid = Grid { columns: 8, rows: 8, stretch: 1.0 };
const FORCE: Target = Target::Force(1.0);

fn set(index: &[u32]) -> CellSet {
    CellSet::from_index(EIGHT, index)
}

/// A summit, a neighbour ten units below it, and all the rest far below: under a unit force the summit alone
/// carries, and `d = I(0, 0)`.
fn summit() -> Problem {
    let mut z = vec![100.0; 64];
    (z[0], z[1]) = (0.0, 10.0);
    problem(EIGHT, &z, Tuning::DEFAULT)
}

/// Unit pressure on one cell; candidates are wanted up to d.
fn solver(problem: &mut Problem, cell: u32, d: f64, factor: bool) -> Solver<'_> {
    let now = Pressure { contact: set(&[cell]), p: vec![1.0], d, q: None };
    let limits = Limits { tolerance: 1e-6, ..limits(factor) };
    Solver::new(problem, FORCE, limits, now, Continuation { reach: d, ..Continuation::default() })
}

#[test]
fn a_gap_is_complete_up_to_where_candidates_were_listed() {
    let depth = influence(0, 0);
    let mut problem = summit();
    let mut solver_above = solver(&mut problem, 0, 5.0, true);
    assert!(solver_above.evaluate(false).complete);
    assert_relative_eq!(solver_above.now.d, depth, max_relative = 1e-14);
    assert_relative_eq!(solver_above.reach, 1.05 * depth, max_relative = 1e-14);
    assert!(!solver_above.evaluate(true).complete, "single precision is no evidence");
    let mut solver_below = solver(&mut problem, 0, 1.0, true);
    assert!(!solver_below.evaluate(false).complete, "the plane ended above the listed cells");
    assert!(solver_below.evaluate(false).complete);
}

#[test]
fn a_factored_approach_is_measured_not_replaced() {
    let mut problem = summit();
    let mut solver = solver(&mut problem, 0, 5.0, true);
    solver.now.q = Some(vec![1.0]);
    let evaluated = solver.evaluate(false);
    assert!(evaluated.factored);
    assert_relative_eq!(solver.now.d, 5.0);
    let off = 5.0 - influence(0, 0);
    assert_relative_eq!(evaluated.residuals.complementarity, off, max_relative = 1e-14);
}

#[test]
fn a_cell_is_added_when_it_penetrates_by_more_than_the_noise() {
    // A gap of 0.5 is left on the summit: that is the noise. Under its own load the neighbour is in tension,
    // which costs a second factor.
    for (gap, factors) in [(0.3, 1), (-0.3, 1), (-0.5, 1), (-0.51, 2)] {
        let mut problem = summit();
        let mut solver = solver(&mut problem, 0, 5.0, true);
        solver.state = Continuation { checked: set(&[0, 1]), gap: vec![0.5, gap], reach: 5.0 };
        solver.left = vec![0.5];
        solver.improve(1.0, &never);
        assert_eq!(solver.now.contact, set(&[0]));
        assert_relative_eq!(solver.now.d, influence(0, 0), max_relative = 1e-14);
        assert_relative_eq!(solver.reach, 1.05 * solver.now.d, max_relative = 1e-14);
        assert_eq!(problem.operators.solves, factors, "gap {gap}");
    }
}

#[test]
fn a_cell_without_pressure_is_not_in_contact() {
    // Stopped before the first step, an inner solve changes nothing: the neighbour that was added still
    // carries nothing.
    for recipe in recipes() {
        let mut problem = summit();
        problem.operators =
            crate::operator::Operators::new(KernelTable::shared(EIGHT, Boundary::Free), &recipe.0);
        let mut solver = solver(&mut problem, 0, 5.0, false);
        solver.state = Continuation { checked: set(&[0, 1]), gap: vec![0.5, -0.8], reach: 5.0 };
        solver.left = vec![0.5];
        solver.improve(1.0, &|| true);
        assert_eq!(solver.now.contact, set(&[0]));
        assert_eq!(solver.now.p, [1.0]);
        assert!(solver.now.q.is_none());
    }
    // First touch: no cell carries anything, whatever the set.
    let mut flat = problem(EIGHT, &[0.0; 64], Tuning::DEFAULT);
    assert!(eliminate(&mut flat, &set(&[0, 1, 2, 3]), Target::Approach(0.0)).is_none());
}

#[test]
fn the_kept_pressure_is_returned_where_it_is_the_best() {
    // A good pressure, and two that follow it on cells far below.
    let mut problem = summit();
    let mut solver = solver(&mut problem, 0, 5.0, false);
    let first = solver.evaluate(false).residuals;
    solver.now_is_best = true;
    for cell in [63, 9] {
        solver.advance(Pressure { contact: set(&[cell]), p: vec![1.0], d: 5.0, q: None });
        assert_eq!(
            (&solver.best.contact, solver.now_is_best),
            (&set(&[0]), false),
            "kept until another is better"
        );
    }
    assert!(solver.evaluate(false).residuals.worst() > first.worst());
}

#[test]
fn residuals_of_ever_more_iterations_never_become_worse() {
    // What is returned is the better of the best and the last; the best is replaced when residuals fall by a
    // tenth.
    let grid = Grid::square(20, 13);
    let z = rough(grid, 8);
    for (target, factor) in
        [(Target::Force(20.0), false), (Target::Approach(3.0), false), (Target::Force(20.0), true)]
    {
        let mut last = f64::INFINITY;
        for outer_iterations in 0..30 {
            let mut problem = problem(grid, &z, Tuning::DEFAULT);
            let limits = Limits { tolerance: 1e-30, outer_iterations, ..limits(factor) };
            let solved = solve(&mut problem, target, everything(grid, target), limits, &never);
            let mut solver = Solver::new(
                &mut problem,
                target,
                limits,
                Pressure { contact: solved.contact, p: solved.p, d: solved.d, q: solved.q },
                Continuation { reach: 2.0 * solved.d, ..Continuation::default() },
            );
            // The residuals are those of the pressure that is returned.
            let measured = solver.evaluate(false).residuals;
            assert_relative_eq!(
                measured.worst(),
                solved.residuals.worst(),
                epsilon = 1e-13,
                max_relative = 1e-3
            );
            let worst = measured.worst();
            assert!(
                worst <= last / 0.89 + 1e-13,
                "{target:?} {factor} {outer_iterations}: {worst} after {last}"
            );
            last = worst;
        }
        assert!(last < 1e-11, "{last}");
    }
}

/// A bowl with a few steps on cells that are no squares, and pressure on a part of it.
fn bowl() -> (Grid, Vec<f64>, Guess) {
    let grid = Grid { columns: 12, rows: 11, stretch: 1.1 };
    let z: Vec<f64> = (0..grid.count())
        .map(|i| {
            let (x, y) = ((i % 12) as f64 - 5.0, (i / 12) as f64 - 6.0);
            (x * x + y * y) / 20.0 + (i % 3) as f64 / 10.0
        })
        .collect();
    let set = CellSet::of_grid(grid, &z, |z| z < 0.8);
    let p = (0..set.len()).map(|k| 0.2 + (k % 4) as f64 / 10.0).collect();
    (grid, z, Guess { set, p, d: 1.0, far: false })
}

#[test]
fn a_gap_is_what_plain_sums_say() {
    let (grid, z, guess) = bowl();
    for height in [None, Some(0.3)] {
        for target in [Target::Force(7.0), Target::Approach(0.5), Target::Approach(6.0)] {
            // Pressure on the whole grid, brought to the force.
            let sum: f64 = guess.p.iter().sum();
            let factor = if let Target::Force(force) = target { force / sum } else { 1.0 };
            let all = CellSet::all(grid);
            let p: Vec<f64> = all.carry(&guess.set, &guess.p).iter().map(|p| p * factor).collect();
            let mut gap = vec![0.0; grid.count()];
            DirectSum(&KernelTable::shared(grid, Boundary::Free)).apply(&all, &p, &all, &mut gap);
            for (g, z) in gap.iter_mut().zip(&z) {
                *g += z;
            }
            let d = match target {
                // The mean weighted by the pressure.
                Target::Force(force) => p.iter().zip(&gap).map(|(p, g)| p * g).sum::<f64>() / force,
                Target::Approach(d) => d,
            };
            for g in &mut gap {
                *g -= d;
            }
            let lowest = gap.iter().copied().fold(f64::INFINITY, f64::min);
            let expected = Residuals::measure(&p, &gap, lowest, height.unwrap_or(d));
            // By pairs and by transforms.
            for recipe in recipes().into_iter().take(2) {
                let mut problem = problem(grid, &z, recipe.0);
                let now = Pressure { contact: guess.set.clone(), p: guess.p.clone(), d: guess.d, q: None };
                let limits = Limits { tolerance: 1e-6, height, ..limits(false) };
                let from = Continuation { reach: 40.0, ..Continuation::default() };
                let mut solver = Solver::new(&mut problem, target, limits, now, from);
                let evaluated = solver.evaluate(false);
                assert!(evaluated.complete && !evaluated.factored);
                assert_relative_eq!(solver.now.d, d, max_relative = DOUBLE);
                for (found, expected) in [
                    (evaluated.residuals.duality_gap, expected.duality_gap),
                    (evaluated.residuals.penetration, expected.penetration),
                    (evaluated.residuals.complementarity, expected.complementarity),
                    (evaluated.residuals.deepest, expected.deepest),
                ] {
                    assert_relative_eq!(found, expected, epsilon = DOUBLE, max_relative = DOUBLE);
                }
                assert_eq!(solver.state.checked.len(), grid.count());
                for (found, expected) in solver.state.gap.iter().zip(&gap) {
                    assert_relative_eq!(found, expected, epsilon = 10.0 * DOUBLE);
                }
                assert_eq!(solver.left, guess.set.carry(&solver.state.checked, &solver.state.gap));
                assert!(!solver.evaluate(true).complete, "single precision is no evidence");
            }
        }
    }
}

#[test]
fn without_pressure_the_surface_itself_is_the_gap() {
    let (grid, z, guess) = bowl();
    // The gap of a cell at the height of the plane is 0: it touches, and is no candidate.
    let plane = z[12 * 6 + 7];
    let mut problem = problem(grid, &z, Tuning::DEFAULT);
    let below = problem.candidates.below(plane);
    let now = Pressure { contact: guess.set, p: vec![0.0; guess.p.len()], d: 1.0, q: None };
    let limits = Limits { height: Some(2.0), ..limits(false) };
    let from = Continuation { reach: plane, ..Continuation::default() };
    let mut solver = Solver::new(&mut problem, Target::Approach(plane), limits, now, from);
    let evaluated = solver.evaluate(false);
    let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
    assert_relative_eq!(evaluated.residuals.worst(), (plane - lowest) / 2.0, max_relative = 1e-14);
    assert_eq!(solver.state.checked, below.union(&solver.now.contact));
}

#[test]
fn the_noise_is_the_root_mean_square_of_the_gap_left() {
    assert_relative_eq!(root_mean_square(&[3.0, -4.0]), 12.5f64.sqrt());
    // Squares of these are no numbers of f64.
    let tiny = root_mean_square(&[3e-200, 4e-200]);
    assert_relative_eq!(tiny, 12.5f64.sqrt() * 1e-200, epsilon = 0.0, max_relative = 1e-14);
    assert_relative_eq!(root_mean_square(&[3e200, 4e200]), 12.5f64.sqrt() * 1e200, max_relative = 1e-14);
    assert_relative_eq!(root_mean_square(&[0.0]), 0.0);
    assert_relative_eq!(root_mean_square(&[]), 0.0);
}

#[test]
fn no_force_comes_from_no_pressure() {
    let mut none = [0.0; 3];
    rescale(&mut none, 5.0);
    assert!(none.iter().all(|&p| p == 0.0));
    let mut some = [1.0, 3.0];
    rescale(&mut some, 2.0);
    assert_relative_eq!(some[..], [0.5, 1.5][..]);
}
