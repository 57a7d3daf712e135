//! The error that a stiffness states, part by part, in each of the three ways that it is found.

use super::*;
use crate::active_set::Look;
use crate::cells::CellSet;
use crate::certificate::Evidence;
use approx::assert_relative_eq;
use contact_model::{Boundary, Status, never};
use std::cell::Cell;
use std::sync::Arc;

/// Solved to this, set errors and values agree to many digits.
const TIGHT: f64 = 1e-9;
/// Single precision in the estimates of arrays.
const SINGLE: f64 = 1e-4;

type Way = fn(&mut Problem, &Solved, Option<Vec<f64>>, f64, Stop<'_>) -> Stiffness;

/// The two iterations.
const ITERATIONS: [Way; 2] = [on_lists, filled];

/// By factorisation; neither guess nor tolerance matter.
const FACTORED: Way = |problem, state, _, _, _| {
    let table = crate::operator::Table::shared(problem.side, Boundary::Free);
    let factor = crate::operator::dense::Factor::new(&table, &state.contact).unwrap();
    let (q, _) = factor.solve_pair(&vec![0.0; state.p.len()]);
    factored(problem, state, q)
};

fn flat(side: usize) -> Problem {
    Problem::new(side, Arc::new(vec![0.0; side * side]), Boundary::Free)
}

/// A state with these pressures and gaps on all cells of a grid; contact where the pressure is positive.
fn state(side: usize, p: Vec<f64>, gap: Vec<f64>) -> Solved {
    let all: Vec<u32> = (0..(side * side) as u32).collect();
    let checked = CellSet::new(side, all);
    let contact = checked.filter(|k| p[k] > 0.0);
    let pressing = p.iter().copied().filter(|&p| p > 0.0).collect();
    let look = Look { checked, p, gap, evidence: Evidence::default() };
    Solved { contact, p: pressing, d: 1.0, q: None, look, steps: 0, status: Status::Converged }
}

/// Full contact of a square, nothing undecided.
fn full(side: usize) -> Solved {
    state(side, vec![1.0; side * side], vec![0.0; side * side])
}

#[test]
fn both_parts_of_the_error_add_up() {
    let k = Stiffness { solve_error: 0.25, set_error: 0.5, ..Stiffness::unknown() };
    assert_relative_eq!(k.error(), 0.75);
}

#[test]
fn undecided_cells_by_hand() {
    // Pressed with a gap of 0.5 left; penetrating, touching, open by less than that, open.
    let touch = state(
        3,
        vec![1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        vec![-0.5, -1.0, 0.0, 0.4, 0.5, 2.0, 2.0, 2.0, 2.0],
    );
    assert_eq!(touch.look.undecided().index(), [1, 2, 3]);
    // A solution without any gap on the contact leaves those that penetrate.
    let exact = state(2, vec![1.0, 0.0, 0.0, 0.0], vec![0.0, -1e-9, 0.0, 1e-9]);
    assert_eq!(exact.look.undecided().index(), [1]);
    // The second pressed cell carries less than its gap of 0.4 may change; the first far more.
    let eigenvalue = love::SMALLEST_EIGENVALUE;
    let doubtful = |p: f64| state(2, vec![3.0, 0.0, p, 0.0], vec![0.01, -0.2, 0.4, 1.0]);
    let added = 0.3f64.powi(2) / eigenvalue;
    let removed = 0.3f64.powi(2) * love::influence(0, 0);
    let estimate = |p: f64| set_error(&doubtful(p), [0.7].into_iter(), &[0.2, 0.3]);
    assert_relative_eq!(estimate(0.1), added + removed, max_relative = 1e-14);
    assert_relative_eq!(estimate(0.4 / eigenvalue), added, max_relative = 1e-14);
    assert_relative_eq!(estimate(1.0), added, max_relative = 1e-14);
}

#[test]
fn the_stated_error_of_an_undecided_corner_is_what_the_corner_changes() {
    // A square of 4 cells with and without one corner. Schur complements lie between the smallest eigenvalue and I(0, 0): the
    // estimate exceeds the change by a factor between 1 and 1.9325.
    let excess = love::influence(0, 0) / love::SMALLEST_EIGENVALUE;
    let mut problem = flat(4);
    let (mut p, mut gap) = (vec![1.0; 16], vec![0.0; 16]);
    let with = FACTORED(&mut problem, &full(4), None, TIGHT, &never).value;
    // data/paper/VALUES.md.
    assert_relative_eq!(std::f64::consts::PI * with / 4.0, 1.065_467_232, max_relative = 5e-9);
    (p[0], gap[0]) = (0.0, -1e-9);
    let open = state(4, p.clone(), gap.clone());
    (p[0], gap[0]) = (1e-12, 1e-9);
    let closed = state(4, p, gap);
    let without = FACTORED(&mut problem, &open, None, TIGHT, &never).value;
    for way in [FACTORED, ITERATIONS[0], ITERATIONS[1]] {
        for (state, own) in [(&open, without), (&closed, with)] {
            let k = way(&mut problem, state, None, TIGHT, &never);
            assert_relative_eq!(k.value, own, max_relative = TIGHT);
            let ratio = k.set_error * k.value / (with - without);
            assert!((1.0..excess).contains(&ratio), "{ratio}");
        }
    }
}

#[test]
fn lists_and_arrays_state_the_same_error() {
    // A uniform q is a poor guess; a tolerance that it meets returns its bounds.
    let side = 8;
    let guess = vec![0.05; side * side];
    let [lists, arrays] =
        ITERATIONS.map(|way| way(&mut flat(side), &full(side), Some(guess.clone()), 10.0, &never));
    assert_eq!((lists.steps, lists.q.as_slice()), (0, guess.as_slice()));
    assert!(lists.solve_error > 1e-3);
    assert_relative_eq!(lists.solve_error, arrays.solve_error, max_relative = SINGLE);
    assert_relative_eq!(lists.value, arrays.value, max_relative = 1e-12);
}

#[test]
fn a_good_guess_costs_no_step_and_a_cold_start_a_few() {
    let side = 32;
    let state = full(side);
    for way in ITERATIONS {
        let mut problem = flat(side);
        let cold = way(&mut problem, &state, None, 1e-4, &never);
        let (cold_work, steps) = (problem.operators.applications, cold.steps);
        // Counts, not times: one correction reaches what is asked, and one look says so.
        assert_eq!(cold_work, steps + 1);
        assert!((3..=8).contains(&steps) && cold_work <= 10, "{steps} steps, {cold_work} applications");
        let tight = way(&mut problem, &state, Some(cold.q), TIGHT, &never);
        assert!(tight.steps > 0);
        let before = problem.operators.applications;
        let warm = way(&mut problem, &state, Some(tight.q), 1e-6, &never);
        assert_eq!(warm.steps, 0);
        assert_eq!(problem.operators.applications - before, 1, "one look says that it is good enough");
    }
}

#[test]
fn a_stopped_solve_claims_nothing() {
    for way in ITERATIONS {
        let mut problem = flat(8);
        let k = way(&mut problem, &full(8), None, TIGHT, &|| true);
        assert!(k.solve_error.is_infinite() && k.q.is_empty());
        assert_eq!(problem.operators.applications, 1);
        // Stopped later, it returns what it has.
        let polls = Cell::new(0);
        let few = || {
            polls.set(polls.get() + 1);
            polls.get() > 3
        };
        let k = way(&mut problem, &full(8), None, TIGHT, &few);
        assert!(k.solve_error > TIGHT && k.solve_error < 1.0, "{}", k.solve_error);
    }
}

#[test]
fn an_unattainable_tolerance_ends_when_nothing_improves() {
    for way in ITERATIONS {
        let mut problem = flat(16);
        let k = way(&mut problem, &full(16), None, -1.0, &never);
        assert!(k.solve_error < 1e-13, "{}", k.solve_error);
        let work = problem.operators.applications;
        println!("{work} applications {} steps", k.steps);
        assert!(work <= 70, "{work} applications");
        // Every application but the looks in double precision is a step, those that changed nothing included.
        assert!(work - k.steps <= 12, "{work} applications, {} steps", k.steps);
    }
}
