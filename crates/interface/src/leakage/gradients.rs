//! Conjugate gradients, whose solution is held in more than double precision.

use super::graph::Graph;
use super::vectors::{combine, dot};
use contact_model::{Result, Stop, check_stop};

/// Steps of one round at most; a round ends as well where rounding stops its progress.
const LARGEST_STEPS: usize = 200;
/// Steps without a smaller residual after which a round ends.
const PATIENCE: usize = 20;

/// Potentials as unevaluated sums of two numbers: in a wide pool behind a narrow constriction, potentials
/// differ by less than the rounding of one.
#[derive(Debug, Clone, Default)]
pub(super) struct Potential {
    pub high: Vec<f64>,
    pub low: Vec<f64>,
}

/// The exact difference `a - b` of two numbers as a sum of two numbers (Knuth).
#[inline]
fn exact_difference(a: f64, b: f64) -> (f64, f64) {
    let difference = a - b;
    let from_b = difference - a;
    (difference, (a - (difference - from_b)) - (b + from_b))
}

impl Potential {
    pub fn zero(nodes: usize) -> Self {
        Self { high: vec![0.0; nodes], low: vec![0.0; nodes] }
    }

    /// Potential of a node above that of another one, rounded once.
    #[inline]
    pub fn above(&self, node: usize, other: usize) -> f64 {
        let (high, rest) = exact_difference(self.high[node], self.high[other]);
        high + (rest + (self.low[node] - self.low[other]))
    }

    /// Potential of a node above a known one.
    pub fn above_known(&self, node: usize, known: f64) -> f64 {
        let (high, rest) = exact_difference(self.high[node], known);
        high + (rest + self.low[node])
    }

    /// Adds a correction.
    pub fn add(&mut self, correction: &[f64]) {
        for ((high, low), &correction) in self.high.iter_mut().zip(&mut self.low).zip(correction) {
            let (sum, rest) = exact_difference(*high, -correction);
            let rest = rest + *low;
            *high = sum + rest;
            *low = exact_difference(sum, *high).0 + rest;
        }
    }
}

/// An approximate solution, and the steps that it took.
#[derive(Debug)]
pub(super) struct SolvedPotential {
    pub x: Vec<f64>,
    pub steps: usize,
}

/// Solves `A x = right` by flexible conjugate gradients until `r' M r` is `reduction` of what it was;
/// `precondition` writes `M r` of a residual r.
///
/// The directions are made conjugate to the last one explicitly, because the preconditioner is not exactly
/// linear (Notay, SIAM J. Sci. Comput. 22, 1444 (2000)).
///
/// # Errors
/// [`contact_model::Error::Stopped`].
pub(super) fn solve(
    graph: &Graph,
    mut precondition: impl FnMut(&[f64], &mut [f64]),
    right: Vec<f64>,
    reduction: f64,
    stop: Stop<'_>,
) -> Result<SolvedPotential> {
    let nodes = graph.nodes();
    let mut residual = right;
    let (mut z, mut direction, mut current) = (vec![0.0; nodes], vec![0.0; nodes], vec![0.0; nodes]);
    let mut solution = SolvedPotential { x: vec![0.0; nodes], steps: 0 };
    let (mut start, mut least, mut since) = (0.0, f64::INFINITY, 0);
    let mut energy = 0.0;
    for step in 0..LARGEST_STEPS {
        check_stop(stop)?;
        precondition(&residual, &mut z);
        let product = dot(&residual, &z);
        if step == 0 {
            start = product;
        }
        stop.residual((product.max(0.0) / start).sqrt(), reduction.sqrt());
        if product < 0.5 * least {
            (least, since) = (product, 0);
        } else {
            since += 1;
        }
        if product.is_nan() || product <= reduction * start || since > PATIENCE {
            return Ok(solution);
        }
        let share = if step == 0 { 0.0 } else { -dot(&z, &current) / energy };
        combine(&mut direction, share, 1.0, &z);
        graph.multiply(&direction, &mut current);
        energy = dot(&direction, &current);
        if energy.is_nan() || energy <= 0.0 {
            return Ok(solution);
        }
        let length = dot(&direction, &residual) / energy;
        combine(&mut solution.x, 1.0, length, &direction);
        solution.steps += 1;
        combine(&mut residual, 1.0, -length, &current);
    }
    Ok(solution)
}
