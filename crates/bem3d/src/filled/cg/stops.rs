//! Each reason to stop, beside a twin that restarts to see where every step has led; solutions beside a factor.

use super::*;
use crate::cells::CellSet;
use crate::filled::runs::marks;
use crate::operator::{Table, dense::Factor};
use contact_model::{Boundary, never};

const SIDE: usize = 16;
/// Single precision inside: what one correction can be asked for, relative to the norm of the solution.
const SINGLE: f64 = 1e-4;

fn operators() -> Operators {
    Operators::new(Table::shared(SIDE, Boundary::Free))
}

fn scattered() -> CellSet {
    CellSet::new(SIDE, (0..(SIDE * SIDE) as u32).filter(|i| (i * i + i / 7) % 5 < 3).collect())
}

/// Right-hand sides of magnitude 1 on the set. What other vectors hold from before must not matter.
fn loaded() -> Vectors {
    let mut v = Vectors::new(SIDE);
    v.take(SIDE, marks(&scattered()));
    for (r, &i) in v.r.iter_mut().zip(scattered().index()) {
        *r = 0.7 + 0.3 * (i as f32 * 1.3).sin();
    }
    v.x.fill(9.0);
    v
}

fn endless(steps: usize) -> Request {
    Request { fixed_sum: false, reduction: 0.0, energy: None, floor: 0.0, steps, exact: true }
}

/// After each number of steps: estimated energy of the error, value gained, largest residual.
fn path() -> Vec<(f64, f64, f64)> {
    let mut operators = operators();
    let right = loaded().r;
    let after = |steps: usize| {
        let mut v = loaded();
        assert_eq!(correct(&mut operators, &mut v, endless(steps), &never).steps, steps);
        let gain = v.x.iter().zip(&right).map(|(&x, &r)| f64::from(x) * f64::from(r)).sum();
        let largest = v.r.iter().fold(0.0, |m: f64, &r| m.max(f64::from(r.abs())));
        (correct(&mut operators, &mut v, endless(0), &never).start, gain, largest)
    };
    (0..9).map(after).collect()
}

#[test]
fn it_stops_at_the_first_step_that_meets_a_request() {
    let path = path();
    let stopped = |request: Request| correct(&mut operators(), &mut loaded(), request, &never).steps;
    let first = |from: usize, met: &dyn Fn(&(f64, f64, f64)) -> bool| {
        path.iter().skip(from).position(met).unwrap() + from
    };
    for share in [3e-1, 3e-2, 3e-3, 3e-4] {
        for base in [0.0, 200.0] {
            let expected = first(0, &|&(energy, gain, _)| TORUS * energy <= share * (base + gain));
            let request = Request { energy: Some(Energy { share, base }), ..endless(50) };
            assert_eq!(stopped(request), expected, "energy {share} {base}");
        }
    }
    for reduction in [2.0, 0.3, 0.1, 0.03, 0.01] {
        // The first step is always taken.
        let expected = first(1, &|&(energy, ..)| energy <= reduction * reduction * path[0].0);
        assert_eq!(stopped(Request { reduction, ..endless(50) }), expected, "reduction {reduction}");
    }
    for floor in [2.0, 0.3, 0.1, 0.03] {
        let expected = first(0, &|&(_, _, largest)| largest <= floor);
        assert_eq!(stopped(Request { floor, ..endless(50) }), expected, "floor {floor}");
    }
    assert!(path[8].0 < 1e-3 * path[0].0, "eight steps gain something");
    assert_eq!(correct(&mut operators(), &mut loaded(), endless(50), &|| true).steps, 0);
}

#[test]
fn it_reaches_the_factored_solution() {
    let set = scattered();
    let right: Vec<f64> = loaded().r.iter().map(|&r| f64::from(r)).collect();
    let mut operators = operators();
    let (q, w) = Factor::new(operators.table(), &set).unwrap().solve_pair(&right);
    let norm = crate::cg::dot(&w, &w).sqrt();
    for fixed_sum in [false, true] {
        let before = operators.solves;
        let mut v = loaded();
        let request = Request { fixed_sum, reduction: 1e-5, ..endless(60) };
        let done = correct(&mut operators, &mut v, request, &never);
        assert_eq!(operators.solves, before + 1);
        // Eight times the gap asks for eight times the pressure, to the last bit, in as many steps.
        let mut eight = loaded();
        for r in &mut eight.r {
            *r *= 8.0;
        }
        assert_eq!(correct(&mut operators, &mut eight, request, &never).steps, done.steps);
        assert!(eight.x.iter().zip(&v.x).all(|(a, b)| (a - 8.0 * b).abs() <= 0.0));
        // Work, not time: the preconditioner makes the number of steps small.
        assert!(done.steps <= 25, "{} steps", done.steps);
        let shift = if fixed_sum { w.iter().sum::<f64>() / q.iter().sum::<f64>() } else { 0.0 };
        for ((&x, w), q) in v.x.iter().zip(&w).zip(&q) {
            let x = f64::from(x);
            assert!((x - (w - shift * q)).abs() < SINGLE * norm, "{fixed_sum}: {x} {}", w - shift * q);
        }
        if fixed_sum {
            let sum: f64 = v.x.iter().map(|&x| f64::from(x)).sum();
            assert!(sum.abs() < SINGLE * norm, "{sum}");
        }
    }
}
