//! What the iteration decides, one decision at a time: a state is certified whatever way led to it, so that a wrong decision
//! costs work and would show in no result.

use super::*;
use approx::assert_relative_eq;
use contact_model::never;
use std::cell::RefCell;
use std::sync::Arc;

const TIGHT: Limits = Limits { tolerance: 1e-6, height: Some(1.0), rounds: 100, dense: true };

/// A complete look with this certificate at an approach of 1.
fn seen(error: f64) -> Seen {
    let evidence = Evidence { duality_gap: error, ..Evidence::default() };
    Seen { evidence, complete: true, d: 1.0, factored: false }
}

/// What was asked of a ground.
#[derive(Default)]
struct Asked {
    rough: Vec<bool>,
    kept: Vec<usize>,
}

/// A ground that sees what it is told to; its last look repeats itself.
struct Scripted<'a> {
    script: &'a [Seen],
    asked: &'a RefCell<Asked>,
}

impl Ground for Scripted<'_> {
    fn look(&mut self, rough: bool) -> Seen {
        let mut asked = self.asked.borrow_mut();
        asked.rough.push(rough);
        self.script[asked.rough.len().min(self.script.len()) - 1]
    }

    fn improve(&mut self, _: Seen, steps: &mut usize, _: Stop<'_>) {
        *steps += 1;
    }

    fn keep(&mut self) {
        let mut asked = self.asked.borrow_mut();
        let at = asked.rough.len() - 1;
        asked.kept.push(at);
    }

    /// The approach says whether it is the best look or the last.
    fn finish(self, status: Status, best: Option<Seen>, last: Seen, steps: usize) -> Solved {
        let empty = CellSet::new(1, Vec::new());
        let look = Look { checked: empty.clone(), p: Vec::new(), gap: Vec::new(), evidence: last.evidence };
        let d = best.unwrap_or(last).d;
        Solved { contact: empty, p: Vec::new(), d, q: None, look, steps, status }
    }
}

fn run(script: &[Seen], limits: Limits) -> (Solved, Asked) {
    let asked = RefCell::default();
    let solved = iterate(Scripted { script, asked: &asked }, Start::default(), limits, &never);
    (solved, asked.into_inner())
}

#[test]
fn converged_is_complete_and_settled_and_within_the_tolerance() {
    let good = seen(1e-6);
    let (solved, asked) = run(&[good], TIGHT);
    assert_eq!((solved.status, asked.rough.len()), (Status::Converged, 1));
    // Not every cell was looked at.
    let (_, asked) = run(&[Seen { complete: false, ..good }, good], TIGHT);
    assert_eq!(asked.rough.len(), 2);
    // A factored set may leave the rounding of its approach, here 1e-12 x 1000, and no more.
    let factored =
        |deepest| Seen { evidence: Evidence { deepest, ..good.evidence }, d: 1e3, factored: true, ..good };
    assert_eq!(run(&[factored(5e-10), good], TIGHT).1.rough.len(), 1);
    assert_eq!(run(&[factored(2e-9), good], TIGHT).1.rough.len(), 2);
}

#[test]
fn patience_is_for_rounds_without_a_better_certificate() {
    // The first look is the best, PATIENCE + 1 more are no better, the next one ends it.
    let (solved, asked) = run(&[seen(1e-3)], TIGHT);
    assert_eq!(solved.status, Status::Stagnated);
    assert_eq!(asked.rough.len(), PATIENCE + 3);
    assert_eq!(solved.steps, PATIENCE + 2);
}

#[test]
fn a_certificate_is_better_when_it_falls_by_a_tenth() {
    let script = [1.0, 0.95, BETTER, 0.5, 0.0].map(seen);
    assert_eq!(run(&script, TIGHT).1.kept, [0, 3]);
    let incomplete = Seen { complete: false, ..seen(0.1) };
    assert_eq!(run(&[seen(1.0), incomplete, seen(0.0)], TIGHT).1.kept, [0]);
}

#[test]
fn the_better_of_best_and_last_is_returned() {
    let at = |d: f64, error: f64| Seen { d, ..seen(error) };
    let limits = Limits { rounds: 1, ..TIGHT };
    for (last, expected) in [(0.2, 1.0), (0.1, 1.0), (0.095, 2.0)] {
        let (solved, _) = run(&[at(1.0, 0.1), at(2.0, last)], limits);
        assert_eq!(solved.status, Status::IterationLimit);
        assert_relative_eq!(solved.d, expected);
    }
    // What has converged is returned although an unsettled look before it had a smaller certificate.
    let evidence = Evidence { duality_gap: 1e-8, deepest: 1.0, ..Evidence::default() };
    let unsettled = Seen { evidence, factored: true, ..at(1.0, 0.0) };
    let (solved, asked) = run(&[unsettled, at(2.0, 1e-7)], limits);
    assert_eq!((solved.status, asked.kept), (Status::Converged, vec![0]));
    assert_relative_eq!(solved.d, 2.0);
}

#[test]
fn a_rough_look_follows_a_large_error_that_single_precision_can_see() {
    // (certificate, tolerance, height, approach) -> whether the next look is in single precision.
    for (error, tolerance, height, d, rough) in [
        (0.5, 1e-6, 1.0, 1.0, true),
        (0.02, 1e-6, 1.0, 1.0, false),
        (ROUGH, 1e-6, 1.0, 1.0, false),
        // Ten times the tolerance is near enough for the real look.
        (0.5, 0.1, 1.0, 1.0, false),
        (0.5, 0.05, 1.0, 1.0, false),
        // The gap that is measured, error x height, against 1e-4 of the approach.
        (0.5, 1e-6, 1.0, 0.5 / SINGLE_NOISE, false),
        (0.5, 1e-6, 1.0, 0.6 / SINGLE_NOISE, false),
        (0.5, 1e-6, 1.0, 0.4 / SINGLE_NOISE, true),
        (0.5, 1e-6, 4.0, 1.0 / SINGLE_NOISE, true),
    ] {
        let limits = Limits { tolerance, height: Some(height), ..TIGHT };
        let (_, asked) = run(&[Seen { d, ..seen(error) }, seen(0.0)], limits);
        assert_eq!(asked.rough, [false, rough], "{error} {tolerance} {height} {d}");
    }
}

#[test]
fn gradients_are_asked_for_half_of_what_is_wanted() {
    let limits = Limits { tolerance: 1e-3, height: Some(5.0), ..TIGHT };
    let reduction = |error| request(Target::Force(1.0), limits, seen(error)).reduction;
    assert_relative_eq!(reduction(4e-3), 0.125);
    assert_relative_eq!(reduction(EARLY), REDUCTION.0);
    assert_relative_eq!(reduction(1.01 * EARLY), EARLY_REDUCTION);
    assert_relative_eq!(reduction(1e-3), REDUCTION.1);
    let tight = Limits { tolerance: 1e-9, height: None, ..limits };
    let asked = request(Target::Approach(1.0), tight, Seen { d: 3.0, ..seen(1e-2) });
    assert_relative_eq!(asked.reduction, REDUCTION.0);
    // A fifth of the tolerance, as a length: of the height, or of the approach where there is none.
    assert_relative_eq!(asked.floor, 0.6e-9);
    assert_relative_eq!(request(Target::Force(1.0), limits, seen(1.0)).floor, 1e-3);
    assert!(!asked.fixed_sum && request(Target::Force(1.0), limits, seen(1.0)).fixed_sum);
}

#[test]
fn the_residual_is_the_rms_gap_of_the_cells_that_press() {
    assert_relative_eq!(residual(&[1.0, 2.0, 0.0], &[3.0, -4.0, 100.0]), 12.5f64.sqrt());
    // Squares of these are no numbers of f64.
    assert_relative_eq!(
        residual(&[1.0, 1.0], &[3e-200, 4e-200]),
        12.5f64.sqrt() * 1e-200,
        epsilon = 0.0,
        max_relative = 1e-14
    );
    assert_relative_eq!(residual(&[0.0, 1.0], &[5.0, 0.0]), 0.0);
}

/// A summit, a neighbour ten units below it, and all the rest far below: under a unit force the summit alone bears, and
/// `d = I(0, 0)`.
fn summit() -> Problem {
    let mut z = vec![100.0; 64];
    (z[0], z[1]) = (0.0, 10.0);
    Problem::new(8, Arc::new(z), Boundary::Free)
}

fn one(cell: u32, d: f64) -> Guess {
    Guess { set: CellSet::new(8, vec![cell]), p: vec![1.0], d, far: false }
}

const FORCE: Target = Target::Force(1.0);

#[test]
fn a_look_is_complete_up_to_where_candidates_were_looked_for() {
    let depth = crate::love::influence(0, 0);
    let mut problem = summit();
    let mut listed = Listed::new(&mut problem, FORCE, one(0, 5.0), TIGHT);
    let look = listed.look(false);
    assert!(look.complete);
    assert_relative_eq!(look.d, depth, max_relative = 1e-14);
    assert_relative_eq!(listed.reach, 1.05 * depth, max_relative = 1e-14);
    assert!(!listed.look(true).complete, "single precision is no evidence");
    let mut listed = Listed::new(&mut problem, FORCE, one(0, 1.0), TIGHT);
    assert!(!listed.look(false).complete, "the plane ended above the cells that were looked at");
    assert!(listed.look(false).complete);
}

#[test]
fn a_factored_approach_is_measured_not_replaced() {
    let mut problem = summit();
    let mut listed = Listed::new(&mut problem, FORCE, one(0, 5.0), TIGHT);
    listed.now.q = Some(vec![1.0]);
    let look = listed.look(false);
    assert_relative_eq!(look.d, 5.0);
    let off = 5.0 - crate::love::influence(0, 0);
    assert_relative_eq!(look.evidence.complementarity, off, max_relative = 1e-14);
}

#[test]
fn a_cell_is_added_when_it_penetrates_by_more_than_the_noise() {
    // The summit presses with a gap of 0.5 left: that is the noise. Under its own load the neighbour only pulls, which costs a
    // second factor.
    for (gap, factors) in [(0.3, 1), (-0.3, 1), (-0.5, 1), (-0.51, 2)] {
        let mut problem = summit();
        let mut listed = Listed::new(&mut problem, FORCE, one(0, 5.0), TIGHT);
        let checked = CellSet::new(8, vec![0, 1]);
        let evidence = Evidence::default();
        listed.look = Look { checked, p: vec![1.0, 0.0], gap: vec![0.5, gap], evidence };
        listed.improve(seen(1.0), &mut 0, &never);
        assert_eq!(listed.now.contact.index(), [0]);
        assert_relative_eq!(listed.now.d, crate::love::influence(0, 0), max_relative = 1e-14);
        assert_relative_eq!(listed.reach, 1.05 * listed.now.d, max_relative = 1e-14);
        assert_eq!(problem.operators.solves, factors, "gap {gap}");
    }
}

#[test]
fn a_cell_without_pressure_is_not_in_contact() {
    // Stopped before the first step, gradients change nothing: the neighbour that was added still carries nothing.
    let mut problem = summit();
    let mut listed = Listed::new(&mut problem, FORCE, one(0, 5.0), Limits { dense: false, ..TIGHT });
    let checked = CellSet::new(8, vec![0, 1]);
    listed.look = Look { checked, p: vec![1.0, 0.0], gap: vec![0.5, -0.8], evidence: Evidence::default() };
    listed.improve(seen(1.0), &mut 0, &|| true);
    assert_eq!(listed.now.contact.index(), [0]);
    assert_eq!(listed.now.p, [1.0]);
    assert!(listed.now.q.is_none());
    // First touch: nothing presses, whatever the set.
    let mut flat = Problem::new(2, Arc::new(vec![0.0; 4]), Boundary::Free);
    assert!(eliminate(&mut flat, &CellSet::new(2, vec![0, 1, 2, 3]), Target::Approach(0.0)).is_none());
}

#[test]
fn the_kept_state_is_returned_where_it_is_the_best() {
    let finished = |best: bool| {
        let mut problem = summit();
        let mut listed = Listed::new(&mut problem, FORCE, one(0, 5.0), TIGHT);
        let first = listed.look(false);
        listed.keep();
        listed.now = Pressed { contact: CellSet::new(8, vec![63]), p: vec![1.0], d: 5.0, q: None };
        let last = listed.look(false);
        listed.finish(Status::Stagnated, best.then_some(first), last, 7)
    };
    assert_eq!(finished(true).contact.index(), [0]);
    assert_eq!(finished(false).contact.index(), [63]);
    assert_eq!(finished(true).steps, 7);
}

#[test]
fn a_guess_promises_the_cells_that_it_makes_penetrate() {
    // The summit under its own load: u = I(x, y) around it. Steps of z and an approach between the values of u + z.
    let side = 8;
    let z: Vec<f64> = (0..64).map(|i| f64::from(i % 8 + i / 8) / 8.0).collect();
    let mut problem = Problem::new(side, Arc::new(z.clone()), Boundary::Free);
    for d in [0.9, 1.3, 2.0] {
        let expected =
            (0..64).filter(|&i| crate::love::influence(i % 8, i / 8) + z[i] < d && z[i] < d).count();
        let guess = Guess { set: CellSet::new(side, vec![0]), p: vec![1.0], d, far: false };
        assert!(expected > 1);
        assert_eq!(promised(&mut problem, &guess), expected, "d = {d}");
    }
    // Without pressure the cells below the plane penetrate; one at its height does not: z = 1/8 holds for cells 1 and 8.
    let guess = Guess { set: CellSet::new(side, vec![1]), p: vec![0.0], d: 0.125, far: false };
    assert_eq!(promised(&mut problem, &guess), 1);
    // At least the guess itself.
    let guess = Guess { set: CellSet::new(side, vec![0, 1, 2]), p: vec![100.0; 3], d: 0.1, far: false };
    assert_eq!(promised(&mut problem, &guess), 3);
}

#[test]
fn no_force_from_nothing_and_no_cell_lost_in_a_union() {
    // No pressure cannot be brought to a force, and stays none.
    let mut none = [0.0; 3];
    rescale(&mut none, 5.0);
    assert!(none.iter().all(|&p| p == 0.0));
    let set = |index: &[u32]| CellSet::new(8, index.to_vec());
    for (a, b, union) in [
        (&[1, 4][..], &[4, 9, 60][..], &[1, 4, 9, 60][..]),
        (&[5, 7], &[], &[5, 7]),
        (&[], &[5, 7], &[5, 7]),
        (&[8, 9], &[1], &[1, 8, 9]),
    ] {
        assert_eq!(with(&set(a), &set(b)).index(), union);
    }
}
