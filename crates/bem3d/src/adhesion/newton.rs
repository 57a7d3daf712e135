//! A Newton step for contact pressure and attraction together, and the conditions under which it stays on the
//! branch.
//!
//! # The system
//!
//! With the contact C kept closed and the law linearised on the open cells Z, slopes D and the couplings of
//! neighbours C', the change x of the net pressure satisfies `G x = -g` on C and `G x - (D + C')^-1 (x + m) =
//! 0` on Z, m the mismatch of attraction and law. With `N = 1 + D^(-1/2) C' D^(-1/2)` and `x_Z = D^(1/2) N v`
//! it is symmetric, and indefinite with as many negative eigenvalues as open cells where the state is stable:
//!
//! ```text
//! [ G_CC             G_CZ D^(1/2) N             ] [x_C]
//! [ N D^(1/2) G_ZC   N D^(1/2) G_ZZ D^(1/2) N - N ] [ v ]
//! ```
//!
//! Minimal residuals need one product by G a step. The block of Z is far from its Schur complement `-N + ...`
//! with G^ for G: pressures on a front displace the contact and all other fronts, and the contact takes that
//! back. So the preconditioner is
//!
//! ```text
//! [ 1  -E' D^(1/2) ] [ T     ] [      1         ]
//! [ 0      1       ] [    d  ] [ -D^(1/2) E   1 ]
//! ```
//!
//! with the inverse T of the kernel on a torus for G_CC^-1, a diagonal d, and a rough E for `G_ZC G_CC^-1`
//! ([`super::near`]) that costs two sums over nearby cells: 15 steps instead of 25 where a residual is to fall
//! by two digits.
//!
//! Near contact the law of a short range is level. With D -> 0 the matrix of both terms, `D + C'`, is
//! indefinite there and N large; a state that is far from instability (r = 0.6) then takes 100 steps instead
//! of 25. Cells with a slope below [`LEVEL`] are therefore left out: their attraction is that of the plain
//! iteration. A step then leaves 0.01 to 0.06 of the mismatch.
//!
//! # Which steps stay on the branch
//!
//! Let `T(s) = s(g(s))` be the map of the plain iteration: g(s) the gap of the elastic contact under the
//! attraction s. T is monotone; from s with `T(s) >= s` the plain iteration rises to the least equilibrium s*
//! above s. A trial t with `T(t) >= t` may lie beyond an unstable equilibrium above s*. It does not where
//! `T(r) > r` holds on the whole segment from s to t in every component that changes: at the first r that
//! touched s* in a component, that component of T(r) would be larger than that of `T(s*) = s*`, although `r
//! <= s*`.
//!
//! The exponential law is convex in the gap; the gap of the contact is convex in s, because it is the least
//! one of all that obey the inequalities of an M-matrix. So T is a convex function, the law, of a concave
//! one, the negative gap:
//!
//! - rising: the law linearised at g(s), after the gap of the true contact, lies below T and is concave. A
//!   solution t >= T(s) of that problem, in which cells that close join the contact, has `T(r) >= r` on the
//!   segment.
//! - falling: the law itself, after the gap of the contact kept closed, lies above T and is convex. The
//!   segment to t with `T(r) <= r` is found by halving: close to s there always is one.
//!
//! The law of a short range is convex for gaps beyond 0.54 of its range only: it is level in contact, so that
//! fronts are not trapped. There the same signs are required. That steps stay on the branch is then observed,
//! not proven: of 6420 states on small grids none differs from that of the plain iteration
//! (`newton_steps_leave_the_branch_in_none_of_thousands_of_states`).
//!
//! Steps whose changes have the other sign are not taken. It is not checked that in a rising step no cell
//! closes from beyond the range and none opens, which is unlikely for small changes; a contact cell whose
//! pressure would be negative opens. The linear system and the contact are solved only to a share of their
//! residuals: signs hold up to [`SLACK`] of the present mismatch. Within [`NEAR`] of an equilibrium, where
//! rounding and the contact decide the signs, a short step of either sign is taken. Stability is measured at
//! the end in any case.

use super::attraction::Attraction;
use super::equilibrium::Equilibrium;
use super::law::LawShape;
use super::near::Near;
use super::pairs::Pairs;
use crate::active_set::Problem;
use crate::geometry::CellSet;
use crate::linear::{Extension, Fixed, Preconditioner, TorusInverse, minres};
use crate::operator::{Conditioning, FftConvolution, InfluenceOperator, PlannedPressure};
use crate::parts::Recorder;
use crate::real::{dot, each, largest, sum, update};
use contact_model::Stop;

// Half and twice the value of each constant below change the work by less than 1 % (34 paths of rough maps and of
// spheres with 65 cells a side, at a tolerance of 1e-5).

/// Slopes below this share of the peak over the range are left out of a step ...
const FLAT: f64 = 1e-3;
/// ... and of a short range, whose law is level in contact, those below this: cells that have just opened
/// hardly change their attraction, and a system with them is far worse conditioned than the state.
const LEVEL: f64 = 0.05;
/// Steps begin when no attraction changes by more than this in an update, over the peak: before, fronts move
/// by whole cells.
pub const BEGIN: f64 = 0.02;
/// Signs of changes hold up to this share of the largest one.
const SLACK: f64 = 0.1;
/// With changes below this, over the peak, steps of either sign are taken ...
const NEAR: f64 = 1e-2;
/// ... that move no attraction by more than this.
const SHORT: f64 = 0.1;
/// No step moves an attraction by more than this, over the peak.
const LONGEST: f64 = 1.0;
/// Solutions of the linear system on a growing contact, at most.
const ROUNDS: usize = 2;
/// Steps of minimal residuals at most.
const STEPS: usize = 100;
/// The diagonal part of the block of Z is at least this share of N.
const LEAST: f64 = 0.1;

/// The state that the plain iteration would reach in one update.
pub struct Predicted<'a> {
    /// Contact pressure, brought to the force.
    pub pressure: &'a [f64],
    /// Attraction.
    pub attraction: &'a [f64],
    /// The gap that follows from both.
    pub gap: &'a [f64],
    /// Cells of the contact set, 1, and others, 0.
    pub contact: &'a [f64],
    /// Gaps below this are those of the contact before it is corrected.
    pub noise: f64,
}

/// A state that a step leads to.
pub struct Trial {
    /// Contact pressure.
    pub pressure: Vec<f64>,
    /// Attraction.
    pub attraction: Vec<f64>,
}

/// The linear system of a state.
struct Linear {
    /// Cells that stay closed.
    contact: CellSet,
    /// They and the open cells whose attraction moves with their gaps.
    both: CellSet,
    /// On both: roots of the slopes, 1 on contact.
    root: Vec<f32>,
    /// On both: 1 on open cells, 0 on contact.
    is_open: Vec<f32>,
}

/// The solution of the system, on both sets of cells.
struct NewtonSolution {
    /// Change of the net pressure.
    change: Vec<f64>,
    /// Gap of open cells, beyond the one at which the law is linearised.
    opening: Vec<f64>,
    steps: usize,
}

/// A Newton step that is asked for.
pub struct WantedStep<'a> {
    /// Where it begins.
    pub state: &'a Equilibrium,
    /// Where the plain iteration would go.
    pub predicted: &'a Predicted<'a>,
    /// What is fixed.
    pub fixed: Fixed,
    /// The factor by which the residual of the linear system is reduced.
    pub reduction: f64,
    /// When to stop.
    pub stop: Stop<'a>,
}

/// In which direction the attractions of a step may change, and how far.
#[derive(Clone, Copy)]
struct Course {
    /// 1 for a rising step, -1 for a falling one; `None`: a short step of either sign.
    sign: Option<f64>,
    /// Changes of the other sign up to this are none.
    slack: f64,
    /// The largest change.
    farthest: f64,
}

impl Course {
    /// From the changes of the plain iteration; `None` where they have both signs and are not small.
    fn of(wanted: &WantedStep<'_>, peak: f64) -> Option<Self> {
        let moved = wanted.predicted.attraction.iter().zip(&wanted.state.attraction);
        let (low, high) = extremes(moved.map(|(next, now)| next - now));
        let change = high.max(-low);
        let slack = SLACK * change;
        let sign = if low >= -slack {
            Some(1.0)
        } else if high <= slack {
            Some(-1.0)
        } else if change <= NEAR * peak {
            None
        } else {
            return None;
        };
        Some(Self { sign, slack, farthest: peak * if sign.is_some() { LONGEST } else { SHORT } })
    }

    /// Whether changes between these, in a system that was solved to `reduction`, keep to it.
    fn allows(&self, (low, high): (f64, f64), reduction: f64) -> bool {
        let allowed = self.slack + reduction * high.max(-low);
        let wrong = self.sign.map_or(0.0, |sign| if sign > 0.0 { -low } else { high });
        wrong <= allowed && high.max(-low) <= self.farthest
    }

    fn falls(&self) -> bool {
        self.sign.is_some_and(|sign| sign < 0.0)
    }
}

/// The lowest and the highest of some changes and of 0.
fn extremes(changes: impl Iterator<Item = f64>) -> (f64, f64) {
    changes.fold((0.0f64, 0.0f64), |(low, high), change| (low.min(change), high.max(change)))
}

/// A Newton step, `None` where it may lead off the branch, and the number of steps of minimal residuals that it
/// took.
///
/// Cost: a product by G and two means over neighbours a step.
pub fn step(
    problem: &mut Problem,
    attraction: &Attraction,
    wanted: &WantedStep<'_>,
) -> (Option<Trial>, usize) {
    let WantedStep { state, predicted, reduction, stop, .. } = *wanted;
    let (peak, range) = (attraction.law.peak, attraction.law.range);
    let Some(course) = Course::of(wanted, peak) else { return (None, 0) };
    let closes = -predicted.noise.max(course.slack / peak * range);
    let mut contact = predicted.contact.to_vec();
    let mut steps = 0;
    for _ in 0..ROUNDS {
        if stop.stops() {
            break;
        }
        let linear = Linear::new(attraction, state, &contact);
        let left = linear.left(wanted, &contact);
        let Some(solution) = linear.solve(problem, attraction, wanted, &left) else { break };
        steps += solution.steps;
        let change = state.cells.carry(&linear.both, &solution.change);
        let opening = state.cells.carry(&linear.both, &solution.opening);
        let open = || (0..change.len()).filter(|&i| contact[i] <= 0.0);
        // Beyond the plain update.
        if stop.stops() || !course.allows(extremes(open().map(|i| -change[i])), reduction) {
            break;
        }
        let closing: Vec<usize> = open().filter(|&i| state.gap[i] + opening[i] < closes).collect();
        if !closing.is_empty() && !course.falls() {
            for i in closing {
                contact[i] = 1.0;
            }
            continue;
        }
        let step = Taken { state, predicted, contact: &contact, change: &change, opening: &opening };
        let trial = if course.falls() {
            step.falling(attraction, course.slack)
        } else {
            Some(step.trial(attraction, 1.0).0)
        };
        return (trial, steps);
    }
    (None, steps)
}

/// A step as it is taken.
struct Taken<'a> {
    state: &'a Equilibrium,
    predicted: &'a Predicted<'a>,
    contact: &'a [f64],
    change: &'a [f64],
    opening: &'a [f64],
}

impl Taken<'_> {
    /// The longest step that falls everywhere, as a share of the whole one.
    fn falling(&self, attraction: &Attraction, slack: f64) -> Option<Trial> {
        [1.0, 0.5, 0.25].into_iter().find_map(|share| {
            let (trial, excess) = self.trial(attraction, share);
            (excess <= slack).then_some(trial)
        })
    }

    /// The state at a share of the step, and by how much the law at the gaps of the closed contact exceeds
    /// its attraction at most.
    fn trial(&self, attraction: &Attraction, share: f64) -> (Trial, f64) {
        let Self { state, predicted, contact, change, opening } = *self;
        let between = |from: f64, to: f64| from + share * (to - from);
        let gap: Vec<f64> = (state.gap.iter().zip(opening).zip(contact))
            .map(|((g, o), &c)| if c > 0.0 { 0.0 } else { (g + share * o).max(0.0) })
            .collect();
        let mut pull = attraction.tractions(&state.cells, &gap);
        let mut pressure = vec![0.0; gap.len()];
        let (mut excess, strongest) = (0.0f64, attraction.strongest());
        for i in 0..gap.len() {
            let to = predicted.pressure[i] - predicted.attraction[i] + change[i];
            let net = between(state.pressure[i] - state.attraction[i], to);
            if contact[i] > 0.0 {
                pressure[i] = (net + pull[i]).max(0.0);
            } else {
                let linear = between(state.attraction[i], -to).clamp(0.0, strongest);
                excess = excess.max(pull[i] - linear);
                pull[i] = linear;
            }
        }
        (Trial { pressure, attraction: pull }, excess)
    }
}

impl Linear {
    fn new(attraction: &Attraction, state: &Equilibrium, contact: &[f64]) -> Self {
        let mut slopes = attraction.slopes(&state.cells, &state.gap);
        let flat = if attraction.law.shape == LawShape::Smooth { LEVEL } else { FLAT };
        let least = flat * attraction.law.peak / attraction.law.range;
        slopes.iter_mut().zip(contact).filter(|(_, c)| **c > 0.0).for_each(|(s, _)| *s = 0.0);
        let open = state.cells.filter(&slopes, |s| s > least);
        let contact = state.cells.filter(contact, |c| c > 0.0);
        let both = contact.union(&open);
        let is_open = both.carry(&open, &vec![1.0; open.len()]);
        let mut root: Vec<f32> = both.carry(&state.cells, &slopes).iter().map(|s| s.sqrt() as f32).collect();
        root.iter_mut().zip(&is_open).filter(|(_, open)| **open <= 0.0).for_each(|(r, _)| *r = 1.0);
        Self { contact, both, root, is_open }
    }

    /// What is left of the conditions: the gap on contact, elsewhere how far the gap is from where the law is
    /// linearised.
    fn left(&self, wanted: &WantedStep<'_>, contact: &[f64]) -> Vec<f64> {
        let WantedStep { state, predicted, .. } = wanted;
        let left: Vec<f64> = (predicted.gap.iter().zip(&state.gap).zip(contact))
            .map(|((after, before), &c)| if c > 0.0 { *after } else { after - before })
            .collect();
        self.both.carry(&state.cells, &left)
    }

    /// Solves for the change of net pressure that closes `left` on contact, the gap there, and with which the
    /// attraction of open cells follows the linearised law; `left` is on them how far the gap is from where
    /// the law is linearised. `None` where nothing is left.
    fn solve(
        &self,
        problem: &mut Problem,
        attraction: &Attraction,
        wanted: &WantedStep<'_>,
        left: &[f64],
    ) -> Option<NewtonSolution> {
        let on = (problem.grid(), problem.operators.table().boundary());
        let (unit, operators) = (largest(left), &mut problem.operators);
        let recipe = operators.planner().system(&self.both, self.contact.len(), false)?;
        if unit.is_nan() || unit <= 0.0 {
            return None;
        }
        let pairs = self.coupling(attraction, wanted.state);
        let pairs = pairs.as_ref();
        let own = operators.table().own() as f32;
        let (decay, recorder) = (operators.tuning().decay, operators.recorder().clone());
        let (mut kernel, torus) = operators.system(recipe);
        let mut extension = Extension::default();
        if let (Conditioning::Torus { extended, .. }, Some(torus)) = (recipe.conditioning, &torus) {
            extension.set(&self.contact, torus.window(), if extended { decay } else { 0.0 });
        }
        let near = torus.as_ref().and_then(|_| Near::of(attraction, on, &self.both, &self.is_open));
        let beside = vec![0.0; self.both.len()];
        let diagonal = self.diagonal(own);
        let mut inverse = RoughInverse { linear: self, diagonal, near, torus, extension, recorder, beside };
        let kept = KeptForce::new(self, pairs, wanted.fixed, &mut inverse);
        let (mut applications, mut source, mut u) =
            (0, vec![0.0f32; self.both.len()], vec![0.0f32; self.both.len()]);
        let product = |y: &[f32], out: &mut [f32]| {
            applications += 1;
            self.product((&mut kernel, wanted.fixed, pairs), y, out, (&mut source, &mut u));
        };
        let precondition = |r: &mut [f32], z: &mut [f32]| kept.precondition(&mut inverse, r, z);
        let mut right: Vec<f32> = left.iter().map(|l| -(l / unit) as f32).collect();
        self.times_root(&mut right);
        let b = times_neighbours(pairs, &right);
        let (y, outcome) = minres(product, precondition, b, (wanted.reduction, STEPS), wanted.stop);
        operators.plans.applications += applications;
        operators.plans.solves += 1;
        Some(self.solution(pairs, &y, unit, outcome.steps))
    }

    /// How the attractions of open cells follow the gaps of others; nothing on contact.
    fn coupling(&self, attraction: &Attraction, state: &Equilibrium) -> Option<Pairs> {
        let Self { both, root, is_open, .. } = self;
        let zone_root: Vec<f64> = root.iter().zip(is_open).map(|(r, open)| f64::from(r * open)).collect();
        attraction.coupling(both, &both.carry(&state.cells, &state.gap), &zone_root)
    }

    fn times_root(&self, values: &mut [f32]) {
        update(values, &self.root, |value, root| *value *= root);
    }

    /// The diagonal d of the preconditioner.
    fn diagonal(&self, own: f32) -> Vec<f32> {
        let of = |(r, &open): (&f32, &f32)| {
            if open > 0.0 { (1.0 - r * r * own).max(LEAST as f32) } else { own }.recip()
        };
        self.root.iter().zip(&self.is_open).map(of).collect()
    }

    /// The product by the matrix of the system; `source` and `u` are room.
    fn product(
        &self,
        (kernel, fixed, pairs): (&mut PlannedPressure<'_>, Fixed, Option<&Pairs>),
        y: &[f32],
        out: &mut [f32],
        (source, u): (&mut [f32], &mut [f32]),
    ) {
        add_neighbours(pairs, y, source);
        let own: Vec<f32> = source.iter().zip(&self.is_open).map(|(s, open)| s * open).collect();
        self.times_root(source);
        kernel.apply(&self.both, source, &self.both, u);
        if let Fixed::MeanPlane(constant) = fixed {
            let offset = (constant * sum(source)) as f32;
            each(u, |u| *u -= offset);
        }
        self.times_root(u);
        add_neighbours(pairs, u, out);
        update(out, &own, |out, own| *out -= own);
    }

    /// From the unknowns of the system to net pressures and gaps.
    fn solution(&self, pairs: Option<&Pairs>, y: &[f32], unit: f64, steps: usize) -> NewtonSolution {
        let mut change = times_neighbours(pairs, y);
        self.times_root(&mut change);
        let opening = y.iter().zip(&self.root).zip(&self.is_open);
        NewtonSolution {
            change: change.into_iter().map(|c| unit * f64::from(c)).collect(),
            opening: opening.map(|((y, root), open)| unit * f64::from(y * open / root)).collect(),
            steps,
        }
    }
}

/// `N y`, which changes nothing on contact.
fn add_neighbours(pairs: Option<&Pairs>, y: &[f32], out: &mut [f32]) {
    out.copy_from_slice(y);
    if let Some(pairs) = pairs {
        pairs.add_product(1.0, y, out);
    }
}

fn times_neighbours(pairs: Option<&Pairs>, y: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; y.len()];
    add_neighbours(pairs, y, &mut out);
    out
}

/// The preconditioner of the system.
struct RoughInverse<'a> {
    linear: &'a Linear,
    diagonal: Vec<f32>,
    near: Option<Near>,
    torus: Option<&'a mut FftConvolution<f32>>,
    extension: Extension,
    recorder: Recorder,
    /// Room on both sets.
    beside: Vec<f32>,
}

impl RoughInverse<'_> {
    fn apply(&mut self, r: &[f32], z: &mut [f32]) {
        let Self { linear, diagonal, near, torus, extension, recorder, beside } = self;
        let Linear { contact, both, is_open, .. } = linear;
        z.copy_from_slice(r);
        if let Some(near) = near {
            near.extend(r, beside);
            linear.times_root(beside);
            update(z, beside, |z, beside| *z -= beside);
        }
        update(z, diagonal, |z, d| *z *= d);
        let Some(transform) = torus.as_deref_mut() else { return };
        update(z, is_open, |z, open| *z *= open);
        if let Some(near) = near {
            beside.copy_from_slice(z);
            linear.times_root(beside);
            near.subtract_transposed(beside, z);
        }
        let mut on_contact = contact.carry(both, r);
        let mut found = vec![0.0; contact.len()];
        let extensions = std::array::from_mut(extension);
        let mut inverse = TorusInverse { transform, extensions, recorder: recorder.clone() };
        inverse.apply(contact, 0.0, &mut on_contact, &mut found);
        both.add_carried(contact, &found, z);
    }
}

/// A fixed net force is the product with `force`; the correction of it is distributed by the weights.
struct KeptForce {
    force: Vec<f32>,
    weights: Vec<f32>,
    /// Their product; 0 where the force is free.
    total: f64,
}

impl KeptForce {
    fn new(linear: &Linear, pairs: Option<&Pairs>, fixed: Fixed, inverse: &mut RoughInverse<'_>) -> Self {
        let force = times_neighbours(pairs, &linear.root);
        let mut kept = Self { weights: vec![0.0; force.len()], force, total: 0.0 };
        if fixed == Fixed::Force {
            inverse.apply(&kept.force, &mut kept.weights);
            kept.total = dot(&kept.force, &kept.weights);
        }
        kept
    }

    fn precondition(&self, inverse: &mut RoughInverse<'_>, r: &mut [f32], z: &mut [f32]) {
        let Self { force, weights, total } = self;
        let less = |values: &mut [f32], share: f64, of: &[f32]| {
            let share = share as f32;
            update(values, of, |value, of| *value -= share * of);
        };
        if *total > 0.0 {
            less(r, dot(weights, r) / total, force);
        }
        inverse.apply(r, z);
        if *total > 0.0 {
            less(z, dot(force, z) / total, weights);
        }
    }
}
