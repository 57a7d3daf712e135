//! The fall-back for kernels that bulge: an interior-point method, which no contact set guides.

use crate::geometry::CellSet;
use crate::operator::Operators;
use crate::real::{dot, sum, sum_of_pairs, update};
use contact_model::{Interrupted, Stop};

/// Largest number of Newton steps; 30 to 60 are usual.
const STEPS: usize = 120;
/// Largest number of conjugate gradients in each.
const INNER_STEPS: usize = 300;
/// Reduction of the residual in each: tighter ones need fewer Newton steps and more applications.
const REDUCTION: f64 = 0.1;
/// Share of the way to the nearest bound.
const NEAR_A_BOUND: f64 = 0.995;
/// The product of pressure and gap that a step aims at over their mean, after a step of more than a share ...
const CENTRING: [(f64, f64); 2] = [(0.9, 0.1), (0.5, 0.3)];
/// ... and after a shorter one.
const SLOWEST: f64 = 0.7;

/// A contact problem on the cells that may touch.
#[derive(Debug)]
pub struct InteriorProblem<'a> {
    /// The operators.
    pub operators: &'a mut Operators,
    /// The cells.
    pub cells: &'a CellSet,
    /// Their undeformed gaps.
    pub z: &'a [f64],
    /// The sum of the pressures, where it is prescribed.
    pub force: Option<f64>,
    /// The approach, which the solution changes where the force is prescribed.
    pub approach: f64,
    /// The mean work of pressure and gap, and the largest error of a gap, at which the method ends; as lengths, the
    /// first one over the mean pressure.
    pub enough: f64,
}

/// A pressure that is positive everywhere.
#[derive(Debug)]
pub struct InteriorPressure {
    /// The pressure on all cells.
    pub p: Vec<f64>,
    /// The gap on all cells; it is positive too.
    pub gap: Vec<f64>,
    /// The approach.
    pub approach: f64,
    /// Steps of conjugate gradients.
    pub steps: usize,
}

/// A Newton step, and what it left of the equations.
struct InteriorStep {
    p: Vec<f64>,
    displacement: Vec<f64>,
    approach: f64,
    iterations: usize,
}

impl InteriorProblem<'_> {
    /// Solves `g = Kp + z - d` and `p g = mu` with positive p and g, for a mu that falls towards zero, from the
    /// given mean pressure on all cells. `None` where rounding ends it.
    ///
    /// Each step is one of Newton's method, taken to near the first bound: with `D = g/p` it solves
    /// `(K + D) dp - dd = mu/p - (Kp + z - d)`. This is the primal-dual method (S. J. Wright, Primal-Dual
    /// Interior-Point Methods, SIAM 1997, chapter 5), with linear systems solved by conjugate gradients to one
    /// digit. What they leave is an error of the gap, which the next step corrects.
    ///
    /// An iteration over contact sets decides on each cell at once, and on a stiff plate a wrong decision bends
    /// all cells around. Here pressures and gaps become small slowly and together.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    ///
    /// Cost: 100 to 3000 applications of K in double precision.
    pub fn solve(
        mut self,
        mean_pressure: f64,
        stop: Stop<'_>,
    ) -> Result<Option<InteriorPressure>, Interrupted> {
        let n = self.cells.len();
        let mut p = vec![self.force.map_or(mean_pressure, |force| force / n as f64); n];
        let mut displaced = Vec::new();
        self.operators.exact(self.cells, &p, self.cells, &mut displaced, stop)?;
        update(&mut displaced, self.z, |u, z| *u += z);
        let mut d = if self.force.is_some() { sum(&displaced) / n as f64 } else { self.approach };
        let size = (sum_of_pairs(&displaced, &displaced, |u, _| (u - d).powi(2)) / n as f64).sqrt();
        let mut gap: Vec<f64> = displaced.iter().map(|u| (u - d).max(size)).collect();
        let (mut share, mut steps) = (1.0, 0);
        for _ in 0..STEPS {
            let (work, mean) = (dot(&p, &gap) / n as f64, sum(&p) / n as f64);
            let error =
                displaced.iter().zip(&gap).fold(0.0, |most: f64, (u, gap)| most.max((u - d - gap).abs()));
            if work <= self.enough * mean && error <= self.enough {
                break;
            }
            let centring = CENTRING.iter().find(|(least, _)| share > *least).map_or(SLOWEST, |(_, aim)| *aim);
            let aim = centring * work;
            let stiffness: Vec<f64> = gap.iter().zip(&p).map(|(gap, p)| gap / p).collect();
            let right = displaced.iter().zip(&p).map(|(u, p)| aim / p - (u - d)).collect();
            let step = self.newton_step(&stiffness, right, stop)?;
            steps += step.iterations;
            let opening: Vec<f64> = (0..n).map(|i| aim / p[i] - gap[i] - stiffness[i] * step.p[i]).collect();
            share = (NEAR_A_BOUND * room(&p, &step.p).min(room(&gap, &opening))).min(1.0);
            if share.is_nan() || share <= 0.0 {
                return Ok(None);
            }
            update(&mut p, &step.p, |p, change| *p += share * change);
            update(&mut gap, &opening, |gap, change| *gap += share * change);
            update(&mut displaced, &step.displacement, |u, change| *u += share * change);
            d += share * step.approach;
        }
        Ok(Some(InteriorPressure { p, gap, approach: d, steps }))
    }

    /// Solves `(K + D) x - a = r` to one digit by conjugate gradients. Where the force is prescribed, the sum of x
    /// is zero and a is found with it; otherwise a is zero.
    fn newton_step(
        &mut self,
        stiffness: &[f64],
        mut r: Vec<f64>,
        stop: Stop<'_>,
    ) -> Result<InteriorStep, Interrupted> {
        let Self { operators, cells, force, .. } = self;
        let (cells, n) = (*cells, r.len());
        let mut metric = InteriorMetric::new(operators.table().own(), stiffness);
        if force.is_some() {
            metric.balance(operators, cells, stop)?;
        }
        let (mut x, mut displacement) = (vec![0.0; n], vec![0.0; n]);
        let (mut z, mut u) = (vec![0.0; n], Vec::new());
        metric.apply(operators, cells, &r, &mut z, stop)?;
        let mut t = z.clone();
        let mut product = dot(&r, &z);
        let (first, mut iterations) = (product, 0);
        while product > REDUCTION.powi(2) * first && iterations < INNER_STEPS {
            operators.exact(cells, &t, cells, &mut u, stop)?;
            let mut yielded = t.clone();
            update(&mut yielded, stiffness, |t, d| *t *= d);
            let length = product / (dot(&t, &u) + dot(&t, &yielded));
            if !(length > 0.0 && length.is_finite()) {
                break;
            }
            update(&mut x, &t, |x, t| *x += length * t);
            update(&mut displacement, &u, |all, u| *all += length * u);
            update(&mut r, &u, |r, u| *r -= length * u);
            update(&mut r, &yielded, |r, u| *r -= length * u);
            metric.apply(operators, cells, &r, &mut z, stop)?;
            let next = dot(&r, &z);
            let beta = next / product;
            update(&mut t, &z, |t, z| *t = z + beta * *t);
            product = next;
            iterations += 1;
        }
        let approach = if force.is_some() { -metric.mean(&r) } else { 0.0 };
        Ok(InteriorStep { p: x, displacement, approach, iterations })
    }
}

/// The largest multiple of a change that leaves positive values positive.
fn room(values: &[f64], change: &[f64]) -> f64 {
    values.iter().zip(change).fold(f64::INFINITY, |least, (value, change)| {
        // A NaN remains.
        if *change >= 0.0 || least.is_nan() { least } else { (-value / change).min(least) }
    })
}

/// The preconditioner of `K + D`: the inverse of K on a torus where D is small, as on cells in contact, and that of D
/// where it is large. It is `T B T + (1 - T)^2/(D + K_00)` with `T = 1/(1 + (D/K_00)^2)`.
struct InteriorMetric {
    inside: Vec<f64>,
    outside: Vec<f64>,
    buffer: Vec<f64>,
    /// The preconditioned constant and its sum, where the sum of the solution is zero.
    weights: Option<(Vec<f64>, f64)>,
}

impl InteriorMetric {
    fn new(own: f64, stiffness: &[f64]) -> Self {
        let inside: Vec<f64> = stiffness.iter().map(|d| 1.0 / (1.0 + (d / own).powi(2))).collect();
        let outside = stiffness.iter().zip(&inside).map(|(d, t)| (1.0 - t).powi(2) / (d + own)).collect();
        Self { inside, outside, buffer: Vec::new(), weights: None }
    }

    /// Keeps sums zero from here on.
    fn balance(
        &mut self,
        operators: &mut Operators,
        cells: &CellSet,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let ones = vec![1.0; cells.len()];
        let mut weights = vec![0.0; cells.len()];
        self.apply(operators, cells, &ones, &mut weights, stop)?;
        let total = sum(&weights);
        self.weights = Some((weights, total));
        Ok(())
    }

    fn apply(
        &mut self,
        operators: &mut Operators,
        cells: &CellSet,
        r: &[f64],
        z: &mut [f64],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { inside, outside, buffer, weights } = self;
        buffer.clear();
        buffer.extend_from_slice(r);
        update(buffer, inside, |r, t| *r *= t);
        operators.torus_inverse(cells, buffer, z, stop)?;
        update(z, inside, |z, t| *z *= t);
        buffer.copy_from_slice(r);
        update(buffer, outside, |r, t| *r *= t);
        update(z, buffer, |z, r| *z += r);
        if let Some((weights, total)) = weights {
            let by = sum(z) / *total;
            update(z, weights, |z, weight| *z -= by * weight);
        }
        Ok(())
    }

    /// The mean in which a constant part of a residual shows.
    fn mean(&self, r: &[f64]) -> f64 {
        self.weights.as_ref().map_or(0.0, |(weights, total)| dot(weights, r) / total)
    }
}

#[cfg(test)]
mod tests;
