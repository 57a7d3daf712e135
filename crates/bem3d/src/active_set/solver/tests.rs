//! Whole solves in every recipe.

use super::*;
use crate::active_set::Bounds;
use crate::geometry::Grid;
use crate::kernel::NormalTable;
use crate::kernel::love::influence;
use crate::operator::{DirectSum, InfluenceOperator};
use crate::response::normal::{self, Responding, StiffnessRequest};
use crate::tuning::Tuning;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};
use proptest::prelude::*;
use std::iter::zip;
use std::sync::Arc;

mod outer_iteration;

const TOLERANCE: f64 = 1e-9;
/// Rounding of a double-precision transform, in units of the largest displacement.
const DOUBLE: f64 = 1e-12;

#[expect(clippy::large_types_passed_by_value, reason = "as `Problem::new`")]
fn problem(grid: Grid, z: &[f64], tuning: Tuning) -> Problem {
    Problem::new(grid, Arc::new(z.to_vec()), Boundary::Free, &tuning)
}

fn limits(factor: bool) -> Limits {
    Limits { tolerance: TOLERANCE, height: Some(1.0), outer_iterations: 200, factor, is_guess: false }
}

/// Uniform pressure everywhere.
fn everything(grid: Grid, target: Control) -> Guess {
    let d = match target {
        Control::Force(force) => force * 4.0,
        Control::Approach(d) => d,
    };
    Guess { set: CellSet::all(grid), p: vec![1.0; grid.count()], d }
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
fn recipes() -> [(Tuning, &'static str, &'static str); 6] {
    let never = Tuning { preconditioned: 2.0, preconditioned_large: 2.0, ..Tuning::DEFAULT };
    let always = Tuning { preconditioned: 0.0, ..never };
    let pairs = |tuning: Tuning| Tuning { pair_ns: 0.0, ..tuning };
    let transforms = |tuning: Tuning| Tuning { point_ns: 0.0, ..tuning };
    // A near part so short that the window is larger.
    let two_transforms = Tuning { pair_ns: 1e9, filter_ns: 0.0, dense_reach: 6, shortened: 2.0, ..always };
    let two_levels =
        Tuning { pair_ns: 1e9, point_ns: 1e3, close_pair_ns: 0.0, spread_ns: 0.0, scattered: 0, ..never };
    [
        (pairs(never), "direct", "direct"),
        (transforms(never), "fft", "f32 in f64"),
        (pairs(always), "direct, ", ""),
        (transforms(always), "fft", ""),
        (two_levels, "two levels", "order 6"),
        (two_transforms, "two transforms", ""),
    ]
}

/// Asserts that the last system was solved with the recipe that these tuned constants select.
fn assert_recipe(problem: &Problem, (_, begins, ends): (Tuning, &str, &str)) {
    let recipe = problem.operators.last().unwrap().to_string();
    assert!(recipe.starts_with(begins) && recipe.ends_with(ends), "{recipe}");
}

/// A surface under a load, and its factored state.
struct FactoredState {
    grid: Grid,
    boundary: Boundary,
    z: Arc<Vec<f64>>,
    target: Control,
    exact: Solved,
}

impl FactoredState {
    fn new(grid: Grid, boundary: Boundary, target: Control) -> Self {
        let z = Arc::new(rough(grid, 9));
        let always = Tuning { always_factored: usize::MAX, ..Tuning::DEFAULT };
        let mut reference = Problem::new(grid, Arc::clone(&z), boundary, &always);
        let exact = solve(&mut reference, target, everything(grid, target), limits(true), &never).unwrap();
        let factored = Self { grid, boundary, z, target, exact };
        assert_eq!(factored.exact.status, Status::Converged, "{factored}");
        // A single cell under a force is solved by its guess.
        assert!(factored.exact.q.is_some() || grid.count() == 1, "{factored}");
        factored
    }

    /// Asserts that a recipe finds the same contact, pressure, approach and stiffness.
    fn assert_found_by(&self, recipe: &(Tuning, &str, &str)) {
        let Self { grid, boundary, target, exact, .. } = self;
        let what = format!("{self} {}", recipe.1);
        let mut problem = Problem::new(*grid, Arc::clone(&self.z), *boundary, &recipe.0);
        let found = solve(&mut problem, *target, everything(*grid, *target), limits(false), &never).unwrap();
        assert_eq!((found.status, found.q.is_some()), (Status::Converged, false), "{what}");
        assert_eq!(found.contact, exact.contact, "{what}");
        assert_relative_eq!(found.d, exact.d, max_relative = 1e-7);
        let peak = largest(&exact.p);
        for (a, b) in found.p.iter().zip(&exact.p) {
            assert!((a - b).abs() < 1e-6 * peak, "{what}: {a} {b}");
        }
        if problem.operators.last().is_some() {
            assert_recipe(&problem, *recipe);
        }
        let Some(q) = &exact.q else { return };
        let k = q.iter().sum();
        let mut stiffness = |state: &Solved| {
            let request = StiffnessRequest { tolerance: TOLERANCE, q: None, expected: None };
            let responding = Responding::whole(state, Bounds::Unlimited);
            normal::solve(&mut problem, state, &responding, request, &never).unwrap()
        };
        assert_relative_eq!(stiffness(exact).k(), k, max_relative = TOLERANCE);
        let tangent = stiffness(&found);
        assert!(tangent.solve_error <= TOLERANCE, "{what}: {tangent:?}");
        assert_relative_eq!(tangent.k(), k, max_relative = 1e-8);
    }
}

impl std::fmt::Display for FactoredState {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?} {:?} {:?}", self.grid, self.boundary, self.target)
    }
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
        let scale = (grid.count() as f64).sqrt() / 48.0;
        let forces = [0.3, 2.0, 30.0, 600.0 * scale].map(Control::Force);
        for target in forces.into_iter().chain([Control::Approach(0.7)]) {
            let state = FactoredState::new(grid, boundary, target);
            for recipe in recipes() {
                let known = boundary == Boundary::Free && grid.has_square_cells();
                if !recipe.1.starts_with("two ") || (known && columns.min(rows) >= 31) {
                    state.assert_found_by(&recipe);
                }
            }
        }
    }
}

#[test]
fn the_stiffness_of_a_large_contact_is_the_same_in_every_recipe() {
    let grid = Grid::square(96, 96);
    let z = rough(grid, 4);
    let target = Control::Force(4000.0);
    let mut first = problem(grid, &z, Tuning::DEFAULT);
    let solved = solve(&mut first, target, everything(grid, target), limits(false), &never).unwrap();
    assert!(solved.contact.len() > grid.count() / 3, "{} cells", solved.contact.len());
    let reference = normal::solve(
        &mut first,
        &solved,
        &Responding::whole(&solved, Bounds::Unlimited),
        StiffnessRequest { tolerance: 1e-8, q: None, expected: None },
        &never,
    )
    .unwrap();
    assert!(first.operators.last().unwrap().has_preconditioner());
    for recipe in recipes() {
        let mut problem = problem(grid, &z, recipe.0);
        let found = normal::solve(
            &mut problem,
            &solved,
            &Responding::whole(&solved, Bounds::Unlimited),
            StiffnessRequest { tolerance: 1e-8, q: None, expected: None },
            &never,
        )
        .unwrap();
        assert_recipe(&problem, recipe);
        assert_relative_eq!(found.k(), reference.k(), max_relative = 1e-8);
        assert!(found.solve_error <= 1e-8 && found.solve_error > 0.0, "{}", found.solve_error);
        assert_relative_eq!(found.set_error, reference.set_error, epsilon = 1e-8);
    }
}

#[test]
fn a_resumed_state_is_not_evaluated_again() {
    let loose = Limits { tolerance: 1e-2, ..limits(false) };
    for (columns, rows, force) in [(31, 31, 2.0), (96, 96, 4000.0), (57, 20, 30.0)] {
        let (grid, target) = (Grid::square(columns, rows), Control::Force(force));
        let z = rough(grid, 4);
        let [again, resumed] = [false, true].map(|resumed| {
            let mut problem = problem(grid, &z, Tuning::DEFAULT);
            let solved = solve(&mut problem, target, everything(grid, target), loose, &never).unwrap();
            assert_eq!(solved.status, Status::Converged);
            let before = problem.operators.plans.applications;
            let tight = if resumed {
                resume(&mut problem, target, solved, limits(false), &never).unwrap()
            } else {
                let guess = Guess { set: solved.contact, p: solved.p, d: solved.d };
                solve(&mut problem, target, guess, limits(false), &never).unwrap()
            };
            assert_eq!(tight.status, Status::Converged);
            (tight, problem.operators.plans.applications - before)
        });
        assert!(resumed.1 <= again.1, "{} applications instead of {}", resumed.1, again.1);
        assert_eq!(resumed.0.contact, again.0.contact);
        assert_relative_eq!(resumed.0.d, again.0.d, max_relative = 1e-8);
        // Stopped at once, it is the state that it was.
        let mut problem = problem(grid, &z, Tuning::DEFAULT);
        let solved = solve(&mut problem, target, everything(grid, target), loose, &never).unwrap();
        let (contact, d, residuals) = (solved.contact.clone(), solved.d, solved.residuals);
        let work = problem.operators.plans.applications;
        let same = resume(&mut problem, target, solved, limits(false), &|| true).unwrap();
        assert_eq!((same.status, same.steps), (Status::Stopped, 0));
        assert_eq!(problem.operators.plans.applications, work);
        assert_eq!(same.contact, contact);
        assert_relative_eq!(same.d, d);
        assert_relative_eq!(same.residuals.worst(), residuals.worst());
    }
}

#[test]
fn a_guess_takes_no_application_in_double_precision() {
    let grid = Grid::square(128, 128);
    let (target, z) = (Control::Force(800.0), rough(grid, 6));
    let table = NormalTable::shared(grid, Boundary::Free);
    for is_guess in [false, true] {
        let recorder = Recorder::new(|| 0);
        let (z, tuning) = (Arc::new(z.clone()), Tuning::DEFAULT);
        let mut problem = Problem::recorded(grid, z, Boundary::Free, &tuning, &recorder);
        let limits = Limits { tolerance: 1e-2, is_guess, ..limits(false) };
        let solved = solve(&mut problem, target, everything(grid, target), limits, &never).unwrap();
        assert_eq!(solved.status, Status::Converged);
        assert_eq!(recorder.take().iter().all(|(part, _)| *part != Part::Double), is_guess);
        // What it says of itself is right up to single precision.
        let (checked, mut u) = (CellSet::all(grid), vec![0.0; grid.count()]);
        DirectSum(&table).apply(&solved.contact, &solved.p, &checked, &mut u);
        let deepest = zip(&u, problem.candidates.z()).map(|(u, z)| solved.d - u - z).fold(0.0, f64::max);
        assert!(deepest < 1.01 * 1e-2, "{deepest}");
    }
}

#[test]
fn inner_solves_that_their_steps_end_are_counted() {
    let grid = Grid::square(48, 48);
    let target = Control::Force(40.0);
    for (inner_steps, limited) in [(Tuning::DEFAULT.inner_steps, false), (1, true)] {
        let tuning = Tuning { inner_steps, ..Tuning::DEFAULT };
        let mut problem = problem(grid, &rough(grid, 3), tuning);
        let solved = solve(&mut problem, target, everything(grid, target), limits(false), &never).unwrap();
        assert_eq!(solved.status, Status::Converged);
        let plans = &problem.operators.plans;
        assert_eq!(plans.limited > 0, limited, "{} of {} solves", plans.limited, plans.solves);
    }
}

#[test]
fn work_of_standard_solves_is_pinned() {
    // Counts, not times: a change of the algorithm shows here. The range allows for the different rounding of
    // other processors.
    let grid = Grid::square(64, 64);
    for (force, most) in [(0.5, 50), (5.0, 60), (50.0, 60)] {
        let mut problem = problem(grid, &rough(grid, 3), Tuning::DEFAULT);
        let target = Control::Force(force);
        let solved = solve(&mut problem, target, everything(grid, target), limits(false), &never).unwrap();
        assert_eq!(solved.status, Status::Converged);
        let work = problem.operators.plans.applications;
        println!("force {force}: {work} applications");
        assert!(work <= most, "force {force}: {work} applications, {most} were enough");
    }
}

#[test]
fn an_unreachable_tolerance_stagnates_and_keeps_the_best() {
    let grid = Grid::square(16, 16);
    let mut problem = problem(grid, &rough(grid, 5), Tuning::DEFAULT);
    let target = Control::Force(3.0);
    let limits = Limits { tolerance: 1e-30, ..limits(false) };
    let solved = solve(&mut problem, target, everything(grid, target), limits, &never).unwrap();
    assert_eq!(solved.status, Status::Stagnated);
    assert!(solved.residuals.worst() < 1e-11, "{}", solved.residuals.worst());
}

#[test]
fn stop_and_the_limit_of_iterations_are_told_apart() {
    let grid = Grid::square(16, 16);
    let target = Control::Force(3.0);
    let z = rough(grid, 5);
    let mut first = problem(grid, &z, Tuning::DEFAULT);
    let stopped = solve(&mut first, target, everything(grid, target), limits(false), &|| true).unwrap();
    assert_eq!(stopped.status, Status::Stopped);
    let mut second = problem(grid, &z, Tuning::DEFAULT);
    let few = Limits { outer_iterations: 1, ..limits(false) };
    let limited = solve(&mut second, target, everything(grid, target), few, &never).unwrap();
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
        let target = Control::Force(force);
        let [exact, iterated] = [true, false].map(|factor| {
            let mut problem = problem(grid, &rough(grid, seed), Tuning::DEFAULT);
            solve(&mut problem, target, everything(grid, target), limits(factor), &never).unwrap()
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
        let target = Control::Force(force);
        let pressed = solve(&mut problem, target, everything(grid, target), limits(true), &never).unwrap();
        let target = Control::Approach(pressed.d);
        let moved = solve(&mut problem, target, everything(grid, target), limits(true), &never).unwrap();
        assert_relative_eq!(moved.p.iter().sum::<f64>(), force, max_relative = 1e-9);
    }
}
