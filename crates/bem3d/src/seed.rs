//! Where a cold solve begins: a small superset, or the same surface on a coarser grid.

use crate::active_set::{self, Guess, Limits, Problem, Target};
use crate::cells::CellSet;
use crate::{love, strategy};
use contact_model::Stop;
use std::sync::Arc;

/// Grids of this size or less are solved without a coarser one.
const COARSEST: usize = 48;
/// Tolerance on coarse grids: a seed, not a result.
const SEED_TOLERANCE: f64 = 1e-2;
/// Rounds at most on a coarse grid.
const SEED_ROUNDS: usize = 20;

/// A guess for a load with nothing known.
///
/// The cells with `z < F / k_1` (k_1: one cell alone, the softest contact) contain the contact set. If they are few they are the guess;
/// otherwise the surface averaged over 2 x 2 cells is solved first. A coarse grid only says where to begin: every fine cell
/// stays a candidate, because fractal summits vanish on coarse grids.
pub fn cold(problem: &mut Problem, target: Target, limits: Limits, stop: Stop<'_>) -> Guess {
    // The highest cell of a coarse grid lies below the plane of first touch.
    let (highest, first, deepest) = range(problem.candidates.z());
    let reach = match target {
        Target::Force(force) => first + force * love::influence(0, 0),
        Target::Approach(d) => d,
    };
    let reach = reach.min(2.0 * deepest + f64::MIN_POSITIVE);
    let from_above = |problem: &mut Problem| {
        let superset = problem.candidates.below(reach);
        active_set::with(&superset, &CellSet::new(problem.side, vec![highest]))
    };
    if problem.side <= COARSEST || !problem.levels {
        return uniform(from_above(problem), target, reach);
    }
    if limits.dense && !problem.candidates.more_than(strategy::LARGEST_FACTOR, reach) {
        let superset = from_above(problem);
        if strategy::dense_is_cheaper(superset.len(), superset.free_lengths()) {
            return uniform(superset, target, reach);
        }
    }
    let mut coarse = problem.coarser.take().unwrap_or_else(|| Box::new(coarser(problem)));
    if let Target::Approach(d) = target
        && range(coarse.candidates.z()).1 >= d
    {
        problem.coarser = Some(coarse);
        return uniform(from_above(problem), target, reach);
    }
    let limits = Limits { tolerance: SEED_TOLERANCE, rounds: SEED_ROUNDS, ..limits };
    // A force is a sum of scaled pressures, which double when the cell does and are a quarter as many.
    let coarse_target = match target {
        Target::Force(force) => Target::Force(force / 2.0),
        approach @ Target::Approach(_) => approach,
    };
    let guess = cold(&mut coarse, coarse_target, limits, stop);
    let solved = active_set::solve(&mut coarse, coarse_target, guess, limits, stop);
    let guess = prolong(problem, &coarse, &solved.contact, &solved.p, solved.d);
    problem.coarser = Some(coarse);
    guess
}

fn uniform(set: CellSet, target: Target, reach: f64) -> Guess {
    let pressure = match target {
        Target::Force(force) => force / set.len() as f64,
        // Any positive value: the first round sees the true gap.
        Target::Approach(d) => d / (love::influence(0, 0) * set.len() as f64),
    };
    Guess { p: vec![pressure; set.len()], set, d: reach, far: false }
}

/// The highest cell, its gap and the largest gap.
fn range(z: &[f64]) -> (u32, f64, f64) {
    let mut highest = 0;
    let mut deepest = 0.0f64;
    for (i, &value) in z.iter().enumerate() {
        if value < z[highest] {
            highest = i;
        }
        deepest = deepest.max(value);
    }
    (highest as u32, z[highest], deepest)
}

/// The same relief on cells twice as large: means of 2 x 2 (fewer at the last row and column of an odd grid).
fn coarser(problem: &Problem) -> Problem {
    let (fine, side) = (problem.side, problem.side.div_ceil(2));
    let z = problem.candidates.z();
    let mut mean = Vec::with_capacity(side * side);
    for y in 0..side {
        for x in 0..side {
            let (mut sum, mut count) = (0.0, 0.0);
            for fy in 2 * y..(2 * y + 2).min(fine) {
                for fx in 2 * x..(2 * x + 2).min(fine) {
                    sum += z[fy * fine + fx];
                    count += 1.0;
                }
            }
            mean.push(sum / count);
        }
    }
    Problem::new(side, Arc::new(mean), problem.operators.table().boundary())
}

/// Coarse pressure on the fine cells below it that lie under the plane (all four if none does).
fn prolong(problem: &Problem, coarse: &Problem, contact: &CellSet, p: &[f64], d: f64) -> Guess {
    let (fine, z) = (problem.side, problem.candidates.z());
    let (mut index, mut pressure) = (Vec::with_capacity(4 * p.len()), Vec::with_capacity(4 * p.len()));
    for row in contact.rows() {
        let rows = 2 * row.y..(2 * row.y + 2).min(fine);
        for y in rows.clone() {
            for k in row.span.clone() {
                let x = 2 * (contact.index()[k] as usize - row.y * coarse.side);
                let columns = x..(x + 2).min(fine);
                let below = |y: usize| columns.clone().filter(move |&x| z[y * fine + x] < d).count();
                let chosen: usize = rows.clone().map(below).sum();
                let carrying = if chosen > 0 { chosen } else { rows.len() * columns.len() };
                for i in columns.map(|x| y * fine + x).filter(|&i| chosen == 0 || z[i] < d) {
                    index.push(i as u32);
                    // Equal force: cells half as large carry twice the sum in scaled units.
                    pressure.push(2.0 * p[k] / carrying as f64);
                }
            }
        }
    }
    Guess { set: CellSet::new(fine, index), p: pressure, d, far: true }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    fn problem(side: usize, z: Vec<f64>) -> Problem {
        Problem::new(side, Arc::new(z), contact_model::Boundary::Free)
    }

    fn limits() -> Limits {
        Limits { tolerance: 1e-6, height: Some(1.0), rounds: 50, dense: false }
    }

    /// A broad hill with one needle on its flank that no coarse grid sees as a summit.
    fn needle(side: usize) -> Vec<f64> {
        let middle = side as f64 / 2.0;
        let mut z: Vec<f64> = (0..side * side)
            .map(|i| {
                let (x, y) = ((i % side) as f64 - middle, (i / side) as f64 - middle);
                0.2 + (x * x + y * y) / (middle * middle)
            })
            .collect();
        z[3 * side + 5] = 0.0;
        z
    }

    #[test]
    fn a_needle_that_coarse_grids_lose_still_carries() {
        let side = 97;
        let mut problem = problem(side, needle(side));
        let target = Target::Approach(0.3);
        let guess = cold(&mut problem, target, limits(), &never);
        let solved = active_set::solve(&mut problem, target, guess, limits(), &never);
        assert_eq!(solved.status, contact_model::Status::Converged);
        assert!(solved.contact.index().contains(&((3 * side + 5) as u32)));
        assert!(solved.contact.len() > 10, "the hill carries too");
    }

    #[test]
    fn a_coarse_grid_keeps_the_force() {
        let side = 97;
        let mut problem = problem(side, needle(side));
        let force = 40.0;
        let guess = cold(&mut problem, Target::Force(force), limits(), &never);
        approx::assert_relative_eq!(guess.p.iter().sum::<f64>(), force, max_relative = 1e-12);
        assert!(guess.p.iter().all(|&p| p > 0.0));
        assert_eq!(guess.p.len(), guess.set.len());
    }

    #[test]
    fn an_approach_below_every_coarse_summit_starts_from_the_fine_grid() {
        let side = 97;
        let mut problem = problem(side, needle(side));
        let target = Target::Approach(1e-3);
        let guess = cold(&mut problem, target, limits(), &never);
        assert_eq!(guess.set.len(), 1);
    }
}
