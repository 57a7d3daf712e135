//! The slow, obviously right twins: sums over pairs, Gauss's elimination, projected Gauss-Seidel.

use bem3d::love::influence;
use contact_model::HeightMap;
use std::f64::consts::PI;

/// Over-relaxation of the projected sweeps; any number in (0, 2) converges for a positive definite kernel.
const OVER: f64 = 1.6;
/// Change of a displacement over the approach at which sweeps end, and how many there are at most.
const SETTLED: f64 = 1e-15;
const SWEEPS: usize = 3000;

/// Displacements of the cells of a grid under forces on them, by the plain sum, for modulus 1.
#[derive(Debug, Clone)]
pub struct PlainSum {
    cells: usize,
    /// Displacement at lag (x, y) under a unit force, row-major.
    kernel: Vec<f64>,
}

impl PlainSum {
    /// A table of `cells` x `cells` lags of `cell` size.
    pub fn new(cells: usize, cell: f64) -> Self {
        let kernel = (0..cells * cells).map(|i| influence(i % cells, i / cells) / (PI * cell)).collect();
        Self { cells, kernel }
    }

    /// The table for a map.
    pub fn of(map: &HeightMap) -> Self {
        Self::new(map.columns(), map.dx())
    }

    /// Displacement of cell i under a unit force on cell j.
    pub fn between(&self, i: usize, j: usize) -> f64 {
        let n = self.cells;
        self.kernel[(i / n).abs_diff(j / n) * n + (i % n).abs_diff(j % n)]
    }

    /// Displacement of every cell under forces on some. Cost O(N^2 n).
    pub fn displacement(&self, forces: &[(usize, f64)]) -> Vec<f64> {
        let n = self.cells;
        let mut u = vec![0.0; n * n];
        for &(j, f) in forces {
            let (jx, jy) = (j % n, j / n);
            for (y, row) in u.chunks_exact_mut(n).enumerate() {
                let lags = &self.kernel[y.abs_diff(jy) * n..][..n];
                let (left, right) = row.split_at_mut(jx);
                left.iter_mut().rev().zip(&lags[1..]).for_each(|(u, k)| *u += f * k);
                right.iter_mut().zip(lags).for_each(|(u, k)| *u += f * k);
            }
        }
        u
    }

    /// `1' K^-1 1` of a set of cells, by elimination. Cost O(n^3).
    pub fn stiffness(&self, contact: &[usize]) -> f64 {
        let row = |&i: &usize| contact.iter().map(|&j| self.between(i, j)).collect();
        eliminate(contact.iter().map(row).collect(), vec![1.0; contact.len()]).iter().sum()
    }
}

/// A state found by relaxation, modulus 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Relaxed {
    /// Contact cells, ascending.
    pub contact: Vec<usize>,
    /// Force on each.
    pub forces: Vec<f64>,
    /// Their sum.
    pub force: f64,
}

/// The state at an approach by projected Gauss-Seidel: each cell in turn gets the force that closes its gap, if that is no pull.
///
/// No guess, no contact set, no transform: slow and independent of everything that `bem3d` does. Cost O(n^2) a sweep and in
/// memory for n cells within reach; a few hundred sweeps on 33 x 33 cells.
pub fn relaxed(map: &HeightMap, approach: f64) -> Relaxed {
    let sum = PlainSum::of(map);
    let highest = map.highest();
    let reach: Vec<usize> =
        (0..map.heights().len()).filter(|&i| highest - map.heights()[i] < approach).collect();
    // Gap without any force, then with it.
    let mut gap: Vec<f64> = reach.iter().map(|&i| highest - map.heights()[i] - approach).collect();
    let mut force = vec![0.0_f64; reach.len()];
    let own = sum.between(0, 0);
    let rows: Vec<Vec<f64>> =
        reach.iter().map(|&j| reach.iter().map(|&i| sum.between(i, j)).collect()).collect();
    for _ in 0..SWEEPS {
        let mut largest = 0.0_f64;
        for a in 0..reach.len() {
            let next = (force[a] - OVER * gap[a] / own).max(0.0);
            let change = next - force[a];
            if change.abs() > 0.0 {
                force[a] = next;
                largest = largest.max((change * own).abs());
                gap.iter_mut().zip(&rows[a]).for_each(|(g, k)| *g += k * change);
            }
        }
        if largest <= SETTLED * approach {
            break;
        }
    }
    let (contact, forces): (Vec<usize>, Vec<f64>) =
        reach.into_iter().zip(force).filter(|&(_, f)| f > 0.0).unzip();
    Relaxed { force: forces.iter().sum(), contact, forces }
}

/// Gauss's elimination with the largest pivot of the column.
pub(crate) fn eliminate(mut a: Vec<Vec<f64>>, mut b: Vec<f64>) -> Vec<f64> {
    let n = b.len();
    for column in 0..n {
        let pivot =
            (column..n).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs())).unwrap_or(column);
        a.swap(column, pivot);
        b.swap(column, pivot);
        let (above, below) = a.split_at_mut(column + 1);
        let top = &above[column];
        for (i, row) in below.iter_mut().enumerate() {
            let factor = row[column] / top[column];
            for (x, t) in row.iter_mut().zip(top).skip(column) {
                *x -= factor * t;
            }
            b[column + 1 + i] -= factor * b[column];
        }
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|j| a[i][j] * b[j]).sum();
        b[i] = (b[i] - known) / a[i][i];
    }
    b
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::every_contact_set;
    use approx::assert_relative_eq;
    use contact_model::Load;

    #[test]
    fn by_hand() {
        // 2 x + y = 5, x + 3 y = 10: x = 1, y = 3; the second one needs its rows exchanged.
        assert_eq!(eliminate(vec![vec![2.0, 1.0], vec![1.0, 3.0]], vec![5.0, 10.0]), [1.0, 3.0]);
        assert_eq!(eliminate(vec![vec![0.0, 1.0], vec![4.0, 0.0]], vec![5.0, 8.0]), [2.0, 5.0]);
    }

    #[test]
    fn rows_of_the_plain_sum_are_its_pairs() {
        let plain = PlainSum::new(5, 0.3);
        let forces = [(3, 1.0), (12, -2.0), (24, 0.5)];
        for (i, u) in plain.displacement(&forces).iter().enumerate() {
            let pairs: f64 = forces.iter().map(|&(j, f)| plain.between(i, j) * f).sum();
            assert_relative_eq!(*u, pairs, max_relative = 1e-14);
        }
    }

    #[test]
    fn relaxation_finds_the_set_that_trying_all_finds() {
        let map = crate::map(3, 3.0, |x, y| ((7 * x + 4 * y) as f64).sin()).unwrap();
        for d in [0.05, 0.4, 1.1, 5.0] {
            let slow = relaxed(&map, d);
            let all = every_contact_set(&map, &(0..9).collect::<Vec<_>>(), Load::Approach(d));
            assert_eq!(slow.contact, all[0].contact);
            // Rounding of nine cells.
            assert_relative_eq!(slow.force, all[0].force, max_relative = 1e-12);
            let k = PlainSum::of(&map).stiffness(&slow.contact);
            assert_relative_eq!(k, all[0].stiffness, max_relative = 1e-12);
        }
    }
}
