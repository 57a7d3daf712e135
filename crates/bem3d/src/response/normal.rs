//! The stiffness of the normal force on given cells, which keep their contact: `G q = 1`.

use super::{Conditions, Goal, NormalStiffness, StiffnessCorrection, refine};
use crate::active_set::{Bounds, Problem, Solved};
use crate::geometry::CellSet;
use crate::kernel::NormalTable;
use crate::linear::{Energy, Fixed, StoppingCriteria, Workspace};
use crate::operator::{Conditioning, Operators, Recipe};
use crate::parts::Part;
use crate::real::{each, sum};
use crate::tuning::MAGNIFIED;
use contact_model::{Interrupted, Stop};
use std::borrow::Cow;

/// The cells of a contact that follow a small change of the approach.
#[derive(Debug, Clone)]
pub struct Responding<'a> {
    /// The cells.
    pub cells: Cow<'a, CellSet>,
    /// The bounds at which their pressure would no longer follow.
    pub bounds: Bounds,
    /// Cells that cannot be on the wrong side of the set, whatever their residual gap: those at the upper
    /// bound where the whole contact is fixed, and those at the bound without a gap where the direction of
    /// the load decides.
    pub decided: CellSet,
}

impl<'a> Responding<'a> {
    /// The free cells.
    pub fn free(state: &'a Solved, bounds: Bounds) -> Self {
        Self { cells: bounds.free(&state.contact, &state.p), bounds, decided: CellSet::default() }
    }

    /// The whole contact with a fixed set of cells, without the upper bound.
    pub fn whole(state: &'a Solved, bounds: Bounds) -> Self {
        let decided = state.contact.without(&bounds.free(&state.contact, &state.p));
        Self { cells: Cow::Borrowed(&state.contact), bounds: Bounds::Unlimited, decided }
    }
}

/// How well it is known which cells respond.
#[derive(Debug, Default)]
struct Doubts {
    /// Cells outside that may respond.
    undecided: CellSet,
    /// Residual gap of each cell that responds.
    left: Vec<f64>,
    /// The distance of its pressure from the nearest bound.
    room: Vec<f64>,
}

impl Doubts {
    fn of(problem: &Problem, state: &Solved, responding: &Responding<'_>) -> Self {
        let (cells, decided) = (&*responding.cells, &responding.decided);
        let operators = &problem.operators;
        let mut left = state.gap_on(cells);
        if !decided.is_empty() {
            let known = cells.carry(decided, &vec![true; decided.len()]);
            left.iter_mut().zip(known).filter(|(_, known)| *known).for_each(|(left, _)| *left = 0.0);
        }
        let mut room = state.room(cells, responding.bounds).into_owned();
        let undecided = || state.undecided(problem.grid(), cells, &left, operators.tuning());
        let mut undecided = operators.recorder().timed(Part::Sets, undecided);
        if !decided.is_empty() {
            undecided = undecided.without(decided);
            cells.add_carried(decided, &vec![f64::INFINITY; decided.len()], &mut room);
        }
        Self { undecided, left, room }
    }

    /// Change of k if the undecided cells changed sides, with the displacement under q at those outside.
    ///
    /// Adding cell j adds `(1 - (Gq)_j)^2 / S_j` with a Schur complement S_j not below the smallest eigenvalue;
    /// removing one takes away `q_j^2 / (G^-1)_jj`, at most `q_j^2 G_jj`. Undecided are the cells of
    /// [`Solved::undecided`] and those whose pressure is nearer to its bounds (`room`) than what their own
    /// residual gap can change. `tests/stiffness_error.rs` compares the sum of both parts with true errors.
    fn change(&self, table: &NormalTable, q: &[f64], at_undecided: &[f64]) -> f64 {
        let smallest = table.smallest_eigenvalue();
        let added: f64 = at_undecided.iter().map(|v| (1.0 - v).powi(2)).sum::<f64>() / smallest;
        let cells = self.room.iter().zip(q).zip(&self.left);
        let doubtful = cells.filter(|&((room, _), gap)| *room < gap.abs() / smallest);
        let removed: f64 = doubtful.map(|((_, q), _)| q * q).sum::<f64>() * table.own();
        added + removed
    }
}

/// The cells of a solve, and what is known of them.
struct StiffnessCells<'a> {
    cells: &'a CellSet,
    doubts: Doubts,
    /// Whether they were factored, so that the q to begin with is exact.
    factored: bool,
}

/// `G q = 1` on some cells. Conjugate gradients estimate the energy of a residual before their first step, so
/// that the check of one correction is the beginning of the next.
struct FixedSet<'a> {
    operators: &'a mut Operators,
    workspace: &'a mut Workspace,
    cells: &'a CellSet,
    doubts: Doubts,
    recipe: Recipe,
    /// The cells, and those that may belong to them.
    targets: CellSet,
    /// Displacement on the targets.
    v: Vec<f64>,
    /// Whether the residual of a guess may be in single precision: the guess will be corrected.
    rough: bool,
    started: bool,
    stop: Stop<'a>,
}

impl Conditions<1, 1> for FixedSet<'_> {
    fn displacements(&self) -> [Vec<f64>; 1] {
        [vec![1.0; self.cells.len()]]
    }

    fn forces(&self, q: &[f64]) -> [f64; 1] {
        [sum(q)]
    }

    fn residual(
        &mut self,
        [q]: &[Vec<f64>; 1],
        is_guess: bool,
        [r]: &mut [Vec<f64>; 1],
    ) -> Result<bool, Interrupted> {
        let Self { operators, cells, targets, v, stop, .. } = self;
        let rough = is_guess && self.rough;
        if rough {
            operators.rough(cells, q, targets, v, *stop)?;
        } else {
            operators.exact(cells, q, targets, v, *stop)?;
        }
        operators.recorder().timed(Part::Sets, || cells.carry_to(targets, v, r));
        each(r, |r| *r = 1.0 - *r);
        Ok(!rough)
    }

    fn correct(
        &mut self,
        [r]: &mut [Vec<f64>; 1],
        goal: Goal<1>,
    ) -> Result<Option<StiffnessCorrection<1>>, Interrupted> {
        let Self { operators, workspace, stop, .. } = self;
        let tuning = *operators.tuning();
        if !std::mem::replace(&mut self.started, true) {
            workspace.take(operators, self.cells.clone(), self.recipe, *stop)?;
        }
        let criteria = StoppingCriteria {
            reduction: tuning.stiffness_reduction,
            energy: Some(Energy { share: goal.share, base: goal.bases[0] }),
            floor: 0.0,
            steps: if goal.only_energy { 0 } else { tuning.stiffness_steps },
        };
        let outcome = workspace.solve(operators, r, Fixed::Approach, criteria, *stop)?;
        Ok(Some(StiffnessCorrection {
            energy: [outcome.energy],
            steps: (!goal.only_energy).then_some(outcome.steps),
        }))
    }

    fn set_error(&self, [q]: &[Vec<f64>; 1]) -> f64 {
        let at_undecided = self.doubts.undecided.carry(&self.targets, &self.v);
        self.doubts.change(self.operators.table(), q, &at_undecided)
    }
}

/// The accuracy of a requested stiffness, and where its solve begins.
#[derive(Debug, Default)]
pub struct StiffnessRequest {
    /// The solve ends when its relative error is estimated below half of this.
    pub tolerance: f64,
    /// The q of a similar set to begin with.
    pub q: Option<Vec<f64>>,
    /// The value that is expected; `None`: it is unknown.
    pub expected: Option<f64>,
}

/// The stiffness `1' G^-1 1` of a state with the kernel as it is, of the cells that respond.
///
/// The q of a factored state is exact up to rounding, and needs no transform.
///
/// # Errors
/// [`Interrupted`] by the stop, as all of these.
///
/// Cost: about 10 applications of G for a relative error of 1e-4.
pub fn solve(
    problem: &mut Problem,
    state: &Solved,
    responding: &Responding<'_>,
    wanted: StiffnessRequest,
    stop: Stop<'_>,
) -> Result<NormalStiffness, Interrupted> {
    let cells = &*responding.cells;
    if cells.is_empty() && !state.contact.is_empty() {
        return Ok(NormalStiffness::nothing());
    }
    let factored = state.q.as_ref().filter(|q| q.len() == cells.len());
    let q = wanted.q.or_else(|| factored.cloned());
    let doubts = Doubts::of(problem, state, responding);
    let cells = StiffnessCells { cells, doubts, factored: factored.is_some() };
    on_cells(problem, cells, StiffnessRequest { q, ..wanted }, stop)
}

/// As [`solve`], to a tolerance of the stiffness of the kernel of zero mean, which the value still has to be
/// turned into ([`magnification`]).
pub fn solve_of_zero_mean(
    problem: &mut Problem,
    state: &Solved,
    responding: &Responding<'_>,
    wanted: StiffnessRequest,
    stop: Stop<'_>,
) -> Result<NormalStiffness, Interrupted> {
    let factored = state.q.as_ref().filter(|q| q.len() == responding.cells.len());
    let wanted = StiffnessRequest { q: factored.cloned().or(wanted.q), ..wanted };
    to_magnified_tolerance(problem, wanted, factored.is_some(), stop, |problem, wanted| {
        solve(problem, state, responding, wanted, stop)
    })
}

/// The stiffness of the kernel of zero mean on cells of which none is in doubt.
pub fn of_held_cells(
    problem: &mut Problem,
    cells: &CellSet,
    tolerance: f64,
    stop: Stop<'_>,
) -> Result<NormalStiffness, Interrupted> {
    let wanted = StiffnessRequest { tolerance, ..StiffnessRequest::default() };
    let found = to_magnified_tolerance(problem, wanted, false, stop, |problem, wanted| {
        on_cells(problem, StiffnessCells { cells, doubts: Doubts::default(), factored: false }, wanted, stop)
    })?;
    Ok(of_zero_mean(found, problem.operators.table().shift()))
}

/// The ratio of the relative error of k to that of `1' G^-1 1 = k'` with the constant c in G:
/// `k = k' / (1 - c k')`.
///
/// 1 with free boundaries; grows without limit towards full contact of a periodic surface.
pub fn magnification(constant: f64, value: f64) -> f64 {
    let rest = 1.0 - constant * value;
    if rest > 1.0 / MAGNIFIED { 1.0 / rest } else { MAGNIFIED }
}

/// From the kernel with its constant to that of zero mean.
pub fn of_zero_mean(found: NormalStiffness, constant: f64) -> NormalStiffness {
    let factor = magnification(constant, found.k());
    NormalStiffness {
        value: [found.k() * factor],
        solve_error: found.solve_error * factor,
        set_error: found.set_error * factor,
        ..found
    }
}

/// Solves again where the error is magnified by more than was expected.
fn to_magnified_tolerance(
    problem: &mut Problem,
    mut wanted: StiffnessRequest,
    is_exact: bool,
    stop: Stop<'_>,
    mut solve: impl FnMut(&mut Problem, StiffnessRequest) -> Result<NormalStiffness, Interrupted>,
) -> Result<NormalStiffness, Interrupted> {
    let misjudged = problem.operators.tuning().misjudged;
    let constant = problem.operators.table().shift();
    let mut expected = wanted.expected.map_or(1.0, |k| magnification(constant, k));
    let mut steps = 0;
    loop {
        let tolerance = wanted.tolerance / expected;
        let mut found = solve(problem, StiffnessRequest { tolerance, q: wanted.q, expected: None })?;
        steps += found.steps;
        found.steps = steps;
        let magnified = magnification(constant, found.k());
        if magnified <= misjudged * expected || is_exact || found.q().is_empty() || stop.stops() {
            return Ok(found);
        }
        expected = magnified;
        let [q] = found.change;
        wanted.q = Some(q);
    }
}

fn on_cells(
    problem: &mut Problem,
    responding: StiffnessCells<'_>,
    wanted: StiffnessRequest,
    stop: Stop<'_>,
) -> Result<NormalStiffness, Interrupted> {
    let StiffnessCells { cells, doubts, factored } = responding;
    let Problem { operators, workspace, .. } = problem;
    let Some(recipe) = operators.planner().system(cells, cells.len(), true) else {
        return Ok(NormalStiffness::unknown());
    };
    let conditioning = if factored { Conditioning::Identity } else { recipe.conditioning };
    let targets = cells.union(&doubts.undecided);
    let tuning = *operators.tuning();
    let error = operators.roughness(cells, &targets);
    let rough = !factored && error > 0.0 && wanted.tolerance >= tuning.stiffness_single * error.powi(2);
    let recipe = Recipe { conditioning, ..recipe };
    let mut conditions = FixedSet {
        operators,
        workspace,
        cells,
        doubts,
        recipe,
        targets,
        v: Vec::new(),
        rough,
        started: false,
        stop,
    };
    refine(&mut conditions, wanted.q.map(|q| [q]), wanted.tolerance, &tuning, stop)
}

#[cfg(test)]
mod tests;
