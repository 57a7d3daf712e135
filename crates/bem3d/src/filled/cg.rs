//! Preconditioned conjugate gradients on a mask over the whole grid, in single precision.

use super::extension::Extension;
use crate::cg::{Energy, TORUS};
use crate::operator::Operators;
use contact_model::Stop;
use std::cell::RefCell;

/// Accumulators side by side in a sum over a row: rounding stays far below that of the transform.
const LANES: usize = 16;

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
}

/// What a correction took and gained, in the units of the residual given.
#[derive(Debug, Clone, Copy)]
pub struct Done {
    /// Conjugate gradient steps.
    pub steps: usize,
    /// Estimated energy `r' K^-1 r` of the error at the beginning.
    pub start: f64,
}

/// Vectors over the grid, zero outside the mask.
#[derive(Debug, Default)]
pub struct Vectors {
    /// 1 on the set, 0 elsewhere.
    pub mask: Vec<f32>,
    /// Residual; in: right-hand side of magnitude about 1.
    pub r: Vec<f32>,
    /// Out: correction.
    pub x: Vec<f32>,
    t: Vec<f32>,
    kt: Vec<f32>,
    z: Vec<f32>,
    ones: Vec<f32>,
    extension: Extension,
}

impl Vectors {
    /// Vectors of zeros.
    pub fn new(side: usize) -> Self {
        let zeros = || vec![0.0; side * side];
        let (mask, r, x, t, kt, z, ones) = (zeros(), zeros(), zeros(), zeros(), zeros(), zeros(), zeros());
        Self { mask, r, x, t, kt, z, ones, extension: Extension::new(side) }
    }
}

/// The twin of [`crate::cg::correct`] for a set that fills the grid: updates run row by row inside the transforms.
///
/// Cost: one application of K and one of its inverse on a torus a step.
pub fn correct(
    operators: &mut Operators,
    side: usize,
    v: &mut Vectors,
    request: Request,
    stop: Stop<'_>,
) -> Done {
    operators.solves += 1;
    let row = |y: usize| y * side..(y + 1) * side;
    let Vectors { mask, r, x, t, kt, z, ones, extension } = v;
    x.fill(0.0);
    extension.set(side, mask);
    let mut total = 0.0;
    if request.fixed_sum {
        extension.clear();
        (0..side).for_each(|y| extension.add(y, &mask[row(y)]));
        precondition(operators, extension, side, mask, mask, ones, |_, m1| total += sum(m1));
    }
    let (mut steps, mut step, mut rz, mut gain) = (0, 0.0f32, 0.0, 0.0);
    let mut start = 0.0;
    loop {
        let (mut largest, mut r_z, mut sum_z, mut r_ones) = (0.0f32, 0.0, 0.0, 0.0);
        extension.clear();
        for y in 0..side {
            let r = &mut r[row(y)];
            if steps > 0 {
                add(&mut x[row(y)], step, &t[row(y)]);
                add(r, -step, &kt[row(y)]);
            }
            largest = largest.max(magnitude(r));
            extension.add(y, r);
        }
        precondition(operators, extension, side, mask, r, z, |y, z| {
            r_z += dot(&r[row(y)], z);
            if request.fixed_sum {
                sum_z += sum(z);
                r_ones += dot(&r[row(y)], &ones[row(y)]);
            }
        });
        let offset = if request.fixed_sum { sum_z / total } else { 0.0 };
        let next = r_z - offset * r_ones;
        if steps == 0 {
            start = next;
        }
        let reached = request.energy.is_some_and(|e| TORUS * next <= e.share * (e.base + gain))
            || (steps > 0 && next <= request.reduction * request.reduction * start)
            || f64::from(largest) <= request.floor;
        if reached || next.is_nan() || next <= 0.0 || steps >= request.steps || stop() {
            break;
        }
        let beta = if steps == 0 { 0.0 } else { (next / rz) as f32 };
        rz = next;
        let offset = offset as f32;
        for y in 0..side {
            advance(&mut t[row(y)], &z[row(y)], beta);
            if request.fixed_sum {
                add(&mut t[row(y)], -offset, &ones[row(y)]);
                add(&mut r[row(y)], -offset, &mask[row(y)]);
            }
        }
        let mut curvature = 0.0;
        operators.fast_rows(
            side,
            |y, out| out.copy_from_slice(&t[row(y)]),
            |y, u| {
                masked(&mut kt[row(y)], u, &mask[row(y)]);
                curvature += dot(&t[row(y)], &kt[row(y)]);
            },
        );
        if curvature.is_nan() || curvature <= 0.0 {
            break; // Below what single precision can resolve.
        }
        step = (rz / curvature) as f32;
        gain += rz * rz / curvature;
        steps += 1;
    }
    Done { steps, start }
}

/// `z = E' B E r`: the residual is extended into the gaps, the inverse of K on a torus is applied, and the transpose leads back.
///
/// The extension holds the sums of r over blocks; `done` sees each row of z once it is final.
fn precondition(
    operators: &mut Operators,
    extension: &mut Extension,
    side: usize,
    mask: &[f32],
    r: &[f32],
    z: &mut [f32],
    mut done: impl FnMut(usize, &[f32]),
) {
    let row = |y: usize| y * side..(y + 1) * side;
    extension.extend();
    let shared = RefCell::new(&mut *extension);
    operators.inverse_rows(
        side,
        |y, out| shared.borrow().fill(y, &r[row(y)], &mask[row(y)], out),
        |y, u| {
            let mut extension = shared.borrow_mut();
            if y == 0 {
                extension.clear(); // All rows have been filled.
            }
            extension.add_outside(y, u, &mask[row(y)]);
            z[row(y)].copy_from_slice(u);
        },
    );
    extension.collect();
    for y in 0..side {
        extension.take(y, &mut z[row(y)], &mask[row(y)]);
        done(y, &z[row(y)]);
    }
}

fn masked(out: &mut [f32], u: &[f32], mask: &[f32]) {
    for ((o, &u), &m) in out.iter_mut().zip(u).zip(mask) {
        *o = u * m;
    }
}

fn add(a: &mut [f32], factor: f32, b: &[f32]) {
    for (a, &b) in a.iter_mut().zip(b) {
        *a += factor * b;
    }
}

/// `t = z + beta t`; with beta = 0 whatever t held is gone.
fn advance(t: &mut [f32], z: &[f32], beta: f32) {
    if beta == 0.0 {
        return t.copy_from_slice(z);
    }
    for (t, &z) in t.iter_mut().zip(z) {
        *t = z + beta * *t;
    }
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    let (a, rest_a) = a.as_chunks::<LANES>();
    let (b, rest_b) = b.as_chunks::<LANES>();
    let mut lanes = [0.0f32; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((lane, a), b) in lanes.iter_mut().zip(a).zip(b) {
            *lane += a * b;
        }
    }
    let rest: f64 = rest_a.iter().zip(rest_b).map(|(&a, &b)| f64::from(a * b)).sum();
    lanes.iter().map(|&l| f64::from(l)).sum::<f64>() + rest
}

fn sum(a: &[f32]) -> f64 {
    let (a, rest) = a.as_chunks::<LANES>();
    let mut lanes = [0.0f32; LANES];
    for a in a {
        for (lane, a) in lanes.iter_mut().zip(a) {
            *lane += a;
        }
    }
    lanes.iter().chain(rest).map(|&l| f64::from(l)).sum()
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
