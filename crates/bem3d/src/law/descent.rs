//! The fall-back of the iterations of contact and of friction: a descent method that lowers the energy in every
//! step from any tractions.

use super::definition::ConvexLaw;
use crate::real::{dot, sum_of_pairs, update};
use contact_model::{Interrupted, Stop};

/// The conditions of a descent, and where it is.
#[derive(Debug)]
pub struct Descent<'a, L, const N: usize> {
    /// What the tractions obey.
    pub law: &'a L,
    /// Their sum, where it is prescribed.
    pub force: Option<[f64; N]>,
    /// The tractions, admissible.
    pub tractions: &'a mut [f64],
    /// The gradient of the energy: the gap, or minus the slip.
    pub gradient: &'a mut [f64],
    /// The displacement of a cell under its own unit traction.
    pub own: f64,
}

/// Minimises the energy `t'Kt/2 + z't` over the admissible tractions, `gradient` being `Kt + z`, in at most the
/// given number of steps; `displace` writes `K` times a field. Returns the number of steps taken, which is smaller
/// where the energy cannot fall any more.
///
/// The first step goes towards the projection of `t - a gradient`, to the minimum of the energy on the way or to
/// its end. Conjugate gradients on the cells between their bounds follow, up to the first bound that a step
/// meets, and as long as the gradient on those cells is the larger part of the projected gradient; then
/// another projected gradient. This is the method of J. J. Moré, G. Toraldo, SIAM J. Optim. 1, 93 (1991) with
/// the proportioning of Z. Dostál, J. Schöberl, Comput. Optim. Appl. 30, 23 (2005), and with exact line
/// searches, which a quadratic energy allows.
///
/// Every step lowers the energy. With a step length a between the inverses of the largest and of the smallest
/// eigenvalue of K, as every one here is, a projected gradient lowers it by at least a fixed share of its
/// distance from the minimum; runs that begin with such a step therefore converge to the unique solution from
/// any tractions (D. P. Bertsekas, Nonlinear Programming, section 2.3).
///
/// # Errors
/// [`Interrupted`] by the stop or by `displace`; tractions and gradient are then those after some step.
///
/// Cost: one application of K in double precision a step.
pub fn descend<L: ConvexLaw<N>, const N: usize>(
    mut descent: Descent<'_, L, N>,
    mut displace: impl FnMut(&[f64], &mut Vec<f64>) -> Result<(), Interrupted>,
    steps: usize,
    stop: Stop<'_>,
) -> Result<usize, Interrupted> {
    let (mut target, mut displaced) = (Vec::new(), Vec::new());
    let size = descent.tractions.len();
    let (mut change, mut residual) = (vec![0.0; size], vec![0.0; size]);
    let mut length = 1.0 / descent.own;
    // The square of the last gradient on the cells between their bounds, while conjugate gradients go on.
    let mut conjugate: Option<f64> = None;
    for taken in 0..steps {
        if stop.stops() {
            return Err(Interrupted);
        }
        let Projected { inside, outside, mean } = descent.project_gradient(&mut residual);
        let on_face = taken > 0 && inside > outside;
        let limit = if on_face {
            let beta = conjugate.map_or(0.0, |last| inside / last);
            update(&mut change, &residual, |change, r| *change = beta * *change - r);
            descent.room(&change)
        } else {
            descent.take_step(mean, length, &mut target);
            change.copy_from_slice(&target);
            update(&mut change, descent.tractions, |change, t| *change -= t);
            1.0
        };
        // The sum of the change is zero up to rounding, and a distant plane would multiply that rounding.
        let slope = slope(&change, descent.gradient, mean);
        if slope.is_nan() || slope >= 0.0 {
            if on_face && conjugate.is_some() {
                // Rounding: begin anew.
                conjugate = None;
                continue;
            }
            return Ok(taken);
        }
        displace(&change, &mut displaced)?;
        let curvature = dot(&change, &displaced);
        if curvature.is_nan() || curvature <= 0.0 {
            return Ok(taken);
        }
        length = dot(&change, &change) / curvature;
        let share = (-slope / curvature).min(limit);
        if !on_face && share >= 1.0 {
            descent.tractions.copy_from_slice(&target);
        } else {
            descent.follow(&change, share);
        }
        conjugate = (on_face && share < limit).then_some(inside);
        if on_face && share >= limit {
            descent.law.meet(descent.tractions, &change);
        }
        update(descent.gradient, &displaced, |gradient, u| *gradient += share * u);
    }
    Ok(steps)
}

impl<L: ConvexLaw<N>, const N: usize> Descent<'_, L, N> {
    /// Writes the projection of `t - length (gradient - mean)`.
    fn take_step(&self, mean: [f64; N], length: f64, target: &mut Vec<f64>) {
        target.clear();
        let n = self.tractions.len() / N;
        for (component, mean) in mean.into_iter().enumerate() {
            let cells = component * n..(component + 1) * n;
            let pairs = self.tractions[cells.clone()].iter().zip(&self.gradient[cells]);
            target.extend(pairs.map(|(t, gradient)| t - length * (gradient - mean)));
        }
        self.law.project(target, self.force);
    }

    /// The share of a change at which the first cell meets its bound.
    fn room(&self, change: &[f64]) -> f64 {
        let (law, t) = (self.law, &*self.tractions);
        let n = t.len() / N;
        (0..n).map(|i| law.room(i, at(t, n, i), at(change, n, i))).fold(f64::INFINITY, f64::min)
    }

    /// Takes a share of a change; rounding does not lead beyond a bound.
    fn follow(&mut self, change: &[f64], share: f64) {
        let (law, t) = (self.law, &mut *self.tractions);
        update(t, change, |t, change| *t += share * change);
        let n = t.len() / N;
        for i in 0..n {
            put(t, n, i, law.nearest(i, at(t, n, i)));
        }
    }

    /// Splits the gradient, and writes its part on cells between their bounds, zero on all others.
    fn project_gradient(&self, residual: &mut [f64]) -> Projected<N> {
        let (law, t, gradient) = (self.law, &*self.tractions, &*self.gradient);
        let n = t.len() / N;
        let (mut total, mut count) = ([0.0; N], 0.0);
        for i in (0..n).filter(|&i| law.held(i, at(t, n, i), [0.0; N]).is_none()) {
            let gradient: [f64; N] = at(gradient, n, i);
            total.iter_mut().zip(gradient).for_each(|(total, gradient)| *total += gradient);
            count += 1.0;
        }
        if count <= 0.0 {
            return Projected { inside: 0.0, outside: f64::INFINITY, mean: [0.0; N] };
        }
        let mean = total.map(|total| if self.force.is_some() { total / count } else { 0.0 });
        let mut outside = 0.0;
        for i in 0..n {
            let gradient: [f64; N] = at(gradient, n, i);
            let r: [f64; N] = std::array::from_fn(|component| gradient[component] - mean[component]);
            let held = law.held(i, at(t, n, i), r.map(|r| -r));
            outside += held.unwrap_or(0.0);
            put(residual, n, i, if held.is_some() { [0.0; N] } else { r });
        }
        Projected { inside: dot(residual, residual), outside, mean }
    }
}

/// The components of cell i.
fn at<const N: usize>(v: &[f64], n: usize, i: usize) -> [f64; N] {
    std::array::from_fn(|component| v[component * n + i])
}

fn put<const N: usize>(v: &mut [f64], n: usize, i: usize, value: [f64; N]) {
    for (component, value) in value.into_iter().enumerate() {
        v[component * n + i] = value;
    }
}

/// The slope of the energy along a change, with gradients measured from their mean.
fn slope<const N: usize>(change: &[f64], gradient: &[f64], mean: [f64; N]) -> f64 {
    let n = change.len() / N;
    let of = |component: usize| {
        let (cells, mean) = (component * n..(component + 1) * n, mean[component]);
        let along = |change, gradient| change * (gradient - mean);
        sum_of_pairs(&change[cells.clone()], &gradient[cells], along)
    };
    (0..N).map(of).reduce(|a, b| a + b).unwrap_or(0.0)
}

/// The two parts of a gradient.
struct Projected<const N: usize> {
    /// The square of the gradient on cells between their bounds, less its mean where the force is prescribed.
    inside: f64,
    /// The square of the part of the gradient that cells at their bounds may follow.
    outside: f64,
    mean: [f64; N],
}

#[cfg(test)]
mod tests;
