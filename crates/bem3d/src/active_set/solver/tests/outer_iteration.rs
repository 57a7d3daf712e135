//! Single outer iterations, and the gap compared with plain sums.

use super::*;

const EIGHT: Grid = Grid { columns: 8, rows: 8, stretch: 1.0 };
const FORCE: Control = Control::Force(1.0);

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
    assert!(solver_above.evaluate(Look::Exact, &never).unwrap().complete);
    assert_relative_eq!(solver_above.now.d, depth, max_relative = 1e-14);
    assert_relative_eq!(solver_above.reach, 1.05 * depth, max_relative = 1e-14);
    assert!(!solver_above.evaluate(Look::Rough, &never).unwrap().complete, "single precision is no evidence");
    let mut solver_below = solver(&mut problem, 0, 1.0, true);
    assert!(
        !solver_below.evaluate(Look::Exact, &never).unwrap().complete,
        "the plane ended above the listed cells"
    );
    assert!(solver_below.evaluate(Look::Exact, &never).unwrap().complete);
}

#[test]
fn the_change_of_a_gap_is_known_to_its_uncertainty() {
    let grid = Grid::square(60, 60);
    let target = Control::Force(900.0);
    for (tuning, begins, _) in recipes() {
        let mut single = false;
        let mut problem = problem(grid, &rough(grid, 7), tuning);
        let Guess { set, p, d } = everything(grid, target);
        let now = Pressure { contact: set, p, d, q: None };
        let mut solver = Solver::new(&mut problem, target, limits(false), now, Continuation::default());
        solver.evaluate(Look::Exact, &never).unwrap();
        for look in [Look::Change, Look::Change, Look::Rough, Look::Exact, Look::Change] {
            solver.improve(1e-3, &never).unwrap();
            let known = solver.measured.is_some();
            let evaluated = solver.evaluate(look, &never).unwrap();
            let Solver { now, state, uncertainty, problem, .. } = &mut solver;
            let mut exact = Vec::new();
            problem.operators.exact(&now.contact, &now.p, &state.checked, &mut exact, &never).unwrap();
            problem.candidates.add_to(&state.checked, &mut exact);
            let errors = exact.iter().zip(&state.gap).map(|(u, gap)| (u - now.d - gap).abs());
            let error = errors.fold(0.0, f64::max);
            let what = format!("{begins} {look:?}: {error:.1e}, said to be {uncertainty:.1e}");
            assert!(known && error <= *uncertainty + DOUBLE * now.d, "{what}");
            // Only a gap in double precision is evidence.
            assert_eq!(evaluated.complete, *uncertainty <= 0.0, "{what}");
            single |= *uncertainty > 0.0;
            assert!(look != Look::Exact || *uncertainty <= 0.0, "{what}");
        }
        assert_eq!(single, !begins.starts_with("direct"), "{begins}");
    }
}

#[test]
fn a_factored_approach_is_measured_not_replaced() {
    let mut problem = summit();
    let mut solver = solver(&mut problem, 0, 5.0, true);
    solver.now.q = Some(vec![1.0]);
    let evaluated = solver.evaluate(Look::Exact, &never).unwrap();
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
        solver.improve(1.0, &never).unwrap();
        assert_eq!(solver.now.contact, set(&[0]));
        assert_relative_eq!(solver.now.d, influence(0, 0), max_relative = 1e-14);
        assert_relative_eq!(solver.reach, 1.05 * solver.now.d, max_relative = 1e-14);
        assert_eq!(problem.operators.plans.solves, factors, "gap {gap}");
    }
}

#[test]
fn a_cell_without_pressure_is_not_in_contact() {
    // Without a step an inner solve changes nothing: the neighbour that was added still carries nothing.
    for recipe in recipes() {
        let mut problem = summit();
        problem.operators =
            crate::operator::Operators::new(NormalTable::shared(EIGHT, Boundary::Free), &recipe.0);
        let mut solver = solver(&mut problem, 0, 5.0, false);
        solver.state = Continuation { checked: set(&[0, 1]), gap: vec![0.5, -0.8], reach: 5.0 };
        solver.left = vec![0.5];
        solver.inner_steps = 0;
        solver.improve(1.0, &never).unwrap();
        assert_eq!(solver.now.contact, set(&[0]));
        assert_eq!(solver.now.p, [1.0]);
        assert!(solver.now.q.is_none());
    }
    // First touch: no cell carries anything, whatever the set.
    let mut flat = problem(EIGHT, &[0.0; 64], Tuning::DEFAULT);
    assert!(eliminate(&mut flat, &set(&[0, 1, 2, 3]), Control::Approach(0.0), &never).unwrap().is_none());
}

#[test]
fn the_kept_pressure_is_returned_where_it_is_the_best() {
    // A good pressure, and two that follow it on cells far below.
    let mut problem = summit();
    let mut solver = solver(&mut problem, 0, 5.0, false);
    let first = solver.evaluate(Look::Exact, &never).unwrap().residuals;
    solver.now_is_best = true;
    for cell in [63, 9] {
        solver.advance(Pressure { contact: set(&[cell]), p: vec![1.0], d: 5.0, q: None });
        assert_eq!(
            (&solver.best.contact, solver.now_is_best),
            (&set(&[0]), false),
            "kept until another is better"
        );
    }
    assert!(solver.evaluate(Look::Exact, &never).unwrap().residuals.worst() > first.worst());
}

#[test]
fn residuals_of_ever_more_iterations_never_become_worse() {
    // What is returned is the better of the best and the last; the best is replaced when residuals fall by a
    // tenth.
    let grid = Grid::square(20, 13);
    let z = rough(grid, 8);
    for (target, factor) in
        [(Control::Force(20.0), false), (Control::Approach(3.0), false), (Control::Force(20.0), true)]
    {
        let mut last = f64::INFINITY;
        for outer_iterations in 0..30 {
            let mut problem = problem(grid, &z, Tuning::DEFAULT);
            let limits = Limits { tolerance: 1e-30, outer_iterations, ..limits(factor) };
            let solved = solve(&mut problem, target, everything(grid, target), limits, &never).unwrap();
            let mut solver = Solver::new(
                &mut problem,
                target,
                limits,
                Pressure { contact: solved.contact, p: solved.p, d: solved.d, q: solved.q },
                Continuation { reach: 2.0 * solved.d, ..Continuation::default() },
            );
            // The residuals are those of the pressure that is returned.
            let measured = solver.evaluate(Look::Exact, &never).unwrap().residuals;
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
    (grid, z, Guess { set, p, d: 1.0 })
}

#[test]
fn a_gap_equals_that_of_plain_sums() {
    let (grid, z, guess) = bowl();
    for height in [None, Some(0.3)] {
        for target in [Control::Force(7.0), Control::Approach(0.5), Control::Approach(6.0)] {
            // Pressure on the whole grid, brought to the force.
            let sum: f64 = guess.p.iter().sum();
            let factor = if let Control::Force(force) = target { force / sum } else { 1.0 };
            let all = CellSet::all(grid);
            let p: Vec<f64> = all.carry(&guess.set, &guess.p).iter().map(|p| p * factor).collect();
            let mut gap = vec![0.0; grid.count()];
            DirectSum(&NormalTable::shared(grid, Boundary::Free)).apply(&all, &p, &all, &mut gap);
            for (g, z) in gap.iter_mut().zip(&z) {
                *g += z;
            }
            let d = match target {
                // The mean weighted by the pressure.
                Control::Force(force) => p.iter().zip(&gap).map(|(p, g)| p * g).sum::<f64>() / force,
                Control::Approach(d) => d,
            };
            for g in &mut gap {
                *g -= d;
            }
            let under = ContactGap { contact: &all, left: &gap, checked: &all, gap: &gap };
            let expected = Residuals::measure(Bounds::Unlimited, &p, under, height.unwrap_or(d));
            // By pairs and by transforms.
            for recipe in recipes().into_iter().take(2) {
                let mut problem = problem(grid, &z, recipe.0);
                let now = Pressure { contact: guess.set.clone(), p: guess.p.clone(), d: guess.d, q: None };
                let limits = Limits { tolerance: 1e-6, height, ..limits(false) };
                let from = Continuation { reach: 40.0, ..Continuation::default() };
                let mut solver = Solver::new(&mut problem, target, limits, now, from);
                let evaluated = solver.evaluate(Look::Exact, &never).unwrap();
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
                // Sums over pairs are exact, single precision is no evidence.
                assert_eq!(solver.evaluate(Look::Rough, &never).unwrap().complete, recipe.1 == "direct");
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
    let mut solver = Solver::new(&mut problem, Control::Approach(plane), limits, now, from);
    let evaluated = solver.evaluate(Look::Exact, &never).unwrap();
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
