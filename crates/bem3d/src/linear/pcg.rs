//! Linear systems in the precision and with the preconditioner of their recipe, by preconditioned conjugate
//! gradients.

use super::extension::Extension;
use super::preconditioner::{Identity, Preconditioned, Preconditioner, TorusInverse};
use crate::geometry::CellSet;
use crate::operator::{Conditioning, InfluenceOperator, Operators, Recipe};
use crate::parts::Part;
use crate::real::{Real, dot, each, largest, sum, update};
use crate::tuning::CHUNK;
use contact_model::{Interrupted, Stop};
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
    /// Whether the number of steps ended it, and no other criterion.
    pub is_limited: bool,
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
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while its operators are planned.
    pub fn take(
        &mut self,
        operators: &mut Operators,
        set: CellSet,
        recipe: Recipe,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        if self.recipe.is_none_or(|last| last.has_preconditioner() != recipe.has_preconditioner()) {
            self.begin_load();
        }
        let is_same = self.recipe == Some(recipe) && *self.set() == set;
        // Until it is prepared there is none.
        self.recipe = None;
        let (decay, recorder) = (operators.tuning().decay, operators.recorder().clone());
        if let (Conditioning::Torus { extended, .. }, (_, Some(torus))) =
            (recipe.conditioning, operators.system(recipe, stop)?)
        {
            // Another window may have been planned since.
            if !is_same || self.extension.window() != Some(torus.window()) {
                let decay = if extended { decay } else { 0.0 };
                recorder.timed(Part::Sets, || self.extension.set(&set, torus.window(), decay));
            }
        }
        self.recipe = Some(recipe);
        if is_same {
            return Ok(());
        }
        recorder.timed(Part::Sets, || {
            if recipe.is_single() {
                self.single.take(set);
            } else {
                self.double.take(set);
            }
        });
        Ok(())
    }

    /// The set.
    pub fn set(&self) -> &CellSet {
        if self.recipe.is_some_and(|recipe| recipe.is_single()) { &self.single.set } else { &self.double.set }
    }

    /// Solves `G x = right` on the set approximately, or the constrained form of it for `fixed`, and writes x
    /// over `right`. Criteria and outcome are in the units of `right`.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `right` is then as it was.
    pub fn solve(
        &mut self,
        operators: &mut Operators,
        right: &mut [f64],
        fixed: Fixed,
        criteria: StoppingCriteria,
        stop: Stop<'_>,
    ) -> Result<PcgOutcome, Interrupted> {
        operators.plans.solves += 1;
        // In units of its own size: its square neither overflows nor underflows.
        let unit = largest(right);
        let Some(recipe) = self.recipe.filter(|_| unit > 0.0) else {
            return Ok(PcgOutcome::default());
        };
        let square = unit * unit;
        let criteria = StoppingCriteria {
            floor: criteria.floor / unit,
            energy: criteria.energy.map(|e| Energy { base: e.base / square, ..e }),
            ..criteria
        };
        let mut identity = Identity { smallest_eigenvalue: operators.table().smallest_eigenvalue() };
        let recorder = operators.recorder().clone();
        let (mut operator, torus) = operators.system(recipe, stop)?;
        let outcome = recorder.timed(Part::Vectors, || {
            let operator = &mut operator;
            if !recipe.is_single() {
                let (preconditioner, vectors) = (&mut identity, &mut self.double);
                let system = LinearSystem { operator, preconditioner, vectors, fixed };
                return system.solve(right, unit, criteria, stop);
            }
            let vectors = &mut self.single;
            if let Some(transform) = torus {
                let extensions = std::array::from_mut(&mut self.extension);
                let preconditioner = &mut TorusInverse { transform, extensions, recorder: recorder.clone() };
                LinearSystem { operator, preconditioner, vectors, fixed }.solve(right, unit, criteria, stop)
            } else {
                let preconditioner = &mut identity;
                LinearSystem { operator, preconditioner, vectors, fixed }.solve(right, unit, criteria, stop)
            }
        })?;
        operators.plans.applications += outcome.applications;
        Ok(PcgOutcome { energy: outcome.energy * square, ..outcome })
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
        self.r.clear();
        self.r.resize(length, T::default());
        // These are written before they are read.
        for vector in [&mut self.x, &mut self.t, &mut self.kt, &mut self.z] {
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
    fn load(&mut self, right: &[f64], unit: f64) {
        update(&mut self.r, right, |r, right| *r = T::of(right / unit));
    }

    /// Gives the solution.
    fn unload(&self, solution: &mut [f64], unit: f64) {
        update(solution, &self.x, |solution, x| *solution = unit * x.to_f64());
    }

    /// The sum of the weights, which are computed where there are none.
    fn weigh(
        &mut self,
        preconditioner: &mut dyn Preconditioner<T>,
        stop: Stop<'_>,
    ) -> Result<f64, Interrupted> {
        let total = sum(&self.weights);
        if total > 0.0 {
            return Ok(total);
        }
        let mut ones = vec![T::of(1.0); self.set.len()];
        let total = preconditioner.apply(&self.set, T::default(), &mut ones, &mut self.z, stop)?.sum;
        self.weights.clone_from(&self.z);
        Ok(total)
    }
}

/// A system `G x = r` on a set of cells, or the constrained form of it for [`Fixed`], with its preconditioner.
pub struct LinearSystem<'a, T> {
    /// The influence matrix G.
    pub operator: &'a mut dyn InfluenceOperator<T>,
    /// The preconditioner.
    pub preconditioner: &'a mut dyn Preconditioner<T>,
    /// The set, the right-hand side and the solution.
    pub vectors: &'a mut Vectors<T>,
    /// The quantity that is fixed.
    pub fixed: Fixed,
}

impl<T: Real> LinearSystem<'_, T> {
    /// Solves for a right-hand side, and writes the solution over it. Criteria and outcome are in units of its size,
    /// `unit`.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop; `right` is then as it was.
    pub fn solve(
        self,
        right: &mut [f64],
        unit: f64,
        criteria: StoppingCriteria,
        stop: Stop<'_>,
    ) -> Result<PcgOutcome, Interrupted> {
        let Self { operator, preconditioner, vectors, fixed } = self;
        vectors.load(right, unit);
        let system = LinearSystem { operator, preconditioner, vectors: &mut *vectors, fixed };
        let outcome = pcg(system, criteria, stop)?;
        vectors.unload(right, unit);
        Ok(outcome)
    }
}

/// Solves a system approximately.
///
/// At a fixed force the equation is solved for corrections whose sum is zero: with the weights w, the
/// residual is `r - (w'r / w'1) 1` and the preconditioned one `z - (1'z / 1'w) w`, which is symmetric and
/// keeps the sum whatever the weights; `G^-1 1` is the best of them.
///
/// # Errors
/// [`Interrupted`] by the stop, which the operators ask.
///
/// Cost: one application of G and one of the preconditioner a step. The caller checks the result with the
/// exact operator.
fn pcg<'a, T: Real>(
    system: LinearSystem<'a, T>,
    criteria: StoppingCriteria,
    stop: Stop<'a>,
) -> Result<PcgOutcome, Interrupted> {
    let mut gradients = ConjugateGradients::new(system, criteria, stop)?;
    loop {
        let found = gradients.precondition()?;
        if gradients.is_reached(found) {
            break;
        }
        if gradients.steps >= gradients.criteria.steps {
            gradients.is_limited = true;
            break;
        }
        gradients.turn(found);
        if !gradients.find_step()? {
            break; // Below what single precision can resolve.
        }
        if gradients.is_expected() {
            gradients.lower_residual();
            break;
        }
    }
    Ok(gradients.finish())
}

/// Conjugate gradients on their way.
struct ConjugateGradients<'a, T> {
    system: LinearSystem<'a, T>,
    criteria: StoppingCriteria,
    stop: Stop<'a>,
    /// Upper bound of the ratio of the energy of a residual to `r' M r`.
    factor: f64,
    /// The sum of the weights, where the sum of corrections is fixed.
    total: Option<f64>,
    /// Length of the last step.
    step: T,
    /// Whether x still lacks that step.
    pending: bool,
    /// `r' M r` at the beginning and before the last step, and by which factor it fell in the step before.
    start: f64,
    rz: f64,
    rate: f64,
    /// By how much the steps have raised `r' x`.
    gain: f64,
    steps: usize,
    applications: usize,
    /// Whether the number of steps ended the iteration.
    is_limited: bool,
}

impl<'a, T: Real> ConjugateGradients<'a, T> {
    fn new(
        system: LinearSystem<'a, T>,
        criteria: StoppingCriteria,
        stop: Stop<'a>,
    ) -> Result<Self, Interrupted> {
        let LinearSystem { preconditioner, vectors, fixed, .. } = system;
        for vector in [&mut vectors.x, &mut vectors.t] {
            vector.fill(T::default());
        }
        let factor = preconditioner.energy_factor();
        let total = if fixed == Fixed::Force { Some(vectors.weigh(preconditioner, stop)?) } else { None };
        Ok(Self {
            system: LinearSystem { preconditioner, vectors, ..system },
            criteria,
            stop,
            factor,
            total,
            step: T::default(),
            pending: false,
            start: 0.0,
            rz: 0.0,
            rate: 1.0,
            gain: 0.0,
            steps: 0,
            applications: 0,
            is_limited: false,
        })
    }

    /// Takes the last step off the residual.
    fn lower_residual(&mut self) {
        let Vectors { r, kt, .. } = &mut *self.system.vectors;
        add(r, T::default() - self.step, kt);
    }

    /// Preconditions the residual after the last step.
    fn precondition(&mut self) -> Result<Preconditioned, Interrupted> {
        if self.steps > 0 {
            self.lower_residual();
        }
        let LinearSystem { preconditioner, vectors, .. } = &mut self.system;
        let Vectors { set, r, z, weights, .. } = &mut **vectors;
        let offset = self.total.map_or(T::default(), |total| T::of(dot(weights, r) / total));
        // Without a product of r and the weights, the part of z along them adds nothing to r'z.
        let found = preconditioner.apply(set, offset, r, z, self.stop)?;
        if self.steps == 0 {
            self.start = found.product;
        }
        Ok(found)
    }

    /// Whether a residual with this `r' M r` is as small as wanted.
    fn is_within(&self, product: f64) -> bool {
        product <= self.criteria.reduction * self.criteria.reduction * self.start
    }

    /// Whether the energy of such a residual is as small as wanted, at the present gain.
    fn is_small(&self, product: f64) -> bool {
        self.criteria.energy.is_some_and(|e| self.factor * product <= e.share * (e.base + self.gain))
    }

    /// Whether the residual or the energy ends the iteration.
    fn is_reached(&self, found: Preconditioned) -> bool {
        let product = found.product;
        self.is_small(product)
            || (self.steps > 0 && self.is_within(product))
            || found.largest <= self.criteria.floor
            || product.is_nan()
            || product <= 0.0
    }

    /// Takes the last step, and turns to the next direction.
    fn turn(&mut self, found: Preconditioned) {
        if self.steps > 0 {
            self.rate = found.product / self.rz;
        }
        let beta = if self.steps == 0 { T::default() } else { T::of(self.rate) };
        self.rz = found.product;
        let Vectors { x, t, z, weights, .. } = &mut *self.system.vectors;
        advance(x, self.step, t, beta, z);
        self.pending = false;
        if let Some(total) = self.total {
            add(t, T::of(-found.sum / total), weights);
        }
    }

    /// Finds the length of the step along the direction; `false` where the curvature along it is not positive.
    fn find_step(&mut self) -> Result<bool, Interrupted> {
        let LinearSystem { operator, vectors, fixed, .. } = &mut self.system;
        let Vectors { set, t, kt, .. } = &mut **vectors;
        operator.apply_until(set, t, set, kt, self.stop)?;
        if let Fixed::MeanPlane(constant) = *fixed {
            let offset = T::of(constant * sum(t));
            each(kt, |kt| *kt += T::default() - offset);
        }
        self.applications += 1;
        let curvature = dot(t, kt);
        if curvature.is_nan() || curvature <= 0.0 {
            return Ok(false);
        }
        self.step = T::of(self.rz / curvature);
        self.gain += self.rz * self.rz / curvature;
        self.steps += 1;
        self.pending = true;
        Ok(true)
    }

    /// Whether the residual after the step need not be known: the step is expected to gain as much as the last one,
    /// and that is enough.
    fn is_expected(&self) -> bool {
        let expected = self.rz * self.rate;
        self.is_within(expected) || self.is_small(expected)
    }

    /// Adds the last step to the solution.
    fn finish(self) -> PcgOutcome {
        let Vectors { x, t, .. } = self.system.vectors;
        if self.pending {
            add(x, self.step, t);
        }
        let energy = self.factor * self.start.max(0.0);
        let Self { steps, applications, is_limited, .. } = self;
        PcgOutcome { steps, applications, energy, is_limited }
    }
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
