//! Preconditioned conjugate gradients on a set that fills the grid, in single precision.

use super::extension::Extension;
use super::runs::Runs;
use crate::cg::{Energy, TORUS};
use crate::operator::Operators;
use contact_model::Stop;
use std::cell::RefCell;

/// Accumulators side by side in a sum, and numbers that they take in before it goes on in double precision: rounding stays far below that
/// of the transform.
const LANES: usize = 16;
const BLOCK: usize = 2048;

/// What one call of [`correct`] is asked to do.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// Keep the sum of the correction at 0.
    pub fixed_sum: bool,
    /// Stop when the energy of the error has fallen by the square of this factor ...
    pub reduction: f64,
    /// ... or is below this share of the value that the equation is solved for ...
    pub energy: Option<Energy>,
    /// ... or the residual is below this value everywhere ...
    pub floor: f64,
    /// ... or after so many steps.
    pub steps: usize,
    /// Whether the kernel is exact at every lag, or only at most ([`Operators::correcting_rows`]).
    pub exact: bool,
}

/// What a correction took and gained, in the units of the residual given.
#[derive(Debug, Clone, Copy)]
pub struct Done {
    /// Conjugate gradient steps.
    pub steps: usize,
    /// Estimated energy `r' K^-1 r` of the error at the beginning.
    pub start: f64,
}

/// Vectors on a set, value after value.
#[derive(Debug, Default)]
pub struct Vectors {
    /// The set.
    pub set: Runs,
    /// Residual; in: right-hand side of magnitude about 1.
    pub r: Vec<f32>,
    /// Out: correction.
    pub x: Vec<f32>,
    t: Vec<f32>,
    kt: Vec<f32>,
    z: Vec<f32>,
    /// What the sum of a correction is taken from: about `K^-1 1`, found on the first set of a load and carried from set to set. Empty:
    /// not yet found.
    pub weights: Vec<f32>,
    /// The set before this one.
    last: Runs,
    extension: Extension,
    row: Vec<f32>,
}

impl Vectors {
    /// Room for a grid.
    pub fn new(side: usize) -> Self {
        let room = || Vec::with_capacity(side * side);
        Self {
            r: room(),
            x: room(),
            t: room(),
            kt: room(),
            z: room(),
            weights: room(),
            extension: Extension::new(side),
            row: vec![0.0; side],
            ..Self::default()
        }
    }

    /// Takes a new set, marked row by row; the right-hand side is zero.
    pub fn take(&mut self, side: usize, mark: impl FnMut(usize, &mut [bool])) {
        std::mem::swap(&mut self.set, &mut self.last);
        self.set.mark(side, mark);
        for vector in [&mut self.r, &mut self.x, &mut self.t, &mut self.kt, &mut self.z] {
            vector.clear();
            vector.resize(self.set.len(), 0.0);
        }
        if !self.weights.is_empty() {
            self.set.carry_to(&self.last, &self.weights, &mut self.z);
            std::mem::swap(&mut self.weights, &mut self.z);
            self.z.resize(self.set.len(), 0.0);
        }
        self.extension.set(&self.set);
    }

    /// The sum of the weights, which are found where there are none.
    fn weigh(&mut self, operators: &mut Operators) -> f64 {
        let total = sum(&self.weights);
        if total > 0.0 {
            return total;
        }
        let right = std::mem::replace(&mut self.r, vec![1.0; self.set.len()]);
        let (_, _, total) = self.precondition(operators, 0.0);
        self.r = right;
        self.weights.clone_from(&self.z);
        total
    }

    /// `z = E' B E r`: the residual is extended into the gaps, the inverse of K on a torus is applied, and the transpose leads back.
    ///
    /// `r` is lowered by `offset` first. Returns its largest magnitude, `r'z` and the sum of z.
    fn precondition(&mut self, operators: &mut Operators, offset: f32) -> (f32, f64, f64) {
        let Self { set, r, z, extension, row, .. } = self;
        let side = set.side();
        let mut largest = 0.0f32;
        extension.clear();
        for y in 0..side {
            let values = &mut r[set.span(y)];
            for r in values.iter_mut() {
                *r -= offset;
            }
            largest = largest.max(magnitude(values));
            row.fill(0.0);
            set.spread(y, r, row);
            extension.add(y, row);
        }
        extension.extend();
        let shared = RefCell::new(&mut *extension);
        operators.inverse_rows(
            side,
            |y, out| {
                shared.borrow().fill(y, out);
                set.spread(y, r, out);
            },
            |y, u| {
                let mut extension = shared.borrow_mut();
                if y == 0 {
                    extension.clear(); // All rows have been filled.
                }
                row.copy_from_slice(u);
                set.collect(y, u, z);
                set.fill(y, 0.0, row);
                extension.add_outside(y, row);
            },
        );
        extension.collect();
        let (mut product, mut total) = (0.0, 0.0);
        for y in 0..side {
            extension.take(y, row);
            set.add(y, row, z);
            product += dot(&r[set.span(y)], &z[set.span(y)]);
            total += sum(&z[set.span(y)]);
        }
        (largest, product, total)
    }

    /// `kt = K t` on the set; their product.
    fn apply(&mut self, operators: &mut Operators, exact: bool) -> f64 {
        let Self { set, t, kt, .. } = self;
        let mut curvature = 0.0;
        operators.correcting_rows(
            set.side(),
            exact,
            |y, out| set.spread(y, t, out),
            |y, u| {
                set.collect(y, u, kt);
                curvature += dot(&t[set.span(y)], &kt[set.span(y)]);
            },
        );
        curvature
    }
}

/// The twin of [`crate::cg::correct`] for a set that fills the grid: vectors go into the transforms row by row.
///
/// With `fixed_sum` the equation is solved on the corrections without a sum: with the weights w, the residual is `r - (w'r / w'1) 1` and
/// the preconditioned one `z - (1'z / 1'w) w`, which is symmetric and keeps the sum whatever the weights; `K^-1 1` is the best of them.
///
/// Cost: one application of K and one of its inverse on a torus a step.
pub fn correct(operators: &mut Operators, v: &mut Vectors, request: Request, stop: Stop<'_>) -> Done {
    operators.solves += 1;
    v.x.fill(0.0);
    let total = if request.fixed_sum { v.weigh(operators) } else { 0.0 };
    let (mut steps, mut step, mut rz, mut gain) = (0, 0.0f32, 0.0, 0.0);
    let (mut start, mut rate, mut pending) = (0.0, 1.0, false);
    loop {
        let Vectors { r, kt, weights, .. } = &mut *v;
        if steps > 0 {
            add(r, -step, kt);
        }
        let offset = if request.fixed_sum { (dot(weights, r) / total) as f32 } else { 0.0 };
        // Without a product of r and the weights, the part of z along them adds nothing to r'z.
        let (largest, next, excess) = v.precondition(operators, offset);
        if steps == 0 {
            start = next;
        }
        let reached = request.energy.is_some_and(|e| TORUS * next <= e.share * (e.base + gain))
            || (steps > 0 && next <= request.reduction * request.reduction * start)
            || f64::from(largest) <= request.floor;
        if reached || next.is_nan() || next <= 0.0 || steps >= request.steps || stop() {
            break;
        }
        if steps > 0 {
            rate = next / rz;
        }
        let beta = if steps == 0 { 0.0 } else { rate as f32 };
        rz = next;
        let Vectors { x, t, z, weights, .. } = &mut *v;
        advance(x, step, t, beta, z);
        if request.fixed_sum {
            add(t, -(excess / total) as f32, weights);
        }
        pending = false;
        let curvature = v.apply(operators, request.exact);
        if curvature.is_nan() || curvature <= 0.0 {
            break; // Below what single precision can resolve.
        }
        step = (rz / curvature) as f32;
        gain += rz * rz / curvature;
        steps += 1;
        pending = true;
        // Where the next step is as good as the last one, nobody needs to know the rest.
        if rz * rate <= request.reduction * request.reduction * start
            || request.energy.is_some_and(|e| TORUS * rz * rate <= e.share * (e.base + gain))
        {
            break;
        }
    }
    if pending {
        add(&mut v.x, step, &v.t);
    }
    Done { steps, start }
}

fn add(a: &mut [f32], factor: f32, b: &[f32]) {
    for (a, &b) in a.iter_mut().zip(b) {
        *a += factor * b;
    }
}

/// `x += step t`, then `t = z + beta t`: each is read once.
fn advance(x: &mut [f32], step: f32, t: &mut [f32], beta: f32, z: &[f32]) {
    for ((x, t), &z) in x.iter_mut().zip(t).zip(z) {
        *x += step * *t;
        *t = z + beta * *t;
    }
}

/// A sum in double precision over blocks in single precision.
fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.chunks(BLOCK).zip(b.chunks(BLOCK)).map(|(a, b)| f64::from(lanes(a, b))).sum()
}

fn lanes(a: &[f32], b: &[f32]) -> f32 {
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut lanes = [0.0f32; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    lanes.iter().sum::<f32>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f32>()
}

fn sum(a: &[f32]) -> f64 {
    let block = |a: &[f32]| {
        let (a, rest) = a.as_chunks::<LANES>();
        let mut lanes = [0.0f32; LANES];
        for a in a {
            for (lane, a) in lanes.iter_mut().zip(a) {
                *lane += a;
            }
        }
        lanes.iter().chain(rest).map(|&l| f64::from(l)).sum::<f64>()
    };
    a.chunks(BLOCK).map(block).sum()
}

fn magnitude(a: &[f32]) -> f32 {
    let (a, rest) = a.as_chunks::<LANES>();
    let mut lanes = [0.0f32; LANES];
    for a in a {
        for (lane, a) in lanes.iter_mut().zip(a) {
            *lane = lane.max(a.abs());
        }
    }
    lanes.iter().chain(rest).fold(0.0, |m, a| m.max(a.abs()))
}

#[cfg(test)]
mod stops;
