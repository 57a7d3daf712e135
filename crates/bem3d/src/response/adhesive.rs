//! The response of a state to a small change of the load: how stable it is and how stiff.
//!
//! With the contact set C and the negative derivatives K of the attractions of the open cells Z in their gaps,
//! a unit of approach changes the net pressure by x and the openings of Z by `-o`, with
//!
//! ```text
//! (G x)_C = 1,    (G x)_Z + o = 1,    x_Z = -K o,
//! ```
//!
//! and `k = 1'x`. Eliminating C leaves `(1 - K G^) y = K b` for `y = -x_Z` with the Schur complement G^ and
//! `b = 1 - G_ZC G_CC^-1 1`; then `o = b + G^ y`. In the scalar product `y' G^ y` the matrix is symmetric, and
//! positive definite where the energy has a minimum, also where K is not: the law of a short range is level in
//! contact, where the neighbours alone are left. Conjugate gradients in that product find y and, with the
//! coefficients of Lanczos, the largest eigenvalue r of K G^.
//!
//! At a fixed force the approach follows, and `G^ + b b'/h` stands for G^ with the stiffness h of the contact
//! alone. Its solution y' of the same right-hand side is `(1 + b'y'/h) y`.
//!
//! With the mean plane of a periodic surface held, G stands for the kernel of zero mean. Where every cell
//! touches, that is singular: the force is free, and there is no stiffness.

use super::normal::{of_held_cells, of_zero_mean};
use super::{Conditions, Goal, NormalStiffness, StiffnessCorrection, refine};
use crate::active_set::Problem;
use crate::adhesion::{AdhesiveControl, Attraction, Equilibrium, LawShape, Pairs};
use crate::geometry::CellSet;
use crate::linear::{Fixed, StoppingCriteria};
use crate::real::{dot, each, largest, sum, update};
use contact_model::{Interrupted, Stop};
use numerics::root::bisect;

/// Slopes below this share of the largest one are left out: what they change is below the rounding of the
/// sums.
const FLAT: f64 = 1e-12;
/// Solves on the contact reduce their residual by this factor; further rounds correct the response.
const INNER: f64 = 1e-2;
/// The reduced iteration ends where its residual has fallen by this factor, whether or not the stability has
/// settled.
const REDUCED: f64 = 1e-9;
/// It also ends with a residual that displaces the open cells by less than this share of what it would displace
/// each cell alone. With the mean plane of a periodic surface held some tractions displace nothing; on a few cells
/// only these are left after a few steps, and a Ritz value of their rounding would call a stable state unstable.
const NO_DISPLACEMENT: f64 = 1e-2;
/// Steps of inner solves at most.
const INNER_STEPS: usize = 60;
/// Steps of the reduced iteration at most.
const STEPS: usize = 200;
/// The stability may still change by so much of itself in each of two steps: in one it may pause.
const SETTLED: f64 = 3e-3;

/// The response to a small change of the load.
#[derive(Debug, Clone, Default)]
pub struct Response {
    /// `1 - r` for the exponential law, with the approach or the force held as the control says; for
    /// Dugdale's law the smallest distance of the gap of a cell from the range, in ranges.
    pub stability: f64,
    /// The stiffness along the branch `dF/dd`, with periodic boundaries `-dF/d(mean gap)`, where it was
    /// requested and exists.
    pub stiffness: Option<NormalStiffness>,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

/// The linearised problem of a state.
struct LinearisedAdhesion<'a> {
    problem: &'a mut Problem,
    contact: CellSet,
    open: CellSet,
    both: CellSet,
    /// Magnitudes of the slopes of the law on the open cells.
    slopes: Vec<f64>,
    /// How their attractions follow the gaps of others, in units of `unit`.
    coupling: Option<Pairs>,
    /// Peak over range of the law.
    unit: f64,
    /// The constant that is taken from the kernel: all of it where the mean plane is held.
    constant: f64,
    request: ResponseRequest<'a>,
    /// The smallest Ritz value so far; `None` before the first correction.
    stability: Option<f64>,
    steps: usize,
}

/// The result of conjugate gradients on the open cells.
struct Reduced {
    /// `G^ y`.
    displacement: Vec<f64>,
    /// Smallest Ritz value of `1 - K G^`, at a fixed force of what stands for it.
    smallest: f64,
}

impl<'a> LinearisedAdhesion<'a> {
    fn new(
        problem: &'a mut Problem,
        attraction: &Attraction,
        state: &Equilibrium,
        contact: CellSet,
        request: ResponseRequest<'a>,
    ) -> Self {
        let unit = attraction.law.peak / attraction.law.range;
        let mut slopes = attraction.slopes(&state.cells, &state.gap);
        slopes.iter_mut().zip(&state.pressure).filter(|(_, p)| **p > 0.0).for_each(|(s, _)| *s = 0.0);
        let open = state.cells.filter(&slopes, |s| s > FLAT * unit);
        let gap = open.carry(&state.cells, &state.gap);
        let both = contact.union(&open);
        let holds_plane = matches!(request.control, AdhesiveControl::Plane(_));
        Self {
            slopes: open.carry(&state.cells, &slopes),
            coupling: attraction.coupling(&open, &gap, &vec![unit.sqrt(); open.len()]),
            constant: if holds_plane { problem.operators.table().shift() } else { 0.0 },
            problem,
            contact,
            open,
            both,
            unit,
            request,
            stability: None,
            steps: 0,
        }
    }
}

impl LinearisedAdhesion<'_> {
    /// `G_CC^-1 r`, in place; returns the energy of r.
    fn contact_solve(&mut self, r: &mut [f64]) -> Result<f64, Interrupted> {
        let Problem { operators, workspace, .. } = &mut *self.problem;
        let Some(recipe) = operators.planner().system(&self.contact, self.contact.len(), true) else {
            return Ok(0.0);
        };
        let stop = self.request.stop;
        workspace.begin_load();
        workspace.take(operators, self.contact.clone(), recipe, stop)?;
        let criteria = StoppingCriteria { reduction: INNER, energy: None, floor: 0.0, steps: INNER_STEPS };
        let fixed = if self.constant > 0.0 { Fixed::MeanPlane(self.constant) } else { Fixed::Approach };
        let outcome = workspace.solve(operators, r, fixed, criteria, stop)?;
        self.steps += outcome.steps;
        Ok(outcome.energy)
    }

    /// `G p` in single precision, from the cells of one set to those of another.
    fn rough(&mut self, sources: &CellSet, p: &[f64], targets: &CellSet) -> Result<Vec<f64>, Interrupted> {
        let mut u = Vec::new();
        self.problem.operators.rough(sources, p, targets, &mut u, self.request.stop)?;
        self.without_constant(p, &mut u);
        Ok(u)
    }

    fn without_constant(&self, p: &[f64], u: &mut [f64]) {
        let offset = self.constant * sum(p);
        each(u, |u| *u -= offset);
    }

    /// `G^ y`.
    fn apply(&mut self, y: &[f64]) -> Result<Vec<f64>, Interrupted> {
        let (contact, open, both) = (self.contact.clone(), self.open.clone(), self.both.clone());
        let u = self.rough(&open, y, &both)?;
        let mut x = contact.carry(&both, &u);
        let mut displacement = open.carry(&both, &u);
        self.contact_solve(&mut x)?;
        let through = self.rough(&contact, &x, &open)?;
        update(&mut displacement, &through, |u, through| *u -= through);
        Ok(displacement)
    }

    /// `K g`.
    fn answer(&self, gap: &[f64]) -> Vec<f64> {
        let mut answer: Vec<f64> = self.slopes.iter().zip(gap).map(|(d, g)| d * g).collect();
        if let Some(coupling) = &self.coupling {
            coupling.add_product(self.unit, gap, &mut answer);
        }
        answer
    }

    /// Solves `(1 - K G^) y = K b` until the energy of the residual is below `wanted` or, without it, until the
    /// smallest eigenvalue has settled. `held` is the stiffness of the contact alone where the force is fixed.
    fn reduce(&mut self, b: &[f64], wanted: Option<f64>, held: Option<f64>) -> Result<Reduced, Interrupted> {
        let follows = |y: &[f64]| held.map_or(0.0, |held| dot(b, y) / held);
        let apply = |linearised: &mut Self, y: &[f64]| {
            let (mut u, share) = (linearised.apply(y)?, follows(y));
            update(&mut u, b, |u, b| *u += share * b);
            Ok(u)
        };
        let own = self.problem.operators.table().own();
        let mut r = self.answer(b);
        let mut t = r.clone();
        let (mut displacement, mut approach) = (vec![0.0; b.len()], 0.0);
        let mut smallest = 1.0;
        // The displacements under r and t.
        let mut ur = if largest(&r) > 0.0 { apply(self, &r)? } else { r.clone() };
        let mut ut = ur.clone();
        let mut rr = dot(&r, &ur);
        let start = rr;
        let (mut diagonal, mut beside) = (Vec::new(), Vec::new());
        let mut last: (f64, f64) = (0.0, 0.0);
        let (mut before, mut settled) = (f64::INFINITY, 0);
        for _ in 0..STEPS {
            if rr.is_nan() || rr <= 0.0 {
                break;
            }
            let mut mt = self.answer(&ut);
            update(&mut mt, &t, |mt, t| *mt = t - *mt);
            let curvature = dot(&ut, &mt);
            let alpha = rr / curvature;
            let (alpha0, beta0) = last;
            diagonal.push(alpha.recip() + if alpha0 == 0.0 { 0.0 } else { beta0 / alpha0 });
            smallest = lowest_eigenvalue(&diagonal, &beside);
            if curvature.is_nan() || curvature <= 0.0 || smallest <= 0.0 {
                break;
            }
            update(&mut displacement, &ut, |u, ut| *u += alpha * ut);
            approach += alpha * follows(&t);
            update(&mut r, &mt, |r, mt| *r -= alpha * mt);
            settled = if (before - smallest).abs() <= SETTLED * smallest.abs() { settled + 1 } else { 0 };
            before = smallest;
            if settled > 1 && wanted.is_none() {
                break;
            }
            ur = apply(self, &r)?;
            let next = dot(&r, &ur);
            let beta = next / rr;
            let done = settled > 1 && wanted.is_none_or(|wanted| next / smallest <= wanted);
            let is_nothing = next <= NO_DISPLACEMENT * own * dot(&r, &r);
            if done || is_nothing || next <= REDUCED * REDUCED * start {
                break;
            }
            beside.push(beta.sqrt() / alpha);
            for (t, r) in [(&mut t, &r), (&mut ut, &ur)] {
                update(t, r, |t, r| *t = r + beta * *t);
            }
            last = (alpha, beta);
            rr = next;
        }
        update(&mut displacement, b, |u, b| *u = (*u - approach * b) / (1.0 + approach));
        Ok(Reduced { displacement, smallest })
    }
}

/// Which response of a state is requested.
#[derive(Clone, Copy)]
pub struct ResponseRequest<'a> {
    /// The force or the plane that is prescribed.
    pub control: AdhesiveControl,
    /// The largest relative error of the stiffness; `None` where only the stability is wanted.
    pub tolerance: Option<f64>,
    /// When to stop.
    pub stop: Stop<'a>,
}

/// The response of a state.
///
/// # Errors
/// [`Interrupted`] by the stop.
///
/// Cost: some ten steps, each one solve on the contact and two applications of G.
pub fn respond(
    problem: &mut Problem,
    attraction: &Attraction,
    state: &Equilibrium,
    request: ResponseRequest<'_>,
) -> Result<Response, Interrupted> {
    let law = attraction.law;
    // Cells that flow do not follow.
    let contact = state.contact();
    let on_contact = contact.carry(&state.cells, &state.pressure);
    let contact = problem.bounds.free(&contact, &on_contact).into_owned();
    let shift = problem.operators.table().shift();
    let is_full = shift > 0.0 && contact.len() == problem.grid().count();
    // A stopped search has no stability: nothing that is unstable was found.
    if is_full || request.stop.stops() {
        return Ok(Response { stability: 1.0, ..Response::default() });
    }
    let mut linearised = LinearisedAdhesion::new(problem, attraction, state, contact, request);
    let stiffness = linearised.stiffness()?;
    let (stability, steps) = (linearised.stability.unwrap_or(1.0), linearised.steps);
    let stiffness = match request.control {
        AdhesiveControl::Force(_) => stiffness.map(|k| of_zero_mean(k, shift)),
        AdhesiveControl::Plane(_) => stiffness,
    };
    let mut response = Response { stability, stiffness, steps };
    if law.shape == LawShape::Uniform {
        response.stability = (state.pressure.iter().zip(&state.gap))
            .filter(|(p, _)| **p <= 0.0)
            .map(|(_, g)| (g / law.range - 1.0).abs())
            .fold(1.0, f64::min);
    }
    Ok(response)
}

/// The stiffness at a fixed contact area: that of the closed cells and, with a short range, of the cells that
/// hold more than half of their work. `None` where the contact area is the whole of a periodic surface.
///
/// # Errors
/// [`Interrupted`] by the stop.
///
/// Cost: one or two solves on the contact.
pub fn fixed_area(
    problem: &mut Problem,
    attraction: &Attraction,
    state: &Equilibrium,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<Option<NormalStiffness>, Interrupted> {
    let area = attraction.held(&state.cells, &state.gap).unwrap_or_else(|| state.contact());
    let is_periodic = problem.operators.table().shift() > 0.0;
    if stop.stops() || (is_periodic && area.len() == problem.grid().count()) {
        return Ok(None);
    }
    if area.is_empty() {
        return Ok(Some(NormalStiffness::nothing()));
    }
    let found = of_held_cells(problem, &area, tolerance, stop)?;
    Ok(found.solve_error.is_finite().then_some(found))
}

impl LinearisedAdhesion<'_> {
    /// The stiffness where it is wanted, and the stability.
    fn stiffness(&mut self) -> Result<Option<NormalStiffness>, Interrupted> {
        if self.both.is_empty() {
            // No cell is within reach: there is no response.
            return Ok(Some(NormalStiffness::nothing()));
        }
        let tuning = *self.problem.operators.tuning();
        let stop = self.request.stop;
        let found = refine(self, None, self.request.tolerance.unwrap_or(1.0), &tuning, stop)?;
        // No later solve begins with the pressures, which are as large as the state.
        let found = NormalStiffness { change: [Vec::new()], ..found };
        Ok(found.solve_error.is_finite().then_some(found))
    }
}

/// The numbers are the net pressures of the contact and of the open cells, and after them the openings of the
/// open cells, whose attractions follow these exactly.
impl Conditions<1, 1> for LinearisedAdhesion<'_> {
    const DEFINITE: bool = false;

    fn displacements(&self) -> [Vec<f64>; 1] {
        let mut right = vec![1.0; self.both.len()];
        right.resize(self.both.len() + self.open.len(), 0.0);
        [right]
    }

    fn forces(&self, x: &[f64]) -> [f64; 1] {
        [sum(&x[..self.both.len()])]
    }

    fn residual(
        &mut self,
        [x]: &[Vec<f64>; 1],
        _: bool,
        [r]: &mut [Vec<f64>; 1],
    ) -> Result<bool, Interrupted> {
        let (x, opening) = x.split_at(self.both.len());
        let mut left = Vec::new();
        self.problem.operators.exact(&self.both, x, &self.both, &mut left, self.request.stop)?;
        self.without_constant(x, &mut left);
        self.both.add_carried(&self.open, opening, &mut left);
        each(&mut left, |r| *r = 1.0 - *r);
        r[..left.len()].copy_from_slice(&left);
        r[left.len()..].fill(0.0);
        Ok(true)
    }

    fn correct(
        &mut self,
        [r]: &mut [Vec<f64>; 1],
        goal: Goal<1>,
    ) -> Result<Option<StiffnessCorrection<1>>, Interrupted> {
        let before = self.steps;
        let (contact, open) = (self.contact.clone(), self.open.clone());
        let (r, opening) = r.split_at_mut(self.both.len());
        // Eliminates the contact.
        let mut on_contact = contact.carry(&self.both, r);
        let energy = self.contact_solve(&mut on_contact)?;
        let through = self.rough(&contact, &on_contact, &open)?;
        let mut b = open.carry(&self.both, r);
        update(&mut b, &through, |b, through| *b -= through);
        // Of the quadratic form of what is left of the open cells, from above.
        let magnitudes: Vec<f64> = b.iter().map(|b| b.abs()).collect();
        let left = dot(&magnitudes, &self.answer(&magnitudes));
        let energy = [energy.abs() + left / self.stability.unwrap_or(1.0).max(f64::MIN_POSITIVE)];
        if goal.only_energy || energy[0] < goal.enough * goal.bases[0].abs() {
            return Ok(Some(StiffnessCorrection { energy, steps: None }));
        }
        // The open cells.
        let first = self.stability.is_none();
        let held = match self.request.control {
            AdhesiveControl::Force(_) if first => Some(sum(&on_contact)).filter(|held| *held > 0.0),
            _ => None,
        };
        let scale = sum(&on_contact).abs().max(left);
        let found = self.reduce(&b, self.request.tolerance.map(|t| 1e-2 * t * scale), held)?;
        // Ritz values lie above the eigenvalue.
        self.stability = Some(self.stability.map_or(found.smallest, |known| known.min(found.smallest)));
        if self.request.tolerance.is_none() || (first && found.smallest <= 0.0) {
            return Ok(None);
        }
        let mut opened = b;
        update(&mut opened, &found.displacement, |opened, u| *opened += u);
        let mut on_open = self.answer(&opened);
        each(&mut on_open, |x| *x = -*x);
        // Back to the contact.
        let u = self.rough(&open, &on_open, &contact)?;
        let mut on_contact = contact.carry(&self.both, r);
        on_contact.iter_mut().zip(&u).for_each(|(x, u)| *x -= u);
        self.contact_solve(&mut on_contact)?;
        r.fill(0.0);
        self.both.add_carried(&contact, &on_contact, r);
        self.both.add_carried(&open, &on_open, r);
        opening.copy_from_slice(&opened);
        Ok(Some(StiffnessCorrection { energy, steps: Some(self.steps - before) }))
    }

    fn set_error(&self, _: &[Vec<f64>; 1]) -> f64 {
        0.0
    }
}

/// Smallest eigenvalue of a symmetric tridiagonal matrix, by bisection with Sturm's sequence.
fn lowest_eigenvalue(diagonal: &[f64], beside: &[f64]) -> f64 {
    let radius = |i: usize| {
        let left = if i > 0 { beside[i - 1].abs() } else { 0.0 };
        left + beside.get(i).filter(|_| i + 1 < diagonal.len()).map_or(0.0, |b| b.abs())
    };
    let low = (0..diagonal.len()).map(|i| diagonal[i] - radius(i)).fold(f64::INFINITY, f64::min);
    let high = diagonal.iter().copied().fold(f64::INFINITY, f64::min);
    let below = |x: f64| {
        let mut d = 1.0;
        diagonal.iter().enumerate().any(|(i, a)| {
            let b = if i > 0 { beside[i - 1] } else { 0.0 };
            d = a - x - b * b / d;
            d < 0.0
        })
    };
    let [_, high] = bisect(low, high, 100, |x| !below(x));
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
