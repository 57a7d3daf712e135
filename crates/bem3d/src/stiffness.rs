//! The incremental stiffness on a given contact set: one linear solve, two-sided bounds.

use crate::active_set::{Problem, Solved};
use crate::cg::{self, Energy, Request, TORUS};
use crate::filled::runs::{self, Runs};
use crate::filled::{self, Arrays};
use crate::{love, strategy};
use contact_model::Stop;

/// Corrections at most; each gains a decade or more.
const ROUNDS: usize = 40;
/// Conjugate gradient steps at most in one correction.
const STEPS: usize = 60;

/// Share of the tolerance that the linear solve may use up; the rest is left to undecided cells.
const SHARE: f64 = 0.5;
/// Share of the tolerance that conjugate gradients aim at: what they estimate is not yet checked in double precision.
const AIM: f64 = 0.3;
/// Reduction of the residual at most in one correction: single precision has no more to give.
const REDUCTION: f64 = 1e-3;

/// Stiffness in scaled units with its evidence.
#[derive(Debug, Clone)]
pub struct Stiffness {
    /// Ritz value of `1' K^-1 1`.
    pub value: f64,
    /// Estimated relative error of the linear solve on the given set.
    pub solve_error: f64,
    /// Estimated relative error from cells that may be on the wrong side of the set.
    pub set_error: f64,
    /// `K q = 1` on the contact set.
    pub q: Vec<f64>,
    /// Conjugate gradient steps.
    pub steps: usize,
}

impl Stiffness {
    fn unknown() -> Self {
        Self { value: 0.0, solve_error: f64::INFINITY, set_error: 0.0, q: Vec::new(), steps: 0 }
    }

    /// Estimated relative error, both parts.
    pub fn error(&self) -> f64 {
        self.solve_error + self.set_error
    }
}

/// Solves `K q = 1` on the contact set of a state until the relative error of k is estimated below half of `tolerance`.
///
/// For any q with residual `r = 1 - K q` the true k lies between the Ritz value `(1'q)^2 / (q'Kq)` and
/// `1'q + r'q + r'K^-1 r`; both errors are quadratic in that of q. `guess` may be the q of a similar set.
///
/// Cost: about 10 applications of K for a relative error of 1e-4.
pub fn solve(
    problem: &mut Problem,
    state: &Solved,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    stop: Stop<'_>,
) -> Stiffness {
    if strategy::fills(&state.contact) {
        return filled(problem, state, guess, tolerance, stop);
    }
    on_lists(problem, state, guess, tolerance, stop)
}

/// The same on lists of cells.
pub fn on_lists(
    problem: &mut Problem,
    state: &Solved,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    stop: Stop<'_>,
) -> Stiffness {
    let contact = &state.contact;
    let n = contact.len();
    let spectral = strategy::precondition(n, contact.window_cells());
    let ambiguous = state.look.undecided();
    let targets = crate::active_set::with(contact, &ambiguous);
    let mut q = guess.unwrap_or_else(|| vec![0.0; n]);
    let mut v = vec![0.0; targets.len()];
    let mut fresh = q.iter().all(|&q| q == 0.0);
    let on_contact = targets.positions(contact);
    let mut best = Stiffness::unknown();
    let mut steps = 0;
    let mut unimproved = 0;
    for round in 0..ROUNDS {
        if !fresh {
            v = problem.operators.exact(contact, &q, &targets);
        }
        let r: Vec<f64> = on_contact.iter().map(|&k| 1.0 - v[k as usize]).collect();
        let (sum, rq): (f64, f64) = (q.iter().sum(), cg::dot(&r, &q));
        if !fresh {
            let energy = cg::energy(&mut problem.operators, contact, &r, spectral);
            let (ritz, error) = bounds(sum, rq, energy);
            let improved = error < 0.9 * best.solve_error;
            if error < best.solve_error {
                let at_ambiguous = targets.positions(&ambiguous).into_iter().map(|k| v[k as usize]);
                let set_error = set_error(state, at_ambiguous, &q) / ritz;
                best = Stiffness { value: ritz, solve_error: error, set_error, q: q.clone(), steps };
            }
            unimproved = if improved { 0 } else { unimproved + 1 };
            if error <= SHARE * tolerance || unimproved > 2 || stop() || round + 1 == ROUNDS {
                break;
            }
        }
        fresh = false;
        let request = Request {
            fixed_sum: false,
            reduction: REDUCTION,
            energy: Some(Energy { share: AIM * tolerance, base: sum + rq }),
            floor: 0.0,
            steps: STEPS,
            precondition: spectral,
            exact: true,
        };
        let correction = cg::correct(&mut problem.operators, contact, &r, request, stop);
        steps += correction.steps;
        for (q, x) in q.iter_mut().zip(&correction.x) {
            *q += x;
        }
    }
    Stiffness { steps, ..best }
}

/// The same on arrays over the grid. The energy of a residual is the first thing that conjugate gradients find, so that the check
/// of one round is the beginning of the next.
fn filled(
    problem: &mut Problem,
    state: &Solved,
    guess: Option<Vec<f64>>,
    tolerance: f64,
    stop: Stop<'_>,
) -> Stiffness {
    let Problem { operators, arrays, side, .. } = problem;
    let side = *side;
    arrays.reserve(side);
    let Arrays { vectors, .. } = arrays;
    let ambiguous = state.look.undecided();
    let doubtful = Runs::of(&ambiguous);
    let mut at_ambiguous = vec![0.0; ambiguous.len()];
    vectors.take(side, runs::marks(&state.contact));
    let n = state.contact.len();
    let mut fresh = guess.is_none();
    let mut q = guess.unwrap_or_else(|| vec![0.0; n]);
    let mut r = vec![1.0; n];
    let mut best = Stiffness::unknown();
    let (mut steps, mut unimproved) = (0, 0);
    for round in 0..ROUNDS {
        if !fresh {
            let set = &vectors.set;
            operators.exact_rows(
                side,
                |y, out| set.spread(y, &q, out),
                |y, u| {
                    set.collect(y, u, &mut r);
                    doubtful.collect(y, u, &mut at_ambiguous);
                },
            );
            for r in &mut r {
                *r = 1.0 - *r;
            }
        }
        let (sum, rq): (f64, f64) = (q.iter().sum(), cg::dot(&r, &q));
        let unit = r.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
        if unit <= 0.0 {
            break;
        }
        for (out, r) in vectors.r.iter_mut().zip(&r) {
            *out = (r / unit) as f32;
        }
        let last = round + 1 == ROUNDS || unimproved > 2;
        let square = unit * unit;
        let request = filled::cg::Request {
            fixed_sum: false,
            reduction: REDUCTION,
            energy: Some(Energy { share: AIM * tolerance, base: (sum + rq) / square }),
            floor: 0.0,
            steps: if last { 0 } else { STEPS },
            exact: true,
        };
        let done = filled::cg::correct(operators, vectors, request, stop);
        if !fresh {
            let (ritz, error) = bounds(sum, rq, TORUS * done.start.max(0.0) * square);
            unimproved = if error < 0.9 * best.solve_error { 0 } else { unimproved + 1 };
            if error < best.solve_error {
                let set_error = set_error(state, at_ambiguous.iter().copied(), &q) / ritz;
                best = Stiffness { value: ritz, solve_error: error, set_error, q: q.clone(), steps };
            }
            if error <= SHARE * tolerance || last || stop() {
                break;
            }
        }
        fresh = false;
        steps += done.steps;
        for (q, &x) in q.iter_mut().zip(&vectors.x) {
            *q += unit * f64::from(x);
        }
    }
    Stiffness { steps, ..best }
}

/// Ritz value and relative width of the bounds from `1'q`, `r'q` and the energy `r' K^-1 r`.
fn bounds(sum: f64, rq: f64, energy: f64) -> (f64, f64) {
    let ritz = sum * sum / (sum - rq);
    (ritz, (sum + rq + energy - ritz).max(0.0) / ritz)
}

/// Change of k if the undecided cells changed sides.
///
/// Adding cell j adds `(1 - (Kq)_j)^2 / S_j` with a Schur complement S_j not below the smallest eigenvalue; removing one
/// takes away `q_j^2 / (K^-1)_jj`, at most `q_j^2 K_jj`. Undecided are the cells of [`crate::active_set::Look::undecided`] and those whose pressure
/// is below what their own residual gap can change. `tests/honest.rs` compares the sum of both parts with true errors.
fn set_error(state: &Solved, at_ambiguous: impl Iterator<Item = f64>, q: &[f64]) -> f64 {
    let added: f64 = at_ambiguous.map(|v| (1.0 - v).powi(2)).sum::<f64>() / love::SMALLEST_EIGENVALUE;
    let look = &state.look;
    let gap = look.gap.iter().zip(&look.p).filter(|&(_, &p)| p > 0.0).map(|(g, _)| g.abs());
    let removed: f64 = state
        .p
        .iter()
        .zip(q)
        .zip(gap)
        .filter(|&((&p, _), gap)| p < gap / love::SMALLEST_EIGENVALUE)
        .map(|((_, q), _)| q * q)
        .sum::<f64>()
        * love::influence(0, 0);
    added + removed
}

/// The stiffness of a factored set: q is exact up to rounding, one more look at its residual says how far.
pub fn factored(problem: &mut Problem, state: &Solved, q: Vec<f64>) -> Stiffness {
    let ambiguous = state.look.undecided();
    let targets = crate::active_set::with(&state.contact, &ambiguous);
    let v = problem.operators.exact(&state.contact, &q, &targets);
    let r: Vec<f64> = targets.positions(&state.contact).iter().map(|&k| 1.0 - v[k as usize]).collect();
    let sum: f64 = q.iter().sum();
    let rq = cg::dot(&r, &q);
    let energy = cg::energy(&mut problem.operators, &state.contact, &r, false);
    let (value, solve_error) = bounds(sum, rq, energy);
    let at_ambiguous = targets.positions(&ambiguous).into_iter().map(|k| v[k as usize]);
    let set_error = set_error(state, at_ambiguous, &q) / value;
    Stiffness { value, solve_error, set_error, q, steps: 0 }
}

#[cfg(test)]
mod evidence;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::active_set::{self, Guess, Limits, Target};
    use crate::cells::CellSet;
    use approx::assert_relative_eq;
    use contact_model::never;
    use std::sync::Arc;

    /// Full contact of a flat square of `side` cells.
    fn flat(side: usize, dense: bool) -> (Problem, Solved) {
        let n = side * side;
        let mut problem = Problem::new(side, Arc::new(vec![0.0; n]), contact_model::Boundary::Free);
        let guess = Guess {
            set: CellSet::new(side, (0..n as u32).collect()),
            p: vec![1.0; n],
            d: 4.0 * n as f64,
            far: false,
        };
        let limits = Limits { tolerance: 1e-9, height: None, rounds: 100, dense };
        let solved = active_set::solve(&mut problem, Target::Force(1.0), guess, limits, &never);
        (problem, solved)
    }

    #[test]
    fn full_contact_of_small_squares() {
        // data/paper/VALUES.md, given to 8 or 9 digits; k / (E* L) = pi k_scaled / N.
        for (side, expected) in [
            (1, 0.891_106_989),
            (2, 0.993_186_221),
            (4, 1.065_467_232),
            (8, 1.106_498_258),
            (16, 1.128_630_66),
        ] {
            for dense in [true, false] {
                let (mut problem, solved) = flat(side, dense);
                let k = match solved.q.clone() {
                    Some(q) => factored(&mut problem, &solved, q),
                    None => solve(&mut problem, &solved, None, 1e-9, &never),
                };
                let physical = std::f64::consts::PI * k.value / side as f64;
                assert_relative_eq!(physical, expected, max_relative = 5e-9);
                assert!(k.error() < 1e-9, "{}", k.error());
            }
        }
    }

    #[test]
    fn the_estimate_covers_a_loose_solve() {
        let (mut problem, solved) = flat(32, false);
        let exact = solve(&mut problem, &solved, None, 1e-10, &never);
        for tolerance in [1e-1, 1e-2, 1e-3, 1e-4] {
            let loose = solve(&mut problem, &solved, None, tolerance, &never);
            let error = (loose.value / exact.value - 1.0).abs();
            assert!(
                error <= loose.solve_error && loose.solve_error <= tolerance,
                "{error} {}",
                loose.solve_error
            );
            assert!(loose.value <= exact.value * (1.0 + 1e-12), "a Ritz value is a lower bound");
        }
    }
}
