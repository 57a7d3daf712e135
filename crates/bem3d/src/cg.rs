//! Preconditioned conjugate gradients on one set of cells.

use crate::cells::CellSet;
use crate::operator::Operators;
use contact_model::Stop;

/// Safety factor of the energy estimate on a torus.
pub const TORUS: f64 = 2.0;

/// A linear equation whose value `r' x` counts: how small the energy of its error shall be.
#[derive(Debug, Clone, Copy)]
pub struct Energy {
    /// Relative error of the value that is allowed.
    pub share: f64,
    /// The value before the correction.
    pub base: f64,
}

/// What one call of [`correct`] is asked to do.
#[derive(Debug, Clone, Copy)]
pub struct Request {
    /// Keep the sum of the correction at 0: the force is prescribed and the approach adapts.
    pub fixed_sum: bool,
    /// Stop when the residual has fallen by this factor (2-norm) ...
    pub reduction: f64,
    /// ... or the energy of its error is below this share of the value that the equation is solved for ...
    pub energy: Option<Energy>,
    /// ... or the residual is below this value everywhere ...
    pub floor: f64,
    /// ... or after so many steps.
    pub steps: usize,
    /// Use the spectral preconditioner.
    pub precondition: bool,
    /// Whether the kernel is exact at every lag, or only at most ([`Operators::correcting`]).
    pub exact: bool,
}

/// A correction and what it took.
#[derive(Debug)]
pub struct Correction {
    /// Change of the pressure on the set.
    pub x: Vec<f64>,
    /// Conjugate gradient steps.
    pub steps: usize,
}

/// Solves `K x = r` on a set approximately; with `fixed_sum`, `K x = r + const` and `sum x = 0`.
///
/// One single-precision application of K a step (and one of the preconditioner): the caller checks the result with the exact
/// operator. The preconditioner is projected so that the constraint holds at every step.
pub fn correct(
    operators: &mut Operators,
    set: &CellSet,
    right: &[f64],
    request: Request,
    stop: Stop<'_>,
) -> Correction {
    operators.solves += 1;
    let n = set.len();
    let mut x = vec![0.0; n];
    // In units of the residual's own size: its square neither overflows nor underflows.
    let unit = right.iter().fold(0.0, |m: f64, r| m.max(r.abs()));
    if unit <= 0.0 {
        return Correction { x, steps: 0 };
    }
    let floor = request.floor / unit;
    let mut r: Vec<f64> = right.iter().map(|r| r / unit).collect();
    let mut preconditioner = Preconditioner::new(operators, set, request);
    let (mut z, mut direction, mut kt) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut offset = preconditioner.apply(operators, set, &r, &mut z);
    let (start, _) = size(&r, offset);
    let mut rz = dot(&r, &z);
    let (mut steps, mut gain) = (0, 0.0);
    // The energy of the error is at most this multiple of r'z.
    let safety = if request.precondition { TORUS } else { 1.0 / crate::love::SMALLEST_EIGENVALUE };
    while steps < request.steps && rz > 0.0 && !stop() {
        if steps == 0 {
            direction.copy_from_slice(&z);
        }
        operators.correcting(set, &direction, &mut kt, request.exact);
        let curvature = dot(&direction, &kt);
        if curvature.is_nan() || curvature <= 0.0 {
            break; // Below what single precision can resolve.
        }
        let step = rz / curvature;
        for k in 0..n {
            x[k] += step * direction[k];
            r[k] -= step * kt[k];
        }
        steps += 1;
        offset = preconditioner.apply(operators, set, &r, &mut z);
        let (norm, largest) = size(&r, offset);
        if norm <= request.reduction * start || largest <= floor {
            break;
        }
        let next = dot(&r, &z);
        gain += step * rz;
        if request
            .energy
            .is_some_and(|e| safety * next * unit * unit <= e.share * (e.base + gain * unit * unit))
        {
            break;
        }
        let beta = next / rz;
        rz = next;
        for (t, &z) in direction.iter_mut().zip(&z) {
            *t = z + beta * *t;
        }
    }
    for x in &mut x {
        *x *= unit;
    }
    Correction { x, steps }
}

/// Upper estimate of the energy error `r' K^-1 r`: the inverse of the wrapped kernel, or the smallest eigenvalue.
///
/// `(K_CC)^-1 <= (K^-1)_CC` for every set C, so that the inverse of the whole lattice gives a bound; wrapping the
/// lattice on a torus makes it an estimate that a residual as wide as the torus can exceed by some ten per cent, hence the
/// factor [`TORUS`]. The eigenvalue gives a bound without any transform, larger by up to the condition.
pub fn energy(operators: &mut Operators, set: &CellSet, r: &[f64], spectral: bool) -> f64 {
    if spectral {
        let mut z = vec![0.0; r.len()];
        operators.inverse(set, r, &mut z);
        TORUS * dot(r, &z).max(0.0)
    } else {
        dot(r, r) / crate::love::SMALLEST_EIGENVALUE
    }
}

/// Projected preconditioner: `z = M r - (1'M r / 1'M 1) M 1`.
struct Preconditioner {
    spectral: bool,
    /// `M 1` and its sum, where the sum of the correction is fixed and M is not the identity.
    ones: Option<(Vec<f64>, f64)>,
    fixed_sum: bool,
}

impl Preconditioner {
    fn new(operators: &mut Operators, set: &CellSet, request: Request) -> Self {
        let ones = (request.precondition && request.fixed_sum).then(|| {
            let mut m1 = vec![0.0; set.len()];
            operators.inverse(set, &vec![1.0; set.len()], &mut m1);
            let sum = m1.iter().sum();
            (m1, sum)
        });
        Self { spectral: request.precondition, ones, fixed_sum: request.fixed_sum }
    }

    /// Fills `z` and returns the constant that the constraint takes from the residual.
    fn apply(&mut self, operators: &mut Operators, set: &CellSet, r: &[f64], z: &mut [f64]) -> f64 {
        if self.spectral {
            operators.inverse(set, r, z);
        } else {
            z.copy_from_slice(r);
        }
        if !self.fixed_sum {
            return 0.0;
        }
        let sum: f64 = z.iter().sum();
        if let Some((m1, total)) = &self.ones {
            let offset = sum / total;
            for (z, m) in z.iter_mut().zip(m1) {
                *z -= offset * m;
            }
            offset
        } else {
            let offset = sum / z.len() as f64;
            for z in z.iter_mut() {
                *z -= offset;
            }
            offset
        }
    }
}

/// 2-norm and largest magnitude of `r - offset`.
fn size(r: &[f64], offset: f64) -> (f64, f64) {
    let (mut square, mut largest) = (0.0, 0.0f64);
    for &r in r {
        let e = r - offset;
        square += e * e;
        largest = largest.max(e.abs());
    }
    (f64::sqrt(square), largest)
}

/// Scalar product.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod stops;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::operator::{Table, dense::Factor};
    use contact_model::Boundary;
    use contact_model::never;

    const SIDE: usize = 20;

    fn scattered() -> CellSet {
        CellSet::new(SIDE, (0..(SIDE * SIDE) as u32).filter(|i| (i * i + i / 7) % 5 < 3).collect())
    }

    fn right(n: usize) -> Vec<f64> {
        (0..n).map(|k| (k as f64 * 1.3).sin()).collect()
    }

    #[test]
    fn both_preconditioners_reach_the_factored_solution() {
        let set = scattered();
        let mut operators = Operators::new(Table::shared(SIDE, Boundary::Free));
        let r = right(set.len());
        let (q, w) = Factor::new(operators.table(), &set).unwrap().solve_pair(&r);
        for precondition in [false, true] {
            for fixed_sum in [false, true] {
                let request = Request {
                    fixed_sum,
                    reduction: 1e-5,
                    energy: None,
                    floor: 0.0,
                    steps: 200,
                    precondition,
                    exact: true,
                };
                let got = correct(&mut operators, &set, &r, request, &never);
                // With a fixed sum the approach takes up the rest: x = w - (sum w / sum q) q.
                let shift = if fixed_sum { w.iter().sum::<f64>() / q.iter().sum::<f64>() } else { 0.0 };
                let norm = dot(&w, &w).sqrt();
                for ((x, w), q) in got.x.iter().zip(&w).zip(&q) {
                    // Single precision inside: 1e-5 of the norm is what one correction can be asked for.
                    assert!((x - (w - shift * q)).abs() < 1e-4 * norm, "{precondition} {fixed_sum}");
                }
                if fixed_sum {
                    assert!(got.x.iter().sum::<f64>().abs() < 1e-9 * norm);
                }
            }
        }
    }

    #[test]
    fn the_energy_estimates_bound_the_energy_error() {
        let set = scattered();
        let mut operators = Operators::new(Table::shared(SIDE, Boundary::Free));
        let smooth: Vec<f64> = (0..set.len()).map(|k| 1.0 + 0.1 * set.place(k).0 as f64).collect();
        for r in [right(set.len()), smooth] {
            let (_, w) = Factor::new(operators.table(), &set).unwrap().solve_pair(&r);
            let true_energy = dot(&r, &w);
            assert!(energy(&mut operators, &set, &r, false) >= true_energy);
            assert!(energy(&mut operators, &set, &r, true) >= true_energy);
        }
    }
}
