//! Small surfaces against a dense reference that shares the influence matrix with the solver and nothing
//! else.

#![allow(clippy::needless_range_loop)] // Indices as in the formulas.

use super::law::LawShape;
use super::relaxation::{FrontLattice, Tractions, follow};
use super::*;
use crate::active_set::{Limits, Problem};
use crate::geometry::{CellSet, Grid};
use crate::kernel::NormalTable;
use crate::response::adhesive::{ResponseRequest, respond};
use crate::tuning::Tuning;
use contact_model::{Boundary, never};
use std::f64::consts::PI;
use std::sync::Arc;

/// Tolerance of the solver in these tests.
const TOLERANCE: f64 = 1e-9;
/// Largest difference between gaps of the solver and of the reference, in ranges: the tolerance over the
/// smallest distance of an eigenvalue from 1 in these tests.
const SAME: f64 = 1e-6;

const LIMITS: Limits =
    Limits { tolerance: TOLERANCE, height: Some(1.0), outer_iterations: 300, factor: true, is_guess: false };

/// Numbers in [0, 1) from a fixed sequence.
struct FixedSequence(u64);

impl FixedSequence {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// A rough surface whose highest point is 0.
fn heights(grid: Grid, seed: u64) -> Vec<f64> {
    let mut numbers = FixedSequence(seed);
    for _ in 0..8 {
        numbers.next();
    }
    let waves: Vec<[f64; 4]> = (0..6)
        .map(|k| [numbers.next(), numbers.next(), 1.0 / f64::from(k + 1), 6.3 * numbers.next()])
        .collect();
    let height = |i: usize| -> f64 {
        let (x, y) = ((i % grid.columns) as f64, (i / grid.columns) as f64);
        waves.iter().map(|[a, b, size, phase]| size * (1.3 * a * x + 1.3 * b * y + phase).cos()).sum()
    };
    let heights: Vec<f64> = (0..grid.count()).map(height).collect();
    let highest = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    heights.iter().map(|h| highest - h).collect()
}

fn problem(grid: Grid, z: &[f64], boundary: Boundary) -> Problem {
    Problem::new(grid, Arc::new(z.to_vec()), boundary, &Tuning::DEFAULT)
}

fn dense(grid: Grid, boundary: Boundary) -> Vec<Vec<f64>> {
    let table = NormalTable::shared(grid, boundary);
    let place = |i: usize| (i % grid.columns, i / grid.columns);
    (0..grid.count())
        .map(|i| {
            let (x, y) = place(i);
            (0..grid.count())
                .map(|j| {
                    let (a, b) = place(j);
                    table.lag(x.abs_diff(a), y.abs_diff(b))[0]
                })
                .collect()
        })
        .collect()
}

/// Without the constant of a periodic kernel, up to a part of it so small that it changes nothing here and
/// keeps the matrix regular: at a plane that of zero mean acts.
fn at_a_plane(grid: Grid, boundary: Boundary) -> Vec<Vec<f64>> {
    const LEFT: f64 = 1e-8;
    let constant = NormalTable::shared(grid, boundary).shift() * (1.0 - LEFT);
    let without = |row: Vec<f64>| row.iter().map(|g| g - constant).collect();
    dense(grid, boundary).into_iter().map(without).collect()
}

/// `matrix x = right` by Gauss's elimination with pivots.
pub fn eliminated(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Vec<f64> {
    let n = right.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| matrix[i][k].abs().total_cmp(&matrix[j][k].abs())).unwrap();
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        for i in k + 1..n {
            let factor = matrix[i][k] / matrix[k][k];
            if factor != 0.0 {
                for j in k..n {
                    matrix[i][j] -= factor * matrix[k][j];
                }
                right[i] -= factor * right[k];
            }
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    right
}

fn asked(control: AdhesiveControl, tolerance: f64) -> ResponseRequest<'static> {
    ResponseRequest { control, tolerance: Some(tolerance), stop: &never }
}

/// A surface at an approach, with the dense matrix of its kernel.
struct MatrixSurface<'a> {
    grid: Grid,
    /// The displacement of each cell under a unit pressure on each other one.
    g: &'a [Vec<f64>],
    /// Gaps from the plane of first touch.
    z: &'a [f64],
    /// The approach.
    d: f64,
}

/// The equilibrium near given gaps at an approach, by Newton's method with the contact set changed between
/// steps; `None` where it does not settle. Returns the gaps, and whether the energy has a minimum there.
fn newton(surface: &MatrixSurface<'_>, attraction: &Attraction, start: &[f64]) -> Option<(Vec<f64>, bool)> {
    let MatrixSurface { grid, g, z, d } = *surface;
    let n = z.len();
    let law = attraction.law;
    let all = CellSet::all(grid);
    let mut gap = start.to_vec();
    let mut contact: Vec<bool> = gap.iter().map(|&g| g <= 0.0).collect();
    for _ in 0..200 {
        // Unknown net pressure p: on the contact (G p)_i = d - z_i; elsewhere p_i = -s(g_i), with g = G p + z - d.
        let tractions = attraction.tractions(&all, &gap);
        let slopes = slopes(attraction, &all, &gap);
        let mut matrix = g.to_vec();
        let mut right = vec![0.0; n];
        for i in 0..n {
            if contact[i] {
                right[i] = d - z[i];
            } else {
                // p_i = -s_i + sum m_ik (g - g0)_k: p_i - sum m_ik (G p)_k = -s_i + sum m_ik (z - d - g0)_k.
                for j in 0..n {
                    let through: f64 = (0..n).map(|k| slopes[i][k] * g[k][j]).sum();
                    matrix[i][j] = if i == j { 1.0 } else { 0.0 } - through;
                }
                right[i] = (0..n).map(|k| slopes[i][k] * (z[k] - d - gap[k])).sum::<f64>() - tractions[i];
            }
        }
        let p = eliminated(matrix, right);
        let full: Vec<f64> =
            (0..n).map(|i| g[i].iter().zip(&p).map(|(g, p)| g * p).sum::<f64>() + z[i] - d).collect();
        // No gap changes by more than half a range in a step.
        let longest = full.iter().zip(&gap).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        let share = (0.5 * law.range / longest).min(1.0);
        let mut same = share >= 1.0 && longest < 1e-13 * law.range;
        for i in 0..n {
            gap[i] += share * (full[i] - gap[i]);
            let touches = if contact[i] { p[i] + tractions[i] > 0.0 } else { gap[i] < 0.0 };
            same &= touches == contact[i];
            contact[i] = touches;
            if touches {
                gap[i] = 0.0;
            }
        }
        if same {
            return Some((gap.clone(), is_minimum(g, &contact, &slopes)));
        }
    }
    None
}

/// The negative derivatives of the tractions, by differences in both directions.
fn slopes(attraction: &Attraction, all: &CellSet, gap: &[f64]) -> Vec<Vec<f64>> {
    let n = gap.len();
    let step = 1e-5 * attraction.law.range;
    let mut slopes = vec![vec![0.0; n]; n];
    for k in 0..n {
        let (mut above, mut below) = (gap.to_vec(), gap.to_vec());
        (above[k], below[k]) = (above[k] + step, below[k] - step);
        let (above, below) = (attraction.tractions(all, &above), attraction.tractions(all, &below));
        for i in 0..n {
            slopes[i][k] = (below[i] - above[i]) / (2.0 * step);
        }
    }
    slopes
}

/// Whether the derivatives of the pressure less those of the attraction are positive definite on the open
/// cells.
fn is_minimum(g: &[Vec<f64>], contact: &[bool], slopes: &[Vec<f64>]) -> bool {
    let n = contact.len();
    let inverse: Vec<Vec<f64>> = (0..n)
        .map(|k| eliminated(g.to_vec(), (0..n).map(|i| if i == k { 1.0 } else { 0.0 }).collect()))
        .collect();
    let open: Vec<usize> = (0..n).filter(|&i| !contact[i]).collect();
    let mut hessian: Vec<Vec<f64>> =
        open.iter().map(|&i| open.iter().map(|&j| inverse[j][i] - slopes[i][j]).collect()).collect();
    // Pivots of the elimination without exchange.
    for k in 0..hessian.len() {
        if hessian[k][k] <= 0.0 {
            return false;
        }
        for i in k + 1..hessian.len() {
            let factor = hessian[i][k] / hessian[k][k];
            for j in k..hessian.len() {
                hessian[i][j] -= factor * hessian[k][j];
            }
        }
    }
    true
}

/// One less the largest eigenvalue of the attraction's answer to itself with the contact kept closed, by power
/// iteration on the dense matrix with 1 added: neighbours can make others negative.
fn dense_stability(g: &[Vec<f64>], contact: &[bool], slopes: &[Vec<f64>]) -> f64 {
    let n = contact.len();
    let open: Vec<usize> = (0..n).filter(|&i| !contact[i]).collect();
    let mut v: Vec<f64> = open.iter().map(|&i| 1.0 + 0.1 * (i as f64).sin()).collect();
    let mut largest = 0.0;
    for _ in 0..3000 {
        // Displacement under the attraction that follows v, where pressure keeps the contact closed.
        let mut matrix = vec![vec![0.0; n]; n];
        let mut right = vec![0.0; n];
        for i in 0..n {
            if contact[i] {
                matrix[i].clone_from(&g[i]);
            } else {
                matrix[i][i] = 1.0;
                right[i] = open.iter().zip(&v).map(|(&k, v)| slopes[i][k] * v).sum();
            }
        }
        let p = eliminated(matrix, right);
        let answer = |i: usize| g[i].iter().zip(&p).map(|(g, p)| g * p).sum::<f64>();
        let next: Vec<f64> = open.iter().zip(&v).map(|(&i, v)| v + answer(i)).collect();
        let norm = next.iter().map(|v| v * v).sum::<f64>().sqrt();
        let settled = (norm - largest).abs() < 1e-13 * norm;
        (largest, v) = (norm, next.iter().map(|v| v / norm).collect());
        if settled {
            break;
        }
    }
    2.0 - largest
}

fn search<'a>(
    problem: &'a mut Problem,
    attraction: &'a Attraction,
    control: AdhesiveControl,
    plain: bool,
) -> Search<'a> {
    Search { problem, attraction, control, limits: LIMITS, plain }
}

/// Gaps of all cells.
fn gaps(grid: Grid, state: &Equilibrium) -> Vec<f64> {
    CellSet::all(grid).carry(&state.cells, &state.gap)
}

/// The attraction of a law whose strength is this share of what the cells allow.
fn law(range: f64, share: f64) -> Attraction {
    Attraction::of(AttractionLaw { peak: share * range / 3.525_494, range, shape: LawShape::Exponential })
}

#[test]
fn a_short_range_does_the_work_with_the_traction_of_its_longer_side() {
    for (work, side) in [(0.3, 1.0), (0.3, 2.0), (0.02, 1.0)] {
        let law = AttractionLaw::short(work, side);
        approx::assert_relative_eq!(
            law.peak.powi(2) * PI * side,
            0.59f64.powi(2) * work,
            max_relative = 1e-12
        );
        approx::assert_relative_eq!(law.energy(0.0), -work, max_relative = 1e-12);
    }
}

/// At a prescribed force the reference is that of a kernel with a very large constant, under which the force
/// cannot change.
#[test]
fn stability_is_that_of_the_dense_matrix_at_an_approach_and_at_a_force() {
    const NO_FORCE: f64 = 1e7;
    // Ritz values approach the spectral radius from below.
    const SETTLED: f64 = 3e-3;
    let mut differ = 0;
    let oblong = Grid { columns: 6, rows: 7, stretch: 1.3 };
    let square = Grid::square(7, 6);
    for (seed, grid, boundary) in [
        (1, square, Boundary::Free),
        (2, oblong, Boundary::Free),
        (1, square, Boundary::Periodic),
        (4, oblong, Boundary::Periodic),
    ] {
        let z = heights(grid, seed);
        let g = at_a_plane(grid, boundary);
        let stiff: Vec<Vec<f64>> = g.iter().map(|row| row.iter().map(|g| g + NO_FORCE).collect()).collect();
        let mut problem = problem(grid, &z, boundary);
        let short = Attraction::short((0.35 * 0.4f64).powi(2) / PI, grid, boundary);
        for (d, law) in [0.4, 0.8].into_iter().flat_map(|d| [(d, law(0.3, 0.2)), (d, short.clone())]) {
            let mut search = search(&mut problem, &law, AdhesiveControl::Plane(d), false);
            let start = search.first(&never).unwrap();
            let state = search.from(start, &never).unwrap();
            let all = CellSet::all(grid);
            // The slope of a short range has a jump at its reach.
            let reach = law.law.reach();
            let mut gap = known(grid, &state, reach);
            gap.iter_mut().filter(|gap| **gap >= reach).for_each(|gap| *gap = 2.0 * reach);
            let pressure = all.carry(&state.cells, &state.pressure);
            let contact: Vec<bool> = pressure.iter().map(|p| *p > 0.0).collect();
            let slopes = slopes(&law, &all, &gap);
            let at = |problem: &mut Problem, control| {
                respond(problem, &law, &state, asked(control, 1e-10)).unwrap().stability
            };
            let (approach, force) = (
                at(&mut problem, AdhesiveControl::Plane(d)),
                at(&mut problem, AdhesiveControl::Force(state.force())),
            );
            let (exact, exact_force) =
                (dense_stability(&g, &contact, &slopes), dense_stability(&stiff, &contact, &slopes));
            approx::assert_relative_eq!(approach, exact, max_relative = SETTLED);
            approx::assert_relative_eq!(force, exact_force, max_relative = SETTLED);
            differ += usize::from(approach - force > 1e-2 * approach);
        }
    }
    assert!(differ > 0);
}

#[test]
fn every_state_of_a_path_is_a_minimum_that_newton_finds_too() {
    let mut jumps = 0;
    for (seed, grid, boundary) in [
        (1, Grid::square(7, 6), Boundary::Free),
        (2, Grid { columns: 6, rows: 7, stretch: 1.3 }, Boundary::Free),
        (3, Grid::square(6, 6), Boundary::Periodic),
    ] {
        let z = heights(grid, seed);
        let g = at_a_plane(grid, boundary);
        let short = |range: f64| Attraction::short((0.35 * range).powi(2) / PI, grid, boundary);
        for law in [law(0.5, 0.15), law(0.3, 0.2), law(0.1, 0.2), short(0.5), short(0.2)] {
            let range = law.law.range;
            let mut problem = problem(grid, &z, boundary);
            let mut last: Option<Equilibrium> = None;
            for d in [-0.6, -0.2, 0.1, 0.4, 1.0, 0.5, 0.1, -0.1, -0.3, -0.6, -1.5] {
                let mut search = search(&mut problem, &law, AdhesiveControl::Plane(d), false);
                let start = last.take().unwrap_or_else(|| search.first(&never).unwrap());
                let before = gaps(grid, &start);
                let state = search.from(start, &never).unwrap();
                let found = gaps(grid, &state);
                let control = AdhesiveControl::Plane(d);
                let response = respond(&mut problem, &law, &state, asked(control, 1e-6)).unwrap();
                // Beyond the reach of the attraction gaps are not known to the solver.
                let all: Vec<f64> = found
                    .iter()
                    .zip(&z)
                    .map(|(&g, z)| if g == 0.0 && z - d > law.law.reach() { z - d } else { g })
                    .collect();
                let surface = MatrixSurface { grid, g: &g, z: &z, d };
                let (exact, minimum) = newton(&surface, &law, &all).unwrap();
                assert!(minimum && response.stability > 0.0, "{seed} {range} {d}");
                for (a, b) in all.iter().zip(&exact) {
                    assert!(
                        (a - b).abs() < SAME * range || a.min(*b) > law.law.reach(),
                        "{seed} {range} {d}: {a} {b}"
                    );
                }
                let moved = before.iter().zip(&found).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                jumps += usize::from(moved > 2.0 * range);
                last = Some(state);
            }
        }
    }
    assert!(jumps > 0, "some of these paths are unstable somewhere");
}

#[test]
fn newton_steps_find_the_states_of_the_plain_iteration() {
    for seed in 1..6 {
        let grid = Grid::square(16, 12);
        let z = heights(grid, seed);
        let short = Attraction::short((0.35 * 0.4f64).powi(2) / PI, grid, Boundary::Free);
        for law in [law(0.4, 0.2), law(0.1, 0.2), short] {
            let range = law.law.range;
            let mut problem = problem(grid, &z, Boundary::Free);
            let mut last: [Option<Equilibrium>; 2] = [None, None];
            for d in [-0.3, 0.0, 0.3, 0.8, 0.2, -0.1, -0.2, -0.3, -0.5, -0.8, -2.0] {
                let mut found = Vec::new();
                for (plain, last) in [false, true].into_iter().zip(&mut last) {
                    let mut search = search(&mut problem, &law, AdhesiveControl::Plane(d), plain);
                    let start = last.take().unwrap_or_else(|| search.first(&never).unwrap());
                    let state = search.from(start, &never).unwrap();
                    found.push((gaps(grid, &state), energy(&problem, &law, &state), state.force()));
                    *last = Some(state);
                }
                let apart =
                    found[0].0.iter().zip(&found[1].0).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                assert!(
                    apart < 1e-5 * range,
                    "{seed} {range} {d}: {apart} {:?} {:?}",
                    found[0].1,
                    found[1].1
                );
            }
        }
    }
}

#[test]
fn followed_fronts_go_on_and_pass_no_equilibrium() {
    // The contact that a first load begins with is solved to a hundredth.
    const SETTLED: f64 = 0.01;
    // Fronts of the other tests hardly move.
    const FLATTER: f64 = 0.35;
    let mut further = 0;
    for seed in 1..9 {
        let grid = Grid { columns: 16, rows: 12, stretch: 1.1 };
        let boundary = if seed % 2 == 0 { Boundary::Free } else { Boundary::Periodic };
        let z: Vec<f64> = heights(grid, seed).iter().map(|z| FLATTER * z).collect();
        let attraction = Attraction::short((0.35 * 0.4f64).powi(2) / PI, grid, boundary);
        let mut problem = problem(grid, &z, boundary);
        // A prescribed mean gap is no monotone map.
        let control = if boundary == Boundary::Free {
            AdhesiveControl::Plane(0.1)
        } else {
            AdhesiveControl::Force(5.0 * attraction.law.peak)
        };
        let mut search = search(&mut problem, &attraction, control, true);
        let first = search.first(&never).unwrap();
        let end = search.from(first.clone(), &never).unwrap();
        search.limits.outer_iterations = 0;
        let (_, state) = *search.from(first, &never).unwrap_err();
        let (mut pressure, mut next) = (state.pressure.clone(), state.lawful.clone());
        let mut to = Tractions { pressure: &mut pressure, attraction: &mut next };
        let lattice = FrontLattice { inverse: attraction.inverse().unwrap(), grid, boundary };
        follow(&attraction, lattice, &state, &mut to, &never).unwrap();
        let peak = attraction.law.peak;
        let end = state.cells.carry(&end.cells, &end.attraction);
        for ((next, lawful), end) in next.iter().zip(&state.lawful).zip(&end) {
            assert!(*next >= lawful - SETTLED * peak && *next <= end + SETTLED * peak, "{seed}");
        }
        further +=
            next.iter().zip(&state.lawful).filter(|(next, lawful)| **next > *lawful + 0.1 * peak).count();
        assert!(pressure.iter().zip(&next).all(|(p, s)| *p >= 0.0 && *s >= 0.0));
    }
    assert!(further > 100, "{further}");
}

/// Gaps of all cells; beyond the reach of the attraction, where cells need not be known, the reach.
fn known(grid: Grid, state: &Equilibrium, reach: f64) -> Vec<f64> {
    let beyond: Vec<f64> = state.gap.iter().map(|g| reach - g.min(reach)).collect();
    CellSet::all(grid).carry(&state.cells, &beyond).iter().map(|b| reach - b).collect()
}

/// Follows paths of random loads from the states of the plain iteration, with and without Newton steps.
/// Returns the number of states and those that differ, in words.
fn compared(seeds: std::ops::Range<u64>) -> (usize, Vec<String>) {
    let (mut count, mut different) = (0, Vec::new());
    for seed in seeds {
        let mut numbers = FixedSequence(seed + 1000);
        let grid = if seed % 2 == 0 {
            Grid::square(12, 9)
        } else {
            Grid { columns: 8, rows: 10, stretch: 0.8 + numbers.next() }
        };
        let boundary = if seed % 4 < 2 { Boundary::Free } else { Boundary::Periodic };
        let z = heights(grid, seed);
        let mut problem = problem(grid, &z, boundary);
        let range = 0.05 + 0.5 * numbers.next();
        let short = Attraction::short((0.35 * range).powi(2) / PI, grid, boundary);
        for law in [short, law(range, 0.1 + 0.1 * numbers.next())] {
            let mut last: Option<Equilibrium> = None;
            // The force at which the surface just touches, and a multiple of the attraction of the law.
            let by_force = numbers.next() < 0.5;
            for step in 0..10 {
                let share = if step < 4 { 1.0 } else { -1.0 } * numbers.next();
                let control = if by_force {
                    AdhesiveControl::Force(law.law.peak * (20.0 * share).max(-8.0))
                } else {
                    AdhesiveControl::Plane(share)
                };
                let mut found = Vec::new();
                for plain in [true, false] {
                    let mut search = search(&mut problem, &law, control, plain);
                    let start =
                        last.as_ref().map_or_else(|| search.first(&never).unwrap(), Equilibrium::again);
                    found.push(search.from(start, &never).map_err(|ended| ended.0));
                }
                count += 1;
                let what = format!("{seed} {boundary:?} {:?} {range:.3} {step} {control:?}", law.law.shape);
                let fast = found.pop().unwrap();
                match (found.pop().unwrap(), fast) {
                    (Ok(plain), Ok(fast)) => {
                        let reach = law.law.reach();
                        let apart = (known(grid, &plain, reach).iter().zip(known(grid, &fast, reach)))
                            .fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
                        if apart > 1e-4 * law.law.range {
                            let energies = [&plain, &fast].map(|state| energy(&problem, &law, state));
                            different.push(format!("{what}: {apart:.2e} energies {energies:?}"));
                        }
                        last = Some(plain);
                    }
                    (Err(plain), Err(fast)) if plain == fast => break,
                    (plain, fast) => {
                        let ended = |state: Result<_, Ended>| state.err();
                        different.push(format!("{what}: {:?} {:?}", ended(plain), ended(fast)));
                        break;
                    }
                }
            }
        }
    }
    (count, different)
}

#[test]
fn newton_steps_stay_on_the_branch_of_the_plain_iteration() {
    let (count, different) = compared(0..24);
    assert!(count > 300 && different.is_empty(), "{count} {different:#?}");
}

/// Some minutes.
#[test]
#[ignore = "a study"]
fn newton_steps_leave_the_branch_in_none_of_thousands_of_states() {
    let (count, different) = compared(0..400);
    println!("{count} states, {} of them elsewhere", different.len());
    for what in &different {
        println!("{what}");
    }
    assert!(count > 4000 && different.is_empty());
}

#[test]
fn the_stiffness_is_the_difference_of_forces() {
    for boundary in [Boundary::Free, Boundary::Periodic] {
        stiffness_by_differences(boundary);
    }
}

fn stiffness_by_differences(boundary: Boundary) {
    let grid = Grid::square(12, 10);
    let z = heights(grid, 4);
    let mut problem = problem(grid, &z, boundary);
    let at = |problem: &mut Problem, law: &Attraction, d: f64| {
        let mut search = search(problem, law, AdhesiveControl::Plane(d), false);
        let start = search.first(&never).unwrap();
        search.from(start, &never).unwrap()
    };
    for (law, d) in [(&law(0.3, 0.15), -0.4), (&law(0.3, 0.15), 0.6)] {
        let state = at(&mut problem, law, d);
        let response = respond(&mut problem, law, &state, asked(AdhesiveControl::Plane(d), 1e-6)).unwrap();
        let step = 1e-4;
        let (above, below) =
            (at(&mut problem, law, d + step).force(), at(&mut problem, law, d - step).force());
        let expected = (above - below) / (2.0 * step);
        // The difference quotient is off by its second order and by cells that join.
        let stiffness = response.stiffness.unwrap();
        approx::assert_relative_eq!(stiffness.k(), expected, max_relative = 1e-3);
        assert!(stiffness.solve_error <= 1e-6);
    }
}

/// The error is relative to the force or to a thousandth of that of the pressure, whichever is larger; a force
/// of rounded zero has the state of zero.
#[test]
fn forces_near_zero_are_met_relative_to_the_pressure() {
    let grid = Grid::square(9, 9);
    let z = heights(grid, 2);
    let law = law(0.3, 0.2);
    let mut problem = problem(grid, &z, Boundary::Free);
    let mut search = search(&mut problem, &law, AdhesiveControl::Force(0.0), false);
    let start = search.first(&never).unwrap();
    let zero = search.from(start, &never).unwrap();
    let pressed: f64 = zero.pressure.iter().sum();
    for asked in [5.6e-17, -1e-300, 1e-12 * pressed, -1e-5 * pressed, 2e-3 * pressed] {
        search.control = AdhesiveControl::Force(asked);
        let state = search.from(zero.again(), &never).unwrap();
        let pressed: f64 = state.pressure.iter().sum();
        let error = (state.force() - asked).abs() / asked.abs().max(1e-3 * pressed);
        approx::assert_relative_eq!(search.load_error(&state), error, max_relative = 1e-6, epsilon = 1e-14);
        assert!(error <= TOLERANCE, "{asked:e}: {error:e}");
    }
    search.control = AdhesiveControl::Force(2.0 * pressed);
    approx::assert_relative_eq!(search.load_error(&zero), 1.0, max_relative = 1e-9);
}

#[test]
fn a_force_beyond_the_pull_off_force_is_an_error() {
    let grid = Grid::square(9, 9);
    let z = heights(grid, 2);
    let law = law(0.3, 0.2);
    let mut problem = problem(grid, &z, Boundary::Free);
    let mut search = search(&mut problem, &law, AdhesiveControl::Force(0.0), false);
    let start = search.first(&never).unwrap();
    let state = search.from(start, &never).unwrap();
    assert!(state.force().abs() < 1e-12 && !state.contact().is_empty());
    search.control = AdhesiveControl::Force(-1e3);
    assert!(matches!(search.from(state, &never), Err(ended) if ended.0 == Ended::PulledOff));
}

#[test]
fn a_law_is_its_energy_differentiated() {
    for shape in [LawShape::Exponential, LawShape::Uniform, LawShape::Smooth] {
        let law = AttractionLaw { peak: 2.0, range: 0.5, shape };
        for gap in [0.1, 0.3, 0.49, 0.6, 3.0] {
            let h = 1e-6;
            let slope = (law.energy(gap + h) - law.energy(gap - h)) / (2.0 * h);
            approx::assert_relative_eq!(slope, law.traction(gap), epsilon = 1e-8);
            let slope = (law.traction(gap + h) - law.traction(gap - h)) / (2.0 * h);
            approx::assert_relative_eq!(-slope, law.slope(gap), epsilon = 1e-6);
            assert!(law.mismatch(law.traction(gap), gap) <= 0.0);
        }
        let work = if shape == LawShape::Smooth { 8.0 / 15.0 } else { 1.0 };
        approx::assert_relative_eq!(law.energy(0.0), -work);
        approx::assert_relative_eq!(law.attached(0.0), 1.0);
    }
    // Next to the jump a traction of either side is right.
    let dugdale = AttractionLaw { peak: 2.0, range: 0.5, shape: LawShape::Uniform };
    approx::assert_relative_eq!(dugdale.mismatch(2.0, 0.55), 0.1, epsilon = 1e-12);
    approx::assert_relative_eq!(dugdale.mismatch(0.0, 0.0), 1.0);
}

/// While the gaps of all others stay, the energy is convex in that of one cell: the stiffness of a cell among
/// held ones is at least the reciprocal of its own influence, and the attraction falls less steeply.
#[test]
fn no_attachment_or_detachment_of_a_single_cell_lowers_the_energy_of_a_short_range() {
    let mut least = f64::INFINITY;
    for (seed, boundary) in [(1, Boundary::Free), (2, Boundary::Free), (3, Boundary::Periodic)] {
        let grid = Grid::square(10, 9);
        let z = heights(grid, seed);
        let g = dense(grid, boundary);
        let all = CellSet::all(grid);
        let short = Attraction::short((0.35 * 0.3f64).powi(2) / PI, grid, boundary);
        let range = short.law.range;
        let mut problem = problem(grid, &z, boundary);
        // At a fixed approach the constant of a periodic kernel is a spring.
        let shift = problem.operators.table().shift();
        let mut last: Option<Equilibrium> = None;
        for d in [-0.2, 0.2, 0.8, 0.3, -0.1, -0.3] {
            let mut search = search(&mut problem, &short, AdhesiveControl::Plane(d), false);
            let start = last.take().unwrap_or_else(|| search.first(&never).unwrap());
            let state = search.from(start, &never).unwrap();
            let d = state.d;
            let u = |p: &[f64]| -> Vec<f64> { g.iter().map(|row| crate::real::dot(row, p)).collect() };
            let net = all.carry(&state.cells, &state.net());
            let gap: Vec<f64> = u(&net).iter().zip(&z).map(|(u, z)| u + z - d).collect();
            let total = |gap: &[f64]| {
                let u: Vec<f64> = gap.iter().zip(&z).map(|(g, z)| g + d - z).collect();
                let p = eliminated(g.clone(), u.clone());
                0.5 * crate::real::dot(&p, &u) + short.energy(&all, gap)
            };
            let before = total(&gap);
            let spring = 0.5 * shift * state.force() * state.force();
            approx::assert_relative_eq!(
                before - spring,
                energy(&problem, &short, &state),
                max_relative = 1e-9
            );
            for i in 0..gap.len() {
                let closed = gap[i] < 1e-6 * range;
                for change in if closed { [0.1 * range, range] } else { [-0.5 * gap[i], -gap[i]] } {
                    let mut moved = gap.clone();
                    moved[i] += change;
                    // Over what the elastic energy of the cell alone would be.
                    least = least.min((total(&moved) - before) / (0.5 * change * change / g[i][i]));
                }
            }
            last = Some(state);
        }
    }
    assert!(least > 0.5, "{least}");
}

#[test]
fn a_law_at_its_ends() {
    let law = |shape| AttractionLaw { peak: 2.0, range: 0.5, shape };
    let (exponential, dugdale) = (law(LawShape::Exponential), law(LawShape::Uniform));
    for law in [exponential, dugdale] {
        // A penetration counts as contact.
        assert!(law.traction(-0.1) >= 2.0 && law.traction(-0.1) <= 2.0);
        approx::assert_relative_eq!(law.energy(-0.1), -1.0);
    }
    assert!(dugdale.traction(0.5) <= 0.0 && dugdale.traction(0.499) >= 2.0 && dugdale.reach() <= 0.5);
    // At the reach tractions are as large as the rounding of the largest one, half of epsilon.
    let least = exponential.traction(exponential.reach()) / 2.0 / f64::EPSILON;
    assert!(least < 0.55 && least > 0.45, "{least}");
}
