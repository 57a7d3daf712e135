//! Initial guesses of a solve: the tangent of the last state, or nested iteration from the same surface on
//! coarser grids.

use super::candidates::GapRange;
use super::solver::solve;
use super::state::{Control, Guess, Limits, Problem, Solved};
use crate::geometry::{CellSet, Grid};
use crate::tuning::Tuning;
use contact_model::{Interrupted, Stop};
use numerics::parallel::{for_each, threads_for};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::ops::Range;
use std::sync::Arc;

/// The state solved last, from which the next is extrapolated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LastState {
    /// The contact set.
    pub contact: CellSet,
    /// Pressure on it.
    pub p: Vec<f64>,
    /// Approach.
    pub d: f64,
    /// Sum of the pressure.
    pub force: f64,
    /// q and k, where known.
    pub tangent: Option<(Vec<f64>, f64)>,
}

impl LastState {
    /// The ratio of the requested load to the last one.
    pub fn ratio(&self, target: Control) -> f64 {
        match target {
            Control::Force(force) => force / self.force,
            Control::Approach(d) => d / self.d,
        }
    }

    /// A guess of q on the cells of a state, from the last q and the secant between the two states; where the
    /// load falls, the last q alone.
    pub fn tangent_at(self, solved: &Solved, cells: &CellSet, tuning: &Tuning) -> Option<Vec<f64>> {
        let mut q = cells.carry(&self.contact, &self.tangent.as_ref()?.0);
        let way = solved.d - self.d;
        if way > 0.0 {
            let before = cells.carry(&self.contact, &self.p);
            let now = if cells.len() == solved.contact.len() {
                Cow::Borrowed(&solved.p)
            } else {
                Cow::Owned(cells.carry(&solved.contact, &solved.p))
            };
            for ((q, p), before) in q.iter_mut().zip(&*now).zip(&before) {
                *q += tuning.extrapolation * ((p - before) / way - *q);
            }
        }
        Some(q)
    }

    /// Follows the tangent of the last state: `p + Dd q` on the same set. The stiffness grows with the load,
    /// so that the predicted approach is an upper bound and every new contact cell lies below it. Where no
    /// stiffness was requested, the pressure is scaled.
    pub fn extrapolated(&self, target: Control, tuning: &Tuning) -> Option<Guess> {
        let ratio = self.ratio(target);
        if !(1.0 / tuning.warm..=tuning.warm).contains(&ratio) {
            return None;
        }
        let (mut p, d): (Vec<f64>, f64) = if let Some((q, k)) = &self.tangent {
            let step = match target {
                Control::Force(force) => (force - self.force) / k,
                Control::Approach(d) => d - self.d,
            };
            (self.p.iter().zip(q).map(|(p, q)| p + step * q).collect(), self.d + step.max(0.0))
        } else {
            (self.p.iter().map(|p| ratio * p).collect(), self.d * ratio.max(1.0))
        };
        let set = self.contact.filter(&p, |p| p > 0.0);
        p.retain(|&p| p > 0.0);
        (!set.is_empty()).then(|| Guess { set, p, d: d.max(f64::MIN_POSITIVE) })
    }

    /// Whether a load begins on coarse grids although a state is known.
    ///
    /// The tangent overshoots (the stiffness grows with every cell that joins); where it predicts far more
    /// cells than the load has grown by, eliminating them costs about three times as much as a coarse
    /// solution. `predicted` counts them with one application; where a good part of the grid will touch, the
    /// answer is known without counting.
    ///
    /// # Errors
    /// That of `predicted`.
    pub fn overshoots(
        &self,
        target: Control,
        cells: usize,
        tuning: &Tuning,
        predicted: impl FnOnce() -> Result<usize, Interrupted>,
    ) -> Result<bool, Interrupted> {
        let ratio = self.ratio(target);
        let (expected, cells) = (self.contact.len() as f64 * ratio, cells as f64);
        Ok(!(tuning.near.0..=tuning.near.1).contains(&ratio)
            && (expected * tuning.filling >= cells
                || (expected * tuning.counted >= cells && predicted()? as f64 > tuning.overshoot * expected)))
    }
}

/// Number of cells that carry pressure or would penetrate under a guess, in single precision.
///
/// # Errors
/// [`Interrupted`] by the stop.
pub fn predicted_cells(problem: &mut Problem, guess: &Guess, stop: Stop<'_>) -> Result<usize, Interrupted> {
    let checked = problem.candidates.below(guess.d).union(&guess.set);
    let mut gap = Vec::new();
    problem.operators.rough(&guess.set, &guess.p, &checked, &mut gap, stop)?;
    problem.candidates.add_to(&checked, &mut gap);
    Ok(gap.iter().filter(|&&g| g < guess.d).count().max(guess.set.len()))
}

/// A guess for a load where no state is known.
///
/// The cells with `z < F / k_1` (k_1: one cell alone, the softest contact) contain the contact set. If they
/// are few they are the guess; otherwise the surface averaged over 2 x 2 cells is solved first. A coarse grid
/// only says where to begin: every fine cell stays a candidate, because fractal summits vanish on coarse
/// grids.
///
/// # Errors
/// [`Interrupted`] by the stop.
pub fn cold_start(
    problem: &mut Problem,
    target: Control,
    limits: Limits,
    stop: Stop<'_>,
) -> Result<Guess, Interrupted> {
    let (grid, tuning) = (problem.grid(), *problem.operators.tuning());
    let own = problem.operators.table().own();
    // The highest cell of a coarse grid lies below the plane of first touch.
    let GapRange { highest, first, deepest } = problem.candidates.range();
    let reach = match target {
        Control::Force(force) => first + force * own,
        Control::Approach(d) => d,
    };
    let reach = reach.min(2.0 * deepest + f64::MIN_POSITIVE);
    let from_above = |problem: &mut Problem| {
        let set = problem.candidates.below(reach).union(&CellSet::from_index(grid, &[highest]));
        let p = match target {
            Control::Force(force) => force / set.len() as f64,
            // Any positive value: the first outer iteration evaluates the true gap.
            Control::Approach(d) => d / (own * set.len() as f64),
        };
        Guess { p: vec![p; set.len()], set, d: reach }
    };
    if grid.count() <= tuning.coarsest * tuning.coarsest || !problem.nested {
        return Ok(from_above(problem));
    }
    if limits.factor && !problem.candidates.more_than(tuning.largest_factor, reach) {
        let guess = from_above(problem);
        let window = guess.set.window().unwrap_or(grid.window());
        if problem.operators.planner().factors(guess.set.len(), window) {
            return Ok(guess);
        }
    }
    let mut coarse = problem.coarser.take().unwrap_or_else(|| Box::new(coarser(problem)));
    if let Control::Approach(d) = target
        && coarse.candidates.range().first >= d
    {
        problem.coarser = Some(coarse);
        return Ok(from_above(problem));
    }
    let limits = Limits {
        tolerance: tuning.coarse_tolerance,
        outer_iterations: tuning.coarse_iterations,
        is_guess: true,
        ..limits
    };
    let coarse_target = match target {
        Control::Force(force) => Control::Force(force / pressure_ratio(grid, &tuning)),
        approach @ Control::Approach(_) => approach,
    };
    // Residuals of coarse grids say nothing about this one's.
    let unheard = || stop.stops();
    let guess = cold_start(&mut coarse, coarse_target, limits, &unheard)?;
    let solved = solve(&mut coarse, coarse_target, guess, limits, &unheard)?;
    let guess = prolonged(problem, &solved);
    problem.coarser = Some(coarse);
    Ok(guess)
}

/// Fine columns and rows of a coarse cell: a direction with few cells is left as it is.
fn blocks(grid: Grid, tuning: &Tuning) -> (usize, usize) {
    let halved = |n: usize| 1 + usize::from(2 * n > tuning.coarsest);
    (halved(grid.columns), halved(grid.rows))
}

/// Ratio of the nondimensional pressures on the coarse and the fine grid under the same force: forces are in
/// units of the side of a cell, so that the sum over coarse cells is smaller.
fn pressure_ratio(grid: Grid, tuning: &Tuning) -> f64 {
    let (across, down) = blocks(grid, tuning);
    ((across * down) as f64).sqrt()
}

/// The same surface on cells twice as large: means of their defined cells (fewer at the last row and column
/// of an odd grid).
fn coarser(problem: &Problem) -> Problem {
    let (fine, tuning) = (problem.grid(), *problem.operators.tuning());
    let (across, down) = blocks(fine, &tuning);
    let stretch =
        if across == down { fine.stretch } else { fine.stretch * (across as f64 / down as f64).sqrt() };
    let grid = Grid { columns: fine.columns.div_ceil(across), rows: fine.rows.div_ceil(down), stretch };
    let mut z = vec![0.0; grid.count()];
    let rows = z.chunks_exact_mut(grid.columns).zip(problem.candidates.z().chunks(down * fine.columns));
    let mut sums = vec![vec![(0.0, 0.0); grid.columns]; threads_for(fine.count())];
    for_each(&mut sums, rows, |sums, (coarse, block)| {
        sums.fill((0.0, 0.0));
        for row in block.chunks_exact(fine.columns) {
            for ((sum, count), cells) in sums.iter_mut().zip(row.chunks(across)) {
                for &z in cells.iter().filter(|z| z.is_finite()) {
                    (*sum, *count) = (*sum + z, *count + 1.0);
                }
            }
        }
        for (mean, &(sum, count)) in coarse.iter_mut().zip(sums.iter()) {
            *mean = if count > 0.0 { sum / count } else { f64::INFINITY };
        }
    });
    // A side of the coarse cells is as many fine ones.
    let medium = problem.medium.on_larger_cells(pressure_ratio(fine, &tuning));
    let mut coarse = Problem::recorded(grid, Arc::new(z), medium, &tuning, problem.operators.recorder());
    coarse.bounds = problem.bounds.scaled(pressure_ratio(fine, &tuning));
    coarse
}

/// The coarse pressure on the fine cells within each coarse cell that lie under the plane (on all defined
/// ones if none does).
fn prolonged(problem: &Problem, solved: &Solved) -> Guess {
    let (grid, z, d) = (problem.grid(), problem.candidates.z(), solved.d);
    let tuning = problem.operators.tuning();
    let ((across, down), ratio) = (blocks(grid, tuning), pressure_ratio(grid, tuning));
    let columns_of = |x: usize| x * across..((x + 1) * across).min(grid.columns);
    let (mut rows, mut p) =
        (Vec::with_capacity(grid.rows), Vec::with_capacity(across * down * solved.p.len()));
    for row in solved.contact.rows() {
        let below = row.y * down..((row.y + 1) * down).min(grid.rows);
        let pressed: Vec<(Range<usize>, f64, f64)> = (row.columns.iter().zip(&solved.p[row.span()]))
            .map(|(&x, p)| {
                let columns = columns_of(x as usize);
                let lower = |limit: f64| {
                    let lines = below.clone().map(|y| &z[y * grid.columns..][columns.clone()]);
                    lines.flatten().filter(|&&z| z < limit).count()
                };
                let under_plane = lower(d);
                let (limit, count) =
                    if under_plane > 0 { (d, under_plane) } else { (f64::INFINITY, lower(f64::INFINITY)) };
                (columns, limit, ratio * p / count as f64)
            })
            .collect();
        for y in below {
            let line = &z[y * grid.columns..][..grid.columns];
            let mut carrying = Vec::with_capacity(across * pressed.len());
            for (columns, limit, share) in &pressed {
                for x in columns.clone().filter(|&x| line[x] < *limit) {
                    carrying.push(x as u32);
                    p.push(*share);
                }
            }
            rows.push((y, carrying));
        }
    }
    Guess { set: CellSet::from_rows(rows), p, d }
}

#[cfg(test)]
mod tests;
