//! The periodogram in rings, and what a spectrum makes of it under a window.

use contact_model::{Cells, HeightMap, Result};
use std::f64::consts::{PI, TAU};
use surface_gen::periodogram;

/// Reach of the window's transform in waves of the map: beyond it there is 1e-6 of its power.
pub(super) const REACH: usize = 6;
/// Points of the lattice of wave vectors for each wave of the map, along each axis, under a window.
const FINE: usize = 2;
/// Nodes of the spectrum for each ring.
const NODES: f64 = 4.0;
/// Number of waves along the shorter side at which the rings begin under a window: longer waves are trends,
/// some of which are removed.
const FIRST: f64 = 4.0;
/// Number of waves before the limit of the grid at which the rings end under a window: half of the width of
/// the window's transform.
const BEFORE_LIMIT: f64 = 2.0;
/// What a plane of least squares leaves of the variance of a wave of nu << 1 periods over the map: `2.16
/// nu^4`.
const WITHOUT_PLANE: f64 = 2.16;
/// Of how many waves under Hann's window one is as good as independent: (35/18)^2.
const HANN_CORRELATION: f64 = 3.780_864_197_530_864;
/// Powers below this share of the largest are rounding of the transform.
const ROUNDING: f64 = 1e-24;
/// Rings with less than this times the leakage of far waves are left out.
const LEAKAGE: f64 = 10.0;
/// Slack of limits that are multiples of a wave.
const SLACK: f64 = 1e-12;

/// One ring of waves.
#[derive(Debug, Clone)]
pub(super) struct Ring {
    /// Mean wavenumber of its waves, in rings.
    pub(super) wavenumber: f64,
    /// Mean variance of its waves, over that of all rings.
    pub(super) power: f64,
    /// Number of its independent waves, conjugate pairs counted once.
    pub(super) independent: f64,
    /// First node and weights of the nodes from there on: the expected power of the ring is the sum of
    /// weights times densities.
    pub(super) first: usize,
    pub(super) weights: Vec<f64>,
}

/// The periodogram of a map in rings of equal width, with the nodes of a spectrum.
#[derive(Debug, Clone)]
pub(super) struct Rings {
    pub(super) all: Vec<Ring>,
    /// Logarithms of the wavenumbers of the nodes, in rings.
    pub(super) nodes: Vec<f64>,
    /// Width of a ring in 1/length, `2 pi/max(Lx, Ly)`.
    pub(super) width: f64,
    /// Wavenumbers from which and to which there are rings, in rings.
    pub(super) range: [f64; 2],
    /// Whether neighbouring rings share the window's transform.
    pub(super) windowed: bool,
    /// Density of a wave with the power 1, in length^4.
    pub(super) density: f64,
}

/// Transform of Hann's window, squared, normalised to the sum 1 over whole numbers.
fn hann_power(nu: f64) -> f64 {
    let root = if nu.abs() < 1e-9 {
        1.0
    } else if (nu.abs() - 1.0).abs() < 1e-9 {
        0.5
    } else {
        (PI * nu).sin() / (PI * nu * (1.0 - nu * nu))
    };
    2.0 / 3.0 * root * root
}

impl Rings {
    /// Rings of a periodic map, or (`windowed`) of one under Hann's window; wavenumbers between the limits
    /// only.
    ///
    /// # Errors
    /// Those of [`periodogram`].
    pub(super) fn new(map: &HeightMap, windowed: bool, limits: [f64; 2]) -> Result<Self> {
        let size = map.size();
        let longest = size.x.max(size.y);
        let width = TAU / longest;
        // Wavenumbers of one period along x and y, in rings.
        let step = [longest / size.x, longest / size.y];
        let grid = PI / map.dx().max(map.dy()) / width;
        let [shortest_side, before] =
            if windowed { [FIRST * longest / size.shorter(), BEFORE_LIMIT] } else { [0.5, 0.0] };
        let from = shortest_side.max(limits[0] / width);
        let to = (grid - before).min(limits[1] / width) * (1.0 + SLACK);
        let count = to.max(0.0) as usize + 2;
        // Copies, copies times wavenumber, copies times variance.
        let mut sums = vec![[0.0; 3]; count];
        let ring_of = |m: [f64; 2]| {
            let q = (m[0] * step[0]).hypot(m[1] * step[1]);
            (q >= from * (1.0 - SLACK) && q <= to).then_some((q.round() as usize, q))
        };
        let unit = periodogram(map, |wave| {
            if let Some((ring, q)) = ring_of(wave.index.map(|m| m as f64)) {
                let sum = &mut sums[ring];
                *sum = [sum[0] + wave.copies, sum[1] + wave.copies * q, sum[2] + wave.copies * wave.variance];
            }
        })?;
        let responses = if windowed {
            Responses::windowed(map.cells(), step, count, &ring_of)
        } else {
            Responses::periodic(map.cells(), count, &ring_of)
        };
        let correlated = if windowed { HANN_CORRELATION } else { 1.0 };
        let total: f64 = sums.iter().map(|s| s[2]).sum();
        let scale = if total > 0.0 { total } else { 1.0 };
        let largest = sums.iter().filter(|s| s[0] > 0.0).map(|s| s[2] / s[0]).fold(0.0, f64::max) / scale;
        let rings = sums.iter().zip(responses.rows).filter(|(sum, _)| sum[0] > 0.0);
        let mut all: Vec<Ring> = rings
            .map(|([count, q, power], row)| {
                let first = row.iter().position(|w| *w > 0.0).unwrap_or(0);
                let last = row.iter().rposition(|w| *w > 0.0).map_or(first, |k| k + 1);
                Ring {
                    wavenumber: q / count,
                    power: (power / count / scale).max(ROUNDING * largest),
                    independent: 0.5 * count / correlated,
                    first,
                    weights: row[first..last].iter().map(|w| w / count).collect(),
                }
            })
            .collect();
        if windowed {
            all = without_leakage(&all);
        }
        let density = (scale * unit * unit) * (size.x / TAU) * (size.y / TAU);
        Ok(Self { all, nodes: responses.nodes, width, range: [from, to], windowed, density })
    }
}

/// The rings whose power is more than what the window's transform brings from beyond its reach: behind the
/// edge of a spectrum there is nothing else, and the responses end there.
fn without_leakage(all: &[Ring]) -> Vec<Ring> {
    let clear = |ring: &&Ring| {
        let far = all.iter().filter(|other| ring.wavenumber - other.wavenumber > REACH as f64 - 0.5);
        // The largest it can be at each distance, not the zeros between.
        let leakage: f64 = far
            .map(|other| {
                let nu = ring.wavenumber - other.wavenumber;
                other.power * 2.0 / 3.0 / (PI * nu * (nu * nu - 1.0)).powi(2)
            })
            .sum();
        ring.power > LEAKAGE * leakage
    };
    all.iter().filter(clear).cloned().collect()
}

/// How much of the density at each node is in the sum of the powers of each ring.
struct Responses {
    nodes: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

type RingOf<'a> = dyn Fn([f64; 2]) -> Option<(usize, f64)> + 'a;

impl Responses {
    fn empty(count: usize) -> (Vec<Vec<f64>>, Vec<[f64; 2]>) {
        let nodes = ((count + REACH + 2) as f64 * NODES) as usize;
        (vec![vec![0.0; nodes]; count], vec![[0.0; 2]; nodes])
    }

    /// Nodes at the mean wavenumbers of what they stand for.
    fn of(rows: Vec<Vec<f64>>, sums: &[[f64; 2]]) -> Self {
        let node = |(k, [weight, q]): (usize, &[f64; 2])| {
            if *weight > 0.0 { (q / weight).ln() } else { ((k as f64 + 0.5) / NODES).ln() }
        };
        Self { nodes: sums.iter().enumerate().map(node).collect(), rows }
    }

    /// Each wave answers to its own wavenumber.
    fn periodic(cells: Cells, count: usize, ring_of: &RingOf<'_>) -> Self {
        let (mut rows, mut sums) = Self::empty(count);
        for (m, copies) in quadrant(cells) {
            let Some((ring, q)) = ring_of(m) else { continue };
            let node = (q * NODES) as usize;
            rows[ring][node] += copies;
            sums[node] = [sums[node][0] + copies, sums[node][1] + copies * q];
        }
        Self::of(rows, &sums)
    }

    /// Each wave answers to the waves of a finer lattice with the window's transform between.
    fn windowed(cells: Cells, step: [f64; 2], count: usize, ring_of: &RingOf<'_>) -> Self {
        let (mut rows, mut sums) = Self::empty(count);
        let reach = (REACH * FINE).cast_signed();
        let offsets: Vec<f64> = (-reach..=reach).map(|k| k as f64 / FINE as f64).collect();
        let kernel: Vec<f64> = offsets.iter().map(|nu| hann_power(*nu) / FINE as f64).collect();
        for (m, copies) in quadrant(cells) {
            let Some((ring, _)) = ring_of(m) else { continue };
            let row = &mut rows[ring];
            for (y, ky) in offsets.iter().zip(&kernel) {
                let qy = (m[1] + y) * step[1];
                for (x, kx) in offsets.iter().zip(&kernel) {
                    let q = ((m[0] + x) * step[0]).hypot(qy);
                    let periods = (m[0] + x).hypot(m[1] + y);
                    let left = (WITHOUT_PLANE * periods.powi(4)).min(1.0);
                    let weight = copies * kx * ky * left;
                    let node = (q * NODES) as usize;
                    if weight > 0.0 && node < row.len() {
                        row[node] += weight;
                        sums[node] = [sums[node][0] + weight, sums[node][1] + weight * q];
                    }
                }
            }
        }
        Self::of(rows, &sums)
    }
}

/// Waves of the quadrant `mx, my >= 0` and how many waves of the whole plane each stands for.
fn quadrant(cells: Cells) -> impl Iterator<Item = ([f64; 2], f64)> {
    let Cells { columns, rows } = cells;
    let copies = |m: usize, n: usize| if m == 0 || 2 * m == n { 1.0 } else { 2.0 };
    (0..=columns / 2).flat_map(move |mx| {
        (0..=rows / 2)
            .filter(move |my| (mx, *my) != (0, 0))
            .map(move |my| ([mx as f64, my as f64], copies(mx, columns) * copies(my, rows)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_keeps_variance() {
        let sum = |offset: f64| (-60_i32..=60).map(|k| hann_power(f64::from(k) + offset)).sum::<f64>();
        for offset in [0.0, 0.25, 0.5] {
            assert!((sum(offset) - 1.0).abs() < 1e-9, "{offset}");
        }
    }

    #[test]
    fn a_flat_spectrum_stays_flat() {
        let map = HeightMap::from_fn([48, 32], [3.0, 2.0], |ix, iy| ((ix * 5 + iy * 3) % 7) as f64).unwrap();
        for windowed in [false, true] {
            let rings = Rings::new(&map, windowed, [0.0, f64::INFINITY]).unwrap();
            assert!(rings.all.len() > 8);
            for ring in &rings.all {
                let sum: f64 = ring.weights.iter().sum();
                assert!((sum - 1.0).abs() < 2e-5, "{windowed}: {sum} at {}", ring.wavenumber);
            }
        }
    }
}
