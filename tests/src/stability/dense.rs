//! The slow reference implementation of contacts that flow and of friction by any law: dense matrices and
//! accelerated projected gradients, to rounding.
//!
//! It follows a path under prescribed forces or displacements. The normal problem is the minimum of
//! `p'Gp/2 + p'z` over `0 <= p <= H`, at a prescribed sum or less `d` times it; the tangential one is that of
//! `q'Kq/2 - q'(delta - s)` over the disks `|q| <= b`, in the same way. There are no contact sets, no transforms
//! and no linear systems.

use crate::stability::plain::PlainSum;
use crate::stability::shear::PlainShear;
use contact_model::FrictionLaw;

/// Steps at most.
const STEPS: usize = 400_000;
/// The iteration has settled where steps change less than this share of the largest value ...
const SMALL: f64 = 2e-14;
/// ... or, after a tenth of the steps, this share ...
const ROUNDING: f64 = 1e-12;
/// ... for this number of steps.
const CALM: usize = 10;
/// Pressures below this share of the largest one are rounding.
const TOUCHING: f64 = 1e-11;

/// What is prescribed along one direction or two.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Prescribed<T> {
    /// The force.
    Force(T),
    /// The displacement of the bodies.
    Displacement(T),
}

/// A contact on its path.
#[derive(Debug, Clone)]
pub struct DensePath {
    normal: Vec<Vec<f64>>,
    shear: Vec<Vec<f64>>,
    /// Gaps without load, with the indentation of the path.
    gaps: Vec<f64>,
    law: FrictionLaw,
    hardness: Option<f64>,
    area: f64,
    /// Force on each cell.
    pub pressed: Vec<f64>,
    /// Tangential forces: components along x, then those along y.
    pub sheared: Vec<f64>,
    /// Depth of the indentation.
    pub indentation: Vec<f64>,
    /// Approach.
    pub approach: f64,
    /// Tangential displacement.
    pub displacement: [f64; 2],
    /// Energy that friction dissipated.
    pub dissipated: f64,
    /// By how much the least decided cell is in contact or out of it: its share of the largest pressure, or its
    /// gap over the largest one.
    pub decided: f64,
}

/// A surface before any load.
#[derive(Debug, Clone)]
pub struct DenseSurface<'a> {
    /// The normal kernel.
    pub normal: &'a PlainSum,
    /// What is subtracted from the normal kernel.
    pub shift: f64,
    /// The tangential kernel.
    pub shear: &'a PlainShear,
    /// Gaps without load.
    pub gaps: Vec<f64>,
    /// Area of a cell.
    pub area: f64,
}

impl DensePath {
    /// The path of a surface with a law of friction and a hardness.
    pub fn new(surface: DenseSurface<'_>, law: FrictionLaw, hardness: Option<f64>) -> Self {
        let DenseSurface { normal, shift, shear, gaps, area } = surface;
        let n = gaps.len();
        let normal = (0..n).map(|i| (0..n).map(|j| normal.between(i, j) - shift).collect()).collect();
        let entry = |row: usize, column: usize| {
            let [xx, yy, xy] = shear.between(row % n, column % n);
            match (row / n, column / n) {
                (0, 0) => xx,
                (1, 1) => yy,
                _ => xy,
            }
        };
        let shear = (0..2 * n).map(|row| (0..2 * n).map(|column| entry(row, column)).collect()).collect();
        Self {
            normal,
            shear,
            gaps,
            law,
            hardness,
            area,
            pressed: vec![0.0; n],
            sheared: vec![0.0; 2 * n],
            indentation: vec![0.0; n],
            approach: 0.0,
            displacement: [0.0; 2],
            dissipated: 0.0,
            decided: 1.0,
        }
    }

    /// Largest tangential force of each cell.
    pub fn limits(&self) -> Vec<f64> {
        let of = |&force: &f64| {
            if force > 0.0 { self.law.largest_traction(force / self.area) * self.area } else { 0.0 }
        };
        self.pressed.iter().map(of).collect()
    }

    /// The pressures of the next step. The tangential part follows by [`DensePath::slide`].
    pub fn press(&mut self, load: Prescribed<f64>) {
        let most = self.hardness.map_or(f64::INFINITY, |hardness| hardness * self.area);
        let bounded = |value: f64| value.clamp(0.0, most);
        let project = |y: &[f64]| -> (Vec<f64>, f64) {
            let shift = match load {
                Prescribed::Displacement(_) => 0.0,
                Prescribed::Force(force) => {
                    let sum = |shift: f64| y.iter().map(|y| bounded(y + shift)).sum::<f64>();
                    let largest = y.iter().fold(0.0, |largest: f64, y| largest.max(y.abs()));
                    let reach = largest + if most.is_finite() { most } else { force };
                    bisect(-reach, reach, |shift| sum(shift) < force)
                }
            };
            (y.iter().map(|y| bounded(y + shift)).collect(), shift)
        };
        let d = match load {
            Prescribed::Displacement(d) => d,
            Prescribed::Force(_) => 0.0,
        };
        let linear: Vec<f64> = self.gaps.iter().map(|z| z - d).collect();
        let (p, step, shift) = minimum(&self.normal, &linear, &self.pressed, project);
        self.approach = match load {
            Prescribed::Displacement(d) => d,
            Prescribed::Force(_) => shift / step,
        };
        let largest = p.iter().fold(0.0, |largest: f64, p| largest.max(*p));
        self.pressed = p.into_iter().map(|p| if p > TOUCHING * largest { p } else { 0.0 }).collect();
        let (u, d) = (product(&self.normal, &self.pressed), self.approach);
        let gaps: Vec<f64> = u.iter().zip(&self.gaps).map(|(u, z)| u + z - d).collect();
        let widest = gaps.iter().zip(&self.gaps).fold(0.0, |w: f64, (gap, z)| w.max(gap.abs()).max(*z));
        self.decided = 1.0;
        for (p, gap) in self.pressed.iter().zip(&gaps) {
            let by = if *p > 0.0 { p / largest } else { gap / widest };
            self.decided = self.decided.min(by);
        }
        for (i, gap) in gaps.iter().enumerate().filter(|(i, _)| self.pressed[*i] >= most) {
            self.gaps[i] += (-gap).max(0.0);
            self.indentation[i] += (-gap).max(0.0);
        }
    }

    /// The tractions of the step under its pressures.
    pub fn slide(&mut self, load: Prescribed<[f64; 2]>) {
        let limits = self.limits();
        let n = limits.len();
        let before = product(&self.shear, &self.sheared);
        let held: Vec<f64> = before.iter().enumerate().map(|(k, u)| self.displacement[k / n] - u).collect();
        let within = |y: &[f64], shift: [f64; 2]| -> (Vec<f64>, [f64; 2]) {
            let (mut q, mut sum) = (vec![0.0; 2 * n], [0.0; 2]);
            for i in (0..n).filter(|&i| limits[i] > 0.0) {
                let (x, y) = (y[i] + shift[0], y[n + i] + shift[1]);
                let scale = (limits[i] / x.hypot(y)).min(1.0);
                (q[i], q[n + i]) = (scale * x, scale * y);
                sum = [sum[0] + q[i], sum[1] + q[n + i]];
            }
            (q, sum)
        };
        let (count, most) = (limits.iter().filter(|b| **b > 0.0).count(), limits.iter().sum::<f64>());
        let mut at = [0.0; 2];
        let project = |y: &[f64]| -> (Vec<f64>, [f64; 2]) {
            let force = match load {
                Prescribed::Displacement(_) => return (within(y, [0.0; 2]).0, [0.0; 2]),
                Prescribed::Force(force) => force,
            };
            // Plain steps of the shift, which the cells within their disks contract.
            let mut least = f64::INFINITY;
            loop {
                let (q, sum) = within(y, at);
                let missing = [force[0] - sum[0], force[1] - sum[1]];
                let left = missing[0].hypot(missing[1]);
                // Down to rounding.
                if left < 1e-16 * most || left < 1e-13 * most && left >= least {
                    return (q, at);
                }
                least = left;
                at = [0, 1].map(|k| at[k] + missing[k] / count as f64);
            }
        };
        let delta = match load {
            Prescribed::Displacement(delta) => delta,
            Prescribed::Force(_) => [0.0; 2],
        };
        let linear: Vec<f64> = held.iter().enumerate().map(|(k, held)| held - delta[k / n]).collect();
        let (q, step, shift) = minimum(&self.shear, &linear, &self.sheared, project);
        let delta = match load {
            Prescribed::Displacement(delta) => delta,
            Prescribed::Force(_) => shift.map(|shift| shift / step),
        };
        let u = product(&self.shear, &q);
        let slip = |k: usize| delta[k / n] - u[k] - held[k];
        self.dissipated += q.iter().enumerate().map(|(k, q)| q * slip(k)).sum::<f64>();
        (self.sheared, self.displacement) = (q, delta);
    }

    /// Sum of the tangential forces.
    pub fn force(&self) -> [f64; 2] {
        let (x, y) = self.sheared.split_at(self.pressed.len());
        [x.iter().sum(), y.iter().sum()]
    }

    /// Area of a cell.
    pub fn cell_area(&self) -> f64 {
        self.area
    }

    /// The gaps that are open under the pressures.
    pub fn open_gaps(&self) -> Vec<f64> {
        let u = product(&self.normal, &self.pressed);
        u.iter().zip(&self.gaps).map(|(u, z)| (u + z - self.approach).max(0.0)).collect()
    }

    /// Elastic energy of the pressures and of the tractions.
    pub fn energies(&self) -> [f64; 2] {
        let of = |matrix: &[Vec<f64>], v: &[f64]| 0.5 * dot(&product(matrix, v), v);
        [of(&self.normal, &self.pressed), of(&self.shear, &self.sheared)]
    }
}

/// The minimum of `x'Ax/2 + b'x` over the set of a projection, the length of the steps, and the shift with which the
/// last projection met its condition. The projection gives the nearest point and that shift.
///
/// # Panics
/// Where it does not settle: an unfinished iteration is no reference.
fn minimum<T>(
    a: &[Vec<f64>],
    b: &[f64],
    start: &[f64],
    mut project: impl FnMut(&[f64]) -> (Vec<f64>, T),
) -> (Vec<f64>, f64, T) {
    let bound = a.iter().map(|row| row.iter().map(|a| a.abs()).sum::<f64>()).fold(0.0, f64::max);
    let step = 1.0 / bound;
    let mut x = project(start).0;
    let (mut ahead, mut t, mut calm) = (x.clone(), 1.0_f64, 0);
    for done in 0..STEPS {
        let y: Vec<f64> =
            ahead.iter().zip(a).zip(b).map(|((x, row), b)| x - step * (dot(row, &ahead) + b)).collect();
        let (next, shift) = project(&y);
        let change: Vec<f64> = next.iter().zip(&x).map(|(next, x)| next - x).collect();
        // Momentum that leads uphill is forgotten.
        let uphill: f64 = ahead.iter().zip(&next).zip(&change).map(|((a, n), d)| (a - n) * d).sum();
        let next_t = if uphill > 0.0 { 1.0 } else { 0.5 * (1.0 + (1.0 + 4.0 * t * t).sqrt()) };
        let momentum = if uphill > 0.0 { 0.0 } else { (t - 1.0) / next_t };
        ahead = next.iter().zip(&change).map(|(next, d)| next + momentum * d).collect();
        let largest = |v: &[f64]| v.iter().fold(0.0, |largest: f64, v| largest.max(v.abs()));
        // After very many steps rounding is what is left.
        let small = if done < STEPS / 10 { SMALL } else { ROUNDING };
        calm = if largest(&change) <= small * largest(&next) { calm + 1 } else { 0 };
        (x, t) = (next, next_t);
        if calm >= CALM {
            return (x, step, shift);
        }
    }
    panic!("projected gradients of {} values did not settle in {STEPS} steps", b.len());
}

/// The place in an interval at which a condition that holds below it ends.
fn bisect(mut low: f64, mut high: f64, below: impl Fn(f64) -> bool) -> f64 {
    loop {
        let middle = f64::midpoint(low, high);
        if middle <= low || middle >= high {
            return middle;
        }
        if below(middle) { low = middle } else { high = middle }
    }
}

fn product(a: &[Vec<f64>], x: &[f64]) -> Vec<f64> {
    a.iter().map(|row| dot(row, x)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
