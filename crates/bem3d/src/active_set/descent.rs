//! The fall-back of the outer iteration: a descent method that lowers the energy in every step from any
//! pressure.

use super::bounds::Bounds;
use crate::geometry::CellSet;
use crate::operator::Operators;
use crate::real::{dot, each, sum, sum_of_pairs, update};
use contact_model::Stop;

/// Largest number of passes over the cells in a projection; about a dozen are usual.
const PASSES: usize = 200;
/// A sum is accepted where its relative error is less than this: the rounding of a sum.
const ROUNDING: f64 = 1e-15;

/// The pressures between their bounds, of a given sum where the force is prescribed.
#[derive(Debug, Clone, Copy)]
pub struct Feasible {
    /// The bounds.
    pub bounds: Bounds,
    /// The sum, where it is prescribed.
    pub force: Option<f64>,
}

impl Feasible {
    /// The nearest feasible pressure: `min(max(y + mu, 0), p_s)`, with the mu that brings the sum to the
    /// force.
    ///
    /// The sum rises with mu and is piecewise linear. Newton's method solves for mu within a bracket, which
    /// is halved where Newton's step leaves it.
    fn project(self, y: &mut [f64]) {
        let upper = self.bounds.upper();
        let Some(force) = self.force else {
            return each(y, |y| *y = y.clamp(0.0, upper));
        };
        // The sum is 0 at the lower end. At the upper end each cell carries its share of the force, or p_s
        // where that is less.
        let (smallest, largest) =
            y.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &y| (a.min(y), b.max(y)));
        let share = force / y.len() as f64;
        let (mut low, mut high) = (-largest, share - smallest);
        let mut shift = 0.0_f64.clamp(low, high.max(low));
        for _ in 0..PASSES {
            let (mut total, mut between) = (0.0, 0.0);
            for y in y.iter() {
                let p = y + shift;
                if p >= upper {
                    total += upper;
                } else if p > 0.0 {
                    total += p;
                    between += 1.0;
                }
            }
            let missing = force - total;
            if missing.abs() <= ROUNDING * force {
                break;
            }
            if missing > 0.0 {
                low = shift;
            } else {
                high = shift;
            }
            let next = shift + missing / between;
            let next = if next > low && next < high { next } else { f64::midpoint(low, high) };
            if next <= low || next >= high {
                break;
            }
            shift = next;
        }
        each(y, |y| *y = (*y + shift).clamp(0.0, upper));
        // Where y is large and p_s small, the shift has fewer digits than the pressures.
        let between = |y: f64| y > 0.0 && y < upper;
        let count = y.iter().filter(|&&y| between(y)).count();
        let missing = (force - sum(y)) / count as f64;
        if count > 0 {
            each(y, |y| {
                if between(*y) {
                    *y = (*y + missing).clamp(0.0, upper);
                }
            });
        }
    }
}

/// Minimises the energy `p'Gp/2 + (z - d)'p` over the feasible pressures on a set of cells, `gap` being its
/// gradient `Gp + z - d`, in at most the given number of steps. Returns the number of steps taken, which is
/// smaller where the energy cannot fall any more.
///
/// The first step goes towards the projection of `p - a gap`, to the minimum of the energy on the way or to
/// its end. Conjugate gradients on the cells between their bounds follow, up to the first bound that a step
/// meets, and as long as the gradient on those cells is the larger part of the projected gradient; then
/// another projected gradient. This is the method of J. J. Moré, G. Toraldo, SIAM J. Optim. 1, 93 (1991) with
/// the proportioning of Z. Dostál, J. Schöberl, Comput. Optim. Appl. 30, 23 (2005), and with exact line
/// searches, which a quadratic energy allows.
///
/// Every step lowers the energy. With a step length a between the inverses of the largest and of the smallest
/// eigenvalue of G, as every one here is, a projected gradient lowers it by at least a fixed share of its
/// distance from the minimum; runs that begin with such a step therefore converge to the unique solution from
/// any pressure (D. P. Bertsekas, Nonlinear Programming, section 2.3).
///
/// Cost: one application of G in double precision a step.
pub fn descend(
    operators: &mut Operators,
    cells: &CellSet,
    (p, gap): (&mut [f64], &mut [f64]),
    feasible: Feasible,
    steps: usize,
    stop: Stop<'_>,
) -> usize {
    let upper = feasible.bounds.upper();
    let (mut target, mut displaced) = (Vec::new(), Vec::new());
    let (mut change, mut residual) = (vec![0.0; p.len()], vec![0.0; p.len()]);
    let mut length = 1.0 / operators.table().own();
    // The square of the last gradient on the cells between their bounds, while conjugate gradients go on.
    let mut conjugate: Option<f64> = None;
    for taken in 0..steps {
        if stop.stops() {
            return taken;
        }
        let (inside, outside, plane) = project_gradient(p, gap, feasible, &mut residual);
        let on_face = taken > 0 && inside > outside;
        let limit = if on_face {
            let beta = conjugate.map_or(0.0, |last| inside / last);
            update(&mut change, &residual, |change, r| *change = beta * *change - r);
            room(p, &change, upper)
        } else {
            target.clear();
            target.extend(p.iter().zip(&*gap).map(|(p, gap)| p - length * (gap - plane)));
            feasible.project(&mut target);
            change.copy_from_slice(&target);
            update(&mut change, p, |change, p| *change -= p);
            1.0
        };
        // The sum of the change is zero up to rounding, and a distant plane would multiply that rounding.
        let slope = sum_of_pairs(&change, gap, |change, gap| change * (gap - plane));
        if slope.is_nan() || slope >= 0.0 {
            if on_face && conjugate.is_some() {
                // Rounding: begin anew.
                conjugate = None;
                continue;
            }
            return taken;
        }
        operators.exact(cells, &change, cells, &mut displaced);
        let curvature = dot(&change, &displaced);
        if curvature.is_nan() || curvature <= 0.0 {
            return taken;
        }
        length = dot(&change, &change) / curvature;
        let share = (-slope / curvature).min(limit);
        if !on_face && share >= 1.0 {
            p.copy_from_slice(&target);
        } else {
            update(p, &change, |p, change| *p = (*p + share * change).clamp(0.0, upper));
        }
        conjugate = (on_face && share < limit).then_some(inside);
        if on_face && share >= limit {
            meet(p, &change, upper);
        }
        update(gap, &displaced, |gap, u| *gap += share * u);
    }
    steps
}

/// The gradient on the cells between their bounds, less its mean where the force is prescribed, zero on all
/// others. Returns its square, the square of the gradient on cells that would leave their bound, and the
/// mean.
fn project_gradient(p: &[f64], gap: &[f64], feasible: Feasible, residual: &mut [f64]) -> (f64, f64, f64) {
    let Feasible { bounds, force } = feasible;
    let upper = bounds.upper();
    let (mut total, mut count) = (0.0, 0.0);
    for (&p, gap) in p.iter().zip(gap) {
        if p > 0.0 && p < upper {
            (total, count) = (total + gap, count + 1.0);
        }
    }
    if count <= 0.0 {
        return (0.0, f64::INFINITY, 0.0);
    }
    let mean = if force.is_some() { total / count } else { 0.0 };
    let mut outside = 0.0;
    for ((r, &p), gap) in residual.iter_mut().zip(p).zip(gap) {
        *r = gap - mean;
        if p <= 0.0 {
            outside += r.min(0.0).powi(2);
            *r = 0.0;
        } else if p >= upper {
            outside += r.max(0.0).powi(2);
            *r = 0.0;
        }
    }
    (dot(residual, residual), outside, mean)
}

/// The largest multiple of a change that can be added before a pressure reaches a bound.
fn room(p: &[f64], change: &[f64], upper: f64) -> f64 {
    let steps = p.iter().zip(change).map(|(p, &change)| {
        if change < 0.0 {
            -p / change
        } else if change > 0.0 {
            (upper - p) / change
        } else {
            f64::INFINITY
        }
    });
    steps.fold(f64::INFINITY, f64::min)
}

/// Puts the pressures that a step brought to a bound, up to rounding, exactly there.
fn meet(p: &mut [f64], change: &[f64], upper: f64) {
    let largest = p.iter().copied().fold(0.0, f64::max);
    let near = 1e-14 * largest;
    update(p, change, |p, &change| {
        if change < 0.0 && *p <= near {
            *p = 0.0;
        } else if change > 0.0 && *p >= upper - near {
            *p = upper;
        }
    });
}

#[cfg(test)]
mod tests;
