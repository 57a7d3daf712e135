//! A look on arrays beside plain sums in double precision.

use super::*;
use crate::active_set::Problem;
use crate::cells::CellSet;
use crate::certificate::measure;
use approx::assert_relative_eq;
use contact_model::{Boundary, never};
use std::sync::Arc;

/// Rounding of a double-precision transform, in units of the largest displacement.
const DOUBLE: f64 = 1e-12;
const SIDE: usize = 12;

fn limits(height: Option<f64>) -> Limits {
    Limits { tolerance: 1e-6, height, rounds: 10, dense: false }
}

/// A bowl with a few steps, and pressure on a part of it.
fn bowl() -> (Problem, Guess) {
    let z: Vec<f64> = (0..SIDE * SIDE)
        .map(|i| {
            let (x, y) = ((i % SIDE) as f64 - 5.0, (i / SIDE) as f64 - 6.0);
            (x * x + y * y) / 20.0 + (i % 3) as f64 / 10.0
        })
        .collect();
    let cells: Vec<u32> = (0..(SIDE * SIDE) as u32).filter(|&i| z[i as usize] < 0.8).collect();
    let p = (0..cells.len()).map(|k| 0.2 + (k % 4) as f64 / 10.0).collect();
    let guess = Guess { set: CellSet::new(SIDE, cells), p, d: 1.0, far: false };
    (Problem::new(SIDE, Arc::new(z), Boundary::Free), guess)
}

fn ground<'a>(problem: &'a mut Problem, target: Target, guess: &Guess, height: Option<f64>) -> Filled<'a> {
    let Problem { candidates, operators, arrays, .. } = problem;
    Filled::new(candidates, operators, arrays, target, guess, limits(height))
}

/// Pressure on the contact set, over the whole grid.
fn pressed(filled: &Filled) -> Vec<f64> {
    let mut p = vec![0.0; SIDE * SIDE];
    for (&i, &value) in filled.now.set.cells().index().iter().zip(&filled.now.p) {
        p[i as usize] = value;
    }
    p
}

/// Pressure brought to a force, and `K p + z`, by plain sums.
fn plain(guess: &Guess, force: Option<f64>) -> (Vec<f64>, Vec<f64>) {
    let (problem, _) = bowl();
    let mut p = vec![0.0; SIDE * SIDE];
    for (&i, &value) in guess.set.index().iter().zip(&guess.p) {
        p[i as usize] = value;
    }
    let sum: f64 = p.iter().sum();
    let factor = force.map_or(1.0, |force| force / sum);
    for p in &mut p {
        *p *= factor;
    }
    let lifted = (0..SIDE * SIDE)
        .map(|i| {
            let u = |j: usize| {
                let lag = |a: usize, b: usize| a.abs_diff(b);
                p[j] * crate::love::influence(lag(i % SIDE, j % SIDE), lag(i / SIDE, j / SIDE))
            };
            (0..SIDE * SIDE).map(u).sum::<f64>() + problem.candidates.z()[i]
        })
        .collect();
    (p, lifted)
}

#[test]
fn a_look_measures_what_plain_sums_measure() {
    let (mut problem, guess) = bowl();
    for height in [None, Some(0.3)] {
        for target in [Target::Force(7.0), Target::Approach(0.5), Target::Approach(6.0)] {
            let force = if let Target::Force(force) = target { Some(force) } else { None };
            let (p, mut gap) = plain(&guess, force);
            let d = match target {
                // The mean weighted by the pressure.
                Target::Force(force) => p.iter().zip(&gap).map(|(p, g)| p * g).sum::<f64>() / force,
                Target::Approach(d) => d,
            };
            for g in &mut gap {
                *g -= d;
            }
            let expected = measure(&p, &gap, height.unwrap_or(d));
            let mut filled = ground(&mut problem, target, &guess, height);
            let seen = filled.look(false);
            assert!(seen.complete && !seen.factored);
            assert_relative_eq!(seen.d, d, max_relative = DOUBLE);
            for (found, expected) in [
                (seen.evidence.duality_gap, expected.duality_gap),
                (seen.evidence.penetration, expected.penetration),
                (seen.evidence.complementarity, expected.complementarity),
                (seen.evidence.deepest, expected.deepest),
            ] {
                assert_relative_eq!(found, expected, epsilon = DOUBLE, max_relative = DOUBLE);
            }
            let squares: Vec<f64> =
                p.iter().zip(&gap).filter(|&(&p, _)| p > 0.0).map(|(_, g)| g * g).collect();
            let rms = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
            assert_relative_eq!(filled.residual, rms, max_relative = 1e-10);
            assert!(!filled.look(true).complete, "single precision is no evidence");
        }
    }
}

#[test]
fn without_pressure_the_relief_itself_is_seen() {
    let (mut problem, guess) = bowl();
    let nothing = Guess { p: vec![0.0; guess.p.len()], ..guess };
    // The gap of a cell at the height of the plane is 0: it touches and is not looked at again.
    let plane = problem.candidates.z()[SIDE * 6 + 7];
    let below = problem.candidates.below(plane);
    let lowest = problem.candidates.z().iter().copied().fold(f64::INFINITY, f64::min);
    let mut filled = ground(&mut problem, Target::Approach(plane), &nothing, Some(2.0));
    let seen = filled.look(false);
    assert_relative_eq!(seen.evidence.worst(), (plane - lowest) / 2.0, max_relative = 1e-14);
    assert!(filled.residual == 0.0);
    let solved = filled.finish(Status::Stopped, None, seen, 0);
    assert!(solved.contact.is_empty());
    assert_eq!(solved.look.checked.index(), below.index());
}

#[test]
fn a_cell_joins_when_it_penetrates_by_more_than_the_noise() {
    let (mut problem, guess) = bowl();
    let corner = Guess { set: CellSet::new(SIDE, vec![0]), p: vec![1.0], ..guess };
    let mut filled = ground(&mut problem, Target::Force(1.0), &corner, None);
    let seen = filled.look(false);
    filled.residual = 0.25;
    // The gap is counted from a reference that lies half a unit below the plane.
    filled.reference = filled.d - 0.5;
    filled.arrays.gap.fill(1.5);
    (filled.arrays.gap[1], filled.arrays.gap[2]) = (0.25, 0.24);
    let mut steps = 0;
    filled.improve(seen, &mut steps, &never);
    assert!(steps > 0);
    assert_eq!(filled.arrays.vectors.set.cells().index(), [0, 2]);
    assert!(pressed(&filled)[3..].iter().all(|&p| p == 0.0));
}

#[test]
fn the_kept_pressure_is_returned_with_what_presses_and_what_penetrates() {
    let (mut problem, guess) = bowl();
    let (p, lifted) = plain(&guess, None);
    let mut order = lifted.clone();
    order.sort_by(f64::total_cmp);
    // Half of the grid penetrates.
    let d = f64::midpoint(order[71], order[72]);
    let target = Target::Approach(d);
    let mut filled = ground(&mut problem, target, &guess, None);
    let first = filled.look(false);
    filled.keep();
    // A round that has lost most of the pressure.
    let lost = Pressed { set: Runs::of(&CellSet::new(SIDE, vec![5])), p: vec![1e-3] };
    filled.best = std::mem::replace(&mut filled.now, lost);
    filled.now_is_best = false;
    let last = filled.look(false);
    let solved = filled.finish(Status::Stagnated, Some(first), last, 5);
    assert_eq!((solved.contact.index(), solved.steps), (guess.set.index(), 5));
    // What the gap left on the contact can move may penetrate; the grid is so small that all of it is near.
    let left_over =
        p.iter().zip(&lifted).filter(|&(&p, _)| p > 0.0).map(|(_, l)| (l - d).abs()).fold(0.0, f64::max);
    let may = |i: usize| p[i] > 0.0 || lifted[i] < d + left_over;
    let expected: Vec<u32> = (0..(SIDE * SIDE) as u32).filter(|&i| may(i as usize)).collect();
    assert!(expected.len() > guess.set.len());
    assert_eq!(solved.look.checked.index(), expected);
    assert_relative_eq!(solved.look.evidence.deepest, first.evidence.deepest);
    for (k, &i) in expected.iter().enumerate() {
        assert_relative_eq!(solved.look.p[k], p[i as usize]);
        assert_relative_eq!(solved.look.gap[k], lifted[i as usize] - d, epsilon = 1e-6);
    }
}

#[test]
fn the_best_pressure_survives_the_rounds_that_follow() {
    let (mut problem, guess) = bowl();
    let mut filled = ground(&mut problem, Target::Force(3.0), &guess, Some(1.0));
    let first = filled.look(false);
    filled.keep();
    let kept = pressed(&filled);
    for rounds in 1..3 {
        filled.improve(first, &mut 0, &never);
        filled.look(false);
        assert!(pressed(&filled).iter().zip(&kept).any(|(a, b)| (a - b).abs() > 1e-6), "round {rounds}");
    }
    let last = filled.look(false);
    let solved = filled.finish(Status::Stagnated, Some(first), last, 0);
    let expected: Vec<f64> = kept.into_iter().filter(|&p| p > 0.0).collect();
    assert_eq!(solved.p.len(), expected.len());
    for (p, expected) in solved.p.iter().zip(&expected) {
        assert_relative_eq!(p, expected, max_relative = 1e-14);
    }
}
