//! Contact that fills the grid: the same iteration on runs of cells instead of lists.
//!
//! Lists cost a look-up a cell and a fresh allocation a step, as much as the transforms where many cells touch. Here vectors on the contact
//! are copied into the rows of the transforms run by run, those of the iteration are single precision, and of the rest of the grid nothing
//! is kept but the gap.

pub mod cg;
mod extension;
pub mod runs;

use crate::active_set::{Ground, Guess, Limits, Look, Seen, Solved, Target};
use crate::candidates::Candidates;
use crate::certificate::Evidence;
use crate::margin::Margin;
use crate::operator::Operators;
use crate::operator::convolution::Real;
use contact_model::{Status, Stop};
use runs::Runs;

/// Accumulators side by side in a minimum over a row.
const LANES: usize = 8;

/// Room for one load, kept from load to load.
#[derive(Debug, Default)]
pub struct Arrays {
    side: usize,
    /// `u + z` less a reference near the approach, on the whole grid.
    gap: Vec<f32>,
    /// What goes with it, where it is that of a finished state.
    pub left: Option<Left>,
    /// Vectors of conjugate gradients.
    pub vectors: cg::Vectors,
}

/// What the gap of a finished state was counted from, and its root mean square on contact cells.
#[derive(Debug, Clone, Copy)]
pub struct Left {
    reference: f64,
    residual: f64,
}

impl Arrays {
    /// Makes room for a grid.
    pub fn reserve(&mut self, side: usize) {
        if self.side != side {
            *self = Self { side, gap: vec![0.0; side * side], left: None, vectors: cg::Vectors::new(side) };
        }
        self.vectors.weights.clear();
    }
}

/// One load on runs.
pub struct Filled<'a> {
    candidates: &'a Candidates,
    operators: &'a mut Operators,
    arrays: &'a mut Arrays,
    target: Target,
    limits: Limits,
    /// The contact set, positive pressure on it, and `u + z` there.
    now: Pressed,
    lifted: Vec<f64>,
    /// The best pressure so far, unless it is the present one.
    best: Pressed,
    now_is_best: bool,
    d: f64,
    /// What the gap is counted from.
    reference: f64,
    /// Root mean square of the gap on contact cells.
    residual: f64,
}

/// Positive pressure on a set.
#[derive(Debug, Default)]
struct Pressed {
    set: Runs,
    p: Vec<f64>,
}

impl Pressed {
    /// Takes the cells with positive pressure of a set.
    fn take(&mut self, set: &Runs, p: &[f64]) {
        self.set.positive(set, p);
        self.p.clear();
        self.p.reserve(self.set.len());
        self.p.extend(p.iter().filter(|&&p| p > 0.0));
    }
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
        let mut now = Pressed::default();
        now.take(&Runs::of(&guess.set), &guess.p);
        Self {
            candidates,
            operators,
            arrays,
            target,
            limits,
            now,
            lifted: Vec::new(),
            best: Pressed::default(),
            now_is_best: false,
            d: guess.d,
            reference: guess.d,
            residual: 0.0,
        }
    }

    /// Goes on from the state that these arrays hold the gap of.
    pub fn resumed(
        candidates: &'a Candidates,
        operators: &'a mut Operators,
        arrays: &'a mut Arrays,
        target: Target,
        (solved, left): (&Solved, Left),
        limits: Limits,
    ) -> Self {
        let guess = Guess { set: solved.contact.clone(), p: solved.p.clone(), d: solved.d, far: false };
        let Left { reference, residual } = left;
        Self { reference, residual, ..Self::new(candidates, operators, arrays, target, &guess, limits) }
    }

    /// `u + z` everywhere; returns the mean of it weighted by the pressure and its minimum.
    fn displace(&mut self, force: f64, rough: bool) -> (f64, f64) {
        let (side, reference) = (self.arrays.side, self.reference);
        let (z, Pressed { set, p }, gap) = (self.candidates.z(), &self.now, &mut self.arrays.gap);
        let (lifted, mut row) = (&mut self.lifted, vec![0.0; side]);
        lifted.resize(p.len(), 0.0);
        let (mut mean, mut lowest) = (0.0, f64::INFINITY);
        // `row` holds the displacement of row y.
        let mut finish = |y: usize, row: &mut [f64]| {
            let cells = y * side..(y + 1) * side;
            for (value, z) in row.iter_mut().zip(&z[cells.clone()]) {
                *value += z;
            }
            lowest = minimum(row).min(lowest);
            set.collect(y, row, lifted);
            let values = set.span(y);
            mean += p[values.clone()].iter().zip(&lifted[values]).map(|(p, v)| p / force * v).sum::<f64>();
            for (gap, value) in gap[cells].iter_mut().zip(&*row) {
                *gap = (value - reference) as f32;
            }
        };
        if rough {
            let unit = f32::unit(p.iter().fold(0.0, |m: f64, &p| m.max(p)));
            let scale = unit.recip();
            let single: Vec<f32> = p.iter().map(|p| (p * scale) as f32).collect();
            self.operators.fast_rows(
                side,
                |y, out| set.spread(y, &single, out),
                |y, u| {
                    for (value, &u) in row.iter_mut().zip(u) {
                        *value = f64::from(u) * unit;
                    }
                    finish(y, &mut row);
                },
            );
        } else {
            self.operators.exact_rows(
                side,
                |y, out| set.spread(y, p, out),
                |y, u| {
                    row.copy_from_slice(u);
                    finish(y, &mut row);
                },
            );
        }
        (mean, lowest)
    }
}

/// Smallest number of a row.
fn minimum(row: &[f64]) -> f64 {
    let (chunks, rest) = row.as_chunks::<LANES>();
    let mut lanes = [f64::INFINITY; LANES];
    for chunk in chunks {
        for (lane, &value) in lanes.iter_mut().zip(chunk) {
            *lane = if value < *lane { value } else { *lane };
        }
    }
    lanes.iter().chain(rest).fold(f64::INFINITY, |m, &v| m.min(v))
}

impl Ground for Filled<'_> {
    fn look(&mut self, rough: bool) -> Seen {
        if let Target::Force(force) = self.target {
            crate::active_set::rescale(&mut self.now.p, force);
        }
        let force: f64 = self.now.p.iter().sum();
        self.reference = self.d;
        let (mean, lowest) = self.displace(force, rough);
        self.d = match self.target {
            Target::Force(_) => mean,
            Target::Approach(asked) => asked,
        };
        let (d, lowest) = (self.d, lowest - self.d);
        let s = self.limits.height.unwrap_or(d);
        let (mut weighted, mut duality, mut square) = (0.0, 0.0, 0.0);
        for (&p, lifted) in self.now.p.iter().zip(&self.lifted) {
            let (share, gap) = (p / force, lifted - d);
            weighted += share * gap.abs();
            duality += share * (gap - lowest);
            square += (gap / d).powi(2);
        }
        let count = self.now.p.len();
        self.residual = if count > 0 { d * f64::sqrt(square / count as f64) } else { 0.0 };
        let deepest = (-lowest).max(0.0);
        let evidence = Evidence {
            duality_gap: duality / s,
            penetration: deepest / s,
            complementarity: weighted / s,
            deepest,
        };
        // Every cell of the grid was looked at.
        Seen { evidence, complete: !rough, d, factored: false }
    }

    fn improve(&mut self, seen: Seen, steps: &mut usize, stop: Stop<'_>) {
        let Arrays { gap, vectors, side, .. } = &mut *self.arrays;
        let Pressed { set, p } = &self.now;
        let (side, shift) = (*side, self.d - self.reference);
        let threshold = (shift - crate::active_set::NOISE * self.residual) as f32;
        vectors.take(side, |y, marks| {
            for (mark, &gap) in marks.iter_mut().zip(&gap[y * side..]) {
                *mark = gap < threshold;
            }
            set.fill(y, true, marks);
        });
        let cg::Vectors { set: wider, r, .. } = vectors;
        let mut unit = 0.0f32;
        for y in 0..side {
            wider.collect(y, &gap[y * side..(y + 1) * side], r);
            for r in &mut r[wider.span(y)] {
                *r = (shift - f64::from(*r)) as f32;
                unit = unit.max(r.abs());
            }
        }
        if unit <= 0.0 {
            return;
        }
        for r in r {
            *r /= unit;
        }
        let asked = crate::active_set::request(self.target, self.limits, seen);
        let unit = f64::from(unit);
        let request = cg::Request {
            fixed_sum: asked.fixed_sum,
            reduction: asked.reduction,
            energy: None,
            floor: asked.floor / unit,
            steps: asked.steps,
            exact: asked.exact,
        };
        *steps += cg::correct(self.operators, vectors, request, stop).steps;
        // What the look has seen is no longer needed: its place takes the new pressure.
        let pressure = &mut self.lifted;
        vectors.set.carry_to(set, p, pressure);
        for (p, &x) in pressure.iter_mut().zip(&vectors.x) {
            *p += unit * f64::from(x);
        }
        if std::mem::take(&mut self.now_is_best) {
            std::mem::swap(&mut self.now, &mut self.best);
        }
        self.now.take(&vectors.set, pressure);
    }

    fn keep(&mut self) {
        self.now_is_best = true;
    }

    fn finish(mut self, status: Status, best: Option<Seen>, last: Seen, steps: usize) -> Solved {
        let mut seen = last;
        if best.is_some() {
            if !self.now_is_best {
                self.now = std::mem::take(&mut self.best);
            }
            seen = self.look(false);
        } else if self.lifted.len() != self.now.p.len() {
            seen = self.look(false); // Stopped before the first look.
        }
        if seen.complete {
            self.arrays.left = Some(Left { reference: self.reference, residual: self.residual });
        }
        let Self { now: Pressed { set, p }, arrays, lifted, d, reference, .. } = self;
        let (side, gap) = (arrays.side, &arrays.gap);
        let mut margin = Margin::new(side);
        for (y, columns, at) in (0..side).flat_map(|y| set.row(y).map(move |(columns, at)| (y, columns, at)))
        {
            margin.leave(y, columns, lifted[at].iter().map(|lifted| lifted - d));
        }
        let (margin, zero) = (margin.bounds(), d - reference);
        // What the stiffness asks about: cells that press, and cells that penetrate or might.
        let touched = Runs::marked(side, |y, marks| {
            let gap = &gap[y * side..];
            for (columns, bound) in margin.row(y, side) {
                let open = (zero + bound) as f32;
                for (mark, &gap) in marks[columns.clone()].iter_mut().zip(&gap[columns]) {
                    *mark = gap < open;
                }
            }
            set.fill(y, true, marks);
        });
        let mut values = vec![0.0; touched.len()];
        let mut row = vec![0.0; side];
        for y in 0..side {
            for (value, &gap) in row.iter_mut().zip(&gap[y * side..]) {
                *value = f64::from(gap) + (reference - d);
            }
            for (columns, at) in set.row(y) {
                for (value, lifted) in row[columns].iter_mut().zip(&lifted[at]) {
                    *value = lifted - d;
                }
            }
            touched.collect(y, &row, &mut values);
        }
        let look = Look {
            p: touched.carry(&set, &p),
            gap: values,
            evidence: seen.evidence,
            checked: touched.cells(),
        };
        Solved { p, contact: set.cells(), d: seen.d, q: None, look, steps, status }
    }
}

#[cfg(test)]
mod looks;
