//! The response of a state to a small change of the load: how stable it is and how stiff.
//!
//! With the contact set C and the slopes D of the law on the open cells Z within reach, a unit of approach changes the net pressure by
//! x with `A x = 1`, where A is G with `-1/D` added on the diagonal of Z: then `k = 1'x`. Eliminating C leaves `(G^ - 1/D) x_Z = ...` with
//! the Schur complement G^; with `S = D^(1/2) G^ D^(1/2)` and `x_Z = -D^(1/2) v` it is `(1 - S) v = b`, positive definite where the energy
//! has a minimum. Conjugate gradients on it find v and, with the coefficients of Lanczos, the largest eigenvalue rho of S.
//!
//! Where the attraction of a cell depends on its neighbours, `D + C` stands for D, `N = 1 + D^(-1/2) C D^(-1/2)`: then `(1 - S N) v = b` with
//! `x_Z = -D^(1/2) N v`, which is positive definite in the scalar product `u'N v`.

use super::attraction::Attraction;
use super::equilibrium::{Control, Equilibrium};
use super::law::Shape;
use crate::active_set::Problem;
use crate::geometry::CellSet;
use crate::linear::StoppingCriteria;
use crate::real::{dot, each, sum};
use contact_model::Stop;

/// Slopes below this share of the largest one are left out: what they change is below the rounding of the sums.
const FLAT: f64 = 1e-12;
/// Inner solves on the contact reduce their residual by this factor: near what single precision resolves.
const INNER: f64 = 1e-4;
/// Steps of inner solves at most.
const INNER_STEPS: usize = 60;
/// Steps of the reduced iteration at most.
const STEPS: usize = 200;
/// Where the stability alone is wanted, it may change in a step by so much of itself.
const SETTLED: f64 = 1e-3;
/// Rounds of correction of the response with the exact operator.
const ROUNDS: usize = 4;

/// What a small change of the load does.
#[derive(Debug, Clone, Copy, Default)]
pub struct Response {
    /// `1 - rho` for the exponential law, with the approach or the force held as the control says; for Dugdale's law the smallest distance
    /// of the gap of a cell from the range, in ranges.
    pub stability: f64,
    /// `dF/dd` of the net force, nondimensional, of the kernel with its constant; with a short range that of the attached cells.
    pub stiffness: f64,
    /// Its absolute error, estimated from above.
    pub error: f64,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

/// The linearised problem of a state.
struct Linearised<'a> {
    problem: &'a mut Problem,
    contact: CellSet,
    open: CellSet,
    both: CellSet,
    /// Roots of the slopes on the open cells.
    root: Vec<f64>,
    /// Their gaps.
    gap: Vec<f64>,
    attraction: &'a Attraction,
    steps: usize,
    stop: Stop<'a>,
}

/// What conjugate gradients on the open cells found.
struct Reduced {
    v: Vec<f64>,
    /// Smallest Ritz value of `1 - S`, and of the same at a fixed force.
    smallest: f64,
    smallest_at_force: f64,
}

impl Linearised<'_> {
    /// `G_CC^-1 r`, in place; returns the energy of r.
    fn contact_solve(&mut self, r: &mut [f64]) -> f64 {
        let Problem { operators, workspace, .. } = &mut *self.problem;
        let Some(recipe) = operators.planner().system(&self.contact, self.contact.len(), true) else {
            return 0.0;
        };
        workspace.begin_load();
        workspace.take(operators, self.contact.clone(), recipe);
        let criteria = StoppingCriteria { reduction: INNER, energy: None, floor: 0.0, steps: INNER_STEPS };
        let outcome = workspace.solve(operators, r, false, criteria, self.stop);
        self.steps += outcome.steps;
        outcome.energy
    }

    /// `S v`.
    fn apply(&mut self, v: &[f64]) -> Vec<f64> {
        let w: Vec<f64> = v.iter().zip(&self.root).map(|(v, d)| v * d).collect();
        let mut u = Vec::new();
        self.problem.operators.rough(&self.open, &w, &self.both, &mut u);
        let mut x = self.contact.carry(&self.both, &u);
        let mut direct = self.open.carry(&self.both, &u);
        self.contact_solve(&mut x);
        let mut through = Vec::new();
        self.problem.operators.rough(&self.contact, &x, &self.open, &mut through);
        for ((u, t), d) in direct.iter_mut().zip(&through).zip(&self.root) {
            *u = d * (*u - t);
        }
        direct
    }

    /// `N v`.
    fn with_neighbours(&self, v: &[f64]) -> Vec<f64> {
        let mut sum = v.to_vec();
        if let Some(coupled) = self.attraction.coupling(&self.open, &self.gap, &self.root) {
            sum.iter_mut().zip(coupled(v)).for_each(|(sum, more)| *sum += more);
        }
        sum
    }

    /// Solves `(1 - S N) v = b` in the scalar product of N until the energy of the residual is below `wanted` or, without it, until the smallest eigenvalue has settled.
    /// `held` is the stiffness of the contact alone where the force is fixed.
    fn reduce(&mut self, b: &[f64], wanted: Option<f64>, held: f64) -> Reduced {
        let mut v = vec![0.0; b.len()];
        let mut r = b.to_vec();
        let mut nr = self.with_neighbours(&r);
        let (mut t, mut nt) = (r.clone(), nr.clone());
        let start = dot(&r, &nr);
        let mut rr = start;
        let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
        let mut last = (0.0, 0.0);
        let mut found = Reduced { v: Vec::new(), smallest: 1.0, smallest_at_force: 1.0 };
        let mut before = f64::INFINITY;
        for _ in 0..STEPS {
            if rr <= 0.0 || (self.stop)() {
                break;
            }
            let snt = self.apply(&nt);
            let at: Vec<f64> = t.iter().zip(&snt).map(|(t, snt)| t - snt).collect();
            let curvature = dot(&nt, &at);
            let alpha = rr / curvature;
            let (alpha0, beta0): (f64, f64) = last;
            diagonal.push(alpha.recip() + if alpha0 == 0.0 { 0.0 } else { beta0 / alpha0 });
            found.smallest = lowest_eigenvalue(&diagonal, &beside);
            let mut at_force = diagonal.clone();
            if held > 0.0 {
                at_force[0] -= start / held;
            }
            found.smallest_at_force = lowest_eigenvalue(&at_force, &beside);
            if curvature.is_nan() || curvature <= 0.0 || found.smallest <= 0.0 {
                break;
            }
            for ((v, r), (t, at)) in v.iter_mut().zip(&mut r).zip(t.iter().zip(&at)) {
                *v += alpha * t;
                *r -= alpha * at;
            }
            nr = self.with_neighbours(&r);
            let next = dot(&r, &nr);
            let beta = next / rr;
            let least = found.smallest.min(found.smallest_at_force);
            let done = match wanted {
                Some(wanted) => next / found.smallest <= wanted,
                None => (before - least).abs() <= SETTLED * least.abs(),
            };
            before = least;
            if done || next <= INNER * INNER * INNER * start {
                break;
            }
            beside.push(beta.sqrt() / alpha);
            for (t, r) in [(&mut t, &r), (&mut nt, &nr)] {
                t.iter_mut().zip(r).for_each(|(t, r)| *t = r + beta * *t);
            }
            last = (alpha, beta);
            rr = next;
        }
        found.v = v;
        found
    }
}

/// The response of a state; `tolerance` is that of the stiffness, relative, `None` where it is not wanted.
///
/// Cost: some ten steps, each one solve on the contact and two applications of G.
pub fn respond(
    problem: &mut Problem,
    attraction: &Attraction,
    control: Control,
    state: &Equilibrium,
    tolerance: Option<f64>,
    stop: Stop<'_>,
) -> Response {
    let law = attraction.law;
    let contact = state.contact();
    let least = FLAT * law.peak / law.range;
    let mut slopes = attraction.slopes(&state.cells, &state.gap);
    slopes.iter_mut().zip(&state.pressure).filter(|(_, p)| **p > 0.0).for_each(|(s, _)| *s = 0.0);
    let open = state.cells.filter(&slopes, |s| s > least);
    let root: Vec<f64> = open.carry(&state.cells, &slopes).iter().map(|s| s.sqrt()).collect();
    let gap = open.carry(&state.cells, &state.gap);
    let both = contact.union(&open);
    let mut linearised = Linearised { problem, contact, open, both, root, gap, attraction, steps: 0, stop };
    let held = attraction.held(&state.cells, &state.gap);
    let mut response = linearised.response(control, if held.is_some() { None } else { tolerance });
    if let (Some(held), Some(_)) = (held, tolerance) {
        (linearised.both, linearised.contact) = (held.clone(), held);
        (linearised.open, linearised.root, linearised.gap) = Default::default();
        let Response { stiffness, error, .. } = linearised.response(Control::Approach(state.d), tolerance);
        (response.stiffness, response.error) = (stiffness, error);
    }
    if law.shape == Shape::Uniform {
        response.stability = (state.pressure.iter().zip(&state.gap))
            .filter(|(p, _)| **p <= 0.0)
            .map(|(_, g)| (g / law.range - 1.0).abs())
            .fold(1.0, f64::min);
    }
    response.steps = linearised.steps;
    response
}

impl Linearised<'_> {
    fn response(&mut self, control: Control, tolerance: Option<f64>) -> Response {
        let mut response = Response { stability: 1.0, error: f64::INFINITY, ..Response::default() };
        if self.both.is_empty() {
            // Nothing within reach: nothing responds.
            return Response { error: 0.0, ..response };
        }
        // The net pressure per approach, and what is left of its equation.
        let mut x = vec![0.0; self.both.len()];
        let mut opening = vec![0.0; self.open.len()];
        let mut r = vec![1.0; self.both.len()];
        for round in 0..ROUNDS {
            let mut on_contact = self.contact.carry(&self.both, &r);
            let energy = self.contact_solve(&mut on_contact);
            let mut through = Vec::new();
            self.problem.operators.rough(&self.contact, &on_contact, &self.open, &mut through);
            let left = self.open.carry(&self.both, &r);
            let b: Vec<f64> =
                left.iter().zip(&through).zip(&self.root).map(|((l, t), d)| d * (l - t)).collect();
            if round > 0 {
                let value = sum(&x) + dot(&r, &x);
                let error = energy.abs()
                    + dot(&b, &self.with_neighbours(&b)) / response.stability.max(f64::MIN_POSITIVE);
                if error < response.error {
                    (response.stiffness, response.error) = (value, error);
                }
                if tolerance.is_none_or(|t| response.error <= 0.5 * t * response.stiffness.abs()) {
                    break;
                }
            }
            let held = match control {
                Control::Force(_) if round == 0 => sum(&on_contact),
                _ => 0.0,
            };
            let scale = sum(&on_contact).abs().max(dot(&b, &b));
            let wanted = tolerance.map(|t| 1e-2 * t * scale);
            let found = self.reduce(&b, wanted, held);
            if round == 0 {
                response.stability = match control {
                    Control::Force(_) => found.smallest_at_force.min(found.smallest),
                    Control::Approach(_) => found.smallest,
                };
                if found.smallest <= 0.0 || tolerance.is_none() {
                    return response;
                }
            }
            let on_open: Vec<f64> =
                self.with_neighbours(&found.v).iter().zip(&self.root).map(|(v, d)| -v * d).collect();
            opening.iter_mut().zip(found.v.iter().zip(&self.root)).for_each(|(g, (v, d))| *g += v / d);
            let mut u = Vec::new();
            self.problem.operators.rough(&self.open, &on_open, &self.contact, &mut u);
            let mut more = self.contact.carry(&self.both, &r);
            more.iter_mut().zip(&u).for_each(|(m, u)| *m -= u);
            self.contact_solve(&mut more);
            self.both.add_carried(&self.contact, &more, &mut x);
            self.both.add_carried(&self.open, &on_open, &mut x);
            // What is left, with the exact operator.
            self.problem.operators.exact(&self.both, &x, &self.both, &mut r);
            self.both.add_carried(&self.open, &opening, &mut r);
            each(&mut r, |r| *r = 1.0 - *r);
        }
        response
    }
}

/// Smallest eigenvalue of a symmetric tridiagonal matrix, by bisection with Sturm's sequence.
fn lowest_eigenvalue(diagonal: &[f64], beside: &[f64]) -> f64 {
    let radius = |i: usize| {
        let left = if i > 0 { beside[i - 1].abs() } else { 0.0 };
        left + beside.get(i).filter(|_| i + 1 < diagonal.len()).map_or(0.0, |b| b.abs())
    };
    let mut low = (0..diagonal.len()).map(|i| diagonal[i] - radius(i)).fold(f64::INFINITY, f64::min);
    let mut high = diagonal.iter().copied().fold(f64::INFINITY, f64::min);
    let below = |x: f64| {
        let mut d = 1.0;
        diagonal.iter().enumerate().any(|(i, a)| {
            let b = if i > 0 { beside[i - 1] } else { 0.0 };
            d = a - x - b * b / d;
            d < 0.0
        })
    };
    for _ in 0..100 {
        let middle = f64::midpoint(low, high);
        if below(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_lowest_eigenvalue_of_the_second_difference() {
        let n = 12;
        let found = lowest_eigenvalue(&vec![2.0; n], &vec![-1.0; n - 1]);
        let expected = 2.0 - 2.0 * (std::f64::consts::PI / (n as f64 + 1.0)).cos();
        approx::assert_relative_eq!(found, expected, max_relative = 1e-12);
        approx::assert_relative_eq!(lowest_eigenvalue(&[3.0], &[]), 3.0);
    }
}
