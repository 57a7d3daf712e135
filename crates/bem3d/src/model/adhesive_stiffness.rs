//! The stiffnesses of a state with adhesion: along the branch, and at a fixed contact area.
//!
//! An exponential attraction moves with the gaps, and its linearised equations have the stiffness. Fronts of
//! a short range and the edges of Dugdale's zones move by whole cells: between two moves the force follows
//! the gaps as with fixed fronts, 1.4 to 1.8 times too stiff for any size of the cells. There the stiffness
//! is a difference quotient: the state is followed along its branch until its fronts have moved by two cells,
//! and a parabola through the states found has its slope at the first one.

use super::adhesive::AdhesiveContact;
use super::load::LoadSequence;
use crate::adhesion::{AdhesiveControl, Equilibrium};
use crate::response::adhesive::{Response, fixed_area};
use contact_model::{Branch, Status, Stop};

/// The first step of the plane, in ranges of the law.
const FIRST_STEP: f64 = 0.1;
/// Fronts advance in a step by about this many cells ...
const ADVANCE: f64 = 0.4;
/// ... and until they have advanced by this number of cells in total.
const FAR_ENOUGH: f64 = 2.5;
/// Until fronts have advanced by this number of cells the force follows the gaps as with fixed fronts; a fit
/// needs points beyond those.
const NEAREST: f64 = 1.0;
/// In a contact of fewer cells than a radius of 17, a front counts as advanced by a cell when it has taken
/// this share of its area.
const NARROW: f64 = 0.12;
/// A step grows or shrinks at most by this factor from one to the next.
const ADAPT: f64 = 2.0;
/// Steps at most.
const STEPS: usize = 14;
/// Smallest number of steps, so that a cubic through all points has a residual scatter.
const FEWEST: usize = 5;
/// A step in which fronts advance by more than this number of cells is a jump, which has no slope.
const JUMP: f64 = 4.0;
/// Neighbouring points deviate from a parabola to the same side, so that their scatter is less informative
/// than that of independent points. This factor is chosen so that the claimed error holds for 85 of 100 small
/// random contacts.
const SMOOTH: f64 = 1.4;
/// A slope with a larger relative error is not claimed.
const CLAIMED: f64 = 0.5;

/// Stiffnesses of a state, nondimensional over pi.
#[derive(Debug, Default)]
pub(super) struct Stiffnesses {
    /// Along the branch.
    pub along_the_branch: Option<f64>,
    /// At a fixed contact area.
    pub fixed_area: Option<f64>,
    /// Largest relative error of the linear solves for them.
    pub solve_error: Option<f64>,
    /// Relative error of a difference quotient.
    pub quotient_error: Option<f64>,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

impl AdhesiveContact<'_> {
    /// The requested stiffnesses.
    pub(super) fn stiffness(
        &mut self,
        state: &Equilibrium,
        response: &Response,
        branch: Branch,
        stop: Stop<'_>,
    ) -> Stiffnesses {
        let mut found = Stiffnesses::default();
        if self.surface.is_full(&state.contact()) {
            return found;
        }
        let mut solved = |error: f64| found.solve_error = Some(found.solve_error.unwrap_or(0.0).max(error));
        if self.surface.outputs.needs_fixed_area() {
            let (problem, tolerance) = (&mut self.surface.problem, self.surface.options.tolerance);
            // A stopped state has no stiffness.
            if let Ok(Some(k)) = fixed_area(problem, self.attraction, state, tolerance, stop) {
                found.steps = k.steps;
                found.fixed_area = Some(k.k());
                solved(k.solve_error);
            }
        }
        if !self.surface.outputs.stiffness {
            return found;
        }
        if !self.attraction.moves_by_cells() {
            if let Some(k) = &response.stiffness {
                found.along_the_branch = Some(k.k());
                solved(k.solve_error);
            }
        } else if let Some((slope, error)) = self.quotient(state, branch, &mut found.steps, stop) {
            found.along_the_branch = Some(slope);
            found.quotient_error = Some(error);
        }
        found
    }

    /// The slope of the force in the plane along the branch, with its relative error; `None` where no branch
    /// goes on from the state.
    fn quotient(
        &mut self,
        state: &Equilibrium,
        branch: Branch,
        steps: &mut usize,
        stop: Stop<'_>,
    ) -> Option<(f64, f64)> {
        let shift = self.surface.problem.operators.table().shift();
        let begin = (state.plane(shift), state.force());
        let (mut at, (mut size, edges)) = (state.clone(), self.extent(state));
        if edges == 0 && state.attraction.iter().all(|s| *s <= 0.0) {
            return Some((0.0, 0.0));
        }
        // A round front has 8/(2 pi) edges of cells for each cell of its length. Of a contact few cells wide
        // the slope changes with less.
        let front = (edges as f64 * std::f64::consts::FRAC_PI_4).min(NARROW * size).max(f64::MIN_POSITIVE);
        let direction = if branch == Branch::Approach { 1.0 } else { -1.0 };
        let mut step = FIRST_STEP * self.attraction.law.range;
        let mut points = vec![(0.0, 0.0)];
        let (mut advanced, mut nearest) = (0.0, 1);
        while points.len() <= STEPS && (advanced < FAR_ENOUGH || points.len() <= FEWEST) {
            let plane = at.plane(shift) + direction * step;
            let found = self
                .search(AdhesiveControl::Plane(plane), Some((&at, LoadSequence::Path)), None, stop)
                .ok()?;
            *steps += found.equilibrium.steps;
            let (next, _) = self.extent(&found.equilibrium);
            // Where a zone stays, the contact may move in it.
            let (before, after) = (at.contact().len() as f64, found.equilibrium.contact().len() as f64);
            let advance =
                ((next - size).abs() / front).max((after - before).abs() / (NARROW * before).max(1.0));
            if found.status != Status::Converged || advance > JUMP {
                break;
            }
            at = found.equilibrium;
            (size, advanced) = (next, advanced + advance);
            nearest += usize::from(advanced < NEAREST);
            points.push((at.plane(shift) - begin.0, at.force() - begin.1));
            step *= if advance > 0.0 { (ADVANCE / advance).clamp(1.0 / ADAPT, ADAPT) } else { ADAPT };
        }
        let (slope, error) = first_slope(&points, (nearest + 1).max(4))?;
        (error <= CLAIMED * slope.abs()).then(|| (slope, error / slope.abs()))
    }

    /// The cells that attract with their attached shares, and the edges of their set.
    fn extent(&self, state: &Equilibrium) -> (f64, usize) {
        let attracting = self.attraction.attracting(&state.cells, &state.gap);
        let (cells, index, boundary) = self.surface.indexed(&attracting);
        (self.attraction.area(&attracting, &state.gap), surface_gen::boundary_edges(cells, &index, boundary))
    }
}

/// The slope at the first of some points on a curve with scatter, and its estimated error.
///
/// Parabolas of least squares go through more and more of the points, at least `fewest`: distant points
/// reduce the effect of the scatter, but add a bias from the terms beyond a parabola. The longest one is
/// taken whose slope agrees with those of all shorter ones within twice the standard errors of both (Lepski's
/// rule); the scatter is that around a cubic through all points.
fn first_slope(points: &[(f64, f64)], fewest: usize) -> Option<(f64, f64)> {
    if points.len() <= FEWEST {
        return None;
    }
    let scatter = Fit::new(points, 3)?.scatter;
    let mut slopes: Vec<(f64, f64)> = Vec::new();
    for count in fewest.min(points.len())..=points.len() {
        let fit = Fit::new(&points[..count], 2)?;
        let now = (fit.slope, 2.0 * scatter * fit.spread);
        if slopes.iter().any(|before| (before.0 - now.0).abs() > before.1 + now.1) {
            break;
        }
        slopes.push(now);
    }
    let (slope, error) = *slopes.last()?;
    // What shorter and longer ones find says how much a parabola leaves out.
    let next = Fit::new(&points[..(slopes.len() + fewest).min(points.len())], 2)?.slope;
    let drift = slopes.iter().map(|s| (s.0 - slope).abs()).fold((next - slope).abs(), f64::max);
    Some((slope, SMOOTH * (error + drift)))
}

/// A polynomial of least squares.
struct Fit {
    /// Slope at the first point.
    slope: f64,
    /// Standard error of the slope for a scatter of 1.
    spread: f64,
    /// Standard deviation of the points from it; 0 where it goes through all.
    scatter: f64,
}

impl Fit {
    /// `None` for points that are too few or coincide.
    fn new(points: &[(f64, f64)], degree: usize) -> Option<Self> {
        let unit = points.iter().map(|p| (p.0 - points[0].0).abs()).fold(0.0, f64::max);
        let n = degree + 1;
        if unit <= 0.0 || points.len() < n {
            return None;
        }
        let powers = |x: f64| -> Vec<f64> {
            let x = (x - points[0].0) / unit;
            std::iter::successors(Some(1.0), |power| Some(power * x)).take(n).collect()
        };
        // Normal equations of few well separated points, with one column more.
        let normal = |column: &dyn Fn(usize) -> f64| {
            let mut rows: Vec<Vec<f64>> = (0..n).map(|i| [vec![0.0; n], vec![column(i)]].concat()).collect();
            for &(x, _) in points {
                let powers = powers(x);
                for i in 0..n {
                    for j in 0..n {
                        rows[i][j] += powers[i] * powers[j];
                    }
                }
            }
            solved(rows)
        };
        let coefficients = normal(&|i| points.iter().map(|&(x, y)| powers(x)[i] * y).sum())?;
        let inverse = normal(&|i| if i == 1 { 1.0 } else { 0.0 })?;
        let left =
            |&(x, y): &(f64, f64)| y - powers(x).iter().zip(&coefficients).map(|(p, c)| p * c).sum::<f64>();
        let misfit: f64 = points.iter().map(|point| left(point).powi(2)).sum();
        let freedom = (points.len() - n).max(1) as f64;
        let (slope, spread) = (coefficients[1] / unit, inverse[1].max(0.0).sqrt() / unit);
        let fit = Self { slope, spread, scatter: (misfit / freedom).sqrt() };
        (slope.is_finite() && spread.is_finite()).then_some(fit)
    }
}

/// Gauss's elimination of a small symmetric system with its right-hand side as the last column; `None` where
/// it is singular.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k].abs() <= 0.0 || !rows[k][k].is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            let (above, below) = rows.split_at_mut(i);
            for (value, pivot) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                *value -= factor * pivot;
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][n] - known) / rows[k][k];
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_that_needs_its_rows_exchanged() {
        let rows = vec![vec![0.0, 2.0, 1.0, 7.0], vec![2.0, 1.0, 3.0, 13.0], vec![1.0, 3.0, 4.0, 19.0]];
        for (found, expected) in solved(rows).unwrap().iter().zip([1.0, 2.0, 3.0]) {
            approx::assert_relative_eq!(*found, expected, max_relative = 1e-14);
        }
        assert!(solved(vec![vec![0.0, 1.0]]).is_none());
    }
}
