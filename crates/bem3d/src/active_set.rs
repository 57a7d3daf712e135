//! The complementarity problem at one load: predict the set, solve on it, drop what pulls, add what penetrates.

use crate::candidates::Candidates;
use crate::cells::CellSet;
use crate::certificate::{Evidence, measure};
use crate::cg::{self, Request};
use crate::operator::Operators;
use crate::operator::dense::Factor;
use crate::strategy;
use contact_model::{Status, Stop};

/// Residual reduction asked of conjugate gradients between two looks at the set.
const REDUCTION: f64 = 0.1;
/// Conjugate gradient steps at most between two looks at the set.
const STEPS: usize = 40;
/// Residual gap, as a share of the tolerance, below which conjugate gradients need not go.
const FLOOR: f64 = 0.2;
/// A certificate counts as better when it falls by this factor.
const BETTER: f64 = 0.9;
/// Rounds without a better certificate after which the arithmetic has given all it can.
const PATIENCE: usize = 12;
/// A cell is added when it penetrates by more than this multiple of the rms gap that the contact cells still have: below it,
/// the gap is only as good as the pressure that made it, and adding half of all candidates by chance undoes the elimination.
const NOISE: f64 = 1.0;
/// Candidates are looked for up to this multiple of the approach; a plane that ends higher costs one more round.
const REACH: f64 = 1.05;
/// Penetration that an exact (factored) solution leaves by rounding, relative to the approach.
const FACTOR_ROUNDING: f64 = 1e-12;

/// One surface in scaled units: z in units of the relief's scale, p so that `u = sum I p`.
#[derive(Debug)]
pub struct Problem {
    /// Where contact is possible.
    pub candidates: Candidates,
    /// The operators.
    pub operators: Operators,
    /// Cells a side.
    pub side: usize,
}

/// What is prescribed, in scaled units.
#[derive(Debug, Clone, Copy)]
pub enum Target {
    /// Sum of p.
    Force(f64),
    /// Approach.
    Approach(f64),
}

/// How accurate, how long.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Bound of the certificate.
    pub tolerance: f64,
    /// Length that gaps are compared with; `None`: the approach.
    pub height: Option<f64>,
    /// Rounds at most.
    pub rounds: usize,
    /// Small sets may be factored.
    pub dense: bool,
}

/// A pressure to begin with.
#[derive(Debug, Clone)]
pub struct Guess {
    /// Where it presses.
    pub set: CellSet,
    /// Positive pressure there.
    pub p: Vec<f64>,
    /// Approach that belongs to it, rather too large than too small.
    pub d: f64,
}

/// A solved state.
#[derive(Debug, Clone)]
pub struct Solved {
    /// The contact set: cells with p > 0.
    pub contact: CellSet,
    /// Pressure on it.
    pub p: Vec<f64>,
    /// Approach.
    pub d: f64,
    /// `K q = 1` on the contact set, where a factor gave it for nothing.
    pub q: Option<Vec<f64>>,
    /// The exact gap on all cells that could touch.
    pub look: Look,
    /// Conjugate gradient steps.
    pub steps: usize,
    /// How it ended.
    pub status: Status,
}

/// A look at the exact gap on the candidates.
#[derive(Debug, Clone)]
pub struct Look {
    /// The candidates.
    pub checked: CellSet,
    /// Pressure on them.
    pub p: Vec<f64>,
    /// Gap on them.
    pub gap: Vec<f64>,
    /// How well the conditions hold.
    pub evidence: Evidence,
    /// Whether every cell below the plane was among them.
    complete: bool,
}

/// A pressure on its way to a solution.
#[derive(Debug, Clone)]
struct Pressed {
    contact: CellSet,
    p: Vec<f64>,
    d: f64,
    /// Where the set was factored; then p and d are exact on it.
    q: Option<Vec<f64>>,
}

/// Solves for one load from a guess.
///
/// At fixed force, solving on a superset of the contact set and dropping the cells in tension never drops a true contact cell
/// where K restricted to the set is an inverse M-matrix, which it was on every set tried: bilateral contact on a superset needs a larger
/// approach than the true one, and every drop lowers it. Rounding and early stops can break this, so each round looks at the
/// exact gap on all candidates and adds what penetrates.
///
/// Cost: 30 to 80 applications of K for four digits, a few factorisations for a small set.
pub fn solve(problem: &mut Problem, target: Target, guess: Guess, limits: Limits, stop: Stop<'_>) -> Solved {
    let mut reach = match target {
        Target::Force(_) => guess.d,
        Target::Approach(asked) => asked,
    };
    let mut now = Pressed { contact: guess.set, p: guess.p, d: guess.d, q: None };
    let mut best: Option<(Pressed, Look)> = None;
    let (mut steps, mut round, mut since_best) = (0, 0, 0);
    loop {
        let look = look(problem, target, &mut now, reach, limits);
        let error = look.evidence.worst();
        let settled = now.q.is_none() || look.evidence.deepest <= FACTOR_ROUNDING * now.d;
        let status = if look.complete && settled && error <= limits.tolerance {
            Some(Status::Converged)
        } else if stop() {
            Some(Status::Stopped)
        } else if round >= limits.rounds {
            Some(Status::IterationLimit)
        } else if since_best > PATIENCE {
            Some(Status::Stagnated)
        } else {
            None
        };
        if let Some(status) = status {
            let (pressed, look) = match best {
                Some(best) if status != Status::Converged && best.1.evidence.worst() <= error => best,
                _ => (now, look),
            };
            let Pressed { contact, p, d, q } = pressed;
            return Solved { contact, p, d, q, look, steps, status };
        }
        // Just above the plane: a generous guess must not make every round look at the whole grid.
        reach = REACH * now.d;
        let better = look.complete && best.as_ref().is_none_or(|b| error < BETTER * b.1.evidence.worst());
        since_best = if better { 0 } else { since_best + 1 };
        let next = improve(problem, target, &look, &now, limits, &mut steps, stop);
        if next.q.is_some() {
            reach = REACH * next.d;
        }
        if better {
            best = Some((now, look));
        }
        now = next;
        round += 1;
    }
}

/// The exact gap under a pressure, and the approach that it makes at a prescribed force.
fn look(problem: &mut Problem, target: Target, now: &mut Pressed, reach: f64, limits: Limits) -> Look {
    if let Target::Force(force) = target {
        rescale(&mut now.p, force);
    }
    let checked = with(&problem.candidates.below(reach), &now.contact);
    let mut gap = problem.operators.exact(&now.contact, &now.p, &checked);
    for (g, z) in gap.iter_mut().zip(problem.candidates.gaps(&checked)) {
        *g += z;
    }
    let p = checked.carry(&now.contact, &now.p);
    match target {
        // The mean weighted by the pressure: the gap is then right where it carries.
        Target::Force(_) if now.q.is_none() => now.d = cg::dot(&p, &gap) / now.p.iter().sum::<f64>(),
        Target::Force(_) => {}
        Target::Approach(asked) => now.d = asked,
    }
    for g in &mut gap {
        *g -= now.d;
    }
    let evidence = measure(&p, &gap, limits.height.unwrap_or(now.d));
    Look { checked, p, gap, evidence, complete: now.d <= reach }
}

/// One round: a new set from the look, a solution on it (exact when it is small), and the cells in tension dropped.
fn improve(
    problem: &mut Problem,
    target: Target,
    look: &Look,
    now: &Pressed,
    limits: Limits,
    steps: &mut usize,
    stop: Stop<'_>,
) -> Pressed {
    let noise = NOISE * residual(&look.p, &look.gap);
    let set = look.checked.filter(|k| look.p[k] > 0.0 || look.gap[k] < -noise);
    if limits.dense
        && strategy::dense_is_cheaper(set.len(), set.free_lengths())
        && let Some(exact) = eliminate(problem, &set, target)
    {
        return exact;
    }
    let position = look.checked.positions(&set);
    let right: Vec<f64> = position.iter().map(|&k| -look.gap[k as usize]).collect();
    let request = Request {
        fixed_sum: matches!(target, Target::Force(_)),
        reduction: REDUCTION,
        floor: FLOOR * limits.tolerance * limits.height.unwrap_or(now.d),
        steps: STEPS,
        precondition: strategy::precondition(now.contact.len(), set.window_cells()),
    };
    let correction = cg::correct(&mut problem.operators, &set, &right, request, stop);
    *steps += correction.steps;
    let pressure: Vec<f64> =
        position.iter().zip(&correction.x).map(|(&k, x)| look.p[k as usize] + x).collect();
    let contact = set.filter(|k| pressure[k] > 0.0);
    let p = pressure.into_iter().filter(|&p| p > 0.0).collect();
    Pressed { contact, p, d: now.d, q: None }
}

/// Drops cells in tension from a small superset until none is left; p, q and d are exact up to rounding.
fn eliminate(problem: &Problem, superset: &CellSet, target: Target) -> Option<Pressed> {
    let mut set = superset.clone();
    loop {
        let z = problem.candidates.gaps(&set);
        let (q, w) = Factor::new(problem.operators.table(), &set)?.solve_pair(&z);
        let d = match target {
            Target::Force(force) => (force + w.iter().sum::<f64>()) / q.iter().sum::<f64>(),
            Target::Approach(d) => d,
        };
        let p: Vec<f64> = q.iter().zip(&w).map(|(q, w)| d * q - w).collect();
        let pressed = set.filter(|k| p[k] > 0.0);
        if pressed.len() == set.len() {
            return Some(Pressed { contact: set, p, d, q: Some(q) });
        }
        if pressed.is_empty() {
            return None;
        }
        set = pressed;
    }
}

/// Root mean square of the gap that is left on the contact cells.
fn residual(p: &[f64], gap: &[f64]) -> f64 {
    let (mut square, mut count) = (0.0, 0.0f64);
    for (&p, &g) in p.iter().zip(gap) {
        if p > 0.0 {
            square += g * g;
            count += 1.0;
        }
    }
    (square / count.max(1.0)).sqrt()
}

fn rescale(p: &mut [f64], force: f64) {
    let sum: f64 = p.iter().sum();
    if sum > 0.0 {
        let factor = force / sum;
        for p in p {
            *p *= factor;
        }
    }
}

/// The union of a set and a (mostly contained) second one.
pub fn with(set: &CellSet, other: &CellSet) -> CellSet {
    let (a, b) = (set.index(), other.index());
    let mut index = Vec::with_capacity(a.len().max(b.len()));
    let (mut i, mut j) = (0, 0);
    while i < a.len() || j < b.len() {
        let next = match (a.get(i), b.get(j)) {
            (Some(&x), Some(&y)) => x.min(y),
            (Some(&x), None) => x,
            (None, Some(&y)) => y,
            (None, None) => break,
        };
        i += usize::from(a.get(i) == Some(&next));
        j += usize::from(b.get(j) == Some(&next));
        index.push(next);
    }
    CellSet::new(set.side(), index)
}
