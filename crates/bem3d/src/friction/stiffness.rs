//! The tangential stiffness of a branch of friction: two linear solves with two-sided bounds.

use super::increment::{FrictionRoom, exact};
use super::linearised::{Branch, Linearised, SLIPPING, Split, TorusWindow, extend, inverse_of};
use crate::geometry::CellSet;
use crate::linear::{Fixed, StoppingCriteria, TORUS_ENERGY, TorusInverse, pcg};
use crate::operator::TangentialOperators;
use crate::parts::Part;
use crate::real::{dot, largest};
use contact_model::Stop;

/// `dT/d(delta)`, symmetric: `[xx, yy, xy]`, nondimensional, with its evidence.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TangentialStiffness {
    /// Ritz values of `B' A^-1 B`, a lower bound.
    pub value: [f64; 3],
    /// Estimated error of the linear solves, relative to the larger eigenvalue.
    pub solve_error: f64,
    /// Estimated error from the state, relative to the same: cells for which stick or slip is undecided, and
    /// directions and slips that are not known exactly.
    pub set_error: f64,
    /// Conjugate gradient steps.
    pub steps: usize,
}

/// The branch of a state: the cells and the admissible changes of their tractions.
#[derive(Debug, Clone, Copy)]
pub struct Held<'a> {
    /// The contact.
    pub cells: &'a CellSet,
    /// The admissible changes of each cell.
    pub branch: &'a Branch,
    /// Cells that may be on the other side of stick and slip.
    pub undecided: &'a [Undecided],
    /// Slip cells whose direction and turning `|w|/b` are not known exactly.
    pub uncertain: &'a [Uncertain],
}

/// A slip cell of which the direction of the traction and of the slip are not known exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// Its position.
    pub cell: usize,
    /// Direction of its traction.
    pub radial: [f64; 2],
    /// Bound on the error of the slip over the limit of the traction.
    pub turning: f64,
}

/// A cell of which it is not known whether it sticks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Undecided {
    /// Its position.
    pub cell: usize,
    /// Direction of its traction.
    pub radial: [f64; 2],
    /// Whether it counts as a stick cell.
    pub sticks: bool,
}

/// Largest number of corrections.
const ROUNDS: usize = 40;
/// Strongest reduction of the residual in one correction, which is the limit of single precision.
const REDUCTION: f64 = 1e-3;
/// Weakest reduction of the residual that a correction aims at.
const LEAST_REDUCTION: f64 = 0.3;
/// Steps of a correction at most.
const STEPS: usize = 60;
/// Share of the tolerance that the linear solve may use up.
const SHARE: f64 = 0.5;
/// Share of it that a correction aims at.
const AIM: f64 = 0.2;

/// Solves `A x = B'` for both directions, where A are the linearised conditions of the branch ([`Linearised`]) and
/// `B'` are the restricted unit displacements, until the stiffness `B A^-1 B'` is known to half of `tolerance`,
/// relative to its larger eigenvalue.
///
/// With residuals `R = B' - A X` the stiffness lies between the Ritz value `S' (X'AX)^-1 S`, `S = B X`, and
/// `B X + R'X + R' M R` with any `M >= A^-1`; errors of both are quadratic in that of X. M is the inverse on a torus
/// of all cells (`A >= K` on the restricted tractions, whatever the slip cells do).
///
/// Cost: about 20 applications for 1e-4.
pub fn solve(
    operators: &mut TangentialOperators,
    room: &mut FrictionRoom,
    held: Held<'_>,
    tolerance: f64,
    stop: Stop<'_>,
) -> TangentialStiffness {
    let Held { cells, branch, .. } = held;
    let n = cells.len();
    let unknown =
        TangentialStiffness { solve_error: f64::INFINITY, set_error: 0.0, ..TangentialStiffness::default() };
    if n == 0 {
        return TangentialStiffness { solve_error: 0.0, ..unknown };
    }
    let right: [Vec<f64>; 2] = std::array::from_fn(|component| {
        let mut ones = vec![0.0; 2 * n];
        ones[component * n..][..n].fill(1.0);
        branch.restrict_f64(&mut ones);
        ones
    });
    let mut x = [vec![0.0; 2 * n], vec![0.0; 2 * n]];
    let mut residual = right.clone();
    let mut displaced = [Vec::new(), Vec::new()];
    let whole = Branch::stuck(cells);
    let (mut best, mut steps, mut unimproved, mut reduction) = (unknown, 0, 0, REDUCTION);
    room.vectors.take_fields(cells.clone(), 2);
    for round in 0..ROUNDS {
        if round > 0 {
            for ((x, right), (r, u)) in x.iter().zip(&right).zip(residual.iter_mut().zip(&mut displaced)) {
                exact(operators, cells, x, cells, u);
                r.clone_from(u);
                branch.restrict_f64(r);
                branch.add_turning(x, r, 1.0);
                r.iter_mut().zip(right).for_each(|(r, right)| *r = right - *r);
            }
            let energy = energy(operators, room, (cells, &whole, branch), &residual);
            let (value, error) = bounds(&right, &x, &residual, energy);
            unimproved = if error < 0.9 * best.solve_error { 0 } else { unimproved + 1 };
            if error < best.solve_error {
                let set_error = set_error(operators, held, (&x, &displaced)) / larger(value);
                let set_error = if set_error.is_finite() { set_error } else { 0.0 };
                best = TangentialStiffness { value, solve_error: error, set_error, steps };
            }
            // Errors are quadratic in the residual.
            reduction = (AIM * tolerance / error).sqrt().clamp(REDUCTION, LEAST_REDUCTION);
            if error <= SHARE * tolerance || unimproved > 2 || stop.stops() {
                break;
            }
        }
        for (x, r) in x.iter_mut().zip(&mut residual) {
            steps += correct(operators, room, (cells, branch), (r, reduction), stop);
            x.iter_mut().zip(&*r).for_each(|(x, r)| *x += r);
        }
    }
    TangentialStiffness { steps, ..best }
}

/// One correction: solves `A x = r` roughly and writes x over r.
fn correct(
    operators: &mut TangentialOperators,
    room: &mut FrictionRoom,
    (cells, branch): (&CellSet, &Branch),
    (r, reduction): (&mut [f64], f64),
    stop: Stop<'_>,
) -> usize {
    let size = largest(r);
    let tuning = *operators.tuning();
    let recorder = operators.recorder().clone();
    let (own, shift) = (operators.table().own(), operators.table().shift());
    operators.solves += 1;
    let Some((kernel, transform)) = operators.system(cells, true).filter(|_| size > 0.0) else { return 0 };
    let FrictionRoom { vectors, extensions, split: vectors_of_split, .. } = room;
    let torus = TorusWindow { window: transform.window(), decay: tuning.decay, extended: tuning.extended };
    recorder.timed(Part::Sets, || extend(extensions, &torus, &branch.stick));
    let mut split = Split {
        torus: TorusInverse { transform, extensions, recorder: recorder.clone() },
        branch,
        own: SLIPPING * own as f32,
        sums: None,
        room: std::mem::take(vectors_of_split),
        recorder: recorder.clone(),
    };
    let mut linearised = Linearised { kernel, shift: shift as f32, branch };
    let criteria = StoppingCriteria { reduction, energy: None, floor: 0.0, steps: STEPS };
    let outcome = recorder.timed(Part::Vectors, || {
        vectors.load(r, size);
        let outcome = pcg(&mut linearised, &mut split, vectors, Fixed::Approach, criteria, stop);
        vectors.unload(r, size);
        outcome
    });
    *vectors_of_split = std::mem::take(&mut split.room);
    operators.applications += outcome.applications;
    outcome.steps
}

/// `R' M R`, estimated from above.
fn energy(
    operators: &mut TangentialOperators,
    room: &mut FrictionRoom,
    (cells, whole, branch): (&CellSet, &Branch, &Branch),
    residual: &[Vec<f64>; 2],
) -> [f64; 3] {
    let size = largest(&residual[0]).max(largest(&residual[1]));
    let tuning = *operators.tuning();
    let recorder = operators.recorder().clone();
    let Some((_, transform)) = operators.system(cells, true).filter(|_| size > 0.0) else { return [0.0; 3] };
    let torus = TorusWindow { window: transform.window(), decay: tuning.decay, extended: tuning.extended };
    recorder.timed(Part::Preconditioner, || {
        extend(&mut room.extensions, &torus, &whole.stick);
        let extensions = &mut room.extensions;
        let mut inverse = TorusInverse { transform, extensions, recorder: recorder.clone() };
        let mut r = residual.each_ref().map(|r| r.iter().map(|r| (r / size) as f32).collect::<Vec<f32>>());
        let z = r.each_mut().map(|r| {
            let mut z = vec![0.0; r.len()];
            inverse.precondition(cells, 0.0, r, &mut z);
            branch.restrict(&mut z);
            z
        });
        let factor = TORUS_ENERGY * size * size;
        let product = |i: usize, j: usize| factor * dot(&r[i], &z[j]);
        [product(0, 0), product(1, 1), product(0, 1)]
    })
}

/// Ritz value and width of the bounds relative to its larger eigenvalue, from the energy `R' A^-1 R`.
fn bounds(
    right: &[Vec<f64>; 2],
    x: &[Vec<f64>; 2],
    residual: &[Vec<f64>; 2],
    energy: [f64; 3],
) -> ([f64; 3], f64) {
    let symmetric = |a: &[Vec<f64>; 2], b: &[Vec<f64>; 2]| {
        [dot(&a[0], &b[0]), dot(&a[1], &b[1]), f64::midpoint(dot(&a[0], &b[1]), dot(&a[1], &b[0]))]
    };
    let (s, rx) = (symmetric(right, x), symmetric(residual, x));
    let form: [f64; 3] = std::array::from_fn(|k| s[k] - rx[k]);
    // S' (X'AX)^-1 S.
    let [a, b, c] = inverse_of(form, 1e-14);
    let ritz = [
        a * s[0] * s[0] + 2.0 * c * s[0] * s[2] + b * s[2] * s[2],
        a * s[2] * s[2] + 2.0 * c * s[2] * s[1] + b * s[1] * s[1],
        a * s[0] * s[2] + c * (s[0] * s[1] + s[2] * s[2]) + b * s[1] * s[2],
    ];
    let width: [f64; 3] = std::array::from_fn(|k| s[k] + rx[k] + energy[k] - ritz[k]);
    let large = larger(ritz);
    (ritz, if large > 0.0 { larger(width).max(0.0) / large } else { 0.0 })
}

/// The larger eigenvalue.
pub fn larger([xx, yy, xy]: [f64; 3]) -> f64 {
    f64::midpoint(xx, yy) + (0.5 * (xx - yy)).hypot(xy)
}

/// Change of the stiffness that the uncertainty of the state allows, of both directions together.
///
/// An undecided slip cell that sticks adds at most `(e - K x)_e^2 / s` with the smallest eigenvalue s, where e is the
/// direction of its traction; a stick cell that slips takes away at most `x_e^2` times its own compliance. To first
/// order a change h of `|w|/b` of a slip cell takes away `x^2 h`, and a turn of its tangent adds `2 x (e - K x)_e` times
/// the angle, which is estimated as h over s.
fn set_error(
    operators: &TangentialOperators,
    held: Held<'_>,
    (x, displaced): (&[Vec<f64>; 2], &[Vec<f64>; 2]),
) -> f64 {
    let table = operators.table();
    let (own, smallest, n) = (table.own(), table.smallest_eigenvalue(), held.cells.len());
    let along = |v: &[f64], i: usize, e: [f64; 2]| v[i] * e[0] + v[n + i] * e[1];
    let held_back = |k: usize, i: usize, e: [f64; 2]| e[k] - along(&displaced[k], i, e);
    let undecided = held.undecided.iter().map(|&Undecided { cell, radial, sticks }| -> f64 {
        let terms = (0..2).map(|k| {
            if sticks {
                along(&x[k], cell, radial).powi(2) * own
            } else {
                held_back(k, cell, radial).powi(2) / smallest
            }
        });
        terms.sum()
    });
    let uncertain = held.uncertain.iter().map(|&Uncertain { cell, radial, turning }| -> f64 {
        let terms = (0..2).map(|k| {
            let moved = x[k][cell].hypot(x[k][n + cell]);
            turning * moved * (moved + 2.0 * held_back(k, cell, radial).abs() / smallest)
        });
        terms.sum()
    });
    undecided.chain(uncertain).fold(0.0, |sum, change| sum + change)
}
