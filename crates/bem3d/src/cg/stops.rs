//! Each reason to stop, beside a twin that looks at the state after every step in double precision.

use super::*;
use crate::love::SMALLEST_EIGENVALUE;
use crate::operator::Table;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};

const SIDE: usize = 16;

fn operators() -> Operators {
    Operators::new(Table::shared(SIDE, Boundary::Free))
}

fn scattered() -> CellSet {
    CellSet::new(SIDE, (0..(SIDE * SIDE) as u32).filter(|i| (i * i + i / 7) % 5 < 3).collect())
}

fn right(n: usize, unit: f64) -> Vec<f64> {
    (0..n).map(|k| unit * (1.0 + 0.5 * (k as f64 * 1.3).sin())).collect()
}

/// Nothing but the number of steps ends it.
fn endless(precondition: bool, steps: usize) -> Request {
    Request { fixed_sum: false, reduction: 0.0, energy: None, floor: 0.0, steps, precondition, exact: true }
}

/// The correction after each of the first steps, with the residual that it leaves.
fn path(set: &CellSet, right: &[f64], precondition: bool) -> Vec<(Vec<f64>, Vec<f64>)> {
    let mut operators = operators();
    let after = |steps: usize| {
        let got = correct(&mut operators, set, right, endless(precondition, steps), &never);
        assert_eq!(got.steps, steps);
        let u = operators.exact(set, &got.x, set);
        (got.x, right.iter().zip(&u).map(|(r, u)| r - u).collect())
    };
    (0..9).map(after).collect()
}

#[test]
fn the_energy_of_the_error_is_compared_with_the_value_gained() {
    // r'K^-1 r of what is left, at most |r|^2 / eigenvalue or 2 r'M r, against a share of base + r'x: to be found at the first
    // step where it holds, in any unit.
    let set = scattered();
    for unit in [1.0, 1e3] {
        let right = right(set.len(), unit);
        for precondition in [false, true] {
            let path = path(&set, &right, precondition);
            let mut found = Vec::new();
            for share in [3e-1, 3e-2, 3e-3, 3e-4] {
                for base in [0.0, 200.0 * unit * unit] {
                    let small = |(x, r): &(Vec<f64>, Vec<f64>)| {
                        energy(&mut operators(), &set, r, precondition) <= share * (base + dot(x, &right))
                    };
                    let expected = path[1..].iter().position(small).unwrap() + 1;
                    let energy = Some(Energy { share, base });
                    let request = Request { energy, ..endless(precondition, 50) };
                    let got = correct(&mut operators(), &set, &right, request, &never);
                    assert_eq!(got.steps, expected, "{unit} {precondition} {share} {base}");
                    found.push(got.steps);
                }
            }
            assert!(found.iter().max().unwrap() >= &3, "this test is about several steps: {found:?}");
        }
    }
}

#[test]
fn the_floor_is_the_largest_residual() {
    let set = scattered();
    for unit in [1.0, 1e-3] {
        let right = right(set.len(), unit);
        let path = path(&set, &right, false);
        let largest = |r: &[f64]| r.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        for share in [0.3, 0.1, 0.03] {
            let floor = share * unit;
            let expected = path[1..].iter().position(|(_, r)| largest(r) <= floor).unwrap() + 1;
            let request = Request { floor, ..endless(false, 50) };
            assert_eq!(correct(&mut operators(), &set, &right, request, &never).steps, expected);
        }
    }
}

#[test]
fn work_is_counted_and_a_uniform_gap_asks_for_none_under_a_given_force() {
    let set = scattered();
    let mut operators = operators();
    let uniform = vec![1.0; set.len()];
    let request = Request { fixed_sum: true, ..endless(false, 5) };
    let got = correct(&mut operators, &set, &uniform, request, &never);
    assert!(got.steps == 0 && got.x.iter().all(|&x| x == 0.0));
    assert_eq!((operators.applications, operators.solves), (0, 1));
    correct(&mut operators, &set, &uniform, endless(true, 5), &never);
    assert_eq!((operators.applications, operators.solves), (5, 2));
}

#[test]
fn the_eigenvalue_bounds_the_energy_by_hand() {
    let pair = CellSet::new(SIDE, vec![0, 1]);
    let found = energy(&mut operators(), &pair, &[1.0, -2.0], false);
    assert_relative_eq!(found, 5.0 / SMALLEST_EIGENVALUE, max_relative = 1e-14);
    // The checkerboard on a full grid comes close to its eigenvalue, the smallest one.
    let all = CellSet::new(SIDE, (0..(SIDE * SIDE) as u32).collect());
    let board: Vec<f64> =
        (0..all.len()).map(|k| if (k + k / SIDE).is_multiple_of(2) { 1.0 } else { -1.0 }).collect();
    let u = operators().exact(&all, &board, &all);
    let eigenvalue = dot(&board, &u) / dot(&board, &board);
    assert!((1.0..1.1).contains(&(eigenvalue / SMALLEST_EIGENVALUE)), "{eigenvalue}");
}
