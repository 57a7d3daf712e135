//! Contact that fills the grid: the same iteration on arrays over the whole grid instead of lists of cells.
//!
//! Lists cost a look-up a cell and a fresh allocation a step, as much as the transforms where most cells touch. Here every update runs
//! row by row in order, the vectors of the iteration are single precision, and nothing is allocated between loads.

pub mod cg;
mod extension;

use crate::active_set::{Ground, Guess, Limits, Look, Seen, Solved, Target};
use crate::candidates::Candidates;
use crate::cells::CellSet;
use crate::certificate::Evidence;
use crate::operator::Operators;
use crate::operator::convolution::Real;
use contact_model::{Status, Stop};

/// Arrays over the grid, kept from load to load.
#[derive(Debug, Default)]
pub struct Arrays {
    side: usize,
    /// Pressure, 0 outside the contact set; in the tangent problem q.
    pub p: Vec<f64>,
    /// Gap; in the tangent problem K q.
    pub gap: Vec<f64>,
    /// The best pressure so far.
    best: Vec<f64>,
    /// Vectors of conjugate gradients.
    pub vectors: cg::Vectors,
}

impl Arrays {
    /// Makes room for a grid.
    pub fn reserve(&mut self, side: usize) {
        let cells = side * side;
        if self.side != side {
            let vectors = cg::Vectors::new(side);
            *self = Self { side, p: vec![0.0; cells], gap: vec![0.0; cells], best: Vec::new(), vectors };
        }
    }

    /// Writes values on a set into an array of zeros.
    pub fn spread(set: &CellSet, values: &[f64], array: &mut [f64]) {
        array.fill(0.0);
        for (&i, &value) in set.index().iter().zip(values) {
            array[i as usize] = value;
        }
    }
}

/// One load on arrays.
pub struct Filled<'a> {
    candidates: &'a Candidates,
    operators: &'a mut Operators,
    arrays: &'a mut Arrays,
    target: Target,
    limits: Limits,
    d: f64,
    /// Root mean square and largest magnitude of the gap on contact cells.
    residual: f64,
}

impl<'a> Filled<'a> {
    /// Starts from a guess.
    pub fn new(
        candidates: &'a Candidates,
        operators: &'a mut Operators,
        arrays: &'a mut Arrays,
        target: Target,
        guess: &Guess,
        limits: Limits,
    ) -> Self {
        arrays.reserve(guess.set.side());
        Arrays::spread(&guess.set, &guess.p, &mut arrays.p);
        Self { candidates, operators, arrays, target, limits, d: guess.d, residual: 0.0 }
    }

    /// `gap = K p + z`; returns the mean of it weighted by the pressure and its minimum.
    fn displace(&mut self, rough: bool) -> (f64, f64) {
        let side = self.arrays.side;
        let (z, p, gap) = (self.candidates.z(), &self.arrays.p, &mut self.arrays.gap);
        let force: f64 = p.iter().sum();
        let (mut mean, mut lowest) = (0.0, f64::INFINITY);
        let row = |y: usize| y * side..(y + 1) * side;
        let mut finish = |y: usize, gap: &mut [f64]| {
            for ((gap, &z), &p) in gap.iter_mut().zip(&z[row(y)]).zip(&p[row(y)]) {
                *gap += z;
                lowest = gap.min(lowest);
                mean += p / force * *gap;
            }
        };
        if rough {
            let unit = f32::unit(p.iter().fold(0.0, |m: f64, &p| m.max(p)));
            let scale = unit.recip();
            self.operators.fast_rows(
                side,
                |y, out| {
                    for (out, &p) in out.iter_mut().zip(&p[row(y)]) {
                        *out = (p * scale) as f32;
                    }
                },
                |y, u| {
                    let gap = &mut gap[row(y)];
                    for (gap, &u) in gap.iter_mut().zip(u) {
                        *gap = f64::from(u) * unit;
                    }
                    finish(y, gap);
                },
            );
        } else {
            self.operators.exact_rows(
                side,
                |y, out| out.copy_from_slice(&p[row(y)]),
                |y, u| {
                    let gap = &mut gap[row(y)];
                    gap.copy_from_slice(u);
                    finish(y, gap);
                },
            );
        }
        (mean, lowest)
    }
}

impl Ground for Filled<'_> {
    fn look(&mut self, rough: bool) -> Seen {
        if let Target::Force(force) = self.target {
            crate::active_set::rescale(&mut self.arrays.p, force);
        }
        let (mean, lowest) = self.displace(rough);
        self.d = match self.target {
            Target::Force(_) => mean,
            Target::Approach(asked) => asked,
        };
        let (d, lowest) = (self.d, lowest - self.d);
        let s = self.limits.height.unwrap_or(d);
        let force: f64 = self.arrays.p.iter().sum();
        let (mut weighted, mut duality, mut square, mut count) = (0.0, 0.0, 0.0, 0.0);
        for (&p, gap) in self.arrays.p.iter().zip(&mut self.arrays.gap) {
            *gap -= d;
            if p > 0.0 {
                let share = p / force;
                weighted += share * gap.abs();
                duality += share * (*gap - lowest);
                square += (*gap / d).powi(2);
                count += 1.0;
            }
        }
        self.residual = if count > 0.0 { d * f64::sqrt(square / count) } else { 0.0 };
        let deepest = (-lowest).max(0.0);
        let evidence = Evidence {
            frank_wolfe: duality / s,
            penetration: deepest / s,
            complementarity: weighted / s,
            deepest,
        };
        // Every cell of the grid was looked at.
        Seen { evidence, complete: !rough, d, factored: false }
    }

    fn improve(&mut self, seen: Seen, steps: &mut usize, stop: Stop<'_>) {
        let noise = crate::active_set::NOISE * self.residual;
        let Arrays { p, gap, vectors, side, .. } = &mut *self.arrays;
        let mut unit = 0.0f64;
        for ((mask, &p), &gap) in vectors.mask.iter_mut().zip(&*p).zip(&*gap) {
            let inside = p > 0.0 || gap < -noise;
            *mask = f32::from(u8::from(inside));
            unit = unit.max(if inside { gap.abs() } else { 0.0 });
        }
        if unit <= 0.0 {
            return;
        }
        for ((r, &mask), &gap) in vectors.r.iter_mut().zip(&vectors.mask).zip(&*gap) {
            *r = mask * (-gap / unit) as f32;
        }
        let asked = crate::active_set::request(self.target, self.limits, seen);
        let request = cg::Request {
            fixed_sum: asked.fixed_sum,
            reduction: asked.reduction,
            energy: None,
            floor: asked.floor / unit,
            steps: asked.steps,
        };
        *steps += cg::correct(self.operators, *side, vectors, request, stop).steps;
        for ((p, &x), &mask) in p.iter_mut().zip(&vectors.x).zip(&vectors.mask) {
            *p = if mask > 0.0 { (*p + unit * f64::from(x)).max(0.0) } else { 0.0 };
        }
    }

    fn keep(&mut self) {
        self.arrays.best.clone_from(&self.arrays.p);
    }

    fn finish(mut self, status: Status, best: Option<Seen>, last: Seen, steps: usize) -> Solved {
        let mut seen = last;
        if best.is_some() {
            self.arrays.p.clone_from(&self.arrays.best);
            seen = self.look(false);
        }
        let side = self.arrays.side;
        let (p, gap) = (&self.arrays.p, &self.arrays.gap);
        let pick = |keep: &dyn Fn(usize) -> bool| {
            // Counted first: a list that grows by doubling costs twice the memory.
            let mut list = Vec::with_capacity((0..side * side).filter(|&i| keep(i)).count());
            list.extend((0..side * side).filter(|&i| keep(i)).map(|i| i as u32));
            CellSet::new(side, list)
        };
        // What the stiffness asks about: cells that press and cells that penetrate.
        let (checked, contact) = (pick(&|i| p[i] > 0.0 || gap[i] < 0.0), pick(&|i| p[i] > 0.0));
        let on = |set: &CellSet, values: &[f64]| {
            set.index().iter().map(|&i| values[i as usize]).collect::<Vec<_>>()
        };
        let look = Look { p: on(&checked, p), gap: on(&checked, gap), evidence: seen.evidence, checked };
        Solved { p: on(&contact, p), contact, d: seen.d, q: None, look, steps, status }
    }
}

#[cfg(test)]
mod looks;
