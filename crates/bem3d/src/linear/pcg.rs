//! Linear systems in the precision and with the preconditioner of their recipe, by preconditioned conjugate
//! gradients.

use super::extension::Extension;
use super::preconditioner::{Identity, Preconditioner, TorusInverse};
use crate::geometry::CellSet;
use crate::operator::{Conditioning, InfluenceOperator, Operators, Recipe};
use crate::parts::Part;
use crate::real::{Real, dot, each, largest, sum, update};
use crate::tuning::CHUNK;
use contact_model::Stop;
use numerics::parallel::{map, widest};

/// Stopping criteria of an iteration: it ends when one of them is met, or one step earlier where the next
/// step would meet one if it gained as much as the last one. The caller measures the result.
#[derive(Debug, Clone, Copy)]
pub struct StoppingCriteria {
    /// The error has fallen by this factor (in the norm `sqrt(r' M r)` of the preconditioned residual) ...
    pub reduction: f64,
    /// ... or its energy is below this share of the value `base + r' x` that the equation is solved for ...
    pub energy: Option<Energy>,
    /// ... or the residual is below this value everywhere ...
    pub floor: f64,
    /// ... or this number of steps is done.
    pub steps: usize,
}

/// Required energy of the error, in the units of the given residual.
#[derive(Debug, Clone, Copy)]
pub struct Energy {
    /// Allowed relative error of the value.
    pub share: f64,
    /// The value before the correction.
    pub base: f64,
}

/// The quantity that is fixed while a pressure is corrected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fixed {
    /// The approach: `G x = r`.
    Approach,
    /// The force: `G x = r + const` and `sum x = 0`, the approach adapts.
    Force,
    /// The mean plane of a periodic surface: `(G - c) x = r` with the constant c that the kernel has beyond
    /// its zero mean.
    MeanPlane(f64),
}

/// Work and result of an iteration, in the units of the given residual.
#[derive(Debug, Clone, Copy, Default)]
pub struct PcgOutcome {
    /// Steps.
    pub steps: usize,
    /// Applications of the influence matrix: one in each step, and one more without effect where the
    /// precision ended the iteration.
    pub applications: usize,
    /// Estimate from above of the energy `r' G^-1 r` at the beginning.
    pub energy: f64,
}

/// Buffers for linear systems, kept from one to the next.
#[derive(Debug, Default)]
pub struct Workspace {
    recipe: Option<Recipe>,
    double: Vectors<f64>,
    single: Vectors<f32>,
    extension: Extension,
}

impl Workspace {
    /// Prepares for a new load: the weights of the sums of corrections are computed again.
    pub fn begin_load(&mut self) {
        self.double.forget();
        self.single.forget();
    }

    /// Sets the set of cells and the recipe for systems on it.
    pub fn take(&mut self, operators: &mut Operators, set: CellSet, recipe: Recipe) {
        if self.recipe.is_some_and(|last| last.has_preconditioner() != recipe.has_preconditioner()) {
            self.begin_load();
        }
        self.recipe = Some(recipe);
        let (decay, recorder) = (operators.tuning().decay, operators.recorder().clone());
        if let (Conditioning::Torus { extended, .. }, (_, Some(torus))) =
            (recipe.conditioning, operators.system(recipe))
        {
            let decay = if extended { decay } else { 0.0 };
            recorder.timed(Part::Sets, || self.extension.set(&set, torus.window(), decay));
        }
        recorder.timed(Part::Sets, || {
            if recipe.is_single() {
                self.single.take(set);
            } else {
                self.double.take(set);
            }
        });
    }

    /// The set.
    pub fn set(&self) -> &CellSet {
        if self.recipe.is_some_and(|recipe| recipe.is_single()) { &self.single.set } else { &self.double.set }
    }

    /// Solves `G x = right` on the set approximately, or the constrained form of it for `fixed`, and writes x
    /// over `right`. Criteria and outcome are in the units of `right`.
    pub fn solve(
        &mut self,
        operators: &mut Operators,
        right: &mut [f64],
        fixed: Fixed,
        criteria: StoppingCriteria,
        stop: Stop<'_>,
    ) -> PcgOutcome {
        operators.plans.solves += 1;
        // In units of its own size: its square neither overflows nor underflows.
        let unit = largest(right);
        let Some(recipe) = self.recipe.filter(|_| unit > 0.0) else { return PcgOutcome::default() };
        let square = unit * unit;
        let criteria = StoppingCriteria {
            floor: criteria.floor / unit,
            energy: criteria.energy.map(|e| Energy { base: e.base / square, ..e }),
            ..criteria
        };
        let mut identity = Identity { smallest_eigenvalue: operators.table().smallest_eigenvalue() };
        let recorder = operators.recorder().clone();
        let (mut operator, torus) = operators.system(recipe);
        let outcome = recorder.timed(Part::Vectors, || {
            if recipe.is_single() {
                let v = &mut self.single;
                v.load(right, unit);
                let outcome = if let Some(transform) = torus {
                    let mut inverse = TorusInverse {
                        transform,
                        extensions: std::array::from_mut(&mut self.extension),
                        recorder: recorder.clone(),
                    };
                    pcg(&mut operator, &mut inverse, v, fixed, criteria, stop)
                } else {
                    pcg(&mut operator, &mut identity, v, fixed, criteria, stop)
                };
                v.unload(right, unit);
                outcome
            } else {
                let v = &mut self.double;
                v.load(right, unit);
                let outcome = pcg(&mut operator, &mut identity, v, fixed, criteria, stop);
                v.unload(right, unit);
                outcome
            }
        });
        operators.plans.applications += outcome.applications;
        PcgOutcome { energy: outcome.energy * square, ..outcome }
    }
}

/// Vectors on a set, kept from system to system.
#[derive(Debug, Default)]
pub struct Vectors<T> {
    /// The set.
    pub set: CellSet,
    /// In: right-hand side of magnitude about 1; out: residual.
    pub r: Vec<T>,
    /// Out: correction.
    pub x: Vec<T>,
    t: Vec<T>,
    kt: Vec<T>,
    z: Vec<T>,
    /// The weights by which the sum of a correction is removed: about `G^-1 1`, computed on the first set of
    /// a load and carried from set to set. Empty before that.
    weights: Vec<T>,
}

impl<T: Real> Vectors<T> {
    /// Takes a new set with several numbers a cell; the right-hand side is zero.
    pub fn take_fields(&mut self, set: CellSet, fields: usize) {
        self.set = set;
        let length = fields * self.set.len();
        for vector in [&mut self.r, &mut self.t] {
            vector.clear();
            vector.resize(length, T::default());
        }
        // These are written before they are read.
        for vector in [&mut self.x, &mut self.kt, &mut self.z] {
            vector.resize(length, T::default());
        }
    }

    /// Takes a new set; the right-hand side is zero.
    pub fn take(&mut self, set: CellSet) {
        let last = std::mem::take(&mut self.set);
        self.take_fields(set, 1);
        if !self.weights.is_empty() {
            self.set.carry_to(&last, &self.weights, &mut self.z);
            std::mem::swap(&mut self.weights, &mut self.z);
            self.z.resize(self.set.len(), T::default());
        }
    }

    /// Drops the weights, which belong to another load or preconditioner.
    pub fn forget(&mut self) {
        self.weights.clear();
    }

    /// Takes a right-hand side in units of its size.
    pub fn load(&mut self, right: &[f64], unit: f64) {
        update(&mut self.r, right, |r, right| *r = T::of(right / unit));
    }

    /// Gives the solution.
    pub fn unload(&self, solution: &mut [f64], unit: f64) {
        update(solution, &self.x, |solution, x| *solution = unit * x.to_f64());
    }

    /// The sum of the weights, which are computed where there are none.
    fn weigh(&mut self, preconditioner: &mut dyn Preconditioner<T>) -> f64 {
        let total = sum(&self.weights);
        if total > 0.0 {
            return total;
        }
        let mut ones = vec![T::of(1.0); self.set.len()];
        let total = preconditioner.apply(&self.set, T::default(), &mut ones, &mut self.z).sum;
        self.weights.clone_from(&self.z);
        total
    }
}

/// Solves `G x = r` on a set approximately, or the constrained form of it for [`Fixed`].
///
/// At a fixed force the equation is solved for corrections whose sum is zero: with the weights w, the
/// residual is `r - (w'r / w'1) 1` and the preconditioned one `z - (1'z / 1'w) w`, which is symmetric and
/// keeps the sum whatever the weights; `G^-1 1` is the best of them.
///
/// Cost: one application of G and one of the preconditioner a step. The caller checks the result with the
/// exact operator.
pub fn pcg<T: Real>(
    operator: &mut dyn InfluenceOperator<T>,
    preconditioner: &mut dyn Preconditioner<T>,
    v: &mut Vectors<T>,
    fixed: Fixed,
    criteria: StoppingCriteria,
    stop: Stop<'_>,
) -> PcgOutcome {
    let fixed_sum = fixed == Fixed::Force;
    v.x.fill(T::default());
    let factor = preconditioner.energy_factor();
    let total = if fixed_sum { v.weigh(preconditioner) } else { 0.0 };
    let small = |energy: f64, gain: f64| {
        criteria.energy.is_some_and(|e| factor * energy <= e.share * (e.base + gain))
    };
    let (mut steps, mut applications, mut step, mut rz, mut gain) = (0, 0, T::default(), 0.0, 0.0);
    let (mut start, mut rate, mut pending) = (0.0, 1.0, false);
    loop {
        let Vectors { set, r, kt, z, weights, .. } = &mut *v;
        if steps > 0 {
            add(r, T::default() - step, kt);
        }
        let offset = if fixed_sum { T::of(dot(weights, r) / total) } else { T::default() };
        // Without a product of r and the weights, the part of z along them adds nothing to r'z.
        let found = preconditioner.apply(set, offset, r, z);
        let next = found.product;
        if steps == 0 {
            start = next;
        }
        let wanted = criteria.reduction * criteria.reduction * start;
        let reached = small(next, gain) || (steps > 0 && next <= wanted) || found.largest <= criteria.floor;
        if reached || next.is_nan() || next <= 0.0 || steps >= criteria.steps || stop.stops() {
            break;
        }
        if steps > 0 {
            rate = next / rz;
        }
        let beta = if steps == 0 { T::default() } else { T::of(rate) };
        rz = next;
        let Vectors { set, x, t, kt, z, weights, .. } = &mut *v;
        advance(x, step, t, beta, z);
        if fixed_sum {
            add(t, T::of(-found.sum / total), weights);
        }
        pending = false;
        operator.apply(set, t, set, kt);
        if let Fixed::MeanPlane(constant) = fixed {
            let offset = T::of(constant * sum(t));
            each(kt, |kt| *kt += T::default() - offset);
        }
        applications += 1;
        let curvature = dot(t, kt);
        if curvature.is_nan() || curvature <= 0.0 {
            break; // Below what single precision can resolve.
        }
        step = T::of(rz / curvature);
        gain += rz * rz / curvature;
        steps += 1;
        pending = true;
        // Where the next step is expected to gain as much as the last one, the rest need not be known.
        if rz * rate <= wanted || small(rz * rate, gain) {
            add(&mut v.r, T::default() - step, &v.kt);
            break;
        }
    }
    if pending {
        add(&mut v.x, step, &v.t);
    }
    PcgOutcome { steps, applications, energy: factor * start.max(0.0) }
}

fn add<T: Real>(a: &mut [T], factor: T, b: &[T]) {
    update(a, b, |a, &b| *a += factor * b);
}

/// `x += step t`, then `t = z + beta t`: each is read once.
fn advance<T: Real>(x: &mut [T], step: T, t: &mut [T], beta: T, z: &[T]) {
    let chunks = x.chunks_mut(CHUNK).zip(t.chunks_mut(CHUNK)).zip(z.chunks(CHUNK));
    map(z.len(), chunks, |((x, t), z)| {
        widest(
            #[inline(always)]
            move || {
                for ((x, t), &z) in x.iter_mut().zip(t).zip(z) {
                    *x += step * *t;
                    *t = z + beta * *t;
                }
            },
        );
    });
}

#[cfg(test)]
mod tests;
