//! Acceleration of the fixed-point iteration for the attraction (Anderson, J. ACM 12, 547 (1965)).

use crate::real::dot;

/// States that are combined at most.
const DEPTH: usize = 6;
/// Added to the diagonal of the normal equations, relative: combinations of nearly equal residuals are not
/// worth their rounding.
const REGULARISATION: f64 = 1e-12;

/// What one update of the iteration made of a state.
#[derive(Debug, Clone)]
struct Entry {
    pressure: Vec<f64>,
    attraction: Vec<f64>,
    residual: Vec<f64>,
}

/// The last updates.
#[derive(Debug, Default)]
pub struct Mixing {
    entries: Vec<Entry>,
}

impl Mixing {
    /// Forgets them.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Takes what an update made of a state with this residual, and replaces it by the combination of the
    /// last updates with the smallest residual, to first order.
    pub fn combine(&mut self, pressure: &mut [f64], attraction: &mut [f64], residual: Vec<f64>) {
        if self.entries.len() > DEPTH {
            self.entries.remove(0);
        }
        let last = Entry { pressure: pressure.to_vec(), attraction: attraction.to_vec(), residual };
        let m = self.entries.len();
        let differences: Vec<Vec<f64>> = (self.entries.iter())
            .map(|e| e.residual.iter().zip(&last.residual).map(|(a, b)| a - b).collect())
            .collect();
        let mut matrix = vec![vec![0.0; m + 1]; m];
        for i in 0..m {
            for j in 0..=i {
                let product = dot(&differences[i], &differences[j]);
                (matrix[i][j], matrix[j][i]) = (product, product);
            }
            matrix[i][i] *= 1.0 + REGULARISATION;
            matrix[i][m] = -dot(&differences[i], &last.residual);
        }
        if let Some(weights) = solved(matrix) {
            for (entry, weight) in self.entries.iter().zip(weights) {
                let mix = |to: &mut [f64], from: &[f64], own: &[f64]| {
                    for ((to, from), own) in to.iter_mut().zip(from).zip(own) {
                        *to += weight * (from - own);
                    }
                };
                mix(pressure, &entry.pressure, &last.pressure);
                mix(attraction, &entry.attraction, &last.attraction);
            }
        }
        self.entries.push(last);
    }
}

/// Gauss's elimination of a small symmetric system with its right-hand side as the last column; `None` where
/// it is singular.
pub fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n).max_by(|&i, &j| rows[i][k].abs().total_cmp(&rows[j][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k].abs() <= 0.0 || !rows[k][k].is_finite() {
            return None;
        }
        for i in k + 1..n {
            let factor = rows[i][k] / rows[k][k];
            let (above, below) = rows.split_at_mut(i);
            for (value, pivot) in below[0][k..].iter_mut().zip(&above[k][k..]) {
                *value -= factor * pivot;
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = (rows[k][n] - known) / rows[k][k];
    }
    x.iter().all(|x| x.is_finite()).then_some(x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_map_of_three_unknowns_is_solved_in_four_updates() {
        // x -> A x + b with eigenvalues 0.95, 0.5, 0.2.
        let map = |x: &[f64]| vec![0.95 * x[0] + 1.0, 0.5 * x[1] + 0.1 * x[0], 0.2 * x[2] - 1.0];
        let (mut mixing, mut x) = (Mixing::default(), vec![0.0; 3]);
        for _ in 0..6 {
            let mut next = map(&x);
            let residual = next.iter().zip(&x).map(|(a, b)| a - b).collect();
            mixing.combine(&mut [], &mut next, residual);
            x = next;
        }
        let left = map(&x).iter().zip(&x).fold(0.0, |m: f64, (a, b)| m.max((a - b).abs()));
        assert!(left < 1e-9, "{left}");
        assert!(solved(vec![vec![0.0, 1.0]]).is_none());
    }

    #[test]
    fn a_system_that_needs_its_rows_exchanged() {
        let rows = vec![vec![0.0, 2.0, 1.0, 7.0], vec![2.0, 1.0, 3.0, 13.0], vec![1.0, 3.0, 4.0, 19.0]];
        for (found, expected) in solved(rows).unwrap().iter().zip([1.0, 2.0, 3.0]) {
            approx::assert_relative_eq!(*found, expected, max_relative = 1e-14);
        }
    }

    #[test]
    fn the_first_update_after_a_clear_is_taken_as_it_is_and_few_are_kept() {
        let mut mixing = Mixing::default();
        for i in 0..3 * DEPTH {
            let x = f64::from(i as u32);
            mixing.combine(&mut [x.sin()], &mut [x.cos()], vec![(1.3 * x).sin(), x.cos()]);
            assert_eq!(mixing.entries.len(), (i + 1).min(DEPTH + 1));
        }
        mixing.clear();
        let (mut pressure, mut attraction) = ([3.0], [4.0]);
        mixing.combine(&mut pressure, &mut attraction, vec![1.0, 0.5]);
        assert_eq!((pressure, attraction), ([3.0], [4.0]));
        // Residuals of 1 and -1: the combination of least residual is half of both, of pressure and
        // attraction.
        mixing.clear();
        mixing.combine(&mut [1.0], &mut [2.0], vec![1.0]);
        let (mut pressure, mut attraction) = ([3.0], [6.0]);
        mixing.combine(&mut pressure, &mut attraction, vec![-1.0]);
        approx::assert_relative_eq!(pressure[0], 2.0, max_relative = 1e-11);
        approx::assert_relative_eq!(attraction[0], 4.0, max_relative = 1e-11);
    }
}
