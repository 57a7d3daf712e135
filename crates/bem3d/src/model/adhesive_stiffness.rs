//! The stiffnesses of a state with adhesion: along the branch, and of its contact area held.
//!
//! An exponential attraction moves with the gaps, and its linearised equations have the stiffness. Fronts of a short range and the edges of
//! Dugdale's zones move by whole cells: between two moves the force follows the gaps as if they were held, 1.4 to 1.8 times too stiff
//! however small the cells. There the stiffness is a difference quotient: the state is followed along its branch until its fronts have moved
//! by two cells, and a parabola through the states found has its slope at the first one.

use super::adhesive::AdhesiveContact;
use crate::adhesion::{Control, Equilibrium, Response, fixed_area};
use contact_model::{Branch, Status, Stop};

/// The first step of the plane, in ranges of the law.
const FIRST_STEP: f64 = 0.2;
/// Fronts advance in a step by about this many cells ...
const ADVANCE: f64 = 0.5;
/// ... and until they have advanced by so many in all.
const FAR_ENOUGH: f64 = 2.5;
/// A step grows or shrinks at most by this factor from one to the next.
const ADAPT: f64 = 4.0;
/// Steps at most, and at least for a parabola.
const STEPS: usize = 9;
const FEWEST: usize = 3;
/// A step in which fronts advance by more than so many cells is a jump, which has no slope.
const JUMP: f64 = 4.0;
/// A slope with a larger relative error is not claimed.
const CLAIMED: f64 = 0.5;

/// Stiffnesses of a state, nondimensional over pi.
#[derive(Debug, Default)]
pub(super) struct Stiffnesses {
    /// Along the branch.
    pub along_the_branch: Option<f64>,
    /// Of the contact area held.
    pub fixed_area: Option<f64>,
    /// Largest relative error of the linear solves for them.
    pub solve_error: Option<f64>,
    /// Relative error of a difference quotient.
    pub quotient_error: Option<f64>,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

impl AdhesiveContact {
    /// The stiffnesses that are asked for.
    pub(super) fn stiffness(
        &mut self,
        state: &Equilibrium,
        response: &Response,
        branch: Branch,
        stop: Stop<'_>,
    ) -> Stiffnesses {
        let mut found = Stiffnesses::default();
        let mut solved = |error: f64| found.solve_error = Some(found.solve_error.unwrap_or(0.0).max(error));
        if self.inner.outputs.needs_fixed_area() {
            let (problem, tolerance) = (&mut self.inner.problem, self.inner.options.tolerance);
            let (slope, steps) = fixed_area(problem, &self.attraction, state, tolerance, stop);
            found.steps = steps;
            found.fixed_area = slope.map(|slope| slope.value);
            if let Some(slope) = slope {
                solved(slope.relative_error());
            }
        }
        if !self.inner.outputs.stiffness {
            return found;
        }
        if !self.attraction.moves_by_cells() {
            found.along_the_branch = response.stiffness.map(|slope| slope.value);
            if let Some(slope) = response.stiffness {
                solved(slope.relative_error());
            }
        } else if let Some((slope, error)) = self.quotient(state, branch, &mut found.steps, stop) {
            found.along_the_branch = Some(slope);
            found.quotient_error = Some(error);
        }
        found
    }

    /// The slope of the force in the plane along the branch, with its relative error; `None` where no branch goes on from the state.
    fn quotient(
        &mut self,
        state: &Equilibrium,
        branch: Branch,
        steps: &mut usize,
        stop: Stop<'_>,
    ) -> Option<(f64, f64)> {
        let shift = self.inner.problem.operators.table().shift();
        let begin = (state.plane(shift), state.force());
        let (mut at, (mut size, edges)) = (state.clone(), self.extent(state));
        if edges == 0 && state.attraction.iter().all(|s| *s <= 0.0) {
            return Some((0.0, 0.0));
        }
        // A round front has 8/(2 pi) edges of cells for each cell of its length.
        let front = (edges as f64 * std::f64::consts::FRAC_PI_4).max(1.0);
        let direction = if branch == Branch::Approach { 1.0 } else { -1.0 };
        let mut step = FIRST_STEP * self.attraction.law.range;
        let mut points = vec![(0.0, 0.0)];
        let mut advanced = 0.0;
        while points.len() <= STEPS && (advanced < FAR_ENOUGH || points.len() <= FEWEST) {
            let plane = at.plane(shift) + direction * step;
            let found = self.search(Control::Plane(plane), Some(&at), None, stop).ok()?;
            *steps += found.equilibrium.steps;
            let (next, _) = self.extent(&found.equilibrium);
            let advance = (next - size).abs() / front;
            if found.status != Status::Converged || advance > JUMP {
                break;
            }
            at = found.equilibrium;
            (size, advanced) = (next, advanced + advance);
            points.push((at.plane(shift) - begin.0, at.force() - begin.1));
            step *= if advance > 0.0 { (ADVANCE / advance).clamp(1.0 / ADAPT, ADAPT) } else { ADAPT };
        }
        let (slope, error) = first_slope(&points)?;
        (error <= CLAIMED * slope.abs()).then(|| (slope, error / slope.abs()))
    }

    /// Cells that attract, with the shares that are attached, and the edges of their set.
    fn extent(&self, state: &Equilibrium) -> (f64, usize) {
        let attracting = self.attraction.attracting(&state.cells, &state.gap);
        let (cells, index, boundary) = self.inner.indexed(&attracting);
        (self.attraction.area(&attracting, &state.gap), surface_gen::boundary_edges(cells, &index, boundary))
    }
}

/// The slope at the first of some points on a curve, from the parabola of least squares, and its estimated error: that of the fit, twice
/// its standard error, and the curvature that a cubic would add.
fn first_slope(points: &[(f64, f64)]) -> Option<(f64, f64)> {
    if points.len() <= FEWEST {
        return None;
    }
    let (slope, error) = fitted(points, 2)?;
    let (other, _) = fitted(points, if points.len() > FEWEST + 2 { 3 } else { 1 })?;
    Some((slope, (2.0 * error).max(0.5 * (slope - other).abs())))
}

/// Slope at the first point of a polynomial of least squares, and its standard error.
fn fitted(points: &[(f64, f64)], degree: usize) -> Option<(f64, f64)> {
    let unit = points.iter().map(|p| (p.0 - points[0].0).abs()).fold(0.0, f64::max);
    if unit <= 0.0 || points.len() <= degree + 1 {
        return None;
    }
    let n = degree + 1;
    let powers = |x: f64| (0..n).map(|k| ((x - points[0].0) / unit).powi(k as i32)).collect::<Vec<f64>>();
    // Normal equations: few well separated points, of low degree.
    let mut rows = vec![vec![0.0; 2 * n + 1]; n];
    for &(x, y) in points {
        let powers = powers(x);
        for i in 0..n {
            for j in 0..n {
                rows[i][j] += powers[i] * powers[j];
            }
            rows[i][2 * n] += powers[i] * y;
        }
    }
    for (i, row) in rows.iter_mut().enumerate() {
        row[n + i] = 1.0;
    }
    for k in 0..n {
        let pivot = rows[k][k];
        if pivot <= 0.0 {
            return None;
        }
        rows[k].iter_mut().for_each(|v| *v /= pivot);
        let base = rows[k].clone();
        for (i, row) in rows.iter_mut().enumerate().filter(|(i, _)| *i != k) {
            let factor = row[k];
            row.iter_mut().zip(&base).for_each(|(v, b)| *v -= factor * b);
            debug_assert!(i != k);
        }
    }
    let coefficients: Vec<f64> = rows.iter().map(|row| row[2 * n]).collect();
    let misfit: f64 = (points.iter())
        .map(|&(x, y)| {
            let fit: f64 = powers(x).iter().zip(&coefficients).map(|(p, c)| p * c).sum();
            (y - fit).powi(2)
        })
        .sum();
    let variance = misfit / (points.len() - n) as f64 * rows[1][n + 1];
    Some((coefficients[1] / unit, variance.max(0.0).sqrt() / unit))
}
