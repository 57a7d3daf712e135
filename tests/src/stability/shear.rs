//! The slow reference implementations of friction: sums over pairs of tractions, elimination of a contact that
//! sticks, projected Gauss-Seidel for Coulomb's law.
//!
//! A traction q on a cell displaces by `1/(pi E*)` times the integral over the cell of a tensor that is
//! homogeneous of degree -1 in the distance: `f = 1/r + c x^2/r^3` and its like, with `c = E* sum nu/(2 G)`
//! (Cerruti; Johnson, Contact Mechanics (1985), Eq. 3.75). By Euler's theorem `div((x, y) f) = 2 f - f = f`,
//! so that the integral equals that of `f (x, y) . n` along the boundary of the cell. It is evaluated by
//! Gauss's rule, without Love's sums over corners or those of `bem3d`.

use crate::stability::plain::{eliminate, images};
use contact_model::{Body, HeightMap, Pair, Result};
use std::f64::consts::PI;

/// Gauss-Legendre's rule of eight points on [-1, 1]: one half of it.
const GAUSS: [(f64, f64); 4] = [
    (0.183_434_642_495_649_8, 0.362_683_783_378_362),
    (0.525_532_409_916_329, 0.313_706_645_877_887_3),
    (0.796_666_477_413_626_7, 0.222_381_034_453_374_48),
    (0.960_289_856_497_536_3, 0.101_228_536_290_376_26),
];
/// Longest piece of an edge for one application of the rule, in units of the distance of the piece: the error
/// is about 1e-14.
const PIECE: f64 = 0.5;
/// Over-relaxation of the projected sweeps: below 2 each of them lowers the energy.
const OVER: f64 = 1.5;
/// Change of a displacement over the largest one at which sweeps end, and how many there are at most.
const SETTLED: f64 = 2e-15;
/// See `SETTLED`.
const SWEEPS: usize = 50_000;

/// The constant `E* sum nu/(2 G)` of two bodies: `nu/(1 - nu)` of bodies that are alike.
///
/// # Errors
/// As [`Pair::contact_modulus`].
pub fn compliance(pair: &Pair) -> Result<f64> {
    let of = |body: Body| match body {
        // G = E/(2 (1 + nu)).
        Body::Elastic { young, poisson } => poisson * (1.0 + poisson) / young,
        _ => 0.0,
    };
    Ok(pair.contact_modulus()? * (of(pair.first) + of(pair.second)))
}

/// Tangential displacements of the cells of a grid under tangential forces on them, by the plain sum, for
/// modulus 1.
#[derive(Debug, Clone)]
pub struct PlainShear {
    columns: usize,
    rows: usize,
    /// `[xx, yy, xy]` at lag (x, y) under a unit force, row-major.
    kernel: Vec<[f64; 3]>,
}

impl PlainShear {
    /// A table of all lags of a grid of `cells` (columns, rows) with sides `dx`, `dy`, on bodies with the
    /// constant [`compliance`] that are unloaded outside the grid.
    pub fn new([columns, rows]: [usize; 2], [dx, dy]: [f64; 2], compliance: f64) -> Self {
        let lag = |i: usize| {
            let at = [(i % columns) as f64 * dx, (i / columns) as f64 * dy];
            of_cell(at, [dx, dy], compliance)
        };
        Self { columns, rows, kernel: (0..columns * rows).map(lag).collect() }
    }

    /// The table for a map.
    pub fn of(map: &HeightMap, compliance: f64) -> Self {
        Self::new([map.columns(), map.rows()], [map.dx(), map.dy()], compliance)
    }

    /// The table for a periodic map, by sums over its images; displacements are measured from their mean.
    /// Accuracy and cost: as [`crate::stability::PlainSum::periodic`], for square maps.
    pub fn periodic(map: &HeightMap, compliance: f64) -> Self {
        let (columns, rows) = (map.columns(), map.rows());
        let sides = [map.dx(), map.dy()];
        let mut kernel = vec![[0.0; 3]; columns * rows];
        for component in 0..3 {
            let values = images(map, |x, y| {
                of_cell([x as f64 * sides[0], y as f64 * sides[1]], sides, compliance)[component]
            });
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            for (i, (kernel, value)) in kernel.iter_mut().zip(values).enumerate() {
                // The entry across is odd in both lags, without a mean; lags were folded to their magnitude.
                let sign = |lag: usize, n: usize| (n.cast_signed() - 2 * lag.cast_signed()).signum() as f64;
                let odd = sign(i % columns, columns) * sign(i / columns, rows) * value;
                kernel[component] = if component < 2 { value - mean } else { odd };
            }
        }
        Self { columns, rows, kernel }
    }

    /// `[xx, yy, xy]` of the displacement of cell i under a unit force on cell j.
    pub fn between(&self, i: usize, j: usize) -> [f64; 3] {
        let n = self.columns;
        let (xi, yi, xj, yj) = (i % n, i / n, j % n, j / n);
        let [xx, yy, xy] = self.kernel[yi.abs_diff(yj) * n + xi.abs_diff(xj)];
        [xx, yy, if (xi < xj) == (yi < yj) { xy } else { -xy }]
    }

    /// Displacement of every cell under forces on some. Cost O(N n) for N cells and n forces.
    pub fn displacement(&self, forces: &[(usize, [f64; 2])]) -> Vec<[f64; 2]> {
        let of = |i: usize| {
            forces.iter().fold([0.0; 2], |[x, y], &(j, [fx, fy])| {
                let [xx, yy, xy] = self.between(i, j);
                [x + xx * fx + xy * fy, y + xy * fx + yy * fy]
            })
        };
        (0..self.columns * self.rows).map(of).collect()
    }

    /// The forces that move a set of cells by one along x or along y, without any slip: components along x, then
    /// those along y. By elimination; cost O(n^3).
    pub fn stuck(&self, contact: &[usize], along: usize) -> Vec<f64> {
        let n = contact.len();
        let entry = |row: usize, column: usize| {
            let [xx, yy, xy] = self.between(contact[row % n], contact[column % n]);
            match (row / n, column / n) {
                (0, 0) => xx,
                (1, 1) => yy,
                _ => xy,
            }
        };
        let matrix = (0..2 * n).map(|row| (0..2 * n).map(|column| entry(row, column)).collect()).collect();
        eliminate(matrix, (0..2 * n).map(|row| f64::from(u8::from(row / n == along))).collect())
    }

    /// The stiffness `dQ_i/d delta_j` of a set of cells that sticks.
    pub fn stiffness(&self, contact: &[usize]) -> [[f64; 2]; 2] {
        let columns = [0, 1].map(|along| {
            let forces = self.stuck(contact, along);
            let (x, y) = forces.split_at(contact.len());
            [x.iter().sum::<f64>(), y.iter().sum()]
        });
        [[columns[0][0], columns[1][0]], [columns[0][1], columns[1][1]]]
    }
}

/// The displacement at a distance from the middle of a cell under a unit force spread over it.
fn of_cell([x, y]: [f64; 2], [dx, dy]: [f64; 2], c: f64) -> [f64; 3] {
    let (east, west) = (x + 0.5 * dx, x - 0.5 * dx);
    let (north, south) = (y + 0.5 * dy, y - 0.5 * dy);
    // (x, y) . n is constant along an edge.
    let vertical = |x: f64| edge([south, north], x.abs(), |y| (x, y), c).map(|part| x * part);
    let horizontal = |y: f64| edge([west, east], y.abs(), |x| (x, y), c).map(|part| y * part);
    let parts = [vertical(east), vertical(west), horizontal(north), horizontal(south)];
    std::array::from_fn(|k| (parts[0][k] - parts[1][k] + parts[2][k] - parts[3][k]) / (PI * dx * dy))
}

/// The integral of the tensor along a straight edge at some distance from the origin.
fn edge([from, to]: [f64; 2], distance: f64, at: impl Fn(f64) -> (f64, f64), c: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    let mut begin = from;
    while begin < to {
        let near = begin.abs().min(to.abs()) * f64::from(u8::from(begin >= 0.0)) + distance;
        let end = if begin + 1.5 * PIECE * near < to { begin + PIECE * near } else { to };
        let (middle, half) = (f64::midpoint(begin, end), 0.5 * (end - begin));
        for (node, weight) in GAUSS.iter().flat_map(|&(x, w)| [(x, w), (-x, w)]) {
            let (x, y) = at(middle + half * node);
            let r = x.hypot(y);
            let (ex, ey) = (x / r, y / r);
            let terms = [1.0 + c * ex * ex, 1.0 + c * ey * ey, c * ex * ey];
            sum.iter_mut().zip(terms).for_each(|(sum, term)| *sum += half * weight * term / r);
        }
        begin = end;
    }
    sum
}

/// A contact on a path of friction, found by relaxation, modulus 1.
#[derive(Debug, Clone)]
pub struct Dragged<'a> {
    sum: &'a PlainShear,
    /// Tangential force on each cell.
    pub forces: Vec<[f64; 2]>,
    /// Tangential displacement of the bodies.
    pub displacement: [f64; 2],
    /// Energy that friction has dissipated.
    pub dissipated: f64,
}

impl<'a> Dragged<'a> {
    /// Before the first step.
    pub fn new(sum: &'a PlainShear) -> Self {
        let cells = sum.columns * sum.rows;
        Self { sum, forces: vec![[0.0; 2]; cells], displacement: [0.0; 2], dissipated: 0.0 }
    }

    /// Sum of the forces.
    pub fn force(&self) -> [f64; 2] {
        self.forces.iter().fold([0.0; 2], |[x, y], f| [x + f[0], y + f[1]])
    }

    /// One increment to a displacement, with the largest friction force of each cell at its end (cells
    /// without one are not in contact): each cell in turn gets the force that makes its slip zero, or the
    /// nearest one within its disk.
    ///
    /// No sets, no transform and no linear system. Cost O(n^2) a sweep for n cells in contact.
    ///
    /// # Panics
    /// Where the sweeps do not settle: an unfinished relaxation is no reference.
    pub fn advance(&mut self, limits: &[(usize, f64)], displacement: [f64; 2]) {
        let before: Vec<(usize, [f64; 2])> =
            self.forces.iter().copied().enumerate().filter(|(_, [x, y])| x.hypot(*y) > 0.0).collect();
        let displaced = self.sum.displacement(&before);
        let n = limits.len();
        let mut force: Vec<[f64; 2]> = limits.iter().map(|&(i, b)| within(self.forces[i], b)).collect();
        let rows: Vec<Vec<[f64; 3]>> = limits
            .iter()
            .map(|&(j, _)| limits.iter().map(|&(i, _)| self.sum.between(i, j)).collect())
            .collect();
        // w = (delta - u) - (delta - u)_before.
        let start: Vec<[f64; 2]> = limits
            .iter()
            .map(|&(i, _)| [0, 1].map(|k| displacement[k] - self.displacement[k] + displaced[i][k]))
            .collect();
        let slip = |force: &[[f64; 2]]| {
            let mut w = start.clone();
            for (row, f) in rows.iter().zip(force) {
                add(&mut w, row, f.map(|f| -f));
            }
            w
        };
        let mut w = slip(&force);
        let [xx, yy, _] = self.sum.between(0, 0);
        let own = xx.max(yy);
        let longest = limits.iter().fold(0.0, |longest: f64, (_, b)| longest.max(*b)) * own;
        let scale = start.iter().fold(longest, |scale, w| scale.max(w[0].hypot(w[1])));
        let mut settled = false;
        for sweep in 0..SWEEPS {
            let mut largest = 0.0_f64;
            for a in 0..n {
                let moved = [0, 1].map(|k| force[a][k] + OVER * w[a][k] / own);
                let next = within(moved, limits[a].1);
                let change = [0, 1].map(|k| next[k] - force[a][k]);
                largest = largest.max(change[0].hypot(change[1]) * own);
                force[a] = next;
                add(&mut w, &rows[a], change.map(|f| -f));
            }
            if sweep % 64 == 63 {
                w = slip(&force);
            }
            if largest <= SETTLED * scale {
                settled = true;
                break;
            }
        }
        assert!(settled, "relaxation of {n} cells did not settle in {SWEEPS} sweeps");
        w = slip(&force);
        self.dissipated += force.iter().zip(&w).map(|(f, w)| f[0] * w[0] + f[1] * w[1]).sum::<f64>();
        self.forces.fill([0.0; 2]);
        limits.iter().zip(force).for_each(|(&(i, _), f)| self.forces[i] = f);
        self.displacement = displacement;
    }
}

/// Adds the displacements of a force on one cell.
fn add(u: &mut [[f64; 2]], row: &[[f64; 3]], [fx, fy]: [f64; 2]) {
    for (u, [xx, yy, xy]) in u.iter_mut().zip(row) {
        *u = [u[0] + xx * fx + xy * fy, u[1] + xy * fx + yy * fy];
    }
}

/// The nearest vector within a disk.
fn within([x, y]: [f64; 2], limit: f64) -> [f64; 2] {
    let length = x.hypot(y);
    if length <= limit { [x, y] } else { [x, y].map(|v| v * limit / length) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bem3d::love::influence_of_rectangle;

    #[test]
    fn without_poissons_ratio_it_is_loves_kernel() {
        for (dx, dy) in [(1.0_f64, 1.0_f64), (3.0, 0.2), (0.1, 10.0)] {
            let (unit, stretch) = ((dx * dy).sqrt(), (dx / dy).sqrt());
            let plain = PlainShear::new([12, 12], [dx, dy], 0.0);
            for i in 0..144 {
                let love = influence_of_rectangle(i % 12, i / 12, stretch) / (PI * unit);
                let [xx, yy, xy] = plain.between(i, 0);
                assert!(
                    (xx / love - 1.0).abs() < 1e-12 && (yy / love - 1.0).abs() < 1e-12,
                    "{i}: {xx} {love}"
                );
                assert!(xy.abs() < 1e-15);
            }
        }
    }

    #[test]
    fn far_away_it_is_the_point_force() {
        let (c, r) = (0.7, 50.0_f64.hypot(20.0));
        let plain = PlainShear::new([51, 21], [1.0, 1.0], c);
        let expected = [1.0 + c * 2500.0 / (r * r), 1.0 + c * 400.0 / (r * r), c * 1000.0 / (r * r)];
        // The cell's own size squared over the distance's.
        for (found, expected) in plain.between(0, 51 * 21 - 1).iter().zip(expected) {
            assert!((found * PI * r / expected - 1.0).abs() < 1e-3, "{found}");
        }
        // The tensor turns its sign with one lag.
        assert!((plain.between(50, 51 * 20)[2] + plain.between(0, 51 * 21 - 1)[2]).abs() < 1e-18);
    }

    #[test]
    fn one_cell_by_hand() {
        // 4 ln(1 + sqrt 2) (1 + c/2)/pi: half of Love's integral is that of x^2/r^3.
        let plain = PlainShear::new([1, 1], [1.0, 1.0], 1.0);
        let own = 4.0 * (1.0 + 2.0_f64.sqrt()).ln() * 1.5 / PI;
        assert!((plain.between(0, 0)[0] / own - 1.0).abs() < 1e-13);
        let mut dragged = Dragged::new(&plain);
        dragged.advance(&[(0, 1.0)], [0.3 * own, 0.0]);
        assert!((dragged.forces[0][0] - 0.3).abs() < 1e-13 && dragged.dissipated.abs() < 1e-14);
        // Beyond the limit: traction 1, slip of the rest.
        dragged.advance(&[(0, 1.0)], [3.0 * own, 0.0]);
        assert!((dragged.forces[0][0] - 1.0).abs() < 1e-13);
        assert!((dragged.dissipated - 2.0 * own).abs() < 1e-12);
    }
}
