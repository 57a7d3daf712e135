//! Minimum of a function of a few variables without derivatives.

/// Evaluations after which a search ends in any case, for each variable.
const MOST: usize = 400;

/// Minimises by the simplex method of Nelder and Mead (Comput. J. 7, 308 (1965)) from a start with one step
/// for each variable, until the values at the corners differ by less than `tolerance`; returns place and
/// value.
pub(super) fn minimise(
    f: &mut dyn FnMut(&[f64]) -> f64,
    start: &[f64],
    steps: &[f64],
    tolerance: f64,
) -> (Vec<f64>, f64) {
    let n = start.len();
    let mut at = |x: Vec<f64>| {
        let value = f(&x);
        (x, if value.is_nan() { f64::INFINITY } else { value })
    };
    let mut corners = vec![at(start.to_vec())];
    for (i, step) in steps.iter().enumerate() {
        let mut x = start.to_vec();
        x[i] += step;
        corners.push(at(x));
    }
    for _ in 0..MOST * n {
        corners.sort_by(|a, b| a.1.total_cmp(&b.1));
        let (best, worst) = (corners[0].1, corners[n].1);
        if worst - best <= tolerance || n == 0 {
            break;
        }
        let middle: Vec<f64> =
            (0..n).map(|i| corners[..n].iter().map(|c| c.0[i]).sum::<f64>() / n as f64).collect();
        let along = |t: f64, worst: &[f64]| -> Vec<f64> {
            middle.iter().zip(worst).map(|(m, w)| m + t * (w - m)).collect()
        };
        let reflected = at(along(-1.0, &corners[n].0));
        if reflected.1 < best {
            let expanded = at(along(-2.0, &corners[n].0));
            corners[n] = if expanded.1 < reflected.1 { expanded } else { reflected };
        } else if reflected.1 < corners[n - 1].1 {
            corners[n] = reflected;
        } else {
            let outside = reflected.1 < worst;
            let contracted = at(along(if outside { -0.5 } else { 0.5 }, &corners[n].0));
            if contracted.1 < worst.min(reflected.1) {
                corners[n] = contracted;
            } else {
                let first = corners[0].0.clone();
                for corner in &mut corners[1..] {
                    let half = corner.0.iter().zip(&first).map(|(x, b)| 0.5 * (x + b)).collect();
                    *corner = at(half);
                }
            }
        }
    }
    corners.sort_by(|a, b| a.1.total_cmp(&b.1));
    corners.swap_remove(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bent_valley() {
        let mut rosenbrock = |x: &[f64]| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2);
        let (x, value) = minimise(&mut rosenbrock, &[-1.2, 1.0], &[0.5, 0.5], 1e-14);
        assert!(value < 1e-10 && (x[0] - 1.0).abs() < 1e-4 && (x[1] - 1.0).abs() < 1e-4, "{x:?} {value}");
    }
}
