//! The linearised conditions of friction on a contact: stick cells have two unknowns, slip cells one, along the
//! tangent of their disk.

use crate::geometry::{CellSet, Window};
use crate::linear::{
    Energy, Extension, Fixed, LinearSystem, PcgOutcome, Preconditioned, Preconditioner, StoppingCriteria,
    TORUS_ENERGY, TorusInverse, Vectors,
};
use crate::operator::{InfluenceOperator, Planned, TangentialOperators};
use crate::parts::{Part, Recorder};
use crate::real::{dot, each, largest, sum, update};
use crate::tuning::CHUNK;
use contact_model::{Interrupted, Stop};
use numerics::parallel::map;

/// Largest `|w|/b` of a slip cell; a cell beyond it is treated as if it did not move.
const STIFFEST: f64 = 1e15;
/// Share of the larger resistance below which the sum of the tractions cannot be moved in a direction.
const IMMOVABLE: f64 = 1e-5;

/// The compliance that the preconditioner assumes for a slip cell along its tangent, over its own compliance.
/// Of the values from 0.25 to 4 it takes the fewest steps (131 at N = 512, D_f = 2.4, F_bar = 20, and 158
/// with the value 0.5), because slip cells move together.
pub const SLIPPING: f32 = 2.0;

/// The admissible changes of the traction of each cell.
#[derive(Debug, Clone, Default)]
pub struct SlipBranch {
    /// Unit vectors along which slip cells move; zero for stick cells. In double precision: of a slip that is
    /// large beside what is left on stick cells an angle of single precision would be as much.
    tangent: Vec<[f64; 2]>,
    /// `|w|/b` of slip cells: the term that turns the traction into the direction of the slip.
    turning: Vec<f32>,
    /// The cells that stick, and their places among all.
    pub stick: CellSet,
    sticking: Vec<u32>,
}

/// Changes both components of each cell by its tangent.
fn each_cell<T: Send>(v: &mut [T], tangent: &[[f64; 2]], change: impl Fn([&mut T; 2], [f64; 2]) + Sync) {
    let (x, y) = v.split_at_mut(tangent.len());
    let chunks = x.chunks_mut(CHUNK).zip(y.chunks_mut(CHUNK)).zip(tangent.chunks(CHUNK));
    map(tangent.len(), chunks, |((x, y), tangent)| {
        for ((x, y), tangent) in x.iter_mut().zip(y).zip(tangent) {
            change([x, y], *tangent);
        }
    });
}

impl SlipBranch {
    /// All cells stick.
    pub fn stuck(cells: &CellSet) -> Self {
        let n = cells.len();
        let sticking = (0..n as u32).collect();
        Self { tangent: vec![[0.0; 2]; n], turning: vec![0.0; n], stick: cells.clone(), sticking }
    }

    /// From the traction `y = q + rho w` that a cell without a limit would have: cells of `|y| > b` slip in its
    /// direction.
    pub fn of(cells: &CellSet, y: &[f64], w: &[f64], limit: &[f64]) -> Self {
        let n = cells.len();
        let mut branch =
            Self { tangent: Vec::with_capacity(n), turning: Vec::with_capacity(n), ..Self::default() };
        for (i, &b) in limit.iter().enumerate() {
            let (x, y) = (y[i], y[n + i]);
            let length = x.hypot(y);
            if length > b {
                branch.tangent.push([-y / length, x / length]);
                branch.turning.push((w[i].hypot(w[n + i]) / b).min(STIFFEST) as f32);
            } else {
                branch.tangent.push([0.0; 2]);
                branch.turning.push(0.0);
            }
        }
        branch.stick = cells.filter(&branch.tangent, |[x, y]| x == 0.0 && y == 0.0);
        branch.sticking = (0..n as u32).filter(|&i| !branch.slips(i as usize)).collect();
        branch
    }

    /// Whether cell i slips.
    pub fn slips(&self, i: usize) -> bool {
        let [x, y] = self.tangent[i];
        x != 0.0 || y != 0.0
    }

    /// Removes the components that slip cells do not admit.
    pub fn restrict(&self, v: &mut [f32]) {
        each_cell(v, &self.tangent, |[x, y], tangent| {
            let [tx, ty] = tangent.map(|t| t as f32);
            if tx != 0.0 || ty != 0.0 {
                let along = *x * tx + *y * ty;
                (*x, *y) = (along * tx, along * ty);
            }
        });
    }

    /// The same in double precision.
    pub fn restrict_f64(&self, v: &mut [f64]) {
        each_cell(v, &self.tangent, |[x, y], [tx, ty]| {
            if tx != 0.0 || ty != 0.0 {
                let along = *x * tx + *y * ty;
                (*x, *y) = (along * tx, along * ty);
            }
        });
    }

    /// Subtracts a uniform displacement from a residual, as far as cells may follow it.
    fn subtract(&self, [x, y]: [f32; 2], r: &mut [f32]) {
        each_cell(r, &self.tangent, |[rx, ry], tangent| {
            let [tx, ty] = tangent.map(|t| t as f32);
            let along = x * tx + y * ty;
            let (x, y) = if tx != 0.0 || ty != 0.0 { (along * tx, along * ty) } else { (x, y) };
            (*rx, *ry) = (*rx - x, *ry - y);
        });
    }

    /// Adds what turns tractions into the direction of the slip.
    pub fn add_turning(&self, t: &[f64], u: &mut [f64], factor: f64) {
        let n = self.turning.len();
        for (i, &turning) in self.turning.iter().enumerate() {
            u[i] += factor * f64::from(turning) * t[i];
            u[n + i] += factor * f64::from(turning) * t[n + i];
        }
    }
}

/// The linearised conditions as an operator on restricted tractions.
#[derive(Debug)]
pub struct LinearisedFriction<'a> {
    /// The kernel.
    pub kernel: Planned<'a, 2, 3>,
    /// The constant in its diagonal entries, which is not part of the displacement.
    pub shift: f32,
    /// The admissible changes of the cells.
    pub branch: &'a SlipBranch,
}

impl InfluenceOperator<f32> for LinearisedFriction<'_> {
    fn apply_until(
        &mut self,
        sources: &CellSet,
        t: &[f32],
        targets: &CellSet,
        u: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { kernel, shift, branch } = self;
        kernel.apply_until(sources, t, targets, u, stop)?;
        let n = sources.len();
        if *shift > 0.0 {
            for (t, u) in t.chunks_exact(n).zip(u.chunks_exact_mut(n)) {
                let mean = *shift * sum(t) as f32;
                each(u, |u| *u -= mean);
            }
        }
        branch.restrict(u);
        for (t, u) in t.chunks_exact(n).zip(u.chunks_exact_mut(n)) {
            let chunks = u.chunks_mut(CHUNK).zip(t.chunks(CHUNK)).zip(branch.turning.chunks(CHUNK));
            map(n, chunks, |((u, t), turning)| {
                for ((u, t), turning) in u.iter_mut().zip(t).zip(turning) {
                    *u += turning * t;
                }
            });
        }
        Ok(())
    }
}

/// The preconditioner, split by stick and slip cells: the inverse of the kernel on a torus where cells stick,
/// a number where they slip. Between the two nothing is passed: what an unsplit inverse passes on to slip
/// cells, which do not follow it, makes it poor.
///
/// With a prescribed force corrections have no sum: `P M P'` with `P = 1 - W (B W)^-1 B`, B the sums of both
/// components, which is symmetric and keeps the sums whatever W is; it is `M B'` of the first branch of an increment.
#[derive(Debug)]
pub struct BranchPreconditioner<'a> {
    /// On stick cells.
    torus: TorusInverse<'a, 2, 3>,
    /// The admissible changes of the cells.
    branch: &'a SlipBranch,
    /// Compliance of a slip cell along its tangent: with its turning the diagonal.
    own: f32,
    /// How the sums are kept; `None` where they are free.
    pub sums: Option<FixedSums>,
    /// Vectors on the stick cells.
    on_stick: &'a mut StickVectors,
    recorder: Recorder,
}

/// Vectors on the stick cells.
#[derive(Debug, Default)]
struct StickVectors {
    r: Vec<f32>,
    z: Vec<f32>,
}

/// How the sums of both components are kept.
#[derive(Debug, Clone, Default)]
pub struct FixedSums {
    /// W.
    weights: [Vec<f32>; 2],
    /// Rows of the inverse of `B W`, where the sums can be moved.
    inverse: [[f64; 2]; 2],
}

impl FixedSums {
    /// The combination of the weights with these sums, as far as they can be moved.
    pub fn spread(&self, sums: [f64; 2], v: &mut [f32]) {
        let factors = times(self.inverse, sums).map(|factor| factor as f32);
        for (weights, factor) in self.weights.iter().zip(factors) {
            update(v, weights, |v, w| *v += factor * w);
        }
    }
}

fn times(matrix: [[f64; 2]; 2], [x, y]: [f64; 2]) -> [f64; 2] {
    matrix.map(|[a, b]| a * x + b * y)
}

/// The sums of both components.
fn sums_of(v: &[f32]) -> [f64; 2] {
    let (x, y) = v.split_at(v.len() / 2);
    [sum(x), sum(y)]
}

/// The inverse of a symmetric matrix `[xx, yy, xy]` on the directions of eigenvalues that are more than a share
/// of the larger one.
pub fn inverse_of([xx, yy, xy]: [f64; 3], share: f64) -> [f64; 3] {
    let (mean, half) = (f64::midpoint(xx, yy), 0.5 * (xx - yy));
    let radius = half.hypot(xy);
    let (large, small) = (mean + radius, mean - radius);
    if large <= 0.0 || !large.is_finite() {
        return [0.0; 3];
    }
    // The direction of the larger one: (1 + cos)/2, (1 - cos)/2, sin/2 of twice its angle.
    let (cos, sin) = if radius > 0.0 { (half / radius, xy / radius) } else { (1.0, 0.0) };
    let (a, b) = (large.recip(), if small > share * large { small.recip() } else { 0.0 });
    let (middle, difference) = (f64::midpoint(a, b), 0.5 * (a - b));
    [middle + difference * cos, middle - difference * cos, difference * sin]
}

impl BranchPreconditioner<'_> {
    /// Keeps the sums from now on. `weights` are those of the first branch of the increment, which are found where
    /// there are none; stick cells keep them.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn fix_sums(
        &mut self,
        set: &CellSet,
        weights: &mut Option<[Vec<f32>; 2]>,
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let n = set.len();
        let ones = [0, 1].map(|component| {
            let mut ones = vec![0.0; 2 * n];
            ones[component * n..][..n].fill(1.0);
            self.branch.restrict(&mut ones);
            ones
        });
        let known = weights.is_some();
        let mut made = |split: &mut Self| {
            let first = match &*weights {
                Some(weights) => weights.clone(),
                None => weights.insert(split.weights(set, &ones, stop)?).clone(),
            };
            let mut fixed = FixedSums { weights: first, ..FixedSums::default() };
            for (weights, ones) in fixed.weights.iter_mut().zip(&ones) {
                for (k, (weight, one)) in weights.iter_mut().zip(ones).enumerate() {
                    if split.branch.slips(k % n) {
                        *weight = one / (split.branch.turning[k % n] + split.own);
                    }
                }
            }
            let [x, y] = fixed.weights.each_ref().map(|weights| sums_of(weights));
            let determinant = x[0] * y[1] - x[1] * y[0];
            let movable = determinant > IMMOVABLE * x[0].max(y[1]).powi(2);
            fixed.inverse = if movable {
                [[y[1] / determinant, -y[0] / determinant], [-x[1] / determinant, x[0] / determinant]]
            } else {
                let [xx, yy, xy] = inverse_of([x[0], y[1], f64::midpoint(x[1], y[0])], IMMOVABLE);
                [[xx, xy], [xy, yy]]
            };
            if !movable {
                *weights = None;
            }
            Ok((fixed, movable))
        };
        let (mut fixed, movable) = made(self)?;
        if known && !movable {
            // Those of another branch move no sum of this one.
            fixed = made(self)?.0;
        }
        self.sums = Some(fixed);
        Ok(())
    }

    /// `M B'` of the branch.
    fn weights(
        &mut self,
        set: &CellSet,
        ones: &[Vec<f32>; 2],
        stop: Stop<'_>,
    ) -> Result<[Vec<f32>; 2], Interrupted> {
        let mut weights = ones.each_ref().map(|ones| vec![0.0; ones.len()]);
        for (ones, weights) in ones.iter().zip(&mut weights) {
            self.precondition(set, &mut ones.clone(), weights, stop)?;
        }
        Ok(weights)
    }

    /// `z = M r` of a restricted residual.
    fn precondition(
        &mut self,
        set: &CellSet,
        r: &mut [f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<(), Interrupted> {
        let Self { torus, branch, own, on_stick: StickVectors { r: on_stick, z: stuck }, .. } = self;
        let (n, stick, own) = (set.len(), &branch.stick, *own);
        if stick.len() == n {
            torus.precondition(stick, 0.0, r, z, stop)?;
            return Ok(());
        }
        for (r, z) in r.chunks_exact(n).zip(z.chunks_exact_mut(n)) {
            let chunks = z.chunks_mut(CHUNK).zip(r.chunks(CHUNK)).zip(branch.turning.chunks(CHUNK));
            map(n, chunks, |((z, r), turning)| {
                for ((z, r), turning) in z.iter_mut().zip(r).zip(turning) {
                    *z = r / (turning + own);
                }
            });
        }
        if stick.is_empty() {
            return Ok(());
        }
        on_stick.clear();
        for r in r.chunks_exact(n) {
            on_stick.extend(branch.sticking.iter().map(|&i| r[i as usize]));
        }
        stuck.resize(on_stick.len(), 0.0);
        torus.precondition(stick, 0.0, on_stick, stuck, stop)?;
        for (stuck, z) in stuck.chunks_exact(stick.len()).zip(z.chunks_exact_mut(n)) {
            for (&i, stuck) in branch.sticking.iter().zip(stuck) {
                z[i as usize] = *stuck;
            }
        }
        Ok(())
    }
}

impl Preconditioner<f32> for BranchPreconditioner<'_> {
    fn apply(
        &mut self,
        set: &CellSet,
        _: f32,
        r: &mut [f32],
        z: &mut [f32],
        stop: Stop<'_>,
    ) -> Result<Preconditioned, Interrupted> {
        let recorder = self.recorder.clone();
        recorder.timed(Part::Preconditioner, || {
            if let Some(sums) = self.sums.take() {
                let products = sums.weights.each_ref().map(|weights| dot(weights, r));
                let [[a, b], [c, d]] = sums.inverse;
                let offset = times([[a, c], [b, d]], products).map(|offset| offset as f32);
                self.branch.subtract(offset, r);
                let done = self.precondition(set, r, z, stop);
                let [x, y] = sums_of(z);
                sums.spread([-x, -y], z);
                self.sums = Some(sums);
                done?;
            } else {
                self.precondition(set, r, z, stop)?;
            }
            Ok(Preconditioned { largest: f64::from(largest(r)), product: dot(r, z), sum: 0.0 })
        })
    }

    fn energy_factor(&self) -> f64 {
        TORUS_ENERGY
    }
}

/// Room for the systems of an increment, kept from one to the next.
#[derive(Debug, Default)]
pub struct FrictionRoom {
    /// Vectors of conjugate gradients.
    vectors: Vectors<f32>,
    /// Extension of each component.
    extensions: [Extension; 2],
    on_stick: StickVectors,
    /// The weights by which the sums of corrections are kept, in the present increment.
    pub weights: Option<[Vec<f32>; 2]>,
}

/// A linear system on a branch, with its preconditioner.
#[derive(Debug)]
pub struct BranchSystem<'a> {
    /// The linearised conditions.
    pub conditions: LinearisedFriction<'a>,
    /// The preconditioner.
    pub preconditioner: BranchPreconditioner<'a>,
    /// The weights of the room.
    pub weights: &'a mut Option<[Vec<f32>; 2]>,
    vectors: &'a mut Vectors<f32>,
}

impl FrictionRoom {
    /// Takes the cells of the systems that follow.
    pub fn take(&mut self, cells: &CellSet) {
        self.vectors.take_fields(cells.clone(), 2);
    }

    /// The system of a branch on the cells that were taken; `None` without any. `every_lag` as in
    /// [`Plans::system`](crate::operator::Plans::system).
    ///
    /// # Errors
    /// [`Interrupted`] by the stop while operators are planned.
    pub fn system<'a>(
        &'a mut self,
        operators: &'a mut TangentialOperators,
        branch: &'a SlipBranch,
        every_lag: bool,
        stop: Stop<'_>,
    ) -> Result<Option<BranchSystem<'a>>, Interrupted> {
        let recorder = operators.recorder().clone();
        let (own, shift) = (operators.table().own(), operators.table().shift());
        let (decay, extended) = (operators.tuning().decay, operators.tuning().extended);
        let Self { vectors, extensions, on_stick, weights } = self;
        let Some((kernel, transform)) = operators.system(&vectors.set, every_lag, stop)? else {
            return Ok(None);
        };
        let decay = if branch.stick.len() >= extended { decay } else { 0.0 };
        recorder.timed(Part::Sets, || extend(extensions, transform.window(), decay, &branch.stick));
        let torus = TorusInverse { transform, extensions, recorder: recorder.clone() };
        let preconditioner = BranchPreconditioner {
            torus,
            branch,
            own: SLIPPING * own as f32,
            sums: None,
            on_stick,
            recorder,
        };
        let conditions = LinearisedFriction { kernel, shift: shift as f32, branch };
        Ok(Some(BranchSystem { conditions, preconditioner, weights, vectors }))
    }

    /// `M r` for the inverse M on a torus of all cells that were taken, restricted to a branch: `r' M r` times
    /// [`TORUS_ENERGY`] is an upper estimate of the energy of r, whichever cells slip. `None` without cells.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn stuck_inverse(
        &mut self,
        operators: &mut TangentialOperators,
        branch: &SlipBranch,
        residuals: &mut [Vec<f32>; 2],
        stop: Stop<'_>,
    ) -> Result<Option<[Vec<f32>; 2]>, Interrupted> {
        let recorder = operators.recorder().clone();
        let (decay, extended) = (operators.tuning().decay, operators.tuning().extended);
        let Self { vectors, extensions, .. } = self;
        let Some((_, transform)) = operators.system(&vectors.set, true, stop)? else { return Ok(None) };
        recorder.timed(Part::Preconditioner, || {
            let decay = if vectors.set.len() >= extended { decay } else { 0.0 };
            extend(extensions, transform.window(), decay, &vectors.set);
            let mut inverse = TorusInverse { transform, extensions, recorder: recorder.clone() };
            let mut found = residuals.each_ref().map(|r| vec![0.0; r.len()]);
            for (r, z) in residuals.iter_mut().zip(&mut found) {
                inverse.precondition(&vectors.set, 0.0, r, z, stop)?;
                branch.restrict(z);
            }
            Ok(Some(found))
        })
    }
}

impl BranchSystem<'_> {
    /// Solves for a right-hand side and writes the solution over it.
    ///
    /// # Errors
    /// [`Interrupted`] by the stop.
    pub fn solve(
        &mut self,
        right: &mut [f64],
        criteria: StoppingCriteria,
        stop: Stop<'_>,
    ) -> Result<PcgOutcome, Interrupted> {
        let size = largest(right);
        if size <= 0.0 || !size.is_finite() {
            right.fill(0.0);
            return Ok(PcgOutcome::default());
        }
        // In units of its own size, as the energy in the criteria.
        let energy = criteria.energy.map(|energy| Energy { base: energy.base / (size * size), ..energy });
        let criteria = StoppingCriteria { energy, floor: criteria.floor / size, ..criteria };
        let Self { conditions, preconditioner, vectors, .. } = self;
        let recorder = preconditioner.recorder.clone();
        recorder.timed(Part::Vectors, || {
            let system =
                LinearSystem { operator: conditions, preconditioner, vectors, fixed: Fixed::Approach };
            system.solve(right, size, criteria, stop)
        })
    }
}

/// Takes the stick cells of a branch for the extension of residuals in the preconditioner.
fn extend(extensions: &mut [Extension; 2], window: Window, decay: f32, stick: &CellSet) {
    for extension in extensions {
        extension.set(stick, window, decay);
    }
}
