//! One increment: the tractions at its end from those at its beginning.

use super::linearised::{BranchSystem, FrictionRoom, LinearisedFriction, SlipBranch};
use crate::geometry::CellSet;
use crate::law::{ConvexLaw, Descent, Discs, descend, excess, length, sums, total};
use crate::linear::StoppingCriteria;
use crate::operator::{InfluenceOperator, TangentialOperators};
use crate::real::{binary_unit, dot, each, largest, sum, update};
use contact_model::{Interrupted, Status, Stop};
use serde::{Deserialize, Serialize};

/// What is prescribed, nondimensional; components along x and y.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub enum TangentialControl {
    /// Tangential displacement of the bodies; with periodic boundaries that of their mean planes.
    Displacement([f64; 2]),
    /// Sum of the tractions.
    Force([f64; 2]),
}

/// The conditions of one increment on a contact of n cells; vectors hold n components along x, then n along y.
#[derive(Debug, Clone, Copy)]
pub struct Increment<'a> {
    /// The contact at its end.
    pub cells: &'a CellSet,
    /// Largest traction of each cell, by the law of friction at its pressure at the end.
    pub limit: &'a [f64],
    /// The sum of the elastic displacement and of the slip at the beginning: the slip of the increment is
    /// `w = delta - K q - reference`.
    pub reference: &'a [f64],
    /// Tangential load at the end.
    pub control: TangentialControl,
    /// Displacement at the beginning; also that at the end where no condition determines it.
    pub displacement: [f64; 2],
}

/// Accuracy and length of the solve of an increment.
#[derive(Debug, Clone, Copy)]
pub struct FrictionLimits {
    /// Bound of the duality gap relative to its scale.
    pub tolerance: f64,
    /// Changes from the state before count as none below this share of the same scales.
    pub unresolved: f64,
    /// Newton's steps at most.
    pub iterations: usize,
}

/// Tractions and slip during the iteration and at the end of an increment.
#[derive(Debug, Clone)]
pub struct IncrementState {
    /// Tractions, admissible to rounding.
    pub traction: Vec<f64>,
    /// Slip of the increment.
    pub slip: Vec<f64>,
    /// Tangential displacement of the bodies.
    pub displacement: [f64; 2],
    /// `sum(b |w| - q . w)` with the exact operator, relative to `sum(b)` times the larger of `|delta - m|` and of the
    /// largest `|reference - m|`, m the mean of the references weighted by the limits. How far the bodies have slid
    /// before, which is in delta and in the references alike, is not in it.
    pub duality_gap: f64,
    /// The length in its scale.
    pub length: f64,
    /// Difference of the force from the prescribed one, over the largest force.
    pub load_error: f64,
    /// The cells that stick.
    pub stick: CellSet,
    /// Newton's steps.
    pub iterations: usize,
    /// Steps of conjugate gradients.
    pub steps: usize,
    /// How it ended.
    pub status: Status,
}

/// `rho` times the own compliance: y = q + rho w decides between stick and slip.
const STEP: f64 = 0.4;
/// Reduction of the residual in one step, at first: of 0.02 to 0.3 the one of fewest applications for N = 512 and 1024, D_f = 2.2
/// and 2.4, F_bar = 1 (2026-11, Xeon). A tighter one solves well on sets that will change, a looser one takes more than
/// twice as many steps.
const REDUCTION: f64 = 0.1;
/// Steps of a linear solve at most.
const INNER_STEPS: usize = 40;
/// Share of a step from which it is taken whole.
const WHOLE: f64 = 0.75;
/// Rounding of the work of a change over that of the tractions themselves.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// Share below which Newton's step is of no use.
const USELESS: f64 = 0.02;
/// Newton's steps without a better gap after which projected gradients take over ...
const PATIENCE: usize = 4;
/// ... for this number of steps, twice as many each further time.
const GRADIENTS: usize = 8;
/// A gap is better when it falls by this factor.
const BETTER: f64 = 0.7;
/// Share of the gap above which a whole step counts as slow: linear systems are solved further from then on.
const SLOW: f64 = 0.3;
/// Factor of the reduction after a slow step.
const FURTHER: f64 = 0.2;
/// Smallest reduction. The norm of conjugate gradients is mostly that of slip cells, the gap that of stick cells, whose
/// residual has long waves and falls later.
const LEAST_REDUCTION: f64 = 0.02;
/// Units of tractions are at least this share of displacements: squares of these stay finite.
const SMALLEST_UNIT: f64 = 1e-100;
/// Largest force as a share of the friction of all cells: at the whole of it the displacement is unbounded. A
/// larger force is solved as this one, and what the certificate compares is this one too. Its displacement is below
/// the least one at which the contact slides, by at most 1e-6 of it for a ball: `(1 - Q/(mu F))^(2/3)` by Cattaneo.
pub const LARGEST_SHARE: f64 = 1.0 - 1e-9;

/// The kernel of tangential tractions, with room for its systems.
#[derive(Debug)]
pub struct FrictionSystems<'a> {
    /// The kernel.
    pub operators: &'a mut TangentialOperators,
    /// The room.
    pub room: &'a mut FrictionRoom,
}

struct IncrementSolver<'a> {
    operators: &'a mut TangentialOperators,
    room: &'a mut FrictionRoom,
    increment: Increment<'a>,
    limits: FrictionLimits,
    /// Sum of the limits, and largest length of the references.
    most: f64,
    reach: f64,
    rho: f64,
    /// Tractions, and the displacements that they make.
    q: Vec<f64>,
    u: Vec<f64>,
    /// Slip, and the tangential displacement.
    w: Vec<f64>,
    delta: [f64; 2],
    gap: f64,
    /// Reduction of the residual of linear systems.
    reduction: f64,
    /// Whether the last step was taken whole.
    whole: bool,
    iterations: usize,
    steps: usize,
}

/// Solves an increment from tractions `start`.
///
/// The conditions `|q| <= b`, `q . w = b |w|` with `w = delta - K q - reference` are those of the minimum of the convex
/// function `q'Kq/2 - q'(delta - reference)` over the discs `|q| <= b`, at a prescribed force over those of them
/// that have this sum; delta is then its multiplier. The square of the error of q in the norm of K is at most the
/// duality gap `sum(b |w| - q . w)`: the function at q exceeds its minimum by half the square at least, and by the
/// gap less half the square at most.
///
/// Each step linearises the conditions for the cells that stick and slip by `y = q + rho w`: `w = 0` where
/// `|y| <= b`; elsewhere `q = b y/|y| + tau t` with the tangent t and `(K tau)_t + tau |w|/b = w_t`, which is
/// symmetric and positive definite. Conjugate gradients solve it roughly; the result is projected onto the
/// admissible tractions, and the energy is minimised on the way there, along which it is a parabola: no step
/// raises it. Where these steps make no progress, projected gradients with the same line search take over,
/// which converge from any start; Newton's steps go on from there.
///
/// # Errors
/// [`Interrupted`] by the stop before the first tractions are known.
///
/// Cost: some 5 to 10 steps, of 2 applications and those of a handful of conjugate gradients each.
/// Source: the conditions are those of Kalker's variational principle (J. J. Kalker, Three-Dimensional Elastic
/// Bodies in Rolling Contact, 1990, chapter 4), the linearisation is that of P. Alart and A. Curnier, Comput.
/// Methods Appl. Mech. Eng. 92, 353 (1991), made symmetric by the bound that does not depend on the slip.
pub fn solve(
    systems: FrictionSystems<'_>,
    increment: Increment<'_>,
    start: Vec<f64>,
    limits: FrictionLimits,
    stop: Stop<'_>,
) -> Result<IncrementState, Interrupted> {
    if largest(increment.limit) <= 0.0 {
        return Ok(free(increment));
    }
    from_mean(increment, |increment| {
        in_units(increment, start, |increment, start| {
            IncrementSolver::new(systems, increment, start, limits).iterate(stop)
        })
    })
}

/// Solves with displacements and references that are counted from the mean reference, weighted by the limits.
/// Only their difference is in the conditions, and after long slip both are much larger than it.
fn from_mean(
    increment: Increment<'_>,
    solve: impl FnOnce(Increment<'_>) -> Result<IncrementState, Interrupted>,
) -> Result<IncrementState, Interrupted> {
    let Increment { limit, reference, control, displacement, .. } = increment;
    let (n, most) = (limit.len(), sum(limit));
    let mean: [f64; 2] = std::array::from_fn(|component| dot(limit, &reference[component * n..][..n]) / most);
    if !(mean[0].is_finite() && mean[1].is_finite()) || length(mean) <= 0.0 {
        return solve(increment);
    }
    let from = |[x, y]: [f64; 2]| [x - mean[0], y - mean[1]];
    let mut less = reference.to_vec();
    for (less, mean) in less.chunks_exact_mut(n).zip(mean) {
        each(less, |r| *r -= mean);
    }
    let displacement = from(displacement);
    match control {
        TangentialControl::Displacement(delta) => {
            let control = TangentialControl::Displacement(from(delta));
            let found = solve(Increment { reference: &less, control, displacement, ..increment })?;
            Ok(IncrementState { displacement: delta, ..found })
        }
        TangentialControl::Force(_) => {
            let found = solve(Increment { reference: &less, displacement, ..increment })?;
            let [x, y] = found.displacement;
            Ok(IncrementState { displacement: [x + mean[0], y + mean[1]], ..found })
        }
    }
}

/// Solves in units of about the largest limit, a power of two.
fn in_units(
    increment: Increment<'_>,
    mut start: Vec<f64>,
    solve: impl FnOnce(Increment<'_>, Vec<f64>) -> Result<IncrementState, Interrupted>,
) -> Result<IncrementState, Interrupted> {
    let Increment { limit, reference, control, displacement, .. } = increment;
    let [dx, dy] = match control {
        TangentialControl::Displacement(displacement) => displacement,
        TangentialControl::Force(_) => displacement,
    };
    let unit = binary_unit(limit).max(SMALLEST_UNIT * largest(reference).max(dx.abs()).max(dy.abs()));
    let unit = binary_unit(&[unit]);
    let less = |v: &[f64]| v.iter().map(|v| v / unit).collect::<Vec<f64>>();
    let pair = |[x, y]: [f64; 2]| [x / unit, y / unit];
    let (limit, reference) = (less(limit), less(reference));
    let control = match control {
        TangentialControl::Displacement(displacement) => TangentialControl::Displacement(pair(displacement)),
        TangentialControl::Force(force) => TangentialControl::Force(pair(force)),
    };
    each(&mut start, |q| *q /= unit);
    let displacement = pair(displacement);
    let scaled = Increment { limit: &limit, reference: &reference, control, displacement, ..increment };
    let mut found = solve(scaled, start)?;
    for vector in [&mut found.traction, &mut found.slip] {
        each(vector, |v| *v *= unit);
    }
    found.displacement = found.displacement.map(|delta| delta * unit);
    found.length *= unit;
    Ok(found)
}

/// The same by projected gradients alone, in at most the given number of steps.
#[cfg(test)]
pub fn by_gradients(
    systems: FrictionSystems<'_>,
    increment: Increment<'_>,
    start: Vec<f64>,
    limits: FrictionLimits,
    steps: usize,
) -> Result<IncrementState, Interrupted> {
    in_units(increment, start, |increment, start| {
        let mut solver = IncrementSolver::new(systems, increment, start, limits);
        solver.admit();
        solver.displace(&contact_model::never)?;
        solver.descend(steps, &contact_model::never)?;
        Ok(solver.state(Status::IterationLimit))
    })
}

/// The step rho of `y = q + rho w`, which decides between stick and slip.
pub fn step(operators: &TangentialOperators) -> f64 {
    STEP / operators.table().own()
}

/// The cells that stick: those for which `y = q + rho w` is within the limit.
pub fn sticking(cells: &CellSet, (q, w): (&[f64], &[f64]), limit: &[f64], rho: f64) -> CellSet {
    let n = limit.len();
    let sticks: Vec<bool> = (limit.iter().enumerate())
        .map(|(i, b)| length([q[i] + rho * w[i], q[n + i] + rho * w[n + i]]) <= *b)
        .collect();
    cells.filter(&sticks, |sticks| sticks)
}

/// The state without resistance: there is no traction, and all displacement is slip.
fn free(increment: Increment<'_>) -> IncrementState {
    let displacement = match increment.control {
        TangentialControl::Displacement(delta) => delta,
        TangentialControl::Force(_) => increment.displacement,
    };
    let n = increment.limit.len();
    let slip = (increment.reference.iter().enumerate())
        .map(|(i, reference)| displacement[usize::from(i >= n)] - reference)
        .collect();
    IncrementState {
        traction: vec![0.0; 2 * n],
        slip,
        displacement,
        duality_gap: 0.0,
        length: 0.0,
        load_error: 0.0,
        stick: CellSet::default(),
        iterations: 0,
        steps: 0,
        status: Status::Converged,
    }
}

impl<'a> IncrementSolver<'a> {
    /// From tractions that need not be admissible.
    fn new(
        systems: FrictionSystems<'a>,
        increment: Increment<'a>,
        start: Vec<f64>,
        limits: FrictionLimits,
    ) -> Self {
        let FrictionSystems { operators, room } = systems;
        let most = sum(increment.limit);
        let control = match increment.control {
            TangentialControl::Force([x, y]) => {
                let share = x.hypot(y) / most;
                let less = if share > LARGEST_SHARE { LARGEST_SHARE / share } else { 1.0 };
                TangentialControl::Force([x * less, y * less])
            }
            displacement @ TangentialControl::Displacement(_) => displacement,
        };
        Self {
            rho: step(operators),
            operators,
            room,
            increment: Increment { control, ..increment },
            limits,
            most,
            reach: largest_length(increment.reference),
            q: start,
            u: Vec::new(),
            w: Vec::new(),
            delta: increment.displacement,
            gap: f64::INFINITY,
            reduction: REDUCTION,
            whole: false,
            iterations: 0,
            steps: 0,
        }
    }

    fn iterate(mut self, stop: Stop<'_>) -> Result<IncrementState, Interrupted> {
        self.admit();
        self.displace(stop)?;
        self.room.take(self.increment.cells);
        self.room.weights = None;
        let mut best = self.state(Status::IterationLimit);
        let (mut since_best, mut gradients) = (0, GRADIENTS);
        let status = loop {
            if self.gap < BETTER * best.duality_gap || self.gap <= self.limits.tolerance {
                since_best = 0;
            } else {
                since_best += 1;
            }
            if self.gap <= best.duality_gap {
                best = self.state(Status::IterationLimit);
            }
            stop.residual(self.gap, self.limits.tolerance);
            if self.gap <= self.limits.tolerance {
                break Status::Converged;
            } else if stop.stops() {
                break Status::Stopped;
            } else if self.iterations >= self.limits.iterations {
                break Status::IterationLimit;
            }
            self.iterations += 1;
            let before = self.gap;
            let moved = if since_best <= PATIENCE { self.newton(stop) } else { Ok(false) };
            let Ok(moved) = moved else { break Status::Stopped };
            if moved {
                if self.whole && self.gap > SLOW * before {
                    self.reduction = (FURTHER * self.reduction).max(LEAST_REDUCTION);
                }
            } else {
                if gradients > 1 << 12 {
                    break Status::Stagnated;
                }
                if self.descend(gradients, stop).is_err() {
                    break Status::Stopped;
                }
                (gradients, since_best) = (2 * gradients, 0);
            }
        };
        Ok(IncrementState { status, iterations: self.iterations, steps: self.steps, ..best })
    }

    fn force(&self) -> Option<[f64; 2]> {
        match self.increment.control {
            TangentialControl::Force(force) => Some(force),
            TangentialControl::Displacement(_) => None,
        }
    }

    fn law(&self) -> Discs<'a> {
        Discs { limit: self.increment.limit }
    }

    /// Moves the tractions to admissible ones.
    fn admit(&mut self) {
        let (law, force) = (self.law(), self.force());
        law.project(&mut self.q, force);
    }

    /// Evaluates the displacements of the present tractions.
    fn displace(&mut self, stop: Stop<'_>) -> Result<(), Interrupted> {
        self.u = self.exact(&self.q.clone(), stop)?;
        self.slide();
        Ok(())
    }

    /// `K q` without the constant of a periodic kernel.
    fn exact(&mut self, q: &[f64], stop: Stop<'_>) -> Result<Vec<f64>, Interrupted> {
        let mut u = Vec::new();
        exact(self.operators, (self.increment.cells, q), self.increment.cells, &mut u, stop)?;
        Ok(u)
    }

    /// The slip under the present displacements, and the duality gap.
    fn slide(&mut self) {
        let law = self.law();
        let Self { increment, q, u, w, delta, rho, .. } = self;
        let n = increment.limit.len();
        w.clone_from(u);
        update(w, increment.reference, |w, reference| *w = -*w - reference);
        *delta = match increment.control {
            TangentialControl::Displacement(delta) => delta,
            TangentialControl::Force(force) => {
                let mut y = w.clone();
                update(&mut y, q, |y, q| *y = q + *rho * *y);
                let start = delta.map(|delta| *rho * delta);
                law.multiplier(&y, force, start).map(|shift| shift / *rho)
            }
        };
        for (w, delta) in w.chunks_exact_mut(n).zip(*delta) {
            each(w, |w| *w += delta);
        }
        let [gap] = sums((q, w), increment.limit, |q, w, b| [excess(q, w, b)]);
        // Where nothing is displaced, as under uniform tractions with periodic boundaries, displacements are rounding.
        let table = self.operators.table();
        let displaced = table.own() + table.shift() * length(total(q));
        let gap = if gap > ROUNDING * self.most * displaced { gap } else { 0.0 };
        let scale = self.most * self.length();
        self.gap = if scale > 0.0 { gap / scale } else { 0.0 };
    }

    /// The length with which slips are compared.
    fn length(&self) -> f64 {
        self.reach.max(length(self.delta))
    }

    fn state(&self, status: Status) -> IncrementState {
        let Self { increment, q, w, delta, rho, .. } = self;
        let load_error = self.force().map_or(0.0, |[fx, fy]| {
            let [x, y] = total(q);
            length([x - fx, y - fy]) / self.most
        });
        let mut traction = q.clone();
        self.law().project(&mut traction, None);
        IncrementState {
            traction,
            slip: w.clone(),
            displacement: *delta,
            duality_gap: self.gap,
            length: self.length(),
            load_error,
            stick: sticking(increment.cells, (q, w), increment.limit, *rho),
            iterations: self.iterations,
            steps: self.steps,
            status,
        }
    }

    /// One step of Newton's method. Returns whether it made progress.
    fn newton(&mut self, stop: Stop<'_>) -> Result<bool, Interrupted> {
        let (branch, on_circles) = self.branch();
        let Some(next) = self.solve_linearised(&branch, on_circles, stop)? else { return Ok(false) };
        self.go_to(next, stop)
    }

    /// The cells that stick and slip at present, and the tractions with those of slip cells on their circles.
    fn branch(&self) -> (SlipBranch, Vec<f64>) {
        let Increment { cells, limit, .. } = self.increment;
        let n = limit.len();
        let y: Vec<f64> = self.q.iter().zip(&self.w).map(|(q, w)| q + self.rho * w).collect();
        let branch = SlipBranch::of(cells, &y, &self.w, limit);
        let mut next = self.q.clone();
        for (i, &b) in limit.iter().enumerate().filter(|(i, _)| branch.slips(*i)) {
            let length = length([y[i], y[n + i]]);
            (next[i], next[n + i]) = (y[i] * b / length, y[n + i] * b / length);
        }
        (branch, next)
    }

    /// The tractions that meet the linearised conditions of a branch, from `next`, whose slip cells are on their
    /// circles. `None` without cells.
    fn solve_linearised(
        &mut self,
        branch: &SlipBranch,
        mut next: Vec<f64>,
        stop: Stop<'_>,
    ) -> Result<Option<Vec<f64>>, Interrupted> {
        let (cells, force) = (self.increment.cells, self.force());
        let shift = self.operators.table().shift();
        let criteria =
            StoppingCriteria { reduction: self.reduction, energy: None, floor: 0.0, steps: INNER_STEPS };
        self.operators.solves += 1;
        let Some(mut system) = self.room.system(self.operators, branch, false, stop)? else {
            return Ok(None);
        };
        let spread = spread_force(&mut system, cells, force, &next, stop)?;
        // The change of the tractions so far, whose displacements the residual needs.
        let mut change: Vec<f32> = next.iter().zip(&self.q).map(|(next, q)| (next - q) as f32).collect();
        change.iter_mut().zip(&spread).for_each(|(change, spread)| *change += spread);
        let (displaced, applications) = displacement(&mut system.conditions, cells, &change, shift, stop)?;
        let mut right: Vec<f64> = self.w.iter().zip(&displaced).map(|(w, u)| w - f64::from(*u)).collect();
        branch.restrict_f64(&mut right);
        let moved: Vec<f64> = spread.iter().map(|&spread| f64::from(spread)).collect();
        branch.add_turning(&moved, &mut right, -1.0);
        let outcome = system.solve(&mut right, criteria, stop)?;
        self.steps += outcome.steps;
        self.operators.applications += applications + outcome.applications;
        for ((next, x), spread) in next.iter_mut().zip(&right).zip(&moved) {
            *next += x + spread;
        }
        Ok(Some(next))
    }

    /// Projects tractions onto the admissible ones and moves there, or as far as the energy falls. Returns
    /// whether that made progress.
    fn go_to(&mut self, mut next: Vec<f64>, stop: Stop<'_>) -> Result<bool, Interrupted> {
        self.law().project(&mut next, self.force());
        let u = self.exact(&next, stop)?;
        let (mut slope, mut curvature, mut rounding) = (0.0, 0.0, 0.0);
        for ((((q, next), w), from), to) in self.q.iter().zip(&next).zip(&self.w).zip(&self.u).zip(&u) {
            let d = next - q;
            slope += d * w;
            rounding += ROUNDING * (q * w).abs();
            curvature += d * (to - from);
        }
        // A change of the energy below its rounding tells nothing.
        let slope = slope + rounding;
        let share = if curvature > 0.0 { slope / curvature } else { f64::from(u8::from(slope > 0.0)) };
        if share.is_nan() || share < USELESS {
            return Ok(false);
        }
        self.whole = share >= WHOLE;
        if self.whole {
            (self.q, self.u) = (next, u);
        } else {
            for (from, to) in [(&mut self.q, &next), (&mut self.u, &u)] {
                from.iter_mut().zip(to).for_each(|(from, to)| *from += share * (to - *from));
            }
        }
        self.slide();
        Ok(true)
    }

    /// Steps of the fall-back, each of which lowers the energy.
    fn descend(&mut self, steps: usize, stop: Stop<'_>) -> Result<(), Interrupted> {
        let (law, force) = (self.law(), self.force());
        let Self { operators, increment, q, w, .. } = self;
        let cells = increment.cells;
        let mut gradient: Vec<f64> = w.iter().map(|w| -w).collect();
        let own = operators.table().own();
        let descent = Descent { law: &law, force, tractions: q, gradient: &mut gradient, own };
        let displace = |change: &[f64], u: &mut Vec<f64>| exact(operators, (cells, change), cells, u, stop);
        self.steps += descend(descent, displace, steps, stop)?;
        self.admit();
        self.displace(stop)
    }
}

/// The change of tractions that brings their sum to a prescribed force, by the weights of a preconditioner, which
/// keeps the sum from then on; zero where no force is prescribed.
fn spread_force(
    system: &mut BranchSystem<'_>,
    cells: &CellSet,
    force: Option<[f64; 2]>,
    tractions: &[f64],
    stop: Stop<'_>,
) -> Result<Vec<f32>, Interrupted> {
    let mut spread = vec![0.0; tractions.len()];
    if let Some([fx, fy]) = force {
        let BranchSystem { preconditioner, weights, .. } = system;
        preconditioner.fix_sums(cells, weights, stop)?;
        let [x, y] = total(tractions);
        if let Some(sums) = &preconditioner.sums {
            sums.spread([fx - x, fy - y], &mut spread);
        }
    }
    Ok(spread)
}

/// The displacement under a change of the tractions in single precision, without the constant of a periodic
/// kernel, and the number of applications.
fn displacement(
    linearised: &mut LinearisedFriction<'_>,
    cells: &CellSet,
    change: &[f32],
    shift: f64,
    stop: Stop<'_>,
) -> Result<(Vec<f32>, usize), Interrupted> {
    let mut displaced = vec![0.0; change.len()];
    if change.iter().all(|change| *change == 0.0) {
        return Ok((displaced, 0));
    }
    linearised.kernel.apply_until(cells, change, cells, &mut displaced, stop)?;
    let n = cells.len();
    for (displaced, change) in displaced.chunks_exact_mut(n).zip(change.chunks_exact(n)) {
        let mean = shift * sum(change);
        for u in displaced.iter_mut() {
            *u -= mean as f32;
        }
    }
    Ok((displaced, 1))
}

/// `u = K q` in double precision, without the constant of a periodic kernel.
///
/// # Errors
/// [`Interrupted`] by the stop; `u` is then undefined.
pub fn exact(
    operators: &mut TangentialOperators,
    (sources, q): (&CellSet, &[f64]),
    targets: &CellSet,
    u: &mut Vec<f64>,
    stop: Stop<'_>,
) -> Result<(), Interrupted> {
    operators.exact(sources, q, targets, u, stop)?;
    let shift = operators.table().shift();
    if shift > 0.0 && !targets.is_empty() {
        for (u, sum) in u.chunks_exact_mut(targets.len()).zip(total(q)) {
            for u in u.iter_mut() {
                *u -= shift * sum;
            }
        }
    }
    Ok(())
}

/// Largest length of the vectors of a field.
fn largest_length(v: &[f64]) -> f64 {
    let (x, y) = v.split_at(v.len() / 2);
    x.iter().zip(y).fold(0.0, |longest: f64, (x, y)| longest.max(length([*x, *y])))
}
