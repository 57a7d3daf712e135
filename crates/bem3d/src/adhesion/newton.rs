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
//! back. The preconditioner has the inverse of the kernel on a torus for G_CC^-1, and a diagonal on Z. Triangular
//! factors around both, with an estimate of `G_ZC G_CC^-1` from nearby cells, took 15 steps instead of 25 where a
//! residual was to fall by two digits. But 22 paths (9 with 129 cells a side, 9 with 257 and 4 with 513) need
//! only 1.00 to 1.13 times as many applications of the kernel without them, and their times, one run each, show no
//! gain. So they were removed.
//!
//! Near contact the law of a short range is level. With D -> 0 the matrix of both terms, `D + C'`, is
//! indefinite there and N large; a state that is far from instability (r = 0.6) then takes 100 steps instead
//! of 25. Cells with a slope below `LEVEL` are therefore left out: their attraction is that of the plain
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

mod system;

pub use system::{Predicted, WantedStep};

use super::attraction::Attraction;
use super::equilibrium::Equilibrium;
use crate::active_set::Problem;
use contact_model::Interrupted;
use system::Linear;

// Half and twice the value of each constant below change the work by less than 1 % (34 paths of rough maps and of
// spheres with 65 cells a side, at a tolerance of 1e-5).

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

/// A state that a step leads to.
pub struct Trial {
    /// Contact pressure.
    pub pressure: Vec<f64>,
    /// Attraction.
    pub attraction: Vec<f64>,
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
/// # Errors
/// [`Interrupted`] by the stop.
///
/// Cost: a product by G and two means over neighbours a step.
pub fn step(
    problem: &mut Problem,
    attraction: &Attraction,
    wanted: &WantedStep<'_>,
) -> Result<(Option<Trial>, usize), Interrupted> {
    let WantedStep { state, predicted, reduction, .. } = *wanted;
    let (peak, range) = (attraction.law.peak, attraction.law.range);
    let Some(course) = Course::of(wanted, peak) else { return Ok((None, 0)) };
    let closes = -predicted.noise.max(course.slack / peak * range);
    let mut contact = predicted.contact.to_vec();
    let mut steps = 0;
    for _ in 0..ROUNDS {
        let linear = Linear::new(attraction, state, &contact);
        let left = linear.left(wanted, &contact);
        let Some(solution) = linear.solve(problem, attraction, wanted, &left)? else { break };
        steps += solution.steps;
        let change = state.cells.carry(&linear.both, &solution.change);
        let opening = state.cells.carry(&linear.both, &solution.opening);
        let open = || (0..change.len()).filter(|&i| contact[i] <= 0.0);
        // Beyond the plain update.
        if !course.allows(extremes(open().map(|i| -change[i])), reduction) {
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
        return Ok((trial, steps));
    }
    Ok((None, steps))
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
