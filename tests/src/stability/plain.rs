//! The slow and simple reference implementations: sums over pairs, Gauss's elimination, projected
//! Gauss-Seidel.

use bem3d::love::influence_of_rectangle;
use contact_model::HeightMap;
use std::f64::consts::PI;

/// Over-relaxation of the projected sweeps; any number in (0, 2) converges for a positive definite kernel.
const OVER: f64 = 1.6;
/// Change of a displacement over the approach at which sweeps end, and how many there are at most.
const SETTLED: f64 = 1e-15;
const SWEEPS: usize = 20_000;

/// Periods of the images that a periodic kernel sums up on each side, for an extrapolation to infinitely
/// many. The contribution of images beyond m periods to a difference of the kernel is a series of odd powers
/// of 1/(m + 1/2); with four sums the remaining error is of the order 1/(m + 1/2)^7.
const IMAGES: [isize; 4] = [3, 6, 12, 24];

/// Displacements of the cells of a grid under forces on them, by the plain sum, for modulus 1.
#[derive(Debug, Clone)]
pub struct PlainSum {
    columns: usize,
    rows: usize,
    /// Displacement at lag (x, y) under a unit force, row-major.
    kernel: Vec<f64>,
}

impl PlainSum {
    /// A table of all lags of a grid of `cells` (columns, rows) with sides `dx`, `dy`, on a half-space that
    /// is unloaded outside the grid.
    pub fn new([columns, rows]: [usize; 2], [dx, dy]: [f64; 2]) -> Self {
        let (unit, stretch) = scales(dx, dy);
        let lag = |i: usize| influence_of_rectangle(i % columns, i / columns, stretch) / (PI * unit);
        Self { columns, rows, kernel: (0..columns * rows).map(lag).collect() }
    }

    /// The table for a map.
    pub fn of(map: &HeightMap) -> Self {
        Self::new([map.columns(), map.rows()], [map.dx(), map.dy()])
    }

    /// The table for a periodic map, from sums of Love's kernel over its images: no Fourier transform and no
    /// spectrum.
    ///
    /// The sum diverges but its differences converge; the kernel is measured from its smallest value.
    /// Accuracy about 1e-10 of the largest one. Cost: some 3000 influence coefficients a lag, more for long
    /// rectangles.
    pub fn periodic(map: &HeightMap) -> Self {
        let (columns, rows) = (map.columns(), map.rows());
        let (unit, stretch) = scales(map.dx(), map.dy());
        let kernel = images(map, |x, y| {
            influence_of_rectangle(x.unsigned_abs(), y.unsigned_abs(), stretch) / (PI * unit)
        });
        // Below every value, and below 0 where there is one cell.
        let lowest = kernel.iter().copied().fold(-0.1 / (PI * unit), f64::min);
        Self { columns, rows, kernel: kernel.iter().map(|value| value - 1.1 * lowest).collect() }
    }

    /// Mean of a periodic kernel: the displacement of all cells under a unit force spread over all of them.
    pub fn mean(&self) -> f64 {
        self.kernel.iter().sum::<f64>() / self.kernel.len() as f64
    }

    /// Displacement of cell i under a unit force on cell j.
    pub fn between(&self, i: usize, j: usize) -> f64 {
        let n = self.columns;
        self.kernel[(i / n).abs_diff(j / n) * n + (i % n).abs_diff(j % n)]
    }

    /// Displacement of every cell under forces on some. Cost O(N n) for N cells and n forces.
    pub fn displacement(&self, forces: &[(usize, f64)]) -> Vec<f64> {
        let n = self.columns;
        let mut u = vec![0.0; n * self.rows];
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

/// Sums of a kernel over the images of a periodic map at all lags, less the sum at lag zero.
pub(crate) fn images(map: &HeightMap, kernel: impl Fn(isize, isize) -> f64) -> Vec<f64> {
    let (columns, rows) = (map.columns(), map.rows());
    // As many images in each direction as make about a square.
    let ratio = map.size().x / map.size().y;
    let odd = |r: f64| 2 * ((r - 1.0) / 2.0).round() as isize + 1;
    let (along_x, along_y) = (odd((1.0 / ratio).max(1.0)), odd(ratio.max(1.0)));
    let image = |lag: usize, i: isize, n: usize| lag.cast_signed() + i * n.cast_signed();
    let sum = |x: usize, y: usize, m: isize| -> f64 {
        // A window of images of one shape: (m + 1/2) along_x periods on each side along x.
        let (mx, my) = (m * along_x + (along_x - 1) / 2, m * along_y + (along_y - 1) / 2);
        (-mx..=mx)
            .flat_map(|i| (-my..=my).map(move |j| (i, j)))
            .map(|(i, j)| kernel(image(x, i, columns), image(y, j, rows)))
            .sum()
    };
    let origin = IMAGES.map(|m| sum(0, 0, m));
    let (half_x, half_y) = (columns / 2 + 1, rows / 2 + 1);
    let mut quarter = vec![0.0; half_x * half_y];
    for (i, value) in quarter.iter_mut().enumerate().skip(1) {
        let below: Vec<f64> =
            IMAGES.iter().zip(origin).map(|(&m, origin)| sum(i % half_x, i / half_x, m) - origin).collect();
        // value + c1 / M + c3 / M^3 + c5 / M^5 = below.
        let row = |&m: &isize| {
            let inverse = (m as f64 + 0.5).recip();
            vec![1.0, inverse, inverse.powi(3), inverse.powi(5)]
        };
        *value = eliminate(IMAGES.iter().map(row).collect(), below)[0];
    }
    let fold = |lag: usize, n: usize| lag.min(n - lag);
    (0..columns * rows)
        .map(|i| quarter[fold(i / columns, rows) * half_x + fold(i % columns, columns)])
        .collect()
}

/// Side of the square cell of the same area, and the side along x in units of it.
fn scales(dx: f64, dy: f64) -> (f64, f64) {
    let square = (dx / dy - 1.0).abs() < 1e-14;
    if square { (dx, 1.0) } else { ((dx * dy).sqrt(), (dx / dy).sqrt()) }
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

/// The state at an approach by projected Gauss-Seidel: each cell in turn gets the force that closes its gap,
/// or zero if that force would be negative.
///
/// No guess, no contact set, no transform: slow and independent of everything that `bem3d` does. Cost O(n^2)
/// a sweep and in memory for n cells within reach; a few hundred sweeps on 33 x 33 cells, thousands where a
/// periodic map is in full contact.
///
/// # Panics
/// Where the sweeps do not settle: an unfinished relaxation is no reference.
pub fn relaxed(map: &HeightMap, approach: f64) -> Relaxed {
    relaxed_by(&PlainSum::of(map), map, approach)
}

/// The same with a given kernel. That of a periodic map may have any constant added that leaves it positive,
/// which changes the approach accordingly.
///
/// # Panics
/// As [`relaxed`].
pub fn relaxed_by(sum: &PlainSum, map: &HeightMap, approach: f64) -> Relaxed {
    let highest = map.highest();
    let reach: Vec<usize> =
        (0..map.heights().len()).filter(|&i| highest - map.heights()[i] < approach).collect();
    // Gap without any force, then with it.
    let mut gap: Vec<f64> = reach.iter().map(|&i| highest - map.heights()[i] - approach).collect();
    let mut force = vec![0.0_f64; reach.len()];
    let own = sum.between(0, 0);
    let rows: Vec<Vec<f64>> =
        reach.iter().map(|&j| reach.iter().map(|&i| sum.between(i, j)).collect()).collect();
    let open = gap.clone();
    let mut settled = false;
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
            settled = true;
            break;
        }
        // All forces together, as far as the energy falls: the mean pressure of a periodic map is slow one by
        // one.
        let product = |b: &mut dyn Iterator<Item = f64>| force.iter().zip(b).map(|(f, b)| f * b).sum::<f64>();
        let slope = product(&mut gap.iter().copied());
        let curvature = product(&mut gap.iter().zip(&open).map(|(g, o)| g - o));
        let scale = if curvature > 0.0 { 1.0 - slope / curvature } else { 1.0 };
        if scale > 0.0 {
            for f in &mut force {
                *f *= scale;
            }
            for (g, o) in gap.iter_mut().zip(&open) {
                *g = o + scale * (*g - o);
            }
        }
    }
    assert!(settled, "relaxation of {} cells did not settle in {SWEEPS} sweeps", reach.len());
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
    use crate::stability::every_contact_set;
    use approx::assert_relative_eq;
    use contact_model::NormalLoad;

    #[test]
    fn by_hand() {
        // 2 x + y = 5, x + 3 y = 10: x = 1, y = 3; the second one needs its rows exchanged.
        assert_eq!(eliminate(vec![vec![2.0, 1.0], vec![1.0, 3.0]], vec![5.0, 10.0]), [1.0, 3.0]);
        assert_eq!(eliminate(vec![vec![0.0, 1.0], vec![4.0, 0.0]], vec![5.0, 8.0]), [2.0, 5.0]);
    }

    #[test]
    fn rows_of_the_plain_sum_are_its_pairs() {
        let plain = PlainSum::new([5, 4], [0.3, 0.2]);
        let forces = [(3, 1.0), (12, -2.0), (19, 0.5)];
        for (i, u) in plain.displacement(&forces).iter().enumerate() {
            let pairs: f64 = forces.iter().map(|&(j, f)| plain.between(i, j) * f).sum();
            assert_relative_eq!(*u, pairs, max_relative = 1e-14);
        }
    }

    #[test]
    fn a_wave_of_a_periodic_kernel_keeps_its_shape() {
        // Any kernel that repeats itself turns a wave of pressure into a wave of displacement.
        for (cells, size) in [([8, 8], [1.0, 1.0]), ([9, 5], [1.0, 1.0]), ([6, 3], [4.0, 1.0])] {
            let map = HeightMap::new(cells, size, vec![0.0; cells[0] * cells[1]]).unwrap();
            let wave = |i: usize| (PI * 2.0 * (i % cells[0]) as f64 / cells[0] as f64).cos();
            let forces: Vec<(usize, f64)> = (0..cells[0] * cells[1]).map(|i| (i, wave(i))).collect();
            let u = PlainSum::periodic(&map).displacement(&forces);
            // 2 pi / q over pi E* at long waves; larger for short ones, which other waves of the continuum
            // add to.
            let continuum = 2.0 * size[0] / (2.0 * PI) * (cells[0] * cells[1]) as f64 / (size[0] * size[1]);
            assert!((0.9..1.2).contains(&(u[0] / continuum)), "{} {continuum}", u[0]);
            for (i, u_i) in u.iter().enumerate() {
                assert_relative_eq!(*u_i, u[0] * wave(i), epsilon = 1e-9 * u[0]);
            }
        }
    }

    #[test]
    fn relaxation_finds_the_set_that_trying_all_finds() {
        let map = crate::stability::map(3, 3.0, |x, y| ((7 * x + 4 * y) as f64).sin()).unwrap();
        for d in [0.05, 0.4, 1.1, 5.0] {
            let slow = relaxed(&map, d);
            let all = every_contact_set(&map, &(0..9).collect::<Vec<_>>(), NormalLoad::Approach(d));
            assert_eq!(slow.contact, all[0].contact);
            // Rounding of nine cells.
            assert_relative_eq!(slow.force, all[0].force, max_relative = 1e-12);
            let k = PlainSum::of(&map).stiffness(&slow.contact);
            assert_relative_eq!(k, all[0].stiffness, max_relative = 1e-12);
        }
    }
}
