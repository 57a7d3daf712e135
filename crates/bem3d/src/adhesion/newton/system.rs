//! The linear system of a Newton step and its preconditioner; the matrices stand on the front page of
//! [`super`].

use crate::active_set::Problem;
use crate::adhesion::attraction::Attraction;
use crate::adhesion::equilibrium::Equilibrium;
use crate::adhesion::law::LawShape;
use crate::adhesion::pairs::Pairs;
use crate::geometry::CellSet;
use crate::linear::{Extension, Fixed, MinresLimits, Preconditioner, TorusInverse, minres};
use crate::operator::{Conditioning, FftConvolution, InfluenceOperator, PlannedPressure};
use crate::parts::Recorder;
use crate::real::{dot, each, largest, sum, update};
use contact_model::{Interrupted, Stop};

// Half and twice the value of each constant below change the work by less than 1 % (34 paths of rough maps and of
// spheres with 65 cells a side, at a tolerance of 1e-5).

/// Slopes below this share of the peak over the range are left out of a step ...
const FLAT: f64 = 1e-3;
/// ... and of a short range, whose law is level in contact, those below this: cells that have just opened
/// hardly change their attraction, and a system with them is far worse conditioned than the state.
const LEVEL: f64 = 0.05;
/// Steps of minimal residuals at most.
const STEPS: usize = 100;
/// The diagonal part of the block of Z is at least this share of N.
const LEAST: f64 = 0.1;

/// The state that the plain iteration would reach in one update.
pub struct Predicted<'a> {
    /// Contact pressure, brought to the force.
    pub pressure: &'a [f64],
    /// Attraction.
    pub attraction: &'a [f64],
    /// The gap that follows from both.
    pub gap: &'a [f64],
    /// Cells of the contact set, 1, and others, 0.
    pub contact: &'a [f64],
    /// Gaps below this are those of the contact before it is corrected.
    pub noise: f64,
}

/// A Newton step that is asked for.
pub struct WantedStep<'a> {
    /// Where it begins.
    pub state: &'a Equilibrium,
    /// Where the plain iteration would go.
    pub predicted: &'a Predicted<'a>,
    /// The quantity that is held: the approach, the force or the mean plane.
    pub fixed: Fixed,
    /// The factor by which the residual of the linear system is reduced.
    pub reduction: f64,
    /// When to stop.
    pub stop: Stop<'a>,
}

/// The linear system of a state.
pub struct Linear {
    /// Cells that stay closed.
    contact: CellSet,
    /// They and the open cells whose attraction moves with their gaps.
    pub both: CellSet,
    /// On both: roots of the slopes, 1 on contact.
    root: Vec<f32>,
    /// On both: 1 on open cells, 0 on contact.
    is_open: Vec<f32>,
}

/// The solution of the system, on both sets of cells.
pub struct NewtonSolution {
    /// Change of the net pressure.
    pub change: Vec<f64>,
    /// Gap of open cells, beyond the one at which the law is linearised.
    pub opening: Vec<f64>,
    /// Steps of minimal residuals.
    pub steps: usize,
}

impl Linear {
    /// The system of a state with these cells in contact, 1.
    pub fn new(attraction: &Attraction, state: &Equilibrium, contact: &[f64]) -> Self {
        let mut slopes = attraction.slopes(&state.cells, &state.gap);
        let flat = if attraction.law.shape == LawShape::Smooth { LEVEL } else { FLAT };
        let least = flat * attraction.law.peak / attraction.law.range;
        slopes.iter_mut().zip(contact).filter(|(_, c)| **c > 0.0).for_each(|(s, _)| *s = 0.0);
        let open = state.cells.filter(&slopes, |s| s > least);
        let contact = state.cells.filter(contact, |c| c > 0.0);
        let both = contact.union(&open);
        let is_open = both.carry(&open, &vec![1.0; open.len()]);
        let mut root: Vec<f32> = both.carry(&state.cells, &slopes).iter().map(|s| s.sqrt() as f32).collect();
        root.iter_mut().zip(&is_open).filter(|(_, open)| **open <= 0.0).for_each(|(r, _)| *r = 1.0);
        Self { contact, both, root, is_open }
    }

    /// The residual of the conditions: the gap on contact, elsewhere how far the gap is from where the law is
    /// linearised.
    pub fn left(&self, wanted: &WantedStep<'_>, contact: &[f64]) -> Vec<f64> {
        let WantedStep { state, predicted, .. } = wanted;
        let left: Vec<f64> = (predicted.gap.iter().zip(&state.gap).zip(contact))
            .map(|((after, before), &c)| if c > 0.0 { *after } else { after - before })
            .collect();
        self.both.carry(&state.cells, &left)
    }

    /// Solves for the change of net pressure that closes `left` on contact, the gap there, and with which the
    /// attraction of open cells follows the linearised law; `left` is on them how far the gap is from where
    /// the law is linearised. `None` where nothing is left.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn solve(
        &self,
        problem: &mut Problem,
        attraction: &Attraction,
        wanted: &WantedStep<'_>,
        left: &[f64],
    ) -> Result<Option<NewtonSolution>, Interrupted> {
        let (unit, operators) = (largest(left), &mut problem.operators);
        let stop = wanted.stop;
        let recipe = operators.planner().system(&self.both, self.contact.len(), false);
        let Some(recipe) = recipe.filter(|_| unit > 0.0) else { return Ok(None) };
        let pairs = self.coupling(attraction, wanted.state);
        let pairs = pairs.as_ref();
        let own = operators.table().own() as f32;
        let (decay, recorder) = (operators.tuning().decay, operators.recorder().clone());
        let (kernel, torus) = operators.system(recipe, stop)?;
        let mut extension = Extension::default();
        if let (Conditioning::Torus { extended, .. }, Some(torus)) = (recipe.conditioning, &torus) {
            extension.set(&self.contact, torus.window(), if extended { decay } else { 0.0 });
        }
        let diagonal = self.diagonal(own);
        let mut inverse = RoughInverse { linear: self, diagonal, torus, extension, recorder };
        let kept = KeptForce::new(self, pairs, wanted.fixed, &mut inverse, stop)?;
        let mut matrix = NewtonMatrix::new(self, kernel, pairs, wanted.fixed);
        let product = |y: &[f32], out: &mut [f32]| matrix.multiply(y, out, stop);
        let precondition = |r: &mut [f32], z: &mut [f32]| kept.precondition(&mut inverse, r, z, stop);
        let mut right: Vec<f32> = left.iter().map(|l| -(l / unit) as f32).collect();
        self.times_root(&mut right);
        let b = times_neighbours(pairs, &right);
        let limits = MinresLimits { reduction: wanted.reduction, steps: STEPS };
        let (y, outcome) = minres(product, precondition, b, limits, stop)?;
        let applications = matrix.applications;
        operators.plans.applications += applications;
        operators.plans.solves += 1;
        Ok(Some(self.solution(pairs, &y, unit, outcome.steps)))
    }

    /// How the attractions of open cells follow the gaps of others; nothing on contact.
    fn coupling(&self, attraction: &Attraction, state: &Equilibrium) -> Option<Pairs> {
        let Self { both, root, is_open, .. } = self;
        let zone_root: Vec<f64> = root.iter().zip(is_open).map(|(r, open)| f64::from(r * open)).collect();
        attraction.coupling(both, &both.carry(&state.cells, &state.gap), &zone_root)
    }

    fn times_root(&self, values: &mut [f32]) {
        update(values, &self.root, |value, root| *value *= root);
    }

    /// The diagonal d of the preconditioner.
    fn diagonal(&self, own: f32) -> Vec<f32> {
        let of = |(r, &open): (&f32, &f32)| {
            if open > 0.0 { (1.0 - r * r * own).max(LEAST as f32) } else { own }.recip()
        };
        self.root.iter().zip(&self.is_open).map(of).collect()
    }

    /// From the unknowns of the system to net pressures and gaps.
    fn solution(&self, pairs: Option<&Pairs>, y: &[f32], unit: f64, steps: usize) -> NewtonSolution {
        let mut change = times_neighbours(pairs, y);
        self.times_root(&mut change);
        let opening = y.iter().zip(&self.root).zip(&self.is_open);
        NewtonSolution {
            change: change.into_iter().map(|c| unit * f64::from(c)).collect(),
            opening: opening.map(|((y, root), open)| unit * f64::from(y * open / root)).collect(),
            steps,
        }
    }
}

/// The matrix of the system.
struct NewtonMatrix<'a> {
    linear: &'a Linear,
    kernel: PlannedPressure<'a>,
    pairs: Option<&'a Pairs>,
    fixed: Fixed,
    /// Room for a pressure, and for the displacement under it.
    source: Vec<f32>,
    u: Vec<f32>,
    /// Number of products.
    applications: usize,
}

impl<'a> NewtonMatrix<'a> {
    fn new(linear: &'a Linear, kernel: PlannedPressure<'a>, pairs: Option<&'a Pairs>, fixed: Fixed) -> Self {
        let room = || vec![0.0f32; linear.both.len()];
        Self { linear, kernel, pairs, fixed, source: room(), u: room(), applications: 0 }
    }

    /// Writes the product by it.
    fn multiply(&mut self, y: &[f32], out: &mut [f32], stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { linear, kernel, pairs, fixed, source, u, applications } = self;
        *applications += 1;
        add_neighbours(*pairs, y, source);
        let own: Vec<f32> = source.iter().zip(&linear.is_open).map(|(s, open)| s * open).collect();
        linear.times_root(source);
        kernel.apply_until(&linear.both, source, &linear.both, u, stop)?;
        if let Fixed::MeanPlane(constant) = fixed {
            let offset = (*constant * sum(source)) as f32;
            each(u, |u| *u -= offset);
        }
        linear.times_root(u);
        add_neighbours(*pairs, u, out);
        update(out, &own, |out, own| *out -= own);
        Ok(())
    }
}

/// `N y`, which changes nothing on contact.
fn add_neighbours(pairs: Option<&Pairs>, y: &[f32], out: &mut [f32]) {
    out.copy_from_slice(y);
    if let Some(pairs) = pairs {
        pairs.add_product(1.0, y, out);
    }
}

fn times_neighbours(pairs: Option<&Pairs>, y: &[f32]) -> Vec<f32> {
    let mut out = vec![0.0; y.len()];
    add_neighbours(pairs, y, &mut out);
    out
}

/// The preconditioner of the system.
struct RoughInverse<'a> {
    linear: &'a Linear,
    diagonal: Vec<f32>,
    torus: Option<&'a mut FftConvolution<f32>>,
    extension: Extension,
    recorder: Recorder,
}

impl RoughInverse<'_> {
    fn apply(&mut self, r: &[f32], z: &mut [f32], stop: Stop<'_>) -> Result<(), Interrupted> {
        let Self { linear, diagonal, torus, extension, recorder } = self;
        let Linear { contact, both, is_open, .. } = linear;
        z.copy_from_slice(r);
        update(z, diagonal, |z, d| *z *= d);
        let Some(transform) = torus.as_deref_mut() else { return Ok(()) };
        update(z, is_open, |z, open| *z *= open);
        let mut on_contact = contact.carry(both, r);
        let mut found = vec![0.0; contact.len()];
        let extensions = std::array::from_mut(extension);
        let mut inverse = TorusInverse { transform, extensions, recorder: recorder.clone() };
        inverse.apply(contact, 0.0, &mut on_contact, &mut found, stop)?;
        both.add_carried(contact, &found, z);
        Ok(())
    }
}

/// A fixed net force is the product with `force`; the correction of it is distributed by the weights.
struct KeptForce {
    force: Vec<f32>,
    weights: Vec<f32>,
    /// Their product; 0 where the force is free.
    total: f64,
}

impl KeptForce {
    fn new(
        linear: &Linear,
        pairs: Option<&Pairs>,
        fixed: Fixed,
        inverse: &mut RoughInverse<'_>,
        stop: Stop<'_>,
    ) -> Result<Self, Interrupted> {
        let force = times_neighbours(pairs, &linear.root);
        let mut kept = Self { weights: vec![0.0; force.len()], force, total: 0.0 };
        if fixed == Fixed::Force {
            inverse.apply(&kept.force, &mut kept.weights, stop)?;
            kept.total = dot(&kept.force, &kept.weights);
        }
        Ok(kept)
    }

    fn precondition(
        &self,
        inverse: &mut RoughInverse<'_>,
        r: &mut [f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { force, weights, total } = self;
        let less = |values: &mut [f32], share: f64, of: &[f32]| {
            let share = share as f32;
            update(values, of, |value, of| *value -= share * of);
        };
        if *total > 0.0 {
            less(r, dot(weights, r) / total, force);
        }
        inverse.apply(r, z, stop)?;
        if *total > 0.0 {
            less(z, dot(force, z) / total, weights);
        }
        Ok(())
    }
}
