//! The complementarity problem at one load: predict the set, solve on it, drop what pulls, add what penetrates.

use crate::candidates::Candidates;
use crate::cells::CellSet;
use crate::certificate::{Evidence, measure};
use crate::cg::{self, Request};
use crate::filled::{Arrays, Filled};
use crate::operator::dense::Factor;
use crate::operator::{Operators, Table};
use crate::strategy;
use contact_model::{Boundary, Status, Stop};
use std::sync::Arc;

/// Reduction of the error asked of conjugate gradients between two looks at the set: half of what is still wanted, within this range. A
/// looser one restarts too often, a tighter one solves well on a set that will change.
const REDUCTION: (f64, f64) = (0.1, 0.3);
/// The same while the set still changes a lot (certificate above [`EARLY`]).
const EARLY_REDUCTION: f64 = 0.3;
const EARLY: f64 = 0.02;
/// Conjugate gradient steps at most between two looks at the set.
const STEPS: usize = 40;
/// Residual gap, as a share of the tolerance, below which conjugate gradients need not go.
const FLOOR: f64 = 0.2;
/// A certificate counts as better when it falls by this factor.
const BETTER: f64 = 0.9;
/// Rounds without a better certificate after which the arithmetic has given all it can.
const PATIENCE: usize = 12;
/// Above this certificate, and above so many times the tolerance, the next look is one in single precision: half the cost.
const ROUGH: f64 = 0.03;
const ROUGH_ROUNDS: f64 = 10.0;
/// ... as long as the gap that it measures stands out of the noise of single precision, this share of the approach.
const SINGLE_NOISE: f64 = 1e-4;
/// A cell is added when it penetrates by more than this multiple of the rms gap that the contact cells still have: below it,
/// the gap is only as good as the pressure that made it, and adding half of all candidates by chance undoes the elimination.
pub const NOISE: f64 = 1.0;
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
    /// Room for contact that fills the grid.
    pub arrays: Arrays,
    /// The same relief on cells twice as large, once a cold start has asked for it.
    pub coarser: Option<Box<Problem>>,
    /// Whether coarse grids may say where to begin.
    pub levels: bool,
}

impl Problem {
    /// A relief of `side^2` gaps from the plane of first touch.
    pub fn new(side: usize, z: Arc<Vec<f64>>, boundary: Boundary) -> Self {
        let operators = Operators::new(Table::shared(side, boundary));
        Self {
            candidates: Candidates::new(side, z),
            operators,
            side,
            arrays: Arrays::default(),
            coarser: None,
            levels: true,
        }
    }
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
    /// Whether it is known to be far off: then single precision is enough for the first look.
    pub far: bool,
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
    /// The candidates (at least those that press or penetrate).
    pub checked: CellSet,
    /// Pressure on them.
    pub p: Vec<f64>,
    /// Gap on them.
    pub gap: Vec<f64>,
    /// How well the conditions hold.
    pub evidence: Evidence,
}

impl Look {
    /// Cells outside the contact set that may belong to it: their gap is negative or below what it can still change.
    pub fn undecided(&self) -> CellSet {
        crate::margin::undecided(&self.checked, &self.p, &self.gap)
    }
}

/// What a look says about how to go on.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// How well the conditions hold.
    pub evidence: Evidence,
    /// Whether every cell below the plane was looked at, in double precision.
    pub complete: bool,
    /// Approach.
    pub d: f64,
    /// Whether p and d are exact on the set, up to rounding.
    pub factored: bool,
}

/// Where the iteration of [`solve`] runs: on lists of cells or on arrays over the grid.
pub trait Ground {
    /// Looks at the gap under the present pressure, and at a prescribed force finds the approach that it makes.
    ///
    /// A `rough` look in single precision says how to go on, but is never evidence.
    fn look(&mut self, rough: bool) -> Seen;
    /// One round: a new set from the look, a solution on it, and the cells in tension dropped.
    fn improve(&mut self, seen: Seen, steps: &mut usize, stop: Stop<'_>);
    /// Remembers the pressure of the last look as the best.
    fn keep(&mut self);
    /// The state of the last look, or the one kept where `best` says so.
    fn finish(self, status: Status, best: Option<Seen>, last: Seen, steps: usize) -> Solved;
}

/// Solves for one load from a guess.
///
/// At fixed force, solving on a superset of the contact set and dropping the cells in tension never drops a true contact cell
/// where K restricted to the set is an inverse M-matrix, which it was on every set tried: bilateral contact on a superset needs a larger
/// approach than the true one, and every drop lowers it. Rounding and early stops can break this, so each round looks at the
/// exact gap on all candidates and adds what penetrates.
///
/// Cost: 20 to 60 applications of K for four digits, a few factorisations for a small set.
pub fn solve(problem: &mut Problem, target: Target, guess: Guess, limits: Limits, stop: Stop<'_>) -> Solved {
    problem.arrays.left = None;
    let start = Start { known: None, rough: guess.far };
    if strategy::fills(&guess.set) {
        let Problem { candidates, operators, arrays, .. } = problem;
        let filled = Filled::new(candidates, operators, arrays, target, &guess, limits);
        drop(guess); // Copied; it is as large as the contact.
        return iterate(filled, start, limits, stop);
    }
    iterate(Listed::new(problem, target, guess, limits), start, limits, stop)
}

/// Goes on from the state that this problem solved last, to a tighter tolerance: what it has seen need not be looked at again.
pub fn resume(
    problem: &mut Problem,
    target: Target,
    solved: &Solved,
    limits: Limits,
    stop: Stop<'_>,
) -> Solved {
    let seen =
        Seen { evidence: solved.look.evidence, complete: true, d: solved.d, factored: solved.q.is_some() };
    let start = Start { known: Some(seen), rough: false };
    if let Some(left) = problem.arrays.left.take() {
        let Problem { candidates, operators, arrays, .. } = problem;
        let filled = Filled::resumed(candidates, operators, arrays, target, (solved, left), limits);
        return iterate(filled, start, limits, stop);
    }
    let Solved { contact, p, d, q, look, .. } = solved.clone();
    let mut ground = Listed::new(problem, target, Guess { set: contact, p, d, far: false }, limits);
    (ground.now.q, ground.look, ground.reach) = (q, look, REACH * d);
    iterate(ground, start, limits, stop)
}

/// How an iteration begins.
#[derive(Debug, Clone, Copy, Default)]
struct Start {
    /// A look at the first state, where there has been one.
    known: Option<Seen>,
    /// Whether the first look is rough.
    rough: bool,
}

fn iterate(mut ground: impl Ground, mut start: Start, limits: Limits, stop: Stop<'_>) -> Solved {
    let mut best: Option<Seen> = None;
    let (mut steps, mut round, mut since_best, mut rough) = (0, 0, 0, start.rough);
    loop {
        let seen = start.known.take().unwrap_or_else(|| ground.look(rough));
        let error = seen.evidence.worst();
        let settled = !seen.factored || seen.evidence.deepest <= FACTOR_ROUNDING * seen.d;
        let status = if seen.complete && settled && error <= limits.tolerance {
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
            let better = best.filter(|b| status != Status::Converged && b.evidence.worst() <= error);
            return ground.finish(status, better, seen, steps);
        }
        let length = error * limits.height.unwrap_or(seen.d);
        rough = error > ROUGH && error > ROUGH_ROUNDS * limits.tolerance && length > SINGLE_NOISE * seen.d;
        if seen.complete && best.is_none_or(|b| error < BETTER * b.evidence.worst()) {
            ground.keep();
            (best, since_best) = (Some(seen), 0);
        } else {
            since_best += usize::from(!rough);
        }
        ground.improve(seen, &mut steps, stop);
        round += 1;
    }
}

/// Number of cells that press or would penetrate under a guess, in single precision.
pub fn promised(problem: &mut Problem, guess: &Guess) -> usize {
    let checked = with(&problem.candidates.below(guess.d), &guess.set);
    let mut u = vec![0.0; checked.len()];
    problem.operators.fast(&guess.set, &guess.p, &checked, &mut u);
    let penetrating =
        u.iter().zip(problem.candidates.gaps(&checked)).filter(|&(u, z)| u + z < guess.d).count();
    penetrating.max(guess.set.len())
}

/// What conjugate gradients are asked for after a look.
pub fn request(target: Target, limits: Limits, seen: Seen) -> Request {
    let error = seen.evidence.worst();
    Request {
        fixed_sum: matches!(target, Target::Force(_)),
        reduction: if error > EARLY {
            EARLY_REDUCTION
        } else {
            (0.5 * limits.tolerance / error).clamp(REDUCTION.0, REDUCTION.1)
        },
        energy: None,
        floor: FLOOR * limits.tolerance * limits.height.unwrap_or(seen.d),
        steps: STEPS,
        precondition: true,
        exact: false,
    }
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

/// One load on lists of cells.
struct Listed<'a> {
    problem: &'a mut Problem,
    target: Target,
    limits: Limits,
    now: Pressed,
    /// The look at it.
    look: Look,
    best: Option<(Pressed, Look)>,
    /// Candidates are looked for up to here.
    reach: f64,
}

impl<'a> Listed<'a> {
    fn new(problem: &'a mut Problem, target: Target, guess: Guess, limits: Limits) -> Self {
        let reach = match target {
            Target::Force(_) => guess.d,
            Target::Approach(asked) => asked,
        };
        let now = Pressed { contact: guess.set, p: guess.p, d: guess.d, q: None };
        let checked = CellSet::new(problem.side, Vec::new());
        let look = Look { checked, p: Vec::new(), gap: Vec::new(), evidence: Evidence::default() };
        Self { problem, target, limits, now, look, best: None, reach }
    }
}

impl Ground for Listed<'_> {
    fn look(&mut self, rough: bool) -> Seen {
        let Self { problem, target, limits, now, reach, .. } = self;
        if let Target::Force(force) = *target {
            rescale(&mut now.p, force);
        }
        let checked = with(&problem.candidates.below(*reach), &now.contact);
        let mut gap = if rough {
            let mut u = vec![0.0; checked.len()];
            problem.operators.fast(&now.contact, &now.p, &checked, &mut u);
            u
        } else {
            problem.operators.exact(&now.contact, &now.p, &checked)
        };
        for (g, z) in gap.iter_mut().zip(problem.candidates.gaps(&checked)) {
            *g += z;
        }
        let p = checked.carry(&now.contact, &now.p);
        match *target {
            // The mean weighted by the pressure: the gap is then right where it carries.
            Target::Force(force) if now.q.is_none() => {
                now.d = p.iter().zip(&gap).map(|(p, g)| p / force * g).sum();
            }
            Target::Force(_) => {}
            Target::Approach(asked) => now.d = asked,
        }
        for g in &mut gap {
            *g -= now.d;
        }
        let evidence = measure(&p, &gap, limits.height.unwrap_or(now.d));
        let complete = !rough && now.d <= *reach;
        // Just above the plane: a generous guess must not make every round look at the whole grid.
        *reach = REACH * now.d;
        self.look = Look { checked, p, gap, evidence };
        Seen { evidence, complete, d: self.now.d, factored: self.now.q.is_some() }
    }

    fn improve(&mut self, seen: Seen, steps: &mut usize, stop: Stop<'_>) {
        let (look, target) = (&self.look, self.target);
        let noise = NOISE * residual(&look.p, &look.gap);
        let set = look.checked.filter(|k| look.p[k] > 0.0 || look.gap[k] < -noise);
        if self.limits.dense
            && strategy::dense_is_cheaper(set.len(), set.free_lengths())
            && let Some(exact) = eliminate(self.problem, &set, target)
        {
            self.reach = REACH * exact.d;
            self.now = exact;
            return;
        }
        let position = look.checked.positions(&set);
        let right: Vec<f64> = position.iter().map(|&k| -look.gap[k as usize]).collect();
        let precondition = strategy::precondition(self.now.contact.len(), set.window_cells());
        let request = Request { precondition, ..request(target, self.limits, seen) };
        let correction = cg::correct(&mut self.problem.operators, &set, &right, request, stop);
        *steps += correction.steps;
        let pressure: Vec<f64> =
            position.iter().zip(&correction.x).map(|(&k, x)| look.p[k as usize] + x).collect();
        let contact = set.filter(|k| pressure[k] > 0.0);
        let p = pressure.into_iter().filter(|&p| p > 0.0).collect();
        self.now = Pressed { contact, p, d: self.now.d, q: None };
    }

    fn keep(&mut self) {
        self.best = Some((self.now.clone(), self.look.clone()));
    }

    fn finish(self, status: Status, best: Option<Seen>, _: Seen, steps: usize) -> Solved {
        let (pressed, look) = match self.best {
            Some(kept) if best.is_some() => kept,
            _ => (self.now, self.look),
        };
        let Pressed { contact, p, d, q } = pressed;
        Solved { contact, p, d, q, look, steps, status }
    }
}

/// Drops cells in tension from a small superset until none is left; p, q and d are exact up to rounding.
fn eliminate(problem: &mut Problem, superset: &CellSet, target: Target) -> Option<Pressed> {
    let mut set = superset.clone();
    loop {
        let z = problem.candidates.gaps(&set);
        problem.operators.solves += 1;
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
    let on_contact = || p.iter().zip(gap).filter(|&(&p, _)| p > 0.0).map(|(_, g)| g.abs());
    let largest = on_contact().fold(0.0, f64::max);
    if largest <= 0.0 {
        return 0.0;
    }
    let (square, count) = on_contact().fold((0.0, 0.0), |(s, n), g| (s + (g / largest).powi(2), n + 1.0));
    largest * f64::sqrt(square / count)
}

/// Brings a pressure to a force.
pub fn rescale(p: &mut [f64], force: f64) {
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

#[cfg(test)]
mod decisions;

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use contact_model::never;
    use proptest::prelude::*;
    use std::sync::Arc;

    const TOLERANCE: f64 = 1e-9;

    fn problem(side: usize, z: Vec<f64>) -> Problem {
        Problem::new(side, Arc::new(z), Boundary::Free)
    }

    fn limits(dense: bool) -> Limits {
        Limits { tolerance: TOLERANCE, height: Some(1.0), rounds: 200, dense }
    }

    fn everything(side: usize, target: Target) -> Guess {
        let n = side * side;
        let d = match target {
            Target::Force(f) => f * 4.0,
            Target::Approach(d) => d,
        };
        Guess { set: CellSet::new(side, (0..n as u32).collect()), p: vec![1.0; n], d, far: false }
    }

    /// Reproducible rough gaps, lowest 0.
    fn rough(side: usize, seed: u64) -> Vec<f64> {
        let mut state = seed.wrapping_mul(2).wrapping_add(1);
        let mut z: Vec<f64> = (0..side * side)
            .map(|_| {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 11) as f64 / (1u64 << 53) as f64
            })
            .collect();
        let lowest = z.iter().copied().fold(f64::INFINITY, f64::min);
        for z in &mut z {
            *z -= lowest;
        }
        z
    }

    /// The same load on lists of cells and on arrays over the grid.
    fn both_grounds(side: usize, z: &[f64], target: Target) -> [Solved; 2] {
        let mut on_lists = problem(side, z.to_vec());
        let guess = everything(side, target);
        let lists = Listed::new(&mut on_lists, target, guess.clone(), limits(false));
        let lists = iterate(lists, Start::default(), limits(false), &never);
        let mut on_arrays = problem(side, z.to_vec());
        let Problem { candidates, operators, arrays, .. } = &mut on_arrays;
        let filled = Filled::new(candidates, operators, arrays, target, &guess, limits(false));
        [lists, iterate(filled, Start::default(), limits(false), &never)]
    }

    #[test]
    fn arrays_and_lists_are_twins() {
        for side in [1, 2, 3, 31, 48] {
            let z = rough(side, 9);
            for target in [0.3, 2.0, 30.0].map(Target::Force).into_iter().chain([Target::Approach(0.7)]) {
                let [lists, arrays] = both_grounds(side, &z, target);
                assert_eq!(
                    (lists.status, arrays.status),
                    (Status::Converged, Status::Converged),
                    "{side} {target:?}"
                );
                assert_eq!(lists.contact.index(), arrays.contact.index(), "{side} {target:?}");
                assert_relative_eq!(lists.d, arrays.d, max_relative = 1e-7);
                let largest = lists.p.iter().copied().fold(0.0, f64::max);
                for (a, b) in lists.p.iter().zip(&arrays.p) {
                    assert!((a - b).abs() < 1e-6 * largest, "{side} {target:?}");
                }
            }
        }
    }

    #[test]
    fn the_stiffness_of_filled_contact_is_that_of_lists() {
        // Large enough that the strategy takes arrays; the twin is a tight solve on lists.
        let side = 96;
        let mut problem = problem(side, rough(side, 4));
        let target = Target::Force(4000.0);
        let solved = solve(&mut problem, target, everything(side, target), limits(false), &never);
        assert!(strategy::fills(&solved.contact), "{} cells", solved.contact.len());
        let arrays = crate::stiffness::solve(&mut problem, &solved, None, 1e-8, &never);
        let lists = crate::stiffness::on_lists(&mut problem, &solved, None, 1e-8, &never);
        assert_relative_eq!(arrays.value, lists.value, max_relative = 1e-8);
        assert!(arrays.solve_error <= 1e-8 && arrays.solve_error > 0.0);
        assert_relative_eq!(arrays.set_error, lists.set_error, epsilon = 1e-8);
    }

    #[test]
    fn a_state_taken_up_again_is_not_looked_at_again() {
        let loose = Limits { tolerance: 1e-2, ..limits(false) };
        for (side, force, fills) in [(31, 2.0, false), (96, 4000.0, true)] {
            let target = Target::Force(force);
            let [again, resumed] = [false, true].map(|resumed| {
                let mut problem = problem(side, rough(side, 4));
                let solved = solve(&mut problem, target, everything(side, target), loose, &never);
                assert_eq!((solved.status, problem.arrays.left.is_some()), (Status::Converged, fills));
                let before = problem.operators.applications;
                let tight = if resumed {
                    resume(&mut problem, target, &solved, limits(false), &never)
                } else {
                    let guess = Guess { set: solved.contact, p: solved.p, d: solved.d, far: false };
                    solve(&mut problem, target, guess, limits(false), &never)
                };
                assert_eq!(tight.status, Status::Converged);
                (tight, problem.operators.applications - before)
            });
            assert_eq!(resumed.1 + 1, again.1, "one look less");
            assert_eq!(resumed.0.contact.index(), again.0.contact.index());
            assert_relative_eq!(resumed.0.d, again.0.d, max_relative = 1e-8);
            // Stopped at once, it is the state that it was.
            let mut problem = problem(side, rough(side, 4));
            let solved = solve(&mut problem, target, everything(side, target), loose, &never);
            let same = resume(&mut problem, target, &solved, limits(false), &|| true);
            assert_eq!((same.status, same.steps), (Status::Stopped, 0));
            assert_eq!(same.contact.index(), solved.contact.index());
            assert_relative_eq!(same.d, solved.d, max_relative = 1e-12);
            assert_relative_eq!(
                same.look.evidence.worst(),
                solved.look.evidence.worst(),
                max_relative = 1e-9
            );
        }
    }

    #[test]
    fn work_of_standard_solves_is_pinned() {
        // Counts, not times: a change of the algorithm shows here. The band leaves room for other processors' last digits.
        let side = 64;
        for (force, most) in [(0.5, 50), (5.0, 60), (50.0, 60)] {
            let mut problem = problem(side, rough(side, 3));
            let target = Target::Force(force);
            let solved = solve(&mut problem, target, everything(side, target), limits(false), &never);
            assert_eq!(solved.status, Status::Converged);
            let work = problem.operators.applications;
            assert!(work <= most, "force {force}: {work} applications, {most} were enough");
        }
    }

    #[test]
    fn an_unreachable_tolerance_stagnates_and_keeps_the_best() {
        let side = 16;
        let mut problem = problem(side, rough(side, 5));
        let target = Target::Force(3.0);
        let limits = Limits { tolerance: 1e-30, ..limits(false) };
        let solved = solve(&mut problem, target, everything(side, target), limits, &never);
        assert_eq!(solved.status, Status::Stagnated);
        assert!(solved.look.evidence.worst() < 1e-11, "{}", solved.look.evidence.worst());
    }

    #[test]
    fn stop_and_round_limit_are_told_apart() {
        let side = 16;
        let target = Target::Force(3.0);
        let mut first = problem(side, rough(side, 5));
        let stopped = solve(&mut first, target, everything(side, target), limits(false), &|| true);
        assert_eq!(stopped.status, Status::Stopped);
        let mut second = problem(side, rough(side, 5));
        let few = Limits { rounds: 1, ..limits(false) };
        let limited = solve(&mut second, target, everything(side, target), few, &never);
        assert_eq!(limited.status, Status::IterationLimit);
        assert!(!limited.p.is_empty());
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, rng_seed: proptest::test_runner::RngSeed::Fixed(2), ..ProptestConfig::default() })]

        #[test]
        fn factoring_and_iterating_find_the_same_state(side in 1usize..14, seed in any::<u64>(), force in 0.01..60.0f64) {
            let target = Target::Force(force);
            let mut states = [true, false].map(|dense| {
                let mut problem = problem(side, rough(side, seed));
                solve(&mut problem, target, everything(side, target), limits(dense), &never)
            }).into_iter();
            let (exact, iterated) = (states.next().unwrap(), states.next().unwrap());
            prop_assert_eq!(exact.status, Status::Converged);
            prop_assert_eq!(iterated.status, Status::Converged);
            prop_assert!((exact.d - iterated.d).abs() <= 1e-8 * (1.0 + exact.d));
            // A single cell is solved by its guess.
            prop_assert!(side == 1 || (exact.q.is_some() && iterated.q.is_none() && iterated.steps > 0));
            if exact.q.is_some() {
                prop_assert!(exact.look.evidence.worst() <= 1e-12 * (1.0 + exact.d));
            }
        }

        #[test]
        fn force_and_approach_are_two_ways_to_one_state(side in 2usize..14, seed in any::<u64>(), force in 0.01..60.0f64) {
            let mut problem = problem(side, rough(side, seed));
            let target = Target::Force(force);
            let pressed = solve(&mut problem, target, everything(side, target), limits(true), &never);
            let target = Target::Approach(pressed.d);
            let moved = solve(&mut problem, target, everything(side, target), limits(true), &never);
            assert_relative_eq!(moved.p.iter().sum::<f64>(), force, max_relative = 1e-9);
        }
    }
}
