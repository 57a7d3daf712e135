//! How a state responds to a small change of its load: how stiff it is, and with adhesion how stable.
//!
//! Some cells follow the change, the others keep what they have: a cell at its hardness its pressure, a slip
//! cell the length of its traction, an open cell without attraction its zero. On the cells that follow, the
//! conditions are linear. Unit displacements of the bodies in N directions change the tractions by X with
//!
//! ```text
//! A X = B,
//! ```
//!
//! where A is symmetric and B says which displacement each number follows; the stiffness is `B' A^-1 B`, a
//! matrix of N rows. Each kind of contact has its own A: the influence matrix of the cells below the hardness
//! ([`normal`]), the linearised conditions of stick and slip ([`tangential`]), the influence matrix less the
//! slopes of the attraction ([`adhesive`]).
//!
//! [`refine`] solves all of them. It corrects X with residuals `R = B - A X` in double precision, until the
//! stiffness is known to the tolerance. For any X it is, with `S = B' X`,
//!
//! ```text
//! B' A^-1 B = S + R' X + R' A^-1 R,
//! ```
//!
//! so that an error of X counts with its square. Where A is positive definite, the stiffness lies between the
//! Ritz value `S (X' A X)^-1 S` and the sum with an upper bound of the energy `R' A^-1 R`.

pub mod adhesive;
pub mod normal;
pub mod tangential;

use crate::friction::inverse_of;
use crate::real::{dot, update};
use crate::tuning::Tuning;
use contact_model::{Interrupted, Stop};

/// A stiffness, nondimensional, with the error estimates that it has by its solve and by its state: a
/// symmetric matrix of N rows by its E entries.
#[derive(Debug, Clone)]
pub struct Stiffness<const N: usize, const E: usize> {
    /// The stiffness; `[xx, yy, xy]` for two rows.
    pub value: [f64; E],
    /// Estimated error of the linear solve, relative to the largest eigenvalue.
    pub solve_error: f64,
    /// Estimated error from the state, relative to the same: cells that may follow the load otherwise than was
    /// assumed.
    pub set_error: f64,
    /// X, on the cells that respond.
    pub change: [Vec<f64>; N],
    /// Conjugate gradient steps.
    pub steps: usize,
}

/// Of the force in the approach or in the plane.
pub type NormalStiffness = Stiffness<1, 1>;
/// Of both components of the tangential force in both of the displacement.
pub type TangentialStiffness = Stiffness<2, 3>;

impl<const N: usize, const E: usize> Stiffness<N, E> {
    /// That of no contact, which is exact.
    pub fn nothing() -> Self {
        let change = [const { Vec::new() }; N];
        Self { value: [0.0; E], solve_error: 0.0, set_error: 0.0, change, steps: 0 }
    }

    /// Before anything is known of it.
    fn unknown() -> Self {
        Self { solve_error: f64::INFINITY, ..Self::nothing() }
    }

    /// Estimated relative error, both parts.
    pub fn error(&self) -> f64 {
        self.solve_error + self.set_error
    }
}

impl NormalStiffness {
    /// The stiffness as a number.
    pub fn k(&self) -> f64 {
        self.value[0]
    }

    /// The change of the pressure per unit of approach.
    pub fn q(&self) -> &[f64] {
        &self.change[0]
    }
}

/// The linear conditions of the cells that respond, `A X = B`.
pub trait Conditions<const N: usize, const E: usize> {
    /// Whether A is positive definite. Where it is not, errors are estimated to both sides.
    const DEFINITE: bool = true;

    /// B: the displacement that each number follows.
    fn displacements(&self) -> [Vec<f64>; N];

    /// `B' x`: the sums of the tractions.
    fn forces(&self, x: &[f64]) -> [f64; N];

    /// Writes `R = B - A X` and returns whether it is in double precision, which that of a `guess` need not be.
    ///
    /// # Errors
    /// [`Interrupted`] by a stop.
    fn residual(
        &mut self,
        x: &[Vec<f64>; N],
        is_guess: bool,
        r: &mut [Vec<f64>; N],
    ) -> Result<bool, Interrupted>;

    /// Estimates the energy of a residual, solves `A x = r` roughly and writes x over r. `None` where these
    /// conditions have no response, which ends the refinement.
    ///
    /// # Errors
    /// [`Interrupted`] by a stop.
    fn correct(
        &mut self,
        r: &mut [Vec<f64>; N],
        goal: Goal<N>,
    ) -> Result<Option<StiffnessCorrection<E>>, Interrupted>;

    /// Change of the stiffness that the uncertainty of the state allows, by X and its last residual.
    fn set_error(&self, x: &[Vec<f64>; N]) -> f64;
}

/// The accuracy that a correction aims at.
#[derive(Debug, Clone, Copy)]
pub struct Goal<const N: usize> {
    /// The stiffness in each direction before the correction.
    pub bases: [f64; N],
    /// The share of it at which the energy of what is left ends the correction.
    pub share: f64,
    /// The share of it below which the energy of the residual makes a correction superfluous.
    pub enough: f64,
    /// Whether nothing but the energy is wanted.
    pub only_energy: bool,
}

/// The result of a correction, beside the solution itself.
#[derive(Debug, Clone, Copy)]
pub struct StiffnessCorrection<const E: usize> {
    /// Upper estimate of the energy `R' A^-1 R` of the residual before it, where A is not definite of its
    /// magnitude.
    pub energy: [f64; E],
    /// Conjugate gradient steps; `None` where the energy was enough and there is no correction.
    pub steps: Option<usize>,
}

/// Corrects X from a guess until the stiffness is known to half of the `tolerance`, or until that improves no
/// more.
///
/// # Errors
/// [`Interrupted`] by the stop, which the conditions ask too.
///
/// Cost: two to four corrections, each with one application of A in double precision.
pub fn refine<const N: usize, const E: usize, C: Conditions<N, E>>(
    conditions: &mut C,
    guess: Option<[Vec<f64>; N]>,
    tolerance: f64,
    tuning: &Tuning,
    stop: Stop<'_>,
) -> Result<Stiffness<N, E>, Interrupted>
where
    [f64; E]: StiffnessEntries,
{
    let mut r = conditions.displacements();
    let mut x = guess;
    let mut best = Stiffness::unknown();
    let (mut steps, mut unimproved) = (0, 0);
    for round in 0..tuning.stiffness_rounds {
        let exact = match &x {
            Some(x) => conditions.residual(x, round == 0, &mut r)?,
            None => true,
        };
        let before = x.as_ref().map_or(Products::NONE, |x| Products::new(conditions, x, &r));
        let goal = Goal {
            bases: before.bases(),
            share: tuning.stiffness_aim * tolerance,
            enough: tuning.stiffness_share * tolerance,
            only_energy: round + 1 == tuning.stiffness_rounds || unimproved > 2,
        };
        let Some(found) = conditions.correct(&mut r, goal)? else { break };
        if let Some(x) = &x
            && exact
        {
            let (value, error) = before.stiffness::<E>(found.energy, C::DEFINITE);
            unimproved = if error < IMPROVED * best.solve_error { 0 } else { unimproved + 1 };
            if error < best.solve_error {
                let set_error = relative(conditions.set_error(x), value.largest());
                best = Stiffness { value, solve_error: error, set_error, change: x.clone(), steps };
            }
            if error <= goal.enough || found.steps.is_none() || stop.stops() {
                break;
            }
        }
        steps += found.steps.unwrap_or(0);
        if let Some(x) = &mut x {
            for (x, correction) in x.iter_mut().zip(&r) {
                update(x, correction, |x, correction| *x += correction);
            }
        } else {
            x = Some(r.clone());
        }
    }
    Ok(Stiffness { steps, ..best })
}

/// An error that falls by less than this factor has not improved.
const IMPROVED: f64 = 0.9;
/// Share of the largest eigenvalue of `X' A X` below which another one counts as none.
const SINGULAR: f64 = 1e-14;

/// `S = B' X` and `R' X`, both symmetric but for rounding.
struct Products<const N: usize> {
    forces: [[f64; N]; N],
    left: [[f64; N]; N],
}

impl<const N: usize> Products<N> {
    /// Before there is an X.
    const NONE: Self = Self { forces: [[0.0; N]; N], left: [[0.0; N]; N] };

    fn new<const E: usize>(conditions: &impl Conditions<N, E>, x: &[Vec<f64>; N], r: &[Vec<f64>; N]) -> Self {
        Self {
            forces: x.each_ref().map(|x| conditions.forces(x)),
            left: x.each_ref().map(|x| r.each_ref().map(|r| dot(r, x))),
        }
    }

    fn bases(&self) -> [f64; N] {
        std::array::from_fn(|i| self.forces[i][i] + self.left[i][i])
    }

    /// The stiffness, and the estimated error of its solve relative to its largest eigenvalue.
    fn stiffness<const E: usize>(&self, energy: [f64; E], definite: bool) -> ([f64; E], f64)
    where
        [f64; E]: StiffnessEntries,
    {
        let forces = <[f64; E]>::of(|i, j| self.forces[i][j]);
        let left = <[f64; E]>::of(|i, j| self.left[i][j]);
        let second: [f64; E] = std::array::from_fn(|k| forces[k] + left[k]);
        if !definite {
            return (second, relative(energy.largest(), second.largest().abs()));
        }
        let ritz = forces.ritz(std::array::from_fn(|k| forces[k] - left[k]));
        let width: [f64; E] = std::array::from_fn(|k| second[k] + energy[k] - ritz[k]);
        (ritz, relative(width.largest().max(0.0), ritz.largest()))
    }
}

/// A part of a stiffness relative to the whole; 0 where there is none.
fn relative(part: f64, whole: f64) -> f64 {
    if whole.abs() <= 0.0 { 0.0 } else { part / whole }
}

/// The entries of a symmetric matrix.
pub trait StiffnessEntries: Sized {
    /// From its rows and columns.
    fn of(entry: impl Fn(usize, usize) -> f64) -> Self;

    /// `S F^-1 S`.
    fn ritz(self, form: Self) -> Self;

    /// The largest eigenvalue.
    fn largest(self) -> f64;
}

impl StiffnessEntries for [f64; 1] {
    fn of(entry: impl Fn(usize, usize) -> f64) -> Self {
        [entry(0, 0)]
    }

    fn ritz(self, [form]: Self) -> Self {
        [self[0] * self[0] / form]
    }

    fn largest(self) -> f64 {
        self[0]
    }
}

impl StiffnessEntries for [f64; 3] {
    fn of(entry: impl Fn(usize, usize) -> f64) -> Self {
        [entry(0, 0), entry(1, 1), f64::midpoint(entry(0, 1), entry(1, 0))]
    }

    fn ritz(self, form: Self) -> Self {
        let [xx, yy, xy] = self;
        let [a, b, c] = inverse_of(form, SINGULAR);
        [
            a * xx * xx + 2.0 * c * xx * xy + b * xy * xy,
            a * xy * xy + 2.0 * c * xy * yy + b * yy * yy,
            a * xx * xy + c * (xx * yy + xy * xy) + b * yy * xy,
        ]
    }

    fn largest(self) -> f64 {
        let [xx, yy, xy] = self;
        f64::midpoint(xx, yy) + (0.5 * (xx - yy)).hypot(xy)
    }
}
