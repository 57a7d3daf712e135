//! Symmetric indefinite systems by preconditioned minimal residuals (Paige and Saunders, SIAM J. Numer.
//! Anal. 12, 617 (1975)).

use crate::real::{Real, dot, update};
use contact_model::{Interrupted, Stop};

/// Where an iteration ends at the latest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MinresLimits {
    /// The factor by which the residual is reduced.
    pub reduction: f64,
    /// Steps at most.
    pub steps: usize,
}

/// Work and residual of an iteration.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MinresOutcome {
    /// Steps, each with one product by the matrix.
    pub steps: usize,
    /// Norm of the residual over the one at the beginning, in the norm `sqrt(r' M r)`.
    pub reduction: f64,
}

/// Solves `A x = b` for symmetric A with a symmetric positive definite preconditioner M that approximates the
/// inverse of |A|, until the residual has fallen by a factor. `precondition(r, z)` writes `z = M r` and may
/// change r where M is singular. Returns x.
///
/// # Errors
/// [`Interrupted`] by the stop, or by a product that was.
///
/// Cost: one product by each in a step, and seven vectors.
pub fn minres<T: Real>(
    mut product: impl FnMut(&[T], &mut [T]) -> Result<(), Interrupted>,
    mut precondition: impl FnMut(&mut [T], &mut [T]) -> Result<(), Interrupted>,
    mut b: Vec<T>,
    limits: MinresLimits,
    stop: Stop<'_>,
) -> Result<(Vec<T>, MinresOutcome), Interrupted> {
    let zeros = || vec![T::default(); b.len()];
    let (mut x, mut w, mut before, mut v, mut y, mut z) =
        (zeros(), zeros(), zeros(), zeros(), zeros(), zeros());
    let mut last = zeros();
    precondition(&mut b, &mut z)?;
    let start = dot(&b, &z).max(0.0).sqrt();
    let (mut beta, mut beta_before) = (start, 0.0);
    // The last two rotations of the QR factors of Lanczos's matrix.
    let (mut cosine, mut sine, mut d, mut epsilon, mut left) = (-1.0, 0.0, 0.0, 0.0, start);
    let mut outcome = MinresOutcome { steps: 0, reduction: 1.0 };
    while start > 0.0 && outcome.steps < limits.steps && beta > 0.0 && beta.is_finite() {
        if stop.stops() {
            return Err(Interrupted);
        }
        let scale = T::of(beta.recip());
        update(&mut v, &z, |v, &z| *v = scale * z);
        product(&v, &mut y)?;
        outcome.steps += 1;
        if outcome.steps > 1 {
            let share = T::of(-beta / beta_before);
            update(&mut y, &last, |y, &r| *y += share * r);
        }
        let alpha = dot(&v, &y);
        let share = T::of(-alpha / beta);
        update(&mut y, &b, |y, &r| *y += share * r);
        // The two last residuals of Lanczos are y and b.
        std::mem::swap(&mut last, &mut b);
        std::mem::swap(&mut b, &mut y);
        precondition(&mut b, &mut z)?;
        beta_before = beta;
        beta = dot(&b, &z).max(0.0).sqrt();
        let epsilon_before = epsilon;
        let delta = cosine * d + sine * alpha;
        let g = sine * d - cosine * alpha;
        epsilon = sine * beta;
        d = -cosine * beta;
        let gamma = g.hypot(beta);
        if gamma <= 0.0 {
            break;
        }
        (cosine, sine) = (g / gamma, beta / gamma);
        let step = T::of(cosine * left);
        left *= sine;
        let (one, two, scale) = (T::of(-epsilon_before), T::of(-delta), T::of(gamma.recip()));
        // w is the last direction, `before` the one before it and then the new one.
        update(&mut before, &w, |before, &w| *before = one * *before + two * w);
        update(&mut before, &v, |direction, &v| *direction = scale * (*direction + v));
        std::mem::swap(&mut before, &mut w);
        update(&mut x, &w, |x, &w| *x += step * w);
        outcome.reduction = left.abs() / start;
        if outcome.reduction <= limits.reduction {
            break;
        }
    }
    Ok((x, outcome))
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact_model::never;

    /// A symmetric matrix with eigenvalues of both signs.
    fn matrix(n: usize) -> Vec<Vec<f64>> {
        let entry = |i: usize, j: usize| {
            let sign = if i < n / 2 { 1.0 } else { -1.0 };
            let own = if i == j { sign * (2.0 + i as f64) } else { 0.0 };
            own + 1.0 / (1.0 + i.abs_diff(j) as f64)
        };
        (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect()
    }

    #[test]
    fn an_indefinite_system_in_as_many_steps_as_it_has_unknowns() {
        let n = 12;
        let a = matrix(n);
        let b: Vec<f64> = (0..n).map(|i| (1.3 * i as f64).sin()).collect();
        for weight in [0.0, 0.5] {
            let (x, outcome) = minres(
                |v, y| {
                    y.iter_mut().zip(&a).for_each(|(y, row)| *y = dot(row, v));
                    Ok(())
                },
                |r, z| {
                    let own = |i: usize| 1.0 / (1.0 + weight * i as f64);
                    z.iter_mut().zip(&*r).enumerate().for_each(|(i, (z, r))| *z = own(i) * r);
                    Ok(())
                },
                b.clone(),
                MinresLimits { reduction: 1e-12, steps: 3 * n },
                &never,
            )
            .unwrap();
            assert!(outcome.steps <= n + 2 && outcome.reduction <= 1e-12, "{outcome:?}");
            for (row, b) in a.iter().zip(&b) {
                approx::assert_relative_eq!(dot(row, &x), *b, epsilon = 1e-10);
            }
        }
    }

    #[test]
    fn a_right_hand_side_of_zero_and_a_limit_of_steps() {
        let identity = |v: &[f64], y: &mut [f64]| {
            y.copy_from_slice(v);
            Ok(())
        };
        let none = |r: &mut [f64], z: &mut [f64]| {
            z.copy_from_slice(r);
            Ok(())
        };
        let limits = MinresLimits { reduction: 1e-3, steps: 9 };
        let (x, outcome) = minres(identity, none, vec![0.0; 3], limits, &never).unwrap();
        assert!(x == [0.0; 3] && outcome.steps == 0);
        let a = matrix(6);
        let product = |v: &[f64], y: &mut [f64]| {
            y.iter_mut().zip(&a).for_each(|(y, row)| *y = dot(row, v));
            Ok(())
        };
        let limits = MinresLimits { reduction: 0.0, steps: 2 };
        let (_, outcome) = minres(product, none, vec![1.0; 6], limits, &never).unwrap();
        assert_eq!(outcome.steps, 2);
        let stopped = minres(product, none, vec![1.0; 6], limits, &|| true);
        assert_eq!(stopped.map(|_| ()), Err(Interrupted));
    }
}
